//! MIDI controllers: what is being learnt, and keeping what was learnt for instances to come.

use egui::{Align2, Key, Pos2, Rect, Ui, Vec2};
use pyrophone_settings::{COUNT, ControllerFile, PARAMETERS};

use super::task::Task;
use super::{map, theme};
use crate::controllers::Controllers;

/// Follows an instance's controllers while its window is open.
#[derive(Default)]
pub struct MidiPanel {
    file: Option<ControllerFile>,
    /// Controllers as they were in the last frame, by place in the table; none before the first.
    seen: Option<[Option<u8>; COUNT]>,
    /// Writes the file.
    task: Option<Task<()>>,
}

impl MidiPanel {
    /// Keeps controllers in this file.
    pub fn new(file: Option<ControllerFile>) -> Self {
        Self { file, ..Self::default() }
    }

    /// Begins anew: what was assigned without a window is the session's alone.
    pub fn open(&mut self) {
        self.seen = None;
    }

    /// Keeps what was assigned since the last frame, says what is being learnt, and lets Escape call that off.
    pub fn show(&mut self, ui: &Ui, all: Rect, controllers: &Controllers) {
        let now: [Option<u8>; COUNT] = std::array::from_fn(|index| controllers.number(index));
        let before = self.seen.replace(now).unwrap_or(now);
        let changed: Vec<(&'static str, Option<u8>)> = (0..COUNT)
            .filter(|index| now[*index] != before[*index])
            .map(|index| (PARAMETERS[index].id, now[index]))
            .collect();
        // A session that was loaded changes many at once; hands change one.
        if let [(id, number)] = changed[..] {
            self.keep(id, number);
        }
        let Some(learner) = controllers.learner() else { return };
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            controllers.stop_learning();
        }
        say(ui, all, &format!("{}: move a MIDI controller (Esc stops)", PARAMETERS[learner].name));
        // The controller is heard by the audio thread, which asks for no frame.
        ui.ctx().request_repaint_after_secs(0.1);
    }

    fn keep(&mut self, id: &'static str, number: Option<u8>) {
        let Some(file) = self.file.clone() else { return };
        // The one before is waited for: both write the same file. That it cannot be written is no fault worth a word; the
        // session has it.
        self.task = None;
        self.task = Task::start("pyrophone-midi", move || drop(file.assign(id, number)), || {});
    }
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
