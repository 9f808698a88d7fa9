//! The receivers: what of a source reaches which channel.
//!
//! All receivers stand where the listener is and differ by direction alone. Spaced ones would get every source at two
//! times, and 20 cm are 0.6 ms: in a fold-down to mono the first notch stands at 860 Hz, in the middle of the whoosh, and
//! sources spread about the listener still leave 3 dB more below than above. Coincident ones fold down flat, and one
//! read of a source's sound serves all channels. Sources still differ in distance, hence in time, and that is what makes
//! channels unlike: each gets sources of its own.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::error::{Error, in_range};

/// Most channels of a layout.
pub const MOST_CHANNELS: usize = 10;

/// The loudspeakers of the output, in the order of their channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layout {
    /// One channel that gets everything.
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

impl Layout {
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

    /// Its number of channels.
    pub fn channels(self) -> usize {
        self.speakers().len()
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

/// A layout's gains by direction.
#[derive(Debug)]
pub(super) struct Panner {
    /// Azimuths in radians and channels, by rising azimuth.
    ring: Vec<(f64, usize)>,
    /// Channels of top left and right.
    top: Option<[usize; 2]>,
    /// Whether no loudspeaker stands behind the listener.
    front_only: bool,
}

impl Panner {
    pub fn new(layout: Layout) -> Self {
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
        Self {
            top: top(false).zip(top(true)).map(|(left, right)| [left, right]),
            front_only: ring.iter().all(|(azimuth, _)| azimuth.abs() < FRAC_PI_2),
            ring,
        }
    }

    /// Gains by channel for a source at `[right, front, up]`; their squares sum to 1.
    pub fn gains(&self, [right, front, up]: [f64; 3]) -> [f32; MOST_CHANNELS] {
        let mut gains = [0.0; MOST_CHANNELS];
        if let [(_, only)] = self.ring[..] {
            gains[only] = 1.0;
            return gains;
        }
        let flat = right.hypot(front);
        let azimuth = if flat > 0.0 { right.atan2(front) } else { 0.0 };
        // What is below the horizon is heard at it.
        let (above, level) = match up.hypot(flat) {
            distance if distance > 0.0 && up > 0.0 && self.top.is_some() => (up / distance, flat / distance),
            _ => (0.0, 1.0),
        };
        if let Some([left_top, right_top]) = self.top.filter(|_| above > 0.0) {
            let part = 0.5 * (1.0 + azimuth.sin() * level);
            gains[left_top] = (above * (FRAC_PI_2 * part).cos()) as f32;
            gains[right_top] = (above * (FRAC_PI_2 * part).sin()) as f32;
        }
        let (from, to, part) = self.pair(azimuth);
        let (sin, cos) = (FRAC_PI_2 * part).sin_cos();
        gains[from] += (level * cos) as f32;
        gains[to] += (level * sin) as f32;
        gains
    }

    /// The channels of the loudspeakers around an azimuth, and how far it is from one to the other (0-1).
    fn pair(&self, azimuth: f64) -> (usize, usize, f64) {
        let (first, last) = (self.ring[0], self.ring[self.ring.len() - 1]);
        let azimuth = if self.front_only {
            let folded = if azimuth.abs() > FRAC_PI_2 { azimuth.signum() * PI - azimuth } else { azimuth };
            folded.clamp(first.0, last.0)
        } else {
            azimuth
        };
        let above = self.ring.partition_point(|(at, _)| *at <= azimuth);
        let ((from, a), (to, b)) = match above {
            0 => ((last.0 - 2.0 * PI, last.1), first),
            above if above == self.ring.len() => (last, (first.0 + 2.0 * PI, first.1)),
            above => (self.ring[above - 1], self.ring[above]),
        };
        (a, b, ((azimuth - from) / (to - from)).clamp(0.0, 1.0))
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
            let layout = Layout::of_channels(channels).expect("a layout");
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
        assert!(Layout::of_channels(0).is_err() && Layout::of_channels(11).is_err());
    }

    #[test]
    fn every_loudspeaker_plays_alone_in_its_own_direction() {
        for channels in 2..=MOST_CHANNELS {
            let layout = Layout::of_channels(channels).expect("a layout");
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
