//! A panel with a title, and buttons in one style.

use egui::epaint::RectShape;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, Pos2, Rect, Response, Role, Sense, Shape, Stroke, StrokeKind, Ui, UiBuilder, Vec2, WidgetInfo};

use super::super::{map, theme};
use super::baked::{baked, bits};

/// Inside a panel's edge, and the height of its title, in points.
const MARGIN: f32 = 9.0;
const TITLE: f32 = 16.0;
/// Least space beside the words of a button, in points.
const PADDING: f32 = 3.0;

/// Draws a panel with a title and, where it fits, a note on it; returns the area for its content.
pub fn section(ui: &Ui, rect: Rect, title: &str, note: &str) -> Rect {
    let painter = ui.painter().with_clip_rect(rect);
    baked(&painter, ui.scope_id().with(("panel", title)), bits(rect), || {
        vec![Shape::rect_filled(rect, f32::from(theme::ROUNDING) + 2.0, theme::PANEL)]
    });
    let inner = rect.shrink(MARGIN);
    let name = painter.text(inner.left_top(), Align2::LEFT_TOP, title, theme::head(), theme::EMBER);
    let galley = painter.layout_no_wrap(note.to_owned(), theme::small(), theme::WEAK);
    if name.right() + 10.0 + galley.size().x <= inner.right() {
        let at = Pos2::new(name.right() + 10.0, name.center().y - 0.5 * galley.size().y);
        painter.galley(at, galley, theme::WEAK);
    }
    inner.with_min_y(inner.top() + TITLE + 4.0)
}

/// The area of a panel's title.
pub fn title_row(rect: Rect) -> Rect {
    let inner = rect.shrink(MARGIN);
    inner.with_max_y(inner.top() + TITLE)
}

/// Lays out `show` within `rect` alone.
pub fn within<R>(ui: &mut Ui, rect: Rect, name: &str, show: impl FnOnce(&mut Ui) -> R) -> R {
    let mut part = ui.new_child(UiBuilder::new().id_salt(name).max_rect(rect));
    part.set_clip_rect(rect.expand(3.0).intersect(ui.clip_rect()));
    part.spacing_mut().item_spacing = Vec2::new(4.0, 3.0);
    part.spacing_mut().button_padding = Vec2::new(6.0, 2.0);
    show(&mut part)
}

/// A button that fills `rect`; its name is noted for tests. It looks and behaves like the toolkit's, and costs a fifth.
pub fn filled(ui: &mut Ui, rect: Rect, words: &str, name: &str, is_on: bool, is_enabled: bool) -> Response {
    let sense = if is_enabled { Sense::click() } else { Sense::hover() };
    let response = ui.interact(rect, ui.scope_id().with(("button", name)), sense);
    map::note(ui, format_args!("button.{name}"), rect);
    let look = ui.style().interact_selectable(&response, is_on);
    let opacity = if is_enabled { 1.0 } else { ui.visuals().disabled_alpha() };
    let (fill, stroke) = (look.weak_bg_fill.gamma_multiply(opacity), look.bg_stroke);
    let stroke = Stroke::new(stroke.width, stroke.color.gamma_multiply(opacity));
    let key = (bits(rect), fill, stroke.color, stroke.width.to_bits());
    baked(ui.painter(), response.id, key, || {
        vec![Shape::Rect(RectShape::new(rect, look.corner_radius, fill, stroke, StrokeKind::Inside))]
    });
    let color = theme::TEXT.gamma_multiply(opacity);
    let mut job = LayoutJob::simple_singleline(words.to_owned(), theme::small(), color);
    job.wrap = TextWrapping::truncate_at_width(rect.width() - 2.0 * PADDING);
    let galley = ui.painter().layout_job(job);
    let place = Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size());
    ui.painter().galley(place.min, galley, color);
    response.widget_info(|| WidgetInfo::selected(Role::Button, is_enabled, is_on, words));
    response
}

/// `rect` cut into `count` equal parts side by side, `gap` points between them.
pub fn columns(rect: Rect, count: usize, gap: f32) -> impl Iterator<Item = Rect> {
    let width = (rect.width() - gap * (count.max(1) - 1) as f32) / count.max(1) as f32;
    (0..count).map(move |n| {
        let left = rect.left() + n as f32 * (width + gap);
        Rect::from_min_max(Pos2::new(left, rect.top()), Pos2::new(left + width, rect.bottom()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_fill_their_place() {
        let rect = Rect::from_min_max(Pos2::new(10.0, 5.0), Pos2::new(110.0, 25.0));
        let found: Vec<Rect> = columns(rect, 3, 5.0).collect();
        assert_eq!((found.len(), found[0].left(), found[2].right()), (3, 10.0, 110.0));
        assert!((found[1].left() - found[0].right() - 5.0).abs() < 1e-4);
        assert_eq!(columns(rect, 0, 5.0).count(), 0);
    }
}
