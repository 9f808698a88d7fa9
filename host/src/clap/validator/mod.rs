//! Checks of a CLAP bundle, see [`validator`](crate::validator). They use the C interface directly, since a host that
//! breaks the rules cannot be built on bindings that enforce them.
//!
//! | module | content |
//! |---|---|
//! | `raw` | an instance over the C interface, and its host |
//! | `events` | lists of events, and buses |
//! | `discovery`, `preset_recording`, `extensions`, `ports` | checks that need more than that |

mod discovery;
mod events;
mod extensions;
mod ports;
mod preset_recording;
mod raw;

use std::collections::BTreeSet;
use std::ffi::c_char;
use std::path::Path;

use clap_sys::audio_buffer::clap_audio_buffer;
use clap_sys::events::clap_event_param_value;
use clap_sys::ext::latency::{CLAP_EXT_LATENCY, clap_plugin_latency};
use clap_sys::ext::params::{
    CLAP_EXT_PARAMS, CLAP_PARAM_IS_BYPASS, CLAP_PARAM_IS_ENUM, CLAP_PARAM_IS_MODULATABLE, CLAP_PARAM_IS_STEPPED,
    clap_plugin_params,
};
use clap_sys::process::CLAP_PROCESS_ERROR;

use crate::numeric_id;
use crate::validator::{Check, ODD_RATES_HZ, duplicate, ensure};

use discovery::presets;
use events::{bus, event, null_channels};
use extensions::extensions;
use ports::ports;
use preset_recording::preset_recording;
use raw::{BLOCK, Raw};

/// All checks.
pub(crate) const CHECKS: &[Check] = &[
    Check { name: "null_and_missing_buffers_are_survived_and_silent", run: null_and_missing_buffers },
    Check { name: "saved_bytes_do_not_change_by_load_and_save", run: bytes_stay },
    Check { name: "latency_is_announced_within_activate_only", run: latency_within_activate },
    Check { name: "odd_rates_activate_and_pass_sound_through", run: odd_rates },
    Check { name: "names_and_flags_of_parameters_are_sound", run: parameters_are_sound },
    Check { name: "whole_numbers_have_their_plain_values", run: plain_whole_numbers },
    Check { name: "presets_are_discovered_and_loaded", run: presets },
    Check { name: "presets_bring_their_recordings", run: preset_recording },
    Check { name: "extensions_that_hosts_ask_for_answer", run: extensions },
    Check { name: "ports_are_configured_as_asked", run: ports },
];

fn text(of: &[c_char]) -> String {
    let bytes: Vec<u8> = of.iter().map(|byte| *byte as u8).take_while(|byte| *byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

fn null_and_missing_buffers(bundle: &Path) -> Result<(), String> {
    let mut raw = Raw::load(bundle)?;
    raw.activate(48_000.0)?;
    let null = std::ptr::null_mut;
    for inputs in 0..4 {
        for kind in 0..3 {
            let mut output = vec![vec![f32::NAN; BLOCK]; 2];
            let mut out_pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
            let mut silence = vec![0.0f32; BLOCK];
            let mut pointers = [[null(), null()], [silence.as_mut_ptr(), null()], [null(), silence.as_mut_ptr()]];
            let buses: Vec<clap_audio_buffer> = pointers
                .iter_mut()
                .take(inputs)
                .map(|pointers| if kind == 0 { null_channels(2) } else { bus(&mut pointers[..kind]) })
                .collect();
            let status = raw.process(&buses, &mut [bus(&mut out_pointers)], &[]);
            let is_silent = output.iter().flatten().all(|sample| *sample == 0.0);
            ensure(status != CLAP_PROCESS_ERROR && is_silent, || {
                format!("with {inputs} input buses of kind {kind} it answers {status} and is not silent")
            })?;
        }
    }
    for outputs in [vec![], vec![null_channels(2)], vec![null_channels(0)]] {
        let mut outputs = outputs;
        raw.process(&[], &mut outputs, &[]);
        raw.process(&[null_channels(6), null_channels(1)], &mut outputs, &[]);
    }
    Ok(())
}

fn bytes_stay(bundle: &Path) -> Result<(), String> {
    let (raw, other) = (Raw::load(bundle)?, Raw::load(bundle)?);
    let parameters = raw.parameters()?;
    for round in 0..8 {
        let values: Vec<clap_event_param_value> = parameters
            .iter()
            .enumerate()
            .map(|(index, info)| {
                let share = (0.137 * (index + 1) as f64 + 0.31 * f64::from(round)).fract();
                let value = info.min_value + share * (info.max_value - info.min_value);
                event(info.id, if info.flags & CLAP_PARAM_IS_STEPPED != 0 { value.round() } else { value })
            })
            .collect();
        raw.flush(&values)?;
        let saved = raw.save()?;
        other.load_state(&saved)?;
        ensure(other.save()? == saved, || format!("in round {round} the bytes differ"))?;
        let differing = parameters.iter().find(|info| {
            let name = |raw: &Raw| {
                // SAFETY: the id's type, and a writable location.
                unsafe {
                    let params: &clap_plugin_params = raw.extension(CLAP_EXT_PARAMS).ok()?;
                    let mut value = 0.0;
                    (params.get_value?)(raw.plugin, info.id, &mut value).then_some(value)
                }
            };
            // Values off the grid are saved on it.
            name(&raw).zip(name(&other)).is_none_or(|(one, other)| (one - other).abs() > 2e-3 * info.max_value.max(1.0))
        });
        if let Some(info) = differing {
            return Err(format!("{} is not what was saved", text(&info.name)));
        }
    }
    Ok(())
}

fn latency_within_activate(bundle: &Path) -> Result<(), String> {
    let mut raw = Raw::load(bundle)?;
    raw.activate(48_000.0)?;
    raw.run_callbacks();
    let restarts = raw.notices().restarts.get();
    ensure(restarts == 0, || "it asks for a restart at its first activation".to_owned())?;
    // SAFETY: the id's type.
    let latency: &clap_plugin_latency = unsafe { raw.extension(CLAP_EXT_LATENCY)? };
    let get = latency.get.ok_or("no latency")?;
    // SAFETY: a live plug-in.
    let before = unsafe { get(raw.plugin) };
    let mut output = vec![vec![0.0f32; BLOCK]; 2];
    let mut pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
    raw.process(&[], &mut [bus(&mut pointers)], &[event(numeric_id("levels"), 8.0)]);
    for _ in 0..500 {
        raw.process(&[], &mut [bus(&mut pointers)], &[]);
        raw.run_callbacks();
        if raw.notices().restarts.get() > 0 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    ensure(raw.notices().restarts.get() > 0, || "another structure asks for no restart".to_owned())?;
    raw.deactivate();
    raw.activate(48_000.0)?;
    raw.run_callbacks();
    // SAFETY: a live plug-in.
    let after = unsafe { get(raw.plugin) };
    let (announced, misplaced) = (raw.notices().announced.get(), raw.notices().misplaced.get());
    ensure(after > before && announced == 1 && misplaced == 0, || {
        format!("latency {before} -> {after}, announced {announced} times within activate and {misplaced} elsewhere")
    })
}

fn odd_rates(bundle: &Path) -> Result<(), String> {
    for sample_rate in ODD_RATES_HZ {
        let mut raw = Raw::load(bundle)?;
        raw.activate(sample_rate)?;
        let mut input: Vec<Vec<f32>> = (0..2).map(|of| (0..BLOCK).map(|n| (n + of) as f32 / 100.0).collect()).collect();
        let mut output = vec![vec![f32::NAN; BLOCK]; 2];
        let mut in_pointers: Vec<*mut f32> = input.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
        let mut out_pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
        raw.process(&[bus(&mut in_pointers)], &mut [bus(&mut out_pointers)], &[]);
        ensure(output == input, || format!("at {sample_rate} Hz the input does not pass through"))?;
    }
    Ok(())
}

fn parameters_are_sound(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let parameters = raw.parameters()?;
    let names: Vec<String> = parameters.iter().map(|info| text(&info.name)).collect();
    if let Some(name) = duplicate(&names) {
        return Err(format!("two parameters are called {name:?}"));
    }
    let ids: BTreeSet<u32> = parameters.iter().map(|info| info.id).collect();
    ensure(ids.len() == parameters.len(), || "two parameters have one id".to_owned())?;
    let first = parameters.first().is_some_and(|info| info.flags & CLAP_PARAM_IS_BYPASS != 0);
    ensure(first, || "bypass is not the first".to_owned())?;
    for info in &parameters {
        let has = |flag| info.flags & flag != 0;
        let name = text(&info.name);
        ensure(!(has(CLAP_PARAM_IS_STEPPED) && has(CLAP_PARAM_IS_MODULATABLE)), || {
            format!("{name} has steps and can be modulated")
        })?;
        ensure(!has(CLAP_PARAM_IS_ENUM) || has(CLAP_PARAM_IS_STEPPED), || format!("{name} is a list without steps"))?;
        let range = info.min_value..=info.max_value;
        ensure(range.contains(&info.default_value), || format!("the default of {name} is out of its range"))?;
    }
    for id in ["drive_mode", "flame_scene", "quality", "dynamic_range"] {
        let info = parameters.iter().find(|info| info.id == numeric_id(id));
        ensure(info.is_some_and(|info| info.flags & CLAP_PARAM_IS_ENUM != 0), || format!("{id} is not a list"))?;
    }
    Ok(())
}

fn plain_whole_numbers(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let parameters = raw.parameters()?;
    for (id, low, high, default) in [
        ("levels", 3.0, 8.0, 6.0),
        ("window", 2.0, 16.0, 4.0),
        ("feature", 1.0, 6.0, 3.0),
        ("half_width", 100.0, 2000.0, 500.0),
    ] {
        let info = parameters.iter().find(|info| info.id == numeric_id(id)).ok_or(format!("there is no {id}"))?;
        let found = (info.min_value, info.max_value, info.default_value);
        ensure(found == (low, high, default), || format!("{id} has {found:?}"))?;
        raw.flush(&[event(info.id, low + 1.0)])?;
        let value = raw.value(id)?;
        ensure((value - low - 1.0).abs() < 1e-3, || format!("{id} was set to {} and is {value}", low + 1.0))?;
    }
    Ok(())
}
