//! MIDI controllers in both formats: they move parameters at their own samples, as automation would, and the host is told.

use std::collections::BTreeMap;

use pyrophone_host::bounce::AutomationPoint;
use pyrophone_host::state::State;
use pyrophone_host::{ControllerMessage, Format, Plugin, numeric_id};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{RATE_HZ, STEREO, assert_same, flame, load_session, open, preset, session};

const BLOCK: usize = 512;
/// The sample at which the controller of most tests moves, within the second block.
const AT: u32 = 700;

/// An instance in which these parameters follow these controllers, and extension alone is heard.
fn instance(format: Format, assignments: &[(&str, u8)]) -> Box<dyn Plugin> {
    let mut plugin = open(format);
    let values = preset("extend", &[]);
    load_session(plugin.as_mut(), &values, &session(None, None));
    let mut state = saved(plugin.as_mut());
    let assignments: BTreeMap<&str, u8> = assignments.iter().copied().collect();
    state.fields.insert("controllers".to_owned(), serde_json::to_string(&assignments).expect("JSON"));
    plugin.set_state(&state.to_bytes(format).expect("bytes")).expect("loaded");
    plugin
}

fn saved(plugin: &mut dyn Plugin) -> State {
    State::from_bytes(plugin.format(), &plugin.state().expect("a state")).expect("a state of this plug-in")
}

fn message(offset: u32, controller: u8, position: u8) -> ControllerMessage {
    ControllerMessage { offset, channel: 9, controller, position }
}

/// Plays 6000 samples with a message at sample [`AT`].
fn play(live: &mut Live, controller: u8, position: u8) -> Vec<Vec<f32>> {
    let input = flame(31, 2, 6000);
    let (first, rest): (Vec<_>, Vec<_>) =
        input.iter().map(|channel| (channel[..BLOCK].to_vec(), channel[BLOCK..].to_vec())).unzip();
    let mut output = live.play(&first, Clock::Playing(0), BLOCK);
    live.move_controllers(&[message(AT - BLOCK as u32, controller, position)]);
    let tail = live.play(&rest, Clock::Playing(BLOCK as i64), BLOCK);
    output.iter_mut().zip(tail).for_each(|(channel, tail)| channel.extend(tail));
    output
}

#[test]
fn a_controller_sounds_as_automation_of_what_follows_it() {
    for format in Format::ALL {
        let mut live = Live::start(instance(format, &[("cutoff", 21), ("output_level", 21)]), RATE_HZ, STEREO);
        let moved = play(&mut live, 21, 96);
        let reported = live.plugin().take_reported_values();
        let at = |id: &str| {
            reported.iter().find(|event| event.id == numeric_id(id)).unwrap_or_else(|| panic!("{format}: {id}"))
        };
        let points = ["cutoff", "output_level"].map(|id| AutomationPoint {
            sample: i64::from(AT),
            id: numeric_id(id),
            value: at(id).value,
        });
        let mut other = Live::start(instance(format, &[]), RATE_HZ, STEREO);
        let automated = other.play_automated(&flame(31, 2, 6000), Clock::Playing(0), BLOCK, &points);
        assert_same(&moved, &automated, &format!("{format}"));
        let mut still = Live::start(instance(format, &[]), RATE_HZ, STEREO);
        assert_ne!(moved, still.play(&flame(31, 2, 6000), Clock::Playing(0), BLOCK), "{format}: it is heard");
        for id in ["cutoff", "output_level"] {
            let (reported, value) = (at(id).value, live.plugin().value(numeric_id(id)).expect("a value"));
            assert!(
                (reported - value).abs() < 1e-6 && (value - 96.0 / 127.0).abs() < 0.01,
                "{format}: {id} {reported} {value}"
            );
        }
    }
}

#[test]
fn steps_are_whole_and_the_last_message_counts() {
    for format in Format::ALL {
        let mut live = Live::start(instance(format, &[("drive_mode", 1)]), RATE_HZ, STEREO);
        live.move_controllers(&[message(0, 1, 0), message(40, 2, 100), message(80, 1, 127)]);
        live.play(&flame(32, 2, BLOCK), Clock::Playing(0), BLOCK);
        let reported = live.plugin().take_reported_values();
        assert_eq!(reported.len(), 1, "{format}: one value of one parameter: {reported:?}");
        assert_eq!((reported[0].id, reported[0].value), (numeric_id("drive_mode"), 1.0), "{format}");
        let id = numeric_id("drive_mode");
        let value = live.plugin().value(id).expect("a value");
        assert_eq!(live.plugin().text(id, value).expect("a text"), "flame", "{format}");
    }
}

#[test]
fn echoed_value_does_not_hide_later_automation() {
    for format in Format::ALL {
        let (mut live, id) = (Live::start(instance(format, &[("alpha", 7)]), RATE_HZ, STEREO), numeric_id("alpha"));
        live.move_controllers(&[message(5, 7, 127)]);
        live.play(&flame(33, 2, BLOCK), Clock::Playing(0), BLOCK);
        live.plugin().take_reported_values();
        assert_eq!(live.plugin().value(id).expect("a value"), 1.0, "{format}");
        let points = [AutomationPoint { sample: 9, id, value: 0.25 }];
        live.play_automated(&flame(34, 2, BLOCK), Clock::Playing(BLOCK as i64), BLOCK, &points);
        let value = live.plugin().value(id).expect("a value");
        assert!((value - 0.25).abs() < 0.01, "{format}: {value}");
    }
}

#[test]
fn states_keep_controllers_and_presets_leave_them() {
    for format in Format::ALL {
        let mut plugin = instance(format, &[("macro_size", 21)]);
        let kept = |plugin: &mut dyn Plugin| saved(plugin).fields["controllers"].clone();
        assert_eq!(kept(plugin.as_mut()), r#"{"macro_size":21}"#, "{format}");
        load_session(plugin.as_mut(), &preset("default", &[]), &session(None, None));
        assert_eq!(kept(plugin.as_mut()), r#"{"macro_size":21}"#, "{format}: a state that says nothing of controllers");
        let mut state = saved(plugin.as_mut());
        for garbage in ["{{{", "[]", r#"{"macro_size":"x"}"#] {
            state.fields.insert("controllers".to_owned(), garbage.to_owned());
            plugin.set_state(&state.to_bytes(format).expect("bytes")).expect("the rest of it is good");
            assert_eq!(kept(plugin.as_mut()), r#"{"macro_size":21}"#, "{format}: {garbage}");
        }
    }
}
