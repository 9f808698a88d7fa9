//! A texture prepared for the renderer: by directions, and at a multiple of its rate.
//!
//! Cubic B-splines interpolate between the steps. Their prefilter and the change of rate are applied to the whole
//! period at once, in the spectrum, so both are exact and the period remains seamless. At four times the texture's
//! rate, the images of its highest frequency are 67 dB down, those of half that frequency 94 dB.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::level::Levels;
use super::texture::{COMPONENTS, Row, VortexTexture, directivity};
use super::upsampler::top_hz;
use crate::dsp::Transform;
use crate::error::{Error, in_range};

/// Number of directions in a bank.
pub const DIRECTIONS: usize = 6;

/// Steps of a bank per step of the texture.
const OVERSAMPLING: usize = 4;

/// Largest number of bytes of a bank.
const MOST_BYTES: usize = 128 << 20;

/// Longest section in steps that is read at once, including the surroundings that interpolation needs.
pub(super) const LONGEST_READ: usize = 1024;

/// A texture prepared for one output rate; shared and immutable.
///
/// It takes 48 bytes per row and step of the texture: 13 MB for 16 rows of 4 s at 4 kHz.
#[derive(Debug)]
pub struct Bank {
    sample_rate_hz: f64,
    /// Steps per second.
    rate_hz: f64,
    /// Steps of a period.
    period: usize,
    /// Steps from one series to the next: a period, followed by a repetition of its beginning as long as one read may
    /// cross its end.
    stride: usize,
    levels: Levels,
    /// Row by row, direction by direction: the scale of a series' numbers, and the spline's coefficients.
    scales: Vec<f32>,
    series: Vec<i16>,
}

/// The six axes of an icosahedron, rotated away from the box's planes and axes of symmetry.
///
/// They form a design of strength 5: their mean square of any vortex sound is that over the whole sphere. The sounds in
/// any two of them correlate by only 1/5, the smallest value for six directions.
pub fn directions() -> [[f64; 3]; DIRECTIONS] {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let norm = 1.0 / maths::hypot(golden, 1.0);
    let axes = [
        [0.0, 1.0, golden],
        [0.0, -1.0, golden],
        [1.0, golden, 0.0],
        [-1.0, golden, 0.0],
        [golden, 0.0, 1.0],
        [golden, 0.0, -1.0],
    ];
    // Angles that keep every coordinate of every axis well away from 0 and from those of other axes.
    let ((sin_a, cos_a), (sin_b, cos_b)) = (maths::sin_cos(1.43), maths::sin_cos(1.26));
    axes.map(|[x, y, z]| {
        let (x, y) = (cos_a * x - sin_a * y, sin_a * x + cos_a * y);
        let (y, z) = (cos_b * y - sin_b * z, sin_b * y + cos_b * z);
        [norm * x, norm * y, norm * z]
    })
}

impl Bank {
    /// Prepares `texture` for output at `sample_rate_hz` (8,000-384,000). Takes about 0.1 s per million values.
    ///
    /// Fails if the rate is out of range, or if the bank would be larger than 128 MB.
    pub fn new(texture: &VortexTexture, sample_rate_hz: f64) -> Result<Self, Error> {
        in_range("sample rate in Hz", sample_rate_hz, 8_000.0, 384_000.0)?;
        let steps = texture.period_samples();
        let period = OVERSAMPLING * steps;
        let stride = period + LONGEST_READ;
        let bytes = texture.rows().len() * DIRECTIONS * stride * size_of::<i16>();
        if bytes > MOST_BYTES {
            let reason = format!("it would take {} MB, but at most {} MB are allowed", bytes >> 20, MOST_BYTES >> 20);
            return Err(Error::VortexTexture { reason });
        }
        let top = top_hz(sample_rate_hz) / texture.sample_rate_hz();
        let rows = texture.rows();
        let mut series = vec![0; rows.len() * DIRECTIONS * stride];
        // Hosts wait for this in their main thread, so rows are made in parallel.
        let scales: Vec<[f32; DIRECTIONS]> = series
            .par_chunks_mut(DIRECTIONS * stride)
            .zip(rows)
            .map_init(|| Oversample::new(steps, top), |oversample, (to, row)| oversample.fill(row, period, to))
            .collect();
        let rate_hz = OVERSAMPLING as f64 * texture.sample_rate_hz();
        Ok(Self {
            sample_rate_hz,
            rate_hz,
            period,
            stride,
            levels: Levels::new(rows),
            scales: scales.into_flattened(),
            series,
        })
    }

    /// Sample rate of its output in Hz.
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.series) + size_of_val(&*self.scales)
    }

    /// Speeds of the lowest and of the highest row in m/s.
    pub fn speeds_m_s(&self) -> [f64; 2] {
        self.levels.speeds_m_s()
    }

    /// Steps per second.
    pub(super) fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Steps of a period.
    pub(super) fn period(&self) -> usize {
        self.period
    }

    pub(super) fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Scale of the coefficients, and the coefficients from the one before `step`, which is below the period.
    #[inline]
    pub(super) fn series(&self, row: usize, direction: usize, step: usize) -> (f32, &[i16]) {
        let which = row * DIRECTIONS + direction;
        // The cubic at a step begins one step earlier.
        let from = if step == 0 { self.period - 1 } else { step - 1 };
        (self.scales[which], &self.series[which * self.stride + from..][..LONGEST_READ])
    }
}

/// The largest magnitude of `values`.
fn largest(values: &[f64]) -> f64 {
    // Several at once: their order does not matter.
    let mut most = [0.0f64; 8];
    let (chunks, rest) = values.as_chunks::<8>();
    for chunk in chunks {
        most.iter_mut().zip(chunk).for_each(|(most, value)| *most = most.max(value.abs()));
    }
    most.iter().chain(rest).fold(0.0, |most, value| most.max(value.abs()))
}

/// Writes `values` in units of `scale`, rounded; half a unit is rounded away from 0.
struct Quantise<'a> {
    values: &'a [f64],
    scale: f64,
    to: &'a mut [i16],
}

impl pulp::WithSimd for Quantise<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (to, value) in self.to.iter_mut().zip(self.values) {
            *to = rounded(value / self.scale);
        }
    }
}

/// As `f64::round`, which would be a call for every value; `steps` is within the range of the result.
#[inline(always)]
fn rounded(steps: f64) -> i16 {
    let whole = steps as i32;
    let rest = steps - f64::from(whole);
    (whole + i32::from(rest >= 0.5) - i32::from(rest <= -0.5)) as i16
}

/// Conversion of a texture's steps to spline coefficients at the higher rate.
struct Oversample {
    low: Transform,
    high: Transform,
    gains: Vec<f64>,
}

impl Oversample {
    /// A conversion for periods of `steps`; frequencies above `top`, in periods per step, are removed.
    fn new(steps: usize, top: f64) -> Self {
        let raised = OVERSAMPLING * steps;
        let gain = |bin: usize| {
            let turn = bin as f64 / raised as f64;
            // A constant pressure is no sound.
            let is_audible = bin > 0 && bin as f64 <= top * steps as f64;
            // The bin at half the rate contains the halves of both of its neighbours.
            let share = if 2 * bin == steps { 0.5 } else { 1.0 };
            if is_audible { share * 3.0 / (2.0 + maths::cos(TAU * turn)) / steps as f64 } else { 0.0 }
        };
        Self { low: Transform::new(steps), high: Transform::new(raised), gains: (0..=steps / 2).map(gain).collect() }
    }

    /// Fills `to` with the output of `row` in all directions, one stride after another, and returns the scale of each.
    fn fill(&mut self, row: &Row, period: usize, to: &mut [i16]) -> [f32; DIRECTIONS] {
        let stride = to.len() / DIRECTIONS;
        let mut strides = to.chunks_exact_mut(stride);
        directions().map(|direction| {
            let coefficients = self.process(row, direction);
            let largest = largest(coefficients);
            let scale = if largest > 0.0 { largest / f64::from(i16::MAX) } else { 1.0 };
            if let Some(to) = strides.next() {
                pulp::Arch::new().dispatch(Quantise { values: coefficients, scale, to: &mut to[..period] });
                // A read that crosses the period's end continues into its beginning.
                (period..stride).for_each(|step| to[step] = to[step - period]);
            }
            scale as f32
        })
    }

    /// The coefficients of the output of `row` in `direction`.
    fn process(&mut self, row: &Row, direction: [f64; 3]) -> &[f64] {
        let weights: [f64; COMPONENTS] = directivity(direction);
        self.low.time.fill(0.0);
        for (series, weight) in row.components.iter().zip(weights) {
            self.low.time.iter_mut().zip(series).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        self.low.forward();
        self.high.spectrum.fill(Default::default());
        for ((high, low), gain) in self.high.spectrum.iter_mut().zip(&self.low.spectrum).zip(&self.gains) {
            *high = low * gain;
        }
        self.high.inverse();
        &self.high.time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_measure_as_the_sphere_does_and_lie_off_its_symmetries() {
        let seen = directions().map(directivity);
        for i in 0..COMPONENTS {
            for j in 0..COMPONENTS {
                let mean = seen.iter().map(|b| b[i] * b[j]).sum::<f64>() / DIRECTIONS as f64;
                assert!((mean - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j}: {mean}");
            }
        }
        for [x, y, z] in directions() {
            let apart = [x, y, z, x.abs() - y.abs(), y.abs() - z.abs(), z.abs() - x.abs()];
            assert!(apart.iter().all(|distance| distance.abs() > 0.11), "{apart:?}");
        }
    }

    #[test]
    fn halves_are_rounded_away_from_zero() {
        let beside: [f64; 9] = [0.0, 0.5, 0.49999999999999994, 1.5, 2.5, 32_766.5, 32_767.0, 3.3, 1234.5678];
        for steps in beside.into_iter().flat_map(|x| [x, -x, x.next_up(), -x.next_up(), x.next_down()]) {
            assert_eq!(rounded(steps), steps.round() as i16, "{steps}");
        }
        let values: Vec<f64> = (0..100).map(|n| f64::from(n * 37 % 100) - 70.0).collect();
        assert_eq!(largest(&values), 70.0);
        assert_eq!((largest(&values[..0]), largest(&values[..3])), (0.0, 70.0));
    }

    #[test]
    fn the_spline_passes_through_the_texture() {
        for steps in [50, 51] {
            let tone = |step: usize, times: f64| (TAU * times * step as f64 / steps as f64 + 0.3).sin() as f32;
            let row = Row {
                speed_m_s: 1.0,
                gain: 1.0,
                components: std::array::from_fn(|k| (0..steps).map(|step| tone(step, 3.0 + 5.0 * k as f64)).collect()),
            };
            let texture = VortexTexture::new(4000.0, vec![row.clone()]).expect("a texture");
            let bank = Bank::new(&texture, 48_000.0).expect("a bank");
            for (which, direction) in directions().into_iter().enumerate() {
                let weights = directivity(direction);
                for step in 0..steps {
                    let (scale, taps) = bank.series(0, which, OVERSAMPLING * step);
                    let found = scale * (f32::from(taps[0]) + 4.0 * f32::from(taps[1]) + f32::from(taps[2])) / 6.0;
                    let expected: f64 = (0..COMPONENTS).map(|k| weights[k] * f64::from(row.components[k][step])).sum();
                    assert!((f64::from(found) - expected).abs() < 1e-3, "{steps}, {which}, {step}");
                }
            }
        }
    }
}
