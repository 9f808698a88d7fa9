//! The frequencies of all plots: bands of equal width on a logarithmic axis.

/// Number of bands.
pub const BANDS: usize = 192;

/// Ends of the axis in Hz.
pub const LOW_HZ: f64 = 20.0;
/// The upper one.
pub const HIGH_HZ: f64 = 20_000.0;

/// Power density, in dB of full scale squared per Hz, that counts as silence.
pub const FLOOR_DB: f32 = -160.0;

/// The frequency at a position on the axis, 0-1.
pub fn frequency_hz(position: f64) -> f64 {
    LOW_HZ * (HIGH_HZ / LOW_HZ).powf(position)
}

/// The position of a frequency on the axis, 0-1 within its ends.
pub fn position(frequency_hz: f64) -> f64 {
    (frequency_hz.max(1e-3) / LOW_HZ).ln() / (HIGH_HZ / LOW_HZ).ln()
}

/// Assignment of a spectrum's bins to bands.
#[derive(Debug, Clone)]
pub struct Bands {
    spans: Vec<Span>,
}

/// Bins of one band: the mean of whole ones, or a point between two.
#[derive(Debug, Clone, Copy)]
enum Span {
    Mean {
        first: usize,
        end: usize,
    },
    Between {
        below: usize,
        part: f32,
    },
    /// Beyond half the sample rate.
    Nothing,
}

impl Bands {
    /// Bands of spectra with `bins` bins from 0 Hz to half the sample rate.
    pub fn new(sample_rate_hz: f64, bins: usize) -> Self {
        let bin_hz = 0.5 * sample_rate_hz / (bins.max(2) - 1) as f64;
        let span = |band: usize| {
            let edge = |band: usize| frequency_hz(band as f64 / BANDS as f64) / bin_hz;
            let (low, high) = (edge(band), edge(band + 1));
            let (first, end) = (low.ceil() as usize, high.ceil() as usize);
            if low >= (bins - 1) as f64 {
                Span::Nothing
            } else if end > first + 1 {
                Span::Mean { first, end: end.min(bins) }
            } else {
                let middle = (low * high).sqrt().min((bins - 1) as f64);
                let below = (middle as usize).min(bins - 2);
                Span::Between { below, part: (middle - below as f64) as f32 }
            }
        };
        Self { spans: (0..BANDS).map(span).collect() }
    }

    /// Power of every band, from that of the bins.
    pub fn gather(&self, bins: &[f32], out: &mut [f32; BANDS]) {
        for (span, out) in self.spans.iter().zip(out) {
            *out = match *span {
                Span::Nothing => 0.0,
                Span::Mean { first, end } => {
                    bins.get(first..end).map_or(0.0, |bins| bins.iter().sum::<f32>() / (end - first) as f32)
                }
                Span::Between { below, part } => match bins.get(below..below + 2) {
                    Some([a, b]) => a + part * (b - a),
                    _ => 0.0,
                },
            };
        }
    }
}

/// Power as dB, silence as the floor.
pub fn decibels(power: f32) -> f32 {
    (10.0 * power.max(1e-20).log10()).max(FLOOR_DB)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_frequencies_are_each_others_inverse() {
        for frequency in [20.0, 180.0, 1000.0, 20_000.0] {
            assert!((frequency_hz(position(frequency)) / frequency - 1.0).abs() < 1e-12, "{frequency}");
        }
        assert_eq!((position(20.0), position(20_000.0)), (0.0, 1.0));
    }

    #[test]
    fn even_power_is_even_in_every_band_and_nothing_lies_beyond_the_rate() {
        for (rate_hz, bins) in [(8_000.0, 2049), (44_100.0, 4097), (192_000.0, 16_385)] {
            let mut out = [f32::NAN; BANDS];
            Bands::new(rate_hz, bins).gather(&vec![0.25; bins], &mut out);
            for (band, power) in out.iter().enumerate() {
                let low_hz = frequency_hz(band as f64 / BANDS as f64);
                let expected = if low_hz < 0.5 * rate_hz { 0.25 } else { 0.0 };
                assert!((power - expected).abs() < 1e-6, "{rate_hz} Hz: {power} at {low_hz} Hz");
            }
        }
    }
}
