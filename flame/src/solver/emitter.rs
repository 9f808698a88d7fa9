//! Emitters: sources of gas, fuel and heat.

/// Shape of an emitter, about its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EmitterShape {
    /// A ball.
    Ball {
        /// Radius in m.
        radius_m: f64,
    },
    /// A box along the axes.
    Box {
        /// Half its edges in m.
        half_m: [f64; 3],
    },
    /// An upright cylinder.
    Cylinder {
        /// Radius in m.
        radius_m: f64,
        /// Half its height in m.
        half_height_m: f64,
    },
}

impl EmitterShape {
    /// Distance in m from the surface, negative inside, of a position relative to the centre.
    pub fn distance_m(&self, place_m: [f64; 3]) -> f64 {
        match *self {
            Self::Ball { radius_m } => length(&place_m) - radius_m,
            Self::Box { half_m } => {
                let beyond: [f64; 3] = std::array::from_fn(|axis| place_m[axis].abs() - half_m[axis]);
                length(&beyond.map(|d| d.max(0.0))) + beyond.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)).min(0.0)
            }
            Self::Cylinder { radius_m, half_height_m } => {
                let beyond = [length(&place_m[..2]) - radius_m, place_m[2].abs() - half_height_m];
                length(&beyond.map(|d| d.max(0.0))) + beyond[0].max(beyond[1]).min(0.0)
            }
        }
    }

    /// Half the edges of the bounding box, in m.
    pub fn reach_m(&self) -> [f64; 3] {
        match *self {
            Self::Ball { radius_m } => [radius_m; 3],
            Self::Box { half_m } => half_m,
            Self::Cylinder { radius_m, half_height_m } => [radius_m, radius_m, half_height_m],
        }
    }
}

/// A source of gas, fuel or heat at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Emitter {
    /// Its shape.
    pub shape: EmitterShape,
    /// Its centre in m.
    pub centre_m: [f64; 3],
    /// Velocity of the gas within it, in m/s.
    pub velocity_m_s: [f64; 3],
    /// Rate at which gas inside it approaches that velocity, in 1/s.
    pub drag_hz: f64,
    /// Fuel within it, 0-1; in a blue core, gas flows out while this is above one half.
    pub fuel: f64,
    /// Variation of the fuel in space and time, 0-1.
    pub flicker: f64,
    /// Least temperature within it, 0-1.
    pub temperature: f64,
    /// Volume added per volume within it and per second: a burst.
    pub outflow_hz: f64,
}

impl Emitter {
    /// Covered share of the cell at a position, 0-1.
    pub fn cover(&self, place_m: [f64; 3], voxel_size_m: f64) -> f64 {
        let relative = std::array::from_fn(|axis| place_m[axis] - self.centre_m[axis]);
        (0.5 - self.shape.distance_m(relative) / voxel_size_m).clamp(0.0, 1.0)
    }
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}
