//! What assistive technology would be told of the window, if the toolkit handed it over: every parameter by name, with its value.

use std::collections::BTreeMap;

use crate::screen::Screen;
use egui::accesskit::Role;
use egui::{Key, Vec2};
use pyrophone::Pyrophone;
use pyrophone::editor::controls::Page;
use pyrophone_settings::{PARAMETERS, ParameterKind};

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
