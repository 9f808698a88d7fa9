//! A place of another program where files can be dropped (XDND 5, the target's side).

use std::path::PathBuf;

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

x11rb::atom_manager! {
    /// Atoms of the drag-and-drop protocol.
    Words: WordsCookie {
        XdndAware,
        XdndEnter,
        XdndPosition,
        XdndStatus,
        XdndLeave,
        XdndDrop,
        XdndFinished,
        XdndSelection,
        XdndActionCopy,
        UriList: b"text/uri-list",
    }
}

/// A window that takes files, on top of all others.
pub struct DropSpot {
    connection: RustConnection,
    words: Words,
    window: Window,
    source: Window,
    accepts: bool,
    /// Drags that have come over it, and that have left.
    pub entered: usize,
    /// See `entered`.
    pub left: usize,
    place: (i16, i16),
}

impl DropSpot {
    /// A spot of 60 by 60 pixels whose left upper corner is here; `accepts` says whether it takes what is dropped.
    pub fn new((x, y): (i16, i16), accepts: bool) -> Self {
        let (connection, screen) = x11rb::connect(None).expect("a display");
        let words = Words::new(&connection).expect("a request").reply().expect("atoms");
        let window = connection.generate_id().expect("an id");
        let root = connection.setup().roots[screen].root;
        let looks = CreateWindowAux::new().override_redirect(1);
        let class = WindowClass::INPUT_OUTPUT;
        let created = connection.create_window(0, window, root, x, y, 60, 60, 0, class, 0, &looks).expect("a request");
        created.check().expect("a window");
        let aware = connection.change_property32(PropMode::REPLACE, window, words.XdndAware, AtomEnum::ATOM, &[5]);
        aware.expect("a request").check().expect("a property");
        connection.map_window(window).expect("a request").check().expect("shown");
        Self { connection, words, window, source: 0, accepts, entered: 0, left: 0, place: (x, y) }
    }

    /// Its middle, on the screen.
    pub fn middle(&self) -> (i16, i16) {
        (self.place.0 + 30, self.place.1 + 30)
    }

    fn tell(&self, what: u32, [a, b, c, d]: [u32; 4]) {
        let message = ClientMessageEvent::new(32, self.source, what, [self.window, a, b, c, d]);
        self.connection.send_event(false, self.source, EventMask::NO_EVENT, message).expect("a request");
        self.connection.flush().expect("sent");
    }

    /// Answers what the source says; the file that was dropped, once it has arrived.
    pub fn poll(&mut self) -> Option<PathBuf> {
        while let Some(event) = self.connection.poll_for_event().expect("a display") {
            match event {
                Event::ClientMessage(message) => self.hear(&message),
                Event::SelectionNotify(notice) => {
                    let any = AtomEnum::ANY;
                    let list = self.connection.get_property(true, self.window, notice.property, any, 0, 4096);
                    let list = list.expect("a request").reply().expect("a list of files").value;
                    self.tell(self.words.XdndFinished, [1, self.words.XdndActionCopy, 0, 0]);
                    return Some(path_in(&String::from_utf8(list).expect("plain characters")));
                }
                _ => {}
            }
        }
        None
    }

    fn hear(&mut self, message: &ClientMessageEvent) {
        let (words, data) = (&self.words, message.data.as_data32());
        if message.type_ == words.XdndEnter {
            assert_eq!((data[1] >> 24, data[2]), (5, words.UriList), "version and kind");
            self.source = data[0];
            self.entered += 1;
        } else if message.type_ == words.XdndPosition {
            let place = ((data[2] >> 16) as i16, data[2] as i16);
            assert!((place.0 - self.place.0).abs() <= 60 && (place.1 - self.place.1).abs() <= 60, "{place:?} is here");
            self.tell(words.XdndStatus, [u32::from(self.accepts), 0, 0, words.XdndActionCopy]);
        } else if message.type_ == words.XdndLeave {
            self.left += 1;
        } else if message.type_ == words.XdndDrop {
            assert!(self.accepts, "what is not taken is not dropped");
            let name = words.XdndSelection;
            self.connection.convert_selection(self.window, name, words.UriList, name, data[2]).expect("a request");
            self.connection.flush().expect("sent");
        }
    }
}

/// The file that a list of one names.
fn path_in(list: &str) -> PathBuf {
    let address = list.strip_suffix("\r\n").and_then(|list| list.strip_prefix("file://")).expect("an address");
    let mut bytes = Vec::new();
    let mut rest = address.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digits = [rest.next(), rest.next()].map(|digit| digit.expect("two digits") as char);
            bytes.push(u8::from_str_radix(&String::from_iter(digits), 16).expect("a number"));
        } else {
            bytes.push(byte);
        }
    }
    PathBuf::from(String::from_utf8(bytes).expect("UTF-8"))
}
