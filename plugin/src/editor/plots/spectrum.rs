//! Spectra of drive, recording and output on one plot, with handles for extension.

use egui::{Align2, Button, Color32, CursorIcon, Id as Place, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui, Vec2};
use pyrophone_settings::Id;

use super::super::param_editor::ParamEditor;
use super::super::suggestion::Suggestion;
use super::super::widgets::notches;
use super::super::{map, theme};
use pyrophone_analysis::bands::{BANDS, decibels, frequency_hz, place};
use pyrophone_analysis::fidelity::Diagnosis;
use pyrophone_analysis::{FLOOR_DB, Figures, RecordingOverview};

/// Time constant in seconds of the curves, and fall rate of their peaks.
const SMOOTHING_S: f32 = 0.5;
const FALL_DB_PER_S: f32 = 6.0;
/// Range of levels shown, and space above the loudest.
const RANGE_DB: f32 = 100.0;
const HEADROOM_DB: f32 = 8.0;
/// The lowest top: below it, the axis does not follow a fading sound.
const REST_DB: f32 = -60.0;
/// Height of a name on an axis, and the plot's width below which the legend is short, in points.
const NAME: f32 = 13.0;
const ROOM_FOR_SENTENCES: f32 = 400.0;
/// Share of its range by which an arrow key moves a handle.
const KEY_NOTCH: f64 = 0.01;
/// The band in which a recording's level is matched and its likeness measured, in Hz.
const LIKENESS_HZ: (f64, f64) = (250.0, 16_000.0);

/// A sound's recent spectrum.
#[derive(Debug, Clone)]
pub struct Track {
    power: [f32; BANDS],
    peak_db: [f32; BANDS],
}

impl Default for Track {
    fn default() -> Self {
        Self { power: [0.0; BANDS], peak_db: [FLOOR_DB; BANDS] }
    }
}

impl Track {
    /// Adds the power densities of one step.
    pub fn take(&mut self, density: &[f32; BANDS], step_s: f32) {
        let part = 1.0 - (-step_s / SMOOTHING_S).exp();
        for ((power, peak_db), now) in self.power.iter_mut().zip(&mut self.peak_db).zip(density) {
            *power += part * (now - *power);
            *peak_db = decibels(*power).max(*peak_db - FALL_DB_PER_S * step_s);
        }
    }

    fn levels_db(&self) -> [f32; BANDS] {
        self.power.map(decibels)
    }
}

/// Drive and output.
#[derive(Debug, Clone)]
pub struct Spectra {
    /// Drive.
    pub drive: Track,
    /// Output.
    pub output: Track,
    top_db: f32,
}

impl Default for Spectra {
    fn default() -> Self {
        Self { drive: Track::default(), output: Track::default(), top_db: REST_DB }
    }
}

/// Mapping of frequencies and levels to the screen.
#[derive(Clone, Copy)]
struct Axes {
    rect: Rect,
    top_db: f32,
}

impl Axes {
    fn x(&self, frequency_hz: f64) -> f32 {
        self.rect.left() + place(frequency_hz) as f32 * self.rect.width()
    }

    fn frequency_hz(&self, x: f32) -> f64 {
        frequency_hz(f64::from((x - self.rect.left()) / self.rect.width()))
    }

    fn y(&self, level_db: f32) -> f32 {
        self.rect.top() + (self.top_db - level_db) / RANGE_DB * self.rect.height()
    }

    fn level_db(&self, y: f32) -> f32 {
        self.top_db - (y - self.rect.top()) / self.rect.height() * RANGE_DB
    }
}

impl Spectra {
    /// Draws the plot; handles on it move parameters. `scaling_alpha` is the value in effect after reduction by the
    /// texture.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        recording: Option<&RecordingOverview>,
        told: &Advice,
        hand: &mut ParamEditor<'_>,
    ) {
        let (drive, output) = (self.drive.levels_db(), self.output.levels_db());
        let loudest = drive.iter().chain(&output).copied().fold(FLOOR_DB, f32::max);
        let wanted = (loudest + HEADROOM_DB).max(REST_DB);
        self.top_db += (wanted - self.top_db) * if wanted > self.top_db { 0.3 } else { 0.02 };
        let axes = Axes { rect, top_db: self.top_db };
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 3.0, theme::WELL);
        grid(&painter, &axes);
        let matched = recording.map(|overview| matched(&overview.spectrum_db, &output));
        if let Some((levels, _)) = &matched {
            curve(&painter, &axes, levels, Stroke::new(1.2, theme::ASH.gamma_multiply(0.8)));
        }
        for (track, levels, color) in [(&self.drive, &drive, theme::BLUE), (&self.output, &output, theme::EMBER)] {
            curve(&painter, &axes, &track.peak_db, Stroke::new(0.8, color.gamma_multiply(0.35)));
            curve(&painter, &axes, levels, Stroke::new(1.6, color));
        }
        // Handles without effect would mislead.
        if hand.inert(Id::Alpha as usize).is_none() {
            extension(ui, &painter, &axes, &drive, hand);
        }
        told.show(ui, &painter, rect, hand);
        legend(&painter, rect, matched.as_ref().and_then(|(_, likeness)| *likeness), recording.is_some());
        read_out(ui, &painter, &axes, &drive, &output);
    }
}

fn grid(painter: &egui::Painter, axes: &Axes) {
    let rule = Stroke::new(1.0, theme::LINE.gamma_multiply(0.6));
    for (frequency_hz, name) in [
        (50.0, "50"),
        (100.0, "100"),
        (200.0, "200"),
        (500.0, "500"),
        (1000.0, "1k"),
        (2000.0, "2k"),
        (5000.0, "5k"),
        (10_000.0, "10k"),
    ] {
        let x = axes.x(frequency_hz);
        painter.line_segment([Pos2::new(x, axes.rect.top()), Pos2::new(x, axes.rect.bottom())], rule);
        let at = Pos2::new(x + 3.0, axes.rect.bottom() - 2.0);
        painter.text(at, Align2::LEFT_BOTTOM, name, theme::small(), theme::WEAK);
    }
    let first = (axes.top_db / 20.0).floor() as i32;
    for level_db in (first - 6..=first).map(|n| 20 * n) {
        let y = axes.y(level_db as f32);
        painter.line_segment([Pos2::new(axes.rect.left(), y), Pos2::new(axes.rect.right(), y)], rule);
        // The frequencies' names are below.
        if y < axes.rect.bottom() - 2.0 * NAME {
            let at = Pos2::new(axes.rect.right() - 4.0, y + 1.0);
            painter.text(at, Align2::RIGHT_TOP, format!("{level_db}"), theme::small(), theme::WEAK);
        }
    }
}

fn curve(painter: &egui::Painter, axes: &Axes, levels_db: &[f32; BANDS], stroke: Stroke) {
    let points = levels_db.iter().enumerate().map(|(band, level)| {
        let x = axes.rect.left() + (band as f32 + 0.5) / BANDS as f32 * axes.rect.width();
        Pos2::new(x, axes.y(*level).min(axes.rect.bottom() + 2.0))
    });
    painter.add(Shape::line(points.collect(), stroke));
}

/// A recording's spectrum at the output's level, and the mean distance of the two, in dB; with a silent output, at its
/// own level.
fn matched(recording: &[f32; BANDS], output: &[f32; BANDS]) -> ([f32; BANDS], Option<f32>) {
    let band = |frequency_hz: f64| (place(frequency_hz) * BANDS as f64) as usize;
    let span = band(LIKENESS_HZ.0)..band(LIKENESS_HZ.1);
    let compared = || span.clone().filter(|at| output[*at] > -140.0 && recording[*at] > -140.0);
    let count = compared().count();
    if count < span.len() / 2 {
        return (*recording, None);
    }
    let offset = compared().map(|at| output[at] - recording[at]).sum::<f32>() / count as f32;
    let apart = compared().map(|at| (output[at] - recording[at] - offset).abs()).sum::<f32>() / count as f32;
    (recording.map(|level| level + offset), Some(apart))
}

/// Cutoff, blend and fit, and the slope that noise continues the drive with; each can be dragged.
fn extension(ui: &Ui, painter: &egui::Painter, axes: &Axes, drive: &[f32; BANDS], hand: &mut ParamEditor<'_>) {
    let (cutoff_hz, blend_hz) = (hand.get(Id::Cutoff), hand.get(Id::BlendWidth));
    let (fit_hz, alpha) = (hand.get(Id::FitWidth), hand.get(Id::Alpha));
    let (top, bottom) = (axes.rect.top(), axes.rect.bottom());
    let edges = [-0.5, 0.5].map(|side| axes.x((cutoff_hz + side * blend_hz).max(1.0)));
    let band = Rect::from_min_max(Pos2::new(edges[0], top), Pos2::new(edges[1], bottom));
    painter.rect_filled(band, 0.0, theme::EMBER.gamma_multiply(0.10));
    let fit = [-1.0, 1.0].map(|side| axes.x((cutoff_hz + side * fit_hz).max(1.0)));
    painter.line_segment([Pos2::new(fit[0], top + 3.0), Pos2::new(fit[1], top + 3.0)], Stroke::new(2.0, theme::BLUE));

    let mut handle = |name: &str, at: Rect, cursor: CursorIcon, help: &str, id: Id, to: &dyn Fn(Pos2) -> f64| -> bool {
        let place = Place::unique(("spectrum", name));
        let response = ui.interact(at, place, Sense::click_and_drag()).on_hover_cursor(cursor);
        map::note(ui, format_args!("handle.{name}"), at);
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if let notches @ (-1.0 | 1.0) = notches(ui, &response) {
            let parameter = id.parameter();
            let now = parameter.to_normalised(hand.get(id));
            hand.set_once(id as usize, parameter.from_normalised((now + KEY_NOTCH * notches).clamp(0.0, 1.0)));
        }
        if response.drag_started() {
            hand.begin(id as usize);
        }
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            hand.set(id as usize, to(pointer));
        }
        if response.drag_stopped() {
            hand.end(id as usize);
        }
        let is_hot = response.hovered() || response.dragged() || response.has_focus();
        response.on_hover_text(help);
        is_hot
    };
    // The lower third is for the blend, which is often narrower than the pointer's precision.
    let third = bottom - 0.3 * (bottom - top);
    let x = axes.x(cutoff_hz);
    let area = |left: f32, right: f32, top: f32, bottom: f32| {
        Rect::from_min_max(Pos2::new(left, top), Pos2::new(right, bottom))
    };
    let across = CursorIcon::ResizeHorizontal;
    let widen = |pointer: Pos2| 2.0 * (axes.frequency_hz(pointer.x) - cutoff_hz).abs();
    let mut is_wide = false;
    let below = area(edges[0] - 8.0, (edges[0] + 4.0).min(x - 1.0), third, bottom);
    let above = area((edges[1] - 4.0).max(x + 1.0), edges[1] + 8.0, third, bottom);
    for (name, area) in [("blend low", below), ("blend high", above)] {
        is_wide |= handle(name, area, across, "Blend width: drag", Id::BlendWidth, &widen);
    }
    let line_area = area(x - 5.0, x + 5.0, top + 14.0, third - 4.0);
    let is_cutoff =
        handle("cutoff", line_area, across, "Cutoff: drag", Id::Cutoff, &|pointer| axes.frequency_hz(pointer.x));
    let line = |x: f32, width: f32| {
        painter.line_segment(
            [Pos2::new(x, top), Pos2::new(x, bottom)],
            Stroke::new(width, theme::EMBER.gamma_multiply(0.8)),
        );
    };
    line(x, if is_cutoff { 2.5 } else { 1.2 });
    let width = if is_wide { 2.0 } else { 1.0 };
    for x in edges {
        let stroke = Stroke::new(width, theme::EMBER.gamma_multiply(0.6));
        painter.line_segment([Pos2::new(x, third), Pos2::new(x, bottom)], stroke);
    }

    // The noise continues from the drive's level about the cutoff.
    let at = ((place(cutoff_hz) * BANDS as f64) as usize).min(BANDS - 1);
    let start_db = drive[at.saturating_sub(3)..(at + 4).min(BANDS)].iter().copied().fold(FLOOR_DB, f32::max);
    let start_db = if start_db > FLOOR_DB + 20.0 { start_db } else { axes.top_db - 40.0 };
    let end_hz = 20_000.0;
    let decades = |frequency_hz: f64| (frequency_hz / cutoff_hz).log10();
    let level_at = |frequency_hz: f64| start_db - (10.0 * alpha * decades(frequency_hz)) as f32;
    let target =
        [(cutoff_hz, start_db), (end_hz, level_at(end_hz))].map(|(f, level)| Pos2::new(axes.x(f), axes.y(level)));
    painter.extend(Shape::dashed_line(&target, Stroke::new(1.4, theme::TEXT.gamma_multiply(0.8)), 5.0, 4.0));
    let grip_hz = cutoff_hz * (end_hz / cutoff_hz).powf(0.35);
    let grip = Pos2::new(axes.x(grip_hz), axes.y(level_at(grip_hz)).clamp(top + 8.0, bottom - 8.0));
    let tilt = |pointer: Pos2| f64::from(start_db - axes.level_db(pointer.y)) / (10.0 * decades(grip_hz));
    let help = "Alpha: the slope of the added noise; drag up or down";
    let area = Rect::from_center_size(grip, Vec2::splat(18.0));
    let is_alpha = handle("alpha", area, CursorIcon::ResizeVertical, help, Id::Alpha, &tilt);
    painter.circle_filled(grip, if is_alpha { 7.5 } else { 6.0 }, theme::EMBER);
    painter.circle_stroke(grip, 6.0, Stroke::new(1.0, theme::TEXT));
    let text = format!("α {alpha:.2}");
    painter.text(grip + Vec2::new(12.0, -6.0), Align2::LEFT_BOTTOM, text, theme::small(), theme::TEXT);
}

fn legend(painter: &egui::Painter, rect: Rect, apart_db: Option<f32>, has_recording: bool) {
    let mut at = rect.left_top() + Vec2::new(8.0, 5.0);
    let mut word = |text: &str, color: Color32| {
        let drawn = readable(painter, at, text, color);
        at.x = drawn.right() + 12.0;
    };
    word("drive", theme::BLUE);
    word("output", theme::EMBER);
    if has_recording {
        match apart_db {
            Some(apart_db) if rect.width() < ROOM_FOR_SENTENCES => {
                word(&format!("recording ±{apart_db:.1} dB"), theme::ASH)
            }
            Some(apart_db) => {
                word("recording, level matched", theme::ASH);
                word(&format!("output within {apart_db:.1} dB of it"), theme::WEAK);
            }
            None => word("recording", theme::ASH),
        }
    }
}

/// Text that stays readable over curves; returns its area.
fn readable(painter: &egui::Painter, at: Pos2, text: &str, color: Color32) -> Rect {
    let room = painter.clip_rect().right() - at.x - 8.0;
    let galley = painter.layout(text.to_owned(), theme::small(), color, room.max(40.0));
    let place = Rect::from_min_size(at, galley.size());
    painter.rect_filled(place.expand(1.5), 2.0, theme::behind_words());
    painter.galley(at, galley, color);
    place
}

/// Judgement of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advice {
    /// Its similarity to the recording, and its correlation with the drive.
    pub figures: Figures,
    /// Present or foreseeable fault.
    pub fault: Option<Diagnosis>,
    /// Scaling alpha after its reduction by Scaling auto.
    pub scaling_alpha: f32,
}

impl Advice {
    /// The figures, the suggested change, and a button that applies it.
    fn show(&self, ui: &mut Ui, painter: &egui::Painter, rect: Rect, hand: &mut ParamEditor<'_>) {
        let mut words = vec![];
        words.extend(self.figures.follows.map(|follows| format!("follows {follows:.2}")));
        words.extend(self.figures.lines_db.map(|lines_db| format!("tones +{lines_db:.1} dB")));
        words.extend(self.figures.crackle.map(|crackle| format!("crackle ×{crackle:.1}")));
        if hand.get(Id::ScalingAuto) > 0.5 {
            words.push(format!("scaling {:.2}", self.scaling_alpha));
        }
        if words.is_empty() && self.fault.is_none() {
            return;
        }
        let at = rect.left_top() + Vec2::new(8.0, 21.0);
        let drawn = readable(painter, at, &words.join("   "), theme::WEAK);
        let area = ui.interact(drawn, Place::unique("figures"), Sense::hover());
        area.on_hover_text(
            "Over the last eight seconds. Follows: correlation of the output's loudness with the drive's, 1 at best. \
             Tones: how far the output's strongest tones stand out beyond the recording's; noise has none, a buzz 3 dB or more. \
             Crackle: how sudden the output is, as a multiple of the recording; 1 at best. \
             Scaling: Scaling alpha as lowered by Scaling auto.",
        );
        let Some(fault) = self.fault else { return };
        let at = at + Vec2::new(0.0, 15.0);
        let remedy = Suggestion::of(fault, &hand.values());
        let advice = readable(painter, at, fault.advice(remedy.is_none()), theme::EMBER);
        let Some(remedy) = remedy else { return };
        let place = Rect::from_min_size(advice.left_bottom() + Vec2::new(0.0, 3.0), Vec2::new(150.0, 18.0));
        let button = Button::new(RichText::new(&remedy.words).font(theme::small())).truncate();
        map::note(ui, "button.Cure", place);
        if ui.put(place, button).on_hover_text("Applies the suggestion; Undo reverts it").clicked() {
            hand.set_once(remedy.id as usize, remedy.plain);
        }
    }
}

/// Frequency and levels under the pointer.
fn read_out(ui: &Ui, painter: &egui::Painter, axes: &Axes, drive: &[f32; BANDS], output: &[f32; BANDS]) {
    let Some(pointer) = ui.input(|input| input.pointer.hover_pos()).filter(|at| axes.rect.contains(*at)) else {
        return;
    };
    let frequency_hz = axes.frequency_hz(pointer.x);
    let band = ((place(frequency_hz) * BANDS as f64) as usize).min(BANDS - 1);
    let hair = Stroke::new(1.0, theme::TEXT.gamma_multiply(0.25));
    painter.line_segment([Pos2::new(pointer.x, axes.rect.top()), Pos2::new(pointer.x, axes.rect.bottom())], hair);
    let text = format!("{frequency_hz:.0} Hz   drive {:.0}   output {:.0} dB/Hz", drive[band], output[band]);
    // Above the frequencies' names, where curves are rare, and clear of the levels' names.
    let at = axes.rect.left_bottom() + Vec2::new(8.0, -30.0);
    readable(painter, at, &text, theme::TEXT);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn likeness_does_not_depend_on_the_level() {
        let recording: [f32; BANDS] = std::array::from_fn(|band| -60.0 - 0.2 * band as f32);
        let quieter = recording.map(|level| level - 23.0);
        let (levels, apart) = matched(&recording, &quieter);
        assert!(apart.unwrap() < 1e-3);
        assert!(levels.iter().zip(&quieter).all(|(a, b)| (a - b).abs() < 1e-3));
        let tilted: [f32; BANDS] = std::array::from_fn(|band| recording[band] + 0.1 * band as f32);
        let apart = matched(&recording, &tilted).1.unwrap();
        assert!((1.5..6.0).contains(&apart), "{apart}");
        assert_eq!(matched(&recording, &[FLOOR_DB; BANDS]), (recording, None));
    }

    #[test]
    fn tracks_smooth_and_their_peaks_fall() {
        let mut track = Track::default();
        for _ in 0..200 {
            track.take(&[1e-6; BANDS], 0.03);
        }
        assert!((track.levels_db()[0] + 60.0).abs() < 0.1);
        for _ in 0..100 {
            track.take(&[0.0; BANDS], 0.03);
        }
        assert!(track.levels_db()[0] < -80.0);
        assert!((track.peak_db[0] + 78.0).abs() < 1.0, "{}", track.peak_db[0]);
    }
}
