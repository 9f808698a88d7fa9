//! Configurable ports and surround.

use std::path::Path;

use clap_sys::ext::audio_ports::{CLAP_EXT_AUDIO_PORTS, clap_audio_port_info, clap_plugin_audio_ports};
use clap_sys::ext::configurable_audio_ports::{
    CLAP_EXT_CONFIGURABLE_AUDIO_PORTS, clap_audio_port_configuration_request, clap_plugin_configurable_audio_ports,
};
use clap_sys::ext::surround::{CLAP_EXT_SURROUND, clap_plugin_surround};

use crate::validator::ensure;

use super::raw::Raw;

/// The check `ports_are_configured_as_asked`.
pub(super) fn ports(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    // SAFETY: the ids' types, a live plug-in, and writable locations whose fields are numbers and null pointers.
    unsafe {
        let configurable: &clap_plugin_configurable_audio_ports = raw.extension(CLAP_EXT_CONFIGURABLE_AUDIO_PORTS)?;
        let ports: &clap_plugin_audio_ports = raw.extension(CLAP_EXT_AUDIO_PORTS)?;
        let surround: &clap_plugin_surround = raw.extension(CLAP_EXT_SURROUND)?;
        let request = |is_input, channel_count| clap_audio_port_configuration_request {
            is_input,
            port_index: 0,
            channel_count,
            port_type: std::ptr::null(),
            port_details: std::ptr::null(),
        };
        let apply = configurable.apply_configuration.ok_or("no apply")?;
        let can = configurable.can_apply_configuration.ok_or("no can_apply")?;
        for (input, output, map) in
            [(1, 1, &[][..]), (2, 2, &[]), (5, 5, &[0, 1, 2, 9, 10]), (2, 6, &[0, 1, 2, 3, 9, 10])]
        {
            let requests = [request(true, input), request(false, output)];
            let is_applied = can(raw.plugin, requests.as_ptr(), 2) && apply(raw.plugin, requests.as_ptr(), 2);
            ensure(is_applied, || format!("{input} in, {output} out is not applied"))?;
            let mut info: clap_audio_port_info = std::mem::zeroed();
            (ports.get.ok_or("no get")?)(raw.plugin, 0, false, &mut info);
            ensure(info.channel_count == output, || {
                format!("{output} out were asked, {} are there", info.channel_count)
            })?;
            let mut found = [0u8; 8];
            let count = (surround.get_channel_map.ok_or("no map")?)(raw.plugin, false, 0, found.as_mut_ptr(), 8);
            ensure(&found[..count as usize] == map, || format!("the loudspeakers of {output} are {found:?}"))?;
        }
        // It does not have loudspeakers in another order, or other ones.
        for (map, is_ours) in [([0u8, 1, 2, 3, 9, 10], true), ([0, 1, 2, 3, 4, 5], false), ([0, 2, 1, 9, 10, 3], false)]
        {
            let asked = clap_audio_port_configuration_request {
                port_type: clap_sys::ext::surround::CLAP_PORT_SURROUND.as_ptr(),
                port_details: map.as_ptr().cast(),
                ..request(false, 6)
            };
            ensure(can(raw.plugin, &asked, 1) == is_ours, || format!("loudspeakers {map:?}"))?;
        }
        let absurd = [request(true, 77)];
        ensure(!can(raw.plugin, absurd.as_ptr(), 1), || "77 channels are taken".to_owned())?;
        let known = surround.is_channel_mask_supported.ok_or("no mask")?;
        ensure(known(raw.plugin, 0b110_0000_1111) && !known(raw.plugin, 0b1), || "masks are wrong".to_owned())
    }
}
