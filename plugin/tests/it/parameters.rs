//! Host parameters and the settings' table agree, and states are brought into range.

use std::collections::BTreeMap;
use std::sync::Arc;

use nice_plug::prelude::*;
use nice_plug_core::plugin::ParamValue;
use proptest::prelude::*;
use pyrophone::parameters::{EffectParams, sanitize};
use pyrophone::persist::SessionStore;
use pyrophone_settings::session::plugin_state;
use pyrophone_settings::{COUNT, PARAMETERS, ParameterKind, Session, Values, host_order};
use pyrophone_synthesis::structure::MatchingMode;

fn params() -> EffectParams {
    EffectParams::new(Arc::new(SessionStore::new(|| {})))
}

/// Does what the framework does with a state's values.
fn apply(params: &EffectParams, state: &PluginState) {
    let map: BTreeMap<_, _> = params.param_map().into_iter().map(|(id, pointer, _)| (id, pointer)).collect();
    for (id, value) in &state.params {
        let plain = match value {
            ParamValue::F32(plain) => *plain,
            ParamValue::I32(plain) => *plain as f32,
            ParamValue::Bool(on) => f32::from(u8::from(*on)),
            ParamValue::String(_) => continue,
        };
        if let Some(pointer) = map.get(id) {
            // SAFETY: `params` is alive.
            unsafe { pointer._internal_set_normalized_value(pointer.preview_normalized(plain)) };
        }
    }
}

#[test]
fn ids_names_groups_ranges_defaults_and_texts_are_the_tables() {
    let params = params();
    let map = params.param_map();
    assert_eq!(map.len(), COUNT);
    for ((id, pointer, group), index) in map.iter().zip(host_order()) {
        let parameter = &PARAMETERS[index];
        assert_eq!((id.as_str(), group.as_str()), (parameter.id, parameter.group.name()));
        // SAFETY: `params` is alive.
        unsafe {
            assert_eq!(pointer.name(), parameter.name);
            let default = parameter.to_normalised(parameter.default_value());
            assert!((f64::from(pointer.default_normalized_value()) - default).abs() < 1e-6, "{id}");
            let steps = match parameter.kind {
                ParameterKind::Float { .. } => None,
                _ => Some((parameter.high() - parameter.low()) as usize),
            };
            assert_eq!(pointer.step_count(), steps, "{id}");
            let flags = pointer.flags();
            assert_eq!(flags.contains(ParamFlags::NON_AUTOMATABLE), !parameter.automatable, "{id}");
            assert_eq!(flags.contains(ParamFlags::BYPASS), *id == "bypass");
            for plain in [parameter.low(), parameter.default_value(), parameter.high()] {
                let normalised = parameter.to_normalised(plain) as f32;
                let text = pointer.normalized_value_to_string(normalised, true);
                assert_eq!(text, parameter.to_text(plain), "{id}");
                let read = pointer.string_to_normalized_value(&text).unwrap();
                assert!((read - normalised).abs() < 1e-6, "{id} {text}: {read} for {normalised}");
            }
            assert_eq!(pointer.string_to_normalized_value("rubbish"), None, "{id}");
        }
    }
    assert_eq!(params.values(), Values::default());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// A value of the grid reaches the engines to the bit through a host's 32-bit normalised one.
    #[test]
    fn values_survive_the_host(index in 0..COUNT, share in 0f64..=1.0) {
        let parameter = &PARAMETERS[index];
        let plain = parameter.snap(parameter.low() + share * (parameter.high() - parameter.low()));
        let params = params();
        let (_, pointer, _) = params.param_map().into_iter().find(|(id, ..)| id == parameter.id).expect("every parameter");
        // SAFETY: `params` is alive.
        unsafe { pointer._internal_set_normalized_value(parameter.to_normalised(plain) as f32) };
        prop_assert_eq!(params.values().as_slice()[index].to_bits(), plain.to_bits());
    }

    /// A whole state as the settings write it arrives to the bit.
    #[test]
    fn states_survive_the_host(shares in prop::collection::vec(0f64..=1.0, COUNT)) {
        let mut values = Values::default();
        for (index, share) in shares.into_iter().enumerate() {
            let parameter = &PARAMETERS[index];
            values.set_nearest(index, parameter.low() + share * (parameter.high() - parameter.low()));
        }
        let mut state: PluginState = serde_json::from_str(&plugin_state(&values, &Session::default())).unwrap();
        sanitize(&mut state);
        prop_assert_eq!(state.params.len(), COUNT);
        let params = params();
        apply(&params, &state);
        prop_assert_eq!(params.values(), values);
        let field = &state.fields["pyrophone"];
        params.deserialize_fields(&state.fields);
        prop_assert_eq!(&params.serialize_fields()["pyrophone"], field);
    }
}

#[test]
fn bad_values_are_brought_into_range_or_dropped() {
    let text = r#"{"version":"9","params":{
        "alpha":{"f32":1e30},"cutoff":{"f32":-5.0},"low_level":{"f32":-1e9},"noise_amount":{"f32":1e300},
        "levels":{"i32":99},"window":{"i32":-7},"quality":{"i32":400},
        "gate":{"i32":1},"bypass":{"f32":1.0},"attack":{"string":"fast"},"feature":{"bool":true},
        "dynamics_mode":{"f32":1.0},"no_such":{"f32":1.0},"":{"bool":true}},"fields":{}}"#;
    let mut state: PluginState = serde_json::from_str(text).unwrap();
    sanitize(&mut state);
    let kept: Vec<&str> = state.params.keys().map(String::as_str).collect();
    let known = [
        "alpha",
        "averaging",
        "body_level",
        "ceiling",
        "cutoff",
        "dynamics_mode",
        "fuel",
        "hiss_level",
        "levels",
        "loudness",
        "low_level",
        "macro_crackle",
        "macro_distance",
        "macro_fury",
        "macro_hiss",
        "macro_sharpness",
        "macro_size",
        "macro_tightness",
        "macro_whoosh",
        "noise_amount",
        "quality",
        "recording_blend",
        "recording_slot",
        "scaling_auto",
        "take",
        "window",
    ];
    assert_eq!(kept, known);
    for (id, value) in &state.params {
        let plain = match value {
            ParamValue::Bool(on) => f64::from(u8::from(*on)),
            ParamValue::F32(plain) => f64::from(*plain),
            ParamValue::I32(plain) => f64::from(*plain),
            other => panic!("{other:?}"),
        };
        let parameter = &PARAMETERS[pyrophone_settings::index_of(id).unwrap()];
        assert!(parameter.check(plain).is_ok(), "{id} {plain}");
    }
}

#[test]
fn a_state_from_before_the_companded_mode_keeps_the_papers() {
    let mut state: PluginState =
        serde_json::from_str(r#"{"version":"0","params":{"falloff":{"f32":0.0}},"fields":{}}"#).unwrap();
    sanitize(&mut state);
    let params = params();
    assert_eq!(params.values().structure().dynamics, MatchingMode::Companded, "a fresh instance's");
    apply(&params, &state);
    assert_eq!(params.values().structure().dynamics, MatchingMode::Paper);
}

#[test]
fn a_state_from_before_fuels_turns_them_off() {
    let params = params();
    let mut values = Values::default();
    for (id, text) in [("fuel", "coal"), ("hiss_level", "-6"), ("body_level", "0")] {
        values.set_text(id, text).unwrap();
    }
    let on: PluginState = serde_json::from_str(&plugin_state(&values, &Session::default())).unwrap();
    apply(&params, &on);
    assert_eq!(params.values(), values);
    let mut earlier = on;
    earlier.params.retain(|id, _| !["fuel", "hiss_level", "body_level"].contains(&id.as_str()));
    sanitize(&mut earlier);
    apply(&params, &earlier);
    assert_eq!(params.values(), Values::default());
}

#[test]
fn a_state_from_before_scaling_auto_turns_it_off() {
    let params = params();
    let mut values = Values::default();
    values.set_text("scaling_auto", "on").unwrap();
    let on: PluginState = serde_json::from_str(&plugin_state(&values, &Session::default())).unwrap();
    apply(&params, &on);
    assert_eq!(params.values(), values);
    let mut earlier = on;
    earlier.params.remove("scaling_auto");
    sanitize(&mut earlier);
    apply(&params, &earlier);
    assert_eq!(params.values(), Values::default());
}
