//! The playing half of a VST3 instance.

use std::collections::HashSet;
use std::sync::{Arc, Mutex};

use ::vst3::Steinberg::Vst::{
    AudioBusBuffers, AudioBusBuffers__type0, IAudioProcessor, IAudioProcessorTrait, IParameterChanges, ProcessContext,
    ProcessContext_::StatesAndFlags_::{kPlaying, kTempoValid},
    ProcessData, ProcessSetup,
};
use ::vst3::Steinberg::kResultOk;
use ::vst3::{ComPtr, ComWrapper};

use super::interfaces::{OutputChanges, ParameterChanges};
use crate::buses::Buses;
use crate::lock::lock;
use crate::{Block, ControllerMessage, Event, HostError, Processor, Tail, Transport};

/// Flags of a context, which are signed on Windows.
#[allow(clippy::unnecessary_cast, reason = "it is necessary on Windows")]
const PLAYING: u32 = kPlaying as u32;
#[allow(clippy::unnecessary_cast, reason = "it is necessary on Windows")]
const TEMPO_VALID: u32 = kTempoValid as u32;

pub(super) struct Vst3Processor {
    processor: ComPtr<IAudioProcessor>,
    instance: u64,
    buses: Buses,
    setup: ProcessSetup,
    ids: HashSet<u32>,
    pending: Arc<Mutex<Vec<Event>>>,
    reported: Arc<Mutex<Vec<Event>>>,
    /// Parameters that controllers are, by number.
    controllers: Vec<Option<u32>>,
    messages: Vec<Event>,
    started: bool,
}

impl Vst3Processor {
    pub fn new(
        processor: ComPtr<IAudioProcessor>,
        instance: u64,
        buses: Buses,
        setup: ProcessSetup,
        ids: HashSet<u32>,
        [pending, reported]: [Arc<Mutex<Vec<Event>>>; 2],
    ) -> Self {
        let (controllers, messages) = (Vec::new(), Vec::new());
        Self { processor, instance, buses, setup, ids, pending, reported, controllers, messages, started: false }
    }

    /// Sets the parameters of controllers, by number.
    pub fn with_controllers(self, controllers: Vec<Option<u32>>) -> Self {
        Self { controllers, ..self }
    }

    fn set_processing(&mut self, state: bool) -> i32 {
        self.started = state;
        // SAFETY: a live processor that is active as long as this half exists.
        unsafe { self.processor.setProcessing(u8::from(state)) }
    }

    fn context(&self, transport: Transport) -> Option<ProcessContext> {
        // SAFETY: all fields are numbers, for which zero is a value.
        let mut context: ProcessContext = unsafe { std::mem::zeroed() };
        context.sampleRate = self.setup.sampleRate;
        context.projectTimeSamples = transport.position?;
        if transport.playing {
            context.state |= PLAYING;
        }
        if let Some(tempo) = transport.tempo {
            context.state |= TEMPO_VALID;
            context.tempo = tempo;
        }
        Some(context)
    }
}

impl Processor for Vst3Processor {
    fn start(&mut self) -> Result<(), HostError> {
        if self.started || self.set_processing(true) == kResultOk {
            Ok(())
        } else {
            self.started = false;
            Err(HostError::Process)
        }
    }

    fn stop(&mut self) {
        if self.started {
            self.set_processing(false);
        }
    }

    fn reset(&mut self) -> Result<(), HostError> {
        let was_started = self.started;
        self.stop();
        if was_started { self.start() } else { Ok(()) }
    }

    fn process(&mut self, block: &mut Block<'_>) -> Result<(), HostError> {
        if !self.started {
            return Err(HostError::Lifecycle { found: "stopped", needed: "started" });
        }
        let (frames, mut pointers) = self.buses.load(block)?;
        if let Some(event) = block.events.iter().find(|e| !self.ids.contains(&e.id)) {
            return Err(HostError::UnknownParameter { id: event.id });
        }
        let pending = std::mem::take(&mut *lock(&self.pending));
        let messages = std::mem::take(&mut self.messages);
        let changes = ComWrapper::new(ParameterChanges::new(pending.iter().chain(block.events).chain(&messages)));
        let reported = ComWrapper::new(OutputChanges::default());
        let mut context = block.transport.and_then(|t| self.context(t));

        // A deactivated bus keeps its index but has no channels.
        let sidechain =
            if block.sidechain.is_some() { bus_buffers(&mut pointers.sidechain) } else { bus_buffers(&mut []) };
        let has_sidechain = !pointers.sidechain.is_empty();
        // nice-plug 0.4.2 reads a second input bus even if only one is present.
        let mut inputs = [bus_buffers(&mut pointers.input), sidechain];
        let mut outputs = [bus_buffers(&mut pointers.output)];
        let mut data = ProcessData {
            processMode: self.setup.processMode,
            symbolicSampleSize: self.setup.symbolicSampleSize,
            numSamples: i32::try_from(frames).unwrap_or(i32::MAX),
            numInputs: 1 + i32::from(has_sidechain),
            numOutputs: 1,
            inputs: inputs.as_mut_ptr(),
            outputs: outputs.as_mut_ptr(),
            inputParameterChanges: changes
                .as_com_ref::<IParameterChanges>()
                .map_or(std::ptr::null_mut(), |changes| changes.as_ptr()),
            outputParameterChanges: reported
                .as_com_ref::<IParameterChanges>()
                .map_or(std::ptr::null_mut(), |reported| reported.as_ptr()),
            inputEvents: std::ptr::null_mut(),
            outputEvents: std::ptr::null_mut(),
            processContext: context.as_mut().map_or(std::ptr::null_mut(), std::ptr::from_mut),
        };
        // SAFETY: a live, active, started processor. All pointers are to values of this function and to channels of
        // `self.buses`, each at least `frames` long, that nothing else uses until `process` has returned.
        if unsafe { self.processor.process(&mut data) } != kResultOk {
            return Err(HostError::Process);
        }
        lock(&self.reported).extend(reported.events());
        self.buses.store(block, frames)
    }

    fn move_controllers(&mut self, messages: &[ControllerMessage]) {
        let event = |message: &ControllerMessage| {
            let id = (*self.controllers.get(usize::from(message.controller))?)?;
            Some(Event { offset: message.offset, id, value: f64::from(message.position) / 127.0 })
        };
        self.messages.extend(messages.iter().filter_map(event));
    }

    fn tail(&mut self) -> Tail {
        // SAFETY: a live processor.
        match unsafe { self.processor.getTailSamples() } {
            u32::MAX => Tail::Infinite,
            samples => Tail::Samples(samples),
        }
    }

    fn instance(&self) -> u64 {
        self.instance
    }
}

fn bus_buffers(channels: &mut [*mut f32]) -> AudioBusBuffers {
    AudioBusBuffers {
        numChannels: i32::try_from(channels.len()).unwrap_or(i32::MAX),
        silenceFlags: 0,
        __field0: AudioBusBuffers__type0 {
            channelBuffers32: if channels.is_empty() { std::ptr::null_mut() } else { channels.as_mut_ptr() },
        },
    }
}
