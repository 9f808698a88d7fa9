//! Pictures of sounds, for a dark page. They are drawn at twice the size at which the page shows them.

use std::path::Path;
use std::sync::Once;

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

use pyrophone_analysis::spectrogram::BAND_HZ;
use pyrophone_analysis::{Spectrogram, Spectrum};

/// Size of a spectrogram in pixels of the picture.
const SPECTROGRAM: (u32, u32) = (1360, 440);
/// Size of a spectrum.
const SPECTRUM: (u32, u32) = (860, 440);
/// Levels from black to white, in dB.
const RANGE_DB: f32 = 80.0;
/// Frequencies with a label.
const TICKS_HZ: [(f64, &str); 7] =
    [(30.0, "30"), (100.0, "100"), (300.0, "300"), (1e3, "1 k"), (3e3, "3 k"), (1e4, "10 k"), (20e3, "20 k")];

const BACKGROUND: RGBColor = RGBColor(0x15, 0x10, 0x10);
const GRID: RGBColor = RGBColor(0x33, 0x29, 0x27);
const LABEL: RGBColor = RGBColor(0xc0, 0xae, 0xa3);
/// Colour of a result.
pub const EMBER: RGBColor = RGBColor(0xff, 0x7a, 0x2f);
/// Colour of an input.
pub const FLAME_BLUE: RGBColor = RGBColor(0x6f, 0xb7, 0xff);
/// Colour of a recording.
pub const ASH: RGBColor = RGBColor(0xb9, 0xab, 0x9e);

/// Black body, roughly: level 0-1 to colour.
const HEAT: [(f32, [f32; 3]); 7] = [
    (0.0, [12.0, 8.0, 9.0]),
    (0.2, [44.0, 14.0, 26.0]),
    (0.4, [112.0, 26.0, 30.0]),
    (0.6, [193.0, 58.0, 22.0]),
    (0.78, [245.0, 125.0, 28.0]),
    (0.9, [255.0, 196.0, 84.0]),
    (1.0, [255.0, 250.0, 224.0]),
];

/// A curve of a spectrum plot.
pub struct Curve<'a> {
    /// Label in the legend.
    pub name: &'a str,
    /// The sound's spectrum.
    pub spectrum: &'a Spectrum,
    /// Added to every level.
    pub gain_db: f64,
    /// Colour.
    pub color: RGBColor,
    /// True for the main curve of the plot.
    pub is_main: bool,
}

/// Draws levels over time and frequency, with the colour scale beside it.
pub fn spectrogram(path: &Path, channels: &[Vec<f32>], sample_rate_hz: u32) -> Result<()> {
    let (left, right, top, bottom) = (78, 118, 14, 46);
    let (width, height) = (SPECTROGRAM.0 as i32 - left - right, SPECTROGRAM.1 as i32 - top - bottom);
    let (columns, rows) = (width as usize, height as usize);
    let levels = Spectrogram::of_channels(channels, sample_rate_hz, columns, rows);
    let highest = levels.top_db();
    draw(path, SPECTROGRAM, |area| {
        let pixels: Vec<u8> = (0..rows)
            .rev()
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .flat_map(|(column, row)| heat(1.0 + (levels.levels_db[column * levels.rows + row] - highest) / RANGE_DB))
            .collect();
        let image = BitMapElement::with_owned_buffer((left, top), (columns as u32, rows as u32), pixels)
            .ok_or_else(|| anyhow!("a picture of the wrong size"))?;
        area.draw(&image)?;
        for (frequency_hz, label) in TICKS_HZ {
            let y = top + (height as f64 * (1.0 - octave_share(frequency_hz))) as i32;
            area.draw(&PathElement::new([(left - 8, y), (left, y)], LABEL))?;
            area.draw(&Text::new(label, (left - 12, y), text(22, HPos::Right, VPos::Center)))?;
        }
        area.draw(&Text::new("Hz", (10, top + height + 14), text(20, HPos::Left, VPos::Top)))?;
        let seconds = channels.first().map_or(0, Vec::len) as f64 / f64::from(sample_rate_hz);
        let step = if seconds > 12.0 { 2 } else { 1 };
        for second in (0..=seconds as usize).step_by(step) {
            let x = left + (width as f64 * second as f64 / seconds) as i32;
            let y = top + height;
            let label = if second == 0 { "0 s".to_owned() } else { second.to_string() };
            area.draw(&PathElement::new([(x, y), (x, y + 8)], LABEL))?;
            area.draw(&Text::new(label, (x, y + 12), text(22, HPos::Center, VPos::Top)))?;
        }
        let x = left + width + 24;
        for y in 0..height {
            let [r, g, b] = heat(1.0 - y as f32 / height as f32);
            area.draw(&PathElement::new([(x, top + y), (x + 18, top + y)], RGBColor(r, g, b)))?;
        }
        for level in [0.0, -20.0, -40.0, -60.0, -80.0f32] {
            let y = top + (height as f32 * -level / RANGE_DB) as i32;
            let label = if level == 0.0 { "0 dB".to_owned() } else { format!("−{}", -level) };
            area.draw(&Text::new(
                label,
                (x + 26, y.clamp(top + 9, top + height - 9)),
                text(22, HPos::Left, VPos::Center),
            ))?;
        }
        Ok(())
    })
}

/// Draws overlaid power spectral densities, and a line of slope -`alpha` where one is given.
pub fn spectrum(path: &Path, curves: &[Curve<'_>], alpha: Option<f64>) -> Result<()> {
    let sampled: Vec<Vec<(f64, f64)>> = curves.iter().map(sample).collect();
    let loudest = sampled.iter().flatten().map(|(_, level)| *level).fold(f64::NEG_INFINITY, f64::max);
    let frame = PlotFrame { highest_db: (loudest / 10.0).ceil() * 10.0 };
    draw(path, SPECTRUM, |area| {
        frame.draw_axes(area)?;
        for (curve, points) in curves.iter().zip(&sampled) {
            let (stroke, opacity) = if curve.is_main { (4, 1.0) } else { (3, 0.85) };
            for run in points.split(|point| !frame.holds(*point)).filter(|run| run.len() > 1) {
                let places: Vec<(i32, i32)> = run.iter().map(|point| frame.place(*point)).collect();
                area.draw(&PathElement::new(places, curve.color.mix(opacity).stroke_width(stroke)))?;
            }
        }
        let mut legend: Vec<(String, RGBColor, bool)> =
            curves.iter().map(|curve| (curve.name.to_owned(), curve.color, false)).collect();
        let main = curves.iter().zip(&sampled).find(|(curve, _)| curve.is_main);
        if let (Some(alpha), Some((_, points))) = (alpha, main) {
            frame.draw_slope(area, alpha, points)?;
            legend.push((format!("slope −{alpha}"), LABEL, true));
        }
        frame.draw_legend(area, legend)
    })
}

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// Ranges of frequency and level in the picture of a spectrum.
struct PlotFrame {
    /// Level in dB per Hz of the upper edge.
    highest_db: f64,
}

impl PlotFrame {
    const LEFT: i32 = 92;
    const TOP: i32 = 14;
    const WIDTH: i32 = SPECTRUM.0 as i32 - Self::LEFT - 16;
    const HEIGHT: i32 = SPECTRUM.1 as i32 - Self::TOP - 46;
    /// Range from the lower to the upper edge in dB.
    const RANGE_DB: f64 = 100.0;

    fn place(&self, (frequency_hz, level_db): (f64, f64)) -> (i32, i32) {
        let x = f64::from(Self::WIDTH) * octave_share(frequency_hz);
        let y = f64::from(Self::HEIGHT) * (self.highest_db - level_db) / Self::RANGE_DB;
        (Self::LEFT + x as i32, Self::TOP + y as i32)
    }

    fn holds(&self, (_, level_db): (f64, f64)) -> bool {
        (self.highest_db - Self::RANGE_DB..=self.highest_db).contains(&level_db)
    }

    fn draw_axes(&self, area: &Area<'_>) -> Result<()> {
        for (frequency_hz, label) in TICKS_HZ {
            let (x, y) = self.place((frequency_hz, self.highest_db - Self::RANGE_DB));
            area.draw(&PathElement::new([(x, Self::TOP), (x, y)], GRID))?;
            let anchor = if frequency_hz > 15e3 { HPos::Right } else { HPos::Center };
            // There is no room for its label beside the last one.
            if frequency_hz != 1e4 {
                area.draw(&Text::new(label, (x, y + 12), text(22, anchor, VPos::Top)))?;
            }
        }
        for step in 0..=5 {
            let level_db = self.highest_db - 20.0 * f64::from(step);
            let (x, y) = self.place((BAND_HZ.0, level_db));
            area.draw(&PathElement::new([(x, y), (x + Self::WIDTH, y)], GRID))?;
            let label = format!("{level_db:.0}").replace('-', "−");
            area.draw(&Text::new(label, (x - 12, y.max(Self::TOP + 9)), text(22, HPos::Right, VPos::Center)))?;
        }
        let y = Self::TOP + Self::HEIGHT + 14;
        area.draw(&Text::new("dB/Hz", (8, y), text(20, HPos::Left, VPos::Top)))?;
        Ok(())
    }

    /// A dashed line of slope -`alpha`, a little above the curve with these points.
    fn draw_slope(&self, area: &Area<'_>, alpha: f64, points: &[(f64, f64)]) -> Result<()> {
        const FROM_HZ: f64 = 300.0;
        const TO_HZ: f64 = 12_000.0;
        const ANCHOR_HZ: f64 = 1_000.0;
        let anchor_db = points.iter().find(|point| point.0 >= ANCHOR_HZ).map_or(0.0, |point| point.1) + 8.0;
        let point = |share: f64| {
            let frequency_hz = FROM_HZ * (TO_HZ / FROM_HZ).powf(share);
            (frequency_hz, anchor_db - 10.0 * alpha * (frequency_hz / ANCHOR_HZ).log10())
        };
        for dash in 0..20 {
            let ends = [0.0, 0.5].map(|part| point((f64::from(dash) + part) / 20.0));
            if ends.iter().all(|end| self.holds(*end)) {
                area.draw(&PathElement::new(ends.map(|end| self.place(end)), LABEL.stroke_width(2)))?;
            }
        }
        Ok(())
    }

    fn draw_legend(&self, area: &Area<'_>, entries: Vec<(String, RGBColor, bool)>) -> Result<()> {
        let x = Self::LEFT + Self::WIDTH - 16;
        for (y, (name, color, is_dashed)) in (Self::TOP + 22..).step_by(30).zip(entries) {
            area.draw(&Text::new(name, (x - 50, y), text(22, HPos::Right, VPos::Center)))?;
            let strokes: &[(i32, i32)] = if is_dashed { &[(-40, -26), (-14, 0)] } else { &[(-40, 0)] };
            for (from, to) in strokes {
                area.draw(&PathElement::new([(x + from, y), (x + to, y)], color.stroke_width(4)))?;
            }
        }
        Ok(())
    }
}

fn sample(curve: &Curve<'_>) -> Vec<(f64, f64)> {
    let (low, high) = (BAND_HZ.0, BAND_HZ.1.min(0.97 * curve.spectrum.nyquist_hz()));
    (0..400)
        .map(|step| low * (high / low).powf(f64::from(step) / 399.0))
        .map(|f| (f, curve.spectrum.density_db(f) + curve.gain_db))
        .collect()
}

/// Position of a frequency between the lowest and the highest shown, 0-1.
fn octave_share(frequency_hz: f64) -> f64 {
    (frequency_hz / BAND_HZ.0).ln() / (BAND_HZ.1 / BAND_HZ.0).ln()
}

fn heat(level: f32) -> [u8; 3] {
    let level = level.clamp(0.0, 1.0);
    let above = HEAT.iter().position(|(at, _)| *at >= level).unwrap_or(HEAT.len() - 1).max(1);
    let ((from, a), (to, b)) = (HEAT[above - 1], HEAT[above]);
    let share = (level - from) / (to - from);
    std::array::from_fn(|channel| (a[channel] + share * (b[channel] - a[channel])).round() as u8)
}

fn text(size: i32, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    ("ubuntu", size).into_font().color(&LABEL).pos(Pos::new(horizontal, vertical))
}

fn draw(path: &Path, size: (u32, u32), content: impl FnOnce(&Area<'_>) -> Result<()>) -> Result<()> {
    static FONT: Once = Once::new();
    // A bundled font makes the picture independent of the system's fonts.
    FONT.call_once(|| {
        let _ = register_font("ubuntu", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    });
    let area = BitMapBackend::new(path, size).into_drawing_area();
    area.fill(&BACKGROUND)?;
    content(&area)?;
    area.present()?;
    Ok(())
}
