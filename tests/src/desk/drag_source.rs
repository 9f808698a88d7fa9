//! The source's side of drag and drop between programs (XDND 5).

use std::fmt::Write;
use std::path::Path;

use pyrophone_host::editor::EditorWindow;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, SELECTION_NOTIFY_EVENT,
    SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

x11rb::atom_manager! {
    /// Atoms of the drag-and-drop protocol.
    Words: WordsCookie {
        XdndAware,
        XdndProxy,
        XdndEnter,
        XdndPosition,
        XdndStatus,
        XdndDrop,
        XdndFinished,
        XdndSelection,
        XdndActionCopy,
        UriList: b"text/uri-list",
    }
}

const VERSION: u32 = 5;

/// A file that is being dropped on a window.
pub(super) struct Parcel {
    connection: RustConnection,
    words: Words,
    source: Window,
    /// Where it is dropped, and the window that stands in for that.
    target: Window,
    proxy: Window,
    uri: String,
}

impl Parcel {
    /// Drags a file to a place in a window that lies in the screen's upper left corner.
    pub fn new(path: &Path, window: &EditorWindow, (x, y): (i16, i16)) -> Self {
        let (connection, screen) = x11rb::connect(None).expect("a display");
        let words = Words::new(&connection).expect("a request").reply().expect("atoms");
        let source = connection.generate_id().expect("an id");
        let root = connection.setup().roots[screen].root;
        let looks = CreateWindowAux::new();
        connection
            .create_window(0, source, root, 0, 0, 1, 1, 0, WindowClass::INPUT_ONLY, 0, &looks)
            .expect("a request")
            .check()
            .expect("a window");
        connection.set_selection_owner(source, words.XdndSelection, x11rb::CURRENT_TIME).expect("a request");
        let target = aware(&connection, &words, window.id()).expect("a window that takes what is dropped");
        let proxy = property(&connection, target, words.XdndProxy).unwrap_or(target);
        if proxy != target {
            let said = property(&connection, proxy, words.XdndProxy);
            assert_eq!(said, Some(proxy), "a stand-in says of itself that it is one");
        }
        let parcel = Self { connection, words, source, target, proxy, uri: uri(path) };
        parcel.tell(parcel.words.XdndEnter, [VERSION << 24, parcel.words.UriList, 0, 0]);
        let place = u32::from(x as u16) << 16 | u32::from(y as u16);
        parcel.tell(parcel.words.XdndPosition, [0, place, x11rb::CURRENT_TIME, parcel.words.XdndActionCopy]);
        parcel
    }

    fn tell(&self, what: u32, [a, b, c, d]: [u32; 4]) {
        let message = ClientMessageEvent::new(32, self.target, what, [self.source, a, b, c, d]);
        self.connection.send_event(false, self.proxy, EventMask::NO_EVENT, message).expect("a request");
        self.connection.flush().expect("sent");
    }

    /// Answers what the window asks, drops the file when it may, and tells whether the window has taken it.
    pub fn is_taken(&mut self) -> bool {
        while let Some(event) = self.connection.poll_for_event().expect("a display") {
            match event {
                Event::SelectionRequest(request) => self.give(&request),
                Event::ClientMessage(message) if message.type_ == self.words.XdndStatus => {
                    let accepts = message.data.as_data32()[1] & 1 != 0;
                    assert!(accepts, "the window refuses the file");
                    self.tell(self.words.XdndDrop, [0, x11rb::CURRENT_TIME, 0, 0]);
                }
                Event::ClientMessage(message) if message.type_ == self.words.XdndFinished => {
                    let accepted = message.data.as_data32()[1] & 1 != 0;
                    assert!(accepted, "the window has refused the file");
                    return true;
                }
                _ => {}
            }
        }
        false
    }

    fn give(&self, request: &SelectionRequestEvent) {
        assert_eq!(request.target, self.words.UriList, "a kind that was not offered");
        let (property, kind) = (request.property, self.words.UriList);
        let written =
            self.connection.change_property8(PropMode::REPLACE, request.requestor, property, kind, self.uri.as_bytes());
        written.expect("a request").check().expect("given");
        let answer = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: request.requestor,
            selection: request.selection,
            target: request.target,
            property,
        };
        self.connection.send_event(false, request.requestor, EventMask::NO_EVENT, answer).expect("a request");
        self.connection.flush().expect("sent");
    }
}

/// The outermost of a window and those in it that takes what is dropped, as sources look for it.
fn aware(connection: &RustConnection, words: &Words, window: Window) -> Option<Window> {
    if property(connection, window, words.XdndAware).is_some_and(|version| version >= VERSION) {
        return Some(window);
    }
    let children = connection.query_tree(window).expect("a request").reply().expect("windows").children;
    children.into_iter().find_map(|child| aware(connection, words, child))
}

fn property(connection: &RustConnection, window: Window, name: u32) -> Option<u32> {
    let request = connection.get_property(false, window, name, AtomEnum::ANY, 0, 1).expect("a request");
    request.reply().expect("a property, or none").value32()?.next()
}

fn uri(path: &Path) -> String {
    let mut uri = String::from("file://");
    for byte in path.to_str().expect("a UTF-8 path").bytes() {
        match byte {
            b'/' | b'.' | b'-' | b'_' => uri.push(byte.into()),
            _ if byte.is_ascii_alphanumeric() => uri.push(byte.into()),
            // Writing to a string does not fail.
            _ => write!(uri, "%{byte:02X}").unwrap_or_default(),
        }
    }
    uri + "\r\n"
}
