//! The window: what goes in, what the recording is, what comes out; and every parameter.
//!
//! | module | shows |
//! |---|---|
//! | [`frame`] | the window itself, whose size a session keeps |
//! | [`header`] | presets, undo, A and B, bypass, cost |
//! | [`presets`] | the list of presets; saving them |
//! | [`plots`] | spectra with handles, running spectrograms, the recording's outline, what the engines do |
//! | [`recording`] | the recording: loading it, its name, progress, messages; learning |
//! | [`controls`] | parameters, as [`widgets`] |
//! | [`levels`] | level meters; solo and mute of layers |
//! | [`listen`] | listening to one sound alone, a burst, [takes](take) and saving them |
//!
//! [`cure`] is what one click does against a fault. [`monitor`] follows the sound, [`hand`] moves parameters, [`theme`] is how it looks, [`dialog`] the system's file dialog,
//! [`mod@drop`] takes files that are dropped, [`task`] work with files, [`map`] tells tests where things are.

pub mod controls;
pub mod cure;
pub mod dialog;
pub mod drop;
pub mod frame;
pub mod hand;
pub mod header;
pub mod levels;
pub mod listen;
pub mod map;
pub mod monitor;
pub mod plots;
pub mod presets;
pub mod recording;
pub mod take;
pub mod task;
pub mod theme;
pub mod widgets;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use egui::Rect;
use nice_plug::prelude::ParamSetter;
use nice_plug_core::context::gui::GuiContext;
use nice_plug_egui::resizable_window::ResizableWindow;
use nice_plug_egui::{Frame, NiceEguiApp, RepaintNotifier};
use pyrophone_settings::Id;
use pyrophone_settings::table::DYNAMIC_RANGES;

use crate::analysis::fidelity::Fault;
use crate::analysis::range::{BUZZING_DB, mean_gain_db};
use crate::loader::LoaderHandle;
use crate::loader::status::View;
use crate::meters::Meters;
use crate::parameters::EffectParams;
use crate::probe::ProbeOut;
use controls::Page;
use hand::{Hand, History};
use header::Header;
use levels::Levels;
use listen::ListenPanel;
use monitor::Monitor;
use plots::spectrum::Told;
use recording::RecordingPanel;

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
    listen: ListenPanel,
    /// Whether a frame was drawn since it was opened.
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
            history: History::default(),
            levels: Levels::default(),
            listen: ListenPanel::new(notifier),
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
        self.open(&context, host);
        self.recording.take_drops(frame.baseview_window());
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
    }

    fn resized(&mut self, size: baseview::WindowSize) {
        self.params.window.set(size);
    }
}

impl Window {
    /// Shows what follows on a new window.
    pub fn open(&mut self, context: &egui::Context, host: GuiContext) {
        theme::apply(context);
        self.host = Some(host);
        self.loader.shared.is_watched.store(true, Ordering::Relaxed);
        self.is_seen = false;
    }

    /// Shows this page of parameters.
    pub fn turn_to(&mut self, page: Page) {
        self.header.page = page;
    }

    /// Draws a frame.
    pub fn show(&mut self, ui: &mut egui::Ui) {
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
}

/// Between parts, in points.
const GAP: f32 = 6.0;
/// Heights of the head, and of the recording's words without and with a message, in points.
const HEAD: f32 = 26.0;
const WORDS: f32 = 80.0;
const MESSAGE: f32 = 30.0;
/// Width of the meters, in points.
const METERS: f32 = 180.0;
/// Height that the parameters like to have, in points.
const CONTROLS: f32 = 388.0;
/// Height of the pictures of what the engines do; below this height of all pictures there is no room for them.
const ENGINES: f32 = 84.0;
const ROOM_FOR_ENGINES: f32 = 270.0;

impl Window {
    fn contents(&mut self, ui: &mut egui::Ui, all: Rect, setter: &ParamSetter) {
        let now_s = ui.input(|input| input.time);
        let load = self.monitor.load(now_s);
        let view = self.loader.status.view();
        let (head, rest) = all.split_top_bottom_at_y(all.top() + HEAD);
        let rest = rest.with_min_y(rest.top() + GAP);
        // Pictures take what the parameters leave, and at least two fifths.
        let split = rest.top() + (rest.height() - CONTROLS).clamp(0.4 * rest.height(), 0.62 * rest.height());
        let (upper, lower) = rest.split_top_bottom_at_y(split);
        let middle = upper.left() + 0.54 * (upper.width() - METERS);
        let left = upper.with_max_x(middle);
        let right = upper.with_min_x(middle + GAP).with_max_x(upper.right() - METERS - GAP);
        let meters = upper.with_min_x(upper.right() - METERS);

        let mut hand = Hand { params: &self.params, setter, history: &mut self.history };
        part(ui, head, "head", |ui| self.header.show(ui, &mut hand, &self.meters, load));
        let portrait = view.portrait.as_deref();
        self.monitor.follow_traces(portrait.map(|portrait| [portrait.duration_s, portrait.start_s]), now_s);
        let shows_engines = left.height() >= ROOM_FOR_ENGINES;
        let spectra = if shows_engines { left.with_max_y(left.bottom() - ENGINES - GAP) } else { left };
        let figures = self.monitor.figures(portrait.map(|portrait| &portrait.character));
        let fault = figures.fault().or_else(|| foreseen(&mut self.monitor, &view, &hand, now_s));
        let told = Told { figures, fault, scaling_alpha: self.meters.scaling_alpha() };
        self.monitor.spectra.show(ui, spectra, portrait, &told, &mut hand);
        if shows_engines {
            self.engines(ui, left.with_min_y(left.bottom() - ENGINES), &view);
        }
        self.sounds(ui, right, &view);

        let mut hand = Hand { params: &self.params, setter, history: &mut self.history };
        self.levels.show(ui, meters.with_max_y(meters.bottom() - listen::HEIGHT - GAP), &self.meters);
        self.monitor.silence(self.levels.silenced());
        let rate_hz = self.meters.engine().map(|(_, rate_hz)| rate_hz);
        part(ui, listen::place(meters), "listen", |ui| {
            self.listen.show(ui, &mut self.monitor, &self.loader, &view, rate_hz, &hand);
        });
        let controls = lower.with_min_y(lower.top() + GAP);
        let page = self.header.page;
        part(ui, controls, "controls", |ui| controls::show(ui, page, &mut hand));
    }

    /// What the engines do: extension's factors, texture's levels, and how loudness is matched.
    fn engines(&mut self, ui: &egui::Ui, rect: Rect, view: &View) {
        let width = (rect.width() - 2.0 * GAP) / 3.0;
        let place = |index: f32| {
            let left = rect.left() + index * (width + GAP);
            rect.with_min_x(left).with_max_x(left + width)
        };
        let uses_learned = DYNAMIC_RANGES[self.params.value(Id::DynamicRange as usize) as usize] == "learned";
        let [recording, learned] = &view.amplitudes;
        let learned = learned.as_deref().filter(|_| uses_learned);
        self.monitor.betas.show(ui, place(0.0));
        self.monitor.levels.show(ui, place(1.0));
        self.monitor.dynamics.show(ui, place(2.0), recording.as_deref(), learned);
    }

    /// Drive, output and recording in the course of time, and the recording's words.
    fn sounds(&mut self, ui: &mut egui::Ui, rect: Rect, view: &View) {
        let has_message = view.error.is_some() || view.notice.is_some() || self.meters.input_cancels();
        let height = WORDS + if has_message { MESSAGE } else { 0.0 };
        let words = rect.with_min_y(rect.bottom() - height);
        let course = (rect.height() - height - 4.0 * GAP) / 4.0;
        let row = |index: f32| {
            let top = rect.top() + index * (course + GAP);
            rect.with_min_y(top).with_max_y(top + course)
        };
        self.monitor.drive.show(ui, row(0.0), theme::BLUE);
        self.monitor.output.show(ui, row(1.0), theme::EMBER);
        self.recording.show_pictures(ui, [row(2.0), row(3.0)], &self.loader, view);
        self.monitor.heat.show(ui, row(2.0));
        part(ui, words, "recording", |ui| {
            self.recording.show(ui, &self.loader, &self.params, view);
            if self.meters.input_cancels() && view.error.is_none() {
                let warning = "The input's channels cancel each other: turn one's phase, or use mono.";
                ui.label(egui::RichText::new(warning).font(theme::small()).color(theme::ALARM));
            }
        });
    }
}

/// Whether matching is likely to buzz, before it is heard to.
fn foreseen(monitor: &mut Monitor, view: &View, hand: &Hand<'_>, now_s: f64) -> Option<Fault> {
    let range = DYNAMIC_RANGES[hand.get(Id::DynamicRange) as usize];
    if hand.get(Id::ScalingAuto) > 0.5 {
        return None;
    }
    let scaling_alpha = hand.get(Id::ScalingAlpha);
    let [recording, learned] = &view.amplitudes;
    let recording = recording.as_deref()?;
    let gain_db = match (range, learned.as_deref(), monitor.dynamics.drive(now_s)) {
        ("learned", Some(learned), _) => mean_gain_db(learned, recording, scaling_alpha),
        ("running", _, Some(drive)) => mean_gain_db(&drive.0, recording, scaling_alpha),
        _ => return None,
    };
    (gain_db > BUZZING_DB).then_some(Fault::MayBuzz)
}

/// A part of the window with a place of its own.
fn part(ui: &mut egui::Ui, rect: Rect, name: &str, show: impl FnOnce(&mut egui::Ui)) {
    let mut part = ui.new_child(egui::UiBuilder::new().id_salt(name).max_rect(rect));
    part.set_clip_rect(rect.expand(3.0).intersect(ui.clip_rect()));
    show(&mut part);
}
