//! Every page at every size: no button, slider or field is cut, none lies across another, and all are large enough to hit.

use std::time::{Duration, Instant};

use egui::{Pos2, Rect, Vec2};
use pyrophone::Pyrophone;
use pyrophone::editor::controls::Page;
use pyrophone_settings::{Id, Preset};

use crate::pages::{SIZES, scrolls};
use crate::playing::Playing;
use crate::screen::{Control, Screen};

/// Points by which edges may overlap.
const SLACK: f32 = 1.0;
/// Least width and height of a control, in points.
const LEAST: f32 = 9.0;

#[test]
fn no_control_is_cut_and_none_lies_across_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut playing = Playing::new(folder.path());
    let plugin = Pyrophone::default();
    let mut faults = faults_of("empty", &plugin, false);
    // Every layer sounds and every handle is there to be dragged.
    let values = Preset::find("drums-to-fire").expect("a factory preset").values;
    for (index, plain) in values.as_slice().iter().enumerate() {
        playing.plugin.effect_params().slot(index).set_without_host(*plain);
    }
    for (id, plain) in [(Id::ExtensionLevel, -12.0), (Id::VortexLevel, -6.0)] {
        playing.plugin.effect_params().slot(id as usize).set_without_host(plain);
    }
    for _ in 0..3 {
        playing.plugin.effect_params().takes.add();
    }
    (0..40).for_each(|_| playing.play_a_block());
    faults.extend(faults_of("playing", &playing.plugin, true));
    faults.sort();
    faults.dedup();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

fn faults_of(state: &str, plugin: &Pyrophone, has_recording: bool) -> Vec<String> {
    let mut faults = vec![];
    let mut screen = Screen::new(plugin.window());
    screen.turn_to(Page::Play, Vec2::new(1000.0, 700.0), 1.0);
    let began = Instant::now();
    let has_outline =
        |screen: &mut Screen| screen.controls().iter().any(|control| control.name == "Part to learn from");
    while has_recording && !has_outline(&mut screen) {
        assert!(began.elapsed() < Duration::from_secs(60), "the recording is not drawn");
        std::thread::sleep(Duration::from_millis(5));
    }
    for (size, scale) in SIZES.into_iter().flat_map(|size| [(size, 1.0), (size, 2.0)]) {
        for page in Page::ALL {
            let size = Vec2::new(size.0, size.1);
            screen.turn_to(page, size, scale);
            (0..3).for_each(|_| drop(screen.draw()));
            let controls = screen.controls();
            assert!(controls.len() > 15, "{page:?} has {} controls", controls.len());
            let case = format!("{page:?}, {state}, {size:?} ×{scale}");
            let within = Rect::from_min_size(Pos2::ZERO, size);
            faults.extend(cut(page, within, &controls).map(|what| format!("{case}: {what}")));
            faults.extend(across(&controls).map(|what| format!("{case}: {what}")));
        }
    }
    faults
}

/// The list of takes scrolls, on a page that does not.
fn is_take(control: &Control) -> bool {
    control.name.starts_with("Take ") || control.name.starts_with("As set")
}

/// Controls of which a part cannot be seen. Where a page or a list scrolls, it may cut what is above and below.
fn cut(page: Page, within: Rect, controls: &[Control]) -> impl Iterator<Item = String> {
    let is_cut = move |control: &Control| {
        let seen = control.seen.intersect(within).expand(SLACK);
        let place = control.place;
        let is_cut_across = place.left() < seen.left() || place.right() > seen.right();
        let is_cut_along = place.top() < seen.top() || place.bottom() > seen.bottom();
        is_cut_across || is_cut_along && !(scrolls(page) || is_take(control)) || place.size().min_elem() < LEAST
    };
    controls.iter().filter(move |control| is_cut(control)).map(|control| {
        format!(
            "{} at {:?}: only {:?} of it can be seen, or it is too small",
            control.name, control.place, control.seen
        )
    })
}

/// Pairs of controls of which one covers a part of the other. A handle inside a plot is no fault.
fn across(controls: &[Control]) -> impl Iterator<Item = String> {
    let pairs = controls.iter().enumerate().flat_map(move |(n, a)| controls[n + 1..].iter().map(move |b| (a, b)));
    let is_fault = |(a, b): &(&Control, &Control)| {
        let is_inside = a.seen.expand(SLACK).contains_rect(b.seen) || b.seen.expand(SLACK).contains_rect(a.seen);
        !is_inside && a.seen.shrink(SLACK).intersects(b.seen.shrink(SLACK))
    };
    pairs.filter(is_fault).map(|(a, b)| format!("{} at {:?} lies across {} at {:?}", a.name, a.seen, b.name, b.seen))
}
