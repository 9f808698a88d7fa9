//! Choices and switches.

use egui::{ComboBox, Response, RichText, Role, Ui, Vec2, WidgetInfo};
use pyrophone_settings::{PARAMETERS, Parameter};

use super::super::param_editor::ParamEditor;
use super::super::{map, theme};
use super::menu::menu;
use super::notches;

/// Width of a choice, in points.
pub const WIDTH: f32 = 112.0;
/// Width in points of a list's arrow, with the space around it.
const ARROW: f32 = 30.0;
/// Opacity of a parameter without effect.
const DIMMED: f32 = 0.45;

/// A list to choose from, under its name.
pub fn choice(ui: &mut Ui, index: usize, names: &[&str], edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    ui.allocate_ui(Vec2::new(WIDTH, 42.0), |ui| {
        ui.vertical(|ui| {
            let reason = edit.inert(index);
            let color = if reason.is_some() { theme::WEAK.gamma_multiply(DIMMED) } else { theme::WEAK };
            let name = ui.label(RichText::new(parameter.name).font(theme::small()).color(color));
            explain(name, parameter, reason);
            list(ui, index, names, WIDTH - 12.0, edit);
        });
    });
}

/// The list of a choice alone, `width` points wide.
pub fn list(ui: &mut Ui, index: usize, names: &[&str], width: f32, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let mut chosen = edit.value(index) as usize;
    let before = chosen;
    let reason = edit.inert(index);
    let name = names[chosen.min(names.len() - 1)];
    // A long name in small letters is better than one that is cut.
    let fits = ui.painter().layout_no_wrap(name.to_owned(), theme::strong(), theme::TEXT).size().x <= width - ARROW;
    let shown = RichText::new(name);
    let shown = if fits { shown } else { shown.font(theme::small()) };
    let shown = if reason.is_some() { shown.color(theme::TEXT.gamma_multiply(DIMMED)) } else { shown };
    let list = ComboBox::from_id_salt(parameter.id).width(width).truncate().selected_text(shown).show_ui(ui, |ui| {
        for (index, name) in names.iter().enumerate() {
            let line = ui.selectable_value(&mut chosen, index, *name);
            map::note(ui, format_args!("choice.{}.{name}", parameter.id), line.rect);
        }
    });
    let response = explain(list.response, parameter, reason);
    // The toolkit's own description has the name only, not the selected value.
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, true, parameter.name);
        info.current_text_value = Some(name.to_owned());
        info
    });
    menu(&response, index, false, edit);
    map::note(ui, format_args!("choice.{}", parameter.id), response.rect);
    // Without opening the list, as the host's own menus do.
    let next = (chosen as f64 - notches(ui, &response)).clamp(0.0, (names.len() - 1) as f64);
    chosen = next as usize;
    if chosen != before {
        edit.set_once(index, chosen as f64);
    }
}

/// A switch.
pub fn toggle(ui: &mut Ui, index: usize, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let mut is_on = edit.value(index) > 0.5;
    let reason = edit.inert(index);
    let color = if is_on { theme::TEXT } else { theme::WEAK };
    let color = if reason.is_some() { color.gamma_multiply(DIMMED) } else { color };
    let switch = ui.checkbox(&mut is_on, RichText::new(parameter.name).color(color));
    let switch = explain(switch, parameter, reason);
    menu(&switch, index, false, edit);
    map::note(ui, format_args!("toggle.{}", parameter.id), switch.rect);
    if switch.changed() {
        edit.set_once(index, f64::from(u8::from(is_on)));
    }
}

/// Adds a tooltip with the parameter's help, and the reason where it has no effect.
fn explain(response: Response, parameter: &Parameter, reason: Option<&str>) -> Response {
    response.on_hover_ui(|ui| {
        ui.set_max_width(320.0);
        ui.label(parameter.help);
        if let Some(reason) = reason {
            ui.label(RichText::new(format!("No effect at present: {reason}.")).color(theme::ALARM));
        }
    })
}
