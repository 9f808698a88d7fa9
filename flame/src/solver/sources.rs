//! Effect of emitters on the gas.

use super::combustion::{Combustion, FUEL, TEMPERATURE};
use super::domain::cell_index;
use super::emitter::Emitter;
use super::parallel::elements;
use super::{Forcing, Solver};

use rayon::prelude::*;

/// Largest number of volumes that a cell may gain in a substep.
const MOST_EXPANSION: f32 = 0.5;

impl Solver {
    /// Cells that an emitter may cover, with their centres in m.
    fn covered(&self, emitter: &Emitter) -> impl Iterator<Item = ([usize; 3], [f64; 3])> + use<> {
        let (h, shape, origin) = (self.domain.voxel_size_m(), self.domain.shape(), self.origin_m());
        let reach = emitter.shape.reach_m();
        let [xs, ys, zs]: [std::ops::Range<usize>; 3] = std::array::from_fn(|axis| {
            let first = (emitter.centre_m[axis] - reach[axis] - origin[axis]) / h - 1.0;
            let last = (emitter.centre_m[axis] + reach[axis] - origin[axis]) / h + 2.0;
            // Casting saturates, and turns NaN into zero.
            (first.max(0.0) as usize)..(last.max(0.0) as usize).min(shape[axis])
        });
        let columns = xs.flat_map(move |i| ys.clone().map(move |j| [i, j]));
        let cells = columns.flat_map(move |[i, j]| zs.clone().map(move |k| [i, j, k]));
        cells.map(move |cell| (cell, std::array::from_fn(|axis| origin[axis] + cell[axis] as f64 * h)))
    }

    /// Adds fuel, heat and gas from the emitters.
    pub(super) fn emit(&mut self, dt_s: f64, surroundings: &Forcing) {
        let (h, shape) = (self.domain.voxel_size_m(), self.domain.shape());
        let is_core = matches!(self.parameters.combustion, Some(Combustion::BlueCore { .. }));
        for emitter in &surroundings.emitters {
            let hold = 1.0 - maths::exp(-emitter.drag_hz.max(0.0) * dt_s);
            for ([i, j, k], position) in self.covered(emitter) {
                let cover = emitter.cover(position, h) as f32;
                let scalar = &mut self.scalars[cell_index(shape, i, j, k)];
                if is_core {
                    if emitter.fuel > 0.5 {
                        let relative = std::array::from_fn(|axis| position[axis] - emitter.centre_m[axis]);
                        scalar[FUEL] = scalar[FUEL].min(emitter.shape.distance_m(relative) as f32);
                    }
                } else if cover > 0.0 {
                    let noise = if emitter.flicker > 0.0 {
                        let eddies = self.parameters.turbulence_scale_m;
                        let turnovers = (self.time_s * self.parameters.turbulence_rate_hz) as f32;
                        self.turbulence.velocity_at(position.map(|x| (x / eddies) as f32), turnovers)[0]
                    } else {
                        0.0
                    };
                    let fuel = emitter.fuel as f32 * (1.0 + emitter.flicker as f32 * noise);
                    scalar[FUEL] = scalar[FUEL].max(cover * fuel.clamp(0.0, 1.0));
                    scalar[TEMPERATURE] = scalar[TEMPERATURE].max(cover * emitter.temperature as f32);
                }
                if cover > 0.0 && hold > 0.0 {
                    // A face between two covered cells is affected by both.
                    let share = 1.0 - (1.0 - cover * hold as f32).max(0.0).sqrt();
                    for axis in 0..3 {
                        let mut face = [i, j, k];
                        for _ in 0..2 {
                            let index = cell_index(self.domain.face_shape(axis), face[0], face[1], face[2]);
                            let value = &mut self.velocity.components[axis][index];
                            *value += share * (emitter.velocity_m_s[axis] as f32 - *value);
                            face[axis] += 1;
                        }
                    }
                }
            }
        }
    }

    /// Adds the emitters' volume; no cell gains more than the grid can transport.
    pub(super) fn add_expansion(&mut self, dt_s: f64, surroundings: &Forcing) {
        for emitter in surroundings.emitters.iter().filter(|emitter| emitter.outflow_hz != 0.0) {
            for ([i, j, k], position) in self.covered(emitter) {
                let cover = emitter.cover(position, self.domain.voxel_size_m());
                self.source[cell_index(self.domain.shape(), i, j, k)] += (cover * emitter.outflow_hz) as f32;
            }
        }
        let most = MOST_EXPANSION / dt_s as f32;
        elements(&mut self.source).for_each(|source| *source = source.clamp(-most, most));
    }
}
