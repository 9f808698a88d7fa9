//! What assistive technology would be told of the window, if the toolkit handed it over: every parameter by name, with its value;
//! and what keys do without a pointer.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use crate::playing::{Playing, RATE_HZ};
use crate::screen::Screen;
use egui::accesskit::Role;
use egui::{Key, Vec2};
use nice_plug::prelude::Plugin;
use pyrophone::Pyrophone;
use pyrophone::editor::controls::Page;
use pyrophone::persist;
use pyrophone_settings::session::FIELD;
use pyrophone_settings::{Id, PARAMETERS, ParameterKind};

/// Tall enough that no page scrolls.
const SIZE: Vec2 = Vec2::new(1600.0, 3000.0);

/// Names and values of all controls of this kind on all pages.
fn controls(screen: &mut Screen, role: Role) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for page in Page::ALL {
        screen.turn_to(page, SIZE, 1.0);
        (0..3).for_each(|_| drop(screen.draw()));
        let nodes = screen.tree().nodes;
        let named = nodes.iter().map(|(_, node)| node).filter(|node| node.role() == role);
        found.extend(
            named.filter_map(|node| Some((node.label()?.to_owned(), node.value().unwrap_or_default().to_owned()))),
        );
    }
    found
}

#[test]
fn every_parameter_is_named_and_has_a_value() {
    let plugin = Pyrophone::default();
    let mut screen = Screen::new(plugin.window());
    let [sliders, values, lists, switches, lines] =
        [Role::Slider, Role::SpinButton, Role::ComboBox, Role::CheckBox, Role::RadioButton]
            .map(|role| controls(&mut screen, role));
    // A button in the head of the window, and a list of takes.
    assert!(controls(&mut screen, Role::Button).contains_key("Bypass") && lines.contains_key("As set, own seeds"));
    let mut missing = vec![];
    for parameter in PARAMETERS.iter().filter(|parameter| !["bypass", "take"].contains(&parameter.id)) {
        let value = parameter.to_text(parameter.default_value());
        let found = match parameter.kind {
            ParameterKind::Choice { .. } => lists.get(parameter.name).cloned(),
            ParameterKind::Toggle { .. } => switches.get(parameter.name).map(|_| value.clone()),
            _ => sliders.get(parameter.name).or_else(|| values.get(parameter.name)).cloned(),
        };
        if found.as_ref() != Some(&value) {
            missing.push(format!("{}: {found:?} instead of {value}", parameter.id));
        }
    }
    assert!(missing.is_empty(), "not told by name and value:\n{}", missing.join("\n"));
}

#[test]
fn menu_of_a_parameter_opens_and_closes_by_keys() {
    let plugin = Pyrophone::default();
    let mut screen = Screen::new(plugin.window());
    screen.turn_to(Page::Play, SIZE, 1.0);
    (0..3).for_each(|_| drop(screen.draw()));
    let focused = |screen: &mut Screen| {
        let tree = screen.tree();
        tree.nodes.into_iter().find(|(id, _)| *id == tree.focus).map(|(_, node)| node)
    };
    let is_slider = |screen: &mut Screen| {
        screen.press(Key::Tab);
        focused(screen).is_some_and(|node| node.role() == Role::Slider)
    };
    assert!((0..100).any(|_| is_slider(&mut screen)), "Tab reaches a knob");
    let learns = |screen: &mut Screen| screen.tree().nodes.iter().any(|(_, node)| node.label() == Some("MIDI learn"));
    assert!(!learns(&mut screen));
    screen.press(Key::M);
    assert!(learns(&mut screen), "the menu is open");
    let line = focused(&mut screen).and_then(|node| node.label().map(str::to_owned));
    assert!(line.as_ref().is_some_and(|line| line.starts_with("Reset to")), "the focus is in it: {line:?}");
    screen.press(Key::Escape);
    screen.draw();
    assert!(!learns(&mut screen), "the menu is closed");
}

/// Name and value of the focused control.
fn focused(screen: &mut Screen) -> Option<(String, String)> {
    let tree = screen.tree();
    let node = tree.nodes.into_iter().find(|(id, _)| *id == tree.focus).map(|(_, node)| node)?;
    Some((node.label()?.to_owned(), node.value().unwrap_or_default().to_owned()))
}

/// Presses Tab until the control with this name has the focus.
#[track_caller]
fn reach(screen: &mut Screen, name: &str) {
    let is_reached = |screen: &mut Screen| {
        screen.press(Key::Tab);
        focused(screen).is_some_and(|(found, _)| found == name)
    };
    assert!((0..200).any(|_| is_reached(screen)), "Tab does not reach {name}");
    // The arrow keys are the control's from the second frame on.
    (0..2).for_each(|_| drop(screen.draw()));
}

#[test]
fn pad_is_moved_by_arrow_keys() {
    let plugin = Pyrophone::default();
    let mut screen = Screen::obeyed(plugin.window());
    screen.turn_to(Page::Play, SIZE, 1.0);
    (0..3).for_each(|_| drop(screen.draw()));
    reach(&mut screen, "Fury and Crackle");
    let macros = || [Id::MacroFury, Id::MacroCrackle].map(|id| plugin.effect_params().value(id as usize));
    [Key::ArrowRight, Key::ArrowRight, Key::ArrowUp].into_iter().for_each(|key| screen.press(key));
    assert_eq!(macros().map(f64::round), [8.0, 4.0]);
    [Key::ArrowLeft, Key::ArrowDown, Key::ArrowDown].into_iter().for_each(|key| screen.press(key));
    assert_eq!(macros().map(f64::round), [4.0, -4.0]);
    let told = focused(&mut screen).expect("a focus");
    assert_eq!(told.0, "Fury and Crackle", "the arrow keys do not move the focus");
    let texts =
        [Id::MacroFury, Id::MacroCrackle].map(|id| id.parameter().to_text(plugin.effect_params().value(id as usize)));
    assert_eq!(told.1, texts.join(", "));
    screen.press(Key::Delete);
    assert_eq!(macros(), [0.0; 2]);
}

#[test]
fn part_of_the_recording_is_chosen_by_arrow_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let playing = Playing::new(folder.path());
    let mut screen = Screen::obeyed(playing.plugin.window());
    screen.turn_to(Page::Play, SIZE, 1.0);
    let began = Instant::now();
    let wait_for = |screen: &mut Screen, what: &str, is_so: &dyn Fn(&mut Screen) -> bool| {
        while !is_so(screen) {
            assert!(began.elapsed() < Duration::from_secs(60), "waited in vain for {what}");
            std::thread::sleep(Duration::from_millis(5));
            screen.draw();
        }
    };
    let has_outline =
        |screen: &mut Screen| screen.tree().nodes.iter().any(|(_, node)| node.label() == Some("Part to learn from"));
    wait_for(&mut screen, "an outline", &has_outline);
    reach(&mut screen, "Part to learn from");
    let duration_s = 500_000.0 / f64::from(RATE_HZ);
    let region_s = || {
        let fields = playing.plugin.params().serialize_fields();
        persist::decode(&fields[FIELD]).expect("a session").cut.region_s
    };
    (0..50).for_each(|_| screen.press(Key::ArrowDown));
    (0..20).for_each(|_| screen.press(Key::ArrowRight));
    assert_eq!(region_s(), None, "not before the keys rest");
    wait_for(&mut screen, "a part", &|_| region_s().is_some());
    let expected = [0.2, 0.7].map(|share| share * duration_s);
    let found = region_s().expect("just seen");
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-6), "{found:?}");
    wait_for(&mut screen, "its words", &|screen| focused(screen).is_some_and(|(_, text)| text == "2.08 to 7.29 s"));
    screen.press(Key::Delete);
    wait_for(&mut screen, "all of it", &|_| region_s().is_none());
}
