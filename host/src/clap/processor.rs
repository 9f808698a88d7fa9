//! The playing half of a CLAP instance.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use clack_extensions::tail::{PluginTail, TailLength};
use clack_host::events::event_types::{MidiEvent, ParamValueEvent, TransportEvent, TransportFlags};
use clack_host::events::io::EventBuffer;
use clack_host::events::spaces::CoreEventSpace;
use clack_host::events::{Event as _, EventFlags};
use clack_host::prelude::*;
use clack_host::utils::{BeatTime, SecondsTime};
use clap_sys::audio_buffer::clap_audio_buffer;

use super::description::Range;
use super::handlers::Handlers;
use crate::buses::Buses;
use crate::lock::lock;
use crate::{Block, ControllerMessage, Event, HostError, Processor, Tail, Transport};

pub(super) struct ClapProcessor {
    processor: PluginAudioProcessor<Handlers>,
    instance: u64,
    buses: Buses,
    sample_rate: f64,
    ranges: Arc<HashMap<u32, Range>>,
    pending: Arc<Mutex<Vec<Event>>>,
    reported: Arc<Mutex<Vec<Event>>>,
    messages: Vec<ControllerMessage>,
}

impl ClapProcessor {
    pub fn new(
        processor: PluginAudioProcessor<Handlers>,
        instance: u64,
        buses: Buses,
        sample_rate: f64,
        ranges: Arc<HashMap<u32, Range>>,
        pending: Arc<Mutex<Vec<Event>>>,
        reported: Arc<Mutex<Vec<Event>>>,
    ) -> Self {
        Self { processor, instance, buses, sample_rate, ranges, pending, reported, messages: Vec::new() }
    }

    /// Records the values in the plug-in's output.
    fn collect_reported(&self, output: &EventBuffer) {
        let values = output.iter().filter_map(|event| match event.as_core_event() {
            Some(CoreEventSpace::ParamValue(event)) => {
                let id = event.param_id()?.get();
                let value = self.ranges.get(&id)?.normalized(event.value());
                Some(Event { offset: event.time(), id, value })
            }
            _ => None,
        });
        lock(&self.reported).extend(values);
    }

    fn param_event(&self, event: &Event) -> Result<ParamValueEvent, HostError> {
        let id = event.id;
        ClapId::from_raw(id)
            .zip(self.ranges.get(&id))
            .map(|(clap_id, range)| {
                let plain = range.plain(event.value);
                ParamValueEvent::new(event.offset, clap_id, Pckn::match_all(), plain)
            })
            .ok_or(HostError::UnknownParameter { id })
    }

    fn transport_event(&self, transport: Transport) -> TransportEvent {
        let mut flags = TransportFlags::empty();
        flags.set(TransportFlags::IS_PLAYING, transport.playing);
        flags.set(TransportFlags::HAS_TEMPO, transport.tempo.is_some());
        flags.set(TransportFlags::HAS_SECONDS_TIMELINE, transport.position.is_some());
        let seconds = transport.position.unwrap_or(0) as f64 / self.sample_rate;
        TransportEvent {
            header: EventHeader::new_core(0, EventFlags::empty()),
            flags,
            song_pos_beats: BeatTime::from_int(0),
            song_pos_seconds: SecondsTime::from_float(seconds),
            tempo: transport.tempo.unwrap_or(0.0),
            tempo_inc: 0.0,
            loop_start_beats: BeatTime::from_int(0),
            loop_end_beats: BeatTime::from_int(0),
            loop_start_seconds: SecondsTime::from_int(0),
            loop_end_seconds: SecondsTime::from_int(0),
            bar_start: BeatTime::from_int(0),
            bar_number: 0,
            time_signature_numerator: 0,
            time_signature_denominator: 0,
        }
    }
}

impl Processor for ClapProcessor {
    fn start(&mut self) -> Result<(), HostError> {
        self.processor.ensure_processing_started().map(|_| ()).map_err(|_| HostError::Process)
    }

    fn stop(&mut self) {
        self.processor.ensure_processing_stopped();
    }

    fn reset(&mut self) -> Result<(), HostError> {
        self.processor.reset();
        Ok(())
    }

    fn process(&mut self, block: &mut Block<'_>) -> Result<(), HostError> {
        if !self.processor.is_started() {
            return Err(HostError::Lifecycle { found: "stopped", needed: "started" });
        }
        let (frames, mut pointers) = self.buses.load(block)?;
        let pending = std::mem::take(&mut *lock(&self.pending));
        let mut events = EventBuffer::with_capacity(pending.len() + block.events.len() + self.messages.len());
        for event in pending.iter().chain(block.events) {
            events.push(&self.param_event(event)?);
        }
        for message in self.messages.drain(..) {
            let bytes = [0xb0 | message.channel, message.controller, message.position];
            events.push(&MidiEvent::new(message.offset, 0, bytes));
        }
        events.sort();
        let mut reported = EventBuffer::new();
        let transport = block.transport.map(|t| self.transport_event(t));

        let mut inputs = vec![audio_buffer(&mut pointers.input)];
        if !pointers.sidechain.is_empty() {
            inputs.push(audio_buffer(&mut pointers.sidechain));
        }
        let mut outputs = [audio_buffer(&mut pointers.output)];
        let frames_count = u32::try_from(frames).unwrap_or(u32::MAX);
        // SAFETY: the buffers point to channels of `self.buses`, each at least `frames` long, that nothing else uses
        // until `process` has returned. Inputs and outputs may share memory, as CLAP allows.
        let (input, mut output) = unsafe {
            (
                InputAudioBuffers::from_raw_buffers(&inputs, frames_count),
                OutputAudioBuffers::from_raw_buffers(&mut outputs, frames_count),
            )
        };
        self.processor
            .as_started_mut()
            .map_err(|_| HostError::Process)?
            .process(&input, &mut output, &events.as_input(), &mut reported.as_output(), None, transport.as_ref())
            .map_err(|_| HostError::Process)?;
        self.collect_reported(&reported);
        self.buses.store(block, frames)
    }

    fn move_controllers(&mut self, messages: &[ControllerMessage]) {
        self.messages.extend_from_slice(messages);
    }

    fn tail(&mut self) -> Tail {
        let handle = self.processor.plugin_handle();
        match handle.get_extension::<PluginTail>().map(|tail| tail.get(&handle)) {
            Some(TailLength::Finite(samples)) => Tail::Samples(samples),
            Some(TailLength::Infinite) => Tail::Infinite,
            None => Tail::Samples(0),
        }
    }

    fn instance(&self) -> u64 {
        self.instance
    }
}

fn audio_buffer(channels: &mut [*mut f32]) -> clap_audio_buffer {
    clap_audio_buffer {
        data32: channels.as_mut_ptr(),
        data64: std::ptr::null_mut(),
        channel_count: u32::try_from(channels.len()).unwrap_or(u32::MAX),
        latency: 0,
        constant_mask: 0,
    }
}
