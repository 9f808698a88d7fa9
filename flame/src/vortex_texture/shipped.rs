//! The textures that are shipped, `presets/vortex`.

use super::{Kind, Recipe};

/// How a texture that is shipped was made, and is made again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shipped {
    /// Its file's name, without `.vtx`.
    pub name: &'static str,
    /// Its rows' recipe.
    pub recipe: Recipe,
    /// Its lowest and highest speed in m/s, and how many there are: what [`speeds`](super::speeds) takes.
    pub speeds: (f64, f64, usize),
}

impl Shipped {
    /// All of them.
    pub const ALL: [Self; 2] = [
        // With the first seed one of the fire's rows ends amid a burst.
        Self { name: "fire", recipe: Recipe { seed: 2, ..Recipe::STANDARD }, speeds: (0.5, 8.0, 8) },
        Self { name: "jet", recipe: Recipe { kind: Kind::Jet, ..Recipe::STANDARD }, speeds: (1.0, 16.0, 9) },
    ];
}
