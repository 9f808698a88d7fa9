#![doc = include_str!("../README.md")]
// The names are those of the C library, as baseview spells them.
#![allow(non_camel_case_types)]
#![cfg(target_os = "linux")]

use std::ffi::{c_char, c_int};
use std::sync::OnceLock;

use libloading::Library;

pub mod x11;

/// Library context in which maps are compiled.
pub enum xkb_context {}
/// Keyboard map, of the library.
pub enum xkb_keymap {}
/// State of a keyboard's modifiers, of the library.
pub enum xkb_state {}

/// Code of a key: that of the X server.
pub type xkb_keycode_t = u32;

/// Options of a context.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum xkb_context_flags {
    /// None.
    XKB_CONTEXT_NO_FLAGS = 0,
}

/// Options of a map.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum xkb_keymap_compile_flags {
    /// None.
    XKB_KEYMAP_COMPILE_NO_FLAGS = 0,
}

/// Direction of a key's movement.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum xkb_key_direction {
    /// The key was released.
    XKB_KEY_UP = 0,
    /// The key was pressed.
    XKB_KEY_DOWN = 1,
}

/// Functions of `libxkbcommon`. Those that take a state accept null.
#[derive(Debug)]
pub struct XkbCommon {
    /// New context, or null.
    pub xkb_context_new: unsafe extern "C" fn(xkb_context_flags) -> *mut xkb_context,
    /// Releases a reference to a context.
    pub xkb_context_unref: unsafe extern "C" fn(*mut xkb_context),
    /// Releases a reference to a state.
    pub xkb_state_unref: unsafe extern "C" fn(*mut xkb_state),
    /// Writes the text that a key types, as zero-terminated UTF-8, to a buffer of a given size; returns its length in
    /// bytes.
    pub xkb_state_key_get_utf8: unsafe extern "C" fn(*mut xkb_state, xkb_keycode_t, *mut c_char, usize) -> c_int,
    /// Informs a state that a key went down or up; returns the set of what changed.
    pub xkb_state_update_key: unsafe extern "C" fn(*mut xkb_state, xkb_keycode_t, xkb_key_direction) -> c_int,
}

/// [`XkbCommon`], and the further functions that this crate uses.
struct Common {
    offered: XkbCommon,
    keymap_unref: unsafe extern "C" fn(*mut xkb_keymap),
    key_get_utf8: unsafe extern "C" fn(*mut xkb_state, xkb_keycode_t, *mut c_char, usize) -> c_int,
    update_key: unsafe extern "C" fn(*mut xkb_state, xkb_keycode_t, xkb_key_direction) -> c_int,
}

impl Common {
    fn load() -> Option<Self> {
        let library = open(["libxkbcommon.so.0", "libxkbcommon.so"])?;
        // SAFETY: names and types are those of xkbcommon.h, version 0.5 and later.
        unsafe {
            Some(Self {
                offered: XkbCommon {
                    xkb_context_new: *library.get(b"xkb_context_new\0").ok()?,
                    xkb_context_unref: *library.get(b"xkb_context_unref\0").ok()?,
                    xkb_state_unref: *library.get(b"xkb_state_unref\0").ok()?,
                    xkb_state_key_get_utf8: key_get_utf8,
                    xkb_state_update_key: update_key,
                },
                keymap_unref: *library.get(b"xkb_keymap_unref\0").ok()?,
                key_get_utf8: *library.get(b"xkb_state_key_get_utf8\0").ok()?,
                update_key: *library.get(b"xkb_state_update_key\0").ok()?,
            })
        }
    }
}

/// `libxkbcommon`, if the system has it.
pub fn xkbcommon_option() -> Option<&'static XkbCommon> {
    common().map(|common| &common.offered)
}

fn common() -> Option<&'static Common> {
    static COMMON: OnceLock<Option<Common>> = OnceLock::new();
    COMMON.get_or_init(Common::load).as_ref()
}

/// A system library, under the first of its names that exists. It stays loaded, because pointers into it are kept.
fn open(names: [&str; 2]) -> Option<&'static Library> {
    // SAFETY: loading the library makes no demands on this program.
    let library = names.into_iter().find_map(|name| unsafe { Library::new(name) }.ok())?;
    Some(Box::leak(Box::new(library)))
}

/// Text that a key types in a state, which may be null; then there is none.
unsafe extern "C" fn key_get_utf8(
    state: *mut xkb_state,
    key: xkb_keycode_t,
    buffer: *mut c_char,
    size: usize,
) -> c_int {
    match common() {
        // SAFETY: the state is the library's and not null; the caller vouches for the buffer.
        Some(common) if !state.is_null() => unsafe { (common.key_get_utf8)(state, key, buffer, size) },
        _ => -1,
    }
}

/// Informs a state, which may be null, that a key went down or up.
unsafe extern "C" fn update_key(state: *mut xkb_state, key: xkb_keycode_t, direction: xkb_key_direction) -> c_int {
    match common() {
        // SAFETY: the state is the library's and not null.
        Some(common) if !state.is_null() => unsafe { (common.update_key)(state, key, direction) },
        _ => 0,
    }
}

#[cfg(test)]
#[path = "../../tests/src/skip.rs"]
mod skip;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_null_state_types_nothing() {
        let Some(common) = xkbcommon_option() else {
            skip::skip("there is no libxkbcommon here");
            return;
        };
        let mut buffer = [0; 32];
        // SAFETY: null is what is being tested; the buffer is as long as said.
        unsafe {
            assert!((common.xkb_state_key_get_utf8)(std::ptr::null_mut(), 38, buffer.as_mut_ptr(), buffer.len()) < 0);
            assert_eq!((common.xkb_state_update_key)(std::ptr::null_mut(), 38, xkb_key_direction::XKB_KEY_DOWN), 0);
            (common.xkb_state_unref)(std::ptr::null_mut());
        }
    }
}
