//! What was recorded in the window is dragged out of it, into another program.

use std::cell::RefCell;

use pyrophone_host::Format;
use pyrophone_tests::desk::{DropSpot, TestDisplay, UiDriver};
use pyrophone_tests::live::Live;
use pyrophone_tests::{RATE_HZ, STEREO, load_session, open, peak, preset, session};

#[test]
fn a_recorded_take_is_dropped_where_it_is_wanted() {
    let Some(desk) = TestDisplay::set_up() else { return };
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("extend", &[]), &session(None, None));
        let mut live = Live::start(plugin, RATE_HZ, STEREO);
        let window = desk.open_drawn(live.plugin(), || {});
        let mut hand = UiDriver::new(&desk, window, &mut live, 0);
        hand.resize((1000, 700));
        hand.click("button.Record");
        (0..40).for_each(|_| hand.pass());
        hand.click("button.Record");

        // A program that does not want it gets nothing, and a click is no drag.
        let spot = RefCell::new(DropSpot::new((1100, 100), false));
        let middle = spot.borrow().middle();
        hand.carry("button.Drag out", middle, "the spot is reached", || {
            assert_eq!(spot.borrow_mut().poll(), None);
            spot.borrow().entered == 1
        });
        hand.wait_until("it leaves again", |_| {
            assert_eq!(spot.borrow_mut().poll(), None);
            spot.borrow().left == 1
        });
        drop(spot);
        hand.click("button.Drag out");

        let spot = RefCell::new(DropSpot::new((1150, 400), true));
        (0..40).for_each(|_| hand.pass());
        let middle = spot.borrow().middle();
        hand.carry("button.Drag out", middle, "the spot is reached", || {
            spot.borrow_mut().poll();
            spot.borrow().entered == 1
        });
        let mut dropped = None;
        hand.wait_until("the file is dropped", |_| {
            dropped = spot.borrow_mut().poll();
            dropped.is_some()
        });
        let path = dropped.expect("seen a moment ago");
        assert!(path.starts_with(desk.folder().join("takes")), "{}: in the folder of takes", path.display());
        let taken = pyrophone_recording::decode(&path, &|_| true).expect("a sound file");
        assert!(taken.channels.len() == 2 && taken.duration_s() > 0.3, "{format}: {} s", taken.duration_s());
        assert!(peak(&taken.channels[0]) > 1e-4, "{format}: it sounds");
        hand.settle();
        hand.screenshot(&format!("{format}-dragged-out"));
        let UiDriver { window, .. } = hand;
        window.close(live.plugin());
    }
}
