//! The layers: a fader over each one's meter, solo and mute, the output with its clip lamp, and the choice of the
//! monitored sound.

use egui::{Align2, Color32, FontFamily, FontId, Id as Place, Pos2, Rect, Sense, Ui, Vec2};
use pyrophone_settings::Id;

use super::super::levels::{FLOOR_DB, Levels, Meter};
use super::super::meter_bridge::switches;
use super::super::param_editor::ParamEditor;
use super::super::widgets::fader::{Track, fader};
use super::super::widgets::section::{columns, filled, section};
use super::super::{map, theme};
use super::Parts;
use crate::probe::Listen;

/// Heights in points: held peaks, names, switches, and the row of monitoring buttons.
const PEAK: f32 = 14.0;
const NAME: f32 = 14.0;
const SWITCH: f32 = 15.0;
const MONITOR: f32 = 20.0;
/// Width in points of a column that has room for a whole name, and for solo and mute side by side.
const WIDE: f32 = 33.0;

/// One fader.
struct Line {
    name: &'static str,
    short: &'static str,
    id: Id,
    meter: Meter,
    color: Color32,
}

/// All faders, roughly from the bottom of the spectrum up, and the output.
const LINES: [Line; 8] = [
    Line { name: "Rumble", short: "Low", id: Id::LowLevel, meter: Meter::Layer(0), color: theme::BLUE },
    Line { name: "Body", short: "Bdy", id: Id::BodyLevel, meter: Meter::Layer(6), color: theme::EMBER },
    Line { name: "Texture", short: "Tex", id: Id::TextureLevel, meter: Meter::Layer(2), color: theme::EMBER },
    Line { name: "Crackle", short: "Crk", id: Id::CrackleLevel, meter: Meter::Layer(4), color: theme::SPARK },
    Line { name: "Extend", short: "Ext", id: Id::ExtensionLevel, meter: Meter::Layer(1), color: theme::ASH },
    Line { name: "Hiss", short: "Hiss", id: Id::HissLevel, meter: Meter::Layer(5), color: theme::ASH },
    Line { name: "Whoosh", short: "Gas", id: Id::VortexLevel, meter: Meter::Layer(3), color: theme::VIOLET },
    Line { name: "Out", short: "Out", id: Id::OutputLevel, meter: Meter::Output, color: theme::TEXT },
];

/// The panel.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let inner = section(ui, rect, "LAYERS", "the mix");
    let faders = inner.with_max_y(inner.bottom() - MONITOR - 6.0);
    for (place, line) in columns(faders, LINES.len(), 2.0).zip(&LINES) {
        column(ui, place, line, parts.levels, edit);
    }
    monitoring(ui, inner.with_min_y(inner.bottom() - MONITOR), parts);
}

fn column(ui: &mut Ui, rect: Rect, line: &Line, levels: &mut Levels, edit: &mut ParamEditor<'_>) {
    let is_wide = rect.width() >= WIDE;
    let switching = if is_wide { SWITCH } else { 2.0 * SWITCH + 1.0 };
    let bottom = rect.with_min_y(rect.bottom() - switching);
    let name_at = Pos2::new(rect.center().x, bottom.top() - 3.0);
    let level = levels.get(line.meter);
    let silenced = levels.silenced();
    let is_silenced = matches!(line.meter, Meter::Layer(layer) if silenced.get(layer) == Some(&true));
    peak(ui, rect.with_max_y(rect.top() + PEAK), line, levels);
    let track = rect.with_min_y(rect.top() + PEAK + 2.0).with_max_y(name_at.y - NAME - 2.0);
    fader(ui, track, line.id as usize, &Track { color: line.color, level, is_silenced }, edit);
    let is_dimmed = edit.inert(line.id as usize).is_some();
    let color = if is_dimmed || is_silenced { theme::WEAK } else { theme::TEXT };
    let name = if is_wide { line.name } else { line.short };
    let size = if rect.width() > 42.0 { 10.5 } else { 9.2 };
    let font = FontId::new(size, FontFamily::Proportional);
    ui.painter().text(name_at, Align2::CENTER_BOTTOM, name, font, color);
    if let Meter::Layer(layer) = line.meter {
        let places = if is_wide {
            let [solo, mute] = <[Rect; 2]>::from(bottom.split_left_right_at_fraction(0.5));
            [solo.shrink2(Vec2::new(1.0, 0.0)), mute.shrink2(Vec2::new(1.0, 0.0))]
        } else {
            let half = bottom.shrink2(Vec2::new(2.0, 0.0));
            <[Rect; 2]>::from(half.split_top_bottom_at_fraction(0.5))
        };
        switches(ui, places, layer, levels);
    }
}

/// The held peak; for the output a clip lamp that stays on until it is clicked.
fn peak(ui: &Ui, rect: Rect, line: &Line, levels: &mut Levels) {
    let level = levels.get(line.meter);
    let is_clipped = line.meter == Meter::Output && levels.has_clipped();
    let text = match level.held_db {
        _ if is_clipped => "clip".to_owned(),
        held_db if held_db <= FLOOR_DB => "–".to_owned(),
        held_db => format!("{held_db:.0}"),
    };
    let color = if is_clipped || level.held_db >= 0.0 { theme::ALARM } else { theme::WEAK };
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, theme::small(), color);
    if line.meter == Meter::Output {
        let lamp = ui.interact(rect, Place::unique("clip lamp"), Sense::click());
        map::note(ui, "clip lamp", rect);
        if lamp.on_hover_text("Recent peak in dB. Clip: full scale was reached; click to clear.").clicked() {
            levels.forgive();
        }
    }
}

/// Choice of the sound that is monitored while the window is open.
fn monitoring(ui: &mut Ui, rect: Rect, parts: &Parts<'_>) {
    let monitored = parts.monitor.listen();
    for (place, (name, listen, hint)) in columns(rect, 3, 3.0).zip([
        ("Output", Listen::Output, "Hear the output, as usual"),
        ("Flame", Listen::Drive, "Hear only the flame that drives the engines"),
        ("Recording", Listen::Recording, "Hear the selected part of the recording, looped"),
    ]) {
        let is_there = listen != Listen::Recording || parts.view.recording.is_some();
        let waits = monitored == listen && listen == Listen::Recording && !parts.view.has_clip;
        let words = if waits { "…" } else { name };
        let button = filled(ui, place, words, &format!("Monitor {name}"), monitored == listen, is_there);
        if button.on_hover_text(format!("{hint}, until the window closes. Not saved, not automated.")).clicked() {
            parts.monitor.listen_to(listen);
            parts.loader.audition(listen == Listen::Recording);
        }
    }
}
