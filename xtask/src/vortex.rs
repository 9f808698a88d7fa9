//! `cargo xtask vortex`: the vortex-sound textures that are shipped, `presets/vortex/NAME.vtx`.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::{Context, Result};
use pyrophone_flame::vortex_texture::{Progress, Shipped, speeds};
use pyrophone_recording::write_file;
use pyrophone_synthesis::vortex::texture::{Row, VortexTexture};
use rayon::prelude::*;

use crate::project;

/// Options of `cargo xtask vortex`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Textures to record, by name [default: all, which takes about 10 minutes on two cores]
    textures: Vec<String>,
    /// Folder to write to [default: presets/vortex]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Records and writes.
pub fn run(args: &Args) -> Result<()> {
    let textures: Vec<Shipped> = match args.textures.as_slice() {
        [] => Shipped::ALL.to_vec(),
        names => names.iter().map(|name| named(name)).collect::<Result<_>>()?,
    };
    let folder = args.output.clone().unwrap_or_else(|| project::root().join("presets/vortex"));
    std::fs::create_dir_all(&folder).with_context(|| format!("creating {}", folder.display()))?;
    for texture in textures {
        let path = folder.join(format!("{}.vtx", texture.name));
        write(&path, &record(&texture)?)?;
        println!("{}", path.display());
    }
    Ok(())
}

fn named(name: &str) -> Result<Shipped> {
    let found = Shipped::ALL.into_iter().find(|texture| texture.name == name);
    found.with_context(|| format!("there is no texture {name}"))
}

/// All rows, as many at a time as there are cores.
fn record(Shipped { name, recipe, speeds: (low, high, count) }: &Shipped) -> Result<VortexTexture> {
    let speeds = speeds(*low, *high, *count)?;
    let meter = Meter::new(name, speeds.iter().map(|speed| recipe.recorded_steps(*speed)).sum());
    // The long ones first, so that no core ends up alone with one.
    let rows = speeds.par_iter().rev().with_max_len(1).map(|speed| {
        recipe.record(*speed, |progress| {
            if matches!(progress, Progress::Recording(_)) {
                meter.step();
            }
            true
        })
    });
    let mut rows: Vec<Row> = rows.collect::<Result<_, _>>()?;
    rows.reverse();
    meter.end();
    Ok(VortexTexture::new(recipe.rate_hz, rows)?)
}

fn write(path: &Path, texture: &VortexTexture) -> Result<()> {
    Ok(write_file(path, |file| file.write_all(&texture.to_bytes()))?)
}

/// Progress of a texture: recorded steps. Before these a flow settles, for an unpredictable time.
struct Meter<'a> {
    name: &'a str,
    total: usize,
    is_shown: bool,
    /// Steps done, and the percent that were shown last.
    done: Mutex<(usize, Option<usize>)>,
}

impl<'a> Meter<'a> {
    fn new(name: &'a str, total: usize) -> Self {
        Self { name, total, is_shown: std::io::stderr().is_terminal(), done: Mutex::new((0, None)) }
    }

    fn step(&self) {
        let mut done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        done.0 += 1;
        let percent = 100 * done.0 / self.total;
        if self.is_shown && done.1 != Some(percent) {
            done.1 = Some(percent);
            eprint!("\rrecording {}: {percent:3} %", self.name);
            // Progress that cannot be shown is no reason to stop.
            let _ = std::io::stderr().flush();
        }
    }

    fn end(&self) {
        if self.is_shown {
            eprintln!();
        }
    }
}

#[cfg(test)]
mod tests {
    use pyrophone_flame::vortex_texture::{FlowModel, Recipe};

    use super::*;

    #[test]
    fn a_texture_is_written_as_it_was_recorded() {
        let recipe =
            Recipe { kind: FlowModel::Wind, voxels: [8; 3], rate_hz: 2_000.0, period_s: 0.25, ..Recipe::STANDARD };
        let texture = record(&Shipped { name: "wind", recipe, speeds: (1.0, 4.0, 3) }).expect("recorded");
        assert_eq!(texture.rows().iter().map(|row| row.speed_m_s).collect::<Vec<_>>(), [1.0, 2.0, 4.0]);
        for row in texture.rows() {
            assert_eq!(*row, recipe.record(row.speed_m_s, |_| true).expect("recorded"), "{} m/s", row.speed_m_s);
        }
        let folder = std::env::temp_dir().join(format!("pyrophone-vortex-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("wind.vtx");
        write(&path, &texture).expect("written");
        assert_eq!(std::fs::read(&path).expect("readable"), texture.to_bytes());
        assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1, "nothing is left beside it");
        std::fs::remove_dir_all(&folder).expect("removed");
    }

    #[test]
    fn unknown_texture_name_is_refused() {
        assert!(named("fire").is_ok() && named("jet").is_ok());
        assert!(named("water").is_err());
    }
}
