use std::collections::HashMap;
use std::path::Path;
use std::time::{Duration, Instant};

use pyrophone_host::editor::EditorWindow;
use pyrophone_host::numeric_id;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConnectionExt, KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use super::drag_source::Parcel;
use super::{Map, PATIENCE, Picture, TestDisplay};
use crate::flame;
use crate::live::{Clock, Live};

const CONTROL: u32 = 0xffe3;
/// The key that ends typing.
pub const RETURN: u32 = 0xff0d;
/// The key that calls off.
pub const ESCAPE: u32 = 0xff1b;

const BUTTON: u8 = 1;
const RIGHT_BUTTON: u8 = 3;
const WHEEL_UP: u8 = 4;

/// A hand on mouse and keyboard, over a window in the screen's upper left corner, while the plugin plays. Things are called
/// by the names that the window's map has for them.
pub struct UiDriver<'a> {
    connection: RustConnection,
    keycodes: HashMap<u32, u8>,
    desk: &'a TestDisplay,
    /// The window.
    pub window: EditorWindow,
    /// The plugin.
    pub live: &'a mut Live,
    /// Sample that is played next.
    pub position: i64,
    /// What is played, over and over: a bit of fire, so that handles that follow its level stay where they are.
    sound: Vec<Vec<f32>>,
}

impl<'a> UiDriver<'a> {
    /// A hand over a window that is drawn; playing goes on at `position`.
    pub fn new(desk: &'a TestDisplay, window: EditorWindow, live: &'a mut Live, position: i64) -> Self {
        let (connection, _) = x11rb::connect(None).expect("a display");
        let (first, last) = (connection.setup().min_keycode, connection.setup().max_keycode);
        let mapping =
            connection.get_keyboard_mapping(first, last - first + 1).expect("a request").reply().expect("keys");
        let per_key = usize::from(mapping.keysyms_per_keycode);
        let unshifted = mapping.keysyms.chunks_exact(per_key).map(|symbols| symbols[0]);
        let keycodes = unshifted.zip(first..=last).collect();
        Self { connection, keycodes, desk, window, live, position, sound: flame(86, 2, 2205) }
    }

    /// Plays silence from now on.
    pub fn play_silence(&mut self) {
        self.sound.iter_mut().for_each(|channel| channel.fill(0.0));
    }

    fn send(&self, kind: u8, detail: u8, (x, y): (i16, i16)) {
        let root = self.connection.setup().roots[0].root;
        self.connection.xtest_fake_input(kind, detail, 0, root, x, y, 0).expect("a request").check().expect("sent");
    }

    /// Plays, with which changes reach the engines, and lets the window live.
    pub fn pass(&mut self) {
        self.live.play(&self.sound, Clock::Playing(self.position), 512);
        self.position += self.sound[0].len() as i64;
        self.window.run_for(self.live.plugin(), Duration::from_millis(10));
    }

    fn map(&self) -> Map {
        self.desk.map().expect("the window has drawn")
    }

    /// Until what was done is drawn: the frame under way may not know of it.
    pub fn settle(&mut self) {
        let frames = self.map().frames;
        let began = Instant::now();
        while self.map().frames < frames + 2 {
            assert!(began.elapsed() < PATIENCE, "nothing is drawn any more");
            self.pass();
        }
    }

    /// Until something has come true.
    #[track_caller]
    pub fn wait_until(&mut self, what: &str, mut is_true: impl FnMut(&mut Self) -> bool) {
        let began = Instant::now();
        while !is_true(self) {
            if began.elapsed() > PATIENCE {
                self.screenshot("unexpected");
                panic!("{what}: not within {PATIENCE:?}");
            }
            self.pass();
        }
    }

    /// Left, top, right and bottom of something, once it can be seen.
    #[track_caller]
    pub fn place(&mut self, thing: &str) -> [i16; 4] {
        let began = Instant::now();
        loop {
            let map = self.map();
            if let Some(place) = map.things.get(thing) {
                return *place;
            }
            if began.elapsed() > PATIENCE {
                self.screenshot("unexpected");
                panic!("{thing} is not to be seen: {map:?}");
            }
            self.pass();
        }
    }

    /// The middle of something, once it can be seen.
    #[track_caller]
    pub fn middle(&mut self, thing: &str) -> (i16, i16) {
        self.place(thing);
        self.map().middle(thing).expect("seen a moment ago")
    }

    fn go(&mut self, to: (i16, i16)) {
        self.send(MOTION_NOTIFY_EVENT, 0, to);
        self.settle();
    }

    /// Goes to something.
    #[track_caller]
    pub fn go_to(&mut self, thing: &str) {
        let at = self.middle(thing);
        self.go(at);
    }

    /// Goes where nothing answers.
    pub fn go_away(&mut self) {
        self.go((1, 1));
    }

    /// Clicks on something.
    #[track_caller]
    pub fn click(&mut self, thing: &str) {
        self.go_to(thing);
        self.send(BUTTON_PRESS_EVENT, BUTTON, (0, 0));
        self.send(BUTTON_RELEASE_EVENT, BUTTON, (0, 0));
        self.settle();
    }

    /// Clicks on something with the right button.
    #[track_caller]
    pub fn right_click(&mut self, thing: &str) {
        self.go_to(thing);
        self.send(BUTTON_PRESS_EVENT, RIGHT_BUTTON, (0, 0));
        self.send(BUTTON_RELEASE_EVENT, RIGHT_BUTTON, (0, 0));
        self.settle();
    }

    /// Clicks into a field, and waits for the keyboard to be the window's: what is typed before is lost.
    #[track_caller]
    pub fn click_into(&mut self, field: &str) {
        self.click(field);
        (0..3).for_each(|_| self.settle());
    }

    /// Clicks twice on something.
    #[track_caller]
    pub fn double_click(&mut self, thing: &str) {
        self.go_to(thing);
        for kind in [BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT] {
            self.send(kind, BUTTON, (0, 0));
        }
        self.settle();
    }

    /// Turns the wheel by a notch over something.
    #[track_caller]
    pub fn wheel_up(&mut self, thing: &str) {
        self.go_to(thing);
        self.send(BUTTON_PRESS_EVENT, WHEEL_UP, (0, 0));
        self.send(BUTTON_RELEASE_EVENT, WHEEL_UP, (0, 0));
        self.settle();
    }

    /// Drags something; what is pressed and let go within one frame would be no drag.
    #[track_caller]
    pub fn drag(&mut self, thing: &str, by: (i16, i16)) {
        let from = self.middle(thing);
        self.drag_from(from, by);
    }

    /// Drags the corner at the lower right with which the window resizes itself.
    pub fn drag_corner(&mut self, by: (i16, i16)) {
        let (width, height) = self.window.size();
        self.drag_from((width as i16 - 4, height as i16 - 4), by);
    }

    fn drag_from(&mut self, from: (i16, i16), by: (i16, i16)) {
        self.go(from);
        self.send(BUTTON_PRESS_EVENT, BUTTON, (0, 0));
        self.settle();
        for step in 1..=4 {
            self.go((from.0 + by.0 * step / 4, from.1 + by.1 * step / 4));
        }
        self.send(BUTTON_RELEASE_EVENT, BUTTON, (0, 0));
        self.settle();
    }

    /// Takes hold of something, carries it to a place of the screen, and lets go once `meanwhile` is true there.
    #[track_caller]
    pub fn carry(&mut self, thing: &str, to: (i16, i16), what: &str, mut meanwhile: impl FnMut() -> bool) {
        let from = self.middle(thing);
        self.go(from);
        self.send(BUTTON_PRESS_EVENT, BUTTON, (0, 0));
        self.settle();
        for step in 1..=8 {
            let part = |from: i16, to: i16| from + ((i32::from(to) - i32::from(from)) * step / 8) as i16;
            self.send(MOTION_NOTIFY_EVENT, 0, (part(from.0, to.0), part(from.1, to.1)));
            self.pass();
        }
        self.wait_until(what, |_| meanwhile());
        self.send(BUTTON_RELEASE_EVENT, BUTTON, (0, 0));
        self.pass();
    }

    /// Presses a key.
    pub fn press(&mut self, symbol: u32) {
        self.strike(symbol);
        self.settle();
    }

    fn strike(&self, symbol: u32) {
        let code = self.keycodes[&symbol];
        self.send(KEY_PRESS_EVENT, code, (0, 0));
        self.send(KEY_RELEASE_EVENT, code, (0, 0));
    }

    /// Types what needs no Shift.
    pub fn write(&mut self, text: &str) {
        text.bytes().for_each(|byte| self.strike(u32::from(byte)));
        self.settle();
    }

    /// Presses a letter with Control.
    pub fn with_control(&mut self, letter: u8) {
        let code = self.keycodes[&CONTROL];
        self.send(KEY_PRESS_EVENT, code, (0, 0));
        self.strike(u32::from(letter));
        self.send(KEY_RELEASE_EVENT, code, (0, 0));
        self.settle();
    }

    /// Drops a file on something, from a window of another program.
    #[track_caller]
    pub fn drop_file(&mut self, path: &Path, thing: &str) {
        let at = self.middle(thing);
        let mut parcel = Parcel::new(path, &self.window, at);
        self.wait_until("the file is taken", |_| parcel.is_taken());
    }

    /// The text of a parameter's value.
    pub fn text(&mut self, id: &str) -> String {
        // A change takes its way through the queue of the host.
        self.pass();
        let id = numeric_id(id);
        let value = self.live.plugin().value(id).expect("a value");
        self.live.plugin().text(id, value).expect("a text")
    }

    /// A parameter's value in its own unit.
    pub fn value(&mut self, id: &str) -> f64 {
        let text = self.text(id);
        text.split_whitespace().next().expect("a number").parse().unwrap_or_else(|_| panic!("{text}"))
    }

    /// The value once it is as expected, and not only on its way.
    #[track_caller]
    pub fn expect(&mut self, id: &str, what: &str, is_expected: impl Fn(f64) -> bool) -> f64 {
        let began = Instant::now();
        loop {
            let value = self.value(id);
            if is_expected(value) {
                self.settle();
                if self.value(id) == value {
                    return value;
                }
            }
            if began.elapsed() > PATIENCE {
                self.screenshot("unexpected");
                panic!("{what}: {id} is {value}");
            }
        }
    }

    /// Does what may be lost between two frames of a busy machine, several times if need be.
    pub fn try_often(&mut self, id: &str, what: impl Fn(&mut Self), until: impl Fn(f64) -> bool) {
        for _ in 0..5 {
            what(self);
            for _ in 0..3 {
                if until(self.value(id)) {
                    return;
                }
                self.settle();
            }
        }
    }

    /// Keeps a picture of the window.
    pub fn screenshot(&self, name: &str) -> Picture {
        TestDisplay::screenshot(&self.window, name)
    }

    /// Resizes the window as its user does by the host's frame, and waits until all of it is drawn.
    #[track_caller]
    pub fn resize(&mut self, size: (u32, u32)) {
        self.window.resize(self.live.plugin(), size).unwrap_or_else(|error| panic!("{error}"));
        self.wait_for_size(size);
    }

    /// Waits until the window has this size and all of it is drawn.
    #[track_caller]
    pub fn wait_for_size(&mut self, size: (u32, u32)) {
        self.wait_until(&format!("a window of {size:?}"), |hand| {
            hand.window.size() == size && hand.map().size == size && Picture::of_window(&hand.window).is_drawn()
        });
        self.settle();
    }
}
