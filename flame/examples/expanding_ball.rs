//! A flame whose flux is known: gas that expands evenly inside a ball of fire. The front is measured, and compared with the
//! ball's volume (Gauss's theorem), which is what equations 4 and 5 of Chadwick & James (2011) come to here.
//!
//! `cargo run -p pyrophone-flame --example expanding_ball`

use std::f64::consts::PI;

use pyrophone_flame::grid::{Grid, Transform};
use pyrophone_flame::velocity::{Placement, Velocity};
use pyrophone_flame::{Frame, Front};

const VOXELS: usize = 48;
const VOXEL_SIZE_M: f64 = 0.02;
const RADIUS_M: f64 = 0.3;
/// Divergence of the flow in 1/s: so much new volume for every volume of gas.
const EXPANSION_PER_S: f64 = 2.0;

fn main() -> Result<(), pyrophone_flame::Error> {
    // The ball's centre is the world's origin.
    let corner = -0.5 * VOXEL_SIZE_M * (VOXELS - 1) as f64;
    let transform = Transform::uniform(VOXEL_SIZE_M, [corner; 3])?;
    let places = (0..VOXELS.pow(3)).map(|n| [n / (VOXELS * VOXELS), n / VOXELS % VOXELS, n % VOXELS]);
    let places: Vec<[f64; 3]> = places.map(|index| transform.to_world(index.map(|i| i as f64))).collect();

    // A field that falls linearly through 0.5 at the ball's surface, and a flow whose divergence is the same everywhere.
    let burning = |[x, y, z]: &[f64; 3]| [(0.5 + (RADIUS_M - (x * x + y * y + z * z).sqrt()) / 0.2) as f32];
    let flow = |place: &[f64; 3]| place.map(|along| (EXPANSION_PER_S / 3.0 * along) as f32);
    let field: Vec<[f32; 1]> = places.iter().map(burning).collect();
    let velocity: Vec<[f32; 3]> = places.iter().map(flow).collect();
    let frame = Frame {
        number: 1,
        field: Grid::dense([VOXELS; 3], &field, transform)?,
        velocity: Velocity::Vectors(Grid::dense([VOXELS; 3], &velocity, transform)?, Placement::Collocated),
    };

    let measured = Front::new(0.5, 3)?.measure(&frame)?;
    let expected = EXPANSION_PER_S * 4.0 / 3.0 * PI * RADIUS_M.powi(3);
    println!("flux {:.6} m³/s, expected {expected:.6} m³/s", measured.flux);
    println!("area {:.4} m², expected {:.4} m²", measured.area, 4.0 * PI * RADIUS_M.powi(2));
    Ok(())
}
