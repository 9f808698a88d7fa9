//! Pictures of a flame front: a small renderer with a depth buffer.

use pyrophone_flame::front::Mesh;

/// Size of a picture in pixels.
const SIZE: (usize, usize) = (420, 520);
/// Samples per pixel along each axis.
const FINE: usize = 3;
/// Share of the picture that the flames may fill.
const FILL: f64 = 0.88;
/// Camera angles in radians: azimuth about the upward axis, and elevation.
const CAMERA: (f64, f64) = (0.6, 0.22);
/// Direction from the front to the light, in camera axes: right, up, towards the camera.
const LIGHT: [f64; 3] = [-0.46, 0.68, 0.57];

const GROUND: [f64; 3] = [17.0, 12.0, 12.0];
/// Colours from a dark, edge-on surface to one that faces camera and light.
const EMBER: [(f64, [f64; 3]); 6] = [
    (0.0, [52.0, 12.0, 16.0]),
    (0.25, [128.0, 30.0, 22.0]),
    (0.5, [212.0, 74.0, 24.0]),
    (0.72, [250.0, 142.0, 44.0]),
    (0.9, [255.0, 208.0, 112.0]),
    (1.0, [255.0, 246.0, 214.0]),
];

/// Red, green and blue, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Three bytes per pixel.
    pub rgb: Vec<u8>,
}

/// One view for all pictures of a flame, so that they are comparable.
#[derive(Debug, Clone)]
pub struct View {
    /// Right, up and towards the camera, in world axes.
    axes: [[f64; 3]; 3],
    /// Centre of the view, in camera axes.
    centre: [f64; 3],
    /// Fine pixels per world unit.
    scale: f64,
}

impl View {
    /// A view that holds all meshes. The longer of the second and third axes points upwards.
    pub fn of_meshes<'a>(meshes: impl Iterator<Item = &'a Mesh> + Clone) -> Self {
        let positions = || meshes.clone().flat_map(|mesh| &mesh.vertices);
        let (low, high) = bounds(positions().copied());
        let (turn, raise) = CAMERA;
        let (right, back) = ([turn.cos(), turn.sin(), 0.0], [turn.sin(), -turn.cos(), 0.0]);
        let up = std::array::from_fn(|axis| raise.cos() * [0.0, 0.0, 1.0][axis] - raise.sin() * back[axis]);
        let towards = std::array::from_fn(|axis| raise.sin() * [0.0, 0.0, 1.0][axis] + raise.cos() * back[axis]);
        let mut axes: [[f64; 3]; 3] = [right, up, towards];
        if high[1] - low[1] > high[2] - low[2] {
            // Turned about the first axis, the second takes the third's place; nothing is mirrored.
            axes = axes.map(|[x, y, z]| [x, z, -y]);
        }
        let (low, high) = bounds(positions().map(|position| axes.map(|axis| dot(axis, *position))));
        let fits = |axis: usize, pixels: usize| FILL * (FINE * pixels) as f64 / (high[axis] - low[axis]).max(1e-9);
        let scale = fits(0, SIZE.0).min(fits(1, SIZE.1));
        Self { axes, centre: std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis])), scale }
    }

    /// Draws a front.
    pub fn draw(&self, mesh: &Mesh) -> Picture {
        let (width, height) = (FINE * SIZE.0, FINE * SIZE.1);
        let mut canvas =
            Canvas { width, depth: vec![f64::NEG_INFINITY; width * height], glow: vec![0.0; width * height] };
        let positions: Vec<[f64; 3]> = mesh.vertices.iter().map(|position| self.project(*position)).collect();
        let glows: Vec<f64> = self.normals(mesh, &positions).into_iter().map(glow).collect();
        for triangle in &mesh.triangles {
            let corner =
                |n: usize| triangle.get(n).and_then(|v| Some((*positions.get(*v as usize)?, *glows.get(*v as usize)?)));
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                canvas.fill([a, b, c]);
            }
        }
        canvas.shrunk()
    }

    /// Position in fine pixels: from the left, from the bottom, and towards the camera.
    fn project(&self, world: [f64; 3]) -> [f64; 3] {
        let middle = [0.5 * (FINE * SIZE.0) as f64, 0.5 * (FINE * SIZE.1) as f64, 0.0];
        std::array::from_fn(|axis| middle[axis] + self.scale * (dot(self.axes[axis], world) - self.centre[axis]))
    }

    /// Unit normals at the corners in camera axes: means over the adjacent triangles.
    fn normals(&self, mesh: &Mesh, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut normals = vec![[0.0; 3]; positions.len()];
        for triangle in &mesh.triangles {
            let [Some(a), Some(b), Some(c)] = triangle.map(|corner| positions.get(corner as usize)) else { continue };
            let (u, v): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            for corner in triangle {
                if let Some(sum) = normals.get_mut(*corner as usize) {
                    (0..3).for_each(|axis| sum[axis] += normal[axis]);
                }
            }
        }
        normals.into_iter().map(|sum| sum.map(|part| part / dot(sum, sum).sqrt().max(1e-30))).collect()
    }
}

/// Brightness 0-1 of a surface with this normal: lit from above, with a body that is brighter where the view passes
/// into it.
fn glow(normal: [f64; 3]) -> f64 {
    let lit = dot(normal, LIGHT).max(0.0);
    let facing = normal[2].max(0.0);
    (0.08 + 0.5 * lit + 0.42 * facing * facing).clamp(0.0, 1.0)
}

struct Canvas {
    width: usize,
    depth: Vec<f64>,
    /// Brightness of the nearest surface, if there is one.
    glow: Vec<f64>,
}

impl Canvas {
    /// Fills a triangle, given its corners in fine pixels and their brightness.
    fn fill(&mut self, corners: [([f64; 3], f64); 3]) {
        let [(a, _), (b, _), (c, _)] = corners;
        let edge = |p: [f64; 3], q: [f64; 3], x: f64, y: f64| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        let doubled = edge(a, b, c[0], c[1]);
        let height = self.depth.len() / self.width;
        let range = |axis: usize, size: usize| {
            let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            low.floor().clamp(0.0, size as f64) as usize..(high.ceil() + 1.0).clamp(0.0, size as f64) as usize
        };
        // Seen from behind, or edge-on: something lies before it.
        if doubled <= 0.0 {
            return;
        }
        for y in range(1, height) {
            for x in range(0, self.width) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let weights = [edge(b, c, px, py), edge(c, a, px, py), edge(a, b, px, py)].map(|part| part / doubled);
                if weights.iter().any(|weight| *weight < 0.0) {
                    continue;
                }
                let mix = |value: fn(&([f64; 3], f64)) -> f64| {
                    corners.iter().zip(weights).map(|(corner, weight)| weight * value(corner)).sum::<f64>()
                };
                let (depth, at) = (mix(|corner| corner.0[2]), (height - 1 - y) * self.width + x);
                if depth > self.depth[at] {
                    self.depth[at] = depth;
                    self.glow[at] = mix(|corner| corner.1);
                }
            }
        }
    }

    /// The picture, each pixel the mean of its samples.
    fn shrunk(&self) -> Picture {
        let (columns, rows) = SIZE;
        let mut rgb = Vec::with_capacity(3 * columns * rows);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let mut sum = [0.0; 3];
            for sample in 0..FINE * FINE {
                let at = (row * FINE + sample / FINE) * self.width + column * FINE + sample % FINE;
                let color = if self.depth[at] > f64::NEG_INFINITY { ember(self.glow[at]) } else { GROUND };
                (0..3).for_each(|channel| sum[channel] += color[channel]);
            }
            rgb.extend(sum.map(|channel| (channel / (FINE * FINE) as f64).round() as u8));
        }
        Picture { width: columns as u32, height: rows as u32, rgb }
    }
}

fn ember(glow: f64) -> [f64; 3] {
    let above = EMBER.iter().position(|(at, _)| *at >= glow).unwrap_or(EMBER.len() - 1).max(1);
    let ((from, a), (to, b)) = (EMBER[above - 1], EMBER[above]);
    let share = ((glow - from) / (to - from)).clamp(0.0, 1.0);
    std::array::from_fn(|channel| a[channel] + share * (b[channel] - a[channel]))
}

fn bounds(positions: impl Iterator<Item = [f64; 3]>) -> ([f64; 3], [f64; 3]) {
    let none = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let (low, high) = positions.fold(none, |(low, high), position| {
        (std::array::from_fn(|i| low[i].min(position[i])), std::array::from_fn(|i| high[i].max(position[i])))
    });
    if low[0] <= high[0] { (low, high) } else { ([-1.0; 3], [1.0; 3]) }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube from 0 to `edges`, triangles counter-clockwise from outside.
    fn cube(edges: [f64; 3]) -> Mesh {
        let vertices =
            (0..8).map(|n| std::array::from_fn(|axis| edges[axis] * f64::from((n >> (2 - axis)) & 1))).collect();
        let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Mesh { vertices, triangles }
    }

    fn covered(picture: &Picture) -> usize {
        let ground = GROUND.map(|channel| channel as u8);
        picture.rgb.chunks(3).filter(|pixel| **pixel != ground).count()
    }

    #[test]
    fn a_box_covers_the_area_of_its_faces_and_stands_upright() {
        for edges in [[1.0, 1.0, 3.0], [1.0, 3.0, 1.0]] {
            let mesh = cube(edges);
            let view = View::of_meshes([&mesh].into_iter());
            let picture = view.draw(&mesh);
            let pixel = view.scale / FINE as f64;
            // Orthographic: every face counts with the part that faces the camera.
            let faces = [edges[1] * edges[2], edges[0] * edges[2], edges[0] * edges[1]];
            let seen: f64 = (0..3).map(|axis| faces[axis] * view.axes[2][axis].abs()).sum::<f64>() * pixel * pixel;
            let found = covered(&picture) as f64;
            assert!((found / seen - 1.0).abs() < 0.02, "{found} {seen}");
            // Its long side is vertical.
            let rows = picture.rgb.chunks(3 * SIZE.0).filter(|row| row.chunks(3).any(|p| p != [17, 12, 12])).count();
            assert!(rows as f64 > 0.8 * SIZE.1 as f64, "{rows}");
        }
    }

    #[test]
    fn nothing_is_an_empty_picture() {
        let view = View::of_meshes([].into_iter());
        assert_eq!(covered(&view.draw(&Mesh::default())), 0);
    }
}
