//! The factor beta that joins the noise to the drive's spectrum at the cutoff (§4, Algorithm 1).
//!
//! # Rule against outliers
//!
//! The fit sees little more than one independent value of the noise's spectrum, so its power a = I[|Y_N|^2]
//! occasionally comes close to 0, and beta ~ 1/sqrt(a) is heavy-tailed. The *expected* a is known: the energy of
//! envelope times window, times the noise's mean density around the cutoff. The rule adds a two-hundredth of it to a,
//!
//! beta_applied = beta sqrt(a / (a + [`FLOOR`] E\[a\])),
//!
//! as if no section of noise could be quite empty at the cutoff. It has no memory: it needs no look-ahead, a silence
//! cannot poison it, and it does not change the drive's own dynamics (the other half of beta), so nothing is lost in
//! synchrony.

use std::f64::consts::TAU;

use maths::fft::Complex64;

use super::band::{Band, triangle_power};

/// Power added to a window's noise in the fit, as a share of its expected power.
pub const FLOOR: f64 = 0.005;

/// Number of frequencies at which the fit's integrals are evaluated: 0.4 standard deviations apart, up to 3 from the
/// centre.
const NODES: usize = 16;

/// Results of one window's fit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fit {
    /// Number of the window; its centre is this times the half-width, on the host's timeline.
    pub window: i64,
    /// The root of the paper's quadratic, in units of the noise's amplitude density at the cutoff.
    pub raw: f64,
    /// The factor in use, after the rule of [this module](self), without the noise amount.
    pub applied: f64,
}

/// The non-negative root of a beta^2 + b beta + c = 0 with a >= 0 >= c, in the form without cancellation; -c/b if a is
/// 0, and 0 if b is 0 too.
pub fn positive_root(a: f64, b: f64, c: f64) -> f64 {
    if a == 0.0 {
        return if b == 0.0 { 0.0 } else { -c / b };
    }
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    if b <= 0.0 { (root - b) / (2.0 * a) } else { -2.0 * c / (b + root) }
}

/// The fit's integrals I\[.\] around one centre frequency.
#[derive(Debug)]
pub(crate) struct Fitter {
    half_width: usize,
    sample_rate_hz: f64,
    sigma_hz: f64,
    band: Option<Band>,
    /// Turn of the phase per sample at every node.
    turn: Phasors,
    /// The Gaussian; 0 at nodes that are not above 0 Hz.
    weight: [f64; NODES],
    upper: [f64; NODES],
    /// E\[a\] for noise of unit density at the cutoff and a window of unit energy.
    expected: f64,
    drive: [Complex64; NODES],
}

impl Fitter {
    /// A fit for windows of `half_width` samples and a Gaussian whose three standard deviations are `fit_width_hz`.
    pub fn new(half_width: usize, sample_rate_hz: f64, fit_width_hz: f64) -> Self {
        Self {
            half_width,
            sample_rate_hz,
            sigma_hz: fit_width_hz / 3.0,
            band: None,
            turn: Phasors::default(),
            weight: [0.0; NODES],
            upper: [0.0; NODES],
            expected: 0.0,
            drive: [Complex64::default(); NODES],
        }
    }

    /// Sets the window's band and its drive times triangle (2 half-widths, centre in the middle).
    pub fn set_drive(&mut self, band: &Band, windowed: &[f64]) {
        self.set_band(band);
        self.drive = self.turn.spectrum(windowed);
    }

    /// Fits the noise times envelope times triangle, whose expected power is `energy` (of envelope
    /// times triangle) times `level` squared (the noise's amplitude density at the cutoff).
    pub fn fit(&self, windowed: &[f64], energy: f64, level: f64) -> (f64, f64) {
        let noise = self.turn.spectrum(windowed);
        let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
        for (node, noise) in noise.iter().enumerate() {
            let (weight, upper) = (self.weight[node], self.upper[node]);
            let lower = 1.0 - upper;
            let drive = self.drive[node];
            a += weight * upper * upper * noise.norm_sqr();
            b += 2.0 * weight * upper * lower * (drive.re * noise.re + drive.im * noise.im);
            c += weight * (lower * lower - 1.0) * drive.norm_sqr();
        }
        let raw = positive_root(a, b, c).max(0.0);
        let floor = FLOOR * self.expected * energy * level * level;
        let applied = raw * (a / (a + floor)).sqrt();
        if applied.is_finite() { (raw, applied) } else { (0.0, 0.0) }
    }

    /// Sets the band in advance.
    pub fn set_band(&mut self, band: &Band) {
        if self.band == Some(*band) {
            return;
        }
        for node in 0..NODES {
            let deviations = (node as f64 - (NODES - 1) as f64 / 2.0) * 0.4;
            let frequency_hz = band.cutoff_hz + deviations * self.sigma_hz;
            let phase = TAU * frequency_hz / self.sample_rate_hz;
            (self.turn.sin[node], self.turn.cos[node]) = maths::sin_cos(phase);
            self.weight[node] = if frequency_hz > 0.0 { maths::exp(-0.5 * deviations * deviations) } else { 0.0 };
            self.upper[node] = band.upper(frequency_hz);
        }
        let gaussian: f64 = self.weight.iter().zip(&self.upper).map(|(weight, upper)| weight * upper * upper).sum();
        self.expected = gaussian * self.expected_density(band);
        self.band = Some(*band);
    }

    /// Mean power at the cutoff of noise of unit density there, seen through a window: the
    /// density smeared by the triangle's power.
    fn expected_density(&self, band: &Band) -> f64 {
        let half_width_s = self.half_width as f64 / self.sample_rate_hz;
        let step_hz = 1.0 / (16.0 * half_width_s);
        let reach_hz = 3.0 / half_width_s;
        let top_hz = (band.cutoff_hz + reach_hz).min(self.sample_rate_hz / 2.0);
        let first = ((band.cutoff_hz - band.width_hz / 2.0).max(band.cutoff_hz - reach_hz) / step_hz).ceil().max(1.0);
        let mut sum = 0.0;
        let mut frequency_hz = first * step_hz;
        while frequency_hz < top_hz {
            // A real signal's spectrum includes negative frequencies too.
            let seen = triangle_power(half_width_s, frequency_hz - band.cutoff_hz)
                + triangle_power(half_width_s, frequency_hz + band.cutoff_hz);
            sum += band.noise_power(frequency_hz) * seen * step_hz;
            frequency_hz += step_hz;
        }
        sum
    }
}

/// Phasors that turn by one sample each at all nodes together.
#[derive(Debug, Default)]
struct Phasors {
    cos: [f64; NODES],
    sin: [f64; NODES],
}

impl Phasors {
    /// Fourier transform at the nodes of a signal of 2 h samples about its sample h.
    fn spectrum(&self, signal: &[f64]) -> [Complex64; NODES] {
        // Uses the widest vectors that the machine has.
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || transform_at(&self.cos, &self.sin, signal),
        )
    }
}

#[inline(always)]
fn transform_at(turn_cos: &[f64; NODES], turn_sin: &[f64; NODES], signal: &[f64]) -> [Complex64; NODES] {
    let half = signal.len() / 2;
    let (before, after) = signal.split_at(half);
    let mut cos = *turn_cos;
    let mut sin = *turn_sin;
    let mut re = [after[0]; NODES];
    let mut im = [0.0; NODES];
    // Samples at equal distances from the centre share their phasor: their sum goes to the real part, their difference
    // to the imaginary part.
    for (left, right) in before.iter().rev().zip(after[1..].iter().chain(std::iter::once(&0.0))) {
        let (even, odd) = (right + left, right - left);
        for node in 0..NODES {
            re[node] += even * cos[node];
            im[node] -= odd * sin[node];
            let turned = cos[node] * turn_cos[node] - sin[node] * turn_sin[node];
            sin[node] = cos[node] * turn_sin[node] + sin[node] * turn_cos[node];
            cos[node] = turned;
        }
    }
    std::array::from_fn(|node| Complex64::new(re[node], im[node]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controls::ExtendControls;
    use crate::dsp::White;
    use crate::extend::window::triangle;

    #[test]
    fn root_solves_the_quadratic_without_cancelling() {
        for (a, b, c) in [(1.0, 0.0, -4.0), (2.0, 1e9, -3.0), (1e-12, 5.0, -1.0), (3.0, -7.0, -1e-9), (1.0, 2.0, 0.0)] {
            let root = positive_root(a, b, c);
            let scale = (a * root * root).abs() + (b * root).abs() + c.abs();
            assert!(root >= 0.0 && (a * root * root + b * root + c).abs() <= 1e-14 * scale, "{a} {b} {c}: {root}");
        }
        assert_eq!(positive_root(0.0, 2.0, -3.0), 1.5);
        assert_eq!(positive_root(0.0, 0.0, -3.0), 0.0);
    }

    #[test]
    fn transform_equals_the_sum() {
        let mut fitter = Fitter::new(500, 44_100.0, 30.0);
        fitter.set_band(&Band::new(&ExtendControls::default()));
        let mut signal = vec![0.0; 1000];
        White::new(1, 0).fill(0, &mut signal);
        let found = fitter.turn.spectrum(&signal);
        for (node, value) in found.iter().enumerate() {
            let phase = TAU * (180.0 + 4.0 * (node as f64 - 7.5)) / 44_100.0;
            let expected: Complex64 =
                signal.iter().enumerate().map(|(i, x)| Complex64::from_polar(*x, -phase * (i as f64 - 500.0))).sum();
            assert!((value - expected).norm() < 1e-10, "node {node}: {value} instead of {expected}");
        }
    }

    #[test]
    fn a_noise_that_is_empty_at_the_cutoff_is_held_by_its_expected_power() {
        let mut fitter = Fitter::new(500, 44_100.0, 30.0);
        let band = Band::new(&ExtendControls::default());
        let window = triangle(500);
        let tone = |gain: f64| -> Vec<f64> {
            window.iter().enumerate().map(|(i, w)| w * gain * (TAU * 180.0 * i as f64 / 44_100.0).sin()).collect()
        };
        fitter.set_drive(&band, &tone(1.0));
        let energy: f64 = window.iter().map(|w| w * w).sum();
        let (ordinary, ordinary_applied) = fitter.fit(&tone(0.3), energy, 1.0);
        let (outlier, outlier_applied) = fitter.fit(&tone(1e-4), energy, 1.0);
        assert!(ordinary_applied > 0.98 * ordinary && ordinary_applied <= ordinary);
        assert!(outlier > 1000.0 * ordinary, "{outlier} {ordinary}");
        assert!(outlier_applied < 100.0 * ordinary_applied, "{outlier_applied} {ordinary_applied}");
        // Silence leaves no trace.
        fitter.set_drive(&band, &[0.0; 1000]);
        assert_eq!(fitter.fit(&tone(0.3), energy, 1.0), (0.0, 0.0));
        fitter.set_drive(&band, &tone(1.0));
        assert_eq!(fitter.fit(&tone(0.3), energy, 1.0), (ordinary, ordinary_applied));
    }
}
