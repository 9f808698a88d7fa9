//! Curves for a dark page, drawn at twice the size at which the page shows them.

use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

use super::raster::Picture;

/// Size in pixels.
const SIZE: (u32, u32) = (1360, 400);
/// Margins between the picture's edges and the plot's frame.
const MARGINS: (i32, i32, i32, i32) = (110, 20, 18, 52);
/// Font size in pixels.
const LETTERS: i32 = 21;

const BACKGROUND: RGBColor = RGBColor(0x15, 0x10, 0x10);
const GRID: RGBColor = RGBColor(0x33, 0x29, 0x27);
const LABEL: RGBColor = RGBColor(0xc0, 0xae, 0xa3);
const BAND: RGBColor = RGBColor(0x2a, 0x1b, 0x14);

/// Colour of a signal.
pub const EMBER: RGBColor = RGBColor(0xff, 0x7a, 0x2f);
/// Colour of the quantity it is derived from.
pub const GLOW: RGBColor = RGBColor(0xff, 0xc4, 0x54);
/// Colour of a secondary quantity.
pub const ASH: RGBColor = RGBColor(0xb9, 0xab, 0x9e);

/// Scale of an axis.
pub struct Axis {
    /// Lowest and highest value.
    pub range: (f64, f64),
    /// True for a logarithmic axis.
    pub logarithmic: bool,
    /// Unit, written at the end of the axis.
    pub unit: &'static str,
}

/// A curve with its axes.
pub struct Plot<'a> {
    /// Points in ascending order; those outside the y axis are left out.
    pub points: &'a [(f64, f64)],
    /// Colour of the curve.
    pub color: RGBColor,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Highlighted part of the x axis.
    pub band: Option<(f64, f64)>,
}

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

impl Plot<'_> {
    /// Draws the plot; fails with the drawing library's message.
    pub fn draw(&self) -> Result<Picture, String> {
        static FONT: Once = Once::new();
        // The picture does not depend on which fonts the system has.
        FONT.call_once(|| {
            let _ = register_font("ubuntu", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
        });
        let mut rgb = vec![0; (3 * SIZE.0 * SIZE.1) as usize];
        let area = BitMapBackend::with_buffer(&mut rgb, SIZE).into_drawing_area();
        self.draw_on(&area).map_err(|error| error.to_string().replace(['\n', '\r'], " "))?;
        drop(area);
        Ok(Picture { width: SIZE.0, height: SIZE.1, rgb })
    }

    fn draw_on(&self, area: &Area<'_>) -> Result<(), Box<dyn std::error::Error>> {
        let (left, right, top, bottom) = (MARGINS.0, SIZE.0 as i32 - MARGINS.1, MARGINS.2, SIZE.1 as i32 - MARGINS.3);
        let x = |value: f64| left + (self.x.share(value) * f64::from(right - left)).round() as i32;
        let y = |value: f64| bottom - (self.y.share(value) * f64::from(bottom - top)).round() as i32;
        area.fill(&BACKGROUND)?;
        if let Some((low, high)) = self.band {
            area.draw(&Rectangle::new([(x(low), top), (x(high), bottom)], BAND.filled()))?;
        }
        for (value, label) in self.x.ticks(7) {
            area.draw(&PathElement::new([(x(value), top), (x(value), bottom)], GRID))?;
            // Leaves room for the unit.
            if x(value) < right - 60 {
                area.draw(&Text::new(label, (x(value), bottom + 12), text(HPos::Center, VPos::Top)))?;
            }
        }
        for (value, label) in self.y.ticks(5) {
            area.draw(&PathElement::new([(left, y(value)), (right, y(value))], GRID))?;
            area.draw(&Text::new(label, (left - 12, y(value)), text(HPos::Right, VPos::Center)))?;
        }
        area.draw(&Text::new(self.x.unit, (right, bottom + 12), text(HPos::Right, VPos::Top)))?;
        area.draw(&Text::new(self.y.unit, (8, bottom + 12), text(HPos::Left, VPos::Top)))?;
        let is_within = |point: &(f64, f64)| (self.y.range.0..=self.y.range.1).contains(&point.1);
        for run in self.points.split(|point| !is_within(point)) {
            let places = thinned(run, (right - left) as usize, &x).into_iter().map(|(at, value)| (at, y(value)));
            let places: Vec<(i32, i32)> = places.collect();
            // Stroke by stroke: the corners of one long stroke would grow spikes.
            for stroke in places.windows(2) {
                area.draw(&PathElement::new(stroke, self.color.stroke_width(3)))?;
            }
        }
        Ok(area.present()?)
    }
}

impl Axis {
    /// An axis with some margin around `values`; it includes zero if that is near.
    pub fn around(values: impl Iterator<Item = f64>, unit: &'static str) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low < high {
            (low, high)
        } else if low.is_finite() {
            (low - 1.0, high + 1.0)
        } else {
            (0.0, 1.0)
        };
        let span = high - low;
        let air =
            |edge: f64, by: f64| if (edge / span).abs() < 0.5 && (edge + by) * edge < 0.0 { edge } else { edge + by };
        let low = if low > 0.0 && low < 0.5 * span { 0.0 } else { air(low, -0.06 * span) };
        Self { range: (low, air(high, 0.06 * span)), logarithmic: false, unit }
    }

    fn share(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        let share =
            if self.logarithmic { (value / low).ln() / (high / low).ln() } else { (value - low) / (high - low) };
        share.clamp(0.0, 1.0)
    }

    /// Round values within the axis, with labels; about as many as requested.
    fn ticks(&self, about: usize) -> Vec<(f64, String)> {
        let (low, high) = self.range;
        if self.logarithmic {
            let decades = (low.log10().floor() as i32..=high.log10().ceil() as i32)
                .flat_map(|power| [1.0, 3.0].map(|step| step * 10f64.powi(power)));
            let label = |hz: f64| if hz >= 1000.0 { format!("{} k", hz / 1000.0) } else { format!("{hz}") };
            return decades.filter(|hz| (low..=high).contains(hz)).map(|hz| (hz, label(hz))).collect();
        }
        let rough = (high - low) / about as f64;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * power >= rough).unwrap_or(10.0) * power;
        let digits = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        (first..=last).map(|n| (n as f64 * step, format!("{:.digits$}", n as f64 * step).replace('-', "−"))).collect()
    }
}

/// Lowest and highest of several points that fall into one column of pixels.
fn thinned(points: &[(f64, f64)], columns: usize, x: &impl Fn(f64) -> i32) -> Vec<(i32, f64)> {
    let mut kept: Vec<(i32, f64)> = vec![];
    if points.len() <= columns {
        kept.extend(points.iter().map(|(at, value)| (x(*at), *value)));
    } else {
        for column in points.chunk_by(|a, b| x(a.0) == x(b.0)) {
            let values = || column.iter().map(|point| point.1);
            let at = column.first().map_or(0, |point| x(point.0));
            let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
            let falls = kept.last().is_some_and(|before| before.1 > high);
            kept.extend(if falls { [(at, high), (at, low)] } else { [(at, low), (at, high)] });
        }
    }
    kept
}

fn text(horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    ("ubuntu", LETTERS).into_font().color(&LABEL).pos(Pos::new(horizontal, vertical))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        let labels = |range, logarithmic, about| {
            let axis = Axis { range, logarithmic, unit: "" };
            axis.ticks(about).into_iter().map(|tick| tick.1).collect::<Vec<_>>()
        };
        assert_eq!(labels((-0.6, 2.1), false, 4), ["0", "1", "2"]);
        assert_eq!(labels((0.0, 0.5), false, 7), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(labels((10.0, 22_050.0), true, 7), ["10", "30", "100", "300", "1 k", "3 k", "10 k"]);
    }

    #[test]
    fn axes_hold_their_values() {
        for values in [vec![1.0, 2.0], vec![-3.0, 5.0], vec![0.5], vec![], vec![100.0, 101.0], vec![-1e-9, 1e-9]] {
            let axis = Axis::around(values.iter().copied(), "");
            assert!(axis.range.0 < axis.range.1, "{values:?}");
            assert!(values.iter().all(|value| (axis.range.0..=axis.range.1).contains(value)), "{values:?}");
        }
    }

    #[test]
    fn a_curve_is_drawn_where_its_values_are() {
        let points: Vec<(f64, f64)> = (0..50_000).map(|n| (f64::from(n), if n < 25_000 { 0.0 } else { 1.0 })).collect();
        let axis = |range| Axis { range, logarithmic: false, unit: "" };
        let plot = Plot { points: &points, color: EMBER, x: axis((0.0, 5e4)), y: axis((0.0, 1.0)), band: None };
        let picture = plot.draw().unwrap();
        let is_ember = |x: u32, y: u32| {
            let at = (3 * (y * SIZE.0 + x)) as usize;
            picture.rgb[at..at + 3] == [EMBER.0, EMBER.1, EMBER.2]
        };
        assert!(is_ember(300, SIZE.1 - 52) && is_ember(1200, 18) && !is_ember(300, 18));
    }
}
