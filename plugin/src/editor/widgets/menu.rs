//! The context menu of a parameter, on the right button or, while it has the focus, on M.

use egui::{Key, Popup, PopupAnchor, Response, Ui};
use pyrophone_settings::PARAMETERS;

use super::super::map;
use super::super::param_editor::ParamEditor;
use super::value;
use crate::host_menu::Line;

/// The menu of a parameter on `response`; `has_text` if its value can be typed and copied.
pub fn menu(response: &Response, index: usize, has_text: bool, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let is_key =
        response.has_focus() && response.ctx.input(|input| input.key_pressed(Key::M) && input.modifiers.is_none());
    if response.secondary_clicked() || is_key {
        edit.params.host_menu.ask(index);
    }
    let id = Popup::default_response_id(response);
    if is_key {
        Popup::open_id(&response.ctx, id);
    }
    let popup = Popup::context_menu(response);
    // A menu that was opened by a key has no pointer to stand at.
    let popup = match Popup::position_of_id(&response.ctx, id) {
        None if !response.secondary_clicked() => popup.anchor(PopupAnchor::ParentRect(response.rect)),
        _ => popup,
    };
    popup.show(|ui| {
        // A host's entries may be long.
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        let default = parameter.to_text(parameter.default_value());
        let reset = button(ui, format!("Reset to {default}"), "Reset");
        if is_key {
            reset.request_focus();
        }
        if closes(ui, &reset) {
            edit.set_once(index, parameter.default_value());
        }
        if has_text {
            let text = parameter.to_text(edit.value(index));
            if entry(ui, "Type a value".to_owned(), "Type") {
                value::begin_typing(ui, index, &text);
            }
            if entry(ui, format!("Copy {text}"), "Copy") {
                ui.ctx().copy_text(text);
            }
        }
        if parameter.automatable {
            ui.separator();
            controllers(ui, index, edit);
        }
        host(ui, index, edit);
    });
}

/// The host's entries, once it has answered.
fn host(ui: &mut Ui, index: usize, edit: &ParamEditor<'_>) {
    let lines = edit.params.host_menu.offered(index);
    if lines.is_empty() {
        return;
    }
    ui.separator();
    if let Some(action) = host_lines(ui, &lines) {
        edit.params.host_menu.perform(index, action);
        ui.close();
    }
}

/// Shows lines up to the end of their menu.
fn host_lines(ui: &mut Ui, lines: &[Line]) -> Option<i32> {
    let (mut at, mut chosen) = (0, None);
    while let Some(line) = lines.get(at) {
        at += 1;
        match line {
            Line::Separator => drop(ui.separator()),
            Line::Title(words) => drop(ui.weak(words)),
            Line::End => break,
            Line::Begin(words) => {
                let rest = &lines[at..];
                at += length(rest);
                let menu = ui.menu_button(words, |ui| host_lines(ui, rest));
                map::note(ui, format_args!("menu.host.{words}"), menu.response.rect);
                chosen = chosen.or(menu.inner.flatten());
            }
            Line::Entry { label, is_enabled, is_checked, action } => {
                let words = if *is_checked { format!("✔ {label}") } else { label.clone() };
                let button = ui.add_enabled(*is_enabled, egui::Button::new(words));
                map::note(ui, format_args!("menu.host.{label}"), button.rect);
                if button.clicked() {
                    chosen = Some(*action);
                }
            }
        }
    }
    chosen
}

/// The number of lines up to the end of a menu, including that.
fn length(lines: &[Line]) -> usize {
    let mut depth = 1;
    for (at, line) in lines.iter().enumerate() {
        match line {
            Line::Begin(_) => depth += 1,
            Line::End => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    lines.len()
}

/// Entries for the MIDI controller of a parameter.
fn controllers(ui: &mut Ui, index: usize, edit: &ParamEditor<'_>) {
    let controllers = &edit.params.controllers;
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

/// A line of the menu, which closes it; true if it was clicked.
fn entry(ui: &mut Ui, words: String, name: &str) -> bool {
    let line = button(ui, words, name);
    closes(ui, &line)
}

fn button(ui: &mut Ui, words: String, name: &str) -> Response {
    let button = ui.button(words);
    map::note(ui, format_args!("menu.{name}"), button.rect);
    button
}

/// True if the line was clicked, which closes the menu.
fn closes(ui: &Ui, line: &Response) -> bool {
    let is_clicked = line.clicked();
    if is_clicked {
        ui.close();
    }
    is_clicked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn menus_in_menus_end_where_they_end() {
        let begin = || Line::Begin(String::new());
        let lines = [Line::Separator, begin(), Line::Separator, Line::End, Line::End, Line::Separator];
        assert_eq!((length(&lines), length(&lines[2..]), length(&lines[5..])), (5, 2, 1));
    }
}
