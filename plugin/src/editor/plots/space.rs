//! The sources of vortex sound from above, around the listener, who faces up; they glow with their level.

use egui::{Align2, Color32, CursorIcon, Id as Place, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2};
use pyrophone_settings::Id;
use pyrophone_synthesis::vortex::SeenSource;

use super::super::param_editor::ParamEditor;
use super::super::{map, theme};
use super::spectrogram::label;

/// Rings about the listener, in m; the largest that is needed is the view's edge.
const RINGS_M: [f32; 12] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0];
/// Least distance of two rings, in points, for the outer one's name.
const ROOM_FOR_NAME: f32 = 15.0;
/// Level in dB below the loudest at which a source no longer glows.
const GLOW_DB: f32 = 30.0;
/// Radius of the listener's head and of a silent source, and the increase for a loud one, in points.
const HEAD: f32 = 7.0;
const DOT: f32 = 2.0;
const MORE: f32 = 4.0;
/// Factor by which the loudest level decays per frame: the view's brightness follows the last second or so.
const FALL: f32 = 0.97;

/// The sources seen last, and those still arriving.
#[derive(Debug, Clone, Default)]
pub struct Space {
    shown: Vec<SeenSource>,
    arriving: Vec<SeenSource>,
    awaited: usize,
    loudest: f32,
    /// Radius of the view in m; it changes step by step.
    radius_m: f32,
    /// Position to which the centre is being dragged, in m to the right and to the front.
    held: Option<[f32; 2]>,
}

impl Space {
    /// Begins a view of this many sources.
    pub fn begin(&mut self, count: usize) {
        self.arriving.clear();
        self.awaited = count;
        if count == 0 {
            self.shown.clear();
        }
    }

    /// Adds one of them.
    pub fn take(&mut self, source: SeenSource) {
        let is_sound = source.level.is_finite() && source.position_m.iter().all(|x| x.is_finite());
        self.arriving.push(if is_sound { source } else { SeenSource::default() });
        if self.arriving.len() == self.awaited {
            std::mem::swap(&mut self.shown, &mut self.arriving);
            let loudest = self.shown.iter().map(|source| source.level).fold(0.0f32, f32::max);
            self.loudest = loudest.max(FALL * self.loudest);
        }
    }

    /// Draws the sources; the centre of those arranged in a ball can be dragged.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, channels: usize, edit: &mut ParamEditor<'_>) {
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 3.0, theme::WELL);
        let [right_m, front_m] = self.held.unwrap_or_else(|| middle_m(edit));
        let spread_m = edit.get(Id::VortexSpread) as f32;
        self.follow_radius(right_m.hypot(front_m) + spread_m);
        let view = View { centre: rect.center(), scale: (0.5 * rect.size().min_elem() - 16.0) / self.radius_m };

        rings(&painter, &view, self.radius_m);
        speakers(&painter, &view, self.radius_m, channels);
        self.sources(&painter, &view);
        head(&painter, view.centre);
        let is_dimmed = edit.inert(Id::VortexDistance as usize).is_some();
        let color = if is_dimmed { theme::WEAK } else { theme::VIOLET };
        let at = view.to_screen(right_m, front_m);
        painter.circle_stroke(at, (view.scale * spread_m).max(4.0), Stroke::new(1.0, color.gamma_multiply(0.8)));
        if !is_dimmed {
            self.drag(ui, at, &view, edit);
        }
        label(ui, rect, "from above", theme::VIOLET);
        if let Some(reason) = edit.inert(Id::VortexDistance as usize) {
            let at = rect.center_bottom() - Vec2::new(0.0, 8.0);
            painter.text(
                at,
                Align2::CENTER_BOTTOM,
                format!("{reason}, so there is no vortex sound"),
                theme::small(),
                theme::ALARM,
            );
        }
        map::note(ui, format_args!("space"), rect);
    }

    /// Moves towards the smallest ring that holds a radius, in small steps, so that the eye can follow.
    fn follow_radius(&mut self, wanted_m: f32) {
        let largest = RINGS_M[RINGS_M.len() - 1];
        let ring = RINGS_M.into_iter().find(|ring| *ring >= 1.05 * wanted_m).unwrap_or(largest);
        let is_held = self.held.is_some();
        if self.radius_m == 0.0 {
            self.radius_m = ring;
        } else if !is_held {
            let step = (ring / self.radius_m).ln().clamp(-0.1, 0.1);
            self.radius_m = if step.abs() < 0.01 { ring } else { self.radius_m * step.exp() };
        }
    }

    fn sources(&self, painter: &egui::Painter, view: &View) {
        for source in &self.shown {
            let [right, front, _] = source.position_m;
            let glow = glow(source.level, self.loudest);
            let color = mix(theme::VIOLET.gamma_multiply(0.35), theme::SPARK, glow);
            painter.circle_filled(view.to_screen(right, front), DOT + MORE * glow, color);
        }
    }

    /// The centre of the sources, which sets distance and azimuth.
    fn drag(&mut self, ui: &mut Ui, at: Pos2, view: &View, edit: &mut ParamEditor<'_>) {
        let handle = Rect::from_center_size(at, Vec2::splat(16.0));
        let response = ui.interact(handle, Place::unique("space middle"), Sense::drag());
        map::note(ui, format_args!("handle.space"), handle);
        let is_hot = response.hovered() || response.dragged();
        let color = if is_hot { theme::EMBER } else { theme::VIOLET };
        ui.painter().circle_stroke(at, 5.0, Stroke::new(1.5, color));
        if is_hot {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
        }
        let indices = [Id::VortexDistance as usize, Id::VortexAzimuth as usize];
        if response.drag_started() {
            indices.into_iter().for_each(|index| edit.begin(index));
            self.held = Some(middle_m(edit));
        }
        if let Some(held) = &mut self.held {
            let by = response.drag_delta() / view.scale;
            *held = [held[0] + by.x, held[1] - by.y];
            if response.dragged() && by != Vec2::ZERO {
                let [right, front] = held.map(f64::from);
                let rise = edit.get(Id::VortexElevation).to_radians().cos().max(0.05);
                edit.set(indices[0], right.hypot(front) / rise);
                edit.set(indices[1], right.atan2(front).to_degrees());
            }
        }
        if response.drag_stopped() {
            self.held = None;
            indices.into_iter().for_each(|index| edit.end(index));
        }
        response.on_hover_text("Drag to set distance and azimuth of the sources' centre. The circle is their spread.");
    }
}

/// Mapping from metres to points; front is up.
struct View {
    centre: Pos2,
    scale: f32,
}

impl View {
    fn to_screen(&self, right_m: f32, front_m: f32) -> Pos2 {
        self.centre + self.scale * Vec2::new(right_m, -front_m)
    }
}

/// The middle of the sources as the parameters have it, in m to the right and to the front.
fn middle_m(edit: &ParamEditor<'_>) -> [f32; 2] {
    let flat = edit.get(Id::VortexDistance) * edit.get(Id::VortexElevation).to_radians().cos();
    let (sin, cos) = edit.get(Id::VortexAzimuth).to_radians().sin_cos();
    [flat * sin, flat * cos].map(|x| x as f32)
}

/// The brightness of a source's glow, 0-1.
fn glow(level: f32, loudest: f32) -> f32 {
    if level <= 0.0 || loudest <= 0.0 {
        return 0.0;
    }
    (1.0 + 20.0 * (level / loudest).log10() / GLOW_DB).clamp(0.0, 1.0)
}

fn mix(from: Color32, to: Color32, part: f32) -> Color32 {
    from.lerp_to_gamma(to, part)
}

fn rings(painter: &egui::Painter, view: &View, radius_m: f32) {
    let mut inner = HEAD + 4.0;
    for ring in RINGS_M.into_iter().filter(|ring| *ring <= 1.001 * radius_m && *ring >= 0.04 * radius_m) {
        let radius = view.scale * ring;
        painter.circle_stroke(view.centre, radius, Stroke::new(1.0, theme::LINE));
        // A name within its ring would cover the next smaller one's, or the head.
        if radius - inner >= ROOM_FOR_NAME {
            let at = view.centre + Vec2::new(3.0, 1.0 - radius);
            painter.text(at, Align2::LEFT_TOP, format!("{ring} m"), theme::small(), theme::WEAK);
        }
        inner = radius;
    }
}

/// Loudspeakers, at the view's edge.
fn speakers(painter: &egui::Painter, view: &View, radius_m: f32, channels: usize) {
    let Ok(layout) = pyrophone_synthesis::vortex::SpeakerLayout::of_channels(channels.max(1)) else { return };
    for azimuth_deg in layout.azimuths_deg() {
        let towards = Vec2::angled((azimuth_deg as f32 - 90.0).to_radians());
        let at = view.centre + (view.scale * radius_m + 7.0) * towards;
        let side = towards.rot90();
        let corners = [at + 5.0 * side, at - 5.0 * side, at - 5.0 * towards];
        painter.add(Shape::convex_polygon(corners.to_vec(), theme::WEAK, Stroke::NONE));
    }
}

/// The listener, nose to the front.
fn head(painter: &egui::Painter, centre: Pos2) {
    let nose = [Vec2::new(-3.0, -HEAD), Vec2::new(3.0, -HEAD), Vec2::new(0.0, -HEAD - 4.0)].map(|by| centre + by);
    painter.add(Shape::convex_polygon(nose.to_vec(), theme::ASH, Stroke::NONE));
    painter.circle_filled(centre, HEAD, theme::ASH);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(right: f32, level: f32) -> SeenSource {
        SeenSource { position_m: [right, 1.0, 0.0], level }
    }

    #[test]
    fn a_view_is_shown_once_it_is_whole() {
        let mut space = Space::default();
        space.begin(2);
        space.take(source(1.0, 0.5));
        assert!(space.shown.is_empty());
        space.take(source(2.0, f32::NAN));
        assert_eq!(space.shown, [source(1.0, 0.5), SeenSource::default()]);
        space.begin(1);
        assert_eq!(space.shown.len(), 2, "the last one is shown meanwhile");
        space.take(source(3.0, 0.1));
        assert_eq!((space.shown.len(), space.loudest), (1, FALL * 0.5));
        space.begin(0);
        assert!(space.shown.is_empty(), "nothing sounds any more");
    }

    #[test]
    fn louder_sources_glow_more() {
        assert_eq!((glow(1.0, 1.0), glow(0.0, 1.0), glow(1.0, 0.0), glow(1e-3, 1.0)), (1.0, 0.0, 0.0, 0.0));
        assert!((glow(10f32.powf(-15.0 / 20.0), 1.0) - 0.5).abs() < 1e-3);
    }
}
