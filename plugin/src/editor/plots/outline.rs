//! A recording's outline.

use egui::{Pos2, Rect, Shape, Stroke, Ui};

use super::super::theme;
use crate::analysis::Portrait;

/// Draws least and largest samples as a band.
pub fn show(ui: &Ui, rect: Rect, portrait: &Portrait) {
    let largest = portrait.outline.iter().flatten().fold(0.0f32, |largest, x| largest.max(x.abs())).max(1e-6);
    let columns = portrait.outline.len().max(1) as f32;
    let y = |value: f32| rect.center().y - 0.48 * rect.height() * value / largest;
    let lines = portrait.outline.iter().enumerate().map(|(index, [low, high])| {
        let x = rect.left() + (index as f32 + 0.5) / columns * rect.width();
        let stroke = Stroke::new((rect.width() / columns).max(1.0), theme::ASH.gamma_multiply(0.85));
        // A silent stretch is a line.
        Shape::line_segment([Pos2::new(x, y(*low) + 0.5), Pos2::new(x, y(*high) - 0.5)], stroke)
    });
    ui.painter().extend(lines);
}
