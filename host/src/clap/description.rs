//! Description of a CLAP plug-in: its parameters and layouts.

use std::collections::HashMap;

use clack_extensions::audio_ports::{AudioPortInfoBuffer, PluginAudioPorts};
use clack_extensions::params::{ParamInfoBuffer, ParamInfoFlags, PluginParams};
use clack_host::prelude::*;

use super::handlers::Handlers;
use crate::{BusLayout, Parameter};

/// Lowest and highest value that CLAP knows for a parameter.
#[derive(Clone, Copy)]
pub(super) struct Range {
    lowest: f64,
    highest: f64,
}

impl Range {
    pub fn plain(self, normalized: f64) -> f64 {
        self.lowest + normalized.clamp(0.0, 1.0) * (self.highest - self.lowest)
    }

    pub fn normalized(self, plain: f64) -> f64 {
        if self.highest > self.lowest { (plain - self.lowest) / (self.highest - self.lowest) } else { 0.0 }
    }
}

pub(super) fn read_parameters(instance: &mut PluginInstance<Handlers>) -> (Vec<Parameter>, HashMap<u32, Range>) {
    let handle = instance.plugin_handle();
    let Some(params) = handle.get_extension::<PluginParams>() else {
        return (Vec::new(), HashMap::new());
    };
    let mut ranges = HashMap::new();
    let parameters = (0..params.count(&handle))
        .filter_map(|index| {
            let mut buffer = ParamInfoBuffer::new();
            let info = params.get_info(&handle, index, &mut buffer)?;
            let range = Range { lowest: info.min_value, highest: info.max_value };
            ranges.insert(info.id.get(), range);
            let stepped = info.flags.contains(ParamInfoFlags::IS_STEPPED);
            Some(Parameter {
                id: info.id.get(),
                name: String::from_utf8_lossy(info.name).into_owned(),
                group: String::from_utf8_lossy(info.module).into_owned(),
                unit: String::new(),
                steps: if stepped { (range.highest - range.lowest) as u32 } else { 0 },
                default: range.normalized(info.default_value),
                automatable: info.flags.contains(ParamInfoFlags::IS_AUTOMATABLE),
                hidden: info.flags.contains(ParamInfoFlags::IS_HIDDEN),
                bypass: info.flags.contains(ParamInfoFlags::IS_BYPASS),
            })
        })
        .collect();
    (parameters, ranges)
}

pub(super) fn read_layout(ports: &PluginAudioPorts, handle: &PluginMainThreadHandle<'_>) -> BusLayout {
    let channels = |index, is_input| {
        ports.get(handle, index, is_input, &mut AudioPortInfoBuffer::new()).map_or(0, |port| port.channel_count)
    };
    BusLayout { input: channels(0, true), sidechain: channels(1, true), output: channels(0, false) }
}
