//! The first fire, slots, the blend and the page of space in the editor's window.

use pyrophone_host::Format;
use pyrophone_host::state::State;
use pyrophone_settings::session::FIELD;
use pyrophone_tests::desk::{TestDisplay, UiDriver};
use pyrophone_tests::live::Live;
use pyrophone_tests::{RATE_HZ, STEREO, await_recording, load_session, open, preset, recording, session};

fn saved(hand: &mut UiDriver<'_>) -> String {
    let plugin = hand.live.plugin();
    let state = State::from_bytes(plugin.format(), &plugin.state().expect("a state")).expect("a state of this plug-in");
    state.fields[FIELD].clone()
}

#[test]
fn slots_are_filled_switched_and_blended_by_hand() {
    let Some(desk) = TestDisplay::set_up() else { return };
    let (first, second) =
        (recording(desk.folder(), "campfire.wav", 2, 100_000), recording(desk.folder(), "embers.wav", 1, 80_000));
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&first), None));
        await_recording(plugin.as_mut(), RATE_HZ, STEREO);
        let mut live = Live::start(plugin, RATE_HZ, STEREO);
        let window = desk.open_drawn(live.plugin(), || {});
        let mut hand = UiDriver::new(&desk, window, &mut live, 0);
        hand.resize((1100, 790));
        hand.screenshot(&format!("{format}-slots"));

        // Nothing to blend with yet.
        hand.drag("slider.recording_blend", (60, 0));
        hand.expect("recording_blend", "there is no second recording", |x| x == 0.0);

        hand.click("button.Slot 2");
        hand.wait_until("the second slot", |hand| hand.text("recording_slot") == "2");
        hand.drop_file(&second, "button.Slot 2");
        hand.wait_until("what was dropped", |hand| saved(hand).contains("embers.wav"));
        assert!(saved(&mut hand).contains("campfire.wav"), "{format}: the first slot keeps its own");
        hand.click("button.Slot 1");
        hand.wait_until("the first slot", |hand| hand.text("recording_slot") == "1");
        (0..20).for_each(|_| hand.pass());
        hand.try_often("recording_blend", |hand| hand.drag("slider.recording_blend", (50, 0)), |x| x > 0.0);
        hand.expect("recording_blend", "dragged", |x| x > 15.0);
        hand.settle();
        hand.screenshot(&format!("{format}-blended"));
        hand.click("button.Undo");
        hand.expect("recording_blend", "undone", |x| x == 0.0);

        hand.click("button.Space");
        hand.wait_until("vortex sound", |hand| {
            let id = pyrophone_host::numeric_id("vortex_level");
            let value = hand.live.plugin().parse(id, "-6").expect("a level");
            hand.live.plugin().set_value(id, value).expect("set");
            hand.text("vortex_level").starts_with("-6")
        });
        (0..40).for_each(|_| hand.pass());
        hand.screenshot(&format!("{format}-space-sounding"));
        hand.try_often("vortex_azimuth", |hand| hand.drag("handle.space", (60, 0)), |x| x != 0.0);
        hand.expect("vortex_azimuth", "dragged to the right", |x| x > 5.0 && x < 90.0);
        hand.settle();
        hand.screenshot(&format!("{format}-space-dragged"));
        let UiDriver { window, .. } = hand;
        window.close(live.plugin());
    }
}

#[test]
fn first_fire_is_lit_and_another_one_comes_from_the_library() {
    let Some(desk) = TestDisplay::set_up() else { return };
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &session(None, None));
        let mut live = Live::start(plugin, RATE_HZ, STEREO);
        let window = desk.open_drawn(live.plugin(), || {});
        let mut hand = UiDriver::new(&desk, window, &mut live, 0);
        hand.play_silence();

        hand.click("button.Light");
        hand.wait_until("the preset that needs no recording", |hand| hand.text("fuel") == "dry wood");
        hand.wait_until("the flame", |hand| hand.text("drive_mode") == "flame");
        (0..40).for_each(|_| hand.pass());
        hand.screenshot(&format!("{format}-lit"));
        hand.click("button.Undo");
        hand.wait_until("as it was", |hand| hand.text("fuel") == "off");
        hand.wait_until("the track", |hand| hand.text("drive_mode") == "pressure");

        hand.click("button.Library");
        hand.go_to("library.Grass fire");
        hand.screenshot(&format!("{format}-library"));
        hand.click("library.Grass fire");
        hand.wait_until("the factory fire", |hand| saved(hand).contains("factory:grass-fire"));
        hand.place("recording.Grass fire (factory): 24.0 s, 48 kHz, stereo");
        hand.screenshot(&format!("{format}-factory-fire"));
        // Now there is something to hear with the flame, so it stays.
        hand.click("button.Light");
        hand.wait_until("the flame", |hand| hand.text("drive_mode") == "flame");
        assert_eq!(hand.text("fuel"), "off", "{format}");
        let UiDriver { window, .. } = hand;
        let state = live.plugin().state().expect("a state");
        window.close(live.plugin());

        // A session that names it finds it, without any file.
        let mut again = open(format);
        again.set_state(&state).expect("a session");
        await_recording(again.as_mut(), RATE_HZ, STEREO);
        let mut live = Live::start(again, RATE_HZ, STEREO);
        let window = desk.open_drawn(live.plugin(), || {});
        let mut hand = UiDriver::new(&desk, window, &mut live, 0);
        hand.place("recording.Grass fire (factory): 24.0 s, 48 kHz, stereo");
        let UiDriver { window, .. } = hand;
        window.close(live.plugin());
    }
}
