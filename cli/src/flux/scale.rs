//! One scale for all flames of a shot, so that their balance is preserved.

use pyrophone_recording::write_file;

use crate::args::SoundArgs;
use crate::error::Error;
use crate::input::text;

/// First line of the file; the scale follows.
const MARK: &str = "pyrophone scale ";

/// The scale in the shot's file; none if the file does not exist yet.
///
/// Fails if the file holds anything else.
pub fn kept(args: &SoundArgs) -> Result<Option<f64>, Error> {
    let Some(path) = args.scale_file.as_deref().filter(|path| path.exists()) else { return Ok(None) };
    let found = text(path)?;
    let scale = found.trim().strip_prefix(MARK).and_then(|scale| scale.parse::<f64>().ok());
    let refused = || {
        let message = format!("{}: this is not a scale written by --scale-file; choose another file", path.display());
        Error::Conflict(message)
    };
    scale.filter(|scale| scale.is_finite() && *scale > 0.0).map(Some).ok_or_else(refused)
}

/// Writes the shot's file if this flame is the first.
pub fn keep(args: &SoundArgs, scale: f64) -> Result<(), Error> {
    let Some(path) = args.scale_file.as_deref().filter(|path| !path.exists()) else { return Ok(()) };
    Ok(write_file(path, |file| std::io::Write::write_all(file, format!("{MARK}{scale:?}\n").as_bytes()))?)
}

/// Magnitude of the loudest sample.
pub fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |peak: f32, sample| peak.max(sample.abs()))
}

/// Description of the applied scaling.
pub fn note(args: &SoundArgs, scale: f64, peak: f32) -> String {
    match &args.scale_file {
        Some(path) => {
            let peak_db = 20.0 * peak.log10();
            format!("scaled by {scale:.6e}, from {}, to a peak of {peak_db:.1} dB", path.display())
        }
        None => format!("scaled by {scale:.6e} to a peak of {} dB", args.peak_db),
    }
}
