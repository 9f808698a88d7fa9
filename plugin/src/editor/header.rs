//! The header of the window: presets, undo, A and B, pages, bypass, processing load.

use egui::{Align, Button, Layout, RichText, Ui};
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::Id;

use super::controls::Page;
use super::param_editor::ParamEditor;
use super::presets::Presets;
use super::{map, theme};
use crate::meters::Meters;

/// Width in points below which the plug-in's name is left out, and the remaining width below which the load is.
const ROOM_FOR_NAME: f32 = 960.0;
const ROOM_FOR_COST: f32 = 70.0;
/// Width of everything in the row except the preset's name, in points.
const OTHERS: f32 = 570.0;

/// Presets, and the page that is shown.
pub struct Header {
    /// The presets.
    pub presets: Presets,
    /// The page that is shown.
    pub page: Page,
}

impl Header {
    /// `notifier` wakes the window when files were read or written.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self { presets: Presets::new(notifier), page: Page::Play }
    }

    /// The row. `load` is the share of their time that blocks use, and the maximum of the last second.
    pub fn show(&mut self, ui: &mut Ui, edit: &mut ParamEditor<'_>, meters: &Meters, load: (f32, f32)) {
        let width = ui.available_width();
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 6.0;
        ui.horizontal(|ui| {
            if width > ROOM_FOR_NAME {
                ui.label(RichText::new("PYROPHONE").heading().color(theme::EMBER).strong());
                ui.separator();
            }
            ui.scope(|ui| self.presets.show(ui, width - OTHERS, edit));
            gap(ui);
            history(ui, edit);
            gap(ui);
            for page in Page::ALL {
                let is_shown = self.page == page;
                let name = RichText::new(page.name()).color(if is_shown { theme::TEXT } else { theme::WEAK });
                let button = ui.add(Button::new(name).selected(is_shown).frame_when_inactive(false));
                map::note(ui, format_args!("button.{}", page.name()), button.rect);
                if is_shown {
                    let line = button.rect.with_min_y(button.rect.bottom() - 2.0);
                    ui.painter().rect_filled(line, 1.0, theme::EMBER);
                }
                if button.on_hover_text(page.hint()).clicked() {
                    self.page = page;
                }
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let bypass = Id::Bypass as usize;
                let is_on = edit.get(Id::Bypass) > 0.5;
                let button = ui.add(Button::new("Bypass").selected(is_on));
                map::note(ui, "button.Bypass", button.rect);
                if button.on_hover_text(Id::Bypass.parameter().help).clicked() {
                    edit.set_once(bypass, f64::from(u8::from(!is_on)));
                }
                if ui.available_width() > ROOM_FOR_COST {
                    cost(ui, meters, load);
                }
            });
        });
    }
}

/// Space between groups.
fn gap(ui: &mut Ui) {
    ui.add_space(5.0);
}

fn history(ui: &mut Ui, edit: &mut ParamEditor<'_>) {
    let keys = |key| move |input: &mut egui::InputState| input.consume_key(egui::Modifiers::COMMAND, key);
    let undo = ui.add_enabled(edit.history.can_undo(), Button::new("Undo"));
    map::note(ui, "button.Undo", undo.rect);
    let undo = undo.on_hover_text("Ctrl+Z: undoes your last change, but not the host's automation");
    if undo.clicked() || ui.input_mut(keys(egui::Key::Z)) {
        edit.undo();
    }
    let redo = ui.add_enabled(edit.history.can_redo(), Button::new("Redo")).on_hover_text("Ctrl+Y");
    map::note(ui, "button.Redo", redo.rect);
    if redo.clicked() || ui.input_mut(keys(egui::Key::Y)) {
        edit.redo();
    }
    gap(ui);
    for (name, is_b) in [("A", false), ("B", true)] {
        let is_heard = edit.history.is_b() == is_b;
        let slot = ui.add(Button::new(name).selected(is_heard)).on_hover_text("Two settings to compare");
        map::note(ui, format_args!("button.{name}"), slot.rect);
        if slot.clicked() && !is_heard {
            edit.exchange();
        }
    }
    let (from, to) = if edit.history.is_b() { ("B", "A") } else { ("A", "B") };
    let copy = ui.button(format!("{from}›{to}")).on_hover_text(format!("Copies {from}, the active setting, to {to}"));
    map::note(ui, "button.Copy", copy.rect);
    if copy.clicked() {
        edit.copy();
    }
}

/// Latency and load, in as many words as fit.
fn cost(ui: &mut Ui, meters: &Meters, (load, worst): (f32, f32)) {
    let Some((samples, rate_hz)) = meters.engine() else {
        ui.label(RichText::new("not running").font(theme::small()).color(theme::WEAK));
        return;
    };
    let ms = 1000.0 * samples as f32 / rate_hz;
    let color = if worst >= 1.0 { theme::ALARM } else { theme::WEAK };
    let late = meters.late_steps();
    let late = if late > 0 { format!(" · {late} late") } else { String::new() };
    let forms = [
        format!("latency {ms:.0} ms · load {:.0} %, worst {:.0} %{late}", 100.0 * load, 100.0 * worst),
        format!("latency {ms:.0} ms · load {:.0} %", 100.0 * load),
        format!("{ms:.0} ms · {:.0} %", 100.0 * load),
    ];
    let room = ui.available_width() - 8.0;
    let fits = |text: &String| ui.painter().layout_no_wrap(text.clone(), theme::small(), color).size().x <= room;
    let Some(text) = forms.iter().find(|text| fits(text)) else { return };
    ui.label(RichText::new(text).font(theme::small()).color(color)).on_hover_text(format!(
        "Latency: {samples} samples. Load: share of its time that a block takes on average, and the most expensive block of the last second ({:.0} %). Late: steps of live gas that arrived too late; use blocks of 512 samples or fewer.",
        100.0 * worst
    ));
}
