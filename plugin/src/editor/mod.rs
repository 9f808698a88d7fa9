//! The window: flame, sound, and every parameter.
//!
//! | module | content |
//! |---|---|
//! | [`frame`] | the window itself, whose size is saved in the session |
//! | [`header`] | presets, undo, A and B, pages, bypass, processing load |
//! | [`presets`] | the list of presets; saving them |
//! | [`play`] | the first page: flame, output, recording, layers, macros, takes |
//! | [`space`] | vortex sound from above, and the settings for its position |
//! | [`engines`] | pictures of the engines, and their parameters |
//! | [`setup`] | sizes of the engines, the presets' folder, the window's scale, and MIDI controllers |
//! | [`plots`] | spectra with handles, running spectrograms, the recording's outline, pictures of the engines |
//! | [`recording`] | the recording: loading it, its name, progress, messages; learning |
//! | [`controls`] | parameters by page, as [`widgets`] |
//! | [`meter_bridge`] | level meters; solo and mute of layers |
//! | [`listen`] | monitoring one sound alone, a burst, [recording](take) and saving sounds |
//!
//! [`midi`] handles MIDI controllers. [`suggestion`] offers a one-click remedy for a fault, [`inert`] lists parameters
//! without effect and the reasons. [`monitor`] and [`levels`] follow the sound, [`param_editor`] moves parameters and
//! [`history`] records the changes, [`theme`] is the look, [`dialog`] the system's file dialog, [`mod@drop`] accepts
//! dropped files, [`drag`] passes sounds to other programs (by `xdnd` under X11), [`task`] works with files, [`map`]
//! shows tests the items' positions.

pub mod controls;
pub mod dialog;
pub mod drag;
pub mod drop;
pub mod engines;
pub mod frame;
pub mod header;
pub mod history;
pub mod inert;
pub mod levels;
pub mod listen;
pub mod map;
pub mod meter_bridge;
pub mod midi;
pub mod monitor;
pub mod param_editor;
pub mod play;
pub mod plots;
pub mod presets;
pub mod recording;
pub mod setup;
pub mod space;
pub mod suggestion;
pub mod take;
pub mod task;
pub mod theme;
pub mod widgets;
#[cfg(target_os = "linux")]
mod xdnd;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use egui::Rect;
use nice_plug::prelude::ParamSetter;
use nice_plug_core::context::gui::GuiContext;
use nice_plug_egui::resizable_window::ResizableWindow;
use nice_plug_egui::{Frame, NiceEguiApp, RepaintNotifier};
use pyrophone_settings::table::DYNAMIC_RANGES;
use pyrophone_settings::{ControllerFile, Id};

use crate::loader::LoaderHandle;
use crate::loader::status::View;
use crate::meters::Meters;
use crate::parameters::EffectParams;
use crate::probe::ProbeOut;
use crate::window_size::SMALLEST;
use controls::Page;
use header::Header;
use history::UndoHistory;
use inert::{Circumstances, reasons};
use levels::Levels;
use listen::ListenPanel;
use midi::MidiPanel;
use monitor::Monitor;
use param_editor::ParamEditor;
use play::pad::Pad;
use plots::spectrum::Advice;
use pyrophone_analysis::fidelity::Diagnosis;
use pyrophone_analysis::range::{BUZZING_DB, mean_gain_db};
use recording::RecordingPanel;
use setup::user::UserPanel;

/// Space between parts, in points.
const GAP: f32 = 6.0;
/// Height of the head, in points.
const HEAD: f32 = 26.0;

/// The window's contents.
pub struct Window {
    params: Arc<EffectParams>,
    loader: LoaderHandle,
    meters: Arc<Meters>,
    host: Option<GuiContext>,
    recording: RecordingPanel,
    header: Header,
    monitor: Monitor,
    history: UndoHistory,
    levels: Levels,
    listen: ListenPanel,
    pad: Pad,
    midi: MidiPanel,
    user: UserPanel,
    /// True once a frame was drawn since the window opened.
    is_seen: bool,
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
            header: Header::new(notifier.clone()),
            monitor: Monitor::new(probe),
            history: UndoHistory::default(),
            levels: Levels::default(),
            listen: ListenPanel::new(notifier.clone()),
            pad: Pad::default(),
            midi: MidiPanel::default(),
            user: UserPanel::new(notifier.clone()),
            is_seen: false,
        }
    }

    /// The same, with MIDI controllers saved in this file.
    pub fn keeping_controllers(mut self, file: Option<ControllerFile>) -> Self {
        self.midi = MidiPanel::new(file);
        self
    }
}

impl NiceEguiApp for Window {
    fn build(
        &mut self,
        context: egui::Context,
        host: GuiContext,
        frame: &mut Frame,
    ) -> Result<(), baseview::HandlerError> {
        self.open(&context, host);
        self.recording.take_drops(frame.baseview_window());
        self.listen.drag_from(frame.baseview_window());
        Ok(())
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut Frame) {
        self.show(ui);
    }

    fn editor_closed(&mut self) {
        self.host = None;
        self.loader.shared.is_watched.store(false, Ordering::Relaxed);
        self.monitor.watch(false);
        self.levels.clear();
        self.recording.close_dialog();
        self.recording.refuse_drops();
        self.header.presets.close();
        self.recording.clear_pictures();
        self.listen.close(&self.loader);
        self.user.close();
        self.params.controllers.stop_learning();
    }

    fn resized(&mut self, size: baseview::WindowSize) {
        self.params.window.set(size);
    }

    fn zoom_factor_changed(&mut self, zoom_factor: f32) {
        self.params.window.set_zoom(f64::from(zoom_factor));
    }
}

impl Window {
    /// Prepares the contents for a new window.
    pub fn open(&mut self, context: &egui::Context, host: GuiContext) {
        theme::apply(context);
        self.host = Some(host);
        self.loader.shared.is_watched.store(true, Ordering::Relaxed);
        self.is_seen = false;
        self.midi.open();
        self.user.open();
    }

    /// Shows this page.
    pub fn turn_to(&mut self, page: Page) {
        self.header.page = page;
    }

    /// Draws a frame.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let Some(host) = self.host.clone() else { return };
        let setter = host.param_setter();
        let began = map::begin(ui.ctx());
        // From here on the audio thread requests frames. A window that gets a request before it is shown may wait for
        // ever for the display to be ready.
        if !std::mem::replace(&mut self.is_seen, true) {
            self.monitor.watch(true);
        }
        self.monitor.follow(self.meters.engine());
        map::analysed(ui.ctx(), began);
        ResizableWindow::new("window").min_size(egui::vec2(SMALLEST.0, SMALLEST.1)).show(ui, |ui| {
            let all = ui.max_rect();
            ui.painter().rect_filled(all, 0.0, theme::GROUND);
            self.contents(ui, all.shrink(8.0), &setter);
        });
        map::end(ui.ctx(), began);
    }

    fn contents(&mut self, ui: &mut egui::Ui, all: Rect, setter: &ParamSetter) {
        let now_s = ui.input(|input| input.time);
        let load = self.monitor.load(now_s);
        let view = self.loader.status.view();
        let rate_hz = self.meters.engine().map(|(_, rate_hz)| rate_hz);
        self.recording.follow(&self.loader, &view, rate_hz);
        self.listen.follow(&self.monitor, &self.loader, rate_hz);
        self.levels.follow(&self.meters, now_s);

        let (head, rest) = all.split_top_bottom_at_y(all.top() + HEAD);
        let rest = rest.with_min_y(rest.top() + GAP);
        let circumstances = Circumstances {
            has_recording: view.recording.is_some(),
            loaded: std::array::from_fn(|slot| view.slots[slot].is_some()),
        };
        let inert = reasons(&self.params.values(), circumstances);
        let (params, loader, history) = (&self.params, &self.loader, &mut self.history);
        let mut edit = ParamEditor { params, setter, loader, history, inert: &inert };
        part(ui, head, "head", |ui| self.header.show(ui, &mut edit, &self.meters, load));

        let overview = view.overview.as_deref();
        self.monitor.follow_traces(overview.map(|overview| [overview.duration_s, overview.start_s]), now_s);
        let figures = self.monitor.figures(overview.map(|overview| &overview.character));
        let fault = figures.fault().or_else(|| foreseen(&mut self.monitor, &view, &edit, now_s));
        let assessment = Advice { figures, fault, scaling_alpha: self.meters.scaling_alpha() };
        let mut parts = play::Parts {
            monitor: &mut self.monitor,
            levels: &mut self.levels,
            recording: &mut self.recording,
            listen: &mut self.listen,
            pad: &mut self.pad,
            loader: &self.loader,
            meters: &self.meters,
            view: &view,
            assessment,
        };
        match self.header.page {
            Page::Play => play::show(ui, rest, &mut parts, &mut edit),
            Page::Space => space::show(ui, rest, &mut parts, &mut edit),
            Page::Engines => engines::show(ui, rest, &mut parts, &mut edit),
            Page::Setup => setup::show(ui, rest, &mut self.user, &mut self.midi, &mut edit),
        }
        self.monitor.silence(self.levels.silenced());
        self.midi.show(ui, all, &self.params.controllers);
        if self.user.follow() {
            self.header.presets.relocate();
        }
    }
}

/// True if matching is likely to buzz, before it can be heard.
fn foreseen(monitor: &mut Monitor, view: &View, edit: &ParamEditor<'_>, now_s: f64) -> Option<Diagnosis> {
    let range = DYNAMIC_RANGES[edit.get(Id::DynamicRange) as usize];
    if edit.get(Id::ScalingAuto) > 0.5 {
        return None;
    }
    let scaling_alpha = edit.get(Id::ScalingAlpha);
    let [recording, learned] = &view.amplitudes;
    let recording = recording.as_deref()?;
    let gain_db = match (range, learned.as_deref(), monitor.dynamics.drive(now_s)) {
        ("learned", Some(learned), _) => mean_gain_db(learned, recording, scaling_alpha),
        ("running", _, Some(drive)) => mean_gain_db(&drive.0, recording, scaling_alpha),
        _ => return None,
    };
    (gain_db > BUZZING_DB).then_some(Diagnosis::MayBuzz)
}

/// A part of the window within a fixed area.
fn part(ui: &mut egui::Ui, rect: Rect, name: &str, show: impl FnOnce(&mut egui::Ui)) {
    let mut part = ui.new_child(egui::UiBuilder::new().id_salt(name).max_rect(rect));
    part.set_clip_rect(rect.expand(3.0).intersect(ui.clip_rect()));
    show(&mut part);
}
