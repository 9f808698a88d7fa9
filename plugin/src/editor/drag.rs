//! Dragging a sound out of the window, onto another program's timeline or into a folder.
//!
//! Under X11 this is a source of XDND 5 on a separate connection and thread: the window itself holds the pointer grab,
//! so pointer and buttons are polled instead. Windows (`DoDragDrop`) and macOS (`NSDraggingSource`) need their source
//! in the window's own event loop, to which baseview 0.4.2 gives no access; there sounds are saved and dragged from the
//! system's file browser.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use raw_window_handle::{HasWindowHandle, RawWindowHandle};
use x11rb::connection::Connection;
use x11rb::errors::{ConnectError, ConnectionError, ReplyError, ReplyOrIdError};
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, KeyButMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use super::task::Task;

x11rb::atom_manager! {
    /// Atoms of the protocol between source and target.
    Words: WordsCookie {
        XdndAware,
        XdndProxy,
        XdndEnter,
        XdndPosition,
        XdndStatus,
        XdndLeave,
        XdndDrop,
        XdndFinished,
        XdndSelection,
        XdndActionCopy,
        TARGETS,
        UriList: b"text/uri-list",
    }
}

/// Version of XDND.
const VERSION: u32 = 5;
/// Interval at which pointer and target are polled.
const PERIOD: Duration = Duration::from_millis(10);
/// Time allowed to a target for reading the dropped file.
const PATIENCE: Duration = Duration::from_secs(20);
/// Bytes left unescaped in an address, beside letters and digits.
const PLAIN: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_');

/// Outcome of a drag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// The target accepted the file.
    Taken(PathBuf),
    /// It was dropped where no target accepts it, or cancelled.
    Dropped,
    /// An error, in words.
    Failed(String),
}

/// Source of sounds dragged out of a window.
pub struct DragSource {
    editor: Window,
    is_called_off: Arc<AtomicBool>,
    task: Option<Task<Outcome>>,
}

impl DragSource {
    /// A source for this window; none where dragging is not possible.
    pub fn of(window: &impl HasWindowHandle) -> Option<Self> {
        let editor = match window.window_handle().ok()?.as_raw() {
            RawWindowHandle::Xlib(handle) => u32::try_from(handle.window).ok()?,
            RawWindowHandle::Xcb(handle) => handle.window.get(),
            _ => return None,
        };
        Some(Self { editor, is_called_off: Arc::default(), task: None })
    }

    /// True if a drag is under way.
    pub fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Drags the file that `write` creates, as long as the primary button is held; `end` is called when the drag is
    /// over.
    pub fn start(
        &mut self,
        path: PathBuf,
        write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
        end: impl FnOnce() + Send + 'static,
    ) {
        let (editor, is_called_off) = (self.editor, Arc::new(AtomicBool::new(false)));
        self.is_called_off = is_called_off.clone();
        let work = move || match write(&path) {
            Ok(()) => Drag::begin(editor, &path)
                .and_then(|mut drag| drag.run(&is_called_off))
                .map_or_else(|error| Outcome::Failed(error.to_string()), |taken| outcome(taken, path)),
            Err(message) => Outcome::Failed(message),
        };
        self.task = Task::start("pyrophone-drag", work, end);
    }

    /// The outcome of the last drag, once.
    pub fn poll(&mut self) -> Option<Outcome> {
        let outcome = self.task.as_mut()?.poll()?;
        self.task = None;
        Some(outcome)
    }
}

impl Drop for DragSource {
    fn drop(&mut self) {
        // The task is waited for.
        self.is_called_off.store(true, Ordering::Relaxed);
    }
}

fn outcome(is_taken: bool, path: PathBuf) -> Outcome {
    if is_taken { Outcome::Taken(path) } else { Outcome::Dropped }
}

/// Reason for which a drag failed.
#[derive(Debug)]
enum Error {
    Connect(ConnectError),
    Reply(ReplyOrIdError),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reason: &dyn fmt::Display = match self {
            Self::Connect(error) => error,
            Self::Reply(error) => error,
        };
        write!(f, "the sound cannot be dragged: {reason}; save it instead")
    }
}

impl From<ConnectError> for Error {
    fn from(error: ConnectError) -> Self {
        Self::Connect(error)
    }
}

impl From<ConnectionError> for Error {
    fn from(error: ConnectionError) -> Self {
        Self::Reply(error.into())
    }
}

impl From<ReplyError> for Error {
    fn from(error: ReplyError) -> Self {
        Self::Reply(error.into())
    }
}

impl From<ReplyOrIdError> for Error {
    fn from(error: ReplyOrIdError) -> Self {
        Self::Reply(error)
    }
}

/// A window that accepts drops, and the one that answers for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Target {
    window: Window,
    proxy: Window,
}

/// A drag under way.
struct Drag {
    connection: RustConnection,
    words: Words,
    root: Window,
    /// Excluded as a target: it would load the sound it has made.
    editor: Window,
    source: Window,
    uri: String,
    target: Option<Target>,
    /// Position last sent to the target, and whether a reply to it is pending.
    reported: Option<(i16, i16)>,
    is_awaited: bool,
    is_accepted: bool,
}

impl Drag {
    fn begin(editor: Window, path: &Path) -> Result<Self, Error> {
        let (connection, screen) = x11rb::connect(None)?;
        let words = Words::new(&connection)?.reply()?;
        let root = connection.setup().roots[screen].root;
        let source = connection.generate_id()?;
        let looks = CreateWindowAux::new();
        connection.create_window(0, source, root, -1, -1, 1, 1, 0, WindowClass::INPUT_ONLY, 0, &looks)?;
        connection.set_selection_owner(source, words.XdndSelection, x11rb::CURRENT_TIME)?.check()?;
        let uri = address(path);
        Ok(Self {
            connection,
            words,
            root,
            editor,
            source,
            uri,
            target: None,
            reported: None,
            is_awaited: false,
            is_accepted: false,
        })
    }

    /// Follows the pointer until the button is released; true if the file was accepted.
    fn run(&mut self, is_called_off: &AtomicBool) -> Result<bool, Error> {
        loop {
            self.answer()?;
            let pointer = self.connection.query_pointer(self.root)?.reply()?;
            let is_held = pointer.mask.contains(KeyButMask::BUTTON1);
            if is_called_off.load(Ordering::Relaxed) {
                self.leave()?;
                return Ok(false);
            }
            let place = (pointer.root_x, pointer.root_y);
            self.go_over(self.target_at(place)?)?;
            self.tell_place(place)?;
            if !is_held {
                return self.let_go(is_called_off);
            }
            std::thread::sleep(PERIOD);
        }
    }

    /// The button was released: drops, once the target has said that it accepts, and waits until it has read the file.
    fn let_go(&mut self, is_called_off: &AtomicBool) -> Result<bool, Error> {
        let (began, mut is_dropped) = (Instant::now(), false);
        while let Some(target) = self.target {
            if began.elapsed() > PATIENCE || is_called_off.load(Ordering::Relaxed) {
                break;
            }
            if let Some(is_taken) = self.answer()? {
                return Ok(is_taken);
            }
            if !is_dropped && !self.is_awaited {
                if !self.is_accepted {
                    break;
                }
                self.tell(target, self.words.XdndDrop, [0, x11rb::CURRENT_TIME, 0, 0])?;
                is_dropped = true;
            }
            std::thread::sleep(PERIOD);
        }
        if !is_dropped {
            self.leave()?;
        }
        Ok(false)
    }

    /// Handles the events that have arrived; returns whether the file was accepted, once the target has said so.
    fn answer(&mut self) -> Result<Option<bool>, Error> {
        while let Some(event) = self.connection.poll_for_event()? {
            match event {
                Event::SelectionRequest(request) => self.give(&request)?,
                Event::ClientMessage(message) if message.format == 32 => {
                    let data = message.data.as_data32();
                    let is_its = self.target.is_some_and(|target| data[0] == target.window);
                    if is_its && message.type_ == self.words.XdndStatus {
                        (self.is_awaited, self.is_accepted) = (false, data[1] & 1 != 0);
                    } else if is_its && message.type_ == self.words.XdndFinished {
                        return Ok(Some(data[1] & 1 != 0));
                    }
                }
                _ => {}
            }
        }
        Ok(None)
    }

    fn give(&self, request: &SelectionRequestEvent) -> Result<(), Error> {
        let words = &self.words;
        // Clients from before that was settled name no property.
        let wanted = if request.property == 0 { request.target } else { request.property };
        let (to, replace) = (request.requestor, PropMode::REPLACE);
        let property = if request.target == words.UriList {
            self.connection.change_property8(replace, to, wanted, words.UriList, self.uri.as_bytes())?;
            wanted
        } else if request.target == words.TARGETS {
            let kinds = [words.TARGETS, words.UriList];
            self.connection.change_property32(replace, to, wanted, AtomEnum::ATOM, &kinds)?;
            wanted
        } else {
            0
        };
        let answer = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: to,
            selection: request.selection,
            target: request.target,
            property,
        };
        self.connection.send_event(false, to, EventMask::NO_EVENT, answer)?;
        self.connection.flush()?;
        Ok(())
    }

    /// The topmost window at a screen position that accepts drops, except the editor's own.
    fn target_at(&self, (x, y): (i16, i16)) -> Result<Option<Target>, Error> {
        let (mut window, mut found) = (self.root, None);
        loop {
            let inside = self.connection.translate_coordinates(self.root, window, x, y)?.reply()?;
            if inside.child == 0 {
                return Ok(found);
            }
            window = inside.child;
            if window == self.editor {
                return Ok(None);
            }
            if found.is_none() {
                found = self.as_target(window)?;
            }
        }
    }

    fn as_target(&self, window: Window) -> Result<Option<Target>, Error> {
        let stand_in = self.property(window, self.words.XdndProxy)?;
        let proxy = match stand_in {
            Some(proxy) if self.property(proxy, self.words.XdndProxy)? == Some(proxy) => proxy,
            _ => window,
        };
        let version = self.property(proxy, self.words.XdndAware)?;
        Ok(version.filter(|version| *version >= 3).map(|_| Target { window, proxy }))
    }

    /// The first number of a property; none for a window that is gone.
    fn property(&self, window: Window, name: u32) -> Result<Option<u32>, Error> {
        match self.connection.get_property(false, window, name, AtomEnum::ANY, 0, 1)?.reply() {
            Ok(reply) => Ok(reply.value32().and_then(|mut values| values.next())),
            Err(ReplyError::X11Error(_)) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    fn go_over(&mut self, target: Option<Target>) -> Result<(), Error> {
        if self.target == target {
            return Ok(());
        }
        self.leave()?;
        self.target = target;
        if let Some(target) = target {
            self.tell(target, self.words.XdndEnter, [VERSION << 24, self.words.UriList, 0, 0])?;
        }
        Ok(())
    }

    fn tell_place(&mut self, place: (i16, i16)) -> Result<(), Error> {
        let Some(target) = self.target.filter(|_| !self.is_awaited && self.reported != Some(place)) else {
            return Ok(());
        };
        let packed = u32::from(place.0 as u16) << 16 | u32::from(place.1 as u16);
        self.tell(target, self.words.XdndPosition, [0, packed, x11rb::CURRENT_TIME, self.words.XdndActionCopy])?;
        (self.reported, self.is_awaited) = (Some(place), true);
        Ok(())
    }

    fn leave(&mut self) -> Result<(), Error> {
        if let Some(target) = self.target.take() {
            self.tell(target, self.words.XdndLeave, [0; 4])?;
            // Closing a connection with unread replies discards its last requests.
            self.connection.sync()?;
        }
        (self.reported, self.is_awaited, self.is_accepted) = (None, false, false);
        Ok(())
    }

    fn tell(&self, target: Target, what: u32, [a, b, c, d]: [u32; 4]) -> Result<(), Error> {
        let message = ClientMessageEvent::new(32, target.window, what, [self.source, a, b, c, d]);
        self.connection.send_event(false, target.proxy, EventMask::NO_EVENT, message)?;
        self.connection.flush()?;
        Ok(())
    }
}

/// The address of a file of this machine, as a list of one (RFC 2483).
fn address(path: &Path) -> String {
    format!("file://{}\r\n", utf8_percent_encode(&path.to_string_lossy(), PLAIN))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_of_plain_characters() {
        let path = Path::new("/home/a b/Flöte 100%.wav");
        assert_eq!(address(path), "file:///home/a%20b/Fl%C3%B6te%20100%25.wav\r\n");
    }
}
