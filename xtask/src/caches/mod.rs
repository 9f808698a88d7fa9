//! `cargo xtask bench caches`: cost of sparse caches of several sizes, through the whole command line.
//!
//! A script writes the caches with OpenVDB's own library, as simulators do. Each is measured twice, all frames and the
//! first half of them, so that the costs of every run (the first look, the check of the units) are known apart from those
//! of each frame.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::project;
use crate::spent::{Spent, spent};

/// Writer of the caches, for Debian's Python, which has OpenVDB.
const SCRIPT: &str = include_str!("write.py");
const PYTHON: &str = "/usr/bin/python3";
/// Frames that are measured at the same time.
const THREADS: &str = "2";

/// Options of `cargo xtask bench caches`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Voxels along an edge
    #[arg(long, value_delimiter = ',', default_value = "128,256,300,512")]
    cells: Vec<usize>,
    /// Frames of each cache
    #[arg(long, default_value_t = 6)]
    frames: usize,
}

/// A cache on disk.
struct Cache {
    folder: PathBuf,
    frames: usize,
    /// Active voxels of the first frame.
    active: u64,
}

/// Writes the caches, measures them, and prints the table.
pub fn run(args: &Args) -> Result<()> {
    ensure!(args.frames >= 2, "--frames is {}; at least 2 are needed", args.frames);
    println!(
        "| voxels | active | CPU s at the start | CPU s per frame | with flips | with `--refine 3` | difference from it | MB | MB with flips |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for cells in &args.cells {
        let cache = Cache::write(*cells, args.frames)?;
        let plain = cache.cost(&["--upsample", "off"])?;
        let sized = cache.flux()?;
        let flips = cache.cost(&["--upsample", "flips"])?;
        let fine = cache.cost(&["--upsample", "off", "--refine", "3"])?;
        let change = difference(&sized, &cache.flux()?);
        println!(
            "| {cells}³ | {:.1} million | {:.1} | {:.2} | {:.2} | {:.2} | {change:.0e} | {:.0} | {:.0} |",
            cache.active as f64 / 1e6,
            plain.start_s,
            plain.frame_s,
            flips.frame_s,
            fine.frame_s,
            plain.peak_mb,
            flips.peak_mb,
        );
    }
    Ok(())
}

/// Cost of measuring a cache.
struct Cost {
    start_s: f64,
    frame_s: f64,
    peak_mb: f64,
}

impl Cache {
    /// Writes a cache, unless it is there already.
    fn write(cells: usize, frames: usize) -> Result<Self> {
        let folder = project::target_dir().join(format!("caches/{cells}"));
        let mut hasher = DefaultHasher::new();
        SCRIPT.hash(&mut hasher);
        // Another script writes other caches.
        let log = folder.join(format!("{frames}-{:x}.log", hasher.finish()));
        if !log.is_file() {
            let _ = fs::remove_dir_all(&folder);
            fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
            eprintln!("writing {frames} frames of {cells}³ voxels");
            let mut python = Command::new(PYTHON);
            python.args(["-c", SCRIPT, &cells.to_string(), &frames.to_string()]).arg(&folder);
            let output = python.output().with_context(|| format!("calling {PYTHON}"))?;
            ensure!(output.status.success(), "writing failed: {}", String::from_utf8_lossy(&output.stderr));
            fs::write(&log, output.stdout)?;
        }
        let text = fs::read_to_string(&log)?;
        let active = text.lines().next().and_then(|line| line.parse().ok());
        Ok(Self { folder, frames, active: active.context("the writer did not say how many voxels are active")? })
    }

    /// Cost with these options.
    fn cost(&self, options: &[&str]) -> Result<Cost> {
        let half = self.frames / 2;
        let first = self.measured(half, options)?;
        let all = self.measured(self.frames, options)?;
        let frame_s = (all.cpu_s - first.cpu_s) / (self.frames - half) as f64;
        Ok(Cost { start_s: all.cpu_s - self.frames as f64 * frame_s, frame_s, peak_mb: all.peak_mb })
    }

    fn measured(&self, frames: usize, options: &[&str]) -> Result<Spent> {
        let program = project::target_dir().join("release/pyrophone");
        ensure!(program.exists(), "{} is missing: cargo build --release --package pyrophone-cli", program.display());
        let mut flux = Command::new(program);
        flux.args(["flux", "--quiet", "--rate", "24", "--frames", &format!("1-{frames}"), "--input"]).arg(&self.folder);
        flux.arg("--flux-csv").arg(self.table()).args(options).env("RAYON_NUM_THREADS", THREADS);
        let _ = fs::remove_file(self.table());
        spent(&mut flux)
    }

    fn table(&self) -> PathBuf {
        self.folder.join("flux.csv")
    }

    /// The frames' flux as last measured.
    fn flux(&self) -> Result<Vec<f64>> {
        column(&self.table(), "flux")
    }
}

/// A column of a table.
fn column(path: &Path, name: &str) -> Result<Vec<f64>> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut lines = text.lines();
    let at = lines.next().and_then(|head| head.split(',').position(|found| found == name));
    let at = at.with_context(|| format!("{} has no column {name}", path.display()))?;
    lines.map(|line| Ok(line.split(',').nth(at).unwrap_or_default().parse()?)).collect()
}

/// Rms difference of two series, of the second's deviation from its mean.
fn difference(found: &[f64], truth: &[f64]) -> f64 {
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let deviation: f64 = truth.iter().map(|x| (x - mean) * (x - mean)).sum();
    let squares: f64 = found.iter().zip(truth).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / deviation).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_relative_to_the_deviation() {
        assert_eq!(difference(&[1.0, 3.0], &[1.0, 3.0]), 0.0);
        assert!((difference(&[11.1, 12.9], &[11.0, 13.0]) - 0.1).abs() < 1e-9);
    }

    #[test]
    fn a_column_is_found_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "frame,flux,area\n1,-2.5,7\n2,3,8\n").unwrap();
        assert_eq!(column(&path, "flux").unwrap(), [-2.5, 3.0]);
        assert!(column(&path, "speed").is_err());
    }
}
