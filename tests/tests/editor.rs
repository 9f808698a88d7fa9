//! The editor in a host's window: it opens, draws, resizes, follows mouse and keyboard, takes files, closes and opens again.

use std::time::Duration;

use pyrophone_host::editor::EditorWindow;
use pyrophone_host::state::State;
use pyrophone_host::{Configuration, Format, Plugin};
use pyrophone_settings::Preset;
use pyrophone_settings::session::FIELD;
use pyrophone_tests::desk::{ESCAPE, RETURN, SCREEN, TestDisplay, UiDriver};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    RATE_HZ, STEREO, await_recording, flame, is_soak, load_session, open, peak, preset, recording, session, wait_until,
};

/// The smallest size there is, and one that the screen has room for.
const SMALL: (u32, u32) = (700, 450);
const LARGE: (u32, u32) = (SCREEN.0 - 10, SCREEN.1 - 10);

#[test]
fn does_all_that_a_hand_can_do() {
    let Some(desk) = TestDisplay::set_up() else { return };
    let chosen = recording(desk.folder(), "embers.wav", 1, 90_000);
    std::fs::rename(chosen, desk.dialog_answer()).expect("moved");
    for format in Format::ALL {
        try_format(&desk, format);
    }
}

fn try_format(desk: &TestDisplay, format: Format) {
    let path = recording(desk.folder(), "campfire.wav", 2, 150_000);
    let mut plugin = open(format);
    // Extension sounds, so that its parameters have an effect and can be dragged.
    load_session(plugin.as_mut(), &preset("default", &[("extension_level", "-12")]), &session(Some(&path), None));
    await_recording(plugin.as_mut(), RATE_HZ, STEREO);
    let mut live = Live::start(plugin, RATE_HZ, STEREO);
    let input = flame(81, 2, 4096);

    let (mut position, first_size) = (0, (1100, 790));
    let mut play = |player: &mut pyrophone_tests::live::Player| {
        let output = player.play(&input, Clock::Playing(position), 512);
        assert!(peak(&output[0]).is_finite());
        position += 4096;
    };
    let (plugin, player) = live.halves();
    let window = desk.open_drawn(plugin, || play(player));
    assert_eq!(window.size(), first_size);
    // Until there is something to be seen of what it plays.
    for _ in 0..20 {
        play(live.halves().1);
    }
    let mut hand = UiDriver::new(desk, window, &mut live, position);
    hand.settle();
    hand.screenshot(&format!("{format}-opened"));
    try_play(&mut hand, format);
    hand.click("button.Engines");
    try_knob_and_values(&mut hand, format);
    // What no host has a part in is the same in both formats: once in every run, twice in the long tests.
    let is_thorough = format == Format::ALL[0] || is_soak();
    if is_thorough {
        try_handles(&mut hand, format);
        try_switches(&mut hand);
    }
    if format == Format::ALL[0] {
        try_saving(&mut hand, desk);
        try_recording_with_preset(&mut hand, desk);
    }
    try_preset(&mut hand, format);
    try_files(&mut hand, desk, format);
    if is_thorough {
        try_part(&mut hand, format);
        try_listening(&mut hand, desk, format);
    }
    try_sizes(&mut hand, desk, format);
    let UiDriver { window, .. } = hand;
    window.close(live.plugin());

    // It has the size again that it had, and all that is heard of it.
    let (plugin, player) = live.halves();
    let mut at = position;
    let mut play = || {
        player.play(&input, Clock::Playing(at), 512);
        at += 4096;
    };
    let mut window = desk.open_drawn(plugin, &mut play);
    assert_eq!(window.size(), LARGE, "{format}: a window remembers its size");
    window.resize(plugin, SMALL).expect("as small as it goes");
    await_size(desk, &mut window, plugin, &mut play, SMALL);
    window.close(plugin);
    if desk.scale_screen(1.5) {
        let window = desk.open_drawn(plugin, &mut play);
        let scaled = (SMALL.0 * 3 / 2, SMALL.1 * 3 / 2);
        assert_eq!(window.size(), scaled, "{format}: as large on a screen with smaller pixels");
        assert_eq!(desk.map().map(|map| map.size), Some(scaled), "{format}");
        TestDisplay::screenshot(&window, &format!("{format}-scaled"));
        window.close(plugin);
        desk.scale_screen(0.0);
        for _ in 0..2 {
            let mut window = desk.open_drawn(plugin, &mut play);
            window.scale(plugin, 1.5).unwrap_or_else(|error| panic!("{format}: {error}"));
            assert_eq!(window.size(), scaled, "{format}: where the host tells of smaller pixels");
            await_size(desk, &mut window, plugin, &mut play, scaled);
            window.close(plugin);
        }
    }
    // It outlives its editor, and changes its state while that is open.
    let mut plugin = live.stop();
    let window = desk.open_drawn(plugin.as_mut(), || {});
    let configuration = Configuration { sample_rate: 48_000.0, max_block: 512, layout: STEREO, offline: false };
    let processor = plugin.activate(&configuration).expect("active with its editor open");
    plugin.deactivate(processor).expect("inactive");
    window.close(plugin.as_mut());
}

/// Plays until the window is drawn in this size.
fn await_size(
    desk: &TestDisplay,
    window: &mut EditorWindow,
    plugin: &mut dyn Plugin,
    mut play: impl FnMut(),
    size: (u32, u32),
) {
    wait_until(&format!("a window of {size:?}"), || {
        play();
        window.run_for(plugin, Duration::from_millis(20));
        desk.map().is_some_and(|map| map.size == size)
    });
}

/// Macros, faders, the pad and takes on the first page.
fn try_play(hand: &mut UiDriver<'_>, format: Format) {
    hand.try_often("macro_size", |hand| hand.drag("knob.macro_size", (0, -40)), |x| x != 0.0);
    hand.expect("macro_size", "dragged", |x| x > 20.0);
    hand.click("button.Undo");
    hand.expect("macro_size", "undone", |x| x == 0.0);
    hand.click_into("value.macro_hiss");
    hand.write("250");
    hand.press(RETURN);
    hand.expect("macro_hiss", "typed beyond its end", |x| x == 100.0);
    hand.screenshot(&format!("{format}-beyond-the-end"));
    let output = hand.value("output_level");
    hand.try_often("output_level", |hand| hand.drag("fader.output_level", (0, 30)), |x| x != output);
    hand.expect("output_level", "pulled down", |x| x < output - 3.0);
    hand.try_often("macro_fury", |hand| hand.drag("pad", (20, -20)), |x| x != 0.0);
    hand.expect("macro_fury", "moved on the pad", |x| x > 0.0);
    hand.expect("macro_crackle", "moved on the pad", |x| x > 0.0);
    hand.click("button.New take");
    hand.expect("take", "a new one", |x| x > 0.0);
    hand.settle();
    hand.screenshot(&format!("{format}-played"));
    hand.click("take.0");
    hand.expect("take", "as set", |x| x == 0.0);
    hand.click("button.Built-in");
    hand.wait_until("a flame", |hand| hand.text("drive_mode") == "flame");
    (0..60).for_each(|_| hand.pass());
    hand.screenshot(&format!("{format}-built-in"));
    hand.click("button.Track");
    hand.wait_until("the track", |hand| hand.text("drive_mode") == "pressure");
}

fn type_alpha(hand: &mut UiDriver<'_>, text: &str) {
    hand.click_into("value.alpha");
    hand.write(text);
    hand.press(RETURN);
}

fn try_knob_and_values(hand: &mut UiDriver<'_>, format: Format) {
    let alpha = hand.value("alpha");
    let place = hand.place("knob.alpha");
    hand.go_away();
    let before = hand.screenshot(&format!("{format}-before"));
    hand.try_often("alpha", |hand| hand.drag("knob.alpha", (0, -60)), |x| x != alpha);
    let turned = hand.expect("alpha", "dragged", |x| x > alpha + 1.0);
    hand.go_away();
    let after = hand.screenshot(&format!("{format}-knob-dragged"));
    let moved = after.differing(&before, place);
    assert!(moved > 30, "{format}: the knob is drawn where it was: {moved} pixels differ");
    hand.try_often("alpha", |hand| hand.wheel_up("knob.alpha"), |x| x != turned);
    hand.expect("alpha", "wheeled", |x| x > turned && x < turned + 0.3);
    hand.click("button.Undo");
    hand.expect("alpha", "undone", |x| x == turned);
    hand.with_control(b'z');
    hand.expect("alpha", "undone by key", |x| x == alpha);
    hand.click("button.Redo");
    hand.expect("alpha", "done again", |x| x == turned);

    type_alpha(hand, "3.25");
    hand.expect("alpha", "typed", |x| x == 3.25);
    hand.screenshot(&format!("{format}-value-typed"));
    hand.click("button.B");
    type_alpha(hand, "1.5");
    hand.expect("alpha", "B, typed", |x| x == 1.5);
    hand.click("button.A");
    hand.expect("alpha", "A", |x| x == 3.25);
    hand.click("button.B");
    hand.expect("alpha", "B", |x| x == 1.5);
    hand.try_often("alpha", |hand| hand.double_click("knob.alpha"), |x| x == 2.5);
    hand.expect("alpha", "double click", |x| x == 2.5);
}

fn try_handles(hand: &mut UiDriver<'_>, format: Format) {
    let cutoff = hand.value("cutoff");
    hand.try_often("cutoff", |hand| hand.drag("handle.cutoff", (60, 0)), |x| x != cutoff);
    hand.expect("cutoff", "dragged", |x| x > 1.5 * cutoff && x < 6.0 * cutoff);
    hand.screenshot(&format!("{format}-cutoff-dragged"));
    hand.try_often("alpha", |hand| hand.drag("handle.alpha", (0, 40)), |x| x != 2.5);
    hand.expect("alpha", "slope dragged", |x| x > 2.6);
    hand.screenshot(&format!("{format}-alpha-dragged"));
}

fn try_switches(hand: &mut UiDriver<'_>) {
    for expected in ["on", "off"] {
        hand.click("button.Bypass");
        hand.wait_until("bypass", |hand| hand.text("bypass") == expected);
    }
}

/// Searching and choosing.
fn try_preset(hand: &mut UiDriver<'_>, format: Format) {
    hand.click_into("button.Presets");
    hand.screenshot(&format!("{format}-presets"));
    hand.write("extend");
    hand.screenshot(&format!("{format}-presets-searched"));
    hand.press(RETURN);
    hand.wait_until("a preset", |hand| hand.text("texture_level") == "off");
    hand.expect("alpha", "a preset", |x| x == 2.5);
    hand.press(ESCAPE);
    hand.click("button.Setup");
    hand.screenshot(&format!("{format}-setup"));
    hand.click("button.Space");
    hand.screenshot(&format!("{format}-space"));
    hand.click("button.Engines");
    hand.place("knob.alpha");
}

/// Saving under a new name, and not replacing what is there; the folder is empty at first.
fn try_saving(hand: &mut UiDriver<'_>, desk: &TestDisplay) {
    let folder = desk.presets();
    let files = || {
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    let set = Preset::find("extend").expect("a preset").values;
    hand.click_into("button.Presets");
    hand.write("extend");
    hand.press(RETURN);
    hand.wait_until("a preset", |hand| hand.text("texture_level") == "off");
    // The field has the name of what was chosen.
    hand.click_into("field.Preset name");
    hand.with_control(b'a');
    hand.write("mine");
    hand.press(RETURN);
    hand.wait_until("a file", |_| files() == ["mine.toml"]);
    let saved = Preset::find("mine").expect("the command line finds it too");
    assert_eq!(saved.name, "mine");
    assert_eq!(saved.values, set);
    hand.settle();
    hand.screenshot("preset-saved");
    // There is one of that name now: the first press only asks.
    let file = folder.join("mine.toml");
    let written = || std::fs::metadata(&file).and_then(|metadata| metadata.modified()).expect("a time");
    let before = written();
    hand.click_into("field.Preset name");
    hand.press(RETURN);
    (0..3).for_each(|_| hand.settle());
    hand.screenshot("preset-exists");
    hand.press(ESCAPE);
    assert_eq!(files(), ["mine.toml"]);
    assert_eq!(written(), before, "nothing is replaced unasked");
}

/// A preset saved with its recording brings it back, as one step with its values.
fn try_recording_with_preset(hand: &mut UiDriver<'_>, desk: &TestDisplay) {
    let file = desk.presets().join("with fire.toml");
    hand.click_into("button.Presets");
    hand.click_into("field.Preset name");
    hand.with_control(b'a');
    hand.write("with fire");
    hand.click("toggle.With recording");
    hand.click("button.Save");
    hand.wait_until("a file", |_| file.exists());
    hand.settle();
    hand.screenshot("preset-with-recording");
    hand.press(ESCAPE);
    let saved = Preset::load(&file).expect("a preset").recording.expect("its recording");
    assert!(saved.file.ends_with("campfire.wav"), "{}", saved.file.display());

    let other = recording(desk.folder(), "other.wav", 1, 70_000);
    hand.drop_file(&other, "handle.cutoff");
    hand.wait_until("another recording", |hand| session_recording(hand).contains("other.wav"));
    hand.click_into("button.Presets");
    hand.write("with fire");
    hand.press(RETURN);
    hand.wait_until("the preset's recording", |hand| session_recording(hand).contains("campfire.wav"));
    hand.press(ESCAPE);
    hand.click("button.Undo");
    hand.wait_until("the other recording", |hand| session_recording(hand).contains("other.wav"));
    hand.click("button.Redo");
    hand.wait_until("the preset's recording again", |hand| session_recording(hand).contains("campfire.wav"));
}

/// The path of the recording in the session that the host would save.
fn session_recording(hand: &mut UiDriver<'_>) -> String {
    let bytes = hand.live.plugin().state().expect("a state");
    let state = State::from_bytes(hand.live.plugin().format(), &bytes).expect("a state of this plugin");
    state.fields[FIELD].clone()
}

/// A recording chosen in the system's dialog, and one that is dropped on the window.
fn try_files(hand: &mut UiDriver<'_>, desk: &TestDisplay, format: Format) {
    assert!(session_recording(hand).contains("campfire.wav"));
    hand.click("button.Load recording");
    hand.wait_until("what the dialog told", |hand| session_recording(hand).contains("chosen in the dialog.wav"));
    hand.settle();
    hand.screenshot(&format!("{format}-file-chosen"));
    let dropped = recording(desk.folder(), "bonfire, 100 % dry.wav", 1, 70_000);
    hand.drop_file(&dropped, "handle.cutoff");
    hand.wait_until("what was dropped", |hand| session_recording(hand).contains("bonfire, 100 % dry.wav"));
    hand.settle();
    hand.screenshot(&format!("{format}-file-dropped"));
}

/// The part of the recording that is learnt from, by mouse and by numbers.
fn try_part(hand: &mut UiDriver<'_>, format: Format) {
    hand.drag("region", (70, 0));
    hand.wait_until("a part of the recording", |hand| session_recording(hand).contains("region_s"));
    hand.settle();
    hand.screenshot(&format!("{format}-part"));
    hand.click_into("number.Gain");
    hand.with_control(b'a');
    hand.write("-6");
    hand.press(RETURN);
    hand.wait_until("a gain", |hand| session_recording(hand).contains("gain_db\\\":-6.0"));
    hand.double_click("region");
    hand.wait_until("all of it", |hand| !session_recording(hand).contains("region_s"));
}

/// Hearing one sound alone, a burst, learning from a file, and saving what was played.
fn try_listening(hand: &mut UiDriver<'_>, desk: &TestDisplay, format: Format) {
    hand.click("button.Hear rec.");
    hand.click("button.Burst");
    (0..20).for_each(|_| hand.pass());
    hand.screenshot(&format!("{format}-listening"));
    hand.click("button.Hear output");
    hand.click("button.Learn from file");
    hand.wait_until("a learned drive", |hand| session_recording(hand).contains("quantiles"));
    let (answer, original) = (desk.dialog_answer(), desk.folder().join("original.wav"));
    std::fs::copy(&answer, &original).expect("copied");
    hand.click("button.Record");
    hand.click("button.Burst");
    (0..80).for_each(|_| hand.pass());
    hand.click("button.Record");
    hand.click("button.Save sound");
    hand.screenshot(&format!("{format}-saving"));
    hand.click("button.Save output");
    let taken = || pyrophone_recording::decode(&answer, &|_| true).ok().filter(|taken| taken.channels.len() == 2);
    hand.wait_until("a file with what was played", |_| taken().is_some());
    let taken = taken().expect("just seen");
    assert!(taken.duration_s() > 0.5 && peak(&taken.channels[0]) > 1e-4, "{format}: the burst is in it");
    std::fs::rename(original, answer).expect("put back");
}

/// The user's own scale, which makes the window larger with all that is in it, and the folder of presets beside it.
fn try_scale(hand: &mut UiDriver<'_>, desk: &TestDisplay, format: Format) {
    hand.click("button.Setup");
    hand.place("field.Presets folder");
    hand.click("scale");
    hand.click("scale.150");
    hand.wait_for_size((SMALL.0 * 3 / 2, SMALL.1 * 3 / 2));
    hand.screenshot(&format!("{format}-user-scale"));
    let kept = || std::fs::read_to_string(desk.presets().join("window-scale.txt")).unwrap_or_default();
    hand.wait_until("a scale that is kept", |_| kept() == "150\n");
    hand.click("scale");
    hand.click("scale.100");
    hand.wait_for_size(SMALL);
    hand.wait_until("the usual scale", |_| kept() == "100\n");
    hand.click("button.Engines");
}

/// Sizes by the host's frame, down to the smallest, and by the corner that the window draws itself.
fn try_sizes(hand: &mut UiDriver<'_>, desk: &TestDisplay, format: Format) {
    hand.resize(SMALL);
    hand.screenshot(&format!("{format}-small"));
    try_scale(hand, desk, format);
    hand.window.resize(hand.live.plugin(), (200, 100)).expect("as small as it goes");
    hand.wait_for_size(SMALL);
    hand.drag_corner((200, 150));
    let near = |length: u32, expected: u32| length.abs_diff(expected) < 12;
    hand.wait_until("a window of the size that its corner was dragged to", |hand| {
        let (width, height) = hand.window.size();
        near(width, SMALL.0 + 200) && near(height, SMALL.1 + 150)
    });
    let dragged = hand.window.size();
    hand.wait_for_size(dragged);
    hand.screenshot(&format!("{format}-corner-dragged"));
    hand.resize(LARGE);
    hand.screenshot(&format!("{format}-large"));
    let alpha = hand.value("alpha");
    hand.try_often("alpha", |hand| hand.drag("knob.alpha", (0, -40)), |x| x != alpha);
    hand.expect("alpha", "dragged in a large window", |x| x > alpha);
}
