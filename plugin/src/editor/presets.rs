//! Presets: the one that sounds, those before and after it, and a list of all, to search, save, rename and delete.

mod list;

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Button, Ui, Vec2};
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::library::Stored;
use pyrophone_settings::{Error, Library, Preset, PresetRecording, Values};

use super::history::Entry;
use super::map;
use super::param_editor::ParamEditor;
use super::task::Task;

/// Least and largest width of the name in the head, in points.
const NAME_WIDTH: (f32, f32) = (104.0, 190.0);

/// Change made to the user's presets.
enum Done {
    Listed,
    /// Saved or renamed, to this file.
    Kept(PathBuf),
    Deleted,
    /// A preset of that name exists and may be replaced.
    Exists(String),
}

/// Content of the user's folder.
struct Found {
    presets: Vec<Stored>,
    broken: Vec<Error>,
    favourites: Vec<String>,
}

/// Result of a task: the change made, and the folder's content after it.
type Outcome = (Result<Done, Error>, Found);

/// Factory presets and the user's.
pub struct Presets {
    library: Option<Library>,
    factory: Vec<Arc<Entry>>,
    users: Vec<Arc<Entry>>,
    broken: Vec<String>,
    favourites: Vec<String>,
    list: list::List,
    task: Option<Task<Outcome>>,
    message: Option<(String, bool)>,
    notifier: RepaintNotifier,
}

impl Presets {
    /// The factory presets, and those in the user's folder.
    pub fn new(notifier: RepaintNotifier) -> Self {
        // They are part of the build, and a test reads every one.
        let factory = Preset::factory().unwrap_or_default();
        Self {
            library: Library::of_user(),
            factory: factory.into_iter().map(|preset| Arc::new(Entry { preset, path: None })).collect(),
            users: vec![],
            broken: vec![],
            favourites: vec![],
            list: list::List::default(),
            task: None,
            message: None,
            notifier,
        }
    }

    /// Looks for the user's presets in the folder that is theirs now.
    pub fn relocate(&mut self) {
        self.library = Library::of_user();
        self.run(|_| Ok(Done::Listed));
    }

    /// Cancels pending work when a window closes.
    pub fn close(&mut self) {
        self.list.close();
        self.task = None;
    }

    /// The preset's name, with a star if changed, which opens the list; and buttons for the previous and next preset.
    pub fn show(&mut self, ui: &mut Ui, width: f32, edit: &mut ParamEditor<'_>) {
        self.follow(edit);
        let values = edit.values();
        if edit.history.chosen.is_none() {
            edit.history.chosen =
                self.factory.iter().find(|entry| entry.preset.values.chosen_over(&values) == values).cloned();
        }
        let shown = match &edit.history.chosen {
            Some(entry) if entry.preset.values.chosen_over(&values) == values => entry.preset.title().to_owned(),
            Some(entry) => format!("{} *", entry.preset.title()),
            None => "changed *".to_owned(),
        };
        let step = |ui: &mut Ui, words: &str, name: &str, hint: &str| {
            let button = ui.add(Button::new(words).min_size(Vec2::new(18.0, 0.0)));
            map::note(ui, format_args!("button.{name}"), button.rect);
            button.on_hover_text(hint).clicked()
        };
        ui.spacing_mut().item_spacing.x = 2.0;
        let is_back = step(ui, "‹", "Previous preset", "Previous preset");
        let width = width.clamp(NAME_WIDTH.0, NAME_WIDTH.1);
        let button =
            ui.add(Button::new(shown).min_size(Vec2::new(width, 0.0)).truncate().selected(self.list.is_open()));
        let button = button.on_hover_text("Presets. A star marks changes since the preset was loaded");
        map::note(ui, "button.Presets", button.rect);
        let is_forth = step(ui, "›", "Next preset", "Next preset");
        if is_back || is_forth {
            self.step(is_forth, edit);
        }
        if button.clicked() && self.list.toggle() {
            self.message = None;
            // A pending task lists them too, and starting another would have to wait for it.
            if self.task.is_none() {
                self.run(|_| Ok(Done::Listed));
            }
        }
        if self.list.is_open() {
            self.show_list(ui, button.rect, edit);
        }
    }

    /// Chooses the next preset of the list, or the previous one, with wraparound.
    fn step(&mut self, is_forth: bool, edit: &mut ParamEditor<'_>) {
        let all: Vec<Arc<Entry>> = self.users.iter().chain(&self.factory).cloned().collect();
        let now = edit.history.chosen.as_ref();
        let at =
            all.iter().position(|entry| Some(entry.preset.name.as_str()) == now.map(|now| now.preset.name.as_str()));
        let next = match (at, is_forth) {
            (None, _) => 0,
            (Some(at), true) => (at + 1) % all.len(),
            (Some(at), false) => (at + all.len() - 1) % all.len(),
        };
        edit.choose(all.get(next).cloned());
    }

    /// Handles the result of a task.
    fn follow(&mut self, edit: &mut ParamEditor<'_>) {
        let Some((done, found)) = self.task.as_mut().and_then(Task::poll) else { return };
        self.task = None;
        let entry = |stored: Stored| Arc::new(Entry { preset: stored.preset, path: Some(stored.path) });
        self.users = found.presets.into_iter().map(entry).collect();
        self.broken = found.broken.iter().map(ToString::to_string).collect();
        self.favourites = found.favourites;
        self.list.forget_questions();
        match done {
            Ok(Done::Listed) => {}
            Ok(Done::Kept(path)) => {
                let kept = self.users.iter().find(|entry| entry.path.as_ref() == Some(&path)).cloned();
                let name = kept.as_ref().map_or("", |entry| entry.preset.title());
                self.message = Some((format!("Saved as \"{name}\""), false));
                edit.history.chosen = kept;
            }
            Ok(Done::Deleted) => self.message = Some(("Deleted.".to_owned(), false)),
            Ok(Done::Exists(name)) => {
                self.list.ask_to_replace();
                self.message =
                    Some((format!("There is a \"{name}\" already: press Replace, or change the name."), true));
            }
            Err(error) => self.message = Some((error.to_string(), true)),
        }
    }

    /// Runs work on the user's library on a separate thread.
    fn run(&mut self, work: impl FnOnce(&Library) -> Result<Done, Error> + Send + 'static) {
        let Some(library) = self.library.clone() else {
            self.message = Some(("There is no home folder for presets; set PYROPHONE_PRESETS.".into(), true));
            return;
        };
        let notifier = self.notifier.clone();
        let task = move || {
            let done = match work(&library) {
                Err(Error::PresetExists { name, .. }) => Ok(Done::Exists(name)),
                done => done,
            };
            let (presets, broken) = library.list();
            (done, Found { presets, broken, favourites: library.favourites() })
        };
        self.task = Task::start("pyrophone-presets", task, move || notifier.request_repaint());
    }

    /// Saves the current settings as a user preset, with this recording.
    fn save(
        &mut self,
        name: &str,
        values: Values,
        recording: Option<PresetRecording>,
        replaces: bool,
        from: Option<&Arc<Entry>>,
    ) {
        // Description and tags of the original preset probably fit its variant too.
        let mut preset = from.map(|entry| entry.preset.clone()).unwrap_or_default();
        if from.is_some_and(|entry| entry.path.is_none()) {
            preset.description = format!("From {}", preset.title());
            preset.author.clear();
        }
        preset = Preset { name: name.trim().to_owned(), title: String::new(), values, recording, ..preset };
        self.run(move |library| library.save(&preset, replaces).map(Done::Kept));
    }

    /// Marks a preset as a favourite, or removes the mark.
    fn mark(&mut self, name: &str) {
        let before = self.favourites.len();
        self.favourites.retain(|favourite| favourite != name);
        if self.favourites.len() == before {
            self.favourites.push(name.to_owned());
        }
        let names = self.favourites.clone();
        self.run(move |library| library.keep_favourites(&names).map(|()| Done::Listed));
    }
}
