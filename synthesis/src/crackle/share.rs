//! Share of a recording's borderline crackles to play, found by trial runs over its bed.

use rayon::prelude::*;

use super::Crackle;
use super::detect::crackles;
use super::event::{Crackles, loud};
use super::source::Sources;
use crate::controls::CrackleControls;

/// Number of trials at each of two shares, each trial with its own order of crackles; and the smallest share that may be
/// played.
const TRIALS: u32 = 4;
const TRIED: [f64; 2] = [1.0, 0.5];
const LEAST_SHARE: f64 = 0.3;

impl Crackles {
    /// Finds the share of the borderline crackles that gives as many loud ones as in the recording. They are counted over
    /// `bed`, the texture of the recording's bed at a steady level: an even bed hides fewer than the recording's own, and
    /// adds some.
    pub(crate) fn calibrate(&mut self, bed: &[f64], sample_rate_hz: f64) {
        let counts = TRIED.map(|share| {
            self.set_share(share);
            self.loud_over(bed, sample_rate_hz)
        });
        let wanted = self.loud_per_s() * TRIALS as f64 * bed.len() as f64 / sample_rate_hz;
        // As a straight line through both; if it hardly falls, leaving out crackles does not help.
        let step = (counts[0] - counts[1]).max(1.0);
        let share = TRIED[0] - (TRIED[0] - TRIED[1]) * (counts[0] - wanted) / step;
        self.set_share(share.clamp(LEAST_SHARE, 1.0));
    }

    /// Number of loud crackles over `bed` in all trials.
    fn loud_over(&self, bed: &[f64], sample_rate_hz: f64) -> f64 {
        let count = |seed: u32| {
            let mut sum = play_steadily(self, seed, bed.len(), sample_rate_hz);
            sum.iter_mut().zip(bed).for_each(|(crackle, bed)| *crackle += bed);
            loud(&crackles(&[sum], sample_rate_hz))
        };
        (0..TRIALS).into_par_iter().map(count).sum::<usize>() as f64
    }
}

/// Output of the layer for a drive of steady loudness.
fn play_steadily(crackles: &Crackles, seed: u32, samples: usize, sample_rate_hz: f64) -> Vec<f64> {
    const BLOCK: usize = 1024;
    let mut layer = Crackle::new(sample_rate_hz, 1, 0, BLOCK);
    let controls = CrackleControls { seed, ..CrackleControls::default() };
    layer.reset(0);
    let mut output = vec![0.0; samples];
    for block in output.chunks_mut(BLOCK) {
        layer.process(&[1.0; BLOCK][..block.len()], &controls, &Sources::of_recording(crackles), &mut [block]);
    }
    output
}
