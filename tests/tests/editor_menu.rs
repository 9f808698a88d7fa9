//! The host's own entries in the menu of a parameter: they are shown, and what is chosen is done by the host.

use pyrophone_host::{Format, MENU, SUBMENU, numeric_id};
use pyrophone_tests::desk::{TestDisplay, UiDriver};
use pyrophone_tests::live::Live;
use pyrophone_tests::{RATE_HZ, STEREO, load_session, open, preset, session};

#[test]
fn a_right_click_offers_what_the_host_has() {
    let Some(desk) = TestDisplay::set_up() else { return };
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &session(None, None));
        let mut live = Live::start(plugin, RATE_HZ, STEREO);
        let window = desk.open_drawn(live.plugin(), || {});
        let mut hand = UiDriver::new(&desk, window, &mut live, 0);
        for (id, knob) in [("macro_size", "knob.macro_size"), ("output_level", "fader.output_level")] {
            hand.right_click(knob);
            let (action, words) = MENU[0];
            hand.place(&format!("menu.host.{words}"));
            hand.screenshot(&format!("{format}-host-menu-{id}"));
            hand.click(&format!("menu.host.{words}"));
            let mut chosen = Vec::new();
            hand.wait_until("the host does it", |hand| {
                chosen.extend(hand.live.plugin().take_menu_choices());
                !chosen.is_empty()
            });
            assert_eq!(chosen, [(numeric_id(id), action)], "{format}");
            assert_eq!(hand.value("macro_size"), 0.0, "{format}: nothing else has happened");
        }
        // In a menu of its own.
        hand.right_click("knob.macro_fury");
        hand.click(&format!("menu.host.{SUBMENU}"));
        let (action, words) = MENU[1];
        hand.click(&format!("menu.host.{words}"));
        let mut chosen = Vec::new();
        hand.wait_until("the host does it", |hand| {
            chosen.extend(hand.live.plugin().take_menu_choices());
            !chosen.is_empty()
        });
        assert_eq!(chosen, [(numeric_id("macro_fury"), action)], "{format}");
        let UiDriver { window, .. } = hand;
        window.close(live.plugin());
    }
}
