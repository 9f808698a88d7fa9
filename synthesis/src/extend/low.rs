//! The low part: the drive below the blend, through one linear-phase filter.
//!
//! The paper's windows sum to 1, so filtering every window alike is filtering the whole. If the filter differs between
//! two neighbouring windows, their outputs are crossfaded.
//!
//! A block lasts from the centre of window k to that of window k + 1. It is filtered in two halves, each as soon as its
//! drive has arrived, which is half a block before it must sound. In between, its transforms are done one at a time, and
//! the next filter is designed, so that no single sample has much to do.

use super::band::{Band, normalise};
use super::layout::ExtensionSizes;
use crate::dsp::{OverlapAdd, RingBuffer, Transform};

/// Low-passes blocks of one hop.
#[derive(Debug)]
pub(crate) struct Low {
    transform: Transform,
    layout: ExtensionSizes,
    sample_rate_hz: f64,
    /// Filters in force at the block's start and end, and a future one.
    filters: [Filter; 3],
    /// The filter being designed, and its finished parts.
    design: Option<(Band, usize)>,
    input: Vec<maths::fft::Complex64>,
    taps: Vec<f64>,
    block: Vec<f64>,
    half: Option<Half>,
}

#[derive(Debug)]
struct Filter {
    band: Option<Band>,
    response: Vec<f64>,
}

/// Half a block in progress.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Half {
    /// Position of its first sample, its offset in the block, and its length.
    pub start: i64,
    pub offset: usize,
    pub len: usize,
    /// Bands in force at the block's start and end.
    pub from: Band,
    pub to: Band,
    /// True if it begins from nothing.
    pub fades_in: bool,
}

impl Half {
    /// Adds it.
    fn add(&self, samples: impl ExactSizeIterator<Item = f64>, out: &mut OverlapAdd) {
        if self.fades_in {
            let len = self.len as f64;
            out.add(self.start, samples.enumerate().map(|(i, sample)| sample * i as f64 / len));
        } else {
            out.add(self.start, samples);
        }
    }
}

/// Parts in which the taps of a filter are computed; one more part transforms them.
const TAP_PARTS: usize = 4;
/// Number of parts of a design.
pub(crate) const DESIGN_PARTS: usize = TAP_PARTS + 1;

impl Low {
    pub fn new(layout: &ExtensionSizes, sample_rate_hz: f64) -> Self {
        let transform = Transform::new(layout.transform_len);
        let filter = || Filter { band: None, response: vec![0.0; transform.bins()] };
        Self {
            layout: *layout,
            sample_rate_hz,
            filters: [filter(), filter(), filter()],
            design: None,
            input: transform.spectrum.clone(),
            taps: vec![0.0; layout.low_reach + 1],
            block: vec![0.0; layout.half_width],
            half: None,
            transform,
        }
    }

    /// Discards all work in progress.
    pub fn reset(&mut self) {
        self.half = None;
    }

    /// Begins half a block, whose drive has arrived up to the filter's length after it.
    pub fn begin(&mut self, half: Half, drive: &RingBuffer) {
        let reach = self.layout.low_reach;
        let input = drive.slice(half.start - reach as i64, half.len + 2 * reach);
        self.half = None;
        if input.iter().all(|sample| *sample == 0.0) {
            return;
        }
        self.transform.time[..input.len()].copy_from_slice(input);
        self.transform.time[input.len()..].fill(0.0);
        self.transform.forward();
        self.input.copy_from_slice(&self.transform.spectrum);
        self.half = Some(half);
    }

    /// Filters it as at the block's start, and adds it if the end is the same.
    pub fn filter_from(&mut self, out: &mut OverlapAdd) {
        let Some(half) = self.half else { return };
        if self.filters[0].band != Some(half.from) {
            // A block usually begins with the filter that the block before ended with.
            if self.filters[1].band == Some(half.from) {
                self.filters.swap(0, 1);
            } else {
                self.set_filter(0, &half.from);
            }
        }
        self.filter(0, half.len);
        if half.from == half.to {
            half.add(self.block[..half.len].iter().copied(), out);
            self.half = None;
        }
    }

    /// Filters it as at the block's end, and adds the transition.
    pub fn filter_to(&mut self, out: &mut OverlapAdd) {
        let Some(half) = self.half.take() else { return };
        if self.filters[1].band != Some(half.to) {
            if self.filters[2].band == Some(half.to) {
                self.filters.swap(1, 2);
            } else {
                self.set_filter(1, &half.to);
            }
        }
        let (reach, hop) = (self.layout.low_reach, self.layout.half_width as f64);
        self.transform.spectrum.copy_from_slice(&self.input);
        self.transform.filter(&self.filters[1].response);
        let pairs = self.block[..half.len].iter().zip(&self.transform.time[reach..]).enumerate();
        let faded = pairs.map(|(i, (old, new))| old + (new - old) * (half.offset + i) as f64 / hop);
        half.add(faded, out);
    }

    /// Does one of the parts of designing the filter for a block's end, in order.
    pub fn design(&mut self, part: usize, band: &Band) {
        if self.filters[1..].iter().any(|filter| filter.band == Some(*band)) {
            return;
        }
        if part == 0 {
            self.design = Some((*band, 0));
        }
        if self.design != Some((*band, part)) {
            return;
        }
        self.design = Some((*band, part + 1));
        self.design_part(part, 2, band);
    }

    /// `block` = the half block filtered.
    fn filter(&mut self, which: usize, len: usize) {
        let reach = self.layout.low_reach;
        self.transform.spectrum.copy_from_slice(&self.input);
        self.transform.filter(&self.filters[which].response);
        self.block[..len].copy_from_slice(&self.transform.time[reach..reach + len]);
    }

    /// A filter that could not be designed ahead.
    fn set_filter(&mut self, which: usize, band: &Band) {
        self.design = None;
        (0..DESIGN_PARTS).for_each(|part| self.design_part(part, which, band));
    }

    fn design_part(&mut self, part: usize, which: usize, band: &Band) {
        let filter = &mut self.filters[which];
        if part < TAP_PARTS {
            filter.band = None;
            let count = self.taps.len();
            let range = part * count / TAP_PARTS..(part + 1) * count / TAP_PARTS;
            band.low_pass_taps(self.sample_rate_hz, range.start, &mut self.taps[range]);
        } else {
            normalise(&mut self.taps);
            self.transform.response(&self.taps, &mut filter.response);
            filter.band = Some(*band);
        }
    }
}
