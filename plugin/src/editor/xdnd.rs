//! XDND 5, the protocol of X11 for drag and drop: its atoms and version, for the window as source and as target.

x11rb::atom_manager! {
    /// Atoms of the protocol between source and target.
    pub Atoms: AtomsCookie {
        XdndAware,
        XdndProxy,
        XdndEnter,
        XdndPosition,
        XdndStatus,
        XdndLeave,
        XdndDrop,
        XdndFinished,
        XdndSelection,
        XdndTypeList,
        XdndActionCopy,
        TARGETS,
        UriList: b"text/uri-list",
    }
}

/// Version of the protocol.
pub const VERSION: u32 = 5;
