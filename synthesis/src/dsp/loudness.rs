//! Integrated loudness (ITU-R BS.1770-4): K-weighted, gated.

use std::f64::consts::PI;

/// Length of a block in seconds, and number of blocks that begin within one.
const BLOCK_S: f64 = 0.4;
const OVERLAP: usize = 4;
/// Gates in LUFS: absolute, and relative to the loudness that passes it.
const SILENT_LUFS: f64 = -70.0;
const QUIET_LU: f64 = -10.0;
/// Loudness in LUFS of a mean square of 1.
const OFFSET_LUFS: f64 = -0.691;

/// A second-order filter, direct form I.
#[derive(Debug, Clone, Copy, Default)]
struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
    inputs: [f64; 2],
    outputs: [f64; 2],
}

impl Biquad {
    fn process(&mut self, x: f64) -> f64 {
        let ([x1, x2], [y1, y2]) = (self.inputs, self.outputs);
        let y = self.b[0] * x + self.b[1] * x1 + self.b[2] * x2 - self.a[0] * y1 - self.a[1] * y2;
        self.inputs = [x, x1];
        self.outputs = [y, y1];
        y
    }
}

/// The standard's two filters, stated there for 48 kHz, at any rate: De Man, "Evaluation of implementations of the EBU
/// R128 loudness measurement" (2018), has their analogue parameters.
fn k_weighting(sample_rate_hz: f64) -> [Biquad; 2] {
    let (corner_hz, gain_db, q) = (1_681.974_450_955_533, 3.999_843_853_973_347, 0.707_175_236_955_419_6);
    let (k, v) = (maths::tan(PI * corner_hz / sample_rate_hz), maths::pow(10.0, gain_db / 20.0));
    let vb = maths::pow(v, 0.499_666_774_154_541_6);
    let a0 = 1.0 + k / q + k * k;
    let shelf = Biquad {
        b: [(v + vb * k / q + k * k) / a0, 2.0 * (k * k - v) / a0, (v - vb * k / q + k * k) / a0],
        a: [2.0 * (k * k - 1.0) / a0, (1.0 - k / q + k * k) / a0],
        ..Biquad::default()
    };
    let (corner_hz, q) = (38.135_470_876_024_44, 0.500_327_037_323_877_3);
    let k = maths::tan(PI * corner_hz / sample_rate_hz);
    let a0 = 1.0 + k / q + k * k;
    let high_pass =
        Biquad { b: [1.0, -2.0, 1.0], a: [2.0 * (k * k - 1.0) / a0, (1.0 - k / q + k * k) / a0], ..Biquad::default() };
    [shelf, high_pass]
}

/// Integrated loudness in LUFS of `channels`, from the mean of their powers, so that the same sound in two channels is
/// as loud as in one. None for silence, and for sounds shorter than a tenth of a second.
pub(crate) fn integrated_lufs(channels: &[Vec<f64>], sample_rate_hz: f64) -> Option<f64> {
    let samples = channels.first().map_or(0, Vec::len);
    let step = (BLOCK_S / OVERLAP as f64 * sample_rate_hz) as usize;
    let mut steps = vec![0.0; samples.checked_div(step)?];
    for channel in channels {
        let [mut shelf, mut high_pass] = k_weighting(sample_rate_hz);
        for (power, samples) in steps.iter_mut().zip(channel.chunks_exact(step)) {
            *power += samples.iter().map(|x| maths::square(high_pass.process(shelf.process(*x)))).sum::<f64>();
        }
    }
    let scale = 1.0 / (step * channels.len()) as f64;
    let width = OVERLAP.min(steps.len()).max(1);
    let blocks: Vec<f64> = steps.windows(width).map(|part| scale * part.iter().sum::<f64>() / width as f64).collect();
    let lufs = |power: f64| OFFSET_LUFS + 10.0 * maths::log10(power);
    let mean_above = |gate: f64| {
        let (sum, count) = blocks.iter().filter(|x| lufs(**x) > gate).fold((0.0, 0.0), |(s, n), x| (s + x, n + 1.0));
        (count > 0.0).then(|| lufs(sum / count))
    };
    mean_above(mean_above(SILENT_LUFS)? + QUIET_LU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_the_standards_loudness_at_any_rate_and_silence_none() {
        for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
            let sine: Vec<f64> =
                (0..3 * rate_hz as usize).map(|i| (2.0 * PI * 997.0 * i as f64 / rate_hz).sin()).collect();
            // BS.1770: a sine of 997 Hz at 0 dBFS in one channel is -3.01 LKFS.
            let found = integrated_lufs(std::slice::from_ref(&sine), rate_hz).unwrap();
            assert!((found + 3.01).abs() < 0.05, "{found} LUFS at {rate_hz} Hz");
            let mut paused = sine.clone();
            paused.extend(vec![0.0; 10 * rate_hz as usize]);
            let gated = integrated_lufs(&[paused.clone(), paused], rate_hz).unwrap();
            assert!((gated - found).abs() < 0.6, "{gated} LUFS with a pause");
        }
        assert_eq!(integrated_lufs(&[vec![0.0; 100_000]], 44_100.0), None);
        assert_eq!(integrated_lufs(&[vec![0.5; 100]], 44_100.0), None);
        assert_eq!(integrated_lufs(&[], 44_100.0), None);
    }
}
