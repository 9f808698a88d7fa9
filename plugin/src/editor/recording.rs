//! The recording and the speed field: loading them, names, progress and messages; learning the dynamic range.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use egui::{Rect, RichText, StrokeKind, Ui, Vec2};
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::Id;
use pyrophone_settings::table::DYNAMIC_RANGES;
use raw_window_handle::HasWindowHandle;

use super::dialog::Dialog;
use super::drop::DropTarget;
use super::plots::course::{Still, label};
use super::plots::outline;
use super::{map, theme};
use crate::loader::LoaderHandle;
use crate::loader::status::View;
use crate::parameters::EffectParams;

/// How the names of speed fields end.
const FIELD_EXTENSION: &str = "field";

/// The panel, with what is typed into it.
pub struct RecordingPanel {
    /// The path as typed, and the session's path that it followed last.
    path: String,
    followed: Option<String>,
    dialog: Option<Dialog>,
    drops: Option<DropTarget>,
    course: Still,
    notifier: RepaintNotifier,
}

impl RecordingPanel {
    /// An empty panel; `notifier` wakes the window when a file was chosen.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self { path: String::new(), followed: None, dialog: None, drops: None, course: Still::default(), notifier }
    }

    /// Calls off the system's dialog.
    pub fn close_dialog(&mut self) {
        self.dialog = None;
    }

    /// Takes what is dropped on this window.
    pub fn take_drops(&mut self, window: &impl HasWindowHandle) {
        self.drops = DropTarget::open(window, self.notifier.clone());
    }

    /// Takes nothing more.
    pub fn refuse_drops(&mut self) {
        self.drops = None;
    }

    /// Forgets what a window that is gone has drawn.
    pub fn clear_pictures(&mut self) {
        self.course.clear();
    }

    /// The panel. A file that is dropped on the window is loaded: as a speed field by its name, else as the recording.
    pub fn show(&mut self, ui: &mut Ui, loader: &LoaderHandle, params: &EffectParams) {
        let view = loader.status.view();
        if view.path != self.followed {
            self.path = view.path.clone().unwrap_or_default();
            self.followed = view.path.clone();
        }
        if let Some(path) = self.drops.as_mut().and_then(DropTarget::poll) {
            self.take(path, loader);
        }
        if let Some(chosen) = self.dialog.as_mut().and_then(Dialog::poll) {
            self.dialog = None;
            if let Some(path) = chosen {
                self.take(path, loader);
            }
        }
        ui.horizontal(|ui| {
            self.loading(ui, loader, &view);
        });
        ui.horizontal(|ui| {
            let mut embed = view.embed;
            let keep = ui.checkbox(&mut embed, "Keep in the session");
            map::note(ui, "toggle.Keep in the session", keep.rect);
            if keep.on_hover_text("Saves the recording itself with the session, up to 10 MB").changed() {
                loader.set_embed(embed);
            }
            ui.separator();
            learning(ui, loader, params, &view);
            if let Some(field) = &view.field {
                ui.separator();
                ui.label(RichText::new(field).color(theme::WEAK)).on_hover_text("Speed field: set Flow to field");
                if ui.small_button("Remove").on_hover_text("Does without the speed field").clicked() {
                    loader.unload_field();
                }
            }
        });
        if let Some(error) = &view.error {
            ui.add(egui::Label::new(RichText::new(error).color(theme::ALARM)).wrap());
        }
    }

    /// Loads a file that was dropped, chosen or typed.
    fn take(&mut self, path: PathBuf, loader: &LoaderHandle) {
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(FIELD_EXTENSION)) {
            loader.load_field(path);
        } else {
            self.path = path.to_string_lossy().into_owned();
            loader.load(path);
        }
    }

    fn loading(&mut self, ui: &mut Ui, loader: &LoaderHandle, view: &View) {
        let browse = ui.add_enabled(self.dialog.is_none(), egui::Button::new("Load recording…"));
        map::note(ui, "button.Load recording", browse.rect);
        if browse
            .on_hover_text("Or drop a sound file on the window; a .field file is the speed field of vortex sound")
            .clicked()
        {
            self.dialog = Some(Dialog::open(&self.path, self.notifier.clone()));
        }
        let width = (ui.available_width() - 76.0).max(80.0);
        let field = egui::TextEdit::singleline(&mut self.path)
            .hint_text("or the path of a sound file, then Enter")
            .desired_width(width);
        let typed = ui.add(field);
        map::note(ui, "field.Recording", typed.rect);
        let entered = typed.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let path = self.path.trim();
        if entered && !path.is_empty() {
            self.take(PathBuf::from(path), loader);
        }
        let remove = ui.add_enabled(view.path.is_some(), egui::Button::new("Remove"));
        map::note(ui, "button.Remove recording", remove.rect);
        if remove.clicked() {
            loader.unload();
        }
    }

    /// Outline and course of the recording, or what is in their way.
    pub fn show_pictures(&mut self, ui: &Ui, [above, below]: [Rect; 2], view: &View) {
        let painter = ui.painter();
        [above, below].iter().for_each(|rect| {
            painter.rect_filled(*rect, 3.0, theme::WELL);
        });
        if let Some(portrait) = &view.portrait {
            outline::show(ui, above, portrait);
            self.course.show(ui, below, portrait);
        }
        let centre = above.union(below).center();
        let word = |text: &str, color| {
            let width = above.width() - 20.0;
            let galley = painter.layout(text.to_owned(), egui::FontId::proportional(12.5), color, width);
            let place = Rect::from_center_size(centre, galley.size());
            painter.rect_filled(place.expand(5.0), 3.0, theme::WELL.gamma_multiply(0.85));
            painter.galley(place.min, galley, color);
        };
        if let Some((what, done)) = &view.progress {
            let bar = Rect::from_min_max(below.left_bottom() - Vec2::new(0.0, 4.0), below.right_bottom());
            painter.rect_filled(bar, 0.0, theme::LINE);
            let done_at = bar.left() + bar.width() * done.clamp(0.0, 1.0);
            painter.rect_filled(bar.with_max_x(done_at), 0.0, theme::EMBER);
            word(&format!("{what} … {:.0} %", 100.0 * done), theme::TEXT);
        } else {
            match (&view.recording, &view.path) {
                (Some(recording), _) => label(ui, above, recording, theme::ASH),
                (None, Some(path)) => word(&format!("Not loaded: {path}\nLoad it from where it is now."), theme::ALARM),
                (None, None) => {
                    word(
                        "No recording yet: extension stands in for texture.\nDrop a recording of fire here.",
                        theme::WEAK,
                    );
                }
            }
        }
        if self.drops.as_ref().is_some_and(DropTarget::is_hovered) {
            painter.rect_stroke(above.union(below), 3.0, egui::Stroke::new(2.0, theme::EMBER), StrokeKind::Inside);
        }
    }
}

fn learning(ui: &mut Ui, loader: &LoaderHandle, params: &EffectParams, view: &View) {
    let learning = &loader.shared.learning;
    let is_on = learning.load(Ordering::Relaxed);
    let text = if is_on { "Learning: press when it has played" } else { "Learn the drive" };
    let learn = ui.add(egui::Button::new(text).selected(is_on));
    map::note(ui, "button.Learn", learn.rect);
    if learn.on_hover_text("Press, play the track once, press again: the texture then follows its loudness").clicked() {
        learning.store(!is_on, Ordering::Relaxed);
    }
    if let Some(values) = view.learning {
        ui.label(format!("{values} amplitudes so far"));
    } else if let Some(learned) = &view.learned {
        ui.label(RichText::new(learned).color(theme::WEAK));
        if ui.small_button("Forget").clicked() {
            loader.forget_learned();
        }
    } else if DYNAMIC_RANGES[params.values().get(Id::DynamicRange) as usize] == "learned" {
        ui.colored_label(theme::ALARM, "Set to learned, but nothing was learned yet.");
    }
}
