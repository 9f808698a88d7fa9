//! The output's figures, and a remedy for its fault.

use egui::{Button, Id as WidgetId, Rect, RichText, Sense, Ui, Vec2};
use pyrophone_analysis::Figures;
use pyrophone_analysis::fidelity::Diagnosis;
use pyrophone_settings::Id;

use super::words::readable;
use crate::editor::param_editor::ParamEditor;
use crate::editor::suggestion::Suggestion;
use crate::editor::{map, theme};

/// Judgement of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advice {
    /// Its similarity to the recording, and its correlation with the drive.
    pub figures: Figures,
    /// Present or foreseeable fault.
    pub fault: Option<Diagnosis>,
    /// Scaling alpha after its reduction by Scaling auto.
    pub scaling_alpha: f32,
}

impl Advice {
    /// The figures, the suggested change, and a button that applies it.
    pub fn show(&self, ui: &mut Ui, painter: &egui::Painter, rect: Rect, edit: &mut ParamEditor<'_>) {
        let mut words = vec![];
        words.extend(self.figures.follows.map(|follows| format!("follows {follows:.2}")));
        words.extend(self.figures.lines_db.map(|lines_db| format!("tones +{lines_db:.1} dB")));
        words.extend(self.figures.crackle.map(|crackle| format!("crackle ×{crackle:.1}")));
        if edit.get(Id::ScalingAuto) > 0.5 {
            words.push(format!("scaling {:.2}", self.scaling_alpha));
        }
        if words.is_empty() && self.fault.is_none() {
            return;
        }
        let at = rect.left_top() + Vec2::new(8.0, 21.0);
        let drawn = readable(painter, at, &words.join("   "), theme::WEAK);
        let figures = ui.interact(drawn, WidgetId::unique("figures"), Sense::hover());
        figures.on_hover_text(
            "Over the last eight seconds. Follows: correlation of the output's loudness with the drive's, 1 at best. \
             Tones: how far the output's strongest tones stand out beyond the recording's; noise has none, a buzz 3 dB or more. \
             Crackle: how sudden the output is, as a multiple of the recording; 1 at best. \
             Scaling: Scaling alpha as lowered by Scaling auto.",
        );
        let Some(fault) = self.fault else { return };
        let at = at + Vec2::new(0.0, 15.0);
        let remedy = Suggestion::of(fault, &edit.values());
        let advice = readable(painter, at, fault.advice(remedy.is_none()), theme::EMBER);
        let Some(remedy) = remedy else { return };
        let area = Rect::from_min_size(advice.left_bottom() + Vec2::new(0.0, 3.0), Vec2::new(150.0, 18.0));
        let button = Button::new(RichText::new(&remedy.words).font(theme::small())).truncate();
        map::note(ui, "button.Cure", area);
        if ui.put(area, button).on_hover_text("Applies the suggestion; Undo reverts it").clicked() {
            edit.set_once(remedy.id as usize, remedy.plain);
        }
    }
}
