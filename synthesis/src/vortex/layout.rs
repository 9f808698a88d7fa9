//! The receivers: each source's contribution to each channel.
//!
//! All receivers are at the listener's position and differ only in direction. Spaced receivers would get every source
//! at two times: 20 cm are 0.6 ms. In a fold-down to mono, the first notch would be at 860 Hz, in the middle of the
//! whoosh, and sources spread around the listener would still leave 3 dB more below than above. Coincident receivers
//! fold down flat, and one read of a source's sound serves all channels. Channels still differ, because each gets its
//! own sources, which differ in distance and so in time.

use std::f64::consts::FRAC_PI_2;

use crate::error::{Error, in_range};

/// Most channels of a layout.
pub const MOST_CHANNELS: usize = 10;

/// A direction this far beyond a loudspeaker's is that.
const ROUNDING: f64 = 1e-12;

/// The loudspeakers of the output, in the order of their channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SpeakerLayout {
    /// One channel for everything.
    Mono,
    /// Left and right at 30°.
    #[default]
    Stereo,
    /// Left, right, centre.
    Front3,
    /// Left, right, rear left and right at 135°.
    Quad,
    /// Left, right, centre, surround left and right at 110°.
    Surround50,
    /// Left, right, centre, low-frequency effects (silent), surround left and right at 110°.
    Surround51,
    /// Left, right, centre, rear left and right at 135°, side left and right at 90°.
    Surround70,
    /// As 7.0, with low-frequency effects (silent) after the centre.
    Surround71,
    /// As 7.0, with top left and right after the sides.
    Surround702,
    /// As 7.1, with top left and right after the sides.
    Surround712,
}

/// Azimuth of a loudspeaker in degrees, positive to the right.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Speaker {
    Ring(f64),
    Top(f64),
    Silent,
}

const LEFT: Speaker = Speaker::Ring(-30.0);
const RIGHT: Speaker = Speaker::Ring(30.0);
const CENTER: Speaker = Speaker::Ring(0.0);
const SURROUND: [Speaker; 2] = [Speaker::Ring(-110.0), Speaker::Ring(110.0)];
const REAR: [Speaker; 2] = [Speaker::Ring(-135.0), Speaker::Ring(135.0)];
const SIDE: [Speaker; 2] = [Speaker::Ring(-90.0), Speaker::Ring(90.0)];
const TOP: [Speaker; 2] = [Speaker::Top(-90.0), Speaker::Top(90.0)];

impl SpeakerLayout {
    /// The layout with this number of channels, 1-10.
    pub fn of_channels(channels: usize) -> Result<Self, Error> {
        in_range("number of channels", channels as f64, 1.0, MOST_CHANNELS as f64)?;
        Ok([
            Self::Mono,
            Self::Stereo,
            Self::Front3,
            Self::Quad,
            Self::Surround50,
            Self::Surround51,
            Self::Surround70,
            Self::Surround71,
            Self::Surround702,
            Self::Surround712,
        ][channels - 1])
    }

    /// Number of channels.
    pub fn channels(self) -> usize {
        self.speakers().len()
    }

    /// The LFE channel, to which no source is panned.
    pub fn low_frequency_effects(self) -> Option<usize> {
        self.speakers().iter().position(|speaker| matches!(speaker, Speaker::Silent))
    }

    /// Azimuths of the loudspeakers around the listener, in degrees, positive to the right.
    pub fn azimuths_deg(self) -> impl Iterator<Item = f64> {
        self.speakers().iter().filter_map(|speaker| match speaker {
            Speaker::Ring(azimuth_deg) => Some(*azimuth_deg),
            Speaker::Top(_) | Speaker::Silent => None,
        })
    }

    fn speakers(self) -> &'static [Speaker] {
        match self {
            Self::Mono => &[CENTER],
            Self::Stereo => &[LEFT, RIGHT],
            Self::Front3 => &[LEFT, RIGHT, CENTER],
            Self::Quad => &[LEFT, RIGHT, REAR[0], REAR[1]],
            Self::Surround50 => &[LEFT, RIGHT, CENTER, SURROUND[0], SURROUND[1]],
            Self::Surround51 => &[LEFT, RIGHT, CENTER, Speaker::Silent, SURROUND[0], SURROUND[1]],
            Self::Surround70 => &[LEFT, RIGHT, CENTER, REAR[0], REAR[1], SIDE[0], SIDE[1]],
            Self::Surround71 => &[LEFT, RIGHT, CENTER, Speaker::Silent, REAR[0], REAR[1], SIDE[0], SIDE[1]],
            Self::Surround702 => &[LEFT, RIGHT, CENTER, REAR[0], REAR[1], SIDE[0], SIDE[1], TOP[0], TOP[1]],
            Self::Surround712 => {
                &[LEFT, RIGHT, CENTER, Speaker::Silent, REAR[0], REAR[1], SIDE[0], SIDE[1], TOP[0], TOP[1]]
            }
        }
    }
}

/// Two loudspeakers between which sources may be panned.
#[derive(Debug)]
struct SpeakerPair {
    channels: [usize; 2],
    /// Conversion from right and front to the loudspeakers' gains, without normalisation.
    inverse: [[f64; 2]; 2],
}

/// A layout's gains by direction: those of the two loudspeakers around it, whose sum of vectors points there (Pulkki
/// 1997, "Virtual sound source positioning using vector base amplitude panning").
#[derive(Debug)]
pub(super) struct Panner {
    /// Pairs by rising azimuth; none with a single loudspeaker.
    pairs: Vec<SpeakerPair>,
    /// Channels of the first and of the last loudspeaker.
    ends: [usize; 2],
    /// Channels of top left and right.
    top: Option<[usize; 2]>,
    /// True if there is no loudspeaker behind the listener.
    front_only: bool,
}

impl Panner {
    pub fn new(layout: SpeakerLayout) -> Self {
        let speakers = layout.speakers();
        let ring = speakers.iter().enumerate().filter_map(|(channel, speaker)| match speaker {
            Speaker::Ring(azimuth_deg) => Some((azimuth_deg.to_radians(), channel)),
            _ => None,
        });
        let mut ring: Vec<(f64, usize)> = ring.collect();
        ring.sort_by(|a, b| a.0.total_cmp(&b.0));
        let top = |right: bool| {
            speakers.iter().position(|speaker| matches!(speaker, Speaker::Top(azimuth) if (*azimuth > 0.0) == right))
        };
        let front_only = ring.iter().all(|(azimuth, _)| azimuth.abs() < FRAC_PI_2);
        let after = ring.iter().skip(1).chain(ring.iter().take(usize::from(!front_only)));
        Self {
            top: top(false).zip(top(true)).map(|(left, right)| [left, right]),
            pairs: ring.iter().zip(after).map(|(from, to)| SpeakerPair::new(*from, *to)).collect(),
            ends: [ring[0].1, ring[ring.len() - 1].1],
            front_only,
        }
    }

    /// Gains by channel for a source at `[right, front, up]`; their squares sum to 1.
    pub fn gains(&self, [right, front, up]: [f64; 3]) -> [f32; MOST_CHANNELS] {
        let mut gains = [0.0; MOST_CHANNELS];
        if self.pairs.is_empty() {
            gains[self.ends[0]] = 1.0;
            return gains;
        }
        let flat_m = (right * right + front * front).sqrt();
        let [right, front] = if flat_m > 0.0 { [right / flat_m, front / flat_m] } else { [0.0, 1.0] };
        // Directions below the horizon are heard at the horizon.
        let (above, level) = match (up * up + flat_m * flat_m).sqrt() {
            distance_m if distance_m > 0.0 && up > 0.0 && self.top.is_some() => (up / distance_m, flat_m / distance_m),
            _ => (0.0, 1.0),
        };
        if let Some([left_top, right_top]) = self.top.filter(|_| above > 0.0) {
            let part = 0.5 * (1.0 + right * level);
            gains[left_top] = (above * (1.0 - part).max(0.0).sqrt()) as f32;
            gains[right_top] = (above * part.sqrt()) as f32;
        }
        let ([from, to], [a, b]) = self.ring(right, front);
        gains[from] += (level * a) as f32;
        gains[to] += (level * b) as f32;
        gains
    }

    /// The channels of the loudspeakers around a direction, and their gains.
    fn ring(&self, right: f64, front: f64) -> ([usize; 2], [f64; 2]) {
        let front = if self.front_only { front.abs() } else { front };
        for pair in &self.pairs {
            let [a, b] = pair.inverse.map(|[x, y]| x * right + y * front);
            if a >= -ROUNDING && b >= -ROUNDING {
                let (a, b) = (a.max(0.0), b.max(0.0));
                let norm = 1.0 / (a * a + b * b).sqrt();
                return (pair.channels, [norm * a, norm * b]);
            }
        }
        (self.ends, if right < 0.0 { [1.0, 0.0] } else { [0.0, 1.0] })
    }
}

impl SpeakerPair {
    /// A pair from azimuths in radians and channels. The angle between the two is less than half a turn.
    fn new((from, from_channel): (f64, usize), (to, to_channel): (f64, usize)) -> Self {
        let ((from_x, from_y), (to_x, to_y)) = (maths::sin_cos(from), maths::sin_cos(to));
        let determinant = from_x * to_y - from_y * to_x;
        let inverse = [[to_y / determinant, -to_x / determinant], [-from_y / determinant, from_x / determinant]];
        Self { channels: [from_channel, to_channel], inverse }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(azimuth_deg: f64, elevation_deg: f64) -> [f64; 3] {
        let ((sin_a, cos_a), (sin_e, cos_e)) =
            (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
        [3.0 * sin_a * cos_e, 3.0 * cos_a * cos_e, 3.0 * sin_e]
    }

    #[test]
    fn power_is_kept_in_every_direction_and_gains_have_no_jumps() {
        for channels in 1..=MOST_CHANNELS {
            let layout = SpeakerLayout::of_channels(channels).expect("a layout");
            assert_eq!(layout.channels(), channels);
            let panner = Panner::new(layout);
            for elevation in [-40.0, 0.0, 30.0, 90.0] {
                let mut before = panner.gains(direction(-180.0, elevation));
                for tenth in -1800..=1800 {
                    let gains = panner.gains(direction(f64::from(tenth) / 10.0, elevation));
                    let power: f32 = gains.iter().map(|gain| gain * gain).sum();
                    assert!((power - 1.0).abs() < 1e-5, "{layout:?} at {tenth}: {power}");
                    let step = gains.iter().zip(before).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                    assert!(step < 0.02, "{layout:?} at {tenth}: {step}");
                    before = gains;
                }
            }
        }
        assert!(SpeakerLayout::of_channels(0).is_err() && SpeakerLayout::of_channels(11).is_err());
    }

    #[test]
    fn every_loudspeaker_plays_alone_in_its_own_direction() {
        for channels in 2..=MOST_CHANNELS {
            let layout = SpeakerLayout::of_channels(channels).expect("a layout");
            let panner = Panner::new(layout);
            for (channel, speaker) in layout.speakers().iter().enumerate() {
                match speaker {
                    Speaker::Ring(azimuth) => {
                        assert!(panner.gains(direction(*azimuth, 0.0))[channel] > 0.9999, "{layout:?} {channel}");
                    }
                    Speaker::Top(_) => assert!(panner.gains([0.0, 0.0, 1.0])[channel] > 0.7, "{layout:?}"),
                    Speaker::Silent => {
                        assert!((0..360).all(|a| panner.gains(direction(f64::from(a), 20.0))[channel] == 0.0));
                    }
                }
            }
        }
    }
}
