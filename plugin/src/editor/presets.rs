//! Presets: a list to search, those that come with Pyrophone and the user's own; saving and renaming.

use std::path::PathBuf;

use egui::{Align, Align2, Button, Key, Label, Layout, Pos2, Rect, RichText, ScrollArea, TextEdit, Ui, Vec2};
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::library::Stored;
use pyrophone_settings::{Error, Library, Preset, Values};

use super::hand::Hand;
use super::task::Task;
use super::{map, theme};

/// Size of the list, in points.
const SIZE: Vec2 = Vec2::new(480.0, 400.0);

/// A preset that can be chosen.
#[derive(Debug, Clone)]
struct Entry {
    preset: Preset,
    /// Its file; none for those that come with Pyrophone.
    path: Option<PathBuf>,
}

/// What was done to the user's presets.
enum Done {
    Listed,
    /// Saved or renamed, to this file.
    Kept(PathBuf),
    /// There is one of that name, which may be replaced.
    Exists(String),
}

/// What a task comes to: what was done, and the presets that there are then, with what is wrong with others.
type Outcome = (Result<Done, Error>, (Vec<Stored>, Vec<Error>));

/// The list, and the preset that was chosen last.
pub struct Presets {
    library: Option<Library>,
    factory: Vec<Entry>,
    users: Vec<Entry>,
    broken: Vec<String>,
    /// What the parameters were last set to as a whole.
    chosen: Option<Entry>,
    is_open: bool,
    has_opened: bool,
    search: String,
    tag: Option<String>,
    /// The line that the keyboard is at.
    marked: usize,
    /// What is typed in to save by.
    name: String,
    /// Whether the next saving replaces.
    replaces: bool,
    task: Option<Task<Outcome>>,
    message: Option<(String, bool)>,
    notifier: RepaintNotifier,
}

impl Presets {
    /// A list of the presets that come with Pyrophone, and of those in the user's folder.
    pub fn new(notifier: RepaintNotifier) -> Self {
        // They are part of the build, and a test reads every one.
        let factory = Preset::factory().unwrap_or_default();
        Self {
            library: Library::of_user(),
            factory: factory.into_iter().map(|preset| Entry { preset, path: None }).collect(),
            users: vec![],
            broken: vec![],
            chosen: None,
            is_open: false,
            has_opened: false,
            search: String::new(),
            tag: None,
            marked: 0,
            name: String::new(),
            replaces: false,
            task: None,
            message: None,
            notifier,
        }
    }

    /// Ends what goes on for a window that closes.
    pub fn close(&mut self) {
        self.is_open = false;
        self.task = None;
    }

    /// The button that opens the list, with the preset's name, and a star where it was changed.
    pub fn show(&mut self, ui: &mut Ui, hand: &mut Hand<'_>) {
        self.follow();
        let values = hand.values();
        if self.chosen.is_none() {
            self.chosen = self.factory.iter().find(|entry| entry.preset.values == values).cloned();
        }
        let shown = match &self.chosen {
            Some(entry) if entry.preset.values == values => entry.preset.name.clone(),
            Some(entry) => format!("{} *", entry.preset.name),
            None => "changed *".to_owned(),
        };
        let button = ui.add(Button::new(shown).min_size(Vec2::new(132.0, 0.0)).truncate().selected(self.is_open));
        let button = button.on_hover_text("Presets; a star: changed since");
        map::note(ui, "button.Presets", button.rect);
        if button.clicked() {
            self.is_open = !self.is_open;
            self.has_opened = self.is_open;
            if self.is_open {
                self.message = None;
                // What is under way lists them too, and would have to be waited for.
                if self.task.is_none() {
                    self.run(|_| Ok(Done::Listed));
                }
            }
        }
        if self.is_open {
            self.list(ui, button.rect, hand);
        }
    }

    /// Takes what a task has come to.
    fn follow(&mut self) {
        let Some((done, (users, broken))) = self.task.as_mut().and_then(Task::poll) else { return };
        self.task = None;
        self.users = users.into_iter().map(|stored| Entry { preset: stored.preset, path: Some(stored.path) }).collect();
        self.broken = broken.iter().map(ToString::to_string).collect();
        self.replaces = false;
        match done {
            Ok(Done::Listed) => {}
            Ok(Done::Kept(path)) => {
                self.chosen = self.users.iter().find(|entry| entry.path.as_ref() == Some(&path)).cloned();
                let name = self.chosen.as_ref().map_or("", |entry| &entry.preset.name);
                self.message = Some((format!("Saved as \"{name}\""), false));
            }
            Ok(Done::Exists(name)) => {
                self.replaces = true;
                self.message =
                    Some((format!("There is a \"{name}\" already: press Replace, or change the name."), true));
            }
            Err(error) => self.message = Some((error.to_string(), true)),
        }
    }

    /// Runs something with the user's library on a thread of its own.
    fn run(&mut self, work: impl FnOnce(&Library) -> Result<Done, Error> + Send + 'static) {
        let Some(library) = self.library.clone() else {
            self.message = Some(("There is no home folder to keep presets in; set PYROPHONE_PRESETS.".into(), true));
            return;
        };
        let notifier = self.notifier.clone();
        let task = move || {
            let done = match work(&library) {
                Err(Error::PresetExists { name, .. }) => Ok(Done::Exists(name)),
                done => done,
            };
            (done, library.list())
        };
        self.task = Task::start("pyrophone-presets", task, move || notifier.request_repaint());
    }

    fn list(&mut self, ui: &mut Ui, button: Rect, hand: &mut Hand<'_>) {
        let screen = ui.ctx().content_rect();
        let size = SIZE.min(screen.size() - Vec2::splat(24.0));
        let left = button.left().min(screen.right() - size.x - 12.0);
        let at = Pos2::new(left.max(screen.left() + 4.0), button.bottom() + 4.0);
        let area = egui::Area::new(egui::Id::unique("presets")).order(egui::Order::Foreground).fixed_pos(at);
        let response = area.pivot(Align2::LEFT_TOP).show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_min_size(size - Vec2::splat(16.0));
                ui.set_max_size(size - Vec2::splat(16.0));
                self.contents(ui, hand);
            });
        });
        let outside = ui.input(|input| {
            let pressed = input.pointer.any_pressed().then(|| input.pointer.interact_pos()).flatten();
            pressed.is_some_and(|at| !response.response.rect.contains(at) && !button.contains(at))
        });
        if outside || ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            self.is_open = false;
        }
    }

    fn contents(&mut self, ui: &mut Ui, hand: &mut Hand<'_>) {
        let keys = ui.input_mut(|input| {
            [Key::ArrowDown, Key::ArrowUp, Key::Enter].map(|key| input.consume_key(egui::Modifiers::NONE, key))
        });
        let search = TextEdit::singleline(&mut self.search).hint_text("Search names, words and tags");
        let search = ui.add(search.desired_width(f32::INFINITY));
        map::note(ui, "field.Search", search.rect);
        if std::mem::take(&mut self.has_opened) {
            search.request_focus();
        }
        self.tags(ui);
        let found: Vec<Entry> = self.found().cloned().collect();
        if search.changed() {
            self.marked = 0;
        }
        let [down, up, enter] = keys;
        self.marked = (self.marked + usize::from(down)).saturating_sub(usize::from(up)).min(found.len().max(1) - 1);
        let is_naming = ui.memory(|memory| memory.has_focus(egui::Id::unique(NAME)));
        let mut next = (enter && !is_naming).then(|| found.get(self.marked).cloned()).flatten();
        let height = ui.available_height() - 66.0;
        ScrollArea::vertical().auto_shrink(false).max_height(height.max(60.0)).show(ui, |ui| {
            for (index, entry) in found.iter().enumerate() {
                let line = self.line(ui, entry, index == self.marked);
                map::note(ui, format_args!("preset.{}", entry.preset.name), line.rect);
                if index == self.marked && (up || down) {
                    line.scroll_to_me(None);
                }
                if line.clicked() {
                    (self.marked, next) = (index, Some(entry.clone()));
                }
            }
            if found.is_empty() {
                ui.label(RichText::new("Nothing of that kind.").color(theme::WEAK));
            }
            for broken in &self.broken {
                ui.add(Label::new(RichText::new(broken).font(theme::small()).color(theme::ALARM)).wrap());
            }
        });
        if let Some(entry) = next {
            hand.set_all(&entry.preset.values);
            self.name = entry.preset.name.clone();
            self.chosen = Some(entry);
            self.message = None;
            self.replaces = false;
        }
        ui.separator();
        self.keeping(ui, hand, enter && is_naming);
    }

    /// The tags that there are; one can be chosen.
    fn tags(&mut self, ui: &mut Ui) {
        let all = self.factory.iter().chain(&self.users).flat_map(|entry| &entry.preset.tags);
        let mut tags: Vec<String> = all.cloned().collect();
        tags.sort();
        tags.dedup();
        ui.horizontal_wrapped(|ui| {
            for tag in tags {
                let is_chosen = self.tag.as_ref() == Some(&tag);
                let button = ui.add(Button::new(RichText::new(&tag).font(theme::small())).selected(is_chosen));
                map::note(ui, format_args!("tag.{tag}"), button.rect);
                if button.clicked() {
                    self.tag = (!is_chosen).then_some(tag);
                    self.marked = 0;
                }
            }
        });
    }

    /// The user's own first, then those that come with Pyrophone, as far as they are looked for.
    fn found(&self) -> impl Iterator<Item = &Entry> {
        let words: Vec<String> = self.search.split_whitespace().map(str::to_lowercase).collect();
        self.users.iter().chain(&self.factory).filter(move |Entry { preset, .. }| {
            let text = format!("{} {} {}", preset.name, preset.description, preset.tags.join(" ")).to_lowercase();
            words.iter().all(|word| text.contains(word))
                && self.tag.as_ref().is_none_or(|tag| preset.tags.contains(tag))
        })
    }

    fn line(&self, ui: &mut Ui, entry: &Entry, is_marked: bool) -> egui::Response {
        let is_chosen = self
            .chosen
            .as_ref()
            .is_some_and(|chosen| chosen.path == entry.path && chosen.preset.name == entry.preset.name);
        let color = if is_chosen { theme::EMBER } else { theme::TEXT };
        let mut text = egui::text::LayoutJob::default();
        let mut say = |words: &str, font, color| {
            text.append(words, 0.0, egui::TextFormat { font_id: font, color, ..Default::default() });
        };
        say(&entry.preset.name, egui::FontId::proportional(12.5), color);
        say(if entry.path.is_some() { "   yours   " } else { "   " }, theme::small(), theme::BLUE);
        say(&entry.preset.tags.join(", "), theme::small(), theme::WEAK);
        say(&format!("\n{}", entry.preset.description), theme::small(), theme::WEAK);
        let width = ui.available_width();
        ui.add(Button::new(text).selected(is_marked).wrap().frame(is_marked).min_size(Vec2::new(width, 0.0)))
    }

    /// Saving and renaming.
    fn keeping(&mut self, ui: &mut Ui, hand: &mut Hand<'_>, entered: bool) {
        let is_free = self.task.is_none();
        let (mut save, mut rename) = (false, false);
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let own = self.chosen.as_ref().and_then(|entry| Some((entry.path.clone()?, entry.preset.name.clone())));
                let can_rename = is_free && own.as_ref().is_some_and(|(_, name)| *name != self.name.trim());
                let button = ui.add_enabled(can_rename, Button::new("Rename"));
                map::note(ui, "button.Rename", button.rect);
                rename = button
                    .on_hover_text("Gives the preset that was chosen, one of yours, the name at the left")
                    .clicked();
                let can_save = is_free && !self.name.trim().is_empty();
                let button = ui.add_enabled(can_save, Button::new(if self.replaces { "Replace" } else { "Save" }));
                map::note(ui, "button.Save", button.rect);
                save =
                    button.on_hover_text("Keeps what is set now as a preset of yours").clicked() || entered && can_save;
                let field =
                    TextEdit::singleline(&mut self.name).id(egui::Id::unique(NAME)).hint_text("Name to save by");
                let field = ui.add(field.desired_width(f32::INFINITY));
                map::note(ui, "field.Preset name", field.rect);
                if field.changed() {
                    self.replaces = false;
                    self.message = None;
                }
            });
        });
        if save {
            self.save(hand.values());
        } else if rename && let Some(path) = self.chosen.as_ref().and_then(|entry| entry.path.clone()) {
            let name = self.name.clone();
            self.run(move |library| library.rename(&path, &name).map(Done::Kept));
        }
        ui.horizontal(|ui| {
            let paper = ui
                .button("The paper's values")
                .on_hover_text("Chadwick & James 2011; levels, widths, seed and envelope stay as they are");
            map::note(ui, "button.The paper's values", paper.rect);
            if paper.clicked() {
                let mut values = hand.values();
                values.reset_to_paper();
                hand.set_all(&values);
            }
            match (&self.message, &self.library) {
                (Some((message, is_bad)), _) => {
                    let color = if *is_bad { theme::ALARM } else { theme::WEAK };
                    ui.add(Label::new(RichText::new(message).font(theme::small()).color(color)).wrap());
                }
                (None, Some(library)) => {
                    let folder = format!("Yours are in {}", library.folder().display());
                    let label = Label::new(RichText::new(&folder).font(theme::small()).color(theme::WEAK)).truncate();
                    ui.add(label).on_hover_text(folder);
                }
                (None, None) => {}
            }
        });
    }

    fn save(&mut self, values: Values) {
        // What it was made from is likely to describe it too; tags of the chosen one go with it.
        let (description, tags) = match &self.chosen {
            Some(entry) if entry.path.is_some() => (entry.preset.description.clone(), entry.preset.tags.clone()),
            Some(entry) => (format!("From {}", entry.preset.name), entry.preset.tags.clone()),
            None => (String::new(), vec![]),
        };
        let preset = Preset { name: self.name.trim().to_owned(), description, tags, values };
        let replaces = self.replaces;
        self.run(move |library| library.save(&preset, replaces).map(Done::Kept));
    }
}

/// The field of the name.
const NAME: &str = "preset name";
