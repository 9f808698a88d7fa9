//! The table of all parameters: the promise that presets, states and automation rest on.
//!
//! Ids and the order of choices never change; new parameters go to the end of [`Id`] and of the
//! table.

use crate::Error;
use crate::parameter::{Kind, Parameter};

/// Places in [`PARAMETERS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is described by its line of the table")]
pub enum Id {
    LowLevel,
    ExtensionLevel,
    TextureLevel,
    OutputLevel,
    Alpha,
    Cutoff,
    BlendWidth,
    NoiseAmount,
    ExtensionSeed,
    ExtensionWidth,
    ScalingAlpha,
    DynamicRange,
    Gate,
    GateThreshold,
    Quality,
    TextureWidth,
    DriveMode,
    DriveGain,
    Attack,
    Release,
    Threshold,
    HighPass,
    Bypass,
    Levels,
    Window,
    Feature,
    Falloff,
    HalfWidth,
    FitWidth,
    DynamicsMode,
    Dynamics,
    DriveMatch,
    LowEnd,
    SpectrumMatch,
    FlameScene,
    FlameIntensity,
    FlameWind,
    FlameOffset,
    VortexLevel,
    VortexTexture,
    VortexFlow,
    VortexSpeed,
    VortexCurve,
    VortexRange,
    VortexVariation,
    VortexSources,
    VortexDistance,
    VortexSpread,
    VortexAzimuth,
    VortexElevation,
    VortexFalloff,
    VortexLimit,
    VortexSeed,
    ScalingAuto,
    CrackleLevel,
    CrackleDensity,
    CrackleSharpness,
    CrackleSpread,
    CrackleFollow,
    CrackleSeed,
    Ceiling,
    Loudness,
    Fuel,
    HissLevel,
    BodyLevel,
    HissTone,
    HissFlutter,
    BodyTone,
    BodyFlutter,
    FuelFollow,
    MacroSize,
    MacroFury,
    MacroCrackle,
    MacroSharpness,
    MacroHiss,
    MacroWhoosh,
    MacroTightness,
    MacroDistance,
    Take,
    TakeAmount,
    RecordingSlot,
    RecordingSecond,
    RecordingBlend,
}

/// Names of the values of `dynamic_range`.
pub const DYNAMIC_RANGES: &[&str] = &["off", "learned", "running"];
/// Names of the values of `quality`.
pub const QUALITIES: &[&str] = &["draft", "normal", "high", "exact"];
/// Names of the values of `recording_slot` and `recording_second`.
pub const RECORDING_SLOTS: &[&str] = &["1", "2", "3", "4"];
/// Names of the values of `dynamics_mode`.
pub const DYNAMICS_MODES: &[&str] = &["paper", "companded"];
/// Names of the values of `drive_mode`.
pub const DRIVE_MODES: &[&str] = &["pressure", "flux", "envelope", "input envelope", "flame"];
/// Names of the values of `flame_scene`.
pub const FLAME_SCENES: &[&str] = pyrophone_synthesis::drive::SCENES;

/// Names of the values of `vortex_texture`.
pub const VORTEX_TEXTURES: &[&str] = pyrophone_synthesis::vortex::TEXTURES;
/// Names of the values of `fuel`.
pub const FUELS: &[&str] = pyrophone_synthesis::controls::Fuel::NAMES;
/// Names of the values of `vortex_flow`.
pub const VORTEX_FLOWS: &[&str] = &["envelope", "field", "live"];

const fn float(low: f64, high: f64, default: f64, skew: f64, decimals: u32) -> Kind {
    Kind::Float { low, high, default, skew, decimals, off_at_low: false }
}

const fn float_or_off(low: f64, high: f64, default: f64, skew: f64, decimals: u32) -> Kind {
    Kind::Float { low, high, default, skew, decimals, off_at_low: true }
}

/// Range of a macro.
const AMOUNT: Kind = float(-100.0, 100.0, 0.0, 1.0, 1);

const fn level(default: f64) -> Kind {
    float_or_off(-72.0, 24.0, default, 1.0, 2)
}

const fn control(
    id: &'static str,
    name: &'static str,
    group: &'static str,
    unit: &'static str,
    kind: Kind,
    paper: Option<f64>,
    help: &'static str,
) -> Parameter {
    Parameter { id, name, group, unit, kind, automatable: true, structure: false, paper, help }
}

const fn structure(
    id: &'static str,
    name: &'static str,
    unit: &'static str,
    kind: Kind,
    paper: f64,
    help: &'static str,
) -> Parameter {
    let group = "Structure";
    Parameter { id, name, group, unit, kind, automatable: false, structure: true, paper: Some(paper), help }
}

/// All parameters, in the order of [`Id`].
pub const PARAMETERS: &[Parameter] = &[
    control(
        "low_level",
        "Low level",
        "Levels",
        "dB",
        level(-72.0),
        None,
        "Level of the flame's own low-frequency part.",
    ),
    control(
        "extension_level",
        "Extension level",
        "Levels",
        "dB",
        level(-72.0),
        None,
        "Level of the noise that spectral extension adds above the cutoff.",
    ),
    control(
        "texture_level",
        "Texture level",
        "Levels",
        "dB",
        level(0.0),
        None,
        "Level of the fire matched from the recording.",
    ),
    control("output_level", "Output level", "Levels", "dB", level(0.0), None, "Level of everything together."),
    control(
        "alpha",
        "Alpha",
        "Extension",
        "",
        float(0.0, 6.0, 2.5, 1.0, 3),
        Some(2.5),
        "How fast the noise falls with frequency: low values hiss, high values rumble.",
    ),
    control(
        "cutoff",
        "Cutoff",
        "Extension",
        "Hz",
        float(40.0, 1000.0, 180.0, 0.5, 1),
        Some(180.0),
        "Frequency where the input ends and the added noise begins.",
    ),
    control(
        "blend_width",
        "Blend width",
        "Extension",
        "Hz",
        float(2.0, 400.0, 30.0, 0.5, 1),
        Some(30.0),
        "Width of the band around the cutoff in which the input is blended into the noise.",
    ),
    control(
        "noise_amount",
        "Noise amount",
        "Extension",
        "",
        float(0.0, 4.0, 1.0, 1.0, 3),
        Some(1.0),
        "Factor on the fitted noise: 1 continues the input's spectrum, less is softer, more is harsher.",
    ),
    control(
        "extension_seed",
        "Noise seed",
        "Extension",
        "",
        Kind::Int { low: 0, high: 65_535, default: 42 },
        None,
        "Number of the noise: another one gives the same fire with other crackle.",
    ),
    control(
        "extension_width",
        "Extension width",
        "Extension",
        "",
        float(0.0, 1.0, 1.0, 1.0, 3),
        None,
        "0: the same noise in all channels; 1: independent noise in each.",
    ),
    control(
        "scaling_alpha",
        "Scaling alpha",
        "Texture",
        "",
        float(0.0, 1.0, 0.0, 1.0, 3),
        Some(1.0),
        "How far single windows' loudness is mapped onto the input's, as the paper does; high values can buzz.",
    ),
    control(
        "dynamic_range",
        "Dynamic range",
        "Texture",
        "",
        Kind::Choice { names: DYNAMIC_RANGES, default: 2 },
        Some(1.0),
        "How the input's loudness is known: off (as it comes), learned beforehand, or estimated as it runs.",
    ),
    control(
        "gate",
        "Gate",
        "Texture",
        "",
        Kind::Toggle { default: true },
        Some(0.0),
        "Silences the texture while the input is silent; without it the recording's quietest moment plays on.",
    ),
    control(
        "gate_threshold",
        "Gate threshold",
        "Texture",
        "dB",
        float(-120.0, -20.0, -80.0, 1.0, 1),
        None,
        "Level of the input below which the gate closes.",
    ),
    control(
        "quality",
        "Quality",
        "Texture",
        "",
        Kind::Choice { names: QUALITIES, default: 1 },
        Some(3.0),
        "How long each search may take: draft, normal and high compare 256, 1024 and 4096 candidates, exact all it needs.",
    ),
    control(
        "texture_width",
        "Texture width",
        "Texture",
        "",
        float(0.0, 1.0, 1.0, 1.0, 3),
        None,
        "0: the texture in mono; 1: as wide as it was recorded.",
    ),
    control(
        "drive_mode",
        "Drive",
        "Drive",
        "",
        Kind::Choice { names: DRIVE_MODES, default: 0 },
        Some(0.0),
        "What the input is: the flame's pressure, its flux, a sound whose envelope drives a rumble (envelope: the sidechain's); flame burns without any.",
    ),
    control(
        "drive_gain",
        "Drive gain",
        "Drive",
        "dB",
        float(-48.0, 48.0, 0.0, 1.0, 2),
        None,
        "Level of the input before the engines; what they match and fit follows it.",
    ),
    control("attack", "Attack", "Drive", "ms", float(0.1, 1000.0, 5.0, 0.3, 2), None, "How fast the envelope rises."),
    control(
        "release",
        "Release",
        "Drive",
        "ms",
        float(1.0, 5000.0, 80.0, 0.3, 1),
        None,
        "How fast the envelope falls.",
    ),
    control(
        "threshold",
        "Threshold",
        "Drive",
        "dB",
        float_or_off(-100.0, 0.0, -60.0, 1.0, 1),
        None,
        "Level below which the envelope is zero.",
    ),
    control(
        "high_pass",
        "High-pass",
        "Drive",
        "Hz",
        float_or_off(0.0, 200.0, 5.0, 0.5, 1),
        Some(30.0),
        "Removes what lies below this frequency before the engines; 0 is off.",
    ),
    control(
        "bypass",
        "Bypass",
        "Levels",
        "",
        Kind::Toggle { default: false },
        None,
        "The input as it is, delayed by the latency.",
    ),
    structure(
        "levels",
        "Pyramid levels",
        "",
        Kind::Int { low: 3, high: 8, default: 6 },
        6.0,
        "Levels of the texture pyramid: more follow the input in a lower, slower band.",
    ),
    structure(
        "window",
        "Window",
        "samples",
        Kind::Int { low: 2, high: 16, default: 4 },
        4.0,
        "Half-width of a texture window: longer ones keep more of the recording together.",
    ),
    structure(
        "feature",
        "Feature",
        "windows",
        Kind::Int { low: 1, high: 6, default: 3 },
        3.0,
        "How many windows to each side are compared in a search: more is smoother, less follows closer.",
    ),
    structure(
        "falloff",
        "Falloff",
        "",
        float(0.0, 1.0, 0.025, 1.0, 3),
        0.0,
        "How much less the far samples count in a search.",
    ),
    structure(
        "half_width",
        "Half-width",
        "samples",
        Kind::Int { low: 100, high: 2000, default: 500 },
        500.0,
        "Half-width of an extension window, at 44.1 kHz: how fast the noise follows the input.",
    ),
    structure(
        "fit_width",
        "Fit width",
        "Hz",
        float(3.0, 120.0, 30.0, 1.0, 1),
        30.0,
        "Width of the band around the cutoff in which the noise's level is fitted.",
    ),
    structure(
        "dynamics_mode",
        "Dynamics mode",
        "",
        Kind::Choice { names: DYNAMICS_MODES, default: 1 },
        0.0,
        "Companded: matched without slow loudness, the input's put back; paper: matched as loud as it comes.",
    ),
    control(
        "dynamics",
        "Dynamics",
        "Texture",
        "",
        float(0.0, 1.0, 0.77, 1.0, 3),
        None,
        "Companded mode: 0 keeps the recording's own swells, 1 leaves only the input's.",
    ),
    control(
        "drive_match",
        "Drive match",
        "Texture",
        "dB",
        float(-24.0, 24.0, 0.0, 1.0, 2),
        None,
        "Companded mode: how loud a part of the recording the input looks for; high values find its bursts.",
    ),
    control(
        "low_end",
        "Low end",
        "Texture",
        "Hz",
        float_or_off(0.0, 400.0, 150.0, 0.5, 1),
        Some(0.0),
        "Companded mode: below this frequency the input itself is heard in place of texture; 0 is off.",
    ),
    control(
        "spectrum_match",
        "Spectrum match",
        "Texture",
        "",
        float(0.0, 1.0, 0.75, 1.0, 3),
        Some(0.0),
        "Companded mode: how far the output's spectrum is brought to the recording's.",
    ),
    control(
        "flame_scene",
        "Scene",
        "Flame",
        "",
        Kind::Choice { names: FLAME_SCENES, default: 5 },
        None,
        "Drive flame: what burns, simulated, over and over without a seam.",
    ),
    control(
        "flame_intensity",
        "Intensity",
        "Flame",
        "",
        float(0.0, 2.0, 1.0, 1.0, 3),
        None,
        "Drive flame: how much burns; 0 is out, 2 twice as much as designed.",
    ),
    control(
        "flame_wind",
        "Wind",
        "Flame",
        "",
        float(0.0, 1.0, 0.0, 1.0, 3),
        None,
        "Drive flame: wind, turbulence and motion of what burns, beyond what it has by itself; 1 is twice as much.",
    ),
    control(
        "flame_offset",
        "Offset",
        "Flame",
        "s",
        float(0.0, 10.0, 0.0, 1.0, 3),
        None,
        "Drive flame: the moment of the scene at the timeline's start; two flames side by side need different ones.",
    ),
    control(
        "vortex_level",
        "Vortex level",
        "Levels",
        "dB",
        level(-72.0),
        None,
        "Level of the whoosh: the sound that turbulent gas makes without burning.",
    ),
    control(
        "vortex_texture",
        "Gas",
        "Vortex",
        "",
        Kind::Choice { names: VORTEX_TEXTURES, default: 0 },
        None,
        "What whooshes: hot gas that rises from a fire, or a jet.",
    ),
    control(
        "vortex_flow",
        "Flow",
        "Vortex",
        "",
        Kind::Choice { names: VORTEX_FLOWS, default: 0 },
        None,
        "What tells how fast the gas flows: the input's loudness, a flame's simulated motion (field), or gas that the input blows at, simulated meanwhile (live).",
    ),
    control(
        "vortex_speed",
        "Speed",
        "Vortex",
        "m/s",
        float(0.0, 40.0, 16.0, 0.5, 2),
        None,
        "How fast the gas flows where the input is at full scale: faster is louder and brighter. With a field, 16 is its own speed.",
    ),
    control(
        "vortex_curve",
        "Curve",
        "Vortex",
        "",
        float(0.1, 4.0, 0.4, 0.5, 3),
        None,
        "How speed follows loudness: low values whoosh in soft passages too, high ones in the loudest only.",
    ),
    control(
        "vortex_range",
        "Range",
        "Vortex",
        "",
        float(0.0, 1.0, 0.5, 1.0, 3),
        None,
        "How much louder fast gas is than slow gas: 1 as in nature, which is steep, 0 not at all.",
    ),
    control(
        "vortex_variation",
        "Variation",
        "Vortex",
        "",
        float(0.0, 1.0, 0.25, 1.0, 3),
        None,
        "How far the speeds of the sources differ.",
    ),
    control(
        "vortex_sources",
        "Sources",
        "Vortex",
        "",
        Kind::Int { low: 1, high: 500, default: 64 },
        None,
        "How many regions of gas are heard: few flutter, many roar; twice as many are 3 dB louder.",
    ),
    control(
        "vortex_distance",
        "Distance",
        "Vortex",
        "m",
        float(0.0, 100.0, 3.0, 0.4, 2),
        None,
        "From the listener to the middle of the gas; as it moves, it sounds higher or lower.",
    ),
    control(
        "vortex_spread",
        "Spread",
        "Vortex",
        "m",
        float(0.0, 20.0, 1.0, 0.5, 2),
        None,
        "Radius of the ball of gas: how much of the space around its direction it fills.",
    ),
    control(
        "vortex_azimuth",
        "Azimuth",
        "Vortex",
        "°",
        float(-180.0, 180.0, 0.0, 1.0, 1),
        None,
        "Where the gas is: 0 ahead, 90 to the right, -90 to the left, 180 behind.",
    ),
    control(
        "vortex_elevation",
        "Elevation",
        "Vortex",
        "°",
        float(-90.0, 90.0, 0.0, 1.0, 1),
        None,
        "How high the gas is: 0 level, 90 overhead.",
    ),
    control(
        "vortex_falloff",
        "Vortex falloff",
        "Vortex",
        "",
        float(1.0, 3.0, 1.0, 1.0, 3),
        None,
        "Power with which it gets softer with distance: 1 as in nature, 3 as Dobashi's paper prints it.",
    ),
    control(
        "vortex_limit",
        "Limit",
        "Vortex",
        "dB",
        float(-48.0, 24.0, 24.0, 1.0, 1),
        None,
        "The loudest that the microphone takes, before the layer's level: bends what is louder, as explosions are.",
    ),
    control(
        "vortex_seed",
        "Vortex seed",
        "Vortex",
        "",
        Kind::Int { low: 0, high: 65_535, default: 42 },
        None,
        "Number of the sources: another one places and times them anew.",
    ),
    control(
        "scaling_auto",
        "Scaling auto",
        "Texture",
        "",
        Kind::Toggle { default: false },
        Some(0.0),
        "Turns Scaling alpha down by itself while the texture buzzes, and slowly up again.",
    ),
    control(
        "crackle_level",
        "Crackle level",
        "Levels",
        "dB",
        level(0.0),
        None,
        "Companded mode: level of the recording's crackles, which are split off and played beside the texture.",
    ),
    control(
        "crackle_density",
        "Density",
        "Crackle",
        "",
        float(0.0, 4.0, 1.0, 0.5, 3),
        None,
        "Number of crackles: 1 as many as in the recording, 2 twice as many.",
    ),
    control(
        "crackle_sharpness",
        "Sharpness",
        "Crackle",
        "",
        float(-1.0, 1.0, 0.0, 1.0, 3),
        None,
        "Tone of crackles: -1 is dull, 0 as recorded, 1 bright and short.",
    ),
    control(
        "crackle_spread",
        "Size spread",
        "Crackle",
        "",
        float(0.0, 2.0, 1.0, 1.0, 3),
        None,
        "Difference between small and large crackles: 0 makes all alike, 1 is as recorded, 2 doubles it in decibels.",
    ),
    control(
        "crackle_follow",
        "Follow",
        "Crackle",
        "",
        float(0.0, 2.0, 1.0, 1.0, 3),
        None,
        "How far crackles become more and louder as the input does: 0 leaves them even.",
    ),
    control(
        "crackle_seed",
        "Seed",
        "Crackle",
        "",
        Kind::Int { low: 0, high: 65_535, default: 42 },
        None,
        "Crackle seed: another one plays the same crackles in another order.",
    ),
    control(
        "ceiling",
        "Ceiling",
        "Levels",
        "",
        Kind::Toggle { default: true },
        Some(0.0),
        "Keeps the output below full scale: bends peaks above -1 dBFS, leaves everything else as it is.",
    ),
    control(
        "loudness",
        "Loudness",
        "Levels",
        "LUFS",
        float_or_off(-60.0, -6.0, -32.0, 1.0, 1),
        None,
        "Companded mode: loudness that every recording is brought to; off leaves it as loud as it was recorded.",
    ),
    control(
        "fuel",
        "Fuel",
        "Fuel",
        "",
        Kind::Choice { names: FUELS, default: 0 },
        None,
        "Companded mode: fuel whose crackle is made where no recording crackles; it also sets the tone of hiss and body.",
    ),
    control(
        "hiss_level",
        "Hiss level",
        "Levels",
        "dB",
        level(-72.0),
        None,
        "Companded mode: level of the hiss of steam and small jets of gas, made without a recording.",
    ),
    control(
        "body_level",
        "Body level",
        "Levels",
        "dB",
        level(-72.0),
        None,
        "Companded mode: level of the roar of the flames, made without a recording.",
    ),
    control(
        "hiss_tone",
        "Hiss tone",
        "Fuel",
        "",
        float(-1.0, 1.0, 0.0, 1.0, 3),
        None,
        "Pitch of the hiss in octaves around the fuel's own: -1 is dark, 1 bright.",
    ),
    control(
        "hiss_flutter",
        "Hiss flutter",
        "Fuel",
        "",
        float(0.0, 1.0, 0.5, 1.0, 3),
        None,
        "Unevenness of the hiss: 0 is steady, 1 comes in spurts.",
    ),
    control(
        "body_tone",
        "Body tone",
        "Fuel",
        "",
        float(-1.0, 1.0, 0.0, 1.0, 3),
        None,
        "Pitch of the body in octaves around the fuel's own: -1 is a large fire, 1 a small one.",
    ),
    control(
        "body_flutter",
        "Body flutter",
        "Fuel",
        "",
        float(0.0, 1.0, 0.5, 1.0, 3),
        None,
        "Unevenness of the body: 0 is steady, 1 flaps.",
    ),
    control(
        "fuel_follow",
        "Fuel follow",
        "Fuel",
        "",
        float(0.0, 2.0, 1.0, 1.0, 3),
        None,
        "How far hiss and body become louder as the input does: 0 leaves them even.",
    ),
    control(
        "macro_size",
        "Macro: Size",
        "Character",
        "%",
        AMOUNT,
        None,
        "How large the fire is: large ones are deeper and slower. 0 % leaves all as it is set.",
    ),
    control(
        "macro_fury",
        "Macro: Fury",
        "Character",
        "%",
        AMOUNT,
        None,
        "How wild the fire is: how far its loudness swings. 0 % leaves all as it is set.",
    ),
    control(
        "macro_crackle",
        "Macro: Crackle",
        "Character",
        "%",
        AMOUNT,
        None,
        "How much it crackles: number and level of crackles. 0 % leaves all as it is set.",
    ),
    control(
        "macro_sharpness",
        "Macro: Sharpness",
        "Character",
        "%",
        AMOUNT,
        None,
        "How sharp crackles are: from dull thuds of wet wood to dry snaps. 0 % leaves all as it is set.",
    ),
    control(
        "macro_hiss",
        "Macro: Hiss",
        "Character",
        "%",
        AMOUNT,
        None,
        "How much it hisses: the sound of steam and small jets, above 6 kHz. 0 % leaves all as it is set.",
    ),
    control(
        "macro_whoosh",
        "Macro: Whoosh",
        "Character",
        "%",
        AMOUNT,
        None,
        "How much moving gas is heard: vortex sound, added where its level is off. 0 % leaves all as it is set.",
    ),
    control(
        "macro_tightness",
        "Macro: Tightness",
        "Character",
        "%",
        AMOUNT,
        None,
        "How closely the sound follows the flame's loudness, moment by moment. 0 % leaves all as it is set.",
    ),
    control(
        "macro_distance",
        "Macro: Distance",
        "Character",
        "%",
        AMOUNT,
        None,
        "How far away the fire is: far ones are softer, duller and narrower. 0 % leaves all as it is set.",
    ),
    control(
        "take",
        "Take",
        "Character",
        "",
        Kind::Int { low: 0, high: 65_535, default: 0 },
        None,
        "Number of the take: another one has the same character and other events; 0 plays the seeds as they are set.",
    ),
    control(
        "take_amount",
        "Take amount",
        "Character",
        "%",
        float(0.0, 100.0, 50.0, 1.0, 1),
        None,
        "How far a take's texture may stray from the recording's nearest moments; noise, crackles and gas are other ones at once.",
    ),
    control(
        "recording_slot",
        "Recording slot",
        "Texture",
        "",
        Kind::Choice { names: RECORDING_SLOTS, default: 0 },
        None,
        "Slot of the recording that texture and crackle are made of; another one takes over within 50 ms.",
    ),
    control(
        "recording_second",
        "Second recording",
        "Texture",
        "",
        Kind::Choice { names: RECORDING_SLOTS, default: 1 },
        None,
        "Slot of a second recording, which is mixed in by the recording blend.",
    ),
    control(
        "recording_blend",
        "Recording blend",
        "Texture",
        "%",
        float(0.0, 100.0, 0.0, 1.0, 1),
        None,
        "Share of the second recording: how many windows of texture are taken from it, and how many of its crackles are heard.",
    ),
];

/// What belongs to a session's recordings, and stays as it is when a preset is chosen.
pub const OF_SESSION: [Id; 3] = [Id::RecordingSlot, Id::RecordingSecond, Id::RecordingBlend];

/// Number of parameters.
pub const COUNT: usize = PARAMETERS.len();

impl Id {
    /// Its line of the table.
    pub fn parameter(self) -> &'static Parameter {
        &PARAMETERS[self as usize]
    }
}

/// Groups in the order in which hosts show them.
const HOST_GROUPS: [&str; 10] =
    ["Character", "Levels", "Drive", "Flame", "Texture", "Crackle", "Fuel", "Extension", "Vortex", "Structure"];

/// Places in the table in the order in which hosts show the parameters: by group, bypass first, within a group as in
/// the table.
pub fn host_order() -> Vec<usize> {
    let mut order: Vec<usize> = (0..COUNT).collect();
    let group = |index: usize| HOST_GROUPS.iter().position(|group| *group == PARAMETERS[index].group);
    order.sort_by_key(|index| (PARAMETERS[*index].id != "bypass", group(*index)));
    order
}

/// Place of the parameter with this id in [`PARAMETERS`].
pub fn index_of(id: &str) -> Result<usize, Error> {
    PARAMETERS.iter().position(|parameter| parameter.id == id).ok_or_else(|| Error::UnknownParameter {
        id: id.to_owned(),
        nearest: PARAMETERS
            .iter()
            .map(|parameter| (edits(parameter.id, id), parameter.id))
            .min()
            .filter(|(distance, nearest)| *distance <= nearest.len() / 3)
            .map(|(_, nearest)| nearest),
    })
}

/// All ids, for messages.
pub(crate) fn ids_as_list() -> String {
    PARAMETERS.iter().map(|parameter| parameter.id).collect::<Vec<_>>().join(", ")
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(64).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
