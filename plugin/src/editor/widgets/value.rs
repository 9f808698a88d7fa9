//! A parameter's value as text, which a click turns into a text field.

use egui::text::{CCursor, CCursorRange};
use egui::{Align2, Color32, Id, Key, Rect, Role, Sense, Ui, WidgetInfo};
use pyrophone_settings::{PARAMETERS, Parameter};

use super::super::param_editor::ParamEditor;
use super::super::{map, theme};

/// Seconds for which a note on an out-of-range value stays.
const WORD_S: f64 = 2.5;

fn id_of(parameter: &Parameter) -> Id {
    Id::unique(("value", parameter.id))
}

/// Turns the value of a parameter into a text field with all of its text selected, so that typing replaces it.
pub fn begin_typing(ui: &Ui, index: usize, text: &str) {
    let id = id_of(&PARAMETERS[index]);
    let mut field = egui::text_edit::TextEditState::default();
    let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
    field.cursor.set_char_range(Some(all));
    field.store(ui.ctx(), id.with("field"));
    ui.data_mut(|data| data.insert_temp(id, text.to_owned()));
    ui.memory_mut(|memory| memory.request_focus(id.with("field")));
}

/// Shows the value in `rect`.
pub fn value(ui: &mut Ui, rect: Rect, index: usize, color: Color32, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let id = id_of(parameter);
    map::note(ui, format_args!("value.{}", parameter.id), rect);
    match ui.data(|data| data.get_temp::<String>(id)) {
        None => shown(ui, rect, index, color, edit),
        Some(typed) => field(ui, rect, index, typed, edit),
    }
}

fn shown(ui: &mut Ui, rect: Rect, index: usize, color: Color32, edit: &ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let id = id_of(parameter);
    let response = ui.interact(rect, id.with("shown"), Sense::click());
    let text = parameter.to_text(edit.value(index));
    let now_s = ui.input(|input| input.time);
    let word: Option<(String, f64)> = ui.data(|data| data.get_temp(id.with("word")));
    let word = word.filter(|(_, until_s)| now_s < *until_s).map(|(word, _)| word);
    let color = match &word {
        Some(_) => theme::ALARM,
        None if response.hovered() => theme::EMBER,
        None => color,
    };
    let galley = ui.painter().layout_no_wrap(word.unwrap_or_else(|| text.clone()), theme::small(), color);
    let place = Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size());
    ui.painter().galley(place.min, galley, color);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::SpinButton, true, parameter.name);
        info.current_text_value = Some(text.clone());
        info
    });
    if response.on_hover_text("Click to type a value").clicked() {
        begin_typing(ui, index, &text);
    }
}

fn field(ui: &mut Ui, rect: Rect, index: usize, mut typed: String, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let id = id_of(parameter);
    let is_valid = parameter.parse_nearest(&typed).is_ok();
    let field = egui::TextEdit::singleline(&mut typed)
        .id(id.with("field"))
        .font(theme::small())
        .margin(egui::Margin::symmetric(2, 1))
        .text_color(if is_valid { theme::TEXT } else { theme::ALARM })
        .align(Align2::CENTER_CENTER);
    // A separate layout area keeps the neighbouring items in place.
    let mut place = ui.new_child(egui::UiBuilder::new().id_salt(id).max_rect(rect));
    let response = place.put(rect, field);
    if !response.lost_focus() {
        ui.data_mut(|data| data.insert_temp(id, typed));
        return;
    }
    let is_refused = ui.input(|input| input.key_pressed(Key::Escape));
    if let (Ok((plain, is_nearest)), false) = (parameter.parse_nearest(&typed), is_refused) {
        edit.set_once(index, plain);
        if is_nearest {
            let end = if plain >= parameter.high() { "at most" } else { "at least" };
            let until_s = ui.input(|input| input.time) + WORD_S;
            let word = (format!("{end} {}", parameter.to_text(plain)), until_s);
            ui.data_mut(|data| data.insert_temp(id.with("word"), word));
            ui.ctx().request_repaint_after_secs(WORD_S as f32);
        }
    }
    ui.data_mut(|data| data.remove::<String>(id));
}
