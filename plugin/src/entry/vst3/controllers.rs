//! MIDI controllers, which VST3 hosts know as parameters alone.
//!
//! Each controller is a hidden parameter, to which it is mapped on every MIDI channel. Where a block moves one, the
//! framework receives values of the assigned parameters, besides the host's own, and the host receives the result.

use std::sync::atomic::{AtomicI32, AtomicPtr, AtomicU16, AtomicU32, Ordering};

use atomic_float::AtomicF64;
use pyrophone_settings::COUNT;
use pyrophone_settings::controller_file::CONTROLLERS;
use vst3::Steinberg::Vst::{
    IParamValueQueue, IParamValueQueueTrait, IParameterChanges, IParameterChangesTrait, ParamID, ParamValue,
    ParameterInfo, ParameterInfo_::ParameterFlags_, kRootUnitId,
};
use vst3::Steinberg::{int32, kInvalidArgument, kResultFalse, kResultOk, tresult};
use vst3::{Class, ComPtr, ComRef, ComWrapper};

use super::text;
use crate::controllers::{Controllers, value_at};
use crate::entry::instance::NUMERIC_IDS;

/// Id of controller 0's parameter; the others follow it. It must never change: projects may hold automation of them.
const FIRST_ID: ParamID = 0x7fff_0000;
/// Maximum number of values per block for one parameter; beyond it, the last one replaces the rest.
const MOST: usize = 64;

/// Id of the parameter that a controller is.
pub fn id_of(number: u8) -> ParamID {
    FIRST_ID + ParamID::from(number)
}

/// The controller that a parameter is, if it is one.
pub fn number_of(id: ParamID) -> Option<u8> {
    id.checked_sub(FIRST_ID).and_then(|number| u8::try_from(number).ok()).filter(|number| *number < CONTROLLERS)
}

/// Fills in the description of a controller's parameter.
pub fn describe(number: u8, info: &mut ParameterInfo) {
    // SAFETY: all fields are numbers, for which zero is valid.
    *info = unsafe { std::mem::zeroed() };
    info.id = id_of(number);
    info.unitId = kRootUnitId;
    info.flags = ParameterFlags_::kIsHidden;
    let name = format!("MIDI controller {number}");
    text::write(&name, &mut info.title);
    text::write(&name, &mut info.shortTitle);
}

/// The values that a block brings to one parameter. Only the audio thread writes and reads them.
struct Queue {
    id: ParamID,
    offsets: [AtomicI32; MOST],
    values: [AtomicF64; MOST],
    count: AtomicU32,
}

impl Queue {
    fn new(id: ParamID) -> Self {
        let (offsets, values) =
            (std::array::from_fn(|_| AtomicI32::new(0)), std::array::from_fn(|_| AtomicF64::new(0.0)));
        Self { id, offsets, values, count: AtomicU32::new(0) }
    }

    fn push(&self, offset: int32, value: f64) {
        let count = self.count.load(Ordering::Relaxed) as usize;
        let place = count.min(MOST - 1);
        self.offsets[place].store(offset, Ordering::Relaxed);
        self.values[place].store(value, Ordering::Relaxed);
        self.count.store(place as u32 + 1, Ordering::Relaxed);
    }

    fn point(&self, place: usize) -> Option<(int32, f64)> {
        let is_there = place < self.count.load(Ordering::Relaxed) as usize;
        let value = || self.values[place].load(Ordering::Relaxed);
        is_there.then(|| (self.offsets[place].load(Ordering::Relaxed), value()))
    }

    fn last(&self) -> Option<(int32, f64)> {
        self.point((self.count.load(Ordering::Relaxed) as usize).checked_sub(1)?)
    }
}

impl Class for Queue {
    type Interfaces = (IParamValueQueue,);
}

impl IParamValueQueueTrait for Queue {
    unsafe fn getParameterId(&self) -> ParamID {
        self.id
    }

    unsafe fn getPointCount(&self) -> int32 {
        self.count.load(Ordering::Relaxed) as int32
    }

    unsafe fn getPoint(&self, index: int32, offset: *mut int32, value: *mut ParamValue) -> tresult {
        let point = usize::try_from(index).ok().and_then(|place| self.point(place));
        let Some((at, to)) = point.filter(|_| !offset.is_null() && !value.is_null()) else { return kInvalidArgument };
        // SAFETY: writable locations.
        unsafe {
            offset.write(at);
            value.write(to);
        }
        kResultOk
    }

    unsafe fn addPoint(&self, _offset: int32, _value: ParamValue, _index: *mut int32) -> tresult {
        kResultFalse
    }
}

/// A block's changes: the host's, followed by those of the controllers.
struct Changes {
    host: AtomicPtr<IParameterChanges>,
    /// By the parameter's index in the table.
    queues: Vec<ComWrapper<Queue>>,
    pointers: Vec<ComPtr<IParamValueQueue>>,
    /// Indices of the parameters that controllers move in this block.
    moved: [AtomicU16; COUNT],
    moved_count: AtomicU32,
}

impl Changes {
    fn host_count(&self) -> int32 {
        // SAFETY: null or the block's changes, which live as long as it does.
        let host = unsafe { ComRef::from_raw(self.host.load(Ordering::Relaxed)) };
        // SAFETY: live changes.
        host.map_or(0, |host| unsafe { host.getParameterCount() }.max(0))
    }

    fn push(&self, index: usize, offset: int32, value: f64) {
        let queue = &self.queues[index];
        if queue.last().is_none() {
            let count = self.moved_count.load(Ordering::Relaxed);
            self.moved[count as usize].store(index as u16, Ordering::Relaxed);
            self.moved_count.store(count + 1, Ordering::Relaxed);
        }
        queue.push(offset, value);
    }

    fn moved(&self) -> impl Iterator<Item = usize> {
        let count = self.moved_count.load(Ordering::Relaxed) as usize;
        self.moved[..count].iter().map(|index| usize::from(index.load(Ordering::Relaxed)))
    }
}

impl Class for Changes {
    type Interfaces = (IParameterChanges,);
}

impl IParameterChangesTrait for Changes {
    unsafe fn getParameterCount(&self) -> int32 {
        self.host_count() + self.moved_count.load(Ordering::Relaxed) as int32
    }

    unsafe fn getParameterData(&self, index: int32) -> *mut IParamValueQueue {
        let own = index - self.host_count();
        if own < 0 {
            // SAFETY: null or the block's changes.
            let host = unsafe { ComRef::from_raw(self.host.load(Ordering::Relaxed)) };
            // SAFETY: live changes.
            return host.map_or(std::ptr::null_mut(), |host| unsafe { host.getParameterData(index) });
        }
        self.moved().nth(own as usize).map_or(std::ptr::null_mut(), |index| self.pointers[index].as_ptr())
    }

    unsafe fn addParameterData(&self, _id: *const ParamID, _index: *mut int32) -> *mut IParamValueQueue {
        std::ptr::null_mut()
    }
}

/// Controllers of an instance: their positions, and the parameters they move in the current block.
pub struct ControllerInput {
    /// Positions, by number.
    positions: [AtomicF64; CONTROLLERS as usize],
    changes: ComWrapper<Changes>,
}

impl Default for ControllerInput {
    fn default() -> Self {
        let queues: Vec<ComWrapper<Queue>> = NUMERIC_IDS.iter().map(|id| ComWrapper::new(Queue::new(*id))).collect();
        let pointers = queues.iter().filter_map(|queue| queue.to_com_ptr()).collect();
        let changes = Changes {
            host: AtomicPtr::default(),
            queues,
            pointers,
            moved: std::array::from_fn(|_| AtomicU16::new(0)),
            moved_count: AtomicU32::new(0),
        };
        Self { positions: std::array::from_fn(|_| AtomicF64::new(0.0)), changes: ComWrapper::new(changes) }
    }
}

impl ControllerInput {
    /// Position of a controller, 0-1.
    pub fn position(&self, number: u8) -> f64 {
        self.positions[usize::from(number)].load(Ordering::Relaxed)
    }

    /// Sets a controller's position, which completes a pending MIDI learn. Real-time safe.
    pub fn set_position(&self, controllers: &Controllers, number: u8, position: f64) {
        controllers.note_moved(number);
        self.positions[usize::from(number)].store(position.clamp(0.0, 1.0), Ordering::Relaxed);
    }

    /// Reads a block's changes and returns those for the framework; real-time safe.
    ///
    /// # Safety
    /// `host` is null or live until [`finish`](Self::finish).
    pub unsafe fn apply_controllers(
        &self,
        controllers: &Controllers,
        host: *mut IParameterChanges,
    ) -> *mut IParameterChanges {
        self.finish();
        // SAFETY: guaranteed by the caller.
        let Some(changes) = (unsafe { ComRef::from_raw(host) }) else { return host };
        self.changes.host.store(host, Ordering::Relaxed);
        // SAFETY: live changes, whose queues live as long as they do.
        unsafe {
            for index in 0..changes.getParameterCount() {
                let Some(queue) = ComRef::from_raw(changes.getParameterData(index)) else { continue };
                if let Some(number) = number_of(queue.getParameterId()) {
                    self.follow_one(controllers, number, &queue);
                }
            }
        }
        self.changes.as_com_ref::<IParameterChanges>().map_or(host, |own| own.as_ptr())
    }

    /// # Safety
    /// A live queue.
    unsafe fn follow_one(&self, controllers: &Controllers, number: u8, queue: &ComRef<'_, IParamValueQueue>) {
        let (mut offset, mut position) = (0, 0.0);
        // SAFETY: guaranteed by the caller; writable locations.
        for point in 0..unsafe { queue.getPointCount() } {
            // SAFETY: as above.
            let result = unsafe { queue.getPoint(point, &mut offset, &mut position) };
            if result != kResultOk || !position.is_finite() {
                continue;
            }
            self.set_position(controllers, number, position);
            controllers.targets(number).for_each(|index| self.changes.push(index, offset, value_at(index, position)));
        }
    }

    /// Indices of the parameters that the block's controllers move, and their values at its end; real-time safe.
    pub fn moved(&self) -> impl Iterator<Item = (usize, f64)> {
        self.changes.moved().filter_map(|index| Some((index, self.changes.queues[index].last()?.1)))
    }

    /// Reports the moved parameters to the host, if it accepts reports; real-time safe where the host is.
    ///
    /// # Safety
    /// `outputs` is null or live.
    pub unsafe fn report_values(&self, outputs: *mut IParameterChanges) {
        // SAFETY: guaranteed by the caller.
        let Some(outputs) = (unsafe { ComRef::from_raw(outputs) }) else { return };
        for (index, value) in self.moved() {
            let mut place = 0;
            // SAFETY: live changes, which return null or a queue that lives as long; readable and writable locations.
            unsafe {
                let queue = outputs.addParameterData(&NUMERIC_IDS[index], &mut place);
                if let Some(queue) = ComRef::from_raw(queue) {
                    queue.addPoint(0, value, &mut place);
                }
            }
        }
    }

    /// Forgets the block.
    pub fn finish(&self) {
        self.changes.host.store(std::ptr::null_mut(), Ordering::Relaxed);
        self.changes.moved().for_each(|index| self.changes.queues[index].count.store(0, Ordering::Relaxed));
        self.changes.moved_count.store(0, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controllers::assignable;
    use crate::entry::instance::index_of_numeric;

    #[test]
    fn ids_are_a_promise_and_no_parameters() {
        assert_eq!((id_of(0), id_of(119)), (0x7fff_0000, 0x7fff_0077));
        assert_eq!((number_of(id_of(119)), number_of(id_of(119) + 1), number_of(0)), (Some(119), None, None));
        assert!((0..CONTROLLERS).all(|number| index_of_numeric(id_of(number)).is_none()));
    }

    #[test]
    fn a_controller_moves_what_follows_it_at_its_samples() {
        let controllers = Controllers::default();
        let [alpha, size] = ["alpha", "macro_size"].map(|id| assignable(id).expect("automatable"));
        controllers.assign(alpha, Some(1));
        controllers.assign(size, Some(1));
        let (input, host) = (ControllerInput::default(), ControllerInput::default());
        // The host's own automation, and its controllers, are changes of the same make.
        host.changes.push(alpha, 0, 0.25);
        let moving = ComWrapper::new(Queue::new(id_of(1)));
        moving.push(3, 1.0);
        moving.push(9, 0.5);
        let pointer = host.changes.as_com_ref::<IParameterChanges>().expect("an interface").as_ptr();
        // SAFETY: live changes and a live queue.
        unsafe {
            let queue = moving.as_com_ref::<IParamValueQueue>().expect("an interface");
            let mut own = std::ptr::null_mut();
            let follow = || {
                own = input.apply_controllers(&controllers, pointer);
                input.follow_one(&controllers, 1, &queue);
            };
            assert_eq!(allocation_counter::measure(follow).count_total, 0);
            let own = ComRef::from_raw(own).expect("changes");
            assert_eq!(own.getParameterCount(), 3);
            let ids =
                [0, 1, 2].map(|index| ComRef::from_raw(own.getParameterData(index)).expect("a queue").getParameterId());
            assert_eq!(ids, [NUMERIC_IDS[alpha], NUMERIC_IDS[alpha], NUMERIC_IDS[size]]);
            let (mut offset, mut value) = (0, 0.0);
            let queue = ComRef::from_raw(own.getParameterData(2)).expect("a queue");
            assert_eq!((queue.getPointCount(), queue.getPoint(1, &mut offset, &mut value)), (2, kResultOk));
            assert_eq!((offset, value), (9, value_at(size, 0.5)));
        }
        assert_eq!(input.moved().map(|(index, _)| index).collect::<Vec<_>>(), [alpha, size]);
        assert_eq!(input.position(1), 0.5);
        input.finish();
        assert_eq!(input.moved().count(), 0);
    }

    #[test]
    fn the_last_of_too_many_values_is_kept() {
        let queue = Queue::new(1);
        (0..3 * MOST).for_each(|n| queue.push(n as i32, n as f64));
        assert_eq!(queue.last(), Some((3 * MOST as i32 - 1, 3.0 * MOST as f64 - 1.0)));
        assert_eq!(queue.count.load(Ordering::Relaxed) as usize, MOST);
    }
}
