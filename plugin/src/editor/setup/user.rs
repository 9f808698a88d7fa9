//! Settings of the user rather than of a sound: the window's scale and the folder of presets.

use std::path::{Path, PathBuf};

use egui::{ComboBox, Key, Label, Rect, RichText, TextEdit, Ui};
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::library::Origin;
use pyrophone_settings::window_scale::SCALES_PERCENT;
use pyrophone_settings::{Library, ScaleFile};

use super::super::dialog::{Answer, Ask, Dialog};
use super::super::task::Task;
use super::super::widgets::section::{section, within};
use super::super::{map, theme};

/// Height of the panel in points.
pub const HEIGHT: f32 = 160.0;
/// Width of the names on the left, in points.
const NAME: f32 = 88.0;

/// Outcome of a task: a change of the folder if there was one, and a message.
struct Outcome {
    has_moved: bool,
    error: Option<String>,
}

/// Settings of the user.
pub struct UserPanel {
    located: Option<(Library, Origin)>,
    /// The folder's path while it is being typed.
    typed: String,
    dialog: Option<Dialog>,
    task: Option<Task<Outcome>>,
    error: Option<String>,
    notifier: RepaintNotifier,
}

impl UserPanel {
    /// `notifier` wakes the window when a folder was chosen.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self { located: None, typed: String::new(), dialog: None, task: None, error: None, notifier }
    }

    /// Looks where the folder is: another instance may have changed it.
    pub fn open(&mut self) {
        self.locate();
        self.error = None;
    }

    /// Calls off the system's dialog.
    pub fn close(&mut self) {
        (self.dialog, self.task) = (None, None);
    }

    fn locate(&mut self) {
        self.located = Library::located();
        self.typed = self.folder().map_or_else(String::new, |folder| folder.to_string_lossy().into_owned());
    }

    fn folder(&self) -> Option<&Path> {
        self.located.as_ref().map(|(library, _)| library.folder())
    }

    /// Handles the answers of dialog and tasks; true if the folder of presets has changed.
    pub fn follow(&mut self) -> bool {
        if let Some(chosen) = self.dialog.as_mut().and_then(Dialog::poll) {
            self.dialog = None;
            match chosen {
                Answer::Chosen(folder) => self.choose(Some(folder)),
                Answer::Unavailable => {
                    self.error = Some("This system shows no file dialog: type the folder's path.".to_owned());
                }
                Answer::Cancelled => {}
            }
        }
        let Some(outcome) = self.task.as_mut().and_then(Task::poll) else { return false };
        (self.task, self.error) = (None, outcome.error);
        if outcome.has_moved {
            self.locate();
        }
        outcome.has_moved
    }

    fn choose(&mut self, folder: Option<PathBuf>) {
        self.work(move || {
            let done = Library::choose(folder.as_deref());
            Outcome { has_moved: done.is_ok(), error: done.err().map(|error| error.to_string()) }
        });
    }

    fn work(&mut self, work: impl FnOnce() -> Outcome + Send + 'static) {
        let notifier = self.notifier.clone();
        // The one before is waited for: both may write the same file.
        self.task = None;
        self.task = Task::start("pyrophone-user", work, move || notifier.request_repaint());
    }

    /// Draws the panel in `rect`.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect) {
        let inner = section(ui, rect, "WINDOW AND FILES", "for all instances");
        within(ui, inner, "user", |ui| {
            ui.spacing_mut().item_spacing.y = 6.0;
            ui.horizontal(|ui| {
                name(ui, "Scale");
                self.scale(ui);
            });
            ui.horizontal(|ui| {
                name(ui, "Presets folder");
                self.buttons(ui);
            });
            self.path(ui);
            let (words, color) = match (&self.error, &self.located) {
                (Some(error), _) => (error.as_str(), theme::ALARM),
                (None, Some((_, Origin::Environment))) => {
                    ("Set by the environment variable PYROPHONE_PRESETS, so it cannot be changed here.", theme::WEAK)
                }
                (None, Some(_)) => (
                    "Your presets, favourites and lists of MIDI controllers and recent recordings. Files stay where they are when you change it.",
                    theme::WEAK,
                ),
                (None, None) => ("There is no home folder for presets; set PYROPHONE_PRESETS.", theme::ALARM),
            };
            ui.add(Label::new(RichText::new(words).font(theme::small()).color(color)).wrap());
        });
    }

    fn scale(&mut self, ui: &mut Ui) {
        let now = (100.0 * ui.ctx().zoom_factor()).round() as u16;
        let mut chosen = now;
        let list = ComboBox::from_id_salt("scale").width(72.0).selected_text(format!("{now} %")).show_ui(ui, |ui| {
            for percent in SCALES_PERCENT {
                let line = ui.selectable_value(&mut chosen, percent, format!("{percent} %"));
                map::note(ui, format_args!("scale.{percent}"), line.rect);
            }
        });
        map::note(ui, "scale", list.response.rect);
        list.response.on_hover_text("Size of everything in the window, on top of the system's own scale");
        if chosen != now {
            ui.ctx().set_zoom_factor(f32::from(chosen) / 100.0);
            self.work(move || {
                let written = ScaleFile::of_user().map_or(Ok(()), |file| file.write(chosen));
                let error = written.err().map(|error| format!("The scale could not be saved: {error}"));
                Outcome { has_moved: false, error }
            });
        }
    }

    /// True if the user may choose another folder.
    fn is_free(&self) -> bool {
        self.located.as_ref().is_some_and(|(_, origin)| *origin != Origin::Environment)
    }

    fn path(&mut self, ui: &mut Ui) {
        let is_free = self.is_free();
        let field = TextEdit::singleline(&mut self.typed).font(theme::small()).desired_width(f32::INFINITY);
        let field = field.align(egui::Align2::LEFT_CENTER);
        let typed = ui.add_enabled(is_free, field);
        map::note(ui, "field.Presets folder", typed.rect);
        if typed.lost_focus() {
            let entered = ui.input(|input| input.key_pressed(Key::Enter));
            let folder = PathBuf::from(self.typed.trim());
            if entered && self.folder() != Some(&folder) {
                self.choose(Some(folder));
            } else if !entered {
                self.locate();
            }
        }
    }

    fn buttons(&mut self, ui: &mut Ui) {
        let is_free = self.is_free();
        let open = ui.small_button("Open").on_hover_text("Shows the folder in the system's file manager");
        map::note(ui, "button.Open presets folder", open.rect);
        if open.clicked()
            && let Some(folder) = self.folder()
        {
            // It may not exist before the first preset is saved.
            let _ = std::fs::create_dir_all(folder);
            ui.ctx().open_url(egui::OpenUrl::new_tab(folder.to_string_lossy()));
        }
        let reason = "Set by the environment variable PYROPHONE_PRESETS";
        let change = ui.add_enabled(is_free && self.dialog.is_none(), egui::Button::new("Change…").small());
        map::note(ui, "button.Change presets folder", change.rect);
        if change.on_hover_text("Chooses another folder").on_disabled_hover_text(reason).clicked() {
            self.dialog = Some(Dialog::open(Ask::Folder, &self.typed, self.notifier.clone()));
        }
        let is_chosen = self.located.as_ref().is_some_and(|(_, origin)| *origin == Origin::Chosen);
        let reset = ui.add_enabled(is_chosen, egui::Button::new("Default").small());
        map::note(ui, "button.Default presets folder", reset.rect);
        if reset.on_hover_text("Goes back to the default folder").clicked() {
            self.choose(None);
        }
    }
}

/// Name of a row.
fn name(ui: &mut Ui, words: &str) {
    let (rect, _) = ui.allocate_exact_size(egui::Vec2::new(NAME, 18.0), egui::Sense::hover());
    ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, words, theme::small(), theme::WEAK);
}
