//! `pyrophone flux-plan`: a render-farm job, planned from the cache's frames.

mod openjd;
mod shell;

use std::path::{Path, PathBuf};

use pyrophone_flame::import::Sequence;
use pyrophone_recording::write_file;

use crate::args::{FarmFormat, FluxPlanArgs};
use crate::error::Error;
use crate::input::in_range;
use crate::output;
use crate::progress::note;
use crate::summary::{Outcome, print};

/// Largest number of jobs that are written out one by one.
const MOST_CHUNKS: u64 = 100_000;

/// A job, independent of the scheduler that runs it.
struct Job {
    program: PathBuf,
    input: PathBuf,
    /// The final sound.
    output: PathBuf,
    /// Folder of the parts.
    parts: PathBuf,
    /// First and last frame, by number.
    frames: (i64, i64),
    chunk: u64,
    /// Options for each part's `flux`.
    measure: Vec<String>,
    /// Options for `flux-merge`.
    merge: Vec<String>,
}

/// Writes a job that measures the frames of a cache in parts and merges them.
pub fn run(args: &FluxPlanArgs) -> Result<Outcome, Error> {
    in_range("--chunk", args.chunk as f64, 1.0, 1e9)?;
    output::check(&args.output, &[])?;
    args.speed_field.as_deref().map_or(Ok(()), output::check_file)?;
    let sequence = Sequence::open(&args.input)?;
    let numbering = sequence.numbering();
    let ends = (sequence.numbers().next(), sequence.numbers().last());
    let (Some(first), Some(last)) = ends else { return Err(pyrophone_flame::Error::NoFrames.into()) };
    let output = absolute(&args.output)?;
    let name = output.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let job = Job {
        program: std::env::current_exe().map_err(|_| Error::Conflict("the program cannot find its own path".into()))?,
        input: absolute(&args.input)?,
        parts: output.with_file_name(format!("{name}.parts")),
        frames: (numbering.frame_of(first), numbering.frame_of(last)),
        chunk: args.chunk,
        measure: measure_options(args),
        merge: merge_options(args)?,
        output,
    };
    let chunks = job.chunks().count() as u64;
    if chunks > MOST_CHUNKS {
        let message = format!(
            "--chunk {} makes {chunks} jobs, but at most {MOST_CHUNKS} are allowed; choose more frames per job",
            args.chunk
        );
        return Err(Error::Conflict(message));
    }
    note(&format!("{} frames in {chunks} parts", sequence.len()));
    let text = match args.format {
        FarmFormat::Openjd => openjd::template(&job),
        FarmFormat::Slurm => shell::slurm(&job),
        FarmFormat::Shell => shell::plain(&job),
    };
    let Some(path) = &args.job else {
        print(&text);
        return Ok(Outcome::default());
    };
    write_file(path, |file| std::io::Write::write_all(file, text.as_bytes()))?;
    Ok(Outcome::default().with_files(vec![path.clone()]))
}

fn measure_options(args: &FluxPlanArgs) -> Vec<String> {
    let mut options = vec![];
    if let Some(rate) = &args.rate {
        options.extend(["--rate".to_owned(), rate.clone()]);
    }
    if args.skip_bad {
        options.push("--skip-bad".to_owned());
    }
    let extras = [("speed-field", args.speed_field.is_some()), ("report", args.report.is_some())];
    for (name, _) in extras.into_iter().filter(|(_, is_wanted)| *is_wanted) {
        options.extend(["--partial-with".to_owned(), name.to_owned()]);
    }
    options.extend(args.flux_options.iter().cloned());
    options
}

fn merge_options(args: &FluxPlanArgs) -> Result<Vec<String>, Error> {
    let mut options = vec![];
    for (option, path) in [("--speed-field", &args.speed_field), ("--report", &args.report)] {
        if let Some(path) = path {
            options.extend([option.to_owned(), absolute(path)?.display().to_string()]);
        }
    }
    options.extend(args.merge_options.iter().cloned());
    Ok(options)
}

/// A path that is valid from every folder; patterns for frame names need not exist.
fn absolute(path: &Path) -> Result<PathBuf, Error> {
    let failed = |error: std::io::Error| Error::Conflict(format!("{}: {}", path.display(), error.kind()));
    std::path::absolute(path).map_err(failed)
}

impl Job {
    /// First and last frame of every part.
    fn chunks(&self) -> impl Iterator<Item = (i64, i64)> + '_ {
        let (first, last) = self.frames;
        let chunk = i64::try_from(self.chunk).unwrap_or(i64::MAX);
        let starts = (0..)
            .map_while(move |n: i64| n.checked_mul(chunk)?.checked_add(first))
            .take_while(move |from| *from <= last);
        starts.map(move |from| (from, from.saturating_add(chunk - 1).min(last)))
    }

    /// Arguments of one part's `flux`; `frames` is the scheduler's placeholder for its frames.
    fn measure_arguments(&self, frames: &str) -> Vec<String> {
        let part = self.parts.join(format!("part_{frames}.csv"));
        let fixed = ["flux", "--input"].map(str::to_owned);
        let named = [self.input.display().to_string(), "--frames".into(), frames.into(), "--partial".into()];
        fixed.into_iter().chain(named).chain([part.display().to_string()]).chain(self.measure.iter().cloned()).collect()
    }

    /// Arguments of the final `flux-merge`.
    fn merge_arguments(&self) -> Vec<String> {
        let parts = self.parts.display().to_string();
        let fixed = ["flux-merge".to_owned(), parts, "--output".into(), self.output.display().to_string()];
        fixed.into_iter().chain(self.merge.iter().cloned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job() -> Job {
        Job {
            program: "/opt/it's/pyrophone".into(),
            input: "/shot 1/fire.####.vdb".into(),
            output: "/shot 1/fire.wav".into(),
            parts: "/shot 1/fire.wav.parts".into(),
            frames: (-2, 65),
            chunk: 30,
            measure: vec!["--rate".into(), "24000/1001".into()],
            merge: vec!["--peak-db".into(), "-12".into()],
        }
    }

    #[test]
    fn chunks_cover_all_frames_once() {
        assert_eq!(job().chunks().collect::<Vec<_>>(), [(-2, 27), (28, 57), (58, 65)]);
        let far = Job { frames: (i64::MAX - 3, i64::MAX), chunk: 2, ..job() };
        assert_eq!(far.chunks().count(), 2);
    }

    #[test]
    fn jobs_quote_what_they_name() {
        let text = shell::plain(&job());
        assert!(
            text.contains(r"'/opt/it'\''s/pyrophone' flux --input '/shot 1/fire.####.vdb' --frames -2-27"),
            "{text}"
        );
        assert!(
            text.contains("flux-merge '/shot 1/fire.wav.parts' --output '/shot 1/fire.wav' --peak-db -12"),
            "{text}"
        );
        let text = shell::slurm(&job());
        assert!(text.contains("--array=0-2") && text.contains("--requeue") && text.contains("afterok"), "{text}");
        let text = openjd::template(&job());
        let parsed: serde_json::Value = serde_json::from_str(&text).unwrap();
        let frames = &parsed["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0];
        assert_eq!(
            (frames["range"].as_str(), frames["chunks"]["defaultTaskCount"].as_i64()),
            (Some("-2-65"), Some(30))
        );
        assert_eq!(parsed["steps"][1]["dependencies"][0]["dependsOn"], "Measure");
    }
}
