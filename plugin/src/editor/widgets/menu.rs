//! What the right button offers on a parameter.

use egui::{Response, Ui};
use pyrophone_settings::PARAMETERS;

use super::super::hand::Hand;
use super::super::map;
use super::value;

/// The menu of a parameter on `response`; `has_text` where its value can be typed and copied.
pub fn menu(response: &Response, index: usize, has_text: bool, hand: &mut Hand<'_>) {
    let parameter = &PARAMETERS[index];
    response.context_menu(|ui| {
        let default = parameter.to_text(parameter.default_value());
        if entry(ui, format!("Reset to {default}"), "Reset") {
            hand.set_once(index, parameter.default_value());
        }
        if has_text {
            let text = parameter.to_text(hand.value(index));
            if entry(ui, "Type a value".to_owned(), "Type") {
                value::begin_typing(ui, index, &text);
            }
            if entry(ui, format!("Copy {text}"), "Copy") {
                ui.ctx().copy_text(text);
            }
        }
        if parameter.automatable {
            ui.separator();
            controllers(ui, index, hand);
        }
    });
}

/// What there is to do about the MIDI controller of a parameter.
fn controllers(ui: &mut Ui, index: usize, hand: &Hand<'_>) {
    let controllers = &hand.params.controllers;
    if controllers.learner() == Some(index) {
        if entry(ui, "Stop MIDI learn".to_owned(), "Stop learning") {
            controllers.stop_learning();
        }
    } else if entry(ui, "MIDI learn".to_owned(), "Learn") {
        controllers.learn(index);
    }
    if let Some(number) = controllers.number(index)
        && entry(ui, format!("Forget MIDI controller {number}"), "Forget")
    {
        controllers.assign(index, None);
    }
}

/// A line of the menu, which closes it; whether it was clicked.
fn entry(ui: &mut Ui, words: String, name: &str) -> bool {
    let button = ui.button(words);
    map::note(ui, format_args!("menu.{name}"), button.rect);
    let is_clicked = button.clicked();
    if is_clicked {
        ui.close();
    }
    is_clicked
}
