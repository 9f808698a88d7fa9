//! Mixing by eddies too small for the grid: local variation of the burn rate around its average.
//!
//! Fuel and air burn as fast as eddies mix them, which is the rate at which eddies dissipate (Magnussen & Hjertager
//! 1977, eddy dissipation). That rate is intermittent: its logarithm is normally distributed (Kolmogorov 1962), and
//! along a path of the gas it changes with the spectrum f^-2 of the inertial range (Tennekes & Lumley 1972, §8.5). All
//! of it is a function of position, time and seed, in metres and seconds: finer cells see the same eddies.

use super::parallel::wide;
use super::random::Random;

/// Number of waves that make up the mixing at one node.
const WAVES: usize = 24;

/// Most nodes along an axis; a wider box has coarser nodes.
const MOST_NODES: usize = 40;

/// Fluctuation of the mixing rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mixing {
    /// Standard deviation of the burn rate's logarithm, 0-3; 0 is even mixing.
    pub spread: f64,
    /// Size of the regions with equal mixing, in m, 1e-3 to 1e4.
    pub scale_m: f64,
    /// Slowest and fastest changes in Hz, 0.01 to 1000: above the slowest the spectrum falls as f^-2.
    pub slowest_hz: f64,
    /// See `slowest_hz`.
    pub fastest_hz: f64,
}

impl Mixing {
    /// Even and constant mixing.
    pub const EVEN: Self = Self { spread: 0.0, scale_m: 1.0, slowest_hz: 1.0, fastest_hz: 2.0 };
}

/// The burn rate's logarithm on nodes in the world, at one time.
#[derive(Debug)]
pub(crate) struct MixingField {
    mixing: Mixing,
    /// Distance between nodes in m.
    scale_m: f64,
    /// Number of the first node along each axis: its position divided by the scale.
    first: [i64; 3],
    counts: [usize; 3],
    waves: Vec<Waves>,
    values: Vec<f32>,
    /// Factor that makes the mean rate 1.
    offset: f32,
}

/// Noise of one node.
#[derive(Debug)]
struct Waves {
    frequency_hz: [f64; WAVES],
    /// Phase at time 0 in turns.
    turns: [f64; WAVES],
    amplitude: [f32; WAVES],
}

impl MixingField {
    /// Mixing in a box from `low_m` to `high_m`.
    pub fn new(mixing: Mixing, low_m: [f64; 3], high_m: [f64; 3], seed: u64) -> Self {
        let longest = (0..3).map(|axis| high_m[axis] - low_m[axis]).fold(0.0, f64::max);
        let scale_m = mixing.scale_m.max(longest / (MOST_NODES - 3) as f64);
        let first = low_m.map(|low| (low / scale_m).floor() as i64);
        let counts = std::array::from_fn(|axis| {
            let last = (high_m[axis] / scale_m).ceil() as i64;
            (last - first[axis]).clamp(1, MOST_NODES as i64) as usize + 1
        });
        let nodes = if mixing.spread > 0.0 { counts.iter().product() } else { 0 };
        let waves = (0..nodes).map(|node| {
            let position = [node / (counts[1] * counts[2]), node / counts[2] % counts[1], node % counts[2]];
            Waves::new(&mixing, std::array::from_fn(|axis| first[axis] + position[axis] as i64), seed)
        });
        let waves: Vec<_> = waves.collect();
        Self { mixing, scale_m, first, counts, values: vec![0.0; waves.len()], waves, offset: 0.0 }
    }

    /// Moves to a time at which everything burns `boost` times as fast as usual.
    pub fn advance(&mut self, time_s: f64, boost: f64) {
        let spread = self.mixing.spread;
        wide(|| {
            for (value, waves) in self.values.iter_mut().zip(&self.waves) {
                *value = spread as f32 * waves.value_at(time_s);
            }
        });
        self.offset = (maths::ln(boost.clamp(1e-3, 1e3)) - 0.5 * spread * spread) as f32;
    }

    /// Burn rate at a position in m, relative to the average.
    #[inline(always)]
    pub fn factor(&self, place_m: [f64; 3]) -> f32 {
        if self.values.is_empty() {
            return maths::exp(self.offset);
        }
        let brackets = std::array::from_fn(|axis| {
            let at =
                (place_m[axis] / self.scale_m - self.first[axis] as f64).clamp(0.0, (self.counts[axis] - 1) as f64);
            let low = (at as usize).min(self.counts[axis] - 2);
            let share = (at - low as f64) as f32;
            // Without a kink at the nodes.
            (low, share * share * (3.0 - 2.0 * share))
        });
        maths::exp(self.offset + self.between(brackets))
    }

    #[inline(always)]
    fn between(&self, [x, y, z]: [(usize, f32); 3]) -> f32 {
        let [_, ny, nz] = self.counts;
        let along_z = |i: usize, j: usize| {
            let at = (i * ny + j) * nz + z.0;
            self.values[at] + z.1 * (self.values[at + 1] - self.values[at])
        };
        let along_y = |i: usize| {
            let (low, high) = (along_z(i, y.0), along_z(i, y.0 + 1));
            low + y.1 * (high - low)
        };
        let (low, high) = (along_y(x.0), along_y(x.0 + 1));
        low + x.1 * (high - low)
    }
}

impl Waves {
    /// The waves of a node, of rms 1 together: one in each equal part of the band's logarithm.
    fn new(mixing: &Mixing, node: [i64; 3], seed: u64) -> Self {
        // Each coordinate is mixed in separately, so that no two nodes share their draws.
        let number = node.iter().fold(seed, |number, at| Random::new(number ^ (*at as u64)).bits());
        let mut random = Random::new(number);
        let band = mixing.fastest_hz / mixing.slowest_hz;
        let frequency_hz: [f64; WAVES] = std::array::from_fn(|wave| {
            mixing.slowest_hz * maths::pow(band, (wave as f64 + random.uniform()) / WAVES as f64)
        });
        // A density of f^-2, times the width f of a part of the logarithm.
        let amplitude = frequency_hz.map(|frequency_hz| maths::pow(frequency_hz, -0.5));
        let rms = amplitude.iter().map(|a| 0.5 * a * a).sum::<f64>().sqrt();
        let turns = std::array::from_fn(|_| random.uniform());
        Self { frequency_hz, turns, amplitude: amplitude.map(|a| (a / rms) as f32) }
    }

    #[inline(always)]
    fn value_at(&self, time_s: f64) -> f32 {
        let mut sum = 0.0;
        for wave in 0..WAVES {
            let turns = self.frequency_hz[wave] * time_s + self.turns[wave];
            sum += self.amplitude[wave] * cosine((turns - turns.round()) as f32);
        }
        sum
    }
}

/// Cosine of -0.5 to 0.5 turns, to within 1e-4: Taylor's polynomial, which is continuous where the turns wrap round.
#[inline(always)]
fn cosine(turns: f32) -> f32 {
    let square = maths::square(std::f32::consts::TAU * turns);
    const TERMS: [f32; 6] =
        [-1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0, 1.0 / 479_001_600.0];
    1.0 + square * TERMS.iter().rev().fold(0.0, |sum, term| sum * square + term)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNEVEN: Mixing = Mixing { spread: 0.8, scale_m: 0.2, slowest_hz: 5.0, fastest_hz: 170.0 };

    fn field(low_m: [f64; 3], seed: u64) -> MixingField {
        MixingField::new(UNEVEN, low_m, [1.0, 1.0, 2.0], seed)
    }

    #[test]
    fn mean_rate_and_spread_are_as_asked_for() {
        let mut field = field([-1.0, -1.0, 0.0], 1);
        let mut logarithms = vec![];
        for step in 0..200 {
            field.advance(f64::from(step) * 0.037, 1.0);
            logarithms.extend(
                (0..300).map(|n| f64::from(field.factor([0.2 * f64::from(n % 5), 0.0, 0.2 * f64::from(n % 7)]).ln())),
            );
        }
        let mean = |of: &dyn Fn(f64) -> f64| logarithms.iter().map(|x| of(*x)).sum::<f64>() / logarithms.len() as f64;
        let (middle, rate) = (mean(&|x| x), mean(&f64::exp));
        let spread = mean(&|x| (x - middle).powi(2)).sqrt();
        assert!((rate - 1.0).abs() < 0.05 && (spread - 0.8).abs() < 0.05, "rate {rate}, spread {spread}");
    }

    /// Another box, as for another resolution, contains the same eddies.
    #[test]
    fn mixing_belongs_to_the_world() {
        let (mut one, mut other) = (field([-1.0, -1.0, 0.0], 1), field([-0.93, -1.31, 0.02], 1));
        let mut elsewhere = field([-1.0, -1.0, 0.0], 2);
        let position = [0.33, -0.41, 0.77];
        for field in [&mut one, &mut other, &mut elsewhere] {
            field.advance(1.7, 1.0);
        }
        assert_eq!(one.factor(position), other.factor(position));
        assert_ne!(one.factor(position), elsewhere.factor(position), "the seed changes nothing");
        assert_ne!(one.factor(position), one.factor([0.93, -0.41, 0.77]), "all places are alike");
    }

    #[test]
    fn the_cosine_is_near_enough() {
        for n in -500..=500 {
            let turns = n as f32 / 1000.0;
            assert!((cosine(turns) - (std::f32::consts::TAU * turns).cos()).abs() < 2e-4, "{turns}");
        }
    }

    #[test]
    fn mixing_is_smooth_across_nodes() {
        let mut field = field([-1.0, -1.0, 0.0], 1);
        field.advance(0.3, 1.0);
        let along: Vec<f32> = (0..2000).map(|n| field.factor([-1.0 + 0.001 * f64::from(n), 0.1, 0.5])).collect();
        let largest = along.windows(2).map(|w| (w[1] / w[0] - 1.0).abs()).fold(0.0, f32::max);
        assert!(largest < 0.05, "a jump of {largest}");
    }

    #[test]
    fn even_mixing_is_boosted_alike_everywhere() {
        let mut even = MixingField::new(Mixing::EVEN, [0.0; 3], [1.0; 3], 1);
        even.advance(3.0, 2.5);
        assert!((even.factor([0.3, 0.9, 7.0]) - 2.5).abs() < 1e-6);
        let mut uneven = field([-1.0, -1.0, 0.0], 1);
        uneven.advance(3.0, 1.0);
        let usual = uneven.factor([0.1; 3]);
        uneven.advance(3.0, 2.0);
        assert!((uneven.factor([0.1; 3]) / usual - 2.0).abs() < 1e-5);
    }
}
