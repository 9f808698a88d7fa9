//! A CLAP host's entries in the menu of a parameter.

use std::ffi::{CStr, c_char, c_void};

use clap_sys::ext::context_menu::{
    CLAP_CONTEXT_MENU_ITEM_BEGIN_SUBMENU, CLAP_CONTEXT_MENU_ITEM_CHECK_ENTRY, CLAP_CONTEXT_MENU_ITEM_END_SUBMENU,
    CLAP_CONTEXT_MENU_ITEM_ENTRY, CLAP_CONTEXT_MENU_ITEM_SEPARATOR, CLAP_CONTEXT_MENU_ITEM_TITLE,
    CLAP_CONTEXT_MENU_TARGET_KIND_PARAM, CLAP_EXT_CONTEXT_MENU, CLAP_EXT_CONTEXT_MENU_COMPAT,
    clap_context_menu_builder, clap_context_menu_check_entry, clap_context_menu_entry, clap_context_menu_item_kind,
    clap_context_menu_item_title, clap_context_menu_submenu, clap_context_menu_target, clap_host_context_menu,
};
use clap_sys::host::clap_host;

use crate::entry::instance::NUMERIC_IDS;
use crate::host_menu::{Line, Provider};

/// The host of one instance.
pub struct ClapMenu {
    host: *const clap_host,
}

// SAFETY: the host outlives the instance, and is called on its main thread alone.
unsafe impl Send for ClapMenu {}

impl ClapMenu {
    /// # Safety
    /// The host lives as long as this.
    pub unsafe fn new(host: *const clap_host) -> Self {
        Self { host }
    }

    fn extension(&self) -> Option<&clap_host_context_menu> {
        // SAFETY: guaranteed by the caller of `new`; the ids' type.
        unsafe {
            let get = (*self.host).get_extension?;
            let find = |id: &CStr| get(self.host, id.as_ptr()).cast::<clap_host_context_menu>().as_ref();
            find(CLAP_EXT_CONTEXT_MENU).or_else(|| find(CLAP_EXT_CONTEXT_MENU_COMPAT))
        }
    }
}

fn target(index: usize) -> clap_context_menu_target {
    clap_context_menu_target { kind: CLAP_CONTEXT_MENU_TARGET_KIND_PARAM, id: NUMERIC_IDS[index] }
}

impl Provider for ClapMenu {
    fn lines(&mut self, index: usize) -> Vec<Line> {
        let mut lines: Vec<Line> = Vec::new();
        let builder = clap_context_menu_builder {
            ctx: (&raw mut lines).cast::<c_void>(),
            add_item: Some(add_item),
            supports: Some(supports),
        };
        if let Some(populate) = self.extension().and_then(|menu| menu.populate) {
            // SAFETY: a live host on its main thread; target and builder live as long as the call.
            unsafe { populate(self.host, &target(index), &builder) };
        }
        lines
    }

    fn perform(&mut self, index: usize, action: i32) {
        if let Some(perform) = self.extension().and_then(|menu| menu.perform) {
            // SAFETY: a live host on its main thread.
            unsafe { perform(self.host, &target(index), action as u32) };
        }
    }
}

/// # Safety
/// `text` is null or a text.
unsafe fn words(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: guaranteed by the caller.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

unsafe extern "C" fn supports(_: *const clap_context_menu_builder, kind: clap_context_menu_item_kind) -> bool {
    kind <= CLAP_CONTEXT_MENU_ITEM_TITLE
}

unsafe extern "C" fn add_item(
    builder: *const clap_context_menu_builder,
    kind: clap_context_menu_item_kind,
    data: *const c_void,
) -> bool {
    // SAFETY: made in `lines`, and used only within it.
    let lines = unsafe { &mut *(*builder).ctx.cast::<Vec<Line>>() };
    // SAFETY: data is of the type given by its kind, if any, and lives as long as the call.
    let line = unsafe {
        match kind {
            CLAP_CONTEXT_MENU_ITEM_SEPARATOR => Some(Line::Separator),
            CLAP_CONTEXT_MENU_ITEM_END_SUBMENU => Some(Line::End),
            CLAP_CONTEXT_MENU_ITEM_ENTRY => data.cast::<clap_context_menu_entry>().as_ref().map(|entry| Line::Entry {
                label: words(entry.label),
                is_enabled: entry.is_enabled,
                is_checked: false,
                action: entry.action_id as i32,
            }),
            CLAP_CONTEXT_MENU_ITEM_CHECK_ENTRY => {
                data.cast::<clap_context_menu_check_entry>().as_ref().map(|entry| Line::Entry {
                    label: words(entry.label),
                    is_enabled: entry.is_enabled,
                    is_checked: entry.is_checked,
                    action: entry.action_id as i32,
                })
            }
            CLAP_CONTEXT_MENU_ITEM_BEGIN_SUBMENU => {
                data.cast::<clap_context_menu_submenu>().as_ref().map(|menu| Line::Begin(words(menu.label)))
            }
            CLAP_CONTEXT_MENU_ITEM_TITLE => {
                data.cast::<clap_context_menu_item_title>().as_ref().map(|title| Line::Title(words(title.title)))
            }
            _ => None,
        }
    };
    let is_known = line.is_some();
    lines.extend(line);
    is_known
}
