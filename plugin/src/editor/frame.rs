//! The editor as hosts have it: a window whose size a session keeps.

use std::error::Error;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nice_plug_core::context::gui::GuiContext;
use nice_plug_core::editor::dpi::{LogicalSize, NativeSize};
use nice_plug_core::editor::{Editor, HostMethods, ParentWindowHandle, ResizeHint, SizeConstraints, SpawnedEditor};
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
    /// Whether a session has brought it and no window had it yet.
    is_new: AtomicBool,
}

impl Default for WindowSize {
    fn default() -> Self {
        Self { bits: AtomicU64::new(pack(SIZE)), is_new: AtomicBool::new(false) }
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
    pub fn set(&self, size: [f32; 2]) {
        self.bits.store(pack(size), Ordering::Relaxed);
    }
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
        self.inner().editor.spawn(parent, wait_for_parent, fallback_scale_factor, context, host)
    }

    fn size(&self) -> NativeSize<u32> {
        self.inner().editor.size()
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
        size.set([800.5, 600.0]);
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
