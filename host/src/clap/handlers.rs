//! Host side of CLAP: requests that a plug-in may make.

use std::ffi::CString;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use clack_extensions::context_menu::{
    ContextMenuBuilder, ContextMenuTarget, HostContextMenu, HostContextMenuImpl, Item,
};
use clack_extensions::gui::{GuiSize, HostGui, HostGuiImpl};
use clack_extensions::latency::{HostLatency, HostLatencyImpl};
use clack_extensions::params::{
    HostParams, HostParamsImplMainThread, HostParamsImplShared, ParamClearFlags, ParamRescanFlags,
};
use clack_extensions::state::{HostState, HostStateImpl};
use clack_host::prelude::*;

use crate::lock::lock;
use crate::{MENU, Requests, SUBMENU};

/// Pending requests; set from any thread.
#[derive(Default)]
pub(super) struct Flags {
    restart: AtomicBool,
    callback: AtomicBool,
    latency_changed: AtomicBool,
    values_changed: AtomicBool,
    editor_size: Mutex<Option<(u32, u32)>>,
    /// Parameters and entries that were chosen of menus.
    chosen: Mutex<Vec<(u32, i32)>>,
}

impl Flags {
    pub fn take_callback(&self) -> bool {
        self.callback.swap(false, Ordering::AcqRel)
    }

    pub fn take_editor_size(&self) -> Option<(u32, u32)> {
        lock(&self.editor_size).take()
    }

    pub fn take_chosen(&self) -> Vec<(u32, i32)> {
        std::mem::take(&mut *lock(&self.chosen))
    }

    pub fn take_requests(&self) -> Requests {
        Requests {
            restart: self.restart.swap(false, Ordering::AcqRel),
            latency_changed: self.latency_changed.swap(false, Ordering::AcqRel),
            values_changed: self.values_changed.swap(false, Ordering::AcqRel),
        }
    }
}

pub(super) struct Handlers;

impl HostHandlers for Handlers {
    type Shared<'a> = Shared;
    type MainThread<'a> = MainThread;
    type AudioProcessor<'a> = ();

    fn declare_extensions(builder: &mut HostExtensions<'_, Self>, _: &Shared) {
        builder.register::<HostLatency>().register::<HostParams>().register::<HostState>().register::<HostGui>();
        builder.register::<HostContextMenu>();
    }
}

pub(super) struct Shared(pub Arc<Flags>);

impl SharedHandler<'_> for Shared {
    fn request_restart(&self) {
        self.0.restart.store(true, Ordering::Release);
    }

    /// The host never lets a plug-in sleep.
    fn request_process(&self) {}

    fn request_callback(&self) {
        self.0.callback.store(true, Ordering::Release);
    }
}

impl HostParamsImplShared for Shared {
    /// Changes made in the editor are sent with the next block.
    fn request_flush(&self) {}
}

impl HostGuiImpl for Shared {
    fn resize_hints_changed(&self) {}

    /// The window follows with the next round of callbacks, as CLAP allows.
    fn request_resize(&self, size: GuiSize) -> Result<(), HostError> {
        *lock(&self.0.editor_size) = Some((size.width, size.height));
        Ok(())
    }

    fn request_show(&self) -> Result<(), HostError> {
        Ok(())
    }

    fn request_hide(&self) -> Result<(), HostError> {
        Ok(())
    }

    fn closed(&self, _: bool) {}
}

pub(super) struct MainThread(pub Arc<Flags>);

impl MainThreadHandler<'_> for MainThread {}

impl HostLatencyImpl for MainThread {
    fn changed(&self) {
        self.0.latency_changed.store(true, Ordering::Release);
    }
}

impl HostParamsImplMainThread for MainThread {
    fn rescan(&self, _: ParamRescanFlags) {
        self.0.values_changed.store(true, Ordering::Release);
    }

    fn clear(&self, _: ClapId, _: ParamClearFlags) {}
}

impl HostContextMenuImpl for MainThread {
    fn populate(&self, _: ContextMenuTarget, builder: &mut ContextMenuBuilder) -> Result<(), HostError> {
        let [first, second] = MENU.map(|(action, words)| (action, CString::new(words).unwrap_or_default()));
        let entry = |label, action: i32| Item::Entry { label, enabled: true, action_id: ClapId::new(action as u32) };
        let submenu = CString::new(SUBMENU).unwrap_or_default();
        let items = [
            entry(&first.1, first.0),
            Item::Separator,
            Item::BeginSubmenu { label: &submenu, enabled: true },
            entry(&second.1, second.0),
            Item::EndSubmenu,
        ];
        items
            .iter()
            .try_for_each(|item| builder.add_item(item))
            .map_err(|_| HostError::Message("the plug-in refuses the menu"))
    }

    fn perform(&self, target: ContextMenuTarget, action: ClapId) -> Result<(), HostError> {
        if let ContextMenuTarget::Param(id) = target {
            lock(&self.0.chosen).push((id.get(), action.get() as i32));
        }
        Ok(())
    }

    fn can_popup(&self) -> bool {
        false
    }

    fn popup(&self, _: ContextMenuTarget, _: i32, _: i32, _: i32) -> Result<(), HostError> {
        Err(HostError::Message("menus are shown by the plug-in"))
    }
}

impl HostStateImpl for MainThread {
    fn mark_dirty(&self) {}
}
