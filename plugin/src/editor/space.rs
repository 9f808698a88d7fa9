//! The Space page: vortex sound from above, and the settings for its position.

use egui::Rect;

use super::controls::{self, Page};
use super::param_editor::ParamEditor;
use super::play::Parts;
use super::{GAP, listen, meter_bridge, part, theme};

/// Largest share of the width for the view, and width of the meters, in points.
const VIEW: f32 = 0.5;
const METERS: f32 = 190.0;
/// Width below which there is no room for the meters.
const ROOM_FOR_METERS: f32 = 900.0;
/// Below this height there is none for the output's spectrogram under the view.
const ROOM_FOR_COURSE: f32 = 60.0;

/// The page.
pub fn show(ui: &mut egui::Ui, rest: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let side = rest.height().min(VIEW * rest.width());
    let (view, right) = rest.split_left_right_at_x(rest.left() + side);
    let channels = parts.monitor.channels();
    parts.monitor.space.show(ui, view.with_max_y(view.top() + side), channels, edit);
    let below = view.with_min_y(view.top() + side + GAP);
    if below.height() >= ROOM_FOR_COURSE {
        parts.monitor.output().show(ui, below, theme::EMBER);
    }
    let mut controls = right.with_min_x(right.left() + GAP);
    if rest.width() >= ROOM_FOR_METERS {
        let meters = controls.with_min_x(controls.right() - METERS);
        controls.max.x = meters.left() - GAP;
        meter_bridge::show(ui, meters.with_max_y(meters.bottom() - listen::HEIGHT - GAP), parts.levels);
        part(ui, listen::place(meters), "listen", |ui| {
            parts.listen.show(ui, parts.monitor, parts.loader, parts.view, edit);
        });
    }
    part(ui, controls, "controls", |ui| controls::show(ui, Page::Space, edit));
}
