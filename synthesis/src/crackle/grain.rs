//! One crackle while it is played.

use super::event::{Crackles, Event, PADDING};
use super::source::{CrackleSource, Sources};

/// Largest number of channels of any bus: those of 7.1.2.
pub(super) const MOST_CHANNELS: usize = 10;
/// Sums are of integers in this unit, so that they do not depend on the order of additions: playback from one position
/// is the same bit for bit, whatever else sounded before. The unit lies 217 dB below full scale, and leaves room for
/// sums of 2^27 times full scale.
const UNIT: f64 = 1.0 / (1u64 << 36) as f64;
/// Corner in Hz of the tilt.
const TILT_HZ: f64 = 4000.0;

/// Playback settings of a crackle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Play {
    /// Source of its wave, and index of its event there.
    pub source: CrackleSource,
    pub event: usize,
    /// Fraction of a sample by which it is delayed.
    pub late: f64,
    /// Samples of its wave per sample.
    pub rate: f64,
    /// Gain factors below and above the tilt's corner, and from each sample to the next.
    pub low: f64,
    pub high: f64,
    pub decay: f64,
    /// Factors on the even and on the odd output channels.
    pub sides: [f64; 2],
}

/// A playing crackle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Grain {
    play: Play,
    is_on: bool,
    /// Position in its wave.
    at: f64,
    envelope: f64,
    /// The low-pass of the tilt, by channel of the wave.
    lows: [f64; MOST_CHANNELS],
}

/// The coefficient of the tilt's low-pass.
pub(super) fn tilt_step(sample_rate_hz: f64) -> f64 {
    1.0 - maths::exp(-2.0 * std::f64::consts::PI * TILT_HZ / sample_rate_hz)
}

impl Grain {
    /// Begins at the next sample.
    pub fn start(play: Play) -> Self {
        Self { is_on: true, at: -play.late, envelope: 1.0, lows: [0.0; MOST_CHANNELS], play }
    }

    /// Source of its wave.
    pub fn source(&self) -> CrackleSource {
        self.play.source
    }

    /// True while it sounds.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Adds the next samples to `sums`, by channel of the output.
    pub fn add(&mut self, sources: &Sources<'_>, tilt_step: f64, sums: &mut [&mut [i64]]) {
        let crackles = sources.crackles(self.play.source);
        let Some((crackles, event)) = crackles.and_then(|all| Some((all, all.events().get(self.play.event)?))) else {
            self.is_on = false;
            return;
        };
        let samples = sums.first().map_or(0, |sums| sums.len());
        let channels = crackles.channels().min(MOST_CHANNELS);
        for i in 0..samples {
            if self.at >= (event.len + 1) as f64 {
                self.is_on = false;
                return;
            }
            let samples_by_channel = self.sample(crackles, event, channels, tilt_step);
            let mean = samples_by_channel[..channels].iter().sum::<f64>() / channels as f64;
            let outputs = sums.len();
            for (output, sums) in sums.iter_mut().enumerate() {
                // As in texture: the same channel, the mean for one output, otherwise in turn.
                let sample = if outputs == 1 { mean } else { samples_by_channel[output % channels] };
                let side = if outputs == 2 { self.play.sides[output] } else { 1.0 };
                // The conversion saturates, and turns NaN into 0.
                sums[i] = sums[i].saturating_add((sample * side / UNIT) as i64);
            }
            self.at += self.play.rate;
            self.envelope *= self.play.decay;
        }
    }

    /// One sample of every channel of the wave.
    #[inline]
    fn sample(&mut self, crackles: &Crackles, event: &Event, channels: usize, tilt_step: f64) -> [f64; MOST_CHANNELS] {
        let position = self.at + PADDING as f64;
        let (whole, part) = (position as usize, position.fract());
        let weights = spline(part);
        let mut samples = [0.0; MOST_CHANNELS];
        for (channel, (sample, low)) in samples.iter_mut().zip(&mut self.lows).enumerate().take(channels) {
            let wave = &crackles.wave(event, channel)[whole - 1..whole + 3];
            let value = wave.iter().zip(weights).map(|(x, weight)| f64::from(*x) * weight).sum::<f64>();
            *low += tilt_step * (value - *low);
            *sample = self.envelope * (self.play.low * *low + self.play.high * (value - *low));
        }
        samples
    }
}

/// Weights of the cubic B-spline at the fraction `part` between the second and the third of four coefficients.
#[inline]
fn spline(part: f64) -> [f64; 4] {
    let rest = 1.0 - part;
    let (a, d) = (rest * rest * rest / 6.0, part * part * part / 6.0);
    let b = 2.0 / 3.0 - 0.5 * part * part * (2.0 - part);
    [a, b, 1.0 - a - b - d, d]
}

/// Value of a sum.
#[inline]
pub(super) fn value_of(sum: i64) -> f64 {
    sum as f64 * UNIT
}
