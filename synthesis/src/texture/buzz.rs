//! The buzz of repeating windows, and the reduction of scalingAlpha against it.
//!
//! At full mapping, a quiet passage of the drive can choose the same windows over and over, as loud as the drive
//! demands. That is a tone whose lines are at multiples of rate / hop, or of an integer fraction of that if a repeat
//! lasts several hops. A sound's autocorrelation, at a lag of as many hops, compares its power at those lines with that
//! between them (Wiener-Khinchin), for all lines at once and without a transform. The autocorrelation at lags beside the
//! hops measures the tones and colours that the sound has anyway. The difference of the two is the buzz.

use crate::dsp::{Svf, section_gain};

/// Longest repeat in hops: torch on its own recording repeats after six.
const HOPS: usize = 16;
/// Number of hops that are stored.
const ROWS: usize = HOPS + 1;
/// Position, in 64ths of a hop, of the lags beside the hops: away from the hops of finer levels too.
const BESIDE: usize = 23;
/// Corner in Hz of the analysed signal: the flames' own rumble is below.
const LOW_HZ: f64 = 500.0;
/// Time constant in seconds of the correlations.
const HEARD_S: f64 = 1.0;
/// Tolerated buzz: recordings and results of the reference pairs without a buzz stay below 0.06 except for moments;
/// those with a line beyond 5 dB reach 0.15 to 0.6.
const TOLERATED: f64 = 0.08;
/// Buzz beyond that at which the share falls at its fastest.
const SPAN: f64 = 0.1;
/// Shortest time in seconds in which the share falls from 1 to 0, and the time in which it recovers without any buzz.
const FALL_S: f64 = 0.8;
const RISE_S: f64 = 20.0;
/// Share of the mean power below which a hop is ignored, -40 dB, and power that always counts as silence.
const SILENT_PART: f64 = 1e-4;
const SILENCE: f64 = 1e-20;

/// Buzz detector for the synthesized sound.
#[derive(Debug)]
pub struct Buzz {
    hop: usize,
    low: Svf,
    low_gain: f64,
    last: f64,
    /// The last `ROWS` hops of the sound: a column for every position in a hop, newest first from `newest` on, stored
    /// twice so that consecutive hops are always contiguous.
    past: Vec<[f64; 2 * ROWS]>,
    newest: usize,
    part: f64,
    power: f64,
    /// Mean products with the sound 1 to `HOPS` hops before, and beside.
    on_grid: [f64; HOPS],
    beside: [f64; HOPS],
    /// Samples in the present hop, and their energy.
    filled: usize,
    energy: f64,
    fall: f64,
    rise: f64,
    share: f64,
}

impl Buzz {
    /// A detector for windows that are matched every `hop` samples, at least 1.
    pub fn new(hop: usize, sample_rate_hz: f64) -> Self {
        let hop_s = hop as f64 / sample_rate_hz;
        Self {
            hop,
            low: Svf::default(),
            low_gain: section_gain(LOW_HZ.min(0.4 * sample_rate_hz), sample_rate_hz),
            last: 0.0,
            past: vec![[0.0; 2 * ROWS]; hop],
            newest: 0,
            part: 1.0 - maths::exp(-1.0 / (HEARD_S * sample_rate_hz)),
            power: 0.0,
            on_grid: [0.0; HOPS],
            beside: [0.0; HOPS],
            filled: 0,
            energy: 0.0,
            fall: hop_s / FALL_S,
            rise: hop_s / RISE_S,
            share: 1.0,
        }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.low.reset();
        self.last = 0.0;
        self.past.fill([0.0; 2 * ROWS]);
        self.newest = 0;
        self.filled = 0;
        self.energy = 0.0;
        self.share = 1.0;
        self.forget();
    }

    fn forget(&mut self) {
        self.power = 0.0;
        self.on_grid = [0.0; HOPS];
        self.beside = [0.0; HOPS];
    }

    /// Remaining share of scalingAlpha, 0-1: it falls during a buzz and rises slowly without one.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Adds a synthesized sample.
    pub fn push(&mut self, sample: f64) {
        // Fire falls by some 6 to 9 dB an octave: its differences are nearly white, so all lines count alike.
        let high_passed = self.low.process(self.low_gain, sample - std::mem::replace(&mut self.last, sample)).high;
        // `lag` hops before, and `lag` hops and a fraction.
        let index = self.filled;
        let beside = self.hop * BESIDE / 64;
        let (column, earlier) = if index >= beside { (index - beside, 0) } else { (index + self.hop - beside, 1) };
        let ago = &self.past[index][self.newest + 1..][..HOPS];
        let ago_beside = &self.past[column][self.newest + 1 + earlier..][..HOPS];
        for hops in 0..HOPS {
            self.on_grid[hops] += self.part * (high_passed * ago[hops] - self.on_grid[hops]);
            self.beside[hops] += self.part * (high_passed * ago_beside[hops] - self.beside[hops]);
        }
        self.power += self.part * (high_passed * high_passed - self.power);
        self.past[index][self.newest] = high_passed;
        self.past[index][self.newest + ROWS] = high_passed;
        self.energy += high_passed * high_passed;
        self.filled += 1;
        if self.filled == self.hop {
            self.newest = (self.newest + ROWS - 1) % ROWS;
            self.update_share();
        }
    }

    /// Strength of repetition with the hops, and with nothing else: up to 1.
    fn strength(&self) -> f64 {
        let most = |means: &[f64; HOPS], size: fn(f64) -> f64| means.iter().fold(0.0f64, |most, x| most.max(size(*x)));
        (most(&self.on_grid, |x| x) - most(&self.beside, f64::abs)) / self.power
    }

    /// Updates the share, once per hop. Buzz at the tolerated level leaves it unchanged, so that it settles where the
    /// buzz just ends.
    fn update_share(&mut self) {
        let power = std::mem::take(&mut self.energy) / self.hop as f64;
        self.filled = 0;
        if self.power < SILENCE {
            self.forget();
        }
        let tells = power > SILENT_PART * self.power && self.power > 0.0;
        let strength = if tells { self.strength() } else { 0.0 };
        let step = if strength > TOLERATED {
            -self.fall * ((strength - TOLERATED) / SPAN).min(1.0)
        } else {
            self.rise * (1.0 - strength / TOLERATED).min(1.0)
        };
        self.share = (self.share + step).clamp(0.0, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::White;

    const RATE_HZ: f64 = 44_100.0;
    const HOP: usize = 64;

    /// Noise that falls as fire does, seconds of it; of `repeats`, that part repeats every `period` samples.
    fn fire(seed: u32, seconds: f64, repeats: f64, period: usize) -> Vec<f64> {
        let (fresh, again) = (White::new(seed, 1), White::new(seed, 2));
        let mut last = 0.0;
        (0..(seconds * RATE_HZ) as usize)
            .map(|n| {
                last = 0.98 * last
                    + (1.0 - repeats) * fresh.sample_at(n as i64)
                    + repeats * again.sample_at((n % period) as i64);
                0.05 * last
            })
            .collect()
    }

    /// The share after every hop.
    fn follow(buzz: &mut Buzz, signal: &[f64]) -> Vec<f64> {
        let hop = |hop: &[f64]| {
            hop.iter().for_each(|x| buzz.push(*x));
            buzz.share()
        };
        signal.chunks_exact(HOP).map(hop).collect()
    }

    fn least(shares: &[f64]) -> f64 {
        shares.iter().fold(1.0f64, |least, share| least.min(*share))
    }

    #[test]
    fn repeats_of_one_and_of_several_hops_are_found_within_seconds() {
        for hops in [1, 2, 3, 6, 12] {
            let mut buzz = Buzz::new(HOP, RATE_HZ);
            let shares = follow(&mut buzz, &fire(1, 3.0, 0.6, hops * HOP));
            assert!(*shares.last().unwrap() < 0.1, "{hops} hops: {:?}", shares.last());
            assert!(shares[(0.3 * RATE_HZ) as usize / HOP] > 0.5, "{hops} hops: it takes about a second");
        }
    }

    #[test]
    fn noise_tones_and_repeats_beside_the_grid_are_no_buzz() {
        let tone = |hz: f64| -> Vec<f64> {
            let noise = fire(2, 4.0, 0.0, 1);
            let angle = |n: usize| 2.0 * std::f64::consts::PI * hz * n as f64 / RATE_HZ;
            noise.iter().enumerate().map(|(n, x)| x + 0.3 * angle(n).sin()).collect()
        };
        let others =
            [fire(3, 8.0, 0.0, 1), tone(900.0), tone(1234.5), tone(5000.0), fire(4, 4.0, 0.6, 87), vec![0.0; 100_000]];
        for (number, signal) in others.iter().enumerate() {
            let shares = follow(&mut Buzz::new(HOP, RATE_HZ), signal);
            // Until all lags have heard it, a tone that begins is like a repeat.
            let (begun, rest) = shares.split_at((0.4 * RATE_HZ) as usize / HOP);
            assert!(least(begun) > 0.75, "signal {number}: {}", least(begun));
            assert!(rest.is_sorted(), "signal {number} falls: {}", least(rest));
        }
    }

    #[test]
    fn the_share_moves_smoothly_and_comes_back_slowly() {
        let mut buzz = Buzz::new(HOP, RATE_HZ);
        let mut shares = follow(&mut buzz, &fire(5, 3.0, 0.7, 3 * HOP));
        let calm = shares.len();
        shares.extend(follow(&mut buzz, &fire(6, 26.0, 0.0, 1)));
        let hop_s = HOP as f64 / RATE_HZ;
        let fastest = shares.windows(2).map(|x| (x[1] - x[0]).abs()).fold(0.0, f64::max);
        assert!(fastest <= 1.001 * hop_s / FALL_S, "{fastest}");
        assert!(shares[calm - 1] < 0.05, "{}", shares[calm - 1]);
        let after = |seconds: f64| shares[calm + (seconds / hop_s) as usize];
        assert!(after(6.0) < 0.4 && after(6.0) > 0.1, "{}", after(6.0));
        assert_eq!(after(25.9), 1.0);
    }

    #[test]
    fn silence_is_no_buzz_however_it_was_before() {
        let mut buzz = Buzz::new(HOP, RATE_HZ);
        let buzzing = *follow(&mut buzz, &fire(7, 3.0, 0.7, HOP)).last().unwrap();
        let shares = follow(&mut buzz, &vec![0.0; 40 * RATE_HZ as usize]);
        assert!(shares[0] >= buzzing && *shares.last().unwrap() == 1.0);
        assert!(least(&follow(&mut buzz, &fire(8, 1.0, 0.0, 1))) > 0.9);
    }

    #[test]
    fn reset_forgets() {
        let (noise, mut used) = (fire(9, 2.0, 0.5, HOP), Buzz::new(HOP, RATE_HZ));
        let fresh = follow(&mut used, &noise);
        assert!(least(&fresh) < 0.5);
        used.push(0.3);
        used.reset();
        assert_eq!(follow(&mut used, &noise), fresh);
    }
}
