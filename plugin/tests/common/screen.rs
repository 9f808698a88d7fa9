//! A window without a screen: its shapes, and pictures of them.

use std::collections::HashMap;
use std::path::Path;

use egui::accesskit::{Node, NodeId, TreeUpdate};
use egui::epaint::{ClippedShape, ImageData, Mesh, Primitive, TextureId, Vertex};
use egui::{Color32, ColorImage, Context, Event, Key, Modifiers, Order, Pos2, RawInput, Rect, Vec2, WidgetRect};
use nice_plug_core::context::gui::GuiContext;
use pyrophone::editor::Window;
use pyrophone::editor::controls::Page;

#[path = "deaf_host.rs"]
pub mod deaf_host;

const FRAMES_HZ: f64 = 60.0;

/// A control: something that can be clicked or dragged.
#[derive(Debug)]
pub struct Control {
    /// What assistive technology is told that it is, or its id.
    pub name: String,
    /// All of it, and the part that can be seen, in points.
    pub place: Rect,
    /// See `place`.
    pub seen: Rect,
}

/// The window, what it was drawn with, and what it drew last.
pub struct Screen {
    window: Window,
    context: Context,
    textures: HashMap<TextureId, ColorImage>,
    shapes: Vec<ClippedShape>,
    tree: Option<TreeUpdate>,
    events: Vec<Event>,
    size: Vec2,
    frame: usize,
}

impl Screen {
    /// An open window, whose host takes no notice of it.
    pub fn new(window: Window) -> Self {
        Self::with_host(window, deaf_host::context())
    }

    /// An open window, whose host does at once what it asks.
    #[allow(dead_code, reason = "not every test changes parameters")]
    pub fn obeyed(window: Window) -> Self {
        Self::with_host(window, deaf_host::obedient_context())
    }

    fn with_host(window: Window, host: GuiContext) -> Self {
        let (context, textures) = (Context::default(), HashMap::new());
        let (shapes, events) = (vec![], vec![]);
        let mut screen = Self { window, context, textures, shapes, tree: None, events, size: Vec2::ZERO, frame: 0 };
        screen.window.open(&screen.context, host);
        screen
    }

    /// Shows this page from now on, in this size in points, with `scale` pixels a point.
    pub fn turn_to(&mut self, page: Page, size: Vec2, scale: f32) {
        self.window.turn_to(page);
        self.context.set_pixels_per_point(scale);
        self.size = size;
    }

    /// Draws a frame.
    pub fn draw(&mut self) -> Vec<ClippedShape> {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size)),
            time: Some(self.frame as f64 / FRAMES_HZ),
            focused: true,
            events: std::mem::take(&mut self.events),
            ..RawInput::default()
        };
        self.frame += 1;
        let mut output = self.context.run_ui(input, |ui| self.window.show(ui));
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                let ImageData::Color(image) = &delta.image;
                match (delta.pos, self.textures.get_mut(id)) {
                    (Some(at), Some(texture)) => patch(texture, at, image),
                    _ => drop(self.textures.insert(*id, (**image).clone())),
                }
            }
        }
        output.textures_delta.clear();
        self.tree = output.platform_output.accesskit_update.take();
        self.shapes = output.shapes.clone();
        output.shapes
    }

    /// Presses and releases a key.
    #[allow(dead_code, reason = "not every test has a keyboard")]
    pub fn press(&mut self, key: Key) {
        for pressed in [true, false] {
            let (physical_key, repeat, modifiers) = (None, false, Modifiers::NONE);
            self.events.push(Event::Key { key, physical_key, pressed, repeat, modifiers });
            self.draw();
        }
    }

    /// The controls of a frame that is drawn now, in its lowest layer, where no list is open, that can be seen at least in
    /// part.
    #[allow(dead_code, reason = "not every test looks at them")]
    pub fn controls(&mut self) -> Vec<Control> {
        let nodes: HashMap<NodeId, Node> = self.tree().nodes.into_iter().collect();
        // The toolkit's scroll bars have no name, and float over what they scroll.
        let bar = self.context.global_style().spacing.scroll.bar_width;
        self.context.viewport(|viewport| {
            let lowest = viewport.prev_pass.widgets.layers().filter(|(layer, _)| layer.order == Order::Background);
            let all = lowest.flat_map(|(_, widgets)| widgets);
            let controls = all.filter(|widget| widget.sense.interactive() && widget.interact_rect.is_positive());
            let name = |widget: &WidgetRect| {
                let node = nodes.get(&widget.id.accesskit_id())?;
                Some(node.label().or_else(|| node.value())?.to_owned())
            };
            let is_bar = |rect: Rect| (rect.width() - bar).abs() < 0.5 && rect.height() > 2.0 * bar;
            let control = |widget: &WidgetRect| {
                let (place, seen, name) = (widget.rect, widget.interact_rect, name(widget));
                let is_none = name.is_none() && is_bar(place);
                let name = name.unwrap_or_else(|| format!("{:?}", widget.id));
                (!is_none).then_some(Control { name, place, seen })
            };
            controls.filter_map(control).collect()
        })
    }

    /// What assistive technology would be told of a frame that is drawn now.
    #[allow(dead_code, reason = "not every test looks at it")]
    pub fn tree(&mut self) -> TreeUpdate {
        self.context.enable_accesskit();
        self.draw();
        self.tree.take().expect("a tree")
    }

    /// Writes a picture of the last frame.
    pub fn save(&self, path: &Path) {
        let scale = self.context.pixels_per_point();
        let (width, height) = ((self.size.x * scale) as usize, (self.size.y * scale) as usize);
        let mut picture = ColorImage::filled([width, height], Color32::BLACK);
        for clipped in self.context.tessellate(self.shapes.clone(), scale) {
            if let Primitive::Mesh(mesh) = &clipped.primitive
                && let Some(texture) = self.textures.get(&mesh.texture_id)
            {
                let clip = Rect::from_min_max(scale * clipped.clip_rect.min, scale * clipped.clip_rect.max);
                fill(&mut picture, mesh, texture, clip, scale);
            }
        }
        let file = std::fs::File::create(path).expect("a file");
        let mut encoder = png::Encoder::new(file, width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        let pixels: Vec<u8> = picture.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
        encoder.write_header().expect("a head").write_image_data(&pixels).expect("pixels");
    }
}

fn patch(texture: &mut ColorImage, [x, y]: [usize; 2], image: &ColorImage) {
    let (width, height) = (image.size[0], image.size[1]);
    for row in 0..height {
        let to = (y + row) * texture.size[0] + x;
        texture.pixels[to..to + width].copy_from_slice(&image.pixels[row * width..(row + 1) * width]);
    }
}

/// Fills the triangles of a mesh.
fn fill(picture: &mut ColorImage, mesh: &Mesh, texture: &ColorImage, clip: Rect, scale: f32) {
    for corners in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|n| mesh.vertices[corners[n] as usize]);
        triangle(picture, corners, texture, clip, scale);
    }
}

fn triangle(picture: &mut ColorImage, corners: [Vertex; 3], texture: &ColorImage, clip: Rect, scale: f32) {
    let [a, b, c] = corners.map(|corner| scale * corner.pos);
    let cross = |from: Pos2, to: Pos2, at: Pos2| (to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x);
    let area = cross(a, b, c);
    if area == 0.0 {
        return;
    }
    let bounds = Rect::from_points(&[a, b, c]).intersect(clip);
    let [width, height] = picture.size;
    let columns = bounds.left().max(0.0).floor() as usize..(bounds.right().max(0.0).ceil() as usize).min(width);
    for y in bounds.top().max(0.0).floor() as usize..(bounds.bottom().max(0.0).ceil() as usize).min(height) {
        for x in columns.clone() {
            let at = Pos2::new(x as f32 + 0.5, y as f32 + 0.5);
            let weights = [cross(b, c, at) / area, cross(c, a, at) / area, cross(a, b, at) / area];
            if !clip.contains(at) || weights.iter().any(|weight| *weight < 0.0) {
                continue;
            }
            let mix = |value: &dyn Fn(&Vertex) -> f32| -> f32 {
                weights.iter().zip(&corners).map(|(weight, corner)| weight * value(corner)).sum()
            };
            let texel = sample(texture, mix(&|corner| corner.uv.x), mix(&|corner| corner.uv.y));
            let source = [0, 1, 2, 3].map(|n| mix(&|corner| f32::from(corner.color[n])) * f32::from(texel[n]) / 255.0);
            let pixel = &mut picture.pixels[y * width + x];
            let rest = 1.0 - source[3] / 255.0;
            let blend = |n: usize| (source[n] + rest * f32::from(pixel[n])).round().clamp(0.0, 255.0) as u8;
            *pixel = Color32::from_rgb(blend(0), blend(1), blend(2));
        }
    }
}

fn sample(texture: &ColorImage, u: f32, v: f32) -> Color32 {
    let [width, height] = texture.size;
    let at = |share: f32, size: usize| ((share * size as f32) as usize).min(size.saturating_sub(1));
    texture.pixels[at(v, height) * width + at(u, width)]
}
