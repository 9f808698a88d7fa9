//! The head of the window: presets, undo, A and B, bypass, what the engines cost.

use egui::{Align, Button, Layout, RichText, Ui};
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::Id;

use super::controls::Page;
use super::hand::Hand;
use super::presets::Presets;
use super::{map, theme};
use crate::meters::Meters;

/// Room in points without which the name, and what the engines cost, are left out.
const ROOM_FOR_NAME: f32 = 860.0;
const ROOM_FOR_COST: f32 = 170.0;

/// Presets, and the page of parameters that is shown.
pub struct Header {
    /// The list of presets.
    pub presets: Presets,
    /// The page of parameters that is shown.
    pub page: Page,
}

impl Header {
    /// `notifier` wakes the window when files were read or written.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self { presets: Presets::new(notifier), page: Page::Play }
    }

    /// The row. `load` is the part of their time that blocks take, and the worst of the last second.
    pub fn show(&mut self, ui: &mut Ui, hand: &mut Hand<'_>, meters: &Meters, load: (f32, f32)) {
        ui.horizontal(|ui| {
            if ui.available_width() > ROOM_FOR_NAME {
                ui.label(RichText::new("PYROPHONE").heading().color(theme::EMBER).strong());
                ui.separator();
            }
            self.presets.show(ui, hand);
            ui.separator();
            history(ui, hand);
            ui.separator();
            for (name, page) in [("Play", Page::Play), ("Vortex", Page::Vortex), ("Structure", Page::Structure)] {
                let button = ui.selectable_value(&mut self.page, page, name);
                map::note(ui, format_args!("button.{name}"), button.rect);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let bypass = Id::Bypass as usize;
                let is_on = hand.get(Id::Bypass) > 0.5;
                let button = ui.add(Button::new("Bypass").selected(is_on));
                map::note(ui, "button.Bypass", button.rect);
                if button.on_hover_text(Id::Bypass.parameter().help).clicked() {
                    hand.set_once(bypass, f64::from(u8::from(!is_on)));
                }
                if ui.available_width() > ROOM_FOR_COST {
                    cost(ui, meters, load);
                }
            });
        });
    }
}

fn history(ui: &mut Ui, hand: &mut Hand<'_>) {
    let keys = |key| move |input: &mut egui::InputState| input.consume_key(egui::Modifiers::COMMAND, key);
    let undo = ui.add_enabled(hand.history.can_undo(), Button::new("Undo")).on_hover_text("Ctrl+Z");
    map::note(ui, "button.Undo", undo.rect);
    if undo.clicked() || ui.input_mut(keys(egui::Key::Z)) {
        hand.undo();
    }
    let redo = ui.add_enabled(hand.history.can_redo(), Button::new("Redo")).on_hover_text("Ctrl+Y");
    map::note(ui, "button.Redo", redo.rect);
    if redo.clicked() || ui.input_mut(keys(egui::Key::Y)) {
        hand.redo();
    }
    ui.separator();
    for (name, is_b) in [("A", false), ("B", true)] {
        let is_heard = hand.history.is_b() == is_b;
        let slot = ui.add(Button::new(name).selected(is_heard)).on_hover_text("Two settings to compare");
        map::note(ui, format_args!("button.{name}"), slot.rect);
        if slot.clicked() && !is_heard {
            hand.exchange();
        }
    }
    let (from, to) = if hand.history.is_b() { ("B", "A") } else { ("A", "B") };
    let copy = ui.button(format!("{from} to {to}")).on_hover_text("Makes both equal to what sounds");
    map::note(ui, "button.Copy", copy.rect);
    if copy.clicked() {
        hand.copy();
    }
}

fn cost(ui: &mut Ui, meters: &Meters, (load, worst): (f32, f32)) {
    let Some((samples, rate_hz)) = meters.engine() else {
        ui.label(RichText::new("not running").color(theme::WEAK));
        return;
    };
    let ms = 1000.0 * samples as f32 / rate_hz;
    let color = if worst >= 1.0 { theme::ALARM } else { theme::WEAK };
    let late = meters.late_steps();
    let late = if late > 0 { format!("   {late} late") } else { String::new() };
    let text = format!("{ms:.1} ms   {:.0} % (worst {:.0} %){late}", 100.0 * load, 100.0 * worst);
    ui.label(RichText::new(text).font(theme::small()).color(color)).on_hover_text(format!(
        "Latency: {samples} samples. Part of their time that blocks take, and the costliest of the last second. Late: steps of the live gas that were not there in time; blocks of 512 samples or less leave time for them."
    ));
}
