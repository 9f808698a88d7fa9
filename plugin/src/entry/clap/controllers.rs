//! Messages of MIDI controllers, converted for the framework into values of the assigned parameters.
//!
//! So the engines follow at the message's own sample, as they follow automation, and the host receives the resulting
//! value.

use clap_sys::events::{
    CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_IS_LIVE, CLAP_EVENT_MIDI, CLAP_EVENT_PARAM_VALUE, clap_event_header,
    clap_event_midi, clap_event_param_value,
};
use pyrophone_settings::controller_file::CONTROLLERS;
use pyrophone_settings::{PARAMETERS, ParameterKind};

use crate::controllers::{Controllers, value_at};
use crate::entry::instance::NUMERIC_IDS;

/// Maximum number of effective messages per block; any further ones are ignored.
const MOST: usize = 1024;

/// A message of the host's list, which is replaced by one or more events.
#[derive(Debug, Clone, Copy)]
struct Message {
    /// Index in the host's list.
    event: u32,
    /// Index in our list of the first value that it sets.
    first: u32,
    /// Number of values that it sets.
    values: u32,
    number: u8,
    /// Position of the controller, 0-1.
    share: f64,
    time: u32,
}

/// Content of an event of our list.
#[derive(Debug, Clone, Copy)]
pub enum EventSource {
    /// The host's event at this index.
    Host(u32),
    /// The value of the parameter at this index of the table.
    Value { index: usize, share: f64, time: u32 },
}

/// The controllers' messages of the current call; real-time safe except for its construction.
pub struct Messages {
    messages: Vec<Message>,
    /// Position at the end of the call of every controller that has moved a parameter.
    last: [Option<f64>; CONTROLLERS as usize],
}

impl Default for Messages {
    fn default() -> Self {
        Self { messages: Vec::with_capacity(MOST), last: [None; CONTROLLERS as usize] }
    }
}

/// Number and position (0-1) of the controller whose message an event is.
///
/// # Safety
/// `event` is null or a live event.
unsafe fn controller(event: *const clap_event_header) -> Option<(u8, f64, u32)> {
    // SAFETY: guaranteed by the caller.
    let header = unsafe { event.as_ref() }?;
    if header.space_id != CLAP_CORE_EVENT_SPACE_ID || header.type_ != CLAP_EVENT_MIDI {
        return None;
    }
    // SAFETY: events of this type are of this size.
    let [status, number, position] = unsafe { (*event.cast::<clap_event_midi>()).data };
    let is_one = status & 0xf0 == 0xb0 && number < CONTROLLERS && position < 128;
    is_one.then(|| (number, f64::from(position) / 127.0, header.time))
}

impl Messages {
    /// Reads the host's list, `count` events that `event` returns; a pending MIDI learn uses the first controller.
    ///
    /// # Safety
    /// Each result of `event` is null or a live event.
    pub unsafe fn read(
        &mut self,
        controllers: &Controllers,
        count: u32,
        event: impl Fn(u32) -> *const clap_event_header,
    ) {
        self.messages.clear();
        self.last.fill(None);
        let mut added = 0;
        for place in 0..count {
            // SAFETY: guaranteed by the caller.
            let Some((number, share, time)) = (unsafe { controller(event(place)) }) else { continue };
            controllers.note_moved(number);
            let values = controllers.targets(number).count() as u32;
            if values == 0 || self.messages.len() == MOST {
                continue;
            }
            self.messages.push(Message { event: place, first: place + added, values, number, share, time });
            self.last[usize::from(number)] = Some(share);
            added += values - 1;
        }
    }

    /// The number of events added to the host's list.
    pub fn added(&self) -> u32 {
        self.messages.iter().map(|message| message.values - 1).sum()
    }

    /// The content at an index of our list.
    pub fn event_at(&self, controllers: &Controllers, place: u32) -> EventSource {
        let before = self.messages.partition_point(|message| message.first <= place);
        let Some(message) = before.checked_sub(1).map(|index| self.messages[index]) else {
            return EventSource::Host(place);
        };
        let beyond = place - message.first;
        if beyond >= message.values {
            return EventSource::Host(message.event + 1 + beyond - message.values);
        }
        // The window may have reassigned it meanwhile; the framework ignores the message itself.
        controllers.targets(message.number).nth(beyond as usize).map_or(EventSource::Host(message.event), |index| {
            EventSource::Value { index, share: message.share, time: message.time }
        })
    }

    /// Values at the end of the call of all moved parameters.
    pub fn moved(&self, controllers: &Controllers) -> impl Iterator<Item = clap_event_param_value> {
        let moved = self.last.iter().enumerate().filter_map(|(number, share)| Some((number as u8, (*share)?)));
        moved.flat_map(|(number, share)| controllers.targets(number).map(move |index| event_of(index, share, 0)))
    }
}

/// The event that sets the parameter at `index` to its controller's position; real-time safe.
pub fn event_of(index: usize, share: f64, time: u32) -> clap_event_param_value {
    let parameter = &PARAMETERS[index];
    // Hosts count the steps of discrete parameters.
    let steps =
        if matches!(parameter.kind, ParameterKind::Float { .. }) { 1.0 } else { parameter.high() - parameter.low() };
    clap_event_param_value {
        header: clap_event_header {
            size: size_of::<clap_event_param_value>() as u32,
            time,
            space_id: CLAP_CORE_EVENT_SPACE_ID,
            type_: CLAP_EVENT_PARAM_VALUE,
            flags: CLAP_EVENT_IS_LIVE,
        },
        param_id: NUMERIC_IDS[index],
        cookie: std::ptr::null_mut(),
        note_id: -1,
        port_index: -1,
        channel: -1,
        key: -1,
        value: value_at(index, share) * steps,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controllers::assignable;

    fn message(status: u8, number: u8, position: u8, time: u32) -> clap_event_midi {
        let header = clap_event_header {
            size: size_of::<clap_event_midi>() as u32,
            time,
            space_id: CLAP_CORE_EVENT_SPACE_ID,
            type_: CLAP_EVENT_MIDI,
            flags: 0,
        };
        clap_event_midi { header, port_index: 0, data: [status, number, position] }
    }

    #[test]
    fn a_message_becomes_the_values_that_it_sets() {
        let controllers = Controllers::default();
        let [alpha, size] = ["alpha", "macro_size"].map(|id| assignable(id).expect("automatable"));
        controllers.assign(alpha, Some(1));
        controllers.assign(size, Some(1));
        // A note, two controllers that move something, one that does not, another note.
        let events = [
            message(0x90, 60, 1, 0),
            message(0xb0, 1, 127, 3),
            message(0xb5, 2, 64, 4),
            message(0xbf, 1, 0, 9),
            message(0x80, 60, 0, 9),
        ];
        let mut messages = Messages::default();
        // SAFETY: live events.
        let read =
            || unsafe { messages.read(&controllers, 5, |place| std::ptr::from_ref(&events[place as usize].header)) };
        assert_eq!(allocation_counter::measure(read).count_total, 0);
        assert_eq!(messages.added(), 2);
        let found: Vec<String> = (0..7).map(|place| format!("{:?}", messages.event_at(&controllers, place))).collect();
        let value = |index: usize, share: f64, time: u32| format!("{:?}", EventSource::Value { index, share, time });
        let host = |place: u32| format!("{:?}", EventSource::Host(place));
        let expected = [
            host(0),
            value(alpha, 1.0, 3),
            value(size, 1.0, 3),
            host(2),
            value(alpha, 0.0, 9),
            value(size, 0.0, 9),
            host(4),
        ];
        assert_eq!(found, expected);
        let reported: Vec<(u32, f64)> =
            messages.moved(&controllers).map(|event| (event.param_id, event.value)).collect();
        assert_eq!(reported, [(NUMERIC_IDS[alpha], 0.0), (NUMERIC_IDS[size], 0.0)], "the host is told the last value");
        controllers.assign(size, None);
        assert!(
            matches!(messages.event_at(&controllers, 2), EventSource::Host(1)),
            "assigned elsewhere within the block"
        );
    }

    #[test]
    fn more_messages_than_there_is_room_for_do_nothing() {
        let controllers = Controllers::default();
        controllers.assign(assignable("alpha").expect("automatable"), Some(1));
        let event = message(0xb0, 1, 64, 0);
        let mut messages = Messages::default();
        // SAFETY: a live event.
        unsafe { messages.read(&controllers, 3 * MOST as u32, |_| &event.header) };
        assert_eq!((messages.messages.len(), messages.messages.capacity()), (MOST, MOST));
        assert!(matches!(messages.event_at(&controllers, 2 * MOST as u32), EventSource::Host(_)));
    }

    #[test]
    fn steps_are_counted_as_hosts_count_them() {
        let choice = assignable("drive_mode").expect("automatable");
        let (event, high) = (event_of(choice, 1.0, 5), PARAMETERS[choice].high());
        assert_eq!((event.value, event.header.time), (high, 5));
        assert_eq!(event_of(choice, 0.4, 0).value.fract(), 0.0);
    }
}
