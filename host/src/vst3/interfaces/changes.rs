//! Changes of parameters within a block, to the plug-in and from it.

use std::cell::RefCell;

use ::vst3::Steinberg::Vst::{
    IParamValueQueue, IParamValueQueueTrait, IParameterChanges, IParameterChangesTrait, ParamID, ParamValue,
};
use ::vst3::Steinberg::{int32, kInvalidArgument, kNotImplemented, kResultFalse, kResultOk, tresult};
use ::vst3::{Class, ComPtr, ComWrapper};

use super::out::write_if_wanted;
use crate::Event;

/// The changes of one parameter within a block.
struct Queue {
    id: ParamID,
    points: Vec<(int32, ParamValue)>,
}

impl Class for Queue {
    type Interfaces = (IParamValueQueue,);
}

impl IParamValueQueueTrait for Queue {
    unsafe fn getParameterId(&self) -> ParamID {
        self.id
    }

    unsafe fn getPointCount(&self) -> int32 {
        self.points.len() as int32
    }

    unsafe fn getPoint(&self, index: int32, offset: *mut int32, value: *mut ParamValue) -> tresult {
        let point = usize::try_from(index).ok().and_then(|i| self.points.get(i));
        let Some(&(at, to)) = point else {
            return kInvalidArgument;
        };
        // SAFETY: null or writable locations.
        unsafe {
            write_if_wanted(offset, at);
            write_if_wanted(value, to);
        }
        kResultOk
    }

    /// Input queues are the host's to fill.
    unsafe fn addPoint(&self, _: int32, _: ParamValue, _: *mut int32) -> tresult {
        kResultFalse
    }
}

/// A plug-in's output for one parameter.
struct OutputQueue {
    id: ParamID,
    points: RefCell<Vec<(int32, ParamValue)>>,
}

impl Class for OutputQueue {
    type Interfaces = (IParamValueQueue,);
}

impl IParamValueQueueTrait for OutputQueue {
    unsafe fn getParameterId(&self) -> ParamID {
        self.id
    }

    unsafe fn getPointCount(&self) -> int32 {
        self.points.borrow().len() as int32
    }

    unsafe fn getPoint(&self, _: int32, _: *mut int32, _: *mut ParamValue) -> tresult {
        kNotImplemented
    }

    unsafe fn addPoint(&self, offset: int32, value: ParamValue, index: *mut int32) -> tresult {
        let mut points = self.points.borrow_mut();
        // SAFETY: null or a writable location.
        unsafe { write_if_wanted(index, points.len() as int32) };
        points.push((offset, value));
        kResultOk
    }
}

/// A plug-in's output within a block, used only by the thread that plays it.
#[derive(Default)]
pub struct OutputChanges {
    queues: RefCell<Vec<(ComWrapper<OutputQueue>, ComPtr<IParamValueQueue>)>>,
}

impl OutputChanges {
    /// All output events.
    pub fn events(&self) -> Vec<Event> {
        let queues = self.queues.borrow();
        let of = |queue: &OutputQueue| {
            let event = |(offset, value): &(int32, f64)| Event { offset: *offset as u32, id: queue.id, value: *value };
            queue.points.borrow().iter().map(event).collect::<Vec<_>>()
        };
        queues.iter().flat_map(|(queue, _)| of(queue)).collect()
    }
}

impl Class for OutputChanges {
    type Interfaces = (IParameterChanges,);
}

impl IParameterChangesTrait for OutputChanges {
    unsafe fn getParameterCount(&self) -> int32 {
        self.queues.borrow().len() as int32
    }

    unsafe fn getParameterData(&self, _: int32) -> *mut IParamValueQueue {
        std::ptr::null_mut()
    }

    unsafe fn addParameterData(&self, id: *const ParamID, index: *mut int32) -> *mut IParamValueQueue {
        // SAFETY: null or the plug-in's id.
        let Some(id) = (unsafe { id.as_ref() }).copied() else { return std::ptr::null_mut() };
        let mut queues = self.queues.borrow_mut();
        let place = queues.iter().position(|(queue, _)| queue.id == id).unwrap_or(queues.len());
        if place == queues.len() {
            let queue = ComWrapper::new(OutputQueue { id, points: RefCell::default() });
            let Some(pointer) = queue.to_com_ptr() else { return std::ptr::null_mut() };
            queues.push((queue, pointer));
        }
        // SAFETY: null or a writable location.
        unsafe { write_if_wanted(index, place as int32) };
        queues[place].1.as_ptr()
    }
}

/// All changes within a block.
pub struct ParameterChanges {
    queues: Vec<ComPtr<IParamValueQueue>>,
}

impl ParameterChanges {
    /// `events` in order of their offsets.
    pub fn new<'a>(events: impl Iterator<Item = &'a Event>) -> Self {
        let mut queues: Vec<Queue> = Vec::new();
        for event in events {
            let point = (event.offset as int32, event.value.clamp(0.0, 1.0));
            match queues.iter_mut().find(|queue| queue.id == event.id) {
                Some(queue) => queue.points.push(point),
                None => queues.push(Queue { id: event.id, points: vec![point] }),
            }
        }
        Self { queues: queues.into_iter().filter_map(|queue| ComWrapper::new(queue).to_com_ptr()).collect() }
    }
}

impl Class for ParameterChanges {
    type Interfaces = (IParameterChanges,);
}

impl IParameterChangesTrait for ParameterChanges {
    unsafe fn getParameterCount(&self) -> int32 {
        self.queues.len() as int32
    }

    unsafe fn getParameterData(&self, index: int32) -> *mut IParamValueQueue {
        usize::try_from(index).ok().and_then(|i| self.queues.get(i)).map_or(std::ptr::null_mut(), ComPtr::as_ptr)
    }

    /// Input changes are the host's to fill.
    unsafe fn addParameterData(&self, _: *const ParamID, _: *mut int32) -> *mut IParamValueQueue {
        std::ptr::null_mut()
    }
}
