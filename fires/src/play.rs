//! The sound of a factory fire: its preset, played from position 0 without an input.

use pyrophone_recording::Progress;
use pyrophone_settings::FactoryFire;
use pyrophone_synthesis::chain::{Chain, Channels, Transport};

use crate::Error;

/// Sample rate of a factory fire in Hz.
pub(crate) const SAMPLE_RATE_HZ: u32 = 48_000;
/// Length of a factory fire in seconds: enough for a hundred crackles of most fires.
const SECONDS: u32 = 24;

/// Samples per call of the effect.
const BLOCK_SAMPLES: usize = 4096;

/// Both channels of a fire: what `pyrophone render --preset NAME --seconds 24` writes.
///
/// # Errors
/// [`pyrophone_recording::Error::Cancelled`] if `progress` returns false.
pub(crate) fn play(fire: FactoryFire, progress: Progress<'_>) -> Result<Vec<Vec<f32>>, Error> {
    let values = fire.preset()?.values;
    let channels = Channels { input: 2, sidechain: 0, output: 2 };
    let rejected = |source| Error::Engines { name: fire.name(), source };
    let mut chain = Chain::new(f64::from(SAMPLE_RATE_HZ), channels, &values.structure()).map_err(rejected)?;
    let latency = chain.latency_samples();
    let total = (SECONDS * SAMPLE_RATE_HZ) as usize + latency;
    let mut sound = vec![vec![0.0_f32; total]; channels.output];
    for at in (0..total).step_by(BLOCK_SAMPLES) {
        let end = total.min(at + BLOCK_SAMPLES);
        let mut block: Vec<&mut [f32]> = sound.iter_mut().map(|channel| &mut channel[at..end]).collect();
        let transport = Transport { playing: true, position: Some(at as i64) };
        chain.process(&mut block, &[], &values.controls(), transport);
        if !progress(end as f32 / total as f32) {
            return Err(pyrophone_recording::Error::Cancelled.into());
        }
    }
    for channel in &mut sound {
        channel.drain(..latency);
    }
    Ok(sound)
}
