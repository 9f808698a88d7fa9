//! Factory presets, and the paper's values.

use nice_plug::prelude::ParamSetter;
use pyrophone_settings::{COUNT, Preset, Values};

use super::controls::set_once;
use crate::parameters::EffectParams;

/// The presets to choose from.
pub struct Presets {
    factory: Vec<Preset>,
}

impl Default for Presets {
    fn default() -> Self {
        // They are part of the build, and a test reads every one.
        Self { factory: Preset::factory().unwrap_or_default() }
    }
}

impl Presets {
    /// The choice of presets and the button.
    pub fn show(&mut self, ui: &mut egui::Ui, params: &EffectParams, setter: &ParamSetter) {
        let values = params.values();
        let chosen = self.factory.iter().find(|preset| preset.values == values);
        let shown = chosen.map_or("(changed)", |preset| preset.name.as_str());
        let mut next: Option<Values> = None;
        ui.label("Preset");
        egui::ComboBox::from_id_salt("preset").selected_text(shown).show_ui(ui, |ui| {
            for preset in &self.factory {
                if ui
                    .selectable_label(preset.values == values, &preset.name)
                    .on_hover_text(&preset.description)
                    .clicked()
                {
                    next = Some(preset.values);
                }
            }
        });
        let reset = ui.button("Reset to the paper's values");
        if reset.on_hover_text("Chadwick & James 2011; levels, widths, seed and envelope stay").clicked() {
            let mut paper = values;
            paper.reset_to_paper();
            next = Some(paper);
        }
        if let Some(next) = next {
            for index in 0..COUNT {
                let (old, new) = (values.as_slice()[index], next.as_slice()[index]);
                if old != new {
                    set_once(params.slot(index), setter, new);
                }
            }
        }
    }
}
