//! MIDI controllers: MIDI learn, the [list of assignments](list), and the file that keeps them for future instances.

pub mod list;

use std::io;

use egui::{Align2, Key, Pos2, Rect, Ui, Vec2};
use pyrophone_settings::controller_file::Assignments;
use pyrophone_settings::{COUNT, ControllerFile, PARAMETERS};

use super::task::Task;
use super::{map, theme};
use crate::controllers::Controllers;

/// Controllers of an instance, by the parameter's index in the table.
type Numbers = [Option<u8>; COUNT];

/// Follows an instance's controllers while its window is open.
#[derive(Default)]
pub struct MidiPanel {
    file: Option<ControllerFile>,
    /// Content of the file when it was last read.
    kept: Assignments,
    /// Controllers as they were in the last frame; none before the first.
    seen: Option<Numbers>,
    /// Writes the file, if there is something to write, and reads it.
    task: Option<Task<Assignments>>,
    /// Time in seconds at which **Remove all** was pressed; for a while the next press removes them.
    asked_s: Option<f64>,
}

impl MidiPanel {
    /// Saves controllers in this file.
    pub fn new(file: Option<ControllerFile>) -> Self {
        Self { file, ..Self::default() }
    }

    /// Resets the panel: assignments made without a window belong to the session alone. Other instances may have
    /// written the file.
    pub fn open(&mut self) {
        (self.seen, self.asked_s) = (None, None);
        self.work(|_| Ok(()));
    }

    /// Saves assignments made since the last frame, shows a pending MIDI learn, and lets Escape cancel it.
    pub fn show(&mut self, ui: &Ui, all: Rect, controllers: &Controllers) {
        if let Some(kept) = self.task.as_mut().and_then(Task::poll) {
            (self.kept, self.task) = (kept, None);
        }
        if self.task.is_some() {
            ui.ctx().request_repaint_after_secs(0.1);
        }
        let now = numbers(controllers);
        let before = self.seen.replace(now).unwrap_or(now);
        let changed: Vec<(&'static str, Option<u8>)> = (0..COUNT)
            .filter(|index| now[*index] != before[*index])
            .map(|index| (PARAMETERS[index].id, now[index]))
            .collect();
        // Loading a session changes many at once; a user changes one.
        if let [(id, number)] = changed[..] {
            self.work(move |file| file.assign(id, number));
        }
        let Some(learner) = controllers.learner() else { return };
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            controllers.stop_learning();
        }
        say(ui, all, &format!("{}: move a MIDI controller (Esc stops)", PARAMETERS[learner].name));
        // The audio thread receives the controller, and requests no frame.
        ui.ctx().request_repaint_after_secs(0.1);
    }

    /// Changes the file, then reads it, on a separate thread.
    fn work(&mut self, change: impl FnOnce(&ControllerFile) -> io::Result<()> + Send + 'static) {
        let Some(file) = self.file.clone() else { return };
        // The one before is waited for: both write the same file.
        self.task = None;
        let work = move || {
            // A write error needs no message: the session has the assignment, and the list shows the file's content.
            let _ = change(&file);
            file.read()
        };
        self.task = Task::start("pyrophone-midi", work, || {});
    }
}

fn numbers(controllers: &Controllers) -> Numbers {
    std::array::from_fn(|index| controllers.number(index))
}

fn say(ui: &Ui, all: Rect, words: &str) {
    let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("midi learn"));
    let painter = ui.ctx().layer_painter(layer);
    let galley = painter.layout_no_wrap(words.to_owned(), theme::small(), theme::TEXT);
    let size = galley.size() + Vec2::new(24.0, 14.0);
    let place = Align2::CENTER_BOTTOM.anchor_size(Pos2::new(all.center().x, all.bottom() - 12.0), size);
    painter.rect(place, 6.0, theme::GROUND, egui::Stroke::new(1.0, theme::EMBER), egui::StrokeKind::Inside);
    painter.galley(place.min + Vec2::new(12.0, 7.0), galley, theme::TEXT);
    map::note(ui, format_args!("learning"), place);
}
