//! Description of a VST3 plug-in: its parameters and layouts.

use std::collections::HashMap;
use std::ffi::CStr;

use ::vst3::Steinberg::Vst::{
    IComponent, IEditController, IEditControllerTrait, IMidiMapping, IMidiMappingTrait, IUnitInfo, IUnitInfoTrait,
    ParameterInfo, ParameterInfo_::ParameterFlags_, SpeakerArr, SpeakerArrangement, UnitInfo,
};
use ::vst3::Steinberg::{IPluginFactoryTrait, PClassInfo, kResultOk};
use ::vst3::{ComPtr, Interface};

use super::module::Module;
use crate::Parameter;

/// Creates the first audio effect of a module and gives its name.
pub(super) fn create_component(module: &Module) -> Option<(ComPtr<IComponent>, String)> {
    let factory = module.factory();
    // SAFETY: a live factory.
    for index in 0..unsafe { factory.countClasses() } {
        // SAFETY: all fields are numbers, for which zero is a value.
        let mut info: PClassInfo = unsafe { std::mem::zeroed() };
        // SAFETY: a live factory and a writable location.
        if unsafe { factory.getClassInfo(index, &mut info) } != kResultOk
            || from_c(&info.category) != "Audio Module Class"
        {
            continue;
        }
        let mut object = std::ptr::null_mut();
        // SAFETY: ids of 16 bytes each and a writable location.
        let result = unsafe { factory.createInstance(info.cid.as_ptr(), IComponent::IID.as_ptr().cast(), &mut object) };
        if result == kResultOk {
            // SAFETY: the factory has given an `IComponent` and one reference to it.
            return unsafe { ComPtr::from_raw(object.cast::<IComponent>()) }
                .map(|component| (component, from_c(&info.name)));
        }
    }
    None
}

pub(super) fn read_parameters(controller: &ComPtr<IEditController>) -> Vec<Parameter> {
    let groups = read_groups(controller);
    // SAFETY: a live controller.
    (0..unsafe { controller.getParameterCount() })
        .filter_map(|index| {
            // SAFETY: all fields are numbers, for which zero is a value.
            let mut info: ParameterInfo = unsafe { std::mem::zeroed() };
            // SAFETY: a live controller and a writable location.
            if unsafe { controller.getParameterInfo(index, &mut info) } != kResultOk {
                return None;
            }
            let has = |flag| info.flags & flag != 0;
            // MIDI controllers are parameters, and nothing that people see.
            if has(ParameterFlags_::kIsHidden) && !has(ParameterFlags_::kCanAutomate) {
                return None;
            }
            Some(Parameter {
                id: info.id,
                name: from_utf16(&info.title),
                group: groups.get(&info.unitId).cloned().unwrap_or_default(),
                unit: from_utf16(&info.units),
                steps: u32::try_from(info.stepCount).unwrap_or(0),
                default: info.defaultNormalizedValue,
                automatable: has(ParameterFlags_::kCanAutomate),
                hidden: has(ParameterFlags_::kIsHidden),
                bypass: has(ParameterFlags_::kIsBypass),
            })
        })
        .collect()
}

/// Paths of the groups by unit id; the root, which has no name here, is left out.
fn read_groups(controller: &ComPtr<IEditController>) -> HashMap<i32, String> {
    let mut groups: HashMap<i32, String> = HashMap::new();
    let Some(units) = controller.cast::<IUnitInfo>() else {
        return groups;
    };
    // SAFETY: a live interface.
    for index in 0..unsafe { units.getUnitCount() } {
        // SAFETY: all fields are numbers, for which zero is a value.
        let mut info: UnitInfo = unsafe { std::mem::zeroed() };
        // SAFETY: a live interface and a writable location.
        if unsafe { units.getUnitInfo(index, &mut info) } != kResultOk || info.id == 0 {
            continue;
        }
        let name = from_utf16(&info.name);
        let path = match groups.get(&info.parentUnitId) {
            Some(parent) => format!("{parent}/{name}"),
            None => name,
        };
        groups.insert(info.id, path);
    }
    groups
}

/// The arrangement for a number of channels; nice-plug uses only the number.
pub(super) const fn arrangement(channels: u32) -> SpeakerArrangement {
    match channels {
        0 => SpeakerArr::kEmpty,
        1 => SpeakerArr::kMono,
        2 => SpeakerArr::kStereo,
        5 => SpeakerArr::k50,
        6 => SpeakerArr::k51,
        64.. => SpeakerArrangement::MAX,
        _ => (1 << channels) - 1,
    }
}

/// The parameters that the controllers of the first MIDI channel are, by number.
pub(super) fn read_controllers(controller: &ComPtr<IEditController>) -> Vec<Option<u32>> {
    let mapping = controller.cast::<IMidiMapping>();
    let id_of = |number| {
        let mut id = 0;
        // SAFETY: a live interface and a writable location.
        let result = unsafe { mapping.as_ref()?.getMidiControllerAssignment(0, 0, number, &mut id) };
        (result == kResultOk).then_some(id)
    };
    (0..128).map(id_of).collect()
}

pub(super) fn from_utf16(text: &[u16]) -> String {
    let length = text.iter().position(|&c| c == 0).unwrap_or(text.len());
    String::from_utf16_lossy(&text[..length])
}

pub(super) fn from_c(text: &[std::ffi::c_char]) -> String {
    let bytes: Vec<u8> = text.iter().map(|&c| c as u8).chain([0]).collect();
    CStr::from_bytes_until_nul(&bytes).map(|text| text.to_string_lossy().into_owned()).unwrap_or_default()
}
