//! A recording's outline.

use std::sync::Arc;

use egui::{Mesh, Pos2, Rect, Shape, Ui};

use super::super::theme;
use pyrophone_analysis::RecordingOverview;

/// The outline, as last drawn.
#[derive(Default)]
pub struct RecordingOutline {
    drawn: Option<(Arc<RecordingOverview>, Rect, Arc<Mesh>)>,
}

impl RecordingOutline {
    /// Draws least and largest samples as a band.
    pub fn show(&mut self, ui: &Ui, rect: Rect, overview: &Arc<RecordingOverview>) {
        let same = self.drawn.as_ref().filter(|(of, place, _)| Arc::ptr_eq(of, overview) && *place == rect);
        let drawn = match same {
            Some((_, _, drawn)) => drawn.clone(),
            None => Arc::new(mesh(rect, overview)),
        };
        self.drawn = Some((overview.clone(), rect, drawn.clone()));
        ui.painter().add(Shape::Mesh(drawn));
    }
}

fn mesh(rect: Rect, overview: &RecordingOverview) -> Mesh {
    let largest = overview.outline.iter().flatten().fold(0.0f32, |largest, x| largest.max(x.abs())).max(1e-6);
    let columns = overview.outline.len().max(1) as f32;
    let y = |value: f32| rect.center().y - 0.48 * rect.height() * value / largest;
    let (half, color) = (0.5 * (rect.width() / columns).max(1.0), theme::ASH.gamma_multiply(0.85));
    let mut mesh = Mesh::default();
    for (index, [low, high]) in overview.outline.iter().enumerate() {
        let x = rect.left() + (index as f32 + 0.5) / columns * rect.width();
        // A silent stretch is a line.
        let (top, bottom) = (y(*high) - 0.5, y(*low) + 0.5);
        mesh.add_colored_rect(Rect::from_min_max(Pos2::new(x - half, top), Pos2::new(x + half, bottom)), color);
    }
    mesh
}
