//! A signal's loudness, in frames of two thirds of a millisecond.

/// Length of a frame in seconds: 32 samples at 44.1 kHz.
const FRAME_S: f64 = 32.0 / 44_100.0;

/// Samples in a frame at `sample_rate_hz`.
pub fn frame_samples(sample_rate_hz: f64) -> usize {
    (FRAME_S * sample_rate_hz).round().max(1.0) as usize
}

/// Weights that combine the powers of the frames around an instant into its loudness: two exponentials back to back,
/// with the future one faded out where the look-ahead ends.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// The oldest frame's first.
    weights: Vec<f64>,
    /// Number of frames after the instant that are known when its loudness is determined; negative if even its own
    /// frame is not.
    look_ahead: i64,
}

/// Time constants of the past after which a frame no longer counts: -39 dB.
const PAST_SPAN: f64 = 9.0;

impl Kernel {
    /// A kernel over frames at `frame_rate_hz`. Power from the future counts exp(-t / `future_s`), from the past exp(-t
    /// / `past_s`).
    pub fn new(frame_rate_hz: f64, look_ahead: i64, future_s: f64, past_s: f64) -> Self {
        let future = look_ahead.max(0);
        let past = (PAST_SPAN * past_s * frame_rate_hz).ceil() as i64;
        let weight = |frame: i64| {
            let time_s = frame as f64 / frame_rate_hz;
            if frame > 0 {
                let end = std::f64::consts::FRAC_PI_2 * frame as f64 / (future + 1) as f64;
                maths::exp(-time_s / future_s) * maths::square(maths::cos(end))
            } else {
                maths::exp(time_s / past_s)
            }
        };
        let mut weights: Vec<f64> = (-past..=future).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|x| *x /= sum);
        Self { weights, look_ahead }
    }

    /// Frames between an instant and the last one of its future.
    pub fn look_ahead(&self) -> i64 {
        self.look_ahead
    }

    /// Frames that it spans.
    pub fn span(&self) -> usize {
        self.weights.len()
    }

    /// The loudness at the instant that the newest of `powers` is the last to count for; `powers` are as
    /// many as the kernel is long, oldest first.
    pub fn loudness(&self, powers: &[f64]) -> f64 {
        self.weights.iter().zip(powers).map(|(weight, power)| weight * power).sum::<f64>().max(0.0).sqrt()
    }
}

/// Weights of an envelope's frames about the one that counts: enough to smooth the steps of frames.
const NEIGHBOURS: [f64; 3] = [0.25, 0.5, 0.25];

impl Kernel {
    /// The amplitude of an envelope at the same instant, where the envelope is `delay_frames` late: read from later
    /// frames, as far as they are known.
    pub fn amplitude(&self, powers: &[f64], delay_frames: i64) -> f64 {
        let newest = powers.len() as i64 - 1;
        let middle = (newest - self.look_ahead + delay_frames).clamp(1, newest - 1) as usize;
        let power: f64 = NEIGHBOURS.iter().zip(&powers[middle - 1..]).map(|(weight, power)| weight * power).sum();
        power.max(0.0).sqrt()
    }
}

/// The most recent values of a quantity given once per frame, interpolated between frames.
#[derive(Debug, Clone)]
pub struct FrameHistory {
    values: Vec<f64>,
    frame_samples: i64,
    /// Value before the first one.
    initial: f64,
    /// Number of frames since reset.
    count: i64,
}

impl FrameHistory {
    /// History of the last `frames` values; returns `initial` before the first.
    pub fn new(frames: usize, frame_samples: usize, initial: f64) -> Self {
        Self { values: vec![initial; frames.max(2)], frame_samples: frame_samples as i64, initial, count: 0 }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.values.fill(self.initial);
        self.count = 0;
    }

    /// Appends the next frame's value.
    pub fn push(&mut self, value: f64) {
        let length = self.values.len() as i64;
        self.values[(self.count % length) as usize] = value;
        self.count += 1;
    }

    /// The frames' centres between which `sample` and the following samples lie; sample 0 is the first of frame 0.
    pub fn positions(&self, sample: i64) -> FramePositions {
        // In half samples, since the centre of a frame may lie between two samples.
        let position = 2 * sample - (self.frame_samples - 1);
        let span = 2 * self.frame_samples;
        FramePositions { frame: position.div_euclid(span), into: position.rem_euclid(span), span }
    }

    /// The most recent value.
    pub fn newest(&self) -> f64 {
        self.frame(self.count - 1)
    }

    /// The value of a frame: the initial value before the first one, the most recent value after the last.
    pub fn frame(&self, frame: i64) -> f64 {
        if frame < 0 {
            return self.initial;
        }
        let length = self.values.len() as i64;
        self.values[(frame.min(self.count - 1).max(0) % length) as usize]
    }
}

/// The frames' centres between which consecutive samples lie: for each sample the frame before it, and the fraction 0-1
/// after that frame's centre.
#[derive(Debug, Clone, Copy)]
pub struct FramePositions {
    frame: i64,
    /// Half samples since that frame's centre, out of `span` from one centre to the next.
    into: i64,
    span: i64,
}

impl FramePositions {
    /// The same position, `frames` frames later.
    pub fn later(self, frames: i64) -> Self {
        Self { frame: self.frame + frames, ..self }
    }

    /// Position of the next sample.
    #[inline]
    pub fn step(&mut self) -> (i64, f64) {
        let position = (self.frame, self.into as f64 / self.span as f64);
        self.into += 2;
        if self.into >= self.span {
            self.into -= self.span;
            self.frame += 1;
        }
        position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_tell_the_level_of_a_steady_signal() {
        for (look_ahead, future_s, past_s) in [(27, 0.02, 0.02), (60, 0.06, 0.02), (0, 0.02, 0.1), (-3, 0.02, 0.02)] {
            let kernel = Kernel::new(1378.0, look_ahead, future_s, past_s);
            let powers = vec![0.25; kernel.span()];
            assert!((kernel.loudness(&powers) - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn an_amplitude_is_read_later_by_its_delay_but_no_later_than_is_known() {
        let kernel = Kernel::new(1378.0, 27, 0.02, 0.02);
        let powers: Vec<f64> = (0..kernel.span()).map(|i| (i as f64 - 100.0).powi(2)).collect();
        let newest = powers.len() as i64 - 1;
        for (delay, frame) in [(0, newest - 27), (11, newest - 16), (100, newest - 1)] {
            let found = kernel.amplitude(&powers, delay);
            assert!((found - (frame as f64 - 100.0)).abs() < 0.01, "{delay}: {found}");
        }
    }

    #[test]
    fn the_future_fades_in() {
        let kernel = Kernel::new(1378.0, 27, 0.02, 0.02);
        let mut powers = vec![0.0; kernel.span()];
        let mut before = 0.0;
        for i in (0..kernel.span()).rev() {
            powers[i] = 1.0;
            let now = kernel.loudness(&powers);
            assert!(now > before, "{i}: {now} after {before}");
            before = now;
        }
        let last = kernel.span() - 1;
        assert!(kernel.weights[last] < 0.01 * kernel.weights[last - 27]);
    }

    #[test]
    fn tracks_tell_between_which_frames_a_sample_lies() {
        let mut track = FrameHistory::new(8, 4, 0.0);
        for value in 0..6 {
            track.push(f64::from(value));
        }
        // Frame 3 spans samples 12-15, its middle is 13.5.
        let position = |sample| track.positions(sample).step();
        assert_eq!([position(13), position(14), position(-1)], [(2, 0.875), (3, 0.125), (-1, 0.375)]);
        let mut positions = track.positions(-9);
        (-9..30).for_each(|sample| assert_eq!(positions.step(), position(sample), "sample {sample}"));
        assert_eq!((track.frame(3), track.newest()), (3.0, 5.0));
        assert_eq!(track.frame(1000), 5.0, "beyond the last one, the last one");
        assert_eq!(track.frame(-1000), 0.0);
    }
}
