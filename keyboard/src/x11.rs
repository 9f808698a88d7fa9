//! Functions of `libxkbcommon-x11`: the keyboard of an X server.

use std::ffi::c_void;
use std::sync::OnceLock;

use crate::{common, open, xkb_context, xkb_keymap, xkb_keymap_compile_flags, xkb_state};

/// Connection to an X server, of XCB.
pub type xcb_connection_t = c_void;

/// Functions of `libxkbcommon-x11`.
#[derive(Debug)]
pub struct XkbCommonX11 {
    /// Number of the server's main keyboard, or -1.
    pub xkb_x11_get_core_keyboard_device_id: unsafe extern "C" fn(*mut xcb_connection_t) -> i32,
    /// New map of a keyboard, or null.
    pub xkb_x11_keymap_new_from_device:
        unsafe extern "C" fn(*mut xkb_context, *mut xcb_connection_t, i32, xkb_keymap_compile_flags) -> *mut xkb_keymap,
    /// New state of a keyboard, or null. It takes over the caller's reference to the map.
    pub xkb_x11_state_new_from_device:
        unsafe extern "C" fn(*mut xkb_keymap, *mut xcb_connection_t, i32) -> *mut xkb_state,
}

type NewState = unsafe extern "C" fn(*mut xkb_keymap, *mut xcb_connection_t, i32) -> *mut xkb_state;

struct CommonX11 {
    offered: XkbCommonX11,
    state_new: NewState,
}

impl CommonX11 {
    fn load() -> Option<Self> {
        let library = open(["libxkbcommon-x11.so.0", "libxkbcommon-x11.so"])?;
        // SAFETY: names and types are those of xkbcommon-x11.h, version 0.5 and later.
        unsafe {
            Some(Self {
                offered: XkbCommonX11 {
                    xkb_x11_get_core_keyboard_device_id: *library.get(b"xkb_x11_get_core_keyboard_device_id\0").ok()?,
                    xkb_x11_keymap_new_from_device: *library.get(b"xkb_x11_keymap_new_from_device\0").ok()?,
                    xkb_x11_state_new_from_device: state_new,
                },
                state_new: *library.get(b"xkb_x11_state_new_from_device\0").ok()?,
            })
        }
    }
}

/// `libxkbcommon-x11`, if the system has it.
pub fn xkbcommon_x11_option() -> Option<&'static XkbCommonX11> {
    common_x11().map(|common| &common.offered)
}

fn common_x11() -> Option<&'static CommonX11> {
    static COMMON: OnceLock<Option<CommonX11>> = OnceLock::new();
    COMMON.get_or_init(CommonX11::load).as_ref()
}

/// New state, or null without a map. The caller's reference to the map is released: the state has its own.
unsafe extern "C" fn state_new(
    keymap: *mut xkb_keymap,
    connection: *mut xcb_connection_t,
    device: i32,
) -> *mut xkb_state {
    let (Some(common), Some(x11)) = (common(), common_x11()) else { return std::ptr::null_mut() };
    if keymap.is_null() {
        return std::ptr::null_mut();
    }
    // SAFETY: the map is the library's and not null; the caller vouches for the connection.
    let state = unsafe { (x11.state_new)(keymap, connection, device) };
    // SAFETY: the reference is the caller's, who no longer uses it.
    unsafe { (common.keymap_unref)(keymap) };
    state
}
