//! The list of presets.

use std::sync::Arc;

use egui::{
    Align, Align2, Button, Checkbox, Key, Label, Layout, Pos2, Rect, RichText, ScrollArea, Sense, Shape, Stroke,
    TextEdit, Ui, Vec2,
};

use pyrophone_settings::PresetRecording;
use pyrophone_settings::session::Slot;

use super::super::history::{Chosen, Entry};
use super::super::param_editor::ParamEditor;
use super::super::{map, theme};
use super::{Done, Presets};

/// Size of the list, in points.
const SIZE: Vec2 = Vec2::new(500.0, 430.0);
/// The field of the name.
const NAME: &str = "preset name";

/// Group of presets listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Shelf {
    #[default]
    All,
    Favourites,
    Yours,
    Factory,
}

impl Shelf {
    const ALL: [(Self, &'static str); 4] =
        [(Self::All, "All"), (Self::Favourites, "Favourites"), (Self::Yours, "Yours"), (Self::Factory, "Factory")];
}

/// Search terms and pending actions of the user.
#[derive(Debug, Default)]
pub(super) struct List {
    is_open: bool,
    has_opened: bool,
    search: String,
    tag: Option<String>,
    shelf: Shelf,
    /// The line that the keyboard is at.
    marked: usize,
    /// Name typed in for saving.
    name: String,
    /// True if the next save includes the recording.
    takes_recording: bool,
    /// True if the next save replaces, and true if the next press deletes.
    replaces: bool,
    deletes: bool,
}

impl List {
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    pub fn close(&mut self) {
        self.is_open = false;
    }

    /// Opens or closes the list; returns true if it is then open.
    pub fn toggle(&mut self) -> bool {
        self.is_open = !self.is_open;
        self.has_opened = self.is_open;
        // What was searched for last time would come before what is typed now.
        self.search.clear();
        self.forget_questions();
        self.is_open
    }

    pub fn ask_to_replace(&mut self) {
        self.replaces = true;
    }

    pub fn forget_questions(&mut self) {
        (self.replaces, self.deletes) = (false, false);
    }
}

impl Presets {
    pub(super) fn show_list(&mut self, ui: &mut Ui, button: Rect, edit: &mut ParamEditor<'_>) {
        let screen = ui.ctx().content_rect();
        let size = SIZE
            .min(screen.size() - Vec2::splat(24.0))
            .min(Vec2::new(SIZE.x, screen.bottom() - button.bottom() - 16.0));
        let left = button.left().min(screen.right() - size.x - 12.0);
        let at = Pos2::new(left.max(screen.left() + 4.0), button.bottom() + 4.0);
        let area = egui::Area::new(egui::Id::unique("presets")).order(egui::Order::Foreground).fixed_pos(at);
        let response = area.pivot(Align2::LEFT_TOP).show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_min_size(size - Vec2::splat(16.0));
                ui.set_max_size(size - Vec2::splat(16.0));
                self.contents(ui, edit);
            });
        });
        let outside = ui.input(|input| {
            let pressed = input.pointer.any_pressed().then(|| input.pointer.interact_pos()).flatten();
            pressed.is_some_and(|at| !response.response.rect.contains(at) && !button.contains(at))
        });
        if outside || ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            self.list.is_open = false;
        }
    }

    fn contents(&mut self, ui: &mut Ui, edit: &mut ParamEditor<'_>) {
        let keys = ui.input_mut(|input| {
            [Key::ArrowDown, Key::ArrowUp, Key::Enter].map(|key| input.consume_key(egui::Modifiers::NONE, key))
        });
        let search = TextEdit::singleline(&mut self.list.search).hint_text("Search by name, word or tag");
        let search = ui.add(search.desired_width(f32::INFINITY));
        map::note(ui, "field.Search", search.rect);
        if std::mem::take(&mut self.list.has_opened) {
            search.request_focus();
        }
        self.shelves(ui);
        let found: Vec<Arc<Entry>> = self.found().cloned().collect();
        if search.changed() {
            self.list.marked = 0;
        }
        let [down, up, enter] = keys;
        let last = found.len().max(1) - 1;
        self.list.marked = (self.list.marked + usize::from(down)).saturating_sub(usize::from(up)).min(last);
        let is_naming = ui.memory(|memory| memory.has_focus(egui::Id::unique(NAME)));
        let chosen = self.lines(ui, &found, up || down, edit.history.chosen.as_ref());
        if let Some(entry) = chosen.or_else(|| found.get(self.list.marked).filter(|_| enter && !is_naming).cloned()) {
            self.list.name = entry.preset.name.clone();
            self.list.takes_recording = entry.preset.recording.is_some();
            edit.choose(Some(entry));
            self.message = None;
            self.list.forget_questions();
        }
        ui.separator();
        self.keeping(ui, edit, enter && is_naming);
        self.foot(ui, edit);
    }

    /// The lines that were found; the one that was clicked.
    fn lines(&mut self, ui: &mut Ui, found: &[Arc<Entry>], has_moved: bool, now: Option<&Arc<Entry>>) -> Chosen {
        let (mut chosen, mut marked) = (None, None);
        let height = ui.available_height() - 66.0;
        ScrollArea::vertical().auto_shrink(false).max_height(height.max(60.0)).show(ui, |ui| {
            for (index, entry) in found.iter().enumerate() {
                let is_at = index == self.list.marked;
                let is_chosen = now.is_some_and(|now| now.path == entry.path && now.preset.name == entry.preset.name);
                let (line, star) = self.line(ui, entry, is_at, is_chosen);
                map::note(ui, format_args!("preset.{}", entry.preset.name), line.rect);
                if is_at && has_moved {
                    line.scroll_to_me(None);
                }
                if line.clicked() {
                    self.list.marked = index;
                    chosen = Some(entry.clone());
                }
                if star.clicked() {
                    marked = Some(entry.preset.name.clone());
                }
            }
            if found.is_empty() {
                ui.label(RichText::new("No matching presets.").color(theme::WEAK));
            }
            for broken in &self.broken {
                ui.add(Label::new(RichText::new(broken).font(theme::small()).color(theme::ALARM)).wrap());
            }
        });
        if let Some(name) = marked.filter(|_| self.task.is_none()) {
            self.mark(&name);
        }
        chosen
    }

    /// Choice of the group, and of a tag from those in use.
    fn shelves(&mut self, ui: &mut Ui) {
        let all = self.factory.iter().chain(&self.users).flat_map(|entry| &entry.preset.tags);
        let mut tags: Vec<String> = all.cloned().collect();
        tags.sort();
        tags.dedup();
        ui.horizontal_wrapped(|ui| {
            for (shelf, name) in Shelf::ALL {
                let is_chosen = self.list.shelf == shelf;
                let button = ui.add(Button::new(RichText::new(name).font(theme::small())).selected(is_chosen));
                map::note(ui, format_args!("shelf.{name}"), button.rect);
                if button.clicked() {
                    (self.list.shelf, self.list.marked) = (shelf, 0);
                }
            }
            ui.separator();
            for tag in tags {
                let is_chosen = self.list.tag.as_ref() == Some(&tag);
                let words = RichText::new(&tag).font(theme::small()).color(theme::WEAK);
                let button = ui.add(Button::new(words).selected(is_chosen));
                map::note(ui, format_args!("tag.{tag}"), button.rect);
                if button.clicked() {
                    self.list.tag = (!is_chosen).then_some(tag);
                    self.list.marked = 0;
                }
            }
        });
    }

    /// User presets first, then factory presets, filtered by the search.
    fn found(&self) -> impl Iterator<Item = &Arc<Entry>> {
        let words: Vec<String> = self.list.search.split_whitespace().map(str::to_lowercase).collect();
        self.users.iter().chain(&self.factory).filter(move |entry| {
            let preset = &entry.preset;
            let tags = preset.tags.join(" ");
            let text = format!("{} {} {} {} {tags}", preset.name, preset.title, preset.author, preset.description);
            let text = text.to_lowercase();
            let is_shelved = match self.list.shelf {
                Shelf::All => true,
                Shelf::Favourites => self.favourites.contains(&preset.name),
                Shelf::Yours => entry.path.is_some(),
                Shelf::Factory => entry.path.is_none(),
            };
            is_shelved
                && words.iter().all(|word| text.contains(word))
                && self.list.tag.as_ref().is_none_or(|tag| preset.tags.contains(tag))
        })
    }

    /// A preset and its star.
    fn line(&self, ui: &mut Ui, entry: &Entry, is_marked: bool, is_chosen: bool) -> (egui::Response, egui::Response) {
        let preset = &entry.preset;
        let color = if is_chosen { theme::EMBER } else { theme::TEXT };
        let mut text = egui::text::LayoutJob::default();
        let mut say = |words: &str, font, color| {
            text.append(words, 0.0, egui::TextFormat { font_id: font, color, ..Default::default() });
        };
        say(preset.title(), theme::strong(), color);
        say(if entry.path.is_some() { "   yours   " } else { "   " }, theme::small(), theme::BLUE);
        say(&preset.tags.join(", "), theme::small(), theme::WEAK);
        if !preset.author.is_empty() {
            say(&format!("   by {}", preset.author), theme::small(), theme::WEAK);
        }
        if let Some(file) = preset.recording.as_ref().and_then(|recording| recording.file.file_name()) {
            say(&format!("   with {}", file.to_string_lossy()), theme::small(), theme::BLUE);
        }
        say(&format!("\n{}", preset.description), theme::small(), theme::WEAK);
        ui.horizontal_top(|ui| {
            let is_favourite = self.favourites.contains(&preset.name);
            let (place, star) = ui.allocate_exact_size(Vec2::new(20.0, 26.0), Sense::click());
            draw_star(ui, place.center(), is_favourite, star.hovered() || star.has_focus());
            map::note(ui, format_args!("star.{}", preset.name), place);
            let star = star.on_hover_text("Favourite");
            let width = ui.available_width();
            let line = Button::new(text).selected(is_marked).wrap().frame(is_marked).min_size(Vec2::new(width, 0.0));
            // Left-aligned, because the lines are stacked.
            (ui.vertical(|ui| ui.add(line)).inner, star)
        })
        .inner
    }

    /// Saving, renaming, deleting.
    fn keeping(&mut self, ui: &mut Ui, edit: &mut ParamEditor<'_>, entered: bool) {
        let is_free = self.task.is_none();
        let chosen = edit.history.chosen.clone();
        let own = chosen.as_ref().and_then(|entry| Some((entry.path.clone()?, entry.preset.name.clone())));
        let (mut save, mut rename, mut delete) = (false, false, false);
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let mut action = |words: &str, name: &str, is_enabled: bool, hint: &str| {
                    let button = ui.add_enabled(is_enabled, Button::new(words));
                    map::note(ui, format_args!("button.{name}"), button.rect);
                    button.on_hover_text(hint).clicked()
                };
                let words = if self.list.deletes { "Delete for good" } else { "Delete" };
                let hint = "Deletes the selected preset, if it is your own; asks for confirmation";
                delete = action(words, "Delete", is_free && own.is_some(), hint);
                let can_rename = is_free && own.as_ref().is_some_and(|(_, name)| *name != self.list.name.trim());
                let hint = "Renames the selected preset, if it is your own, to the name on the left";
                rename = action("Rename", "Rename", can_rename, hint);
                let can_save = is_free && !self.list.name.trim().is_empty();
                let words = if self.list.replaces { "Replace" } else { "Save" };
                save = action(words, "Save", can_save, "Saves the current settings as a preset of your own")
                    || entered && can_save;
                let has_recording = edit.loader.status.view().path.is_some();
                let tick = Checkbox::new(&mut self.list.takes_recording, "With recording");
                let tick = ui.add_enabled(has_recording, tick);
                map::note(ui, "toggle.With recording", tick.rect);
                tick.on_hover_text("Saves where the active slot's recording is, its selected part and its level, so that choosing the preset loads it")
                    .on_disabled_hover_text("No recording is loaded");
                let field = TextEdit::singleline(&mut self.list.name).id(egui::Id::unique(NAME));
                let field = ui.add(field.hint_text("Preset name").desired_width(f32::INFINITY));
                map::note(ui, "field.Preset name", field.rect);
                if field.changed() {
                    self.list.forget_questions();
                    self.message = None;
                }
            });
        });
        let name = self.list.name.clone();
        match own {
            _ if save => {
                let recording = self.list.takes_recording.then(|| recording(edit)).flatten();
                self.save(&name, edit.values(), recording, self.list.replaces, chosen.as_ref());
            }
            Some((path, _)) if rename => self.run(move |library| library.rename(&path, &name).map(Done::Kept)),
            Some(_) if delete && !self.list.deletes => {
                self.list.deletes = true;
                self.message = Some((format!("Delete \"{name}\" for good?"), true));
            }
            Some((path, _)) if delete => {
                edit.history.chosen = None;
                self.run(move |library| library.delete(&path).map(|()| Done::Deleted));
            }
            _ => {}
        }
    }

    fn foot(&mut self, ui: &mut Ui, edit: &mut ParamEditor<'_>) {
        ui.horizontal(|ui| {
            let paper = ui
                .button("The paper's values")
                .on_hover_text("Chadwick & James 2011; levels, widths, seed and envelope do not change");
            map::note(ui, "button.The paper's values", paper.rect);
            if paper.clicked() {
                let mut values = edit.values();
                values.reset_to_paper();
                edit.set_all(&values);
            }
            match (&self.message, &self.library) {
                (Some((message, is_bad)), _) => {
                    let color = if *is_bad { theme::ALARM } else { theme::WEAK };
                    ui.add(Label::new(RichText::new(message).font(theme::small()).color(color)).wrap());
                }
                (None, Some(library)) => {
                    let folder = format!("User presets: {}", library.folder().display());
                    let label = Label::new(RichText::new(&folder).font(theme::small()).color(theme::WEAK)).truncate();
                    ui.add(label).on_hover_text(folder);
                }
                (None, None) => {}
            }
        });
    }
}

/// The active slot's recording, for a preset.
fn recording(edit: &ParamEditor<'_>) -> Option<PresetRecording> {
    let (_, Slot { recording, cut }) = edit.slot();
    Some(PresetRecording { file: recording?.path.into(), cut })
}

/// A star with five points, drawn because the fonts have none.
fn draw_star(ui: &Ui, centre: Pos2, is_on: bool, is_hot: bool) {
    const RADII: [f32; 2] = [6.5, 2.9];
    let point = |n: usize| {
        let angle = std::f32::consts::PI * (n as f32 / 5.0 - 0.5);
        centre + RADII[n % 2] * Vec2::angled(angle)
    };
    let color = if is_on || is_hot { theme::SPARK } else { theme::WEAK };
    let points: Vec<Pos2> = (0..10).map(point).collect();
    if is_on {
        // A star is not convex, but every one of its points is.
        let inner: Vec<Pos2> = points.iter().skip(1).step_by(2).copied().collect();
        ui.painter().add(Shape::convex_polygon(inner, color, Stroke::NONE));
        for tip in (0..10).step_by(2) {
            let corner = vec![points[(tip + 9) % 10], points[tip], points[tip + 1]];
            ui.painter().add(Shape::convex_polygon(corner, color, Stroke::NONE));
        }
    }
    ui.painter().add(Shape::closed_line(points, Stroke::new(1.0, color)));
}
