//! Extensions that some hosts ask for.

use std::collections::BTreeSet;
use std::ffi::c_void;
use std::path::Path;

use clap_sys::ext::context_menu::{
    CLAP_CONTEXT_MENU_TARGET_KIND_PARAM, CLAP_EXT_CONTEXT_MENU, clap_context_menu_builder, clap_context_menu_target,
    clap_plugin_context_menu,
};
use clap_sys::ext::param_indication::{CLAP_EXT_PARAM_INDICATION, clap_plugin_param_indication};
use clap_sys::ext::remote_controls::{
    CLAP_EXT_REMOTE_CONTROLS, clap_plugin_remote_controls, clap_remote_controls_page,
};
use clap_sys::ext::state_context::{CLAP_EXT_STATE_CONTEXT, CLAP_STATE_CONTEXT_FOR_PRESET, clap_plugin_state_context};

use crate::numeric_id;
use crate::validator::ensure;

use super::events::event;
use super::raw::{Raw, loaded, saved};

/// Pages of remote controls that a controller can count on.
const LEAST_PAGES: u32 = 4;

/// The check `extensions_that_hosts_ask_for_answer`.
pub(super) fn extensions(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    // SAFETY: the ids' types, a live plug-in, and writable locations whose fields are numbers.
    unsafe {
        let context: &clap_plugin_state_context = raw.extension(CLAP_EXT_STATE_CONTEXT)?;
        let for_preset =
            saved(|stream| context.save.is_some_and(|save| save(raw.plugin, stream, CLAP_STATE_CONTEXT_FOR_PRESET)))?;
        loaded(&for_preset, |stream| {
            context.load.is_some_and(|load| load(raw.plugin, stream, CLAP_STATE_CONTEXT_FOR_PRESET))
        })?;

        let remote: &clap_plugin_remote_controls = raw.extension(CLAP_EXT_REMOTE_CONTROLS)?;
        let pages = (remote.count.ok_or("no count")?)(raw.plugin);
        // The number is up to the plug-in: every new group of parameters may add a page.
        ensure(pages >= LEAST_PAGES, || format!("{pages} remote control pages, at least {LEAST_PAGES} are wanted"))?;
        let ids: BTreeSet<u32> = raw.parameters()?.iter().map(|info| info.id).collect();
        for index in 0..pages {
            let mut page: clap_remote_controls_page = std::mem::zeroed();
            ensure((remote.get.ok_or("no get")?)(raw.plugin, index, &mut page), || format!("no page {index}"))?;
            ensure(page.param_ids.iter().all(|id| ids.contains(id)), || format!("page {index} has a gap"))?;
        }

        let indication: &clap_plugin_param_indication = raw.extension(CLAP_EXT_PARAM_INDICATION)?;
        let id = numeric_id("alpha");
        (indication.set_mapping.ok_or("no mapping")?)(
            raw.plugin,
            id,
            true,
            std::ptr::null(),
            c"knob".as_ptr(),
            std::ptr::null(),
        );
        (indication.set_automation.ok_or("no automation")?)(raw.plugin, id, 2, std::ptr::null());

        menu(&raw, id)
    }
}

/// The context menu of a parameter offers to reset it, and does.
///
/// # Safety
/// A live plug-in.
unsafe fn menu(raw: &Raw, id: u32) -> Result<(), String> {
    unsafe extern "C" fn add(builder: *const clap_context_menu_builder, _kind: u32, _item: *const c_void) -> bool {
        // SAFETY: made below.
        unsafe { *(*builder).ctx.cast::<usize>() += 1 };
        true
    }
    // SAFETY: the id's type; all arguments live as long as the calls.
    unsafe {
        let menu: &clap_plugin_context_menu = raw.extension(CLAP_EXT_CONTEXT_MENU)?;
        let target = clap_context_menu_target { kind: CLAP_CONTEXT_MENU_TARGET_KIND_PARAM, id };
        let mut items = 0usize;
        let builder = clap_context_menu_builder { ctx: (&raw mut items).cast(), add_item: Some(add), supports: None };
        let is_filled = (menu.populate.ok_or("no populate")?)(raw.plugin, &target, &builder);
        ensure(is_filled && items > 0, || "its context menu is empty".to_owned())?;
        let default = raw.value("alpha")?;
        raw.flush(&[event(id, 0.9)])?;
        ensure((menu.perform.ok_or("no perform")?)(raw.plugin, &target, 1), || "it does not reset".to_owned())?;
        let value = raw.value("alpha")?;
        ensure((value - default).abs() < 1e-6, || format!("reset, it is {value} instead of {default}"))
    }
}
