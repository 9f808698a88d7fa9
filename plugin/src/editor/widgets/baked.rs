//! Shapes that rarely change: cut into triangles once, not in every frame.

use std::hash::Hash;
use std::sync::Arc;

use egui::epaint::{Mesh, Tessellator};
use egui::{Id, Painter, Rect, Shape};

/// Triangles, and what they were made from.
#[derive(Clone)]
struct Baked {
    key: u64,
    mesh: Arc<Mesh>,
}

/// Draws `shapes`, which contain no text. They are rebuilt only if `key` differs from the last frame's: it has
/// everything that they depend on.
pub fn baked(painter: &Painter, id: Id, key: impl Hash, shapes: impl FnOnce() -> Vec<Shape>) {
    let context = painter.ctx();
    let pixels_per_point = context.pixels_per_point();
    let key = egui::util::hash((key, pixels_per_point.to_bits()));
    let known: Option<Baked> = context.data(|data| data.get_temp(id));
    let mesh = match known {
        Some(baked) if baked.key == key => baked.mesh,
        _ => {
            let options = context.tessellation_options(|options| *options);
            // Neither the font's texture nor its discs: both may be replaced while the triangles are kept.
            let mut tessellator = Tessellator::new(pixels_per_point, options, [1, 1], vec![]);
            let mut mesh = Mesh::default();
            shapes().into_iter().for_each(|shape| tessellator.tessellate_shape(shape, &mut mesh));
            let mesh = Arc::new(mesh);
            context.data_mut(|data| data.insert_temp(id, Baked { key, mesh: mesh.clone() }));
            mesh
        }
    };
    painter.add(Shape::Mesh(mesh));
}

/// A rectangle as part of a key.
pub fn bits(rect: Rect) -> [u32; 4] {
    [rect.left(), rect.top(), rect.right(), rect.bottom()].map(f32::to_bits)
}

#[cfg(test)]
mod tests {
    use egui::{Color32, Context, Pos2, RawInput};

    use super::*;

    #[test]
    fn shapes_are_made_once_and_again_where_the_key_changes() {
        let context = Context::default();
        let mut made = 0;
        for key in [1, 1, 2, 2, 2, 1] {
            let mut frame = |ui: &mut egui::Ui| {
                baked(ui.painter(), Id::unique("test"), key, || {
                    made += 1;
                    vec![Shape::circle_filled(Pos2::new(5.0, 5.0), 4.0, Color32::WHITE)]
                });
            };
            let mut output = context.run_ui(RawInput::default(), &mut frame);
            output.textures_delta.clear();
            let meshes = output.shapes.iter().filter(|clipped| matches!(&clipped.shape, Shape::Mesh(_))).count();
            assert_eq!(meshes, 1);
        }
        assert_eq!(made, 3);
    }
}
