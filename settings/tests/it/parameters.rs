//! The table: its promise, and that its three spellings of a value agree.

use proptest::prelude::*;
use pyrophone_settings::{COUNT, Error, Group, Id, PARAMETERS, Parameter, ParameterKind, Values, index_of};
use pyrophone_synthesis::controls::{DriveMode, DynamicRange, Fuel, Quality, VortexControls};
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::{Controls, EngineConfig};

#[test]
fn ids_kinds_ranges_and_defaults_stay() {
    let lines: Vec<String> = PARAMETERS
        .iter()
        .map(|p| {
            let kind = match p.kind {
                ParameterKind::Float { skew, decimals, off_at_low, .. } => {
                    format!("float skew={skew} decimals={decimals}{}", if off_at_low { " off" } else { "" })
                }
                ParameterKind::Int { .. } => "int".to_owned(),
                ParameterKind::Choice { names, .. } => format!("choice {}", names.join("|")),
                ParameterKind::Toggle { .. } => "toggle".to_owned(),
            };
            let automatable = if p.automatable { "" } else { " fixed" };
            format!("{} [{}, {}] default {} {} {kind}{automatable}", p.id, p.low(), p.high(), p.default_value(), p.unit)
        })
        .collect();
    insta::assert_snapshot!(lines.join("\n"));
}

#[test]
fn every_id_is_at_its_place() {
    let expected = [
        (Id::LowLevel, "low_level"),
        (Id::ExtensionLevel, "extension_level"),
        (Id::TextureLevel, "texture_level"),
        (Id::OutputLevel, "output_level"),
        (Id::Alpha, "alpha"),
        (Id::Cutoff, "cutoff"),
        (Id::BlendWidth, "blend_width"),
        (Id::NoiseAmount, "noise_amount"),
        (Id::ExtensionSeed, "extension_seed"),
        (Id::ExtensionWidth, "extension_width"),
        (Id::ScalingAlpha, "scaling_alpha"),
        (Id::DynamicRange, "dynamic_range"),
        (Id::Gate, "gate"),
        (Id::GateThreshold, "gate_threshold"),
        (Id::Quality, "quality"),
        (Id::TextureWidth, "texture_width"),
        (Id::DriveMode, "drive_mode"),
        (Id::DriveGain, "drive_gain"),
        (Id::Attack, "attack"),
        (Id::Release, "release"),
        (Id::Threshold, "threshold"),
        (Id::HighPass, "high_pass"),
        (Id::Bypass, "bypass"),
        (Id::Levels, "levels"),
        (Id::Window, "window"),
        (Id::Feature, "feature"),
        (Id::Falloff, "falloff"),
        (Id::HalfWidth, "half_width"),
        (Id::FitWidth, "fit_width"),
        (Id::DynamicsMode, "dynamics_mode"),
        (Id::Dynamics, "dynamics"),
        (Id::DriveMatch, "drive_match"),
        (Id::LowEnd, "low_end"),
        (Id::SpectrumMatch, "spectrum_match"),
        (Id::FlameScene, "flame_scene"),
        (Id::FlameIntensity, "flame_intensity"),
        (Id::FlameWind, "flame_wind"),
        (Id::FlameOffset, "flame_offset"),
        (Id::VortexLevel, "vortex_level"),
        (Id::VortexTexture, "vortex_texture"),
        (Id::VortexFlow, "vortex_flow"),
        (Id::VortexSpeed, "vortex_speed"),
        (Id::VortexCurve, "vortex_curve"),
        (Id::VortexRange, "vortex_range"),
        (Id::VortexVariation, "vortex_variation"),
        (Id::VortexSources, "vortex_sources"),
        (Id::VortexDistance, "vortex_distance"),
        (Id::VortexSpread, "vortex_spread"),
        (Id::VortexAzimuth, "vortex_azimuth"),
        (Id::VortexElevation, "vortex_elevation"),
        (Id::VortexFalloff, "vortex_falloff"),
        (Id::VortexLimit, "vortex_limit"),
        (Id::VortexSeed, "vortex_seed"),
        (Id::ScalingAuto, "scaling_auto"),
        (Id::CrackleLevel, "crackle_level"),
        (Id::CrackleDensity, "crackle_density"),
        (Id::CrackleSharpness, "crackle_sharpness"),
        (Id::CrackleSpread, "crackle_spread"),
        (Id::CrackleFollow, "crackle_follow"),
        (Id::CrackleSeed, "crackle_seed"),
        (Id::Ceiling, "ceiling"),
        (Id::Loudness, "loudness"),
        (Id::Fuel, "fuel"),
        (Id::HissLevel, "hiss_level"),
        (Id::BodyLevel, "body_level"),
        (Id::HissTone, "hiss_tone"),
        (Id::HissFlutter, "hiss_flutter"),
        (Id::BodyTone, "body_tone"),
        (Id::BodyFlutter, "body_flutter"),
        (Id::FuelFollow, "fuel_follow"),
        (Id::MacroSize, "macro_size"),
        (Id::MacroFury, "macro_fury"),
        (Id::MacroCrackle, "macro_crackle"),
        (Id::MacroSharpness, "macro_sharpness"),
        (Id::MacroHiss, "macro_hiss"),
        (Id::MacroWhoosh, "macro_whoosh"),
        (Id::MacroTightness, "macro_tightness"),
        (Id::MacroDistance, "macro_distance"),
        (Id::Take, "take"),
        (Id::TakeAmount, "take_amount"),
        (Id::RecordingSlot, "recording_slot"),
        (Id::RecordingSecond, "recording_second"),
        (Id::RecordingBlend, "recording_blend"),
        (Id::Averaging, "averaging"),
    ];
    assert_eq!(expected.len(), COUNT);
    for (place, (id, name)) in expected.into_iter().enumerate() {
        assert_eq!((id as usize, id.parameter().id), (place, name));
        assert_eq!(index_of(name).unwrap(), place);
    }
}

#[test]
fn the_table_is_sound() {
    for p in PARAMETERS {
        assert!(p.low() < p.high(), "{}", p.id);
        assert!(p.id.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'_'), "{}", p.id);
        for plain in [p.low(), p.high(), p.default_value()].into_iter().chain(p.paper) {
            assert_eq!(p.check(plain).unwrap(), plain, "{} {plain} lies on the grid", p.id);
        }
        assert_ne!(p.structure, p.automatable, "{}: structure alone is not automatable", p.id);
        assert!(p.help.len() > 20, "{}", p.id);
    }
    // Hosts know parameters by a 31-bit hash of the id.
    let hash = |id: &str| id.bytes().fold(0u32, |hash, byte| hash.wrapping_mul(31).wrapping_add(byte.into())) << 1;
    let mut hashes: Vec<u32> = PARAMETERS.iter().map(|p| hash(p.id)).collect();
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), COUNT);
}

#[test]
fn defaults_are_those_of_the_engines() {
    let (values, engine) = (Values::default(), Controls::default());
    let controls = values.controls();
    assert!((controls.drive.threshold - engine.drive.threshold).abs() < 1e-15);
    assert!((controls.texture.gate - engine.texture.gate).abs() < 1e-15);
    let mut same = controls;
    same.drive.threshold = engine.drive.threshold;
    // The engines' own defaults are the paper's, all layers at full level; a fresh instance is the default preset.
    assert_eq!((controls.mix.low, controls.mix.extension), (0.0, 0.0));
    same.mix = engine.mix;
    // A level per pascal and a limit are the texture's own.
    assert!(controls.vortex.level > 0.0 && controls.vortex.max_pressure_pa > 0.0);
    assert!((controls.vortex.threshold - engine.vortex.threshold).abs() < 1e-15);
    let VortexControls { level, max_pressure_pa, threshold, .. } = engine.vortex;
    same.vortex = VortexControls { level, max_pressure_pa, threshold, ..same.vortex };
    same.drive.high_pass_hz = engine.drive.high_pass_hz;
    same.texture.scaling_alpha = engine.texture.scaling_alpha;
    same.texture.gate = engine.texture.gate;
    assert_eq!(same, engine);
    let structure = EngineConfig { falloff: 0.0, dynamics: MatchingMode::Paper, ..values.structure() };
    assert_eq!(structure, EngineConfig::default());
}

#[test]
fn levels_are_exact_at_0_db_and_off() {
    let mut values = Values::default();
    assert_eq!(values.controls().mix.texture.to_bits(), 1f64.to_bits());
    values.set_text("low_level", "-inf dB").unwrap();
    values.set_text("output_level", "-6.02 dB").unwrap();
    let mix = values.controls().mix;
    assert_eq!(mix.low.to_bits(), 0f64.to_bits());
    assert!((mix.output - 0.5).abs() < 1e-4);
}

#[test]
fn choices_reach_the_engines() {
    let mut values = Values::default();
    for (text, quality) in [
        ("draft", Quality::Bounded { candidates: 256 }),
        ("normal", Quality::Bounded { candidates: 1024 }),
        ("high", Quality::Bounded { candidates: 4096 }),
        ("exact", Quality::Exact),
    ] {
        values.set_text("quality", text).unwrap();
        assert_eq!(values.controls().texture.quality, quality);
    }
    for (text, range) in
        [("off", DynamicRange::Off), ("learned", DynamicRange::Learned), ("running", DynamicRange::Running)]
    {
        values.set_text("dynamic_range", text).unwrap();
        assert_eq!(values.controls().texture.dynamic_range, range);
    }
    for (text, mode) in [
        ("pressure", DriveMode::Pressure),
        ("flux", DriveMode::Flux),
        ("envelope", DriveMode::Envelope),
        ("input envelope", DriveMode::InputEnvelope),
        ("flame", DriveMode::Flame),
    ] {
        values.set_text("drive_mode", text).unwrap();
        assert_eq!(values.controls().drive.mode, mode);
    }
    for (text, dynamics) in [("paper", MatchingMode::Paper), ("companded", MatchingMode::Companded)] {
        values.set_text("dynamics_mode", text).unwrap();
        assert_eq!(values.structure().dynamics, dynamics);
    }
    for (name, fuel) in Fuel::NAMES.iter().zip(Fuel::ALL) {
        values.set_text("fuel", name).unwrap();
        assert_eq!((values.controls().crackle.fuel, values.controls().fuel.fuel), (fuel, fuel));
    }
    values.set_text("gate", "off").unwrap();
    assert_eq!(values.controls().texture.gate, 0.0);
}

#[test]
fn every_value_stays_in_the_engines_ranges() {
    for plain in [f64::NEG_INFINITY, f64::INFINITY] {
        let mut values = Values::default();
        for index in 0..COUNT {
            values.set_nearest(index, plain);
        }
        values.structure().validate().unwrap();
        let c = values.controls();
        assert!((0.0001..=1.0).contains(&c.drive.attack_s) && (0.001..=5.0).contains(&c.drive.release_s));
        assert!((0.0..=1.0).contains(&c.drive.threshold) && c.drive.gain >= 0.0);
        assert!((0.0..=6.0).contains(&c.extend.alpha) && (40.0..=1000.0).contains(&c.extend.cutoff_hz));
        assert!((2.0..=400.0).contains(&c.extend.blend_width_hz) && (0.0..=4.0).contains(&c.extend.noise_amount));
    }
}

#[test]
fn reset_to_paper_leaves_the_mix_alone() {
    let mut values = Values::default();
    for (id, text) in
        [("output_level", "-3"), ("levels", "8"), ("alpha", "4"), ("texture_width", "0"), ("quality", "draft")]
    {
        values.set_text(id, text).unwrap();
    }
    values.reset_to_paper();
    assert_eq!(values.structure(), EngineConfig::default());
    let controls = values.controls();
    assert_eq!(controls.extend.alpha, 2.5);
    assert_eq!((controls.texture.quality, controls.texture.gate), (Quality::Exact, 0.0));
    assert_eq!((values.get(Id::OutputLevel), values.get(Id::TextureWidth)), (-3.0, 0.0));
}

#[test]
fn wrong_texts_name_the_remedy() {
    let message = |id: &str, text: &str| Values::default().set_text(id, text).unwrap_err().to_string();
    assert_eq!(message("alpha", "7"), "alpha is 7, but must lie between 0.000 and 6.000; choose a value in that range");
    assert_eq!(
        message("quality", "best"),
        "quality is `best`, but must be one of \"draft\", \"normal\", \"high\", \"exact\"; write it as in `quality = \"normal\"`"
    );
    assert_eq!(
        message("alhpa", "2"),
        "there is no parameter `alhpa` (did you mean `alpha`?); `pyrophone parameters` lists the ids"
    );
    assert!(message("scaling_alfa", "2").contains("did you mean `scaling_alpha`?"));
    for (id, text) in
        [("alpha", "nan"), ("alpha", "inf"), ("alpha", ""), ("levels", "4.5"), ("gate", "maybe"), ("alpha", "off")]
    {
        let error = Values::default().set_text(id, text).unwrap_err();
        assert!(matches!(error, Error::WrongKind { .. }), "{id} {text}: {error}");
    }
}

#[test]
fn values_are_read_as_people_write_them() {
    let read = |id: &str, text: &str| PARAMETERS[index_of(id).unwrap()].parse(text).ok();
    for text in ["250", "250 Hz", "0.25k", "0.25 kHz", "0,25 KHZ", "250,0"] {
        assert_eq!(read("cutoff", text), Some(250.0), "{text}");
    }
    assert_eq!(read("flame_offset", "20 ms"), Some(0.02));
    assert_eq!(read("attack", "0.02 s"), Some(20.0));
    assert_eq!(read("vortex_distance", "150 cm"), Some(1.5));
    assert_eq!(read("extension_seed", "1,5"), None);
    for text in ["1.2.3", "1,2,3", "k", "ms", "", "1e400"] {
        assert_eq!(read("cutoff", text), None, "{text}");
    }
}

#[test]
fn value_out_of_range_becomes_the_nearest_limit() {
    let nearest = |id: &str, text: &str| PARAMETERS[index_of(id).unwrap()].parse_nearest(text).ok();
    assert_eq!(nearest("cutoff", "5 kHz"), Some((1000.0, true)));
    assert_eq!(nearest("cutoff", "-1"), Some((40.0, true)));
    assert_eq!(nearest("cutoff", "0.1k"), Some((100.0, false)));
    assert_eq!(nearest("low_level", "off"), Some((-72.0, false)));
    assert_eq!(nearest("cutoff", "high"), None);
}

fn any_parameter() -> impl Strategy<Value = &'static Parameter> {
    (0..COUNT).prop_map(|index| &PARAMETERS[index])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Text, with and without unit, gives back the very value.
    #[test]
    fn text_round_trip(p in any_parameter(), share in -0.1f64..1.1) {
        let plain = p.snap(p.low() + share * (p.high() - p.low()));
        let text = p.to_text(plain);
        prop_assert_eq!(p.parse(&text).unwrap().to_bits(), plain.to_bits());
        let bare = text.strip_suffix(p.unit).unwrap_or(&text);
        prop_assert_eq!(p.parse(bare).unwrap().to_bits(), plain.to_bits());
        prop_assert_eq!(p.parse(&format!("  {}", text.to_uppercase())).unwrap().to_bits(), plain.to_bits());
    }

    /// The normalised value gives back the very value, even cut to 32 bits.
    #[test]
    fn normalised_round_trip(p in any_parameter(), share in 0f64..=1.0) {
        let plain = p.snap(p.low() + share * (p.high() - p.low()));
        let normalised = p.to_normalised(plain);
        prop_assert!((0.0..=1.0).contains(&normalised));
        prop_assert_eq!(p.from_normalised(normalised).to_bits(), plain.to_bits());
        prop_assert_eq!(p.from_normalised(f64::from(normalised as f32)).to_bits(), plain.to_bits());
    }

    /// The normalised scale rises and keeps to the range, whatever a host sends.
    #[test]
    fn normalised_is_monotonic(p in any_parameter(), a in -1f64..2.0, b in -1f64..2.0) {
        let (low, high) = (p.from_normalised(a.min(b)), p.from_normalised(a.max(b)));
        prop_assert!(p.low() <= low && low <= high && high <= p.high());
    }

    /// Any text is a value or an error.
    #[test]
    fn any_text_is_survived(p in any_parameter(), text in ".*") {
        if let Ok(plain) = p.parse(&text) {
            prop_assert_eq!(p.snap(plain), plain);
        }
    }
}

#[test]
fn names_are_unique_and_every_group_has_its_place_with_hosts() {
    let names: std::collections::HashSet<&str> = PARAMETERS.iter().map(|parameter| parameter.name).collect();
    assert_eq!(names.len(), PARAMETERS.len(), "hosts tell parameters apart by their names");
    let order = pyrophone_settings::host_order();
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, (0..PARAMETERS.len()).collect::<Vec<_>>(), "each once");
    assert_eq!(PARAMETERS[order[0]].id, "bypass");
    let groups: Vec<Group> = order[1..].iter().map(|index| PARAMETERS[*index].group).collect();
    let mut changes = groups.clone();
    changes.dedup();
    let distinct: std::collections::HashSet<Group> = groups.iter().copied().collect();
    assert_eq!(changes.len(), distinct.len(), "each group stands together");
    assert_eq!(changes[0], Group::Character);
}
