//! The low part: the drive below the blend, through one linear-phase filter.
//!
//! The paper's windows sum to 1, so filtering every window alike is filtering the whole. Where the
//! filter differs between two neighbouring windows, their outputs are crossfaded.

use super::band::Band;
use super::layout::Layout;
use super::spectrum::Transform;
use super::window::{History, Overlap};

/// Low-passes blocks of one hop, from window k's centre to window k+1's.
#[derive(Debug)]
pub(crate) struct Low {
    transform: Transform,
    layout: Layout,
    sample_rate_hz: f64,
    /// Filters in force at the block's begin and end.
    filters: [Filter; 2],
    input: Vec<crate::fft::Complex64>,
    taps: Vec<f64>,
    block: Vec<f64>,
}

#[derive(Debug)]
struct Filter {
    band: Option<Band>,
    response: Vec<f64>,
}

impl Low {
    pub fn new(layout: &Layout, sample_rate_hz: f64) -> Self {
        let transform = Transform::new(layout.transform_len);
        let filter = || Filter { band: None, response: vec![0.0; transform.bins()] };
        Self {
            layout: *layout,
            sample_rate_hz,
            filters: [filter(), filter()],
            input: transform.spectrum.clone(),
            taps: vec![0.0; layout.low_reach + 1],
            block: vec![0.0; layout.half_width],
            transform,
        }
    }

    /// Adds the block from `start` on, with `from` in force at its begin and `to` at its end.
    pub fn process(&mut self, start: i64, drive: &History, from: &Band, to: &Band, out: &mut Overlap) {
        let (hop, reach) = (self.layout.half_width, self.layout.low_reach);
        let input = drive.slice(start - reach as i64, hop + 2 * reach);
        if input.iter().all(|sample| *sample == 0.0) {
            return;
        }
        if self.filters[1].band.as_ref() == Some(from) {
            self.filters.swap(0, 1);
        }
        self.set_filter(0, from);
        self.transform.time[..input.len()].copy_from_slice(input);
        self.transform.time[input.len()..].fill(0.0);
        self.transform.forward();
        if from == to {
            self.transform.filter(&self.filters[0].response);
            out.add(start, self.transform.time[reach..reach + hop].iter().copied());
            return;
        }
        self.input.copy_from_slice(&self.transform.spectrum);
        self.transform.filter(&self.filters[0].response);
        self.block.copy_from_slice(&self.transform.time[reach..reach + hop]);
        self.set_filter(1, to);
        self.transform.spectrum.copy_from_slice(&self.input);
        self.transform.filter(&self.filters[1].response);
        let faded = self.block.iter().zip(&self.transform.time[reach..]).enumerate();
        out.add(start, faded.map(|(i, (old, new))| old + (new - old) * i as f64 / hop as f64));
    }

    fn set_filter(&mut self, which: usize, band: &Band) {
        let filter = &mut self.filters[which];
        if filter.band != Some(*band) {
            band.low_pass(self.sample_rate_hz, &mut self.taps);
            self.transform.response(&self.taps, &mut filter.response);
            filter.band = Some(*band);
        }
    }
}
