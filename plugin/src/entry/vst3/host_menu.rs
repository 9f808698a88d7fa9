//! A VST3 host's entries in the menu of a parameter.

use std::sync::Arc;
use std::sync::atomic::{AtomicPtr, Ordering};

use vst3::Steinberg::IPlugView;
use vst3::Steinberg::Vst::{
    IComponentHandler3, IComponentHandler3Trait, IContextMenu, IContextMenuItem,
    IContextMenuItem_::{Flags, Flags_},
    IContextMenuTargetTrait, IContextMenuTrait,
};
use vst3::Steinberg::kResultOk;
use vst3::{ComPtr, ComRef};

use super::text;
use crate::entry::instance::NUMERIC_IDS;
use crate::host_menu::{Line, Provider};

/// Address of the open view; null if there is none.
pub type OpenView = Arc<AtomicPtr<IPlugView>>;

/// The host of one instance.
pub struct Vst3Menu {
    handler: ComPtr<IComponentHandler3>,
    view: OpenView,
    /// The menu requested last: it performs the chosen entry.
    menu: Option<(usize, ComPtr<IContextMenu>)>,
}

// SAFETY: everything is used on the host's main thread alone.
unsafe impl Send for Vst3Menu {}

impl Vst3Menu {
    /// A host with this handler, for any open view.
    pub fn new(handler: ComPtr<IComponentHandler3>, view: OpenView) -> Self {
        Self { handler, view, menu: None }
    }
}

impl Provider for Vst3Menu {
    fn lines(&mut self, index: usize) -> Vec<Line> {
        self.menu = None;
        let view = self.view.load(Ordering::Acquire);
        if view.is_null() {
            return Vec::new();
        }
        // SAFETY: a live handler and view, on the main thread; the menu comes with a reference for us.
        let menu = unsafe { ComPtr::from_raw(self.handler.createContextMenu(view, &NUMERIC_IDS[index])) };
        let Some(menu) = menu else { return Vec::new() };
        // SAFETY: a live menu.
        let count = unsafe { menu.getItemCount() };
        let lines = (0..count).filter_map(|place| line(&menu, place)).collect();
        self.menu = Some((index, menu));
        lines
    }

    fn perform(&mut self, index: usize, action: i32) {
        let Some((_, menu)) = self.menu.as_ref().filter(|(of, _)| *of == index) else { return };
        // SAFETY: all fields are numbers, for which zero is valid.
        let (mut item, mut target): (IContextMenuItem, _) = (unsafe { std::mem::zeroed() }, std::ptr::null_mut());
        // SAFETY: a live menu on the main thread, writable locations; the target lives as long as the menu.
        unsafe {
            if menu.getItem(action, &mut item, &mut target) == kResultOk
                && let Some(target) = ComRef::from_raw(target)
            {
                target.executeMenuItem(item.tag);
            }
        }
    }
}

/// A line of the menu; its index serves as the action's number.
fn line(menu: &ComPtr<IContextMenu>, place: i32) -> Option<Line> {
    // SAFETY: all fields are numbers, for which zero is valid.
    let (mut item, mut target): (IContextMenuItem, _) = (unsafe { std::mem::zeroed() }, std::ptr::null_mut());
    // SAFETY: a live menu, and writable locations.
    if unsafe { menu.getItem(place, &mut item, &mut target) } != kResultOk {
        return None;
    }
    #[allow(clippy::unnecessary_cast, reason = "the type of flags is another one on Windows")]
    let has = |flags: Flags| item.flags as u32 & flags as u32 == flags as u32;
    let label = text::read(&item.name);
    // Groups are marked by two flags, each of which has a different meaning alone.
    Some(if has(Flags_::kIsGroupStart) {
        Line::Begin(label)
    } else if has(Flags_::kIsGroupEnd) {
        Line::End
    } else if has(Flags_::kIsSeparator) {
        Line::Separator
    } else {
        let (is_enabled, is_checked) = (!has(Flags_::kIsDisabled), has(Flags_::kIsChecked));
        Line::Entry { label, is_enabled, is_checked, action: place }
    })
}
