//! The window: what goes in, what the recording is, what comes out; and every parameter.
//!
//! | module | shows |
//! |---|---|
//! | [`header`] | presets, undo, A and B, bypass, cost |
//! | [`presets`] | the list of presets; saving them |
//! | [`plots`] | spectra with handles, running spectrograms, the recording's outline |
//! | [`recording`] | the recording: loading it, its name, progress, messages; learning |
//! | [`controls`] | parameters, as [`widgets`] |
//! | [`levels`] | level meters; solo and mute of layers |
//!
//! [`cure`] is what one click does against a fault. [`monitor`] follows the sound, [`hand`] moves parameters, [`theme`] is how it looks, [`dialog`] the system's file dialog, [`drop`] takes
//! files that are dropped,
//! [`map`] tells tests where things are.

pub mod controls;
pub mod cure;
pub mod dialog;
pub mod drop;
pub mod hand;
pub mod header;
pub mod levels;
pub mod map;
pub mod monitor;
pub mod plots;
pub mod presets;
pub mod recording;
pub mod theme;
pub mod widgets;

use std::sync::Arc;

use egui::Rect;
use nice_plug::prelude::ParamSetter;
use nice_plug_core::context::gui::GuiContext;
use nice_plug_core::editor::dpi::LogicalSize;
use nice_plug_core::editor::{ResizeHint, SizeConstraints};
use nice_plug_egui::resizable_window::ResizableWindow;
use nice_plug_egui::{
    EguiEditor, EguiEditorState, EguiNiceSettings, Frame, NiceEguiApp, RepaintNotifier, create_egui_editor,
};

use crate::loader::LoaderHandle;
use crate::meters::Meters;
use crate::parameters::EffectParams;
use crate::probe::ProbeOut;
use hand::{Hand, History};
use header::Header;
use levels::Levels;
use monitor::Monitor;
use recording::RecordingPanel;

/// Size of a new window in points.
const SIZE: (f32, f32) = (1060.0, 760.0);
/// The smallest size in points at which everything can be reached.
const SMALLEST: (f32, f32) = (700.0, 450.0);

/// The window's contents.
pub struct Window {
    params: Arc<EffectParams>,
    loader: LoaderHandle,
    meters: Arc<Meters>,
    host: Option<GuiContext>,
    recording: RecordingPanel,
    header: Header,
    monitor: Monitor,
    history: History,
    levels: Levels,
    /// Whether a frame was drawn since it was opened.
    is_seen: bool,
}

/// The size of a window that was never opened.
pub fn initial_state() -> Arc<EguiEditorState> {
    EguiEditorState::from_size(LogicalSize::new(SIZE.0, SIZE.1), 1.0)
}

/// The editor that hosts open.
pub fn create(state: Arc<EguiEditorState>, notifier: RepaintNotifier, window: Window) -> Option<EguiEditor<Window>> {
    let hint = ResizeHint {
        can_resize: true,
        can_resize_horizontally: true,
        can_resize_vertically: true,
        size_constraints: SizeConstraints::min_logical_size(LogicalSize::new(SMALLEST.0, SMALLEST.1)),
        ..ResizeHint::NON_RESIZABLE
    };
    let settings = EguiNiceSettings::new().with_tile("Pyrophone").with_resize_hint(hint);
    create_egui_editor(state, notifier, settings, window)
}

impl Window {
    /// Contents for one instance.
    pub fn new(
        params: Arc<EffectParams>,
        loader: LoaderHandle,
        meters: Arc<Meters>,
        probe: ProbeOut,
        notifier: RepaintNotifier,
    ) -> Self {
        Self {
            params,
            loader,
            meters,
            host: None,
            recording: RecordingPanel::new(notifier.clone()),
            header: Header::new(notifier),
            monitor: Monitor::new(probe),
            history: History::default(),
            levels: Levels::default(),
            is_seen: false,
        }
    }
}

impl NiceEguiApp for Window {
    fn build(
        &mut self,
        context: egui::Context,
        host: GuiContext,
        frame: &mut Frame,
    ) -> Result<(), baseview::HandlerError> {
        theme::apply(&context);
        self.recording.take_drops(frame.baseview_window());
        self.host = Some(host);
        self.is_seen = false;
        Ok(())
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut Frame) {
        let Some(host) = self.host.clone() else { return };
        let setter = host.param_setter();
        let began = map::begin(ui.ctx());
        // From here on the audio thread asks for frames. A window that is asked before it is shown may wait for ever for the
        // display to be ready.
        if !std::mem::replace(&mut self.is_seen, true) {
            self.monitor.watch(true);
        }
        self.monitor.follow(self.meters.engine());
        ResizableWindow::new("window").min_size(egui::vec2(SMALLEST.0, SMALLEST.1)).show(ui, |ui| {
            let all = ui.max_rect();
            ui.painter().rect_filled(all, 0.0, theme::GROUND);
            self.contents(ui, all.shrink(8.0), &setter);
        });
        map::end(ui.ctx(), began);
    }

    fn editor_closed(&mut self) {
        self.host = None;
        self.monitor.watch(false);
        self.levels.clear();
        self.recording.close_dialog();
        self.recording.refuse_drops();
        self.header.presets.close();
        self.recording.clear_pictures();
    }
}

/// Between parts, in points.
const GAP: f32 = 6.0;
/// Heights of the head and of the recording's words, in points.
const HEAD: f32 = 26.0;
const WORDS: f32 = 54.0;
/// Width of the meters, in points.
const METERS: f32 = 172.0;

impl Window {
    fn contents(&mut self, ui: &mut egui::Ui, all: Rect, setter: &ParamSetter) {
        let now_s = ui.input(|input| input.time);
        let load = self.monitor.load(now_s);
        let view = self.loader.status.view();
        let mut hand = Hand { params: &self.params, setter, history: &mut self.history };
        let (head, rest) = all.split_top_bottom_at_y(all.top() + HEAD);
        let rest = rest.with_min_y(rest.top() + GAP);
        // Pictures take what the parameters leave, and at least two fifths.
        let split = rest.top() + (rest.height() - CONTROLS).clamp(0.4 * rest.height(), 0.62 * rest.height());
        let (upper, lower) = rest.split_top_bottom_at_y(split);
        let middle = upper.left() + 0.56 * (upper.width() - METERS);
        let spectra = upper.with_max_x(middle);
        let right = upper.with_min_x(middle + GAP).with_max_x(upper.right() - METERS - GAP);
        let meters = upper.with_min_x(upper.right() - METERS);
        let words = right.with_min_y(right.bottom() - WORDS);
        let course = (right.height() - WORDS - 4.0 * GAP) / 4.0;
        let row = |index: f32| {
            let top = right.top() + index * (course + GAP);
            right.with_min_y(top).with_max_y(top + course)
        };

        part(ui, head, "head", |ui| self.header.show(ui, &mut hand, &self.meters, load));
        let figures = self.monitor.figures(view.portrait.as_deref().map(|portrait| &portrait.character));
        self.monitor.spectra.show(ui, spectra, view.portrait.as_deref(), &figures, &mut hand);
        self.monitor.drive.show(ui, row(0.0), theme::BLUE);
        self.monitor.output.show(ui, row(1.0), theme::EMBER);
        self.monitor.follow_matches(view.portrait.as_deref().map(|portrait| portrait.duration_s), now_s);
        self.recording.show_pictures(ui, [row(2.0), row(3.0)], &view);
        self.monitor.heat.show(ui, row(2.0));
        part(ui, words, "recording", |ui| self.recording.show(ui, &self.loader, &self.params));
        self.levels.show(ui, meters, &self.meters);
        self.monitor.silence(self.levels.silenced());
        if self.meters.input_cancels() {
            let at = meters.left_bottom() - egui::vec2(0.0, 68.0);
            let warning = "The input's channels cancel each other: turn one's phase, or use mono.";
            let galley = ui.painter().layout(warning.into(), theme::small(), theme::ALARM, meters.width());
            ui.painter().galley(at, galley, theme::ALARM);
        }
        let controls = lower.with_min_y(lower.top() + GAP);
        let shows_structure = self.header.shows_structure;
        part(ui, controls, "controls", |ui| controls::show(ui, shows_structure, &mut hand));
    }
}

/// Height that the parameters like to have, in points.
const CONTROLS: f32 = 388.0;

/// A part of the window with a place of its own.
fn part(ui: &mut egui::Ui, rect: Rect, name: &str, show: impl FnOnce(&mut egui::Ui)) {
    let mut part = ui.new_child(egui::UiBuilder::new().id_salt(name).max_rect(rect));
    part.set_clip_rect(rect.expand(3.0).intersect(ui.clip_rect()));
    show(&mut part);
}
