//! Dropping files on the window under X11. egui-baseview 0.9.0 passes no drops on, so an invisible window of our own acts
//! as target for the editor's (XDND 5, `XdndProxy`), on a separate thread.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use nice_plug_egui::RepaintNotifier;
use percent_encoding::percent_decode_str;
use raw_window_handle::{HasWindowHandle, RawWindowHandle};
use x11rb::connection::Connection;
use x11rb::errors::ReplyOrIdError;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use crate::editor::xdnd::{Atoms, VERSION};

/// Longest list of files that is read, in units of four bytes.
const LONGEST: u32 = 1 << 18;

/// Receiver of files dropped on a window; dropping it ends that.
pub struct DropTarget {
    dropped: Mutex<Receiver<PathBuf>>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    connection: RustConnection,
    atoms: Atoms,
    /// The proxy window.
    own: Window,
    is_hovered: AtomicBool,
    has_ended: AtomicBool,
}

impl DropTarget {
    /// Starts accepting files for this window; none where that is not possible. `notifier` wakes the window.
    pub fn open(window: &impl HasWindowHandle, notifier: RepaintNotifier) -> Option<Self> {
        let editor = match window.window_handle().ok()?.as_raw() {
            RawWindowHandle::Xlib(handle) => u32::try_from(handle.window).ok()?,
            RawWindowHandle::Xcb(handle) => handle.window.get(),
            _ => return None,
        };
        let shared = Arc::new(Shared::proxy_for(editor).ok()?);
        let (sender, receiver) = channel();
        let target = shared.clone();
        let work = move || target.run(&sender, &notifier);
        let thread = std::thread::Builder::new().name("pyrophone-drop".to_owned()).spawn(work).ok()?;
        Some(Self { dropped: Mutex::new(receiver), shared, thread: Some(thread) })
    }

    /// True if a file is held over the window.
    pub fn is_hovered(&self) -> bool {
        self.shared.is_hovered.load(Ordering::Relaxed)
    }

    /// A file that was dropped.
    pub fn poll(&mut self) -> Option<PathBuf> {
        self.dropped.get_mut().unwrap_or_else(PoisonError::into_inner).try_recv().ok()
    }
}

impl Drop for DropTarget {
    fn drop(&mut self) {
        self.shared.has_ended.store(true, Ordering::Relaxed);
        // Any event wakes the thread. Without a display it has ended already.
        let own = self.shared.own;
        let _ = self.shared.send(own, self.shared.atoms.XdndLeave, [0; 5], own);
        if let Some(thread) = self.thread.take() {
            // A panic on that thread only means that files are no longer accepted.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn proxy_for(editor: Window) -> Result<Self, ReplyOrIdError> {
        let (connection, screen) = x11rb::connect(None).map_err(|_| ReplyOrIdError::IdsExhausted)?;
        let atoms = Atoms::new(&connection)?.reply()?;
        let own = connection.generate_id()?;
        let root = connection.setup().roots[screen].root;
        let looks = CreateWindowAux::new();
        connection.create_window(0, own, root, -1, -1, 1, 1, 0, WindowClass::INPUT_ONLY, 0, &looks)?;
        let (window, atom) = (AtomEnum::WINDOW, AtomEnum::ATOM);
        connection.change_property32(PropMode::REPLACE, own, atoms.XdndAware, atom, &[VERSION])?;
        // By the protocol, a proxy must carry the property itself too.
        connection.change_property32(PropMode::REPLACE, own, atoms.XdndProxy, window, &[own])?;
        connection.change_property32(PropMode::REPLACE, editor, atoms.XdndProxy, window, &[own])?.check()?;
        let (is_hovered, has_ended) = (AtomicBool::new(false), AtomicBool::new(false));
        Ok(Self { connection, atoms, own, is_hovered, has_ended })
    }

    fn run(&self, dropped: &Sender<PathBuf>, notifier: &RepaintNotifier) {
        let mut drag = None;
        while let Ok(event) = self.connection.wait_for_event() {
            if self.has_ended.load(Ordering::Relaxed) {
                break;
            }
            match self.follow(&event, &mut drag) {
                Ok(files) => files.into_iter().for_each(|file| drop(dropped.send(file))),
                // The failure concerns the drag only: the source may be gone.
                Err(_) => drag = None,
            }
            self.is_hovered.store(drag.as_ref().is_some_and(|drag| drag.has_files), Ordering::Relaxed);
            notifier.request_repaint();
        }
    }

    /// Continues a drag, and returns the dropped files.
    fn follow(&self, event: &Event, drag: &mut Option<Drag>) -> Result<Vec<PathBuf>, ReplyOrIdError> {
        let atoms = &self.atoms;
        match event {
            Event::ClientMessage(message) if message.format == 32 => {
                let data = message.data.as_data32();
                let (source, kind) = (data[0], message.type_);
                if kind == atoms.XdndEnter {
                    let has_files = self.kinds(source, &data)?.contains(&atoms.UriList);
                    *drag = Some(Drag { source, target: message.window, has_files });
                } else if let Some(known) = drag.as_ref().filter(|drag| drag.source == source) {
                    let (target, accepts) = (known.target, u32::from(known.has_files));
                    if kind == atoms.XdndPosition {
                        let action = if known.has_files { atoms.XdndActionCopy } else { 0 };
                        self.send(source, atoms.XdndStatus, [target, accepts, 0, 0, action], source)?;
                    } else if kind == atoms.XdndLeave {
                        *drag = None;
                    } else if kind == atoms.XdndDrop && known.has_files {
                        let property = atoms.XdndSelection;
                        self.connection.convert_selection(self.own, property, atoms.UriList, property, data[2])?;
                        self.connection.flush()?;
                    } else if kind == atoms.XdndDrop {
                        self.send(source, atoms.XdndFinished, [target, 0, 0, 0, 0], source)?;
                        *drag = None;
                    }
                }
            }
            Event::SelectionNotify(notice) => {
                let Some(Drag { source, target, .. }) = drag.take() else { return Ok(vec![]) };
                let mut files = vec![];
                if notice.property != 0 {
                    let any = AtomEnum::ANY;
                    let list =
                        self.connection.get_property(true, self.own, notice.property, any, 0, LONGEST)?.reply()?;
                    files = files_in(&list.value);
                }
                let (is_taken, action) = if files.is_empty() { (0, 0) } else { (1, atoms.XdndActionCopy) };
                self.send(source, atoms.XdndFinished, [target, is_taken, action, 0, 0], source)?;
                return Ok(files);
            }
            _ => {}
        }
        Ok(vec![])
    }

    /// The kinds of data that a source offers: three fit into its message.
    fn kinds(&self, source: Window, data: &[u32; 5]) -> Result<Vec<u32>, ReplyOrIdError> {
        if data[1] & 1 == 0 {
            return Ok(data[2..].to_vec());
        }
        let list = self.connection.get_property(false, source, self.atoms.XdndTypeList, AtomEnum::ATOM, 0, 1024)?;
        Ok(list.reply()?.value32().map(Iterator::collect).unwrap_or_default())
    }

    fn send(&self, to: Window, kind: u32, data: [u32; 5], about: Window) -> Result<(), ReplyOrIdError> {
        let message = ClientMessageEvent::new(32, about, kind, data);
        self.connection.send_event(false, to, EventMask::NO_EVENT, message)?;
        self.connection.flush()?;
        Ok(())
    }
}

/// A drag over the window.
struct Drag {
    source: Window,
    /// The window that the source speaks to.
    target: Window,
    has_files: bool,
}

/// The files of this machine in a list of addresses (RFC 2483).
fn files_in(list: &[u8]) -> Vec<PathBuf> {
    let list = String::from_utf8_lossy(list);
    let path = |line: &str| {
        let path = line.strip_prefix("file://")?;
        let path = &path[path.find('/')?..];
        Some(PathBuf::from(percent_decode_str(path).decode_utf8().ok()?.into_owned()))
    };
    list.lines().filter_map(|line| path(line.trim_end_matches('\0'))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_name_files() {
        let list =
            b"# a comment\r\nfile:///a%20b/100%25.wav\r\nhttp://x/y.wav\r\nfile://host/c.wav\r\nfile://nothing\0";
        assert_eq!(files_in(list), [PathBuf::from("/a b/100%.wav"), PathBuf::from("/c.wav")]);
        assert!(files_in(&[0xff, 0, b'\n']).is_empty());
    }
}
