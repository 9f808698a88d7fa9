//! MIDI controllers: what is being learnt, [what moves what](list), and keeping it for instances to come.

pub mod list;

use std::io;

use egui::{Align2, Key, Pos2, Rect, Ui, Vec2};
use pyrophone_settings::controller_file::Assignments;
use pyrophone_settings::{COUNT, ControllerFile, PARAMETERS};

use super::task::Task;
use super::{map, theme};
use crate::controllers::Controllers;

/// Controllers of an instance, by the parameter's place in the table.
type Numbers = [Option<u8>; COUNT];

/// Follows an instance's controllers while its window is open.
#[derive(Default)]
pub struct MidiPanel {
    file: Option<ControllerFile>,
    /// What the file held when it was last read.
    kept: Assignments,
    /// Controllers as they were in the last frame; none before the first.
    seen: Option<Numbers>,
    /// Writes the file, if there is something to write, and reads it.
    task: Option<Task<Assignments>>,
    /// When **Remove all** was pressed, in seconds; for a while the next press removes them.
    asked_s: Option<f64>,
}

impl MidiPanel {
    /// Keeps controllers in this file.
    pub fn new(file: Option<ControllerFile>) -> Self {
        Self { file, ..Self::default() }
    }

    /// Begins anew: what was assigned without a window is the session's alone. Other instances may have written the file.
    pub fn open(&mut self) {
        (self.seen, self.asked_s) = (None, None);
        self.work(|_| Ok(()));
    }

    /// Keeps what was assigned since the last frame, says what is being learnt, and lets Escape call that off.
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
        // A session that was loaded changes many at once; hands change one.
        if let [(id, number)] = changed[..] {
            self.work(move |file| file.assign(id, number));
        }
        let Some(learner) = controllers.learner() else { return };
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            controllers.stop_learning();
        }
        say(ui, all, &format!("{}: move a MIDI controller (Esc stops)", PARAMETERS[learner].name));
        // The controller is heard by the audio thread, which asks for no frame.
        ui.ctx().request_repaint_after_secs(0.1);
    }

    /// Changes the file, then reads it, on a thread of its own.
    fn work(&mut self, change: impl FnOnce(&ControllerFile) -> io::Result<()> + Send + 'static) {
        let Some(file) = self.file.clone() else { return };
        // The one before is waited for: both write the same file.
        self.task = None;
        let work = move || {
            // That it cannot be written is no fault worth a word: the session has it, and the list shows what the file has.
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
