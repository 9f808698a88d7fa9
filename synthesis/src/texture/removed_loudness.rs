//! Slow loudness that was removed from a recording before its windows were analysed, and is restored window by window.

use bitcode::{Decode, Encode};

use crate::bulk::bulk_fields;

/// Loudness of a recording by frames, of which a power was divided out.
#[derive(Debug, Clone, Encode, Decode)]
pub struct RemovedLoudness {
    /// Loudness by frames, relative to that of the whole; positive.
    #[bitcode(skip)]
    relative: Vec<f64>,
    frame_samples: usize,
    /// Exponent of the power that was divided out.
    exponent: f64,
    /// Index, in the dictionary's arrays, of the recording's first sample.
    first: usize,
}

bulk_fields!(RemovedLoudness: relative);

impl RemovedLoudness {
    /// Divides `channels`, equally long, by power `exponent` of a loudness: `relative` to the whole, positive, one value
    /// per `frame_samples`, linear between the frames' centres.
    pub fn divide_out(channels: &mut [Vec<f64>], relative: Vec<f64>, frame_samples: usize, exponent: f64) -> Self {
        let removed = Self { relative, frame_samples, exponent, first: 0 };
        // A power for each sample of all channels: it is most of the work of analysing a recording's loudness.
        for i in 0..channels.first().map_or(0, Vec::len) {
            let gain = maths::pow(removed.relative_at(i as f64), -exponent);
            channels.iter_mut().for_each(|channel| channel[i] *= gain);
        }
        removed
    }

    /// Sets the start of the recording in the dictionary's arrays.
    pub(super) fn set_first(&mut self, first: usize) {
        self.first = first;
    }

    /// The factor after which loudness to the power of `exponent` (0-1) is left, around `sample` of the dictionary's
    /// arrays.
    pub fn gain_at(&self, sample: i64, exponent: f64) -> f64 {
        let missing = self.exponent - exponent;
        if missing == 0.0 { 1.0 } else { maths::pow(self.relative_at((sample - self.first as i64) as f64), missing) }
    }

    /// Approximate number of bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.relative.len() * size_of::<f64>()
    }

    fn relative_at(&self, sample: f64) -> f64 {
        let Some(last) = self.relative.len().checked_sub(1) else { return 1.0 };
        let position = ((sample + 0.5) / self.frame_samples as f64 - 0.5).clamp(0.0, last as f64);
        let frame = (position as usize).min(last);
        let next = self.relative[(frame + 1).min(last)];
        self.relative[frame] + (position - frame as f64) * (next - self.relative[frame])
    }
}
