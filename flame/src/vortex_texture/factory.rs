//! The built-in textures, `presets/vortex`.

use super::recipe::{FlowModel, Recipe};

/// Recipe of a built-in texture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shipped {
    /// File name without `.vtx`.
    pub name: &'static str,
    /// Its rows' recipe.
    pub recipe: Recipe,
    /// Lowest speed, highest speed in m/s, and number of speeds: the arguments of [`speeds`](super::speeds).
    pub speeds: (f64, f64, usize),
}

/// Voxels of 5 mm: eddies of two voxels pass at 50 to 800 Hz in the fire's rows, and at 100 to 1600 Hz in the jet's.
const SMALL: Recipe = Recipe { voxel_size_m: 0.005, ..Recipe::STANDARD };

impl Shipped {
    /// All built-in textures.
    pub const ALL: [Self; 2] = [
        // Seeds with which no row ends during a burst.
        Self { name: "fire", recipe: Recipe { seed: 2, ..SMALL }, speeds: (0.5, 8.0, 8) },
        Self { name: "jet", recipe: Recipe { kind: FlowModel::Jet, ..SMALL }, speeds: (1.0, 16.0, 9) },
    ];
}
