//! The controlling half: parameters and their groups.

use pyrophone_settings::controller_file::CONTROLLERS;
use pyrophone_settings::{COUNT, PARAMETERS, ParameterKind};
use std::sync::atomic::Ordering;
use vst3::Steinberg::Vst::{
    BusDirection, CString, IComponentHandler, IComponentHandler3, IEditControllerTrait, IMidiMappingTrait,
    IUnitInfoTrait, MediaType, ParamID, ParamValue, ParameterInfo, ParameterInfo_::ParameterFlags_, ProgramListID,
    ProgramListInfo, String128, TChar, UnitID, UnitInfo, kNoParentUnitId, kNoProgramListId, kRootUnitId,
};
use vst3::Steinberg::{
    FIDString, IBStream, IPlugView, int16, int32, kInvalidArgument, kNotImplemented, kResultFalse, kResultOk, tresult,
};
use vst3::{ComPtr, ComRef};

use super::component::Component;
use super::controllers::{describe, id_of, number_of};
use super::host_menu::Vst3Menu;
use super::text;
use super::view::View;
use crate::controllers::value_at;
use crate::entry::instance::{NUMERIC_IDS, index_of_numeric};
use crate::host_menu::Provider;

impl Component {
    /// Applies a controller's movement while playback is stopped; otherwise the next block carries it.
    fn move_controller(&self, number: u8, position: f64) {
        if self.is_processing.load(Ordering::SeqCst) {
            return;
        }
        let assigned = &self.instance.params.controllers;
        self.controllers.set_position(assigned, number, position);
        for index in assigned.targets(number) {
            // SAFETY: a live controller; it stores values at once while processing is off.
            unsafe { self.controller.setParamNormalized(NUMERIC_IDS[index], value_at(index, position)) };
        }
    }
}

impl IEditControllerTrait for Component {
    unsafe fn setComponentState(&self, state: *mut IBStream) -> tresult {
        // SAFETY: a live controller.
        unsafe { self.controller.setComponentState(state) }
    }

    unsafe fn setState(&self, state: *mut IBStream) -> tresult {
        // SAFETY: a live controller; it stores nothing itself.
        unsafe { IEditControllerTrait::setState(&self.controller, state) }
    }

    unsafe fn getState(&self, state: *mut IBStream) -> tresult {
        // SAFETY: a live controller; it stores nothing itself.
        unsafe { IEditControllerTrait::getState(&self.controller, state) }
    }

    unsafe fn getParameterCount(&self) -> int32 {
        // The MIDI controllers come last.
        COUNT as int32 + int32::from(CONTROLLERS)
    }

    unsafe fn getParameterInfo(&self, index: int32, info: *mut ParameterInfo) -> tresult {
        if info.is_null() || index < 0 {
            return kInvalidArgument;
        }
        // The framework panics at the index after the last.
        if let Some(number) = (index as usize).checked_sub(COUNT) {
            let Some(number) = u8::try_from(number).ok().filter(|number| *number < CONTROLLERS) else {
                return kInvalidArgument;
            };
            // SAFETY: a writable location.
            describe(number, unsafe { &mut *info });
            return kResultOk;
        }
        // SAFETY: a live controller and a writable location.
        let result = unsafe { self.controller.getParameterInfo(index, info) };
        // SAFETY: just written.
        let info = unsafe { &mut *info };
        if result == kResultOk
            && let Some(index) = index_of_numeric(info.id)
        {
            let parameter = &PARAMETERS[index];
            text::write(parameter.unit, &mut info.units);
            if matches!(parameter.kind, ParameterKind::Choice { .. }) {
                info.flags |= ParameterFlags_::kIsList;
            }
        }
        result
    }

    unsafe fn getParamStringByValue(&self, id: ParamID, value: ParamValue, string: *mut String128) -> tresult {
        if string.is_null() {
            return kInvalidArgument;
        }
        if number_of(id).is_some() {
            // SAFETY: a writable location.
            text::write(&format!("{:.0}", 127.0 * value.clamp(0.0, 1.0)), unsafe { &mut *string });
            return kResultOk;
        }
        // SAFETY: a live controller and a writable location.
        let result = unsafe { self.controller.getParamStringByValue(id, value, string) };
        if result == kResultOk
            && let Some(index) = index_of_numeric(id)
            && !PARAMETERS[index].unit.is_empty()
        {
            // SAFETY: just written.
            let string = unsafe { &mut *string };
            let whole = text::read(string);
            // Hosts append the unit themselves.
            text::write(whole.strip_suffix(PARAMETERS[index].unit).map_or(whole.as_str(), str::trim_end), string);
        }
        result
    }

    unsafe fn getParamValueByString(&self, id: ParamID, string: *mut TChar, value: *mut ParamValue) -> tresult {
        // SAFETY: a live controller; the function rejects null.
        unsafe { self.controller.getParamValueByString(id, string, value) }
    }

    unsafe fn normalizedParamToPlain(&self, id: ParamID, value: ParamValue) -> ParamValue {
        // SAFETY: a live controller.
        unsafe { self.controller.normalizedParamToPlain(id, value) }
    }

    unsafe fn plainParamToNormalized(&self, id: ParamID, value: ParamValue) -> ParamValue {
        // SAFETY: a live controller.
        unsafe { self.controller.plainParamToNormalized(id, value) }
    }

    unsafe fn getParamNormalized(&self, id: ParamID) -> ParamValue {
        if let Some(number) = number_of(id) {
            return self.controllers.position(number);
        }
        let pending = index_of_numeric(id).and_then(|index| self.pending.get(index));
        // SAFETY: a live controller.
        pending.unwrap_or_else(|| unsafe { self.controller.getParamNormalized(id) })
    }

    unsafe fn setParamNormalized(&self, id: ParamID, value: ParamValue) -> tresult {
        if !value.is_finite() {
            return kInvalidArgument;
        }
        if let Some(number) = number_of(id) {
            self.move_controller(number, value);
            return kResultOk;
        }
        let Some(index) = index_of_numeric(id) else { return kInvalidArgument };
        if self.is_processing.load(Ordering::SeqCst) {
            if self.pending.is_echo(index, value) {
                return kResultOk;
            }
            // The engines receive it with the next block, at its sample; until then this is the value that the host
            // reads and saves.
            self.pending.set(index, value);
            return kResultOk;
        }
        // SAFETY: a live controller.
        unsafe { self.controller.setParamNormalized(id, value) }
    }

    unsafe fn setComponentHandler(&self, handler: *mut IComponentHandler) -> tresult {
        // SAFETY: null or a live handler, to which a reference is kept.
        let own = unsafe { ComRef::from_raw(handler) }.and_then(|handler| handler.cast::<IComponentHandler3>());
        let menu = own.map(|handler| Box::new(Vst3Menu::new(handler, self.view.clone())) as Box<dyn Provider>);
        self.instance.params.host_menu.set_provider(menu);
        // SAFETY: a live controller; null removes the handler.
        unsafe { self.controller.setComponentHandler(handler) }
    }

    unsafe fn createView(&self, name: FIDString) -> *mut IPlugView {
        // SAFETY: a live controller, which returns a view with one reference, or null.
        let view = unsafe { ComPtr::from_raw(self.controller.createView(name)) };
        let view = view.and_then(|view| View::new(view, self.view.clone()).to_com_ptr::<IPlugView>());
        view.map_or(std::ptr::null_mut(), ComPtr::into_raw)
    }
}

impl IMidiMappingTrait for Component {
    unsafe fn getMidiControllerAssignment(
        &self,
        bus: int32,
        channel: int16,
        controller: int16,
        id: *mut ParamID,
    ) -> tresult {
        if id.is_null() {
            return kInvalidArgument;
        }
        let number = u8::try_from(controller).ok().filter(|number| *number < CONTROLLERS);
        let Some(number) = number.filter(|_| bus == 0 && (0..16).contains(&channel)) else { return kResultFalse };
        // SAFETY: a writable location.
        unsafe { id.write(id_of(number)) };
        kResultOk
    }
}

impl IUnitInfoTrait for Component {
    unsafe fn getUnitCount(&self) -> int32 {
        // The framework leaves the root out.
        // SAFETY: a live object.
        1 + unsafe { self.units.getUnitCount() }
    }

    unsafe fn getUnitInfo(&self, index: int32, info: *mut UnitInfo) -> tresult {
        // SAFETY: null or a writable location.
        let Some(place) = (unsafe { info.as_mut() }) else { return kInvalidArgument };
        if index == 0 {
            // SAFETY: all fields are numbers, for which zero is valid.
            *place = unsafe { std::mem::zeroed() };
            (place.id, place.parentUnitId, place.programListId) = (kRootUnitId, kNoParentUnitId, kNoProgramListId);
            text::write("Pyrophone", &mut place.name);
            return kResultOk;
        }
        // SAFETY: a live object.
        if !(0..unsafe { self.getUnitCount() }).contains(&index) {
            return kInvalidArgument;
        }
        // SAFETY: a live object and a writable location.
        unsafe { self.units.getUnitInfo(index - 1, info) }
    }

    unsafe fn getProgramListCount(&self) -> int32 {
        0
    }

    unsafe fn getProgramListInfo(&self, _index: int32, _info: *mut ProgramListInfo) -> tresult {
        kInvalidArgument
    }

    unsafe fn getProgramName(&self, _list: ProgramListID, _index: int32, _name: *mut String128) -> tresult {
        kInvalidArgument
    }

    unsafe fn getProgramInfo(
        &self,
        _list: ProgramListID,
        _index: int32,
        _attribute: CString,
        _value: *mut String128,
    ) -> tresult {
        kInvalidArgument
    }

    unsafe fn hasProgramPitchNames(&self, _list: ProgramListID, _index: int32) -> tresult {
        kResultFalse
    }

    unsafe fn getProgramPitchName(
        &self,
        _list: ProgramListID,
        _index: int32,
        _pitch: int16,
        _name: *mut String128,
    ) -> tresult {
        kInvalidArgument
    }

    unsafe fn getSelectedUnit(&self) -> UnitID {
        kRootUnitId
    }

    unsafe fn selectUnit(&self, _unit: UnitID) -> tresult {
        kResultFalse
    }

    unsafe fn getUnitByBus(
        &self,
        _kind: MediaType,
        _direction: BusDirection,
        _bus: int32,
        _channel: int32,
        _unit: *mut UnitID,
    ) -> tresult {
        kResultFalse
    }

    unsafe fn setUnitProgramData(&self, _list_or_unit: int32, _index: int32, _data: *mut IBStream) -> tresult {
        kNotImplemented
    }
}
