//! The noise part: envelope, noise, fit, high-pass (§4, Algorithm 1), window by window.
//!
//! A window is due when its last drive sample, and the envelope's filter after it, have arrived, and its first sample
//! must sound at once. Only work that cannot be done earlier happens then: the envelope of its second half, and the
//! fit. Everything else is done in steps during the hop before and the hop after. Before, the noise and the filters are
//! made from the controls at the window's centre, and the first half's noise is high-passed without its gain. The second
//! half, which sounds a hop later, is high-passed afterwards.

use super::band::{Band, complement, normalise};
use super::beta::{Fit, Fitter};
use super::layout::ExtensionSizes;
use super::noise::NoiseSource;
use super::window::triangle;
use crate::controls::ExtendControls;
use crate::dsp::{OverlapAdd, RingBuffer, Transform, quick_len};
use crate::error::within;

/// Steps of designing the filters.
const DESIGN_STEPS: usize = 5;
/// Steps of a half's envelope, and of a channel's high-pass: forward, and back.
const TRANSFORM_STEPS: usize = 2;

/// Generator of the windows' noise.
#[derive(Debug)]
pub(crate) struct High {
    layout: ExtensionSizes,
    sample_rate_hz: f64,
    triangle: Vec<f64>,
    fitter: Fitter,
    /// Transform for half an envelope.
    short: Transform,
    /// Transform for the high-pass of half an output.
    long: Transform,
    filters: Filters,
    /// The drive times the triangle, then the envelope times the triangle.
    windowed: Vec<f64>,
    envelope: Vec<f64>,
    channels: Vec<Channel>,
    /// Part of the previous window that is still to be high-passed.
    falling: Falling,
    /// The window being prepared.
    coming: Option<Coming>,
    /// Steps done since the previous window was due.
    done: usize,
}

/// Second halves that are still to be high-passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Falling {
    None,
    /// Each channel's own.
    Own,
    /// The first channel's, for all.
    Shared,
}

/// A channel's share of a window.
#[derive(Debug, Clone)]
struct Channel {
    noise: Vec<f64>,
    /// The first half, high-passed without its gain.
    rising: Vec<f64>,
    /// The second half, with it.
    falling: Vec<f64>,
}

#[derive(Debug)]
struct Filters {
    /// Cutoff and width in Hz of the present filters.
    made_for: Option<(f64, f64)>,
    /// Cutoff and width of the filters in progress, and the steps done.
    design: Option<((f64, f64), usize)>,
    envelope: Vec<f64>,
    high_pass: Vec<f64>,
    taps: Vec<f64>,
}

/// A window that is not yet due.
#[derive(Debug, Clone, Copy)]
struct Coming {
    /// Position of its first sample.
    start: i64,
    controls: ExtendControls,
    band: Band,
}

/// Working data of the steps.
pub(crate) struct Surroundings<'a, N> {
    pub drive: &'a RingBuffer,
    pub source: &'a mut N,
    pub out: &'a mut [OverlapAdd],
}

impl High {
    pub fn new(layout: &ExtensionSizes, channels: usize, sample_rate_hz: f64, fit_width_hz: f64) -> Self {
        let half = layout.half_width;
        let short = Transform::new(quick_len(half + 2 * layout.envelope_reach));
        let long = Transform::new(quick_len(half + 2 * layout.high_reach));
        let filters = Filters {
            made_for: None,
            design: None,
            envelope: vec![0.0; short.bins()],
            high_pass: vec![0.0; long.bins()],
            taps: vec![0.0; layout.envelope_reach.max(layout.high_reach) + 1],
        };
        let channel = Channel {
            noise: vec![0.0; 2 * half],
            rising: vec![0.0; half + 2 * layout.high_reach],
            falling: vec![0.0; half],
        };
        Self {
            layout: *layout,
            sample_rate_hz,
            triangle: triangle(half),
            fitter: Fitter::new(half, sample_rate_hz, fit_width_hz),
            filters,
            windowed: vec![0.0; 2 * half],
            envelope: vec![0.0; 2 * half],
            channels: vec![channel; channels],
            falling: Falling::None,
            coming: None,
            done: 0,
            short,
            long,
        }
    }

    /// Forgets all windows.
    pub fn reset(&mut self) {
        self.falling = Falling::None;
        self.coming = None;
        self.done = 0;
    }

    /// Steps between the due samples of two consecutive windows, for a noise source with `of_source` steps.
    pub fn steps(&self, of_source: usize) -> usize {
        let channels = self.channels.len();
        channels * TRANSFORM_STEPS + DESIGN_STEPS + of_source + TRANSFORM_STEPS + channels * TRANSFORM_STEPS
    }

    /// True if the next step concerns the coming window, not the previous one.
    pub fn is_ahead(&self) -> bool {
        self.done >= self.channels.len() * TRANSFORM_STEPS
    }

    /// Steps done.
    pub fn done(&self) -> usize {
        self.done
    }

    /// Does the next step. `coming` are first sample and controls of the coming window.
    pub fn step(&mut self, (start, controls): (i64, &ExtendControls), with: &mut Surroundings<'_, impl NoiseSource>) {
        let mut step = self.done;
        self.done += 1;
        let of_channels = self.channels.len() * TRANSFORM_STEPS;
        if step < of_channels {
            self.falling_step(step, start - self.layout.half_width as i64, with.out);
            return;
        }
        step -= of_channels;
        if step == 0 {
            self.coming = Some(Coming { start, controls: *controls, band: Band::new(controls) });
        }
        let Some(coming) = self.coming else { return };
        if within(coming.controls.noise_amount, 0.0, 4.0) == 0.0 {
            return;
        }
        if step < DESIGN_STEPS {
            self.filter_step(step, &coming.band);
            return;
        }
        step -= DESIGN_STEPS;
        if step < with.source.steps() {
            with.source.prepare(step, coming.start, &coming.controls);
            return;
        }
        step -= with.source.steps();
        if step < TRANSFORM_STEPS {
            self.envelope_step(step, coming.start, 0, with.drive);
        } else {
            self.rising_step(step - TRANSFORM_STEPS, &coming, with.source);
        }
    }

    /// Finishes the window from `start` on, which is due: returns the fit, and adds its first half to the outputs.
    pub fn process(
        &mut self,
        (window, start): (i64, i64),
        controls: &ExtendControls,
        with: &mut Surroundings<'_, impl NoiseSource>,
        fits: &mut [Fit],
    ) {
        fits.fill(Fit { window, ..Fit::default() });
        let half = self.layout.half_width;
        let segment = with.drive.slice(start, 2 * half);
        let amount = within(controls.noise_amount, 0.0, 4.0);
        let is_heard = amount != 0.0 && segment.iter().any(|sample| *sample != 0.0);
        let all = self.steps(with.source.steps());
        let needed = if is_heard { all } else { self.channels.len() * TRANSFORM_STEPS };
        while self.done < needed {
            self.step((start, controls), with);
        }
        self.done = 0;
        self.coming = None;
        if !is_heard {
            return;
        }
        for (value, (sample, weight)) in self.windowed.iter_mut().zip(segment.iter().zip(&self.triangle)) {
            *value = sample * weight;
        }
        self.fitter.set_drive(&Band::new(controls), &self.windowed);
        (0..TRANSFORM_STEPS).for_each(|step| self.envelope_step(step, start, half, with.drive));
        let energy = self.envelope.iter().map(|value| value * value).sum();
        let level = with.source.level(controls);
        // At width 0 all channels are alike.
        let is_shared = controls.width <= 0.0;
        for channel in 0..self.channels.len() {
            let of = if is_shared { 0 } else { channel };
            fits[channel] = if channel > of { fits[0] } else { self.fit(channel, window, energy, level, amount) };
            let gain = fits[channel].applied * amount;
            let rising = self.channels[of].rising.iter().map(|sample| gain * sample);
            with.out[channel].add(start - self.layout.high_reach as i64, rising);
        }
        self.falling = if is_shared { Falling::Shared } else { Falling::Own };
    }

    /// Fits a channel's noise, and stores the data for its second half.
    fn fit(&mut self, channel: usize, window: i64, energy: f64, level: f64, amount: f64) -> Fit {
        let Channel { noise, falling, .. } = &mut self.channels[channel];
        noise.iter_mut().zip(&self.envelope).for_each(|(noise, envelope)| *noise *= envelope);
        let (raw, applied) = self.fitter.fit(noise, energy, level);
        for (kept, noise) in falling.iter_mut().zip(&noise[self.layout.half_width..]) {
            *kept = applied * amount * noise;
        }
        Fit { window, raw, applied }
    }

    /// High-passes a channel's second half of the previous window, which begins at `start`.
    fn falling_step(&mut self, step: usize, start: i64, out: &mut [OverlapAdd]) {
        let (channel, step) = (step / TRANSFORM_STEPS, step % TRANSFORM_STEPS);
        if self.falling == Falling::None || self.falling == Falling::Shared && channel > 0 {
            return;
        }
        if step == 0 {
            high_pass_begin(&mut self.long, self.layout.high_reach, self.channels[channel].falling.iter().copied());
            return;
        }
        self.long.filter(&self.filters.high_pass);
        let count = self.layout.half_width + 2 * self.layout.high_reach;
        let first = start + self.layout.half_width as i64 - self.layout.high_reach as i64;
        let last = if self.falling == Falling::Shared { self.channels.len() } else { channel + 1 };
        for out in &mut out[channel..last] {
            out.add(first, self.long.time[..count].iter().copied());
        }
        if last == self.channels.len() {
            self.falling = Falling::None;
        }
    }

    /// Generates a channel's noise, and high-passes its first half without its gain.
    fn rising_step(&mut self, step: usize, coming: &Coming, source: &mut impl NoiseSource) {
        let (channel, step) = (step / TRANSFORM_STEPS, step % TRANSFORM_STEPS);
        if channel > 0 && coming.controls.width <= 0.0 {
            return;
        }
        let (half, reach) = (self.layout.half_width, self.layout.high_reach);
        let Channel { noise, rising, .. } = &mut self.channels[channel];
        if step == 0 {
            source.fill(channel, coming.start, &coming.controls, noise);
            let windowed = noise[..half].iter().zip(&self.envelope).map(|(noise, envelope)| noise * envelope);
            high_pass_begin(&mut self.long, reach, windowed);
        } else {
            self.long.filter(&self.filters.high_pass);
            rising.copy_from_slice(&self.long.time[..half + 2 * reach]);
        }
    }

    /// Half of `envelope`, from `from` on, = |low-passed drive| times triangle.
    fn envelope_step(&mut self, step: usize, start: i64, from: usize, drive: &RingBuffer) {
        let (half, reach) = (self.layout.half_width, self.layout.envelope_reach);
        if step == 0 {
            let input = drive.slice(start + from as i64 - reach as i64, half + 2 * reach);
            self.short.time[..input.len()].copy_from_slice(input);
            self.short.time[input.len()..].fill(0.0);
            self.short.forward();
            return;
        }
        self.short.filter(&self.filters.envelope);
        let weighed = self.short.time[reach..].iter().zip(&self.triangle[from..]);
        for (value, (sample, weight)) in self.envelope[from..from + half].iter_mut().zip(weighed) {
            *value = sample.abs() * weight;
        }
    }

    /// Does a step of designing both filters, in order.
    fn filter_step(&mut self, step: usize, band: &Band) {
        let wanted = (band.cutoff_hz, band.width_hz);
        let Filters { made_for, design, envelope, high_pass, taps } = &mut self.filters;
        if step == 0 {
            self.fitter.set_band(band);
            *design = (*made_for != Some(wanted)).then_some((wanted, 0));
        }
        if *design != Some((wanted, step)) {
            return;
        }
        *design = Some((wanted, step + 1));
        *made_for = None;
        let (envelope_reach, high_reach) = (self.layout.envelope_reach, self.layout.high_reach);
        match step {
            0 => band.envelope_low_pass(self.sample_rate_hz, &mut taps[..=envelope_reach]),
            1 => self.short.response(&taps[..=envelope_reach], envelope),
            2 => band.low_pass_taps(self.sample_rate_hz, 0, &mut taps[..high_reach / 2]),
            3 => band.low_pass_taps(self.sample_rate_hz, high_reach / 2, &mut taps[high_reach / 2..=high_reach]),
            _ => {
                let taps = &mut taps[..=high_reach];
                normalise(taps);
                complement(taps);
                self.long.response(taps, high_pass);
                *made_for = Some(wanted);
            }
        }
    }
}

/// Transforms half a window's noise with `long`; after filtering, its output begins the filter's half-length earlier.
fn high_pass_begin(long: &mut Transform, reach: usize, noise: impl Iterator<Item = f64>) {
    long.time.fill(0.0);
    long.time[reach..].iter_mut().zip(noise).for_each(|(sample, noise)| *sample = noise);
    long.forward();
}
