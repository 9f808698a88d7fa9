//! Bandwidth extension of a whole signal as published (Chadwick & James 2011, §4, Algorithm 1),
//! in double precision, for comparison with the authors' own results.
//!
//! It preserves the published program's peculiarities: a frequency axis whose last bin is at the sample rate, one-sided
//! blend ramps (hence half the amplitude of everything), complex noise, and transforms as long as the signal.
//! [`Extend`](super::Extend) is the engine for sound.

use std::f64::consts::TAU;
use std::ops::Range;

use maths::fft::{self, Complex64, ComplexTransform};

use super::beta::positive_root;
use crate::dsp::ChirpZ;
use crate::error::{Error, in_range};

/// Inputs of the published program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Sample rate in Hz.
    pub sample_rate_hz: f64,
    /// The noise's power falls as frequency^(-alpha); 0-6.
    pub alpha: f64,
    /// Corner in Hz of the envelope's low-pass, above 0 and below half the sample rate.
    pub cutoff_hz: f64,
    /// Half-width of the windows in samples, at least 1.
    pub half_width: usize,
    /// Centre of the fit in Hz, above 0 and below half the sample rate.
    pub fit_centre_hz: f64,
    /// Three standard deviations of the fit's Gaussian in Hz, above 0.
    pub fit_width_hz: f64,
    /// Start of the blend in Hz, 0 or more.
    pub blend_start_hz: f64,
    /// End of the blend in Hz, above its start and below half the sample rate.
    pub blend_end_hz: f64,
    /// Factor on the noise, 0 or more.
    pub noise_amplitude: f64,
    /// Seed of the noise's phases.
    pub seed: u64,
}

impl Settings {
    /// The paper's values, at `sample_rate_hz`.
    pub fn new(sample_rate_hz: f64) -> Self {
        Self {
            sample_rate_hz,
            alpha: 2.5,
            cutoff_hz: 180.0,
            half_width: 500,
            fit_centre_hz: 180.0,
            fit_width_hz: 30.0,
            blend_start_hz: 165.0,
            blend_end_hz: 195.0,
            noise_amplitude: 1.0,
            seed: 42,
        }
    }

    /// Fails with the first setting out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        in_range("sample rate in Hz", self.sample_rate_hz, 1000.0, 768_000.0)?;
        let nyquist_hz = 0.499 * self.sample_rate_hz;
        in_range("alpha", self.alpha, 0.0, 6.0)?;
        in_range("cutoff in Hz", self.cutoff_hz, 1.0, nyquist_hz)?;
        in_range("half-width", self.half_width as f64, 1.0, 1e9)?;
        in_range("fit centre in Hz", self.fit_centre_hz, 1.0, nyquist_hz)?;
        in_range("fit width in Hz", self.fit_width_hz, 0.1, nyquist_hz)?;
        in_range("blend start in Hz", self.blend_start_hz, 0.0, nyquist_hz)?;
        in_range("blend end in Hz", self.blend_end_hz, self.blend_start_hz + 1e-3, nyquist_hz)?;
        in_range("noise amplitude", self.noise_amplitude, 0.0, 1e6)
    }
}

/// Standard deviations from the fit's centre beyond which the Gaussian, below 1e-36, does not
/// change a double.
const FIT_REACH: f64 = 13.0;

/// Results of the published program.
#[derive(Debug, Clone, PartialEq)]
pub struct Extended {
    /// The extended sound, as long as the input.
    pub samples: Vec<f64>,
    /// The factor of every window, in order.
    pub betas: Vec<f64>,
}

/// Extends `signal`.
///
/// `progress` receives the share of windows done, 0-1, from time to time, and cancels the work by returning `false`.
/// Fails if a setting is out of range, if `signal` is shorter than a half-width or than the envelope filter's 9-sample
/// extension requires, or if it contains a value that is not finite.
pub fn extend(signal: &[f64], settings: &Settings, progress: &mut dyn FnMut(f64) -> bool) -> Result<Extended, Error> {
    settings.validate()?;
    let least = settings.half_width.max(PADDING + 1);
    if signal.len() < least {
        let remedy = "a smaller half-width";
        return Err(Error::TooShort { what: "the input", found: signal.len(), least, remedy });
    }
    if let Some(at) = signal.iter().position(|sample| !sample.is_finite()) {
        return Err(Error::NotFinite { what: "the input", at });
    }
    let mut work = Work::new(signal, settings);
    let h = settings.half_width;
    let windows = (signal.len() + h).div_ceil(h);
    let mut betas = Vec::with_capacity(windows);
    for window in 0..windows {
        if !progress(window as f64 / windows as f64) {
            return Err(Error::Cancelled);
        }
        betas.push(work.beta(window));
    }
    let samples = work.output(&betas);
    progress(1.0);
    Ok(Extended { samples, betas })
}

/// Data common to all windows.
struct Work<'a> {
    signal: &'a [f64],
    settings: &'a Settings,
    fourier: ComplexTransform,
    axis: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    gaussian: Vec<f64>,
    /// Envelope times noise.
    noise: Vec<Complex64>,
    /// The bins that weigh in the fit, and their spectra of one window.
    fitted: Range<usize>,
    zoom: ChirpZ,
    window_drive: Vec<Complex64>,
    window_noise: Vec<Complex64>,
}

impl<'a> Work<'a> {
    fn new(signal: &'a [f64], settings: &'a Settings) -> Self {
        let bins = signal.len().next_power_of_two();
        let fourier = ComplexTransform::new(bins);
        let axis = frequency_axis(bins, settings.sample_rate_hz);
        let (lower, upper) = blend_ramps(&axis, settings.blend_start_hz, settings.blend_end_hz);
        let mut noise = noise_spectrum(&axis, settings.alpha, &mut Pcg32::new(settings.seed));
        noise.iter_mut().zip(&upper).for_each(|(bin, upper)| *bin *= upper);
        fourier.inverse(&mut noise);
        let envelope = zero_phase_low_pass(signal, settings.cutoff_hz, settings.sample_rate_hz);
        let scale = 1.0 / bins as f64;
        noise.truncate(signal.len());
        noise.iter_mut().zip(&envelope).for_each(|(noise, low)| *noise *= low.abs() * scale);
        let sigma_hz = settings.fit_width_hz / 3.0;
        let gaussian = gaussian(&axis, settings.fit_centre_hz, sigma_hz);
        let reach_hz = FIT_REACH * sigma_hz;
        let begin = axis.partition_point(|x| *x < settings.fit_centre_hz - reach_hz);
        let end = axis.partition_point(|x| *x <= settings.fit_centre_hz + reach_hz);
        // The trapezoid rule weights a bin by the distance of its neighbours.
        let fitted = begin.saturating_sub(1)..(end + 1).min(bins);
        let zeros = vec![Complex64::default(); fitted.len()];
        Self {
            zoom: ChirpZ::new(bins, fitted.clone(), (2 * settings.half_width).min(signal.len())),
            window_drive: zeros.clone(),
            window_noise: zeros,
            signal,
            settings,
            fourier,
            axis,
            lower,
            upper,
            gaussian,
            noise,
            fitted,
        }
    }

    /// The section of the signal under a window.
    fn span(&self, window: usize) -> Range<usize> {
        let (h, centre) = (self.settings.half_width, window * self.settings.half_width);
        centre.saturating_sub(h)..(centre + h).min(self.signal.len())
    }

    /// Weight of sample `at` in a window.
    fn weight(&self, window: usize, at: usize) -> f64 {
        let h = self.settings.half_width;
        1.0 - at.abs_diff(window * h) as f64 / h as f64
    }

    /// The spectra of the fit all start their phases at the window's first sample, which does not change their
    /// products.
    fn beta(&mut self, window: usize) -> f64 {
        let weights: Vec<f64> = self.span(window).map(|at| self.weight(window, at)).collect();
        let span = self.span(window);
        let drive = self.signal[span.clone()].iter().zip(&weights).map(|(sample, weight)| (sample * weight).into());
        self.zoom.transform(drive, &mut self.window_drive);
        let noise = self.noise[span].iter().zip(&weights).map(|(sample, weight)| sample * weight);
        self.zoom.transform(noise, &mut self.window_noise);
        let fitted = self.fitted.clone();
        self.window_noise.iter_mut().zip(&self.upper[fitted.clone()]).for_each(|(bin, upper)| *bin *= upper);
        let (gaussian, lower) = (&self.gaussian[fitted.clone()], &self.lower[fitted.clone()]);
        fit(&self.axis[fitted], gaussian, lower, &self.window_drive, &self.window_noise)
    }

    /// The sum of the windows. Transform and ramps are linear, so the sum is taken before them.
    fn output(&self, betas: &[f64]) -> Vec<f64> {
        let mut low = vec![Complex64::default(); self.axis.len()];
        let mut high = low.clone();
        for (window, beta) in betas.iter().enumerate() {
            for at in self.span(window) {
                let weight = self.weight(window, at);
                low[at].re += weight * self.signal[at];
                high[at] += self.noise[at] * (weight * beta * self.settings.noise_amplitude);
            }
        }
        self.fourier.forward(&mut low);
        self.fourier.forward(&mut high);
        for (bin, (low, high)) in low.iter_mut().zip(&high).enumerate() {
            *low = *low * self.lower[bin] + high * self.upper[bin];
        }
        self.fourier.inverse(&mut low);
        let scale = 1.0 / self.axis.len() as f64;
        low[..self.signal.len()].iter().map(|sample| sample.re * scale).collect()
    }
}

/// Frequencies in Hz of `bins` bins; the last one is at the sample rate.
pub fn frequency_axis(bins: usize, sample_rate_hz: f64) -> Vec<f64> {
    (0..bins).map(|bin| sample_rate_hz * bin as f64 / (bins - 1) as f64).collect()
}

/// The lower ramp, 1 below `start_hz` and falling to 0 at `end_hz`, and the upper one, its
/// complement.
pub fn blend_ramps(axis: &[f64], start_hz: f64, end_hz: f64) -> (Vec<f64>, Vec<f64>) {
    let lower: Vec<f64> = axis.iter().map(|x| ((end_hz - x) / (end_hz - start_hz)).clamp(0.0, 1.0)).collect();
    let upper = lower.iter().map(|lower| 1.0 - lower).collect();
    (lower, upper)
}

/// The Gaussian exp(-(x - centre)^2 / (2 sigma^2)).
pub fn gaussian(axis: &[f64], centre_hz: f64, sigma_hz: f64) -> Vec<f64> {
    axis.iter().map(|x| maths::exp(-0.5 * maths::square((x - centre_hz) / sigma_hz))).collect()
}

/// The noise's spectrum before the blend: amplitude x^(-alpha/2), 0 at 0 Hz, one random phase per
/// bin, bin 0 included.
pub fn noise_spectrum(axis: &[f64], alpha: f64, phases: &mut Pcg32) -> Vec<Complex64> {
    let bin = |x: &f64| {
        let phase = TAU * phases.next_unit();
        if *x == 0.0 { Complex64::default() } else { fft::polar(maths::pow(*x, -alpha / 2.0), phase) }
    };
    axis.iter().map(bin).collect()
}

/// The factor by which `noise` (times the upper ramp) joins `drive` (in full) at the fit's centre: the paper's
/// quadratic, with its integrals by the trapezoid rule.
pub fn fit(axis: &[f64], gaussian: &[f64], lower: &[f64], drive: &[Complex64], noise: &[Complex64]) -> f64 {
    let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
    for bin in 0..axis.len() {
        if gaussian[bin] == 0.0 {
            continue;
        }
        let left = if bin == 0 { axis[0] } else { axis[bin - 1] };
        let right = axis[(bin + 1).min(axis.len() - 1)];
        let weight = gaussian[bin] * 0.5 * (right - left);
        let low = drive[bin] * lower[bin];
        a += weight * noise[bin].norm_sqr();
        b += weight * 2.0 * (low.re * noise[bin].re + low.im * noise[bin].im);
        c += weight * (low.norm_sqr() - drive[bin].norm_sqr());
    }
    positive_root(a, b, c)
}

/// Samples by which the zero-phase filter extends a signal at either end.
const PADDING: usize = 9;

/// Butterworth low-pass of order 2, run forwards and backwards, with an odd extension of 9 samples at both ends and an
/// initial state settled on the first value.
///
/// `signal` has at least 10 samples.
pub fn zero_phase_low_pass(signal: &[f64], cutoff_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    if signal.len() <= PADDING {
        return signal.to_vec();
    }
    let (first, last) = (signal[0], signal[signal.len() - 1]);
    let mut extended = Vec::with_capacity(signal.len() + 2 * PADDING);
    extended.extend((1..=PADDING).rev().map(|i| 2.0 * first - signal[i]));
    extended.extend_from_slice(signal);
    extended.extend((1..=PADDING).map(|i| 2.0 * last - signal[signal.len() - 1 - i]));
    for _ in 0..2 {
        low_pass_from_rest(&mut extended, cutoff_hz, sample_rate_hz);
        extended.reverse();
    }
    extended[PADDING..PADDING + signal.len()].to_vec()
}

/// Bilinear transform of the analogue Butterworth filter, corner prewarped; transposed direct
/// form II.
fn low_pass_from_rest(signal: &mut [f64], cutoff_hz: f64, sample_rate_hz: f64) {
    let w = maths::tan(std::f64::consts::PI * cutoff_hz / sample_rate_hz);
    let norm = 1.0 + std::f64::consts::SQRT_2 * w + w * w;
    let b = [w * w / norm, 2.0 * w * w / norm, w * w / norm];
    let a = [2.0 * (w * w - 1.0) / norm, (1.0 - std::f64::consts::SQRT_2 * w + w * w) / norm];
    // State of the filter settled on a constant 1, for which its output is also 1.
    let (mut s1, mut s2) = ((1.0 - b[0]) * signal[0], (b[2] - a[1]) * signal[0]);
    for sample in signal {
        let x = *sample;
        let y = b[0] * x + s1;
        s1 = b[1] * x - a[0] * y + s2;
        s2 = b[2] * x - a[1] * y;
        *sample = y;
    }
}

/// The generator PCG32, XSH-RR 64/32 (O'Neill 2014), on the published program's stream.
#[derive(Debug, Clone)]
pub struct Pcg32 {
    state: u64,
}

impl Pcg32 {
    const INCREMENT: u64 = (0xDA3E_39CB_94B9_5BDB << 1) | 1;
    const MULTIPLIER: u64 = 6_364_136_223_846_793_005;

    /// Canonical seeding.
    pub fn new(seed: u64) -> Self {
        let mut generator = Self { state: 0 };
        generator.next_u32();
        generator.state = generator.state.wrapping_add(seed);
        generator.next_u32();
        generator
    }

    /// 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(Self::MULTIPLIER).wrapping_add(Self::INCREMENT);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// A value of 0 or more and below 1.
    pub fn next_unit(&mut self) -> f64 {
        f64::from(self.next_u32()) / 4_294_967_296.0
    }
}
