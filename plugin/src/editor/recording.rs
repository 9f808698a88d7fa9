//! The recording and the speed field: loading them, the part used for learning, names, progress and messages; learning
//! the dynamic range.

mod region;

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use egui::{Button, DragValue, Label, Rect, RichText, ScrollArea, StrokeKind, TextEdit, Ui, Vec2};
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::session::{Cut, MAX_CUT_GAIN_DB};
use pyrophone_settings::table::DYNAMIC_RANGES;
use pyrophone_settings::{FACTORY_FIRES, FactoryFire, Id};
use raw_window_handle::HasWindowHandle;

use super::dialog::{Answer, Ask, Dialog};
use super::drop::DropTarget;
use super::param_editor::ParamEditor;
use super::plots::outline::RecordingOutline;
use super::plots::spectrogram::{Still, label};
use super::{map, theme};
use crate::loader::LoaderHandle;
use crate::loader::status::View;
use region::{Change, Region, SHORTEST_S};

/// File name extension of speed fields.
const FIELD_EXTENSION: &str = "field";
/// Message where the system shows no dialog.
const NO_DIALOG: &str =
    "This system shows no file dialog. Drop the file on the window, or type its path on the Engines page.";
/// Height of a plot that has room for a name in its corner, in points.
const ROOM_FOR_LABEL: f32 = 24.0;

/// The panel, with the text being typed into it.
pub struct RecordingPanel {
    /// The path as typed, and the session's path that it followed last.
    path: String,
    followed: Option<String>,
    dialog: Option<(Ask, Dialog)>,
    drops: Option<DropTarget>,
    course: Still,
    outline: RecordingOutline,
    region: Region,
    /// The part and level while being typed or dragged.
    held: Option<Cut>,
    /// Sample rate of the engine in Hz, while one runs.
    rate_hz: Option<f32>,
    /// The factory fires by their titles.
    fires: Vec<(String, FactoryFire)>,
    notifier: RepaintNotifier,
}

impl RecordingPanel {
    /// An empty panel; `notifier` wakes the window when a file was chosen.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self {
            path: String::new(),
            followed: None,
            dialog: None,
            drops: None,
            course: Still::default(),
            outline: RecordingOutline::default(),
            region: Region::default(),
            held: None,
            rate_hz: None,
            fires: FACTORY_FIRES
                .iter()
                .filter_map(|fire| Some((fire.preset().ok()?.title().to_owned(), *fire)))
                .collect(),
            notifier,
        }
    }

    /// Calls off the system's dialog.
    pub fn close_dialog(&mut self) {
        self.dialog = None;
        self.held = None;
        self.region = Region::default();
    }

    /// Starts accepting files dropped on this window.
    pub fn take_drops(&mut self, window: &impl HasWindowHandle) {
        self.drops = DropTarget::open(window, self.notifier.clone());
    }

    /// Stops accepting files.
    pub fn refuse_drops(&mut self) {
        self.drops = None;
    }

    /// Drops the pictures drawn for a window that is gone.
    pub fn clear_pictures(&mut self) {
        self.course.clear();
        self.outline = RecordingOutline::default();
    }

    /// Loads a file dropped on the window or chosen in a dialog: a speed field by its extension, otherwise a recording.
    pub fn follow(&mut self, loader: &LoaderHandle, view: &View, rate_hz: Option<f32>) {
        self.rate_hz = rate_hz;
        if view.path != self.followed {
            self.path = view.path.clone().unwrap_or_default();
            self.followed = view.path.clone();
        }
        if let Some(path) = self.drops.as_mut().and_then(DropTarget::poll) {
            self.take(path, loader);
        }
        if let Some((ask, chosen)) = self.dialog.as_mut().and_then(|(ask, dialog)| Some((ask.clone(), dialog.poll()?)))
        {
            self.dialog = None;
            match (ask, chosen) {
                (Ask::Drive, Answer::Chosen(path)) => loader.learn_from(path),
                (_, Answer::Chosen(path)) => self.take(path, loader),
                (_, Answer::Unavailable) => loader.status.update(|view| view.error = Some(NO_DIALOG.to_owned())),
                (_, Answer::Cancelled) => {}
            }
        }
    }

    /// The panel, with the part used for learning in figures, and controls for learning.
    pub fn show(&mut self, ui: &mut Ui, loader: &LoaderHandle, edit: &mut ParamEditor<'_>, view: &View) {
        ScrollArea::vertical().id_salt("recording").auto_shrink(false).show(ui, |ui| self.rows(ui, loader, edit, view));
    }

    fn rows(&mut self, ui: &mut Ui, loader: &LoaderHandle, edit: &mut ParamEditor<'_>, view: &View) {
        // Narrow windows break the rows, and scroll.
        ui.horizontal_wrapped(|ui| self.loading(ui, loader, view));
        ui.horizontal_wrapped(|ui| self.cutting(ui, loader, view));
        ui.horizontal_wrapped(|ui| {
            self.learning(ui, loader, edit, view);
            if let Some(field) = &view.field {
                ui.separator();
                ui.label(RichText::new(field).color(theme::WEAK)).on_hover_text("Speed field: used when Flow is field");
                if ui.small_button("Remove").on_hover_text("Removes the speed field").clicked() {
                    loader.unload_field();
                }
            }
        });
        message(ui, loader, view);
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

    fn ask(&mut self, ask: Ask) {
        self.dialog = Some((ask.clone(), Dialog::open(ask, &self.path, self.notifier.clone())));
    }

    /// Buttons that load a recording.
    pub fn buttons(&mut self, ui: &mut Ui, loader: &LoaderHandle, view: &View) {
        let is_missing = view.recording.is_none() && view.path.is_some() && view.progress.is_none();
        let (words, hint) = if is_missing {
            (
                RichText::new("Locate…").color(theme::ALARM),
                "Choose the file at its new place; its selected part and level are kept",
            )
        } else {
            let hint =
                "You can also drop a sound file on the window, or a .field file: the speed field of vortex sound";
            (RichText::new("Load recording…"), hint)
        };
        let browse = ui.add_enabled(self.dialog.is_none(), Button::new(words));
        map::note(ui, "button.Load recording", browse.rect);
        if browse.on_hover_text(hint).clicked() {
            self.ask(Ask::Recording);
        }
        self.library(ui, loader, view);
    }

    /// Menu of recordings at hand: the factory fires, and those loaded recently.
    fn library(&mut self, ui: &mut Ui, loader: &LoaderHandle, view: &View) {
        let mut chosen = None;
        let library = ui.menu_button("Library", |ui| {
            let mut row = |ui: &mut Ui, name: &str, path: &Path| {
                let button = ui.button(name);
                map::note(ui, format_args!("library.{name}"), button.rect);
                if button.on_hover_text(path.display().to_string()).clicked() {
                    chosen = Some(path.to_owned());
                    ui.close();
                }
            };
            ui.label(RichText::new("Factory fires").font(theme::small()).color(theme::WEAK));
            for (title, fire) in &self.fires {
                row(ui, title, &fire.path());
            }
            if !view.recent.is_empty() {
                ui.separator();
                ui.label(RichText::new("Recent").font(theme::small()).color(theme::WEAK));
            }
            for path in &view.recent {
                row(ui, path.rsplit(['/', '\\']).next().unwrap_or(path), Path::new(path));
            }
        });
        map::note(ui, "button.Library", library.response.rect);
        library.response.on_hover_text("Fires that Pyrophone plays itself, and recordings loaded recently");
        if let Some(path) = chosen {
            self.take(path, loader);
        }
    }

    fn loading(&mut self, ui: &mut Ui, loader: &LoaderHandle, view: &View) {
        self.buttons(ui, loader, view);
        let width = (ui.available_size_before_wrap().x - 76.0).max(70.0);
        let field = TextEdit::singleline(&mut self.path).hint_text("or the path of a sound file").desired_width(width);
        let typed = ui.add(field);
        map::note(ui, "field.Path", typed.rect);
        let entered = typed.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let path = self.path.trim();
        if entered && !path.is_empty() {
            self.take(PathBuf::from(path), loader);
        }
        if view.progress.is_some() {
            let cancel = ui.button("Cancel").on_hover_text("Stops loading; the current sound continues");
            map::note(ui, "button.Cancel", cancel.rect);
            if cancel.clicked() {
                loader.cancel();
            }
            return;
        }
        let remove = ui.add_enabled(view.path.is_some(), Button::new("Remove"));
        map::note(ui, "button.Remove", remove.rect);
        if remove.clicked() {
            loader.unload();
        }
    }

    /// The part used for learning, and its level.
    fn cutting(&mut self, ui: &mut Ui, loader: &LoaderHandle, view: &View) {
        let duration_s = view.overview.as_ref().map_or(0.0, |overview| overview.duration_s);
        let cut = self.held.unwrap_or(view.cut);
        let [mut start_s, mut end_s] = cut.region_s.unwrap_or([0.0, duration_s]);
        let (mut gain_db, mut normalise) = (cut.gain_db, cut.normalise);
        let (mut is_held, mut is_done) = (false, false);
        let mut number = |ui: &mut Ui, name: &str, value: DragValue<'_>, hint: &str| {
            let response = ui.add(value).on_hover_text(hint);
            map::note(ui, format_args!("number.{name}"), response.rect);
            is_held |= response.changed() || response.dragged();
            is_done |= response.drag_stopped() || response.lost_focus();
        };
        ui.add_enabled_ui(view.overview.is_some(), |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.spacing_mut().interact_size.x = 48.0;
            let seconds = |value, name| DragValue::new(value).prefix(name).suffix(" s").fixed_decimals(2).speed(0.01);
            number(
                ui,
                "Start",
                seconds(&mut start_s, "from ").range(0.0..=duration_s),
                "Start of the part to learn from",
            );
            number(ui, "End", seconds(&mut end_s, "to ").range(0.0..=duration_s), "End of the part to learn from");
            let gain = DragValue::new(&mut gain_db).prefix("gain ").suffix(" dB").fixed_decimals(1).speed(0.1);
            number(ui, "Gain", gain.range(-MAX_CUT_GAIN_DB..=MAX_CUT_GAIN_DB), "Gain of the recording");
        });
        let toggle =
            ui.checkbox(&mut normalise, "Normalise").on_hover_text("Normalises the selected part to full scale first");
        map::note(ui, "toggle.Normalise", toggle.rect);
        let mut embed = view.embed;
        let keep = ui.checkbox(&mut embed, "Embed");
        map::note(ui, "toggle.Keep in the session", keep.rect);
        if keep.on_hover_text("Saves the recording itself with the session, up to 10 MB").changed() {
            loader.set_embed(embed);
        }
        let is_whole = start_s <= 0.0 && end_s >= duration_s;
        let region_s = (!is_whole).then_some([start_s.min(end_s - SHORTEST_S).max(0.0), end_s.max(SHORTEST_S)]);
        let now = Cut { region_s, gain_db, normalise };
        if toggle.changed() || is_done && self.held.is_some() {
            self.held = None;
            loader.set_cut(now);
        } else if is_held {
            self.held = Some(now);
        }
    }

    /// Outline and spectrogram of the recording, or the reason for their absence.
    pub fn show_pictures(&mut self, ui: &Ui, [above, below]: [Rect; 2], loader: &LoaderHandle, view: &View) {
        ui.painter().rect_filled(below, 3.0, theme::WELL);
        self.show_outline(ui, above, loader, view);
        if let Some(overview) = &view.overview {
            self.course.show(ui, below, overview);
            // In a low plot the name would cover the picture.
            if let Some(recording) = view.recording.as_ref().filter(|_| above.height() >= ROOM_FOR_LABEL) {
                label(ui, above, recording, theme::ASH);
            }
        }
    }

    /// Outline of the recording with the part used for learning, or the reason for its absence.
    pub fn show_outline(&mut self, ui: &Ui, above: Rect, loader: &LoaderHandle, view: &View) {
        let painter = ui.painter();
        painter.rect_filled(above, 3.0, theme::WELL);
        if let Some(overview) = &view.overview {
            self.outline.show(ui, above, overview);
            if let Some(recording) = &view.recording {
                map::note(ui, format_args!("recording.{recording}"), above);
            }
            let shown = self.held.unwrap_or(view.cut).region_s;
            let change = self.region.show(ui, above, overview.duration_s, shown);
            if let Some(change) = change {
                let region_s = if let Change::Part(region_s) = change { Some(region_s) } else { None };
                loader.set_cut(Cut { region_s, ..view.cut });
            }
        }
        let centre = above.center();
        let word = |text: &str, colour| {
            let width = above.width() - 20.0;
            let mut galley = painter.layout(text.to_owned(), theme::strong(), colour, width);
            if galley.size().y > above.height() {
                galley = painter.layout(text.replace('\n', " "), theme::small(), colour, width);
            }
            let place = Rect::from_center_size(centre, galley.size());
            painter.rect_filled(place.expand(5.0), 3.0, theme::text_background());
            painter.galley(place.min, galley, colour);
        };
        if let Some((what, done)) = &view.progress {
            let bar = Rect::from_min_max(above.left_bottom() - Vec2::new(0.0, 4.0), above.right_bottom());
            painter.rect_filled(bar, 0.0, theme::LINE);
            let done_at = bar.left() + bar.width() * done.clamp(0.0, 1.0);
            painter.rect_filled(bar.with_max_x(done_at), 0.0, theme::EMBER);
            word(&format!("{what} … {:.0} %", 100.0 * done), theme::TEXT);
        } else if let Some(path) = view.path.as_ref().filter(|_| view.recording.is_none()) {
            word(
                &format!("Not found: {path}\nLocate the file. Until then, synthetic sound replaces it."),
                theme::ALARM,
            );
        } else if view.recording.is_none() {
            word(
                "Drop a recording of a fire here, load one, or choose one from the library.\nUntil then, synthetic sound replaces it.",
                theme::WEAK,
            );
        }
        if self.drops.as_ref().is_some_and(DropTarget::is_hovered) {
            painter.rect_stroke(above, 3.0, egui::Stroke::new(2.0, theme::EMBER), StrokeKind::Inside);
        }
    }

    fn learning(&mut self, ui: &mut Ui, loader: &LoaderHandle, edit: &mut ParamEditor<'_>, view: &View) {
        let learning = &loader.shared.learning;
        let is_on = learning.load(Ordering::Relaxed);
        let text = if is_on { "Learning: press again after playing" } else { "Learn the flame" };
        let learn = ui.add(Button::new(text).selected(is_on));
        map::note(ui, "button.Learn the drive", learn.rect);
        let hint = "Press, play the track once and press again: the texture then follows its loudness";
        if learn.on_hover_text(hint).clicked() {
            loader.shared.learned_samples.store(0, Ordering::Relaxed);
            learning.store(!is_on, Ordering::Relaxed);
        }
        if view.learning.is_some() {
            let samples = loader.shared.learned_samples.load(Ordering::Relaxed) as f32;
            ui.label(self.rate_hz.map_or_else(String::new, |rate_hz| format!("{:.1} s so far", samples / rate_hz)));
            return;
        }
        let from_file = ui.add_enabled(self.dialog.is_none(), Button::new("from file…"));
        map::note(ui, "button.Learn from file", from_file.rect);
        let hint = "Learns from a sound file instead of the track, with the current drive settings";
        if from_file.on_hover_text(hint).clicked() {
            self.ask(Ask::Drive);
        }
        let learned_range = DYNAMIC_RANGES.iter().position(|range| *range == "learned").unwrap_or(0);
        let is_used = edit.get(Id::DynamicRange) as usize == learned_range;
        if let Some(learned) = &view.learned {
            if !is_used {
                let use_it = ui.small_button("Use it").on_hover_text("Sets Dynamic range to learned");
                map::note(ui, "button.Use learned", use_it.rect);
                if use_it.clicked() {
                    edit.set_once(Id::DynamicRange as usize, learned_range as f64);
                }
            }
            if ui.small_button("Forget").clicked() {
                loader.forget_learned();
            }
            let text = RichText::new(learned).font(theme::small()).color(theme::WEAK);
            ui.add(Label::new(text).truncate()).on_hover_text(learned);
        } else if is_used {
            ui.label(RichText::new("Nothing was learned yet.").font(theme::small()).color(theme::ALARM));
        }
    }
}

/// An error or notice, until it is dismissed.
pub fn message(ui: &mut Ui, loader: &LoaderHandle, view: &View) {
    let (message, color) = match (&view.error, &view.notice) {
        (Some(error), _) => (error, theme::ALARM),
        (None, Some(notice)) => (notice, theme::WEAK),
        (None, None) => return,
    };
    ui.horizontal_top(|ui| {
        if ui.small_button("×").on_hover_text("Read").clicked() {
            loader.status.update(|view| (view.error, view.notice) = (None, None));
        }
        let text = RichText::new(message).font(theme::small()).color(color);
        ui.add(Label::new(text).wrap()).on_hover_text(message);
    });
}
