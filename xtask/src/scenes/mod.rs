//! `cargo xtask bench scenes`: the sound of the scenes at several resolutions, beside signals of other flames.

mod character;

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use pyrophone_flame::pressure::derivative;
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene};

use crate::{drives, project, simulated};
use character::{BANDS_HZ, Character};

/// Sampling rate of the pressure, in Hz: four times the steps', so that the kernel's images are far outside the band.
const RATE_HZ: f64 = 4.0 * STEP_RATE_HZ;

/// Options of `cargo xtask bench scenes`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scenes to simulate, by name [default: all]
    scenes: Vec<String>,
    /// Cells along the longest side, from coarse to fine
    #[arg(long, value_delimiter = ',', default_value = "24,40,64")]
    cells: Vec<usize>,
    /// Length of the signal that is measured, in seconds
    #[arg(long, default_value_t = 3.0)]
    seconds: f64,
    /// Random seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Measure the plugin's loops, as designed and windy, without simulating anything
    #[arg(long, conflicts_with_all = ["cells", "seconds", "seed"])]
    loops: bool,
    /// WAV files of other flames' pressure, which come first in the table
    #[arg(long, value_name = "FILE", num_args = 1.., value_delimiter = ',')]
    reference: Vec<PathBuf>,
}

/// Simulates, and prints the table.
pub fn run(args: &Args) -> Result<()> {
    println!("{}", head());
    for path in &args.reference {
        let (signal, rate_hz) = read(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        println!("{}", row(&name, "", Character::of_signal(&signal, rate_hz).as_ref(), ""));
    }
    for scene in simulated::scenes(&args.scenes)? {
        if args.loops {
            print_loops(scene)?;
            continue;
        }
        let mut coarser: Option<Character> = None;
        for cells in &args.cells {
            let began = Instant::now();
            let options = Options { resolution: *cells, seed: args.seed, ..Options::default() };
            let found = of_scene(scene, options, args.seconds)?;
            let cost = format!("{:.1}", began.elapsed().as_secs_f64() / args.seconds);
            println!("{}", row(scene.name(), &cells.to_string(), found.as_ref(), &cost));
            if let (Some(coarser), Some(found)) = (coarser, found) {
                println!("{}", changes(&coarser, &found));
            }
            coarser = found;
        }
    }
    Ok(())
}

/// The character of a scene's pressure over `seconds`, after its usual time to catch fire.
pub fn of_scene(scene: Scene, options: Options, seconds: f64) -> Result<Option<Character>> {
    let flux = simulated::flux(scene, options, scene.default_pre_roll_s(), seconds, scene.name())?;
    Ok(Character::of_signal(&derivative(&flux, STEP_RATE_HZ, RATE_HZ), RATE_HZ))
}

/// Prints the character of a scene's loops in the plugin, one for each way in which it was simulated.
fn print_loops(scene: Scene) -> Result<()> {
    let path = project::root().join(format!("presets/drives/{}.wav", scene.name()));
    let mut reader = hound::WavReader::open(&path).with_context(|| path.display().to_string())?;
    let flux: Vec<f64> = reader.samples::<i16>().map(|x| x.map(f64::from)).collect::<Result<_, _>>()?;
    for (way, (name, _)) in drives::WAYS.iter().enumerate() {
        let flux: Vec<f64> = flux.iter().copied().skip(way).step_by(drives::WAYS.len()).collect();
        let found = Character::of_signal(&derivative(&flux, STEP_RATE_HZ, RATE_HZ), RATE_HZ);
        println!("{}", row(&format!("{}, {name}", scene.name()), "loop", found.as_ref(), ""));
    }
    Ok(())
}

/// A WAV file's first channel, and its sample rate in Hz.
fn read(path: &PathBuf) -> Result<(Vec<f64>, f64)> {
    let mut reader = hound::WavReader::open(path).with_context(|| path.display().to_string())?;
    let spec = reader.spec();
    let samples: Vec<f64> = match spec.sample_format {
        hound::SampleFormat::Float => reader.samples::<f32>().map(|x| x.map(f64::from)).collect::<Result<_, _>>()?,
        hound::SampleFormat::Int => {
            let full = 2f64.powi(i32::from(spec.bits_per_sample) - 1);
            reader.samples::<i32>().map(|x| x.map(|x| f64::from(x) / full)).collect::<Result<_, _>>()?
        }
    };
    ensure!(!samples.is_empty(), "{}: there is no sound in it", path.display());
    Ok((samples.into_iter().step_by(usize::from(spec.channels)).collect(), f64::from(spec.sample_rate)))
}

fn head() -> String {
    let [a, b, c] = BANDS_HZ.map(|(low, high)| format!("{low}-{high} Hz"));
    format!(
        "| signal | cells | {a}, dB | {b}, dB | {c}, dB | envelope CV | kurtosis | bursts /s | dB per decade | s per s |\n|---|---|---|---|---|---|---|---|---|---|"
    )
}

fn row(name: &str, cells: &str, found: Option<&Character>, cost: &str) -> String {
    let Some(found) = found else { return format!("| {name} | {cells} | silent | | | | | | | {cost} |") };
    let Character { levels_db: [a, b, c], envelope_cv, kurtosis, bursts_hz, slope_db } = found;
    format!(
        "| {name} | {cells} | {a:.1} | {b:.1} | {c:.1} | {envelope_cv:.2} | {kurtosis:.1} | {bursts_hz:.1} | {slope_db:.0} | {cost} |"
    )
}

/// Change in dB with finer cells.
fn changes(coarse: &Character, fine: &Character) -> String {
    let [a, b, c]: [f64; 3] = std::array::from_fn(|band| fine.levels_db[band] - coarse.levels_db[band]);
    format!("| | change | {a:+.1} | {b:+.1} | {c:+.1} | | | | | |")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Most that levels may change in dB from 40 to 64 cells.
    const MOST_CHANGE_DB: f64 = 1.5;

    fn changes_db(scene: Scene, cells: [usize; 2], seconds: f64) -> [f64; 3] {
        let [coarse, fine] = cells.map(|resolution| {
            of_scene(scene, Options { resolution, ..Options::default() }, seconds).unwrap().unwrap().levels_db
        });
        std::array::from_fn(|band| fine[band] - coarse[band])
    }

    /// The sound is the flame's, not its grid's: checked for one scene in brief, for all in the long tests.
    #[test]
    fn levels_hardly_depend_on_the_cells() {
        let is_long = std::env::var_os("PYROPHONE_SOAK").is_some();
        let (scenes, cells, seconds) =
            if is_long { (Scene::ALL.to_vec(), [40, 64], 3.0) } else { (vec![Scene::BurningBrick], [24, 32], 0.8) };
        let found: Vec<_> = scenes.into_iter().map(|scene| (scene.name(), changes_db(scene, cells, seconds))).collect();
        let is_still = |(_, changes): &(&str, [f64; 3])| changes.iter().all(|db| db.abs() <= MOST_CHANGE_DB);
        assert!(found.iter().all(is_still), "dB in three bands: {found:.2?}");
    }

    /// Bursts as fire has them, with a spectrum that a recording of fire could have.
    #[test]
    fn a_scene_has_the_character_of_fire() {
        let options = Options { resolution: 24, ..Options::default() };
        let found = of_scene(Scene::BurningBrick, options, 2.0).unwrap().unwrap();
        assert!(found.envelope_cv > 0.6 && found.kurtosis > 5.0, "{found:?}");
        assert!((0.5..=4.0).contains(&found.bursts_hz) && (-20.0..=0.0).contains(&found.slope_db), "{found:?}");
    }
}
