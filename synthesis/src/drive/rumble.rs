//! The rumble of a flame, as band-limited noise.

use crate::dsp::{Transform, White};

/// The band in Hz: between the paper's high-pass (30 Hz) and its cutoff (180 Hz), so that neither removes much of it.
const BAND_HZ: (f64, f64) = (40.0, 150.0);

/// Half-length of the band-pass in seconds.
const REACH_S: f64 = 0.035;

/// White-noise stream that no other stage uses.
const STREAM: u32 = 0x4655_4D45;

/// Noise of 40-150 Hz with unit rms, a function of (seed, position) only. It is made in blocks that are aligned with
/// multiples of their length on the timeline.
#[derive(Debug)]
pub(super) struct Rumble {
    transform: Transform,
    response: Vec<f64>,
    reach: usize,
    block: Vec<f64>,
    /// Seed and number of the block at hand.
    made: Option<(u32, i64)>,
}

impl Rumble {
    pub fn new(sample_rate_hz: f64) -> Self {
        let reach = (REACH_S * sample_rate_hz).ceil() as usize;
        let mut transform = Transform::new((5 * reach / 2).next_power_of_two());
        let mut response = vec![0.0; transform.bins()];
        transform.response(&band_pass(reach, sample_rate_hz), &mut response);
        let block = vec![0.0; transform.len() - 2 * reach];
        Self { transform, response, reach, block, made: None }
    }

    /// Multiplies `signal`, whose first sample is at `position`, by the rumble.
    pub fn modulate(&mut self, seed: u32, position: i64, signal: &mut [f64]) {
        let hop = self.block.len() as i64;
        let mut done = 0;
        while done < signal.len() {
            let at = position.wrapping_add(done as i64);
            let (number, offset) = (at.div_euclid(hop), at.rem_euclid(hop) as usize);
            if self.made != Some((seed, number)) {
                self.make(seed, number);
            }
            let piece = &mut signal[done..];
            let count = piece.len().min(self.block.len() - offset);
            piece[..count].iter_mut().zip(&self.block[offset..]).for_each(|(sample, rumble)| *sample *= rumble);
            done += count;
        }
    }

    fn make(&mut self, seed: u32, number: i64) {
        let hop = self.block.len();
        let start = number.wrapping_mul(hop as i64).wrapping_sub(self.reach as i64);
        for (offset, sample) in self.transform.time.iter_mut().enumerate() {
            *sample = White::new(seed, STREAM).sample_at(start.wrapping_add(offset as i64));
        }
        self.transform.forward();
        self.transform.filter(&self.response);
        self.block.copy_from_slice(&self.transform.time[self.reach..self.reach + hop]);
        self.made = Some((seed, number));
    }
}

/// Taps 0, 1, ... of a linear-phase band-pass under a Hann window, with unit energy, so that white noise of unit
/// variance keeps its variance.
fn band_pass(reach: usize, sample_rate_hz: f64) -> Vec<f64> {
    let mut taps: Vec<f64> = (0..=reach)
        .map(|tap| {
            let angle = std::f64::consts::PI * tap as f64;
            let hann = 0.5 + 0.5 * maths::cos(angle / (reach + 1) as f64);
            let low_pass = |edge_hz: f64| {
                let turn = 2.0 * edge_hz / sample_rate_hz;
                if tap == 0 { turn } else { maths::sin(angle * turn) / angle }
            };
            hann * (low_pass(BAND_HZ.1) - low_pass(BAND_HZ.0))
        })
        .collect();
    let energy = 2.0 * taps.iter().map(|tap| tap * tap).sum::<f64>() - taps[0] * taps[0];
    taps.iter_mut().for_each(|tap| *tap /= energy.sqrt());
    taps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_unit_rms_and_does_not_depend_on_the_cutting() {
        let count = 441_000;
        let mut whole = vec![1.0; count];
        Rumble::new(44_100.0).modulate(42, -1234, &mut whole);
        let power = whole.iter().map(|x| x * x).sum::<f64>() / count as f64;
        assert!((power - 1.0).abs() < 0.1, "{power}");
        let mut pieces = vec![1.0; count];
        let mut rumble = Rumble::new(44_100.0);
        let mut at = 0;
        for step in [1, 17, 997, 1000, 4096, 8192].into_iter().cycle() {
            let end = (at + step).min(count);
            rumble.modulate(42, at as i64 - 1234, &mut pieces[at..end]);
            at = end;
            if at == count {
                break;
            }
        }
        assert_eq!(whole, pieces);
    }
}
