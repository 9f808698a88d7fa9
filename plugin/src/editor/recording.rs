//! The recording: loading it, its name, progress and messages; learning the dynamic range.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::Id;
use pyrophone_settings::table::DYNAMIC_RANGES;

use super::dialog::Dialog;
use crate::loader::LoaderHandle;
use crate::parameters::EffectParams;

const ERROR: egui::Color32 = egui::Color32::from_rgb(230, 110, 80);

/// The panel, with what is typed into it.
pub struct RecordingPanel {
    /// The path as typed, and the session's path that it followed last.
    path: String,
    followed: Option<String>,
    dialog: Option<Dialog>,
    notifier: RepaintNotifier,
}

impl RecordingPanel {
    /// An empty panel; `notifier` wakes the window when a file was chosen.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self { path: String::new(), followed: None, dialog: None, notifier }
    }

    /// Calls off the system's dialog.
    pub fn close_dialog(&mut self) {
        self.dialog = None;
    }

    /// The panel.
    pub fn show(&mut self, ui: &mut egui::Ui, loader: &LoaderHandle, params: &EffectParams) {
        let view = loader.status.view();
        if view.path != self.followed {
            self.path = view.path.clone().unwrap_or_default();
            self.followed = view.path.clone();
        }
        ui.horizontal(|ui| {
            let browse = ui.add_enabled(self.dialog.is_none(), egui::Button::new("Load recording…"));
            if browse.clicked() {
                self.dialog = Some(Dialog::open(&self.path, self.notifier.clone()));
            }
            let width = (ui.available_width() - 150.0).max(100.0);
            let field = egui::TextEdit::singleline(&mut self.path)
                .hint_text("or the path of a sound file, then Enter")
                .desired_width(width);
            let typed = ui.add(field);
            let entered = typed.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if ui.button("Load").clicked() || entered {
                let path = self.path.trim();
                if !path.is_empty() {
                    loader.load(PathBuf::from(path));
                }
            }
            if ui.add_enabled(view.path.is_some(), egui::Button::new("Remove")).clicked() {
                loader.unload();
            }
        });
        if let Some(chosen) = self.dialog.as_mut().and_then(Dialog::poll) {
            self.dialog = None;
            if let Some(path) = chosen {
                self.path = path.to_string_lossy().into_owned();
                loader.load(path);
            }
        }
        ui.horizontal(|ui| {
            match (&view.recording, &view.path) {
                (Some(recording), _) => ui.label(recording),
                (None, Some(path)) => ui.colored_label(ERROR, format!("Not loaded: {path}")),
                (None, None) => ui.weak("No recording: texture is silent, extension plays."),
            };
            if let Some((what, done)) = &view.progress {
                ui.add(egui::ProgressBar::new(*done).desired_width(160.0).text(what.as_str()));
            }
            let mut embed = view.embed;
            let keep = ui.checkbox(&mut embed, "Keep in the session");
            if keep.on_hover_text("Saves the recording itself with the session, up to 10 MB").changed() {
                loader.set_embed(embed);
            }
        });
        if let Some(error) = &view.error {
            ui.add(egui::Label::new(egui::RichText::new(error).color(ERROR)).wrap());
        }
        ui.horizontal(|ui| {
            let learning = &loader.shared.learning;
            let is_on = learning.load(Ordering::Relaxed);
            let text = if is_on { "Learning: press when it has played" } else { "Learn" };
            let learn = ui.add(egui::Button::new(text).selected(is_on));
            if learn
                .on_hover_text("Press, play the track once, press again: the texture then follows its loudness")
                .clicked()
            {
                learning.store(!is_on, Ordering::Relaxed);
            }
            if let Some(values) = view.learning {
                ui.label(format!("{values} amplitudes so far"));
            } else if let Some(learned) = &view.learned {
                ui.label(format!("Dynamic range: {learned}"));
                if ui.small_button("Forget").clicked() {
                    loader.forget_learned();
                }
            } else if DYNAMIC_RANGES[params.values().get(Id::DynamicRange) as usize] == "learned" {
                ui.colored_label(ERROR, "Dynamic range is set to learned, but nothing was learned yet.");
            }
        });
    }
}
