//! Eddies too small, or from too far away, to be simulated: an added noise field.

use std::sync::{Arc, Mutex, PoisonError};

use super::lattice::Lattice;
use super::random::Random;

/// Samples along an edge of the tile.
const SIZE: usize = 32;

/// Number of waves in the tile.
const WAVES: usize = 64;

/// Highest wave number, in waves per tile: more than four samples of the tile for each wave.
const HIGHEST: i32 = 7;

/// Drift of the two copies of the tile per turnover of the largest eddies, in tiles.
const DRIFTS: [[f32; 3]; 2] = [[0.37, 0.23, 0.71], [-0.29, 0.31, -0.53]];

/// Velocities without divergence whose spectrum falls as Kolmogorov's (similar to those that Bridson et al. 2007 and
/// Kim et al. 2008 add to flames), periodic in space but not in time.
#[derive(Debug, Clone)]
pub struct Turbulence {
    tile: Arc<[[f32; 4]]>,
}

/// The most recent noise, with its seed. It takes tens of milliseconds to make, and solvers come in pairs and are often
/// created with the same seed.
#[derive(Debug)]
struct Latest(Mutex<Option<(u64, Turbulence)>>);

static LATEST: Latest = Latest(Mutex::new(None));

impl Latest {
    fn get(&self, seed: u64) -> Turbulence {
        // Held while noise is made: a concurrent caller usually wants the same noise.
        let mut latest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((number, turbulence)) = &*latest
            && *number == seed
        {
            return turbulence.clone();
        }
        let turbulence = Turbulence::made(seed);
        *latest = Some((seed, turbulence.clone()));
        turbulence
    }
}

impl Turbulence {
    /// Noise with seed `seed`, of rms 1 per component.
    pub fn new(seed: u64) -> Self {
        LATEST.get(seed)
    }

    fn made(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut tile = vec![[0.0f32; 4]; SIZE * SIZE * SIZE];
        for _ in 0..WAVES {
            let (wave, magnitude) = loop {
                let wave: [i32; 3] = std::array::from_fn(|_| random.below(2 * HIGHEST as u64 + 1) as i32 - HIGHEST);
                let square: i32 = wave.iter().map(|k| k * k).sum();
                if square > 0 && square <= HIGHEST * HIGHEST {
                    break (wave, f64::from(square).sqrt());
                }
            };
            let axis: [f64; 3] = std::array::from_fn(|_| random.normal());
            let direction = crate::grid::cross(wave.map(f64::from), axis);
            let norm = crate::grid::length(direction).max(1e-9);
            // Energy per wave number falls as k^(-5/3); a shell holds k² waves, so a wave's amplitude falls as
            // k^(-11/6). Waves are drawn uniformly from the ball.
            let amplitude = maths::pow(magnitude, -11.0 / 6.0) / norm;
            let phase = std::f64::consts::TAU * random.uniform();
            // Only a few phases occur: integer fractions of a turn.
            let last = SIZE as i32 - 1;
            let lowest: i32 = wave.iter().map(|k| k.min(&0) * last).sum();
            let highest: i32 = wave.iter().map(|k| k.max(&0) * last).sum();
            let add = |parts: i32| {
                let turns = f64::from(parts) / SIZE as f64;
                let wave = amplitude * maths::cos(std::f64::consts::TAU * turns + phase);
                direction.map(|along| (wave * along) as f32)
            };
            let added: Vec<[f32; 3]> = (lowest..=highest).map(add).collect();
            for (line, values) in tile.chunks_exact_mut(SIZE).enumerate() {
                let mut parts = wave[0] * (line / SIZE) as i32 + wave[1] * (line % SIZE) as i32 - lowest;
                for value in values {
                    for (value, added) in value.iter_mut().zip(added[parts as usize]) {
                        *value += added;
                    }
                    parts += wave[2];
                }
            }
        }
        let power: f64 = tile.iter().flat_map(|value| &value[..3]).map(|v| maths::square(f64::from(*v))).sum();
        let rms = (power / (3 * tile.len()) as f64).sqrt().max(1e-30) as f32;
        tile.iter_mut().flatten().for_each(|value| *value /= rms);
        Self { tile: tile.into() }
    }

    /// The noise at a position, in units of the largest eddies' size, and a time, in units of their turnover.
    #[inline(always)]
    pub fn velocity_at(&self, place: [f32; 3], time: f32) -> [f32; 3] {
        let lattice = Lattice::repeating(SIZE);
        let mut sum = [0.0; 3];
        for drift in DRIFTS {
            let position = std::array::from_fn(|axis| (place[axis] + drift[axis] * time) * SIZE as f32);
            let value = lattice.sample(&self.tile, position);
            for (sum, value) in sum.iter_mut().zip(value) {
                *sum += std::f32::consts::FRAC_1_SQRT_2 * value;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_of_one_number_is_made_once_and_always_the_same() {
        let latest = Latest(Mutex::new(None));
        let first = latest.get(7);
        assert!(Arc::ptr_eq(&first.tile, &latest.get(7).tile));
        assert_ne!(first.tile, latest.get(8).tile);
        assert_eq!(first.tile, latest.get(7).tile);
        assert_eq!(first.tile, Turbulence::new(7).tile);
    }
}
