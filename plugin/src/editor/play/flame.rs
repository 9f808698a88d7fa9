//! Signal that drives the sound: the track, the sidechain, or the built-in flame.

use egui::{Align2, FontFamily, FontId, Id as Place, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2};
use pyrophone_settings::Id;
use pyrophone_settings::table::{DRIVE_MODES, FLAME_SCENES};

use super::super::levels::{FLOOR_DB, Level, Meter};
use super::super::param_editor::ParamEditor;
use super::super::widgets::baked::{baked, bits};
use super::super::widgets::knob::{Look, named_dial};
use super::super::widgets::pick::list;
use super::super::widgets::section::{columns, filled, section, within};
use super::super::{map, theme};
use super::Parts;

/// Height of a row of buttons, and space between rows, in points.
const ROW: f32 = 22.0;
const GAP: f32 = 5.0;
/// Minimum size of a scene's tile, in points; with less space, scenes are a list.
const LEAST_TILE: Vec2 = Vec2::new(42.0, 40.0);
const TILES_PER_ROW: usize = 4;
/// Height of a horizontal meter, in points.
const METER: f32 = 8.0;
/// Height of the list of sounds with the meter and a word below it, and the largest of the trace, in points.
const LIST_AND_METER: f32 = ROW + GAP + METER + 32.0;
const HIGHEST_TRACE: f32 = 260.0;

/// Origin of the flame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    Track,
    Sidechain,
    BuiltIn,
}

impl Source {
    const ALL: [(Self, &'static str, &'static str, &'static str); 3] = [
        (Self::Track, "Track", "pressure", "The flame is the sound on this track, or follows its loudness"),
        (Self::Sidechain, "Sidechain", "envelope", "The flame follows the loudness of the sidechain"),
        (Self::BuiltIn, "Built-in", "flame", "A simulated flame burns without any input"),
    ];

    fn of(mode: usize) -> Self {
        match DRIVE_MODES.get(mode) {
            Some(&"flame") => Self::BuiltIn,
            Some(&"envelope") => Self::Sidechain,
            _ => Self::Track,
        }
    }
}

/// The panel.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let inner = section(ui, rect, "FLAME", "its source");
    let radius = (0.075 * inner.height()).clamp(13.0, 24.0);
    let knobs = 2.0 * radius + 36.0;
    let source = Source::of(edit.get(Id::DriveMode) as usize);
    // Scenes use the space that otherwise belongs to the trace.
    let spare = inner.height() - knobs - ROW - LIST_AND_METER - 3.0 * GAP;
    let trace = match source {
        Source::BuiltIn => (0.13 * inner.height()).clamp(14.0, 44.0),
        Source::Track | Source::Sidechain => spare.clamp(14.0, HIGHEST_TRACE),
    };
    sources(ui, inner.with_max_y(inner.top() + ROW), source, edit);

    let trace_at = inner.with_min_y(inner.bottom() - trace);
    let knobs_at = inner.with_max_y(trace_at.top() - GAP).with_min_y(trace_at.top() - GAP - knobs);
    let body = inner.with_min_y(inner.top() + ROW + GAP).with_max_y(knobs_at.top() - GAP);
    match source {
        Source::BuiltIn => scenes(ui, body, edit),
        Source::Track => track(ui, body, parts, edit),
        Source::Sidechain => sidechain(ui, body, parts),
    }
    knobs_row(ui, knobs_at, source, radius, edit);
    parts.monitor.trace.show(ui, trace_at, theme::BLUE);
    ui.interact(trace_at, Place::unique("trace"), Sense::hover()).on_hover_text("The flame of the last four seconds");
}

fn sources(ui: &mut Ui, rect: Rect, now: Source, edit: &mut ParamEditor<'_>) {
    // In proportion to the length of their labels.
    let cuts = [0.28, 0.67].map(|share| rect.left() + share * rect.width());
    let (first, rest) = rect.split_left_right_at_x(cuts[0]);
    let (second, third) = rest.split_left_right_at_x(cuts[1]);
    let places = [first.with_max_x(first.right() - 2.0), second.with_max_x(second.right() - 2.0), third];
    for (place, (source, name, mode, hint)) in places.into_iter().zip(Source::ALL) {
        let button = filled(ui, place, name, name, source == now, true);
        if button.on_hover_text(hint).clicked() && source != now {
            let mode = DRIVE_MODES.iter().position(|found| *found == mode).unwrap_or(0);
            edit.set_once(Id::DriveMode as usize, mode as f64);
        }
    }
}

/// Knobs that shape the flame, whatever its origin.
fn knobs_row(ui: &mut Ui, rect: Rect, source: Source, radius: f32, edit: &mut ParamEditor<'_>) {
    let follows = DRIVE_MODES.get(edit.get(Id::DriveMode) as usize).is_some_and(|mode| mode.contains("envelope"));
    let knobs: [(Id, &str); 3] = match source {
        Source::BuiltIn => [(Id::DriveGain, "Gain"), (Id::FlameIntensity, "Intensity"), (Id::FlameWind, "Wind")],
        _ if follows => [(Id::DriveGain, "Gain"), (Id::Attack, "Attack"), (Id::Release, "Release")],
        _ => [(Id::DriveGain, "Gain"), (Id::HighPass, "High-pass"), (Id::Dynamics, "Dynamics")],
    };
    for (place, (id, name)) in columns(rect, 3, 2.0).zip(knobs) {
        let look = Look { name, font: theme::small(), color: theme::EMBER, radius, more: None };
        named_dial(ui, place, id as usize, &look, edit);
    }
}

/// Interpretation of the track's sound.
fn track(ui: &mut Ui, rect: Rect, parts: &Parts<'_>, edit: &mut ParamEditor<'_>) {
    const KINDS: [(&str, &str); 3] =
        [("pressure", "flame pressure"), ("flux", "flame flux"), ("input envelope", "any sound")];
    let mode = DRIVE_MODES.get(edit.get(Id::DriveMode) as usize).copied().unwrap_or_default();
    let row = rect.with_max_y(rect.top() + ROW);
    let chosen = within(ui, row, "track", |ui| {
        let mut chosen = mode;
        let shown = KINDS.iter().find(|(name, _)| *name == mode).map_or("", |(_, words)| words);
        let list = egui::ComboBox::from_id_salt("track kind").width(row.width() - 8.0).truncate().selected_text(shown);
        let list = list.show_ui(ui, |ui| {
            for (name, words) in KINDS {
                let line = ui.selectable_value(&mut chosen, name, words);
                map::note(ui, format_args!("track.{name}"), line.rect);
            }
        });
        map::note(ui, "track", list.response.rect);
        list.response.on_hover_text(Id::DriveMode.parameter().help);
        chosen
    });
    if let Some(next) = DRIVE_MODES.iter().position(|name| *name == chosen && chosen != mode) {
        edit.set_once(Id::DriveMode as usize, next as f64);
    }
    let level = parts.levels.get(Meter::Input);
    let words = if parts.meters.input_cancels() {
        ("Channels cancel: invert one, or use mono.", theme::ALARM)
    } else if level.held_db <= FLOOR_DB {
        ("No input signal.", theme::WEAK)
    } else {
        ("", theme::WEAK)
    };
    meter(ui, rect.with_min_y(row.bottom() + GAP), level, words);
}

fn sidechain(ui: &mut Ui, rect: Rect, parts: &Parts<'_>) {
    let level = parts.levels.get(Meter::Sidechain);
    let words = if parts.meters.sidechain_channels() == 0 {
        ("No sidechain connected: route one in your host.", theme::ALARM)
    } else if level.held_db <= FLOOR_DB {
        ("The sidechain is silent.", theme::WEAK)
    } else {
        ("", theme::WEAK)
    };
    meter(ui, rect, level, words);
}

/// A horizontal meter, with text below it.
fn meter(ui: &Ui, rect: Rect, level: Level, (words, color): (&str, egui::Color32)) {
    let painter = ui.painter().with_clip_rect(rect);
    let well = rect.with_max_y(rect.top() + METER);
    painter.rect_filled(well, 3.0, theme::WELL);
    let share = |db: f32| ((db - FLOOR_DB) / -FLOOR_DB).clamp(0.0, 1.0);
    let filled = well.with_max_x(well.left() + share(level.shown_db) * well.width());
    painter.rect_filled(filled, 3.0, if level.shown_db > 0.0 { theme::ALARM } else { theme::BLUE });
    let galley = painter.layout(words.to_owned(), theme::small(), color, rect.width());
    painter.galley(well.left_bottom() + Vec2::new(0.0, 4.0), galley, color);
}

/// Short names, and the height and width of each flame's drawing.
fn picture(scene: &str) -> (&str, f32, f32) {
    match scene {
        "candle" => ("Candle", 0.45, 0.45),
        "torch" => ("Torch", 0.85, 0.6),
        "flame_jet" => ("Jet", 0.7, 0.35),
        "burning_brick" => ("Brick", 0.45, 0.8),
        "dragon" => ("Dragon", 0.9, 0.75),
        "campfire" => ("Campfire", 1.0, 0.9),
        "flamethrower" => ("Thrower", 0.75, 0.5),
        "explosion" => ("Blast", 0.95, 1.0),
        other => (other, 0.8, 0.7),
    }
}

fn scenes(ui: &mut Ui, rect: Rect, edit: &mut ParamEditor<'_>) {
    let rows = FLAME_SCENES.len().div_ceil(TILES_PER_ROW);
    let height = (rect.height() - (rows - 1) as f32 * 4.0) / rows as f32;
    let width = (rect.width() - (TILES_PER_ROW - 1) as f32 * 4.0) / TILES_PER_ROW as f32;
    if height < LEAST_TILE.y || width < LEAST_TILE.x {
        let row = Rect::from_center_size(rect.center(), Vec2::new(rect.width(), ROW));
        within(ui, row, "scenes", |ui| list(ui, Id::FlameScene as usize, FLAME_SCENES, row.width() - 8.0, edit));
        return;
    }
    let chosen = edit.get(Id::FlameScene) as usize;
    for (number, scene) in FLAME_SCENES.iter().enumerate() {
        let (column, row) = ((number % TILES_PER_ROW) as f32, (number / TILES_PER_ROW) as f32);
        let at = rect.left_top() + Vec2::new(column * (width + 4.0), row * (height + 4.0));
        let place = Rect::from_min_size(at, Vec2::new(width, height));
        if tile(ui, place, scene, number == chosen) && number != chosen {
            edit.set_once(Id::FlameScene as usize, number as f64);
        }
    }
}

/// A scene's tile; true if it was clicked.
fn tile(ui: &Ui, rect: Rect, scene: &str, is_chosen: bool) -> bool {
    let (name, tall, wide) = picture(scene);
    let response = ui.interact(rect, Place::unique(("scene", scene)), Sense::click());
    map::note(ui, format_args!("scene.{scene}"), rect);
    let is_hot = response.hovered() || response.has_focus();
    let font = FontId::new(9.5, FontFamily::Proportional);
    let words = if is_chosen { theme::TEXT } else { theme::WEAK };
    let painter = ui.painter();
    let galley = painter.layout_no_wrap(name.to_owned(), font, words);
    let spot = Align2::CENTER_BOTTOM.anchor_size(rect.center_bottom() - Vec2::new(0.0, 3.0), galley.size());
    baked(painter, response.id, (bits(rect), bits(spot), is_chosen, is_hot), || {
        let color = if is_chosen { theme::EMBER } else { theme::EMBER.gamma_multiply(0.55) };
        let border = if is_chosen || is_hot { theme::EMBER } else { theme::LINE };
        let room = rect.with_max_y(spot.top() - 2.0).shrink2(Vec2::new(6.0, 4.0));
        let height = room.height().min(1.5 * room.width());
        let size = Vec2::new(0.7 * wide * room.width().min(height), tall * height);
        vec![
            Shape::rect_filled(rect, 4.0, if is_chosen { theme::WELL } else { theme::GROUND }),
            Shape::rect_stroke(rect, 4.0, Stroke::new(1.0, border), StrokeKind::Inside),
            flame_shape(room.center_bottom(), size, color),
        ]
    });
    painter.galley(spot.min, galley, words);
    response.clicked()
}

/// A flame whose base is at `foot`.
fn flame_shape(foot: Pos2, size: Vec2, color: egui::Color32) -> Shape {
    const STEPS: usize = 12;
    let half = 0.5 * size.x;
    // A round foot that runs into a point: half an ellipse below, straight flanks above.
    let waist = foot.y - 0.35 * size.y;
    let arc = (0..=STEPS).map(|n| {
        let angle = std::f32::consts::PI * n as f32 / STEPS as f32;
        Pos2::new(foot.x + half * angle.cos(), waist + 0.35 * size.y * angle.sin())
    });
    let points = arc.chain([Pos2::new(foot.x, foot.y - size.y)]).collect();
    Shape::convex_polygon(points, color.gamma_multiply(0.55), Stroke::new(1.2, color))
}
