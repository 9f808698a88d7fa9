//! Monitoring of drive, recording and output alone; a test burst; recording and saving of sounds.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use egui::{Button, Rect, RichText, Ui, Vec2};
use nice_plug_egui::RepaintNotifier;
use pyrophone_recording::write_wav_f32;
use pyrophone_settings::library::Origin;
use pyrophone_settings::table::DRIVE_MODES;
use pyrophone_settings::{Id, Library};
use raw_window_handle::HasWindowHandle;

use super::dialog::{Answer, Ask, Dialog};
use super::drag::{DragSource, Outcome};
use super::monitor::Monitor;
use super::param_editor::ParamEditor;
use super::task::Task;
use super::{map, theme};
use crate::loader::LoaderHandle;
use crate::loader::status::View;
use crate::probe::Listen;

/// Sound that can be saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sound {
    Drive,
    Recording,
    Output,
}

impl Sound {
    const ALL: [Self; 3] = [Self::Drive, Self::Recording, Self::Output];

    fn name(self) -> &'static str {
        match self {
            Self::Drive => "flame",
            Self::Recording => "recording",
            Self::Output => "output",
        }
    }
}

/// Monitoring, bursts, and recording of the output.
pub struct ListenPanel {
    dialog: Option<(Sound, Dialog)>,
    saving: Option<Task<Result<PathBuf, String>>>,
    /// Source of drags of the recorded sound, where the system supports it.
    drag: Option<DragSource>,
    message: Option<(String, bool)>,
    /// Sample rate of the engine in Hz, while one runs.
    rate_hz: Option<f32>,
    notifier: RepaintNotifier,
}

impl ListenPanel {
    /// A panel; `notifier` wakes the window when something was saved.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self { dialog: None, saving: None, drag: None, message: None, rate_hz: None, notifier }
    }

    /// Enables dragging the recorded sound out of this window.
    pub fn drag_from(&mut self, window: &impl HasWindowHandle) {
        self.drag = DragSource::of(window);
    }

    /// Cancels pending work when a window closes.
    pub fn close(&mut self, loader: &LoaderHandle) {
        self.dialog = None;
        self.drag = None;
        self.message = None;
        loader.audition(false);
    }

    /// Handles the results of dialog and saving. `rate_hz` is that of the engine, if one runs.
    pub fn follow(&mut self, monitor: &Monitor, loader: &LoaderHandle, rate_hz: Option<f32>) {
        self.rate_hz = rate_hz;
        if let Some(done) = self.saving.as_mut().and_then(Task::poll) {
            self.saving = None;
            self.message = Some(match done {
                Ok(path) => (format!("Saved: {}", path.display()), false),
                Err(message) => (message, true),
            });
        }
        match self.drag.as_mut().and_then(DragSource::poll) {
            Some(Outcome::Taken(path)) => self.message = Some((format!("Dragged: {}", path.display()), false)),
            Some(Outcome::Failed(message)) => self.message = Some((message, true)),
            Some(Outcome::Dropped) | None => {}
        }
        let Some((sound, chosen)) = self.dialog.as_mut().and_then(|(sound, dialog)| Some((*sound, dialog.poll()?)))
        else {
            return;
        };
        self.dialog = None;
        match chosen {
            Answer::Chosen(path) => self.save(sound, with_extension(path), monitor, loader),
            // Saved anyway; a message says where.
            Answer::Unavailable => match take_path() {
                Some(path) => {
                    // If this fails, so does saving, which says why.
                    let _ = path.parent().map(std::fs::create_dir_all);
                    self.save(sound, path, monitor, loader);
                }
                None => self.message = Some(("This system shows no file dialog.".to_owned(), true)),
            },
            Answer::Cancelled => {}
        }
    }

    fn save(&mut self, sound: Sound, path: PathBuf, monitor: &Monitor, loader: &LoaderHandle) {
        let channels = match sound {
            Sound::Drive => monitor.take.drive(),
            Sound::Output => monitor.take.output(),
            Sound::Recording => {
                loader.save_part(path);
                return;
            }
        };
        let rate_hz = self.rate_hz.unwrap_or(44_100.0) as u32;
        let work = move || match write_wav_f32(&path, &channels, rate_hz) {
            Ok(()) => Ok(path),
            Err(error) => Err(error.to_string()),
        };
        let notifier = self.notifier.clone();
        self.saving = Task::start("pyrophone-save", work, move || notifier.request_repaint());
    }

    /// The panel below the meters.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        monitor: &mut Monitor,
        loader: &LoaderHandle,
        view: &View,
        edit: &ParamEditor<'_>,
    ) {
        ui.spacing_mut().item_spacing = Vec2::new(4.0, 3.0);
        ui.spacing_mut().button_padding = Vec2::new(5.0, 2.0);
        ui.horizontal(|ui| {
            ui.label(RichText::new("Monitor").font(theme::small()).color(theme::WEAK));
            monitoring(ui, monitor, loader, view);
        });
        ui.horizontal(|ui| {
            self.burst(ui, monitor, edit);
            self.record(ui, monitor);
            self.saves(ui, monitor, view);
        });
        self.word(ui, monitor);
    }

    /// A button that lights a burst.
    pub fn burst(&self, ui: &mut Ui, monitor: &Monitor, edit: &ParamEditor<'_>) {
        let burns = DRIVE_MODES.get(edit.get(Id::DriveMode) as usize) == Some(&"flame");
        let burst = ui.add_enabled(!burns && self.rate_hz.is_some(), Button::new("Burst"));
        map::note(ui, "button.Burst", burst.rect);
        let hint = "Adds a burst of flame to the input, for trying out settings. Has no effect on a built-in flame.";
        if burst.on_hover_text(hint).clicked() {
            monitor.burst();
        }
    }

    /// The result of saving, an error, or the recorded length.
    pub fn word(&self, ui: &mut Ui, monitor: &Monitor) {
        let seconds = monitor.take.len_samples() as f32 / self.rate_hz.unwrap_or(44_100.0);
        let (text, is_bad) = match &self.message {
            Some((message, is_bad)) => (message.clone(), *is_bad),
            None if monitor.take.lost() > 0 => ("The host was too fast: samples are missing.".to_owned(), true),
            None if monitor.take.len_samples() > 0 => (format!("Recorded: {seconds:.1} s"), false),
            None => return,
        };
        let color = if is_bad { theme::ALARM } else { theme::WEAK };
        let label = egui::Label::new(RichText::new(&text).font(theme::small()).color(color)).truncate();
        ui.add(label).on_hover_text(text);
    }

    /// A button that records drive and output.
    pub fn record(&mut self, ui: &mut Ui, monitor: &mut Monitor) {
        let is_on = monitor.take.is_on();
        let text = if is_on { RichText::new("Stop").color(theme::ALARM) } else { RichText::new("Record") };
        let button = ui.add_enabled(self.rate_hz.is_some(), Button::new(text).selected(is_on));
        map::note(ui, "button.Record", button.rect);
        let hint =
            "Captures flame and output, aligned, until you press it again: five minutes at most. Then save them.";
        if button.on_hover_text(hint).clicked() {
            self.message = None;
            match self.rate_hz {
                Some(rate_hz) if !is_on => monitor.take.start(f64::from(rate_hz)),
                _ => monitor.take.stop(),
            }
        }
    }

    /// A handle for dragging the recorded output into another program.
    pub fn drag_out(&mut self, ui: &mut Ui, monitor: &Monitor) {
        let Some(drag) = &mut self.drag else { return };
        let is_there = monitor.take.len_samples() > 0 && !monitor.take.is_on();
        let handle = Button::new("Drag out").sense(egui::Sense::drag());
        let button = ui.add_enabled(is_there && !drag.is_busy(), handle);
        map::note(ui, "button.Drag out", button.rect);
        let hint = "Drags the recorded output, as WAV, onto another program's timeline or into a folder. \
                    The file is kept in Pyrophone's folder of takes.";
        let button = button.on_hover_text(hint).on_disabled_hover_text("Record something first");
        if !button.drag_started() {
            return;
        }
        let Some(path) = take_path() else {
            self.message = Some(("There is no folder for takes; use Save instead".to_owned(), true));
            return;
        };
        let (channels, rate_hz) = (monitor.take.output(), self.rate_hz.unwrap_or(44_100.0) as u32);
        let write = move |path: &Path| {
            let folder = path.parent().unwrap_or(Path::new("."));
            std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
            write_wav_f32(path, &channels, rate_hz).map_err(|error| error.to_string())
        };
        let notifier = self.notifier.clone();
        drag.start(path, write, move || notifier.request_repaint());
    }

    /// A menu of the sounds that can be saved.
    pub fn saves(&mut self, ui: &mut Ui, monitor: &Monitor, view: &View) {
        let menu = ui.menu_button("Save…", |ui| {
            for sound in Sound::ALL {
                let is_there = match sound {
                    Sound::Recording => view.recording.is_some(),
                    Sound::Drive | Sound::Output => monitor.take.len_samples() > 0 && !monitor.take.is_on(),
                };
                let is_free = self.dialog.is_none() && self.saving.is_none();
                let entry = ui.add_enabled(is_there && is_free, Button::new(format!("The {}…", sound.name())));
                map::note(ui, format_args!("button.Save {}", sound.name()), entry.rect);
                if entry.clicked() {
                    let ask = Ask::Save(format!("{}.wav", sound.name()));
                    let folder = view.path.as_deref().unwrap_or("");
                    self.dialog = Some((sound, Dialog::open(ask, folder, self.notifier.clone())));
                    ui.close();
                }
            }
        });
        map::note(ui, "button.Save sound", menu.response.rect);
        menu.response.on_hover_text("Save the captured flame or output, or the selected part of the recording, as WAV");
    }
}

/// Buttons that choose the monitored sound.
pub fn monitoring(ui: &mut Ui, monitor: &Monitor, loader: &LoaderHandle, view: &View) {
    let monitored = monitor.listen();
    for (name, listen, hint) in [
        ("flame", Listen::Drive, "Hear only the signal that drives the engines"),
        ("rec.", Listen::Recording, "Hear the selected part of the recording, looped"),
        ("output", Listen::Output, "Hear the output, as usual"),
    ] {
        let is_there = listen != Listen::Recording || view.recording.is_some();
        let is_monitored = monitored == listen;
        let waits = is_monitored && listen == Listen::Recording && !view.has_clip;
        let button = ui.add_enabled(is_there, Button::new(if waits { "…" } else { name }).selected(is_monitored));
        map::note(ui, format_args!("button.Hear {name}"), button.rect);
        if button.on_hover_text(format!("{hint}, until the window closes. Not saved, not automated.")).clicked() {
            monitor.listen_to(listen);
            loader.audition(listen == Listen::Recording);
        }
    }
}

/// A separate file in the folder of recorded takes: the other program may use it in place. The folder is beside the
/// presets', or within a folder that the user has chosen, because what is beside that is not ours.
fn take_path() -> Option<PathBuf> {
    let (library, origin) = Library::located()?;
    let home = if origin == Origin::Chosen { library.folder() } else { library.folder().parent()? };
    let folder = home.join("takes");
    let now_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_secs());
    let name = |number: u32| match number {
        1 => format!("take {now_s}.wav"),
        number => format!("take {now_s}-{number}.wav"),
    };
    (1..).map(|number| folder.join(name(number))).find(|path| !path.exists())
}

fn with_extension(path: PathBuf) -> PathBuf {
    if Path::new(&path).extension().is_some() { path } else { path.with_extension("wav") }
}

/// Height of the panel in points.
pub const HEIGHT: f32 = 72.0;

/// The panel's area at the foot of a column.
pub fn place(column: Rect) -> Rect {
    column.with_min_y(column.bottom() - HEIGHT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_wav_unless_they_are_named_otherwise() {
        assert_eq!(with_extension("/a/output".into()), Path::new("/a/output.wav"));
        assert_eq!(with_extension("/a/output.WAV".into()), Path::new("/a/output.WAV"));
    }
}
