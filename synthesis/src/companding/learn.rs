//! Loudnesses of a whole drive, learned before it is played.

use super::frames::frame_samples;
use super::{Companding, DriveBlock, DriveEnvelope};
use crate::Error;
use crate::controls::TextureControls;

/// Samples processed at a time.
const LEARN_BLOCK: usize = 4096;

/// The loudnesses of a whole drive, or of the whole envelope that it was made from, for learning. Fails if it is shorter
/// than a frame.
pub fn loudnesses(drive: &[f64], envelope: Option<DriveEnvelope<'_>>, sample_rate_hz: f64) -> Result<Vec<f64>, Error> {
    let least = frame_samples(sample_rate_hz);
    if drive.len() < least {
        let remedy = "the running estimate";
        return Err(Error::TooShort { what: "the sound to learn from", found: drive.len(), least, remedy });
    }
    let mut companding = Companding::new(sample_rate_hz, 0, 0, 0, LEARN_BLOCK);
    let mut all = Vec::new();
    let (mut flat, mut loudness) = (vec![0.0; LEARN_BLOCK], vec![0.0; LEARN_BLOCK]);
    for (number, drive) in drive.chunks(LEARN_BLOCK).enumerate() {
        let envelope = envelope
            .map(|whole| DriveEnvelope { values: &whole.values[number * LEARN_BLOCK..][..drive.len()], ..whole });
        let (flat, loudness) = (&mut flat[..drive.len()], &mut loudness[..drive.len()]);
        companding.compress(DriveBlock { samples: drive, envelope }, &TextureControls::default(), None, flat, loudness);
        all.extend_from_slice(companding.measured_loudnesses());
    }
    Ok(all)
}
