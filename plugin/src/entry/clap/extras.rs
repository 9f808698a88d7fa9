//! Indications of mapping and automation, and our entries in a host's context menu of a parameter.

use std::ffi::{CStr, c_char};

use clap_sys::color::clap_color;
use clap_sys::ext::context_menu::{
    CLAP_CONTEXT_MENU_ITEM_ENTRY, CLAP_CONTEXT_MENU_TARGET_KIND_PARAM, clap_context_menu_builder,
    clap_context_menu_entry, clap_context_menu_target, clap_plugin_context_menu,
};
use clap_sys::ext::param_indication::clap_plugin_param_indication;
use clap_sys::ext::params::{CLAP_EXT_PARAMS, CLAP_PARAM_RESCAN_VALUES, clap_host_params};
use clap_sys::id::clap_id;
use clap_sys::plugin::clap_plugin;
use pyrophone_settings::PARAMETERS;

use super::guard::Guard;
use crate::entry::indication::Automation;
use crate::entry::instance::index_of_numeric;

/// Mapping and automation state of parameters, as reported by the host.
pub static INDICATION: clap_plugin_param_indication =
    clap_plugin_param_indication { set_mapping: Some(set_mapping), set_automation: Some(set_automation) };
/// Our entries in a host's context menu.
pub static CONTEXT_MENU: clap_plugin_context_menu =
    clap_plugin_context_menu { populate: Some(populate), perform: Some(perform) };

unsafe extern "C" fn set_mapping(
    plugin: *const clap_plugin,
    id: clap_id,
    has_mapping: bool,
    _color: *const clap_color,
    _label: *const c_char,
    _description: *const c_char,
) {
    // SAFETY: a live plug-in.
    if let (Some(guard), Some(index)) = (unsafe { Guard::of(plugin) }, index_of_numeric(id)) {
        guard.instance.params.indications.set_mapped(index, has_mapping);
    }
}

unsafe extern "C" fn set_automation(plugin: *const clap_plugin, id: clap_id, state: u32, _color: *const clap_color) {
    // SAFETY: a live plug-in.
    if let (Some(guard), Some(index)) = (unsafe { Guard::of(plugin) }, index_of_numeric(id)) {
        guard.instance.params.indications.set_automation(index, Automation::from_clap(state));
    }
}

/// Action of a menu entry on a parameter.
struct Action {
    id: clap_id,
    label: &'static CStr,
    /// The plain value for the parameter at an index of the table; none if the action does not apply.
    value: fn(usize) -> Option<f64>,
}

const ACTIONS: [Action; 2] = [
    Action { id: 1, label: c"Reset to default", value: |index| Some(PARAMETERS[index].default_value()) },
    Action { id: 2, label: c"Set to the paper's value", value: |index| PARAMETERS[index].paper },
];

/// The target parameter, by its index in the table.
///
/// # Safety
/// `target` is null or live.
unsafe fn parameter_of(target: *const clap_context_menu_target) -> Option<usize> {
    // SAFETY: guaranteed by the caller.
    let target = unsafe { target.as_ref() }.filter(|target| target.kind == CLAP_CONTEXT_MENU_TARGET_KIND_PARAM)?;
    index_of_numeric(target.id)
}

unsafe extern "C" fn populate(
    _plugin: *const clap_plugin,
    target: *const clap_context_menu_target,
    builder: *const clap_context_menu_builder,
) -> bool {
    // SAFETY: null or the host's.
    let (index, builder) = unsafe { (parameter_of(target), builder.as_ref()) };
    let Some((builder, add_item)) = builder.and_then(|builder| Some((builder, builder.add_item?))) else {
        return false;
    };
    // The menu of the plug-in as a whole has the host's own entries only.
    let Some(index) = index else { return true };
    ACTIONS.iter().filter(|action| (action.value)(index).is_some()).all(|action| {
        let entry = clap_context_menu_entry { label: action.label.as_ptr(), is_enabled: true, action_id: action.id };
        // SAFETY: a live builder, which copies the entry.
        unsafe { add_item(builder, CLAP_CONTEXT_MENU_ITEM_ENTRY, std::ptr::from_ref(&entry).cast()) }
    })
}

unsafe extern "C" fn perform(
    plugin: *const clap_plugin,
    target: *const clap_context_menu_target,
    action: clap_id,
) -> bool {
    // SAFETY: a live plug-in, and a target that is null or the host's.
    let (Some(guard), Some(index)) = (unsafe { (Guard::of(plugin), parameter_of(target)) }) else { return false };
    let action = ACTIONS.iter().find(|known| known.id == action);
    let Some(value) = action.and_then(|action| (action.value)(index)) else { return false };
    guard.instance.params.slot(index).set_without_host(value);
    // SAFETY: the id's type.
    let params: Option<&clap_host_params> = unsafe { guard.host_extension(CLAP_EXT_PARAMS) };
    if let Some(rescan) = params.and_then(|params| params.rescan) {
        // SAFETY: a live host, on its main thread.
        unsafe { rescan(guard.host, CLAP_PARAM_RESCAN_VALUES) };
    }
    true
}
