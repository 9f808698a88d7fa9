//! The window: plain, every parameter, the recording, levels.
//!
//! | module | shows |
//! |---|---|
//! | [`recording`] | the recording: loading it, its name, progress, messages; learning |
//! | [`presets`] | factory presets, reset to the paper's values |
//! | [`controls`] | parameters |
//! | [`levels`] | level meters and latency |
//! | [`dialog`] | the system's file dialog |

pub mod controls;
pub mod dialog;
pub mod levels;
pub mod presets;
pub mod recording;

use std::sync::Arc;

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
use levels::Levels;
use presets::Presets;
use recording::RecordingPanel;

/// Size of a new window in points.
const SIZE: (f32, f32) = (900.0, 720.0);
/// The smallest size in points at which everything can be reached.
const SMALLEST: (f32, f32) = (560.0, 400.0);

/// The window's contents.
pub struct Window {
    params: Arc<EffectParams>,
    loader: LoaderHandle,
    meters: Arc<Meters>,
    host: Option<GuiContext>,
    recording: RecordingPanel,
    presets: Presets,
    levels: Levels,
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
        notifier: RepaintNotifier,
    ) -> Self {
        Self {
            params,
            loader,
            meters,
            host: None,
            recording: RecordingPanel::new(notifier),
            presets: Presets::default(),
            levels: Levels::default(),
        }
    }
}

impl NiceEguiApp for Window {
    fn build(
        &mut self,
        _context: egui::Context,
        host: GuiContext,
        _frame: &mut Frame,
    ) -> Result<(), baseview::HandlerError> {
        self.host = Some(host);
        Ok(())
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut Frame) {
        let Some(host) = self.host.clone() else { return };
        let setter = host.param_setter();
        ResizableWindow::new("window").min_size(egui::vec2(SMALLEST.0, SMALLEST.1)).show(ui, |ui| {
            egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.heading("Pyrophone");
                    ui.separator();
                    self.presets.show(ui, &self.params, &setter);
                });
                ui.separator();
                self.recording.show(ui, &self.loader, &self.params);
                ui.separator();
                self.levels.show(ui, &self.meters);
                ui.separator();
                egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    controls::show(ui, &self.params, &setter);
                });
            });
        });
    }

    fn editor_closed(&mut self) {
        self.host = None;
        self.recording.close_dialog();
    }
}
