//! The flame front as triangles with shared corners, for pictures and other programs.

use std::collections::HashMap;
use std::io::{Result as IoResult, Write};

use super::measure::Front;
use crate::error::Error;
use crate::grid::Grid;

/// A closed surface in world units; triangles are counter-clockwise as seen from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Positions of the corners.
    pub vertices: Vec<[f64; 3]>,
    /// Triples of corners, as indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
}

impl Front {
    /// The front of a field; empty if there is none.
    ///
    /// # Errors
    /// As [`Front::measure`], and beyond 2^32 corners.
    pub fn mesh(&self, field: &Grid<1>) -> Result<Mesh, Error> {
        let transform = field.transform();
        let mirrored = transform.is_mirrored();
        let mut mesh = Mesh::default();
        let mut numbers = HashMap::new();
        self.walk(field, |_, corners, _| {
            let mut corners = corners.map(|corner| {
                *numbers.entry(corner.place).or_insert_with(|| {
                    mesh.vertices.push(transform.to_world(corner.index));
                    (mesh.vertices.len() - 1) as u32
                })
            });
            if mirrored {
                corners.swap(1, 2);
            }
            mesh.triangles.push(corners);
        })?;
        match mesh.vertices.len() as u128 {
            found if found > 1 << 32 => Err(Error::TooLarge { found, allowed: 1 << 32 }),
            _ => Ok(mesh),
        }
    }
}

impl Mesh {
    /// Writes Wavefront OBJ as text, with numbers that read back as the same `f64`.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn write_obj(&self, to: &mut impl Write) -> IoResult<()> {
        writeln!(to, "# Flame front, world units")?;
        for [x, y, z] in &self.vertices {
            writeln!(to, "v {x} {y} {z}")?;
        }
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| u64::from(corner) + 1);
            writeln!(to, "f {a} {b} {c}")?;
        }
        Ok(())
    }

    /// Writes little-endian binary PLY, with corners as `f32`.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn write_ply(&self, to: &mut impl Write) -> IoResult<()> {
        write!(
            to,
            "ply\nformat binary_little_endian 1.0\ncomment flame front, world units\nelement vertex {}\n\
             property float x\nproperty float y\nproperty float z\nelement face {}\n\
             property list uchar uint vertex_indices\nend_header\n",
            self.vertices.len(),
            self.triangles.len(),
        )?;
        for place in self.vertices.iter().flatten() {
            to.write_all(&(*place as f32).to_le_bytes())?;
        }
        for triangle in &self.triangles {
            to.write_all(&[3])?;
            for corner in triangle {
                to.write_all(&corner.to_le_bytes())?;
            }
        }
        Ok(())
    }
}
