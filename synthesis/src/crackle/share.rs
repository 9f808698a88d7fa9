//! Share of a recording's crackles to play, found by a trial run over its bed.

use rayon::prelude::*;

use super::Crackle;
use super::detect::crackles;
use super::event::{Crackles, loud};
use super::source::Sources;
use crate::controls::CrackleControls;

/// Number of trials, each with its own order of crackles, over which loud ones are counted; and the smallest share of
/// them that may be played.
const TRIALS: u32 = 6;
const LEAST_SHARE: f64 = 0.5;

impl Crackles {
    /// Finds the share of the crackles that gives as many loud ones as in the recording. They are counted over `bed`, the
    /// texture of the recording's bed at a steady level: an even bed hides fewer than the recording's own, and adds some.
    pub(crate) fn calibrate(&mut self, bed: &[f64], sample_rate_hz: f64) {
        let seconds = TRIALS as f64 * bed.len() as f64 / sample_rate_hz;
        let all = &*self;
        let count: usize = (0..TRIALS)
            .into_par_iter()
            .map(|seed| {
                let mut heard = play_steadily(all, seed, bed.len(), sample_rate_hz);
                heard.iter_mut().zip(bed).for_each(|(crackle, bed)| *crackle += bed);
                loud(&crackles(&[heard], sample_rate_hz))
            })
            .sum();
        let share = self.loud_per_s() * seconds / count.max(1) as f64;
        self.set_share(share.clamp(LEAST_SHARE, 1.0));
    }
}

/// Output of the layer for a drive of steady loudness.
fn play_steadily(crackles: &Crackles, seed: u32, samples: usize, sample_rate_hz: f64) -> Vec<f64> {
    const BLOCK: usize = 1024;
    let mut layer = Crackle::new(sample_rate_hz, 1, 0, BLOCK);
    let controls = CrackleControls { seed, ..CrackleControls::default() };
    layer.reset(0);
    let mut heard = vec![0.0; samples];
    for block in heard.chunks_mut(BLOCK) {
        layer.process(&[1.0; BLOCK][..block.len()], &controls, &Sources::of_recording(crackles), &mut [block]);
    }
    heard
}
