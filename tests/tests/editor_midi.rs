//! MIDI learn in the editor's window: right click, move a controller, and the parameter follows it from then on; the list on
//! the Setup page says what moves what, and removes it.

use std::path::Path;

use pyrophone_host::state::State;
use pyrophone_host::{ControllerMessage, Format};
use pyrophone_tests::desk::{ESCAPE, TestDisplay, UiDriver};
use pyrophone_tests::live::Live;
use pyrophone_tests::{RATE_HZ, STEREO, load_session, open, preset, session};

fn controllers(hand: &mut UiDriver<'_>) -> String {
    let plugin = hand.live.plugin();
    let state = State::from_bytes(plugin.format(), &plugin.state().expect("a state")).expect("a state of this plug-in");
    state.fields["controllers"].clone()
}

fn turn(hand: &mut UiDriver<'_>, controller: u8, position: u8) {
    hand.live.move_controllers(&[ControllerMessage { offset: 3, channel: 0, controller, position }]);
    hand.pass();
    hand.live.plugin().take_reported_values();
}

#[test]
fn a_right_click_learns_a_controller_for_this_session_and_those_to_come() {
    let Some(desk) = TestDisplay::set_up() else { return };
    let file = desk.presets().join("midi-controllers.txt");
    for format in Format::ALL {
        // What the other format has left.
        let _ = std::fs::remove_file(&file);
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &session(None, None));
        let mut live = Live::start(plugin, RATE_HZ, STEREO);
        let window = desk.open_drawn(live.plugin(), || {});
        let mut hand = UiDriver::new(&desk, window, &mut live, 0);
        turn(&mut hand, 21, 100);
        hand.expect("macro_size", "no controller moves it yet", |x| x == 0.0);

        hand.right_click("knob.macro_size");
        hand.screenshot(&format!("{format}-midi-menu"));
        hand.click("menu.Learn");
        hand.place("learning");
        hand.screenshot(&format!("{format}-midi-learning"));
        hand.press(ESCAPE);
        turn(&mut hand, 21, 100);
        assert_eq!(controllers(&mut hand), "{}", "{format}: called off");

        hand.right_click("knob.macro_size");
        hand.click("menu.Learn");
        hand.place("learning");
        turn(&mut hand, 21, 127);
        hand.expect("macro_size", "it follows", |x| x == 100.0);
        assert_eq!(controllers(&mut hand), r#"{"macro_size":21}"#, "{format}");
        hand.wait_until("kept", |_| std::fs::read_to_string(&file).is_ok_and(|text| text == "macro_size 21\n"));
        turn(&mut hand, 21, 0);
        hand.expect("macro_size", "it goes on following", |x| x == -100.0);
        hand.settle();
        hand.screenshot(&format!("{format}-midi-learnt"));
        let mut fresh = open(format);
        let state = State::from_bytes(format, &fresh.state().expect("a state")).expect("a state of this plug-in");
        assert_eq!(state.fields["controllers"], r#"{"macro_size":21}"#, "{format}: a new instance has it");
        drop(fresh);

        hand.right_click("knob.macro_size");
        hand.click("menu.Forget");
        hand.wait_until("forgotten", |_| std::fs::read_to_string(&file).is_ok_and(|text| text.is_empty()));
        turn(&mut hand, 21, 64);
        hand.expect("macro_size", "it stays", |x| x == -100.0);
        let UiDriver { window, .. } = hand;
        window.close(live.plugin());
        try_list(&desk, format, &file);
    }
}

/// The session and the file agree on one controller, and each has one that the other has not.
fn try_list(desk: &TestDisplay, format: Format, file: &Path) {
    // No window is open, so that nobody else writes it.
    let _ = std::fs::remove_file(file);
    let mut plugin = open(format);
    let mut state = State::from_bytes(format, &plugin.state().expect("a state")).expect("a state of this plug-in");
    state.fields.insert("controllers".to_owned(), r#"{"macro_fury":22,"macro_size":21}"#.to_owned());
    plugin.set_state(&state.to_bytes(format).expect("a state")).expect("taken");
    std::fs::write(file, "macro_hiss 30\nmacro_size 21\n").expect("written");
    let mut live = Live::start(plugin, RATE_HZ, STEREO);
    let window = desk.open_drawn(live.plugin(), || {});
    let mut hand = UiDriver::new(desk, window, &mut live, 0);
    let text = || std::fs::read_to_string(file).expect("there");

    hand.click("button.Setup");
    for line in ["midi.21.macro_size", "midi.22.macro_fury", "midi.30.macro_hiss"] {
        hand.place(line);
    }
    hand.screenshot(&format!("{format}-midi-list"));
    hand.click("button.remove.22.macro_fury");
    assert_eq!(controllers(&mut hand), r#"{"macro_size":21}"#, "{format}");
    hand.click("button.remove.30.macro_hiss");
    hand.wait_until("the file forgets it", |_| text() == "macro_size 21\n");
    assert_eq!(controllers(&mut hand), r#"{"macro_size":21}"#, "{format}: the session's own stays");
    hand.click("button.Remove all");
    assert_eq!((controllers(&mut hand).as_str(), text().as_str()), (r#"{"macro_size":21}"#, "macro_size 21\n"));
    // On a busy machine the button may have stopped asking before the second click, which then asks again.
    for _ in 0..3 {
        hand.click("button.Remove all");
        if text().is_empty() {
            break;
        }
    }
    hand.wait_until("the file is empty", |_| text().is_empty());
    assert_eq!(controllers(&mut hand), "{}", "{format}");
    turn(&mut hand, 21, 127);
    hand.expect("macro_size", "nothing moves it", |x| x == 0.0);
    let UiDriver { window, .. } = hand;
    window.close(live.plugin());
}
