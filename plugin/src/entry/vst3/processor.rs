//! The processing half: arrangements, set-up, blocks.

use std::sync::TryLockError;
use std::sync::atomic::Ordering;

use vst3::ComRef;
use vst3::Steinberg::Vst::{
    AudioBusBuffers, AudioBusBuffers__type0, BusDirection, IAudioProcessorTrait, IComponentTrait,
    IParamValueQueueTrait, IParameterChangesTrait, ProcessData, ProcessSetup, SpeakerArr, SpeakerArrangement,
    SymbolicSampleSizes_,
};
use vst3::Steinberg::{TBool, int32, kInvalidArgument, kNotInitialized, kResultFalse, kResultOk, tresult, uint32};

use super::component::{AUDIO, Component};
use crate::channels::MAX_CHANNELS;
use crate::entry::buses::{Buses, MAX_INPUTS};
use crate::entry::instance::index_of_numeric;

const SAMPLE_32: int32 = SymbolicSampleSizes_::kSample32 as int32;

/// Loudspeaker arrangements reported to the host; others with as many channels would be accepted and not reported.
const ARRANGEMENTS: [SpeakerArrangement; 4] =
    [SpeakerArr::kMono, SpeakerArr::kStereo, SpeakerArr::k50, SpeakerArr::k51];

/// # Safety
/// `arrangements` is null or has `count` entries.
unsafe fn are_known(arrangements: *const SpeakerArrangement, count: int32) -> bool {
    let Ok(count) = usize::try_from(count) else { return false };
    if arrangements.is_null() {
        return false;
    }
    // SAFETY: guaranteed by the caller.
    let arrangements = unsafe { std::slice::from_raw_parts(arrangements, count) };
    arrangements.iter().all(|arrangement| ARRANGEMENTS.contains(arrangement))
}

/// A bus of the host, if it exists.
///
/// # Safety
/// `buses` is null or has `count` entries.
unsafe fn bus<'a>(buses: *const AudioBusBuffers, count: int32, index: usize) -> Option<&'a AudioBusBuffers> {
    let is_there = !buses.is_null() && usize::try_from(count).is_ok_and(|count| index < count);
    // SAFETY: guaranteed by the caller.
    is_there.then(|| unsafe { &*buses.add(index) })
}

/// A channel of a bus, null where it is missing.
fn channel(bus: Option<&AudioBusBuffers>, index: usize) -> *mut f32 {
    let Some(bus) = bus else { return std::ptr::null_mut() };
    // SAFETY: this is the union's field for 32-bit samples, which the caller has checked.
    let channels = unsafe { bus.__field0.channelBuffers32 };
    if channels.is_null() || usize::try_from(bus.numChannels).map_or(true, |count| index >= count) {
        return std::ptr::null_mut();
    }
    // SAFETY: the host's array has `numChannels` entries.
    unsafe { *channels.add(index) }
}

fn empty_bus() -> AudioBusBuffers {
    AudioBusBuffers {
        numChannels: 0,
        silenceFlags: 0,
        __field0: AudioBusBuffers__type0 { channelBuffers32: std::ptr::null_mut() },
    }
}

fn bus_of(pointers: &mut [*mut f32]) -> AudioBusBuffers {
    AudioBusBuffers {
        numChannels: pointers.len() as int32,
        silenceFlags: 0,
        __field0: AudioBusBuffers__type0 { channelBuffers32: pointers.as_mut_ptr() },
    }
}

impl Component {
    /// Notes which values set on the host's main thread arrive with this block; real-time safe.
    ///
    /// # Safety
    /// The block's changes are null or live.
    unsafe fn pass_changes(&self, data: &ProcessData) {
        // SAFETY: guaranteed by the caller.
        let Some(changes) = (unsafe { ComRef::from_raw(data.inputParameterChanges) }) else { return };
        // SAFETY: live changes; queues live as long as they do; writable locations.
        unsafe {
            for index in 0..changes.getParameterCount() {
                let Some(queue) = ComRef::from_raw(changes.getParameterData(index)) else { continue };
                let (mut offset, mut value) = (0, 0.0);
                let last = queue.getPointCount() - 1;
                if last >= 0
                    && queue.getPoint(last, &mut offset, &mut value) == kResultOk
                    && let Some(index) = index_of_numeric(queue.getParameterId())
                {
                    self.pending.pass(index, value);
                }
            }
        }
    }

    /// Processes a block after replacing missing channels.
    ///
    /// # Safety
    /// The conditions of [`IAudioProcessorTrait::process`].
    unsafe fn process_guarded(&self, data: &mut ProcessData, buses: &mut Buses) -> tresult {
        let declared = buses.declared();
        for index in 0..MAX_INPUTS {
            // SAFETY: the host's buses.
            let given = unsafe { bus(data.inputs, data.numInputs, index) };
            buses.set_input(index, |of| channel(given, of));
        }
        // SAFETY: the host's buses.
        let given = unsafe { bus(data.outputs, data.numOutputs, 0) };
        let is_heard = buses.set_output(|of| channel(given, of));
        let inputs = declared.inputs.iter().filter(|channels| **channels > 0).count();
        let [main, sidechain] = &mut buses.inputs;
        let mut guarded_inputs =
            [bus_of(&mut main[..declared.inputs[0]]), bus_of(&mut sidechain[..declared.inputs[1]])];
        // The framework reads one bus more than there is.
        let mut guarded_outputs = [bus_of(&mut buses.output[..declared.output]), empty_bus()];
        let mut guarded = ProcessData { ..*data };
        guarded.numInputs = inputs as int32;
        guarded.inputs = guarded_inputs.as_mut_ptr();
        // Without an output to write to only the changes of parameters count.
        guarded.numOutputs = int32::from(is_heard);
        guarded.outputs = guarded_outputs.as_mut_ptr();
        let assigned = &self.instance.params.controllers;
        // SAFETY: the host's changes, which live as long as the block.
        guarded.inputParameterChanges =
            unsafe { self.controllers.apply_controllers(assigned, data.inputParameterChanges) };
        // SAFETY: a live processor; every channel that was declared is there and long enough.
        let result = unsafe { self.processor.process(&mut guarded) };
        self.controllers.moved().for_each(|(index, value)| self.pending.report(index, value));
        // SAFETY: null or the host's changes.
        unsafe { self.controllers.report_values(data.outputParameterChanges) };
        self.controllers.finish();
        // SAFETY: the host's buses; channels beyond those declared must not keep old samples.
        unsafe { silence_rest(data, declared.output) };
        result
    }
}

/// Silences output channels of the host beyond those of the effect.
///
/// # Safety
/// The conditions of [`IAudioProcessorTrait::process`].
unsafe fn silence_rest(data: &mut ProcessData, channels: usize) {
    let samples = usize::try_from(data.numSamples).unwrap_or(0);
    for index in 0..usize::try_from(data.numOutputs).unwrap_or(0) {
        // SAFETY: the host's buses.
        let given = unsafe { bus(data.outputs, data.numOutputs, index) };
        let first = if index == 0 { channels } else { 0 };
        let count = given.map_or(0, |bus| usize::try_from(bus.numChannels).unwrap_or(0));
        for of in first..count {
            let pointer = channel(given, of);
            if !pointer.is_null() {
                // SAFETY: a channel of the host's, as long as the block.
                unsafe { pointer.write_bytes(0, samples) };
            }
        }
        if !data.outputs.is_null() {
            // SAFETY: the host's bus; its silence flags still describe the previous block.
            unsafe { (*data.outputs.add(index)).silenceFlags = 0 };
        }
    }
}

impl IAudioProcessorTrait for Component {
    unsafe fn setBusArrangements(
        &self,
        inputs: *mut SpeakerArrangement,
        input_count: int32,
        outputs: *mut SpeakerArrangement,
        output_count: int32,
    ) -> tresult {
        // SAFETY: the host's arrays.
        if !unsafe { are_known(inputs, input_count) && are_known(outputs, output_count) } {
            return kResultFalse;
        }
        // The framework compares the sidechain with the main input, and would accept any arrangement.
        // SAFETY: two entries, by the count.
        if input_count == 2 && unsafe { *inputs != *inputs.add(1) } {
            return kResultFalse;
        }
        // SAFETY: a live processor, arrays that are there.
        unsafe { self.processor.setBusArrangements(inputs, input_count, outputs, output_count) }
    }

    unsafe fn getBusArrangement(
        &self,
        direction: BusDirection,
        index: int32,
        arrangement: *mut SpeakerArrangement,
    ) -> tresult {
        // The framework treats negative indices as the sidechain.
        // SAFETY: a live component.
        if arrangement.is_null() || !(0..unsafe { self.component.getBusCount(AUDIO, direction) }).contains(&index) {
            return kInvalidArgument;
        }
        // SAFETY: a live processor and a writable location.
        unsafe { self.processor.getBusArrangement(direction, index, arrangement) }
    }

    unsafe fn canProcessSampleSize(&self, size: int32) -> tresult {
        // SAFETY: a live processor.
        unsafe { self.processor.canProcessSampleSize(size) }
    }

    unsafe fn getLatencySamples(&self) -> uint32 {
        // SAFETY: a live processor.
        unsafe { self.processor.getLatencySamples() }
    }

    unsafe fn setupProcessing(&self, setup: *mut ProcessSetup) -> tresult {
        // SAFETY: null or the host's set-up.
        let Some(asked) = (unsafe { setup.as_ref() }) else { return kInvalidArgument };
        let is_possible = asked.symbolicSampleSize == SAMPLE_32
            && asked.maxSamplesPerBlock > 0
            && asked.sampleRate.is_finite()
            && asked.sampleRate > 0.0;
        if !is_possible {
            return kResultFalse;
        }
        self.max_block.store(asked.maxSamplesPerBlock as usize, Ordering::Relaxed);
        // Twice: the framework passes a new process mode to the effect only at the following set-up, so an offline
        // render would count as real time.
        // SAFETY: a live processor and the host's set-up.
        unsafe {
            self.processor.setupProcessing(setup);
            self.processor.setupProcessing(setup)
        }
    }

    unsafe fn setProcessing(&self, state: TBool) -> tresult {
        // SAFETY: a live processor.
        let result = unsafe { self.processor.setProcessing(state) };
        self.is_processing.store(state != 0, Ordering::SeqCst);
        if state == 0 {
            self.settle_pending();
        }
        result
    }

    unsafe fn process(&self, data: *mut ProcessData) -> tresult {
        // SAFETY: null or the host's block.
        let Some(data) = (unsafe { data.as_mut() }) else { return kInvalidArgument };
        if data.symbolicSampleSize != SAMPLE_32 || data.numSamples < 0 {
            return kInvalidArgument;
        }
        // Uncontended while the effect is active, unless a host breaks the rules.
        let mut buses = match self.buses.try_lock() {
            Ok(buses) => buses,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return kResultFalse,
        };
        let Some(buses) = buses.as_mut() else {
            // SAFETY: the host's block.
            unsafe { silence_rest(data, 0) };
            return kNotInitialized;
        };
        if data.numSamples as usize > buses.max_block() {
            // SAFETY: the host's block.
            unsafe { silence_rest(data, 0) };
            return kInvalidArgument;
        }
        // SAFETY: the host's block.
        unsafe {
            self.pass_changes(data);
            self.process_guarded(data, buses)
        }
    }

    unsafe fn getTailSamples(&self) -> uint32 {
        // SAFETY: a live processor.
        unsafe { self.processor.getTailSamples() }
    }
}

const _: () = assert!(MAX_CHANNELS >= 6, "the largest arrangement has six channels");
