//! The window's size, which outlives the window.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use atomic_float::AtomicF64;
use nice_plug_core::editor::dpi::{LogicalSize, NativeSize};

/// The smallest window in which everything can be reached, in points: width and height.
pub const SMALLEST: (f32, f32) = (700.0, 450.0);
/// Size of a new window in points.
const SIZE: [f32; 2] = [1100.0, 790.0];
/// The largest size that is believed, in points.
const LARGEST: f32 = 8192.0;

/// The window's size in points, shared by the window, the session and the host's threads.
#[derive(Debug)]
pub struct WindowSize {
    /// Width and height, 32 bits each.
    bits: AtomicU64,
    /// Pixels of the system's unit on the last window's screen; 0 before there was one.
    scale: AtomicF64,
    /// The system's units of a point: the scale that the user has chosen.
    zoom: AtomicF64,
    /// True if a session has brought it and no window has used it yet.
    is_new: AtomicBool,
}

impl Default for WindowSize {
    fn default() -> Self {
        Self {
            bits: AtomicU64::new(pack(SIZE)),
            scale: AtomicF64::new(0.0),
            zoom: AtomicF64::new(1.0),
            is_new: AtomicBool::new(false),
        }
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

    /// The size as stored in a session.
    pub fn to_json(&self) -> String {
        let [width, height] = self.get();
        format!("[{width},{height}]")
    }

    /// Restores the size stored in a session; anything else is ignored.
    pub fn read_json(&self, text: &str) {
        let Ok(size) = serde_json::from_str::<[f32; 2]>(text) else { return };
        if size.iter().all(|side| side.is_finite()) {
            let [width, height] = size;
            let size = [width.clamp(SMALLEST.0, LARGEST), height.clamp(SMALLEST.1, LARGEST)];
            self.bits.store(pack(size), Ordering::Relaxed);
            self.is_new.store(true, Ordering::Release);
        }
    }

    /// True if a session has brought a size since the last call.
    pub(crate) fn take_new(&self) -> bool {
        self.is_new.swap(false, Ordering::Acquire)
    }

    /// Sets the window's current size.
    pub fn set(&self, size: baseview::WindowSize) {
        self.set_points([size.logical.width as f32, size.logical.height as f32]);
        self.set_scale(size.scale_factor / self.zoom());
    }

    /// Width and height in points.
    pub(crate) fn set_points(&self, size: [f32; 2]) {
        self.bits.store(pack(size), Ordering::Relaxed);
    }

    /// The system's units of a point.
    pub fn zoom(&self) -> f64 {
        self.zoom.load(Ordering::Relaxed)
    }

    /// Sets the system's units of a point.
    pub(crate) fn set_zoom(&self, zoom: f64) {
        self.zoom.store(zoom, Ordering::Relaxed);
    }

    /// Pixels of the system's unit.
    pub(crate) fn set_scale(&self, scale: f64) {
        self.scale.store(scale, Ordering::Relaxed);
    }

    /// The size in the host's units. Hosts ask before there is a window, too.
    pub(crate) fn native(&self) -> NativeSize<u32> {
        let [width, height] = self.get();
        let scale = match self.scale.load(Ordering::Relaxed) {
            scale if scale > 0.0 => scale,
            _ => desktop_scale(),
        };
        NativeSize::from_size(LogicalSize::new(width, height).into(), scale * self.zoom())
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

/// Pixels of a point on the user's desktop, as a window that opens there will find it: 1 in a host that leaves scaling to
/// Windows. baseview 0.4.2 scales nothing before Windows 10 1903, which brought the function that it asks first: what it
/// asks otherwise, it misreads.
#[cfg(target_os = "windows")]
fn desktop_scale() -> f64 {
    use windows_sys::Win32::System::LibraryLoader::{GetModuleHandleA, GetProcAddress};
    use windows_sys::Win32::UI::HiDpi::GetDpiForSystem;
    // SAFETY: constant names, of a library that this one is linked to and of a function that is not called.
    let is_scaled = unsafe {
        let library = GetModuleHandleA(windows_sys::s!("user32.dll"));
        GetProcAddress(library, windows_sys::s!("GetDpiAwarenessContextForProcess")).is_some()
    };
    // SAFETY: it has no requirements.
    let dots_per_inch = if is_scaled { unsafe { GetDpiForSystem() } } else { 0 };
    f64::from(dots_per_inch.max(96)) / 96.0
}

/// On other systems the host uses points.
#[cfg(not(any(target_os = "linux", target_os = "windows")))]
fn desktop_scale() -> f64 {
    1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hosts_see_a_scaled_window_larger() {
        let size = WindowSize::default();
        size.set_points([800.0, 600.0]);
        size.set_scale(1.5);
        size.set_zoom(2.0);
        let points = LogicalSize::new(800.0f32, 600.0);
        assert_eq!(size.native(), NativeSize::from_size(points.into(), 3.0));
        // The toolkit reports both factors as one.
        size.set(baseview::WindowSize {
            logical: LogicalSize::new(700.0, 500.0),
            physical: nice_plug_core::editor::dpi::PhysicalSize::new(2100, 1500),
            scale_factor: 3.0,
        });
        assert_eq!(size.native(), NativeSize::from_size(LogicalSize::new(700.0f32, 500.0).into(), 3.0));
    }

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
