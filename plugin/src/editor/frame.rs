//! The editor as seen by hosts: a window whose size is saved in the session.

use std::error::Error;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use nice_plug_core::context::gui::GuiContext;
use nice_plug_core::editor::dpi::{LogicalSize, NativeSize};
use nice_plug_core::editor::{
    Editor, EditorHandle as _, HostMethods, ParentWindowHandle, ResizeHint, SizeConstraints, SpawnedEditor,
};
use nice_plug_core::plugin::TrackInfo;
use nice_plug_egui::{
    EguiEditor, EguiEditorHandle, EguiEditorState, EguiNiceSettings, Frame, NiceEguiApp, RepaintNotifier,
    create_egui_editor,
};

use pyrophone_settings::ScaleFile;

use super::Window;
use crate::window_size::{SMALLEST, WindowSize};

/// Access to the contents from the window: windows come and go, the contents stay.
pub struct Pane(Arc<Mutex<Window>>);

impl Pane {
    fn contents(&self) -> MutexGuard<'_, Window> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl NiceEguiApp for Pane {
    fn build(
        &mut self,
        context: egui::Context,
        host: GuiContext,
        frame: &mut Frame,
    ) -> Result<(), baseview::HandlerError> {
        self.contents().build(context, host, frame)
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut Frame) {
        self.contents().ui(ui, frame);
    }

    fn resized(&mut self, size: baseview::WindowSize) {
        self.contents().resized(size);
    }

    fn zoom_factor_changed(&mut self, zoom_factor: f32) {
        self.contents().zoom_factor_changed(zoom_factor);
    }

    fn editor_closed(&mut self) {
        self.contents().editor_closed();
    }
}

/// The editor. The framework's own editor hides its size, so it is recreated when a session has brought another one.
pub struct PyrophoneEditor {
    contents: Arc<Mutex<Window>>,
    size: Arc<WindowSize>,
    notifier: RepaintNotifier,
    inner: Mutex<Inner>,
}

struct Inner {
    editor: EguiEditor<Pane>,
    state: Arc<EguiEditorState>,
    zoom: f64,
}

impl PyrophoneEditor {
    /// An editor of these contents; `size` is saved in the session, and `notifier` requests frames.
    pub fn new(contents: Window, size: Arc<WindowSize>, notifier: RepaintNotifier) -> Option<Self> {
        let contents = Arc::new(Mutex::new(contents));
        size.set_zoom(stored_zoom());
        let inner = Mutex::new(Inner::new(&contents, &size, &notifier)?);
        Some(Self { contents, size, notifier, inner })
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        if inner.state.is_open() {
            return inner;
        }
        // Another instance may have changed the scale.
        self.size.set_zoom(stored_zoom());
        if (self.size.take_new() || inner.zoom != self.size.zoom())
            && let Some(other) = Inner::new(&self.contents, &self.size, &self.notifier)
        {
            *inner = other;
        }
        inner
    }
}

/// Environment variable with the maximum number of frames a second drawn while sound plays: with software rendering,
/// each needs a core for tens of milliseconds.
const FRAMES_VARIABLE: &str = "PYROPHONE_FRAMES_PER_SECOND";
/// Frames a second without that variable, and the bounds of its value. The audio thread asks for 30; checking twice as
/// often keeps them evenly spaced.
const FRAMES_PER_SECOND: f64 = 64.0;
const FRAMES_RANGE: (f64, f64) = (1.0, 240.0);

/// Time between two checks for something new to draw; an invalid number of frames is ignored.
fn repaint_interval(frames_per_second: Option<&str>) -> Duration {
    let asked = frames_per_second.and_then(|text| text.trim().parse::<f64>().ok()).filter(|frames| frames.is_finite());
    let frames = asked.map_or(FRAMES_PER_SECOND, |frames| frames.clamp(FRAMES_RANGE.0, FRAMES_RANGE.1));
    Duration::from_secs_f64(1.0 / frames)
}

/// The scale that the user has chosen.
fn stored_zoom() -> f64 {
    ScaleFile::of_user().map_or(1.0, |file| f64::from(file.read()) / 100.0)
}

impl Inner {
    fn new(contents: &Arc<Mutex<Window>>, size: &WindowSize, notifier: &RepaintNotifier) -> Option<Self> {
        let [width, height] = size.get();
        let zoom = size.zoom();
        let state = EguiEditorState::from_size(LogicalSize::new(width, height), zoom as f32);
        let smallest = LogicalSize::new(SMALLEST.0 * zoom as f32, SMALLEST.1 * zoom as f32);
        let hint = ResizeHint {
            can_resize: true,
            can_resize_horizontally: true,
            can_resize_vertically: true,
            size_constraints: SizeConstraints::min_logical_size(smallest),
            ..ResizeHint::NON_RESIZABLE
        };
        let settings = EguiNiceSettings::new()
            .with_tile("Pyrophone")
            .with_resize_hint(hint)
            .with_repaint_poll_interval(repaint_interval(std::env::var(FRAMES_VARIABLE).ok().as_deref()));
        let editor = create_egui_editor(state.clone(), notifier.clone(), settings, Pane(contents.clone()))?;
        Some(Self { editor, state, zoom })
    }
}

impl Editor for PyrophoneEditor {
    type Handle = EguiEditorHandle;

    fn spawn(
        &self,
        parent: Option<ParentWindowHandle>,
        wait_for_parent: bool,
        fallback_scale_factor: Option<f64>,
        context: GuiContext,
        host: Option<HostMethods>,
    ) -> Result<SpawnedEditor<Self::Handle>, Box<dyn Error>> {
        let inner = self.inner();
        let wanted = self.size.get();
        let spawned = inner.editor.spawn(parent, wait_for_parent, fallback_scale_factor, context, host)?;
        let found = spawned.window.size();
        // With baseview 0.4.2 the size of a new X11 window ignores the scale that the host has set.
        let [width, height] = wanted;
        let scale = found.scale_factor * self.size.zoom();
        let native = NativeSize::from_size(LogicalSize::new(width, height).into(), scale);
        let is_found = native == NativeSize::from_logical_or_physical(found.logical, found.physical);
        if !is_found {
            spawned.handle.set_size(native, &spawned.window)?;
        }
        self.size.set_points(wanted);
        self.size.set_scale(found.scale_factor);
        Ok(spawned)
    }

    fn size(&self) -> NativeSize<u32> {
        // A session may have brought another size.
        drop(self.inner());
        self.size.native()
    }

    fn resize_hint(&self) -> ResizeHint {
        self.inner().editor.resize_hint()
    }

    fn track_info_updated(&self, info: TrackInfo) {
        self.inner().editor.track_info_updated(info);
    }

    unsafe fn assume_standalone_in_process(&self) {
        // SAFETY: the caller guarantees the requirements of the inner editor.
        unsafe { self.inner().editor.assume_standalone_in_process() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_per_second_are_limited_as_asked() {
        let frames = |text| 1.0 / repaint_interval(text).as_secs_f64();
        let cases = [(Some("20"), 20.0), (Some("0"), 1.0), (Some("1e9"), 240.0)];
        let no_numbers = [None, Some(""), Some("many"), Some("NaN"), Some("inf")];
        for (text, expected) in cases.into_iter().chain(no_numbers.map(|text| (text, FRAMES_PER_SECOND))) {
            assert!((frames(text) / expected - 1.0).abs() < 1e-4, "{text:?}: {}", frames(text));
        }
    }
}
