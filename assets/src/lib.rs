#![doc = include_str!("../README.md")]

/// A built-in flame, as it was simulated.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    /// Its name in parameters and presets.
    pub name: &'static str,
    /// Its flux over one period: a WAV file whose sample rate is the step rate and whose channels are the variants.
    pub drive: &'static [u8],
    /// Speeds of the gas in the same simulation: a speed field.
    pub field: &'static [u8],
}

/// The built-in flames, written by `cargo xtask drives`. Indices are a promise: scenes may only be appended.
pub const SCENES: [Scene; 8] = [
    Scene {
        name: "candle",
        drive: include_bytes!("../../presets/drives/candle.wav"),
        field: include_bytes!("../../presets/fields/candle.field"),
    },
    Scene {
        name: "torch",
        drive: include_bytes!("../../presets/drives/torch.wav"),
        field: include_bytes!("../../presets/fields/torch.field"),
    },
    Scene {
        name: "flame_jet",
        drive: include_bytes!("../../presets/drives/flame_jet.wav"),
        field: include_bytes!("../../presets/fields/flame_jet.field"),
    },
    Scene {
        name: "burning_brick",
        drive: include_bytes!("../../presets/drives/burning_brick.wav"),
        field: include_bytes!("../../presets/fields/burning_brick.field"),
    },
    Scene {
        name: "dragon",
        drive: include_bytes!("../../presets/drives/dragon.wav"),
        field: include_bytes!("../../presets/fields/dragon.field"),
    },
    Scene {
        name: "campfire",
        drive: include_bytes!("../../presets/drives/campfire.wav"),
        field: include_bytes!("../../presets/fields/campfire.field"),
    },
    Scene {
        name: "flamethrower",
        drive: include_bytes!("../../presets/drives/flamethrower.wav"),
        field: include_bytes!("../../presets/fields/flamethrower.field"),
    },
    Scene {
        name: "explosion",
        drive: include_bytes!("../../presets/drives/explosion.wav"),
        field: include_bytes!("../../presets/fields/explosion.field"),
    },
];

/// A vortex-sound texture.
#[derive(Debug, Clone, Copy)]
pub struct VortexTexture {
    /// Its name in parameters and presets.
    pub name: &'static str,
    /// The texture's file.
    pub file: &'static [u8],
}

/// The built-in vortex-sound textures, written by `cargo xtask vortex`. Indices are a promise: textures may only be appended.
pub const VORTEX_TEXTURES: [VortexTexture; 2] = [
    VortexTexture { name: "fire", file: include_bytes!("../../presets/vortex/fire.vtx") },
    VortexTexture { name: "jet", file: include_bytes!("../../presets/vortex/jet.vtx") },
];

/// Names and texts of the factory presets, in the order in which they are listed.
pub const PRESETS: &[(&str, &str)] = &[
    ("default", include_str!("../../presets/default.toml")),
    ("extend", include_str!("../../presets/extend.toml")),
    ("flame", include_str!("../../presets/flame.toml")),
    ("campfire", include_str!("../../presets/campfire.toml")),
    ("flamethrower", include_str!("../../presets/flamethrower.toml")),
    ("explosion", include_str!("../../presets/explosion.toml")),
    ("swinging-torch", include_str!("../../presets/swinging-torch.toml")),
    ("texture", include_str!("../../presets/texture.toml")),
    ("texture-paper", include_str!("../../presets/texture-paper.toml")),
    ("candle-close", include_str!("../../presets/candle-close.toml")),
    ("match-strike", include_str!("../../presets/match-strike.toml")),
    ("hearth", include_str!("../../presets/hearth.toml")),
    ("bonfire", include_str!("../../presets/bonfire.toml")),
    ("torch-pass-by", include_str!("../../presets/torch-pass-by.toml")),
    ("flamethrower-burst", include_str!("../../presets/flamethrower-burst.toml")),
    ("dragon-breath", include_str!("../../presets/dragon-breath.toml")),
    ("jet-engine", include_str!("../../presets/jet-engine.toml")),
    ("burning-house", include_str!("../../presets/burning-house.toml")),
    ("explosion-tail", include_str!("../../presets/explosion-tail.toml")),
    ("magic-fire", include_str!("../../presets/magic-fire.toml")),
    ("embers", include_str!("../../presets/embers.toml")),
    ("gas-burner", include_str!("../../presets/gas-burner.toml")),
    ("blowtorch", include_str!("../../presets/blowtorch.toml")),
    ("wildfire-far", include_str!("../../presets/wildfire-far.toml")),
    ("drums-to-fire", include_str!("../../presets/drums-to-fire.toml")),
    ("paper-burning-brick", include_str!("../../presets/paper-burning-brick.toml")),
    ("paper-candle", include_str!("../../presets/paper-candle.toml")),
    ("paper-dragon", include_str!("../../presets/paper-dragon.toml")),
    ("paper-flame-jet", include_str!("../../presets/paper-flame-jet.toml")),
    ("paper-torch", include_str!("../../presets/paper-torch.toml")),
    ("speech", include_str!("../../presets/speech.toml")),
    ("drums", include_str!("../../presets/drums.toml")),
    ("wet-logs", include_str!("../../presets/wet-logs.toml")),
    ("grass-fire", include_str!("../../presets/grass-fire.toml")),
    ("burning-paper", include_str!("../../presets/burning-paper.toml")),
    ("coal-embers", include_str!("../../presets/coal-embers.toml")),
    ("brazier", include_str!("../../presets/brazier.toml")),
    ("torch-in-hand", include_str!("../../presets/torch-in-hand.toml")),
    ("burning-hut", include_str!("../../presets/burning-hut.toml")),
];
