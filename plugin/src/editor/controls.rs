//! Parameters: a slider with a value that can be typed, a list or a check box, and a way back to
//! the default.

use nice_plug::prelude::ParamSetter;
use pyrophone_settings::{Kind, PARAMETERS, Parameter};

use crate::parameters::{EffectParams, Slot};

/// Widest a column of parameters gets, in points.
const COLUMN_WIDTH: f32 = 420.0;
const NAME_WIDTH: f32 = 110.0;
const SLIDER_WIDTH: f32 = 140.0;

/// All parameters, by group, in as many columns as there is room for.
pub fn show(ui: &mut egui::Ui, params: &EffectParams, setter: &ParamSetter) {
    let mut groups: Vec<&str> = Vec::new();
    for parameter in PARAMETERS {
        if !groups.contains(&parameter.group) {
            groups.push(parameter.group);
        }
    }
    let columns = ((ui.available_width() / COLUMN_WIDTH) as usize).clamp(1, 3);
    ui.columns(columns, |columns| {
        // Each group goes to the column that is shortest so far, counted in rows.
        let mut rows = vec![0; columns.len()];
        for group in groups {
            let members = PARAMETERS.iter().enumerate().filter(|(_, parameter)| parameter.group == group);
            let shortest = (0..rows.len()).min_by_key(|column| rows[*column]).unwrap_or(0);
            rows[shortest] += members.clone().count() + 2;
            let ui = &mut columns[shortest];
            ui.add_space(4.0);
            ui.strong(group);
            if group == "Structure" {
                ui.weak("A change restarts the engines and may change the latency.");
            }
            for (index, parameter) in members {
                row(ui, parameter, params.slot(index), setter);
            }
            ui.add_space(8.0);
        }
    });
}

fn row(ui: &mut egui::Ui, parameter: &Parameter, slot: &Slot, setter: &ParamSetter) {
    let plain = parameter.snap(slot.plain());
    ui.horizontal(|ui| {
        let size = egui::vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        let name = egui::Label::new(parameter.name).truncate();
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(NAME_WIDTH);
            ui.add(name).on_hover_text(parameter.help);
        });
        let is_default = plain == parameter.default_value();
        let reset = ui.add_enabled(!is_default, egui::Button::new("<").small());
        if reset.on_hover_text(format!("Back to {}", parameter.to_text(parameter.default_value()))).clicked() {
            set_once(slot, setter, parameter.default_value());
        }
        match parameter.kind {
            Kind::Float { .. } | Kind::Int { .. } => slider(ui, parameter, slot, setter, plain),
            Kind::Choice { names, .. } => {
                let mut chosen = plain as usize;
                egui::ComboBox::from_id_salt(parameter.id).selected_text(names[chosen]).show_ui(ui, |ui| {
                    for (index, name) in names.iter().enumerate() {
                        ui.selectable_value(&mut chosen, index, *name);
                    }
                });
                if chosen as f64 != plain {
                    set_once(slot, setter, chosen as f64);
                }
            }
            Kind::Toggle { .. } => {
                let mut is_on = plain > 0.5;
                if ui.checkbox(&mut is_on, "").changed() {
                    set_once(slot, setter, f64::from(u8::from(is_on)));
                }
            }
        }
    });
}

fn slider(ui: &mut egui::Ui, parameter: &Parameter, slot: &Slot, setter: &ParamSetter, plain: f64) {
    let mut normalised = parameter.to_normalised(plain);
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    let slider = egui::Slider::new(&mut normalised, 0.0..=1.0)
        .custom_formatter(|normalised, _| parameter.to_text(parameter.from_normalised(normalised)))
        .custom_parser(|text| parameter.parse(text).ok().map(|plain| parameter.to_normalised(plain)));
    let response = ui.add(slider);
    let chosen = parameter.from_normalised(normalised);
    if response.drag_started() {
        slot.begin(setter);
    }
    if response.changed() && chosen != plain {
        if response.dragged() {
            slot.set(setter, chosen);
        } else {
            set_once(slot, setter, chosen);
        }
    }
    if response.drag_stopped() {
        slot.end(setter);
    }
}

/// Sets a parameter as one gesture.
pub fn set_once(slot: &Slot, setter: &ParamSetter, plain: f64) {
    slot.begin(setter);
    slot.set(setter, plain);
    slot.end(setter);
}
