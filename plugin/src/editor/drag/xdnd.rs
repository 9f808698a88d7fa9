//! Source of a file in XDND 5, the protocol of X11 for drag and drop.

use std::fmt;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use x11rb::connection::Connection;
use x11rb::errors::{ConnectError, ConnectionError, ReplyError, ReplyOrIdError};
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, KeyButMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use crate::editor::xdnd::{Atoms, VERSION};

/// Interval at which pointer and target are polled.
const PERIOD: Duration = Duration::from_millis(10);
/// Time allowed to a target for reading the dropped file.
const PATIENCE: Duration = Duration::from_secs(20);
/// Bytes left unescaped in an address, beside letters and digits.
const PLAIN: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_');

/// Reason for which a drag failed.
#[derive(Debug)]
pub enum Error {
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
pub struct Drag {
    connection: RustConnection,
    atoms: Atoms,
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
    /// Begins to offer the file to other windows than `editor`.
    pub fn begin(editor: Window, path: &Path) -> Result<Self, Error> {
        let (connection, screen) = x11rb::connect(None)?;
        let atoms = Atoms::new(&connection)?.reply()?;
        let root = connection.setup().roots[screen].root;
        let source = connection.generate_id()?;
        let attributes = CreateWindowAux::new();
        connection.create_window(0, source, root, -1, -1, 1, 1, 0, WindowClass::INPUT_ONLY, 0, &attributes)?;
        connection.set_selection_owner(source, atoms.XdndSelection, x11rb::CURRENT_TIME)?.check()?;
        let uri = address(path);
        Ok(Self {
            connection,
            atoms,
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
    pub fn run(&mut self, is_called_off: &AtomicBool) -> Result<bool, Error> {
        loop {
            self.answer()?;
            let pointer = self.connection.query_pointer(self.root)?.reply()?;
            let is_held = pointer.mask.contains(KeyButMask::BUTTON1);
            if is_called_off.load(Ordering::Relaxed) {
                self.leave()?;
                return Ok(false);
            }
            let position = (pointer.root_x, pointer.root_y);
            self.set_target(self.target_at(position)?)?;
            self.send_position(position)?;
            if !is_held {
                return self.finish(is_called_off);
            }
            std::thread::sleep(PERIOD);
        }
    }

    /// The button was released: drops, once the target has said that it accepts, and waits until it has read the file.
    fn finish(&mut self, is_called_off: &AtomicBool) -> Result<bool, Error> {
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
                self.send(target, self.atoms.XdndDrop, [0, x11rb::CURRENT_TIME, 0, 0])?;
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
                    let is_from_target = self.target.is_some_and(|target| data[0] == target.window);
                    if is_from_target && message.type_ == self.atoms.XdndStatus {
                        (self.is_awaited, self.is_accepted) = (false, data[1] & 1 != 0);
                    } else if is_from_target && message.type_ == self.atoms.XdndFinished {
                        return Ok(Some(data[1] & 1 != 0));
                    }
                }
                _ => {}
            }
        }
        Ok(None)
    }

    fn give(&self, request: &SelectionRequestEvent) -> Result<(), Error> {
        let atoms = &self.atoms;
        // Clients from before that was settled name no property.
        let wanted = if request.property == 0 { request.target } else { request.property };
        let (to, replace) = (request.requestor, PropMode::REPLACE);
        let property = if request.target == atoms.UriList {
            self.connection.change_property8(replace, to, wanted, atoms.UriList, self.uri.as_bytes())?;
            wanted
        } else if request.target == atoms.TARGETS {
            let kinds = [atoms.TARGETS, atoms.UriList];
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
        let proxy = self.property(window, self.atoms.XdndProxy)?;
        let proxy = match proxy {
            Some(proxy) if self.property(proxy, self.atoms.XdndProxy)? == Some(proxy) => proxy,
            _ => window,
        };
        let version = self.property(proxy, self.atoms.XdndAware)?;
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

    fn set_target(&mut self, target: Option<Target>) -> Result<(), Error> {
        if self.target == target {
            return Ok(());
        }
        self.leave()?;
        self.target = target;
        if let Some(target) = target {
            self.send(target, self.atoms.XdndEnter, [VERSION << 24, self.atoms.UriList, 0, 0])?;
        }
        Ok(())
    }

    fn send_position(&mut self, position: (i16, i16)) -> Result<(), Error> {
        let Some(target) = self.target.filter(|_| !self.is_awaited && self.reported != Some(position)) else {
            return Ok(());
        };
        let packed = u32::from(position.0 as u16) << 16 | u32::from(position.1 as u16);
        self.send(target, self.atoms.XdndPosition, [0, packed, x11rb::CURRENT_TIME, self.atoms.XdndActionCopy])?;
        (self.reported, self.is_awaited) = (Some(position), true);
        Ok(())
    }

    fn leave(&mut self) -> Result<(), Error> {
        if let Some(target) = self.target.take() {
            self.send(target, self.atoms.XdndLeave, [0; 4])?;
            // Closing a connection with unread replies discards its last requests.
            self.connection.sync()?;
        }
        (self.reported, self.is_awaited, self.is_accepted) = (None, false, false);
        Ok(())
    }

    fn send(&self, target: Target, what: u32, [a, b, c, d]: [u32; 4]) -> Result<(), Error> {
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
