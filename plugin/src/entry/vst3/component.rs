//! The effect as a VST3 host sees it: component, processor and controller in one object, as in the framework.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use nice_plug::wrapper::vst3::Wrapper;
use vst3::Steinberg::Vst::{
    BusDirection, BusDirections_, BusInfo, ChannelContext::IInfoListener, ChannelContext::IInfoListenerTrait,
    IAttributeList, IAudioProcessor, IComponent, IComponentTrait, IEditController, IEditControllerTrait, IMidiMapping,
    IProcessContextRequirements, IProcessContextRequirementsTrait, IUnitInfo, IoMode, MediaType, MediaTypes_,
    RoutingInfo,
};
use vst3::Steinberg::{
    FUnknown, IBStream, IPluginBaseTrait, TBool, TUID, int32, kInvalidArgument, kResultFalse, kResultOk, tresult,
    uint32,
};
use vst3::{Class, ComPtr, ComWrapper};

use super::controllers::ControllerInput;
use super::host_menu::OpenView;
use super::pending::PendingValues;
use super::stream::{MemoryStream, pointer, read_all, write_all};
use crate::Pyrophone;
use crate::channels::MAX_CHANNELS;
use crate::entry::buses::{Buses, Declared, MAX_INPUTS};
use crate::entry::instance::{self, Instance, numeric_id};
use crate::entry::state;

pub const AUDIO: MediaType = MediaTypes_::kAudio as MediaType;
pub const INPUT: BusDirection = BusDirections_::kInput as BusDirection;
pub const OUTPUT: BusDirection = BusDirections_::kOutput as BusDirection;

/// Guards the framework's object.
pub struct Component {
    pub(super) component: ComPtr<IComponent>,
    pub(super) processor: ComPtr<IAudioProcessor>,
    pub(super) controller: ComPtr<IEditController>,
    pub(super) units: ComPtr<IUnitInfo>,
    requirements: ComPtr<IProcessContextRequirements>,
    info_listener: ComPtr<IInfoListener>,
    pub(super) instance: Instance,
    pub(super) pending: PendingValues,
    pub(super) controllers: ControllerInput,
    pub(super) view: OpenView,
    pub(super) is_processing: AtomicBool,
    /// Longest block, as announced; 0 before that.
    pub(super) max_block: std::sync::atomic::AtomicUsize,
    /// Used by the audio thread while active, exchanged by the main thread while not: never waited for.
    pub(super) buses: Mutex<Option<Buses>>,
}

impl Component {
    /// A new effect; none where the framework's object lacks an interface.
    pub fn new() -> Option<ComWrapper<Self>> {
        let wrapper = ComWrapper::new(Wrapper::<Pyrophone>::new());
        let instance = instance::take_announced()?;
        Some(ComWrapper::new(Self {
            component: wrapper.to_com_ptr()?,
            processor: wrapper.to_com_ptr()?,
            controller: wrapper.to_com_ptr()?,
            units: wrapper.to_com_ptr()?,
            requirements: wrapper.to_com_ptr()?,
            info_listener: wrapper.to_com_ptr()?,
            instance,
            pending: PendingValues::default(),
            controllers: ControllerInput::default(),
            view: OpenView::default(),
            is_processing: AtomicBool::new(false),
            max_block: Default::default(),
            buses: Mutex::new(None),
        }))
    }

    /// Current channels of a bus; 0 for a bus that does not exist.
    fn channels(&self, direction: BusDirection, index: int32) -> usize {
        // SAFETY: all fields are numbers, for which zero is valid.
        let mut info: BusInfo = unsafe { std::mem::zeroed() };
        // SAFETY: a live component and a writable location.
        let result = unsafe { IComponentTrait::getBusInfo(self, AUDIO, direction, index, &mut info) };
        if result == kResultOk { usize::try_from(info.channelCount).unwrap_or(0).min(MAX_CHANNELS) } else { 0 }
    }

    fn declared(&self) -> Declared {
        let mut inputs = [0; MAX_INPUTS];
        for (index, channels) in inputs.iter_mut().enumerate() {
            *channels = self.channels(INPUT, index as int32);
        }
        Declared { inputs, output: self.channels(OUTPUT, 0) }
    }

    /// The pending values as plain ones, by index in the table.
    ///
    /// The framework converts them, because it rounds in 32 bits: near the middle between two steps the table's own
    /// conversion, in 64 bits, gives the other step, and a state saved before the next block would differ from one
    /// saved after it.
    fn pending_plain(&self) -> Vec<(usize, f64)> {
        let plain = |(index, normalised): (usize, f64)| {
            let id = numeric_id(pyrophone_settings::PARAMETERS[index].id);
            // SAFETY: a live controller.
            (index, unsafe { self.controller.normalizedParamToPlain(id, normalised) })
        };
        self.pending.all().into_iter().map(plain).collect()
    }

    /// Delivers values that the host has set during playback and no block has carried, now that none will.
    pub(super) fn settle_pending(&self) {
        for (index, normalised) in self.pending.take_all() {
            let id = numeric_id(pyrophone_settings::PARAMETERS[index].id);
            // SAFETY: a live controller; it stores values at once while processing is off.
            unsafe { self.controller.setParamNormalized(id, normalised) };
        }
    }
}

impl Class for Component {
    type Interfaces = (
        IComponent,
        IEditController,
        IAudioProcessor,
        IProcessContextRequirements,
        IUnitInfo,
        IInfoListener,
        IMidiMapping,
    );
}

impl IPluginBaseTrait for Component {
    unsafe fn initialize(&self, context: *mut FUnknown) -> tresult {
        // SAFETY: a live component; the context is the host's.
        unsafe { self.component.initialize(context) }
    }

    unsafe fn terminate(&self) -> tresult {
        // SAFETY: a live component.
        unsafe { self.component.terminate() }
    }
}

impl IComponentTrait for Component {
    unsafe fn getControllerClassId(&self, class_id: *mut TUID) -> tresult {
        // SAFETY: a live component.
        unsafe { self.component.getControllerClassId(class_id) }
    }

    unsafe fn setIoMode(&self, mode: IoMode) -> tresult {
        // SAFETY: a live component.
        unsafe { self.component.setIoMode(mode) }
    }

    unsafe fn getBusCount(&self, kind: MediaType, direction: BusDirection) -> int32 {
        // SAFETY: a live component.
        unsafe { self.component.getBusCount(kind, direction) }
    }

    unsafe fn getBusInfo(&self, kind: MediaType, direction: BusDirection, index: int32, info: *mut BusInfo) -> tresult {
        // The framework treats negative indices as the sidechain.
        // SAFETY: a live component.
        if info.is_null() || !(0..unsafe { self.getBusCount(kind, direction) }).contains(&index) {
            return kInvalidArgument;
        }
        // SAFETY: a live component and a writable location.
        unsafe { self.component.getBusInfo(kind, direction, index, info) }
    }

    unsafe fn getRoutingInfo(&self, from: *mut RoutingInfo, to: *mut RoutingInfo) -> tresult {
        // SAFETY: a live component; the function rejects null.
        unsafe { self.component.getRoutingInfo(from, to) }
    }

    unsafe fn activateBus(&self, kind: MediaType, direction: BusDirection, index: int32, state: TBool) -> tresult {
        // SAFETY: a live component.
        unsafe { self.component.activateBus(kind, direction, index, state) }
    }

    unsafe fn setActive(&self, state: TBool) -> tresult {
        if state != 0 {
            let buses = Buses::new(self.declared(), self.max_block.load(Ordering::Relaxed));
            // A host that activates in mid-block waits for the block's end here, as in the framework.
            *self.buses.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(buses);
        }
        // SAFETY: a live component.
        let result = unsafe { self.component.setActive(state) };
        if state == 0 {
            self.is_processing.store(false, Ordering::SeqCst);
            self.settle_pending();
        }
        result
    }

    unsafe fn setState(&self, stream: *mut IBStream) -> tresult {
        // SAFETY: null or a live stream of the host.
        let Some(bytes) = (unsafe { read_all(stream) }) else { return kInvalidArgument };
        let copy = MemoryStream::new(bytes);
        // SAFETY: a live component and a live stream.
        let result = unsafe { self.component.setState(pointer(&copy)) };
        if result == kResultOk {
            // Values set earlier belong to the previous state.
            self.pending.take_all();
        }
        result
    }

    unsafe fn getState(&self, stream: *mut IBStream) -> tresult {
        if stream.is_null() {
            return kInvalidArgument;
        }
        let saved = MemoryStream::new(Vec::new());
        // SAFETY: a live component and a live stream.
        let result = unsafe { self.component.getState(pointer(&saved)) };
        if result != kResultOk {
            return result;
        }
        let bytes = state::normalise(&saved.take_bytes(), &self.pending_plain());
        // SAFETY: a live stream of the host.
        if unsafe { write_all(stream, &bytes) } { kResultOk } else { kResultFalse }
    }
}

impl IProcessContextRequirementsTrait for Component {
    unsafe fn getProcessContextRequirements(&self) -> uint32 {
        // SAFETY: a live object.
        unsafe { self.requirements.getProcessContextRequirements() }
    }
}

impl IInfoListenerTrait for Component {
    unsafe fn setChannelContextInfos(&self, list: *mut IAttributeList) -> tresult {
        if list.is_null() {
            return kInvalidArgument;
        }
        // SAFETY: a live object and a live list.
        unsafe { self.info_listener.setChannelContextInfos(list) }
    }
}
