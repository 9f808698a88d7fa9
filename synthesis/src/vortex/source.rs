//! One source: its properties drawn from a seed, its position, and its sound at the end of the last hop.

use super::bank::DIRECTIONS;
use super::layout::MOST_CHANNELS;
use super::level::Blend;
use crate::controls::Flow;
use crate::dsp::White;

/// Number of hops in which a source fades out or in.
const FADE_HOPS: f32 = 4.0;

/// Sources change their identity in turn, within this many hops: together they would leave a gap.
const TURN_HOPS: i64 = 16;

/// Spread of the sources' paces. Flows have their own tones (eddies that shed in step, the recording box), which a
/// crowd at one pace would hum; a single source reads at the recorded pace.
const PACES: f64 = 0.12;

/// Numbers that a seed gives each source; not all are in use.
const STREAM: u32 = 0x0076_6f72;
const NUMBERS: i64 = 8;

/// Parameters that define a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Identity {
    pub seed: u32,
    pub flow: Flow,
}

/// Sound of a source at the edge of a hop.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Edge {
    pub blend: Blend,
    /// Gains by channel: direction and distance.
    pub gains: [f32; MOST_CHANNELS],
    /// Position: to the right, to the front and up, in m.
    pub position: [f64; 3],
    /// Presence as set by the source's motion.
    pub motion_presence: f64,
    /// Distance that delays, in m.
    pub distance_m: f64,
    /// True if that is the source's own distance by now.
    pub settled: bool,
}

/// One source.
#[derive(Debug, Clone, Default)]
pub(super) struct VortexSource {
    pub identity: Identity,
    /// Presence, 0-1, at the edge.
    pub presence: f32,
    /// Edge at the end of the last hop.
    pub edge: Edge,
    /// Index of its direction in the bank.
    pub direction: usize,
    /// Reading position in the period, 0-1.
    pub offset: f64,
    /// Position in a ball of radius 1.
    pub ball: [f64; 3],
    /// Deviation of its flow speed, -1..1.
    deviation: f32,
    /// Variation of its speed, and the logarithm of the factor.
    variation: f32,
    pub ln_deviation: f32,
    /// Reading speed as a multiple of the texture's pace.
    pub pace: f64,
}

impl VortexSource {
    /// Source number `index` of a seed.
    ///
    /// Offsets are drawn: evenly spaced ones would cancel at most frequencies of a period and add up at a few.
    pub fn new(index: usize, identity: Identity) -> Self {
        let white = White::new(identity.seed, STREAM);
        // Uniform in 0..1.
        let number = |which: i64| 0.5 + 0.5 * white.sample_at(NUMBERS * index as i64 + which) / 3f64.sqrt();
        // Directions go round, so that they are as equally many as can be.
        let turn = (white.sample_at(-1).to_bits() >> 8) as usize;
        let (height, azimuth) = (2.0 * number(0) - 1.0, std::f64::consts::TAU * number(1));
        let radius = maths::cbrt(number(2));
        let flat = radius * (1.0 - height * height).max(0.0).sqrt();
        Self {
            identity,
            presence: 0.0,
            edge: Edge::default(),
            direction: (index + turn) % DIRECTIONS,
            offset: number(4),
            ball: [flat * maths::cos(azimuth), flat * maths::sin(azimuth), radius * height],
            deviation: (2.0 * number(3) - 1.0) as f32,
            variation: 0.0,
            ln_deviation: 0.0,
            pace: if index == 0 { 1.0 } else { 1.0 + PACES * (2.0 * number(5) - 1.0) },
        }
    }

    /// Sets the variation of speeds (0-1).
    pub fn vary(&mut self, variation: f32) {
        if self.variation != variation {
            self.variation = variation;
            self.ln_deviation = maths::ln_1p(variation * self.deviation);
        }
    }

    /// Moves on by one hop towards being `wanted` as `identity`. Returns the presence at the hop's start.
    pub fn turn(&mut self, index: usize, hop: i64, wanted: bool, identity: Identity) -> f32 {
        let before = self.presence;
        let stays = wanted && self.identity == identity;
        // 7 has no factor in common with the number of hops, so all of them are used, and neighbours turn far apart.
        let mine = || (hop + index as i64 * 7).rem_euclid(TURN_HOPS) == 0;
        if before == 0.0 && wanted && !stays {
            *self = Self::new(index, identity);
            self.presence = 1.0 / FADE_HOPS;
        } else if stays {
            self.presence = (before + 1.0 / FADE_HOPS).min(1.0);
        } else if before < 1.0 || mine() {
            self.presence = (before - 1.0 / FADE_HOPS).max(0.0);
        }
        before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_neither_cancel_nor_add_up_at_any_frequency_of_the_period() {
        let identity = Identity { seed: 7, flow: Flow::Envelope };
        let sources: Vec<VortexSource> = (0..600).map(|index| VortexSource::new(index, identity)).collect();
        assert!(sources.iter().all(|source| source.ball.iter().map(|x| x * x).sum::<f64>() <= 1.0));
        for direction in 0..DIRECTIONS {
            let mine: Vec<&VortexSource> = sources.iter().filter(|source| source.direction == direction).collect();
            assert_eq!(mine.len(), 600 / DIRECTIONS);
            let power = |turns: u32| {
                let phases = mine.iter().map(|source| std::f64::consts::TAU * f64::from(turns) * source.offset);
                let (sin, cos) =
                    phases.map(f64::sin_cos).fold((0.0, 0.0), |sum, (sin, cos)| (sum.0 + sin, sum.1 + cos));
                (sin * sin + cos * cos) / mine.len() as f64
            };
            let powers: Vec<f64> = (1..4000).map(power).collect();
            // As of independent sources: exponentially distributed about 1.
            let below_median = powers.iter().filter(|power| **power < 2f64.ln()).count() as f64 / powers.len() as f64;
            let largest = powers.iter().fold(0.0f64, |largest, power| largest.max(*power));
            assert!((below_median - 0.5).abs() < 0.05 && largest < 20.0, "{direction}: {below_median} {largest}");
        }
    }

    #[test]
    fn a_source_changes_its_identity_only_while_it_is_silent() {
        let (one, two) = (Identity { seed: 1, flow: Flow::Envelope }, Identity { seed: 2, flow: Flow::Envelope });
        let mut source = VortexSource { presence: 1.0, ..VortexSource::new(3, one) };
        for hop in 0..64 {
            let before = source.clone();
            let at_start = source.turn(3, hop, true, two);
            assert_eq!(at_start, before.presence);
            assert!(source.identity == before.identity || before.presence == 0.0);
            assert!((source.presence - before.presence).abs() <= 1.0 / FADE_HOPS);
        }
        assert_eq!((source.identity, source.presence), (two, 1.0));
    }
}
