//! Choices and switches.

use egui::{ComboBox, RichText, Ui, Vec2};
use pyrophone_settings::{PARAMETERS, Parameter};

use super::super::hand::Hand;
use super::super::{map, theme};
use super::notches;

/// Width of a choice, in points.
pub const WIDTH: f32 = 112.0;

/// A list to choose from, under its name.
pub fn choice(ui: &mut Ui, index: usize, names: &[&str], hand: &mut Hand<'_>) {
    let parameter = &PARAMETERS[index];
    let mut chosen = hand.value(index) as usize;
    let before = chosen;
    ui.allocate_ui(Vec2::new(WIDTH, 42.0), |ui| {
        ui.vertical(|ui| {
            name(ui, parameter);
            let choice = ComboBox::from_id_salt(parameter.id)
                .width(WIDTH - 12.0)
                .selected_text(names[chosen.min(names.len() - 1)])
                .show_ui(ui, |ui| {
                    for (index, name) in names.iter().enumerate() {
                        let line = ui.selectable_value(&mut chosen, index, *name);
                        map::note(ui, format_args!("choice.{}.{name}", parameter.id), line.rect);
                    }
                })
                .response
                .on_hover_text(parameter.help);
            map::note(ui, format_args!("choice.{}", parameter.id), choice.rect);
            // Without opening the list, as the host's own menus do.
            let next = (chosen as f64 - notches(ui, &choice)).clamp(0.0, (names.len() - 1) as f64);
            chosen = next as usize;
        });
    });
    if chosen != before {
        hand.set_once(index, chosen as f64);
    }
}

/// A switch.
pub fn toggle(ui: &mut Ui, index: usize, hand: &mut Hand<'_>) {
    let parameter = &PARAMETERS[index];
    let mut is_on = hand.value(index) > 0.5;
    let text = RichText::new(parameter.name).color(if is_on { theme::TEXT } else { theme::WEAK });
    let switch = ui.checkbox(&mut is_on, text).on_hover_text(parameter.help);
    map::note(ui, format_args!("toggle.{}", parameter.id), switch.rect);
    if switch.changed() {
        hand.set_once(index, f64::from(u8::from(is_on)));
    }
}

fn name(ui: &mut Ui, parameter: &Parameter) {
    ui.label(RichText::new(parameter.name).font(theme::small()).color(theme::WEAK)).on_hover_text(parameter.help);
}
