//! The editor as hosts have it: a window whose size a session keeps.

use std::error::Error;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

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

use super::{SMALLEST, Window};

/// Size of a new window in points.
const SIZE: [f32; 2] = [1100.0, 790.0];
/// The largest size that is believed, in points.
const LARGEST: f32 = 8192.0;

/// The window's size in points, which the window, the session and the host's threads share.
#[derive(Debug)]
pub struct WindowSize {
    /// Width and height, 32 bits each.
    bits: AtomicU64,
    /// Pixels of a point on the last window's screen; 0 before there was one.
    scale_bits: AtomicU64,
    /// Whether a session has brought it and no window had it yet.
    is_new: AtomicBool,
}

impl Default for WindowSize {
    fn default() -> Self {
        Self { bits: AtomicU64::new(pack(SIZE)), scale_bits: AtomicU64::new(0), is_new: AtomicBool::new(false) }
    }
}

fn pack([width, height]: [f32; 2]) -> u64 {
    u64::from(width.to_bits()) << 32 | u64::from(height.to_bits())
}

impl WindowSize {
    /// Width and height.
    pub fn get(&self) -> [f32; 2] {
        let bits = self.bits.load(Ordering::Relaxed);
        [f32::from_bits((bits >> 32) as u32), f32::from_bits(bits as u32)]
    }

    /// As a session keeps it.
    pub fn to_json(&self) -> String {
        let [width, height] = self.get();
        format!("[{width},{height}]")
    }

    /// As a session has kept it; what is no size is of no account.
    pub fn read_json(&self, text: &str) {
        let Ok(size) = serde_json::from_str::<[f32; 2]>(text) else { return };
        if size.iter().all(|side| side.is_finite()) {
            let [width, height] = size;
            let size = [width.clamp(SMALLEST.0, LARGEST), height.clamp(SMALLEST.1, LARGEST)];
            self.bits.store(pack(size), Ordering::Relaxed);
            self.is_new.store(true, Ordering::Release);
        }
    }

    /// As the window has it now.
    pub fn set(&self, size: baseview::WindowSize) {
        self.set_points([size.logical.width as f32, size.logical.height as f32]);
        self.set_scale(size.scale_factor);
    }

    fn set_points(&self, size: [f32; 2]) {
        self.bits.store(pack(size), Ordering::Relaxed);
    }

    fn set_scale(&self, scale: f64) {
        self.scale_bits.store(scale.to_bits(), Ordering::Relaxed);
    }

    /// As hosts count it. They ask before there is a window, too.
    fn native(&self) -> NativeSize<u32> {
        let [width, height] = self.get();
        let scale = match f64::from_bits(self.scale_bits.load(Ordering::Relaxed)) {
            scale if scale > 0.0 => scale,
            _ => desktop_scale(),
        };
        NativeSize::from_size(LogicalSize::new(width, height).into(), scale)
    }
}

/// Pixels of a point on the user's desktop, as a window that opens there will find it.
#[cfg(target_os = "linux")]
fn desktop_scale() -> f64 {
    let resources = x11rb::connect(None)
        .ok()
        .and_then(|(connection, _)| x11rb::resource_manager::new_from_default(&connection).ok());
    let dots_per_inch = resources.and_then(|resources| resources.get_value::<u32>("Xft.dpi", "").ok().flatten());
    dots_per_inch.map_or(1.0, |dots_per_inch| f64::from(dots_per_inch) / 96.0)
}

/// Elsewhere the host tells, or counts in points.
#[cfg(not(target_os = "linux"))]
fn desktop_scale() -> f64 {
    1.0
}

/// What is drawn in: windows come and go, the contents stay.
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

    fn editor_closed(&mut self) {
        self.contents().editor_closed();
    }
}

/// The editor. The framework's own keeps its size to itself, so it is made anew when a session has brought another one.
pub struct PyrophoneEditor {
    contents: Arc<Mutex<Window>>,
    size: Arc<WindowSize>,
    notifier: RepaintNotifier,
    inner: Mutex<Inner>,
}

struct Inner {
    editor: EguiEditor<Pane>,
    state: Arc<EguiEditorState>,
}

impl PyrophoneEditor {
    /// An editor of these contents; `size` is what a session keeps, and `notifier` asks for frames.
    pub fn new(contents: Window, size: Arc<WindowSize>, notifier: RepaintNotifier) -> Option<Self> {
        let contents = Arc::new(Mutex::new(contents));
        let inner = Mutex::new(Inner::new(&contents, &size, &notifier)?);
        Some(Self { contents, size, notifier, inner })
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        if !inner.state.is_open()
            && self.size.is_new.swap(false, Ordering::Acquire)
            && let Some(other) = Inner::new(&self.contents, &self.size, &self.notifier)
        {
            *inner = other;
        }
        inner
    }
}

impl Inner {
    fn new(contents: &Arc<Mutex<Window>>, size: &WindowSize, notifier: &RepaintNotifier) -> Option<Self> {
        let [width, height] = size.get();
        let state = EguiEditorState::from_size(LogicalSize::new(width, height), 1.0);
        let hint = ResizeHint {
            can_resize: true,
            can_resize_horizontally: true,
            can_resize_vertically: true,
            size_constraints: SizeConstraints::min_logical_size(LogicalSize::new(SMALLEST.0, SMALLEST.1)),
            ..ResizeHint::NON_RESIZABLE
        };
        let settings = EguiNiceSettings::new().with_tile("Pyrophone").with_resize_hint(hint);
        let editor = create_egui_editor(state.clone(), notifier.clone(), settings, Pane(contents.clone()))?;
        Some(Self { editor, state })
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
        // With baseview 0.4.2 the size of a new X11 window leaves out the scale that the host has told of.
        let [width, height] = wanted;
        let native = NativeSize::from_size(LogicalSize::new(width, height).into(), found.scale_factor);
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
        // SAFETY: whoever calls this promises what the inner one wants.
        unsafe { self.inner().editor.assume_standalone_in_process() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_kept_and_garbage_is_not() {
        let size = WindowSize::default();
        assert_eq!(size.get(), SIZE);
        size.set_points([800.5, 600.0]);
        let other = WindowSize::default();
        other.read_json(&size.to_json());
        assert_eq!(other.get(), [800.5, 600.0]);
        for garbage in ["", "null", "[1]", "[1,2,3]", "\"x\"", "{}", "[null,2]"] {
            other.read_json(garbage);
            assert_eq!(other.get(), [800.5, 600.0], "{garbage}");
        }
        other.read_json("[1,1e30]");
        assert_eq!(other.get(), [SMALLEST.0, LARGEST], "what is no window's is brought to one");
    }
}
