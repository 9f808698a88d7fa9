//! The noise part of one window: envelope, noise, fit, high-pass (§4, Algorithm 1).

use super::band::Band;
use super::beta::{Fit, Fitter};
use super::layout::Layout;
use super::noise::NoiseSource;
use super::spectrum::{Transform, quick_len};
use super::window::{History, Overlap, triangle};
use crate::controls::ExtendControls;
use crate::error::within;

/// Makes one window's noise at a time.
#[derive(Debug)]
pub(crate) struct High {
    layout: Layout,
    sample_rate_hz: f64,
    triangle: Vec<f64>,
    fitter: Fitter,
    /// For the envelope.
    short: Transform,
    /// For the output's high-pass.
    long: Transform,
    /// Cutoff and width in Hz that the two filters were made for.
    filters_for: Option<(f64, f64)>,
    envelope_response: Vec<f64>,
    high_pass_response: Vec<f64>,
    taps: Vec<f64>,
    /// The drive times the triangle, then the envelope times the triangle.
    windowed: Vec<f64>,
    noise: Vec<f64>,
}

impl High {
    pub fn new(layout: &Layout, sample_rate_hz: f64, fit_width_hz: f64) -> Self {
        let short = Transform::new(quick_len(2 * (layout.half_width + layout.envelope_reach)));
        let long = Transform::new(quick_len(2 * (layout.half_width + layout.high_reach)));
        Self {
            layout: *layout,
            sample_rate_hz,
            triangle: triangle(layout.half_width),
            fitter: Fitter::new(layout.half_width, sample_rate_hz, fit_width_hz),
            filters_for: None,
            envelope_response: vec![0.0; short.bins()],
            high_pass_response: vec![0.0; long.bins()],
            taps: vec![0.0; layout.envelope_reach.max(layout.high_reach) + 1],
            windowed: vec![0.0; 2 * layout.half_width],
            noise: vec![0.0; 2 * layout.half_width],
            short,
            long,
        }
    }

    /// Adds window `window` to the outputs, one per channel, and tells what was fitted.
    pub fn process(
        &mut self,
        window: i64,
        drive: &History,
        controls: &ExtendControls,
        source: &mut impl NoiseSource,
        fits: &mut [Fit],
        out: &mut [Overlap],
    ) {
        let start = (window - 1) * self.layout.half_width as i64;
        let segment = drive.slice(start, self.windowed.len());
        fits.fill(Fit { window, ..Fit::default() });
        let amount = within(controls.noise_amount, 0.0, 4.0);
        if amount == 0.0 || segment.iter().all(|sample| *sample == 0.0) {
            return;
        }
        let band = Band::new(controls);
        for (value, (sample, weight)) in self.windowed.iter_mut().zip(segment.iter().zip(&self.triangle)) {
            *value = sample * weight;
        }
        self.fitter.set_drive(&band, &self.windowed);
        self.set_filters(&band);
        self.window_envelope(start, drive);
        let energy = self.windowed.iter().map(|value| value * value).sum();
        let level = source.level(controls);
        for channel in 0..out.len() {
            // At width 0 all channels are alike, and what the first one left is still there.
            if channel == 0 || controls.width > 0.0 {
                source.fill(channel, start, controls, &mut self.noise);
                self.noise.iter_mut().zip(&self.windowed).for_each(|(noise, envelope)| *noise *= envelope);
                let (raw, applied) = self.fitter.fit(&self.noise, energy, level);
                fits[channel] = Fit { window, raw, applied };
                self.high_pass(applied * amount);
            } else {
                fits[channel] = fits[0];
            }
            let count = 2 * (self.layout.half_width + self.layout.high_reach);
            let piece = self.long.time[..count].iter().copied();
            out[channel].add(start - self.layout.high_reach as i64, piece);
        }
    }

    /// `windowed` = |low-passed drive| times triangle.
    fn window_envelope(&mut self, start: i64, drive: &History) {
        let reach = self.layout.envelope_reach;
        let input = drive.slice(start - reach as i64, self.windowed.len() + 2 * reach);
        self.short.time[..input.len()].copy_from_slice(input);
        self.short.time[input.len()..].fill(0.0);
        self.short.forward();
        self.short.filter(&self.envelope_response);
        let envelope = &self.short.time[reach..];
        for (value, (sample, weight)) in self.windowed.iter_mut().zip(envelope.iter().zip(&self.triangle)) {
            *value = sample.abs() * weight;
        }
    }

    /// `noise`, scaled, to the front of `long.time`, a filter's half-length later.
    fn high_pass(&mut self, gain: f64) {
        let reach = self.layout.high_reach;
        let time = &mut self.long.time;
        time.fill(0.0);
        for (sample, noise) in time[reach..].iter_mut().zip(&self.noise) {
            *sample = gain * noise;
        }
        self.long.forward();
        self.long.filter(&self.high_pass_response);
    }

    fn set_filters(&mut self, band: &Band) {
        let wanted = Some((band.cutoff_hz, band.width_hz));
        if self.filters_for == wanted {
            return;
        }
        self.filters_for = wanted;
        let taps = &mut self.taps[..=self.layout.envelope_reach];
        band.envelope_low_pass(self.sample_rate_hz, taps);
        self.short.response(taps, &mut self.envelope_response);
        let taps = &mut self.taps[..=self.layout.high_reach];
        band.high_pass(self.sample_rate_hz, taps);
        self.long.response(taps, &mut self.high_pass_response);
    }
}
