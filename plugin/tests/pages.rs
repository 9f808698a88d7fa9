//! Every page at every size: no word is cut, and on the Play page none stands on another.

use std::sync::Arc;

use egui::epaint::{ClippedShape, Shape, TextShape};
use egui::{Context, Pos2, RawInput, Rect, Vec2};
use nice_plug::prelude::*;
use nice_plug_core::context::gui::{GuiContext, GuiContextInner};
use pyrophone::Pyrophone;
use pyrophone::editor::Window;
use pyrophone::editor::controls::Page;
use pyrophone_settings::index_of;

const SIZES: [(f32, f32); 6] =
    [(700.0, 450.0), (800.0, 500.0), (1000.0, 700.0), (1100.0, 790.0), (1600.0, 1000.0), (3840.0, 2160.0)];
/// Points by which glyphs may reach beyond their line.
const SLACK: f32 = 1.5;

/// A host that takes no notice.
struct Host;

impl GuiContextInner for Host {
    fn plugin_api(&self) -> PluginApi {
        PluginApi::Clap
    }
    unsafe fn raw_begin_set_parameter(&self, _: ParamPtr) {}
    unsafe fn raw_set_parameter_normalized(&self, _: ParamPtr, _: f32) {}
    unsafe fn raw_end_set_parameter(&self, _: ParamPtr) {}
    fn get_state(&self) -> PluginState {
        PluginState { version: String::new(), params: Default::default(), fields: Default::default() }
    }
    fn set_state(&self, _: PluginState) {}
    fn request_restart(&self) {}
}

/// A word on the screen, and what is left of it to be seen.
struct Word {
    text: String,
    place: Rect,
    clip: Rect,
    is_elided: bool,
}

fn words(shapes: &[ClippedShape]) -> Vec<Word> {
    fn collect(shape: &Shape, clip: Rect, words: &mut Vec<Word>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, words)),
            Shape::Text(text) if !text.galley.text().trim().is_empty() => words.push(word(text, clip)),
            _ => {}
        }
    }
    fn word(text: &TextShape, clip: Rect) -> Word {
        let (place, is_elided) = (text.visual_bounding_rect(), text.galley.elided);
        Word { text: text.galley.text().to_owned(), place, clip, is_elided }
    }
    let mut found = vec![];
    shapes.iter().for_each(|ClippedShape { clip_rect, shape }| collect(shape, *clip_rect, &mut found));
    found
}

struct Screen {
    window: Window,
    context: Context,
}

impl Screen {
    fn new(plugin: &Pyrophone) -> Self {
        let mut screen = Self { window: plugin.window(), context: Context::default() };
        screen.window.open(&screen.context, GuiContext::new(Arc::new(Host)));
        screen
    }

    /// The words of a page, once it has settled.
    fn words(&mut self, page: Page, size: Vec2, scale: f32) -> Vec<Word> {
        self.window.turn_to(page);
        self.context.set_pixels_per_point(scale);
        let mut found = vec![];
        for frame in 0..4 {
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, size)),
                time: Some(f64::from(frame) / 60.0),
                focused: true,
                ..RawInput::default()
            };
            let output = self.context.run_ui(input, |ui| self.window.show(ui));
            found = words(&output.shapes);
        }
        found
    }
}

/// Pages that scroll may show a part of a line at their edges.
fn scrolls(page: Page) -> bool {
    page != Page::Play
}

#[test]
fn no_word_is_cut_and_none_stands_on_another() {
    let plugin = Pyrophone::default();
    let mut faults = vec![];
    for drive in ["pressure", "envelope", "input envelope", "flame"] {
        let slot = plugin.effect_params().slot(index_of("drive_mode").expect("known"));
        let choice = pyrophone_settings::table::DRIVE_MODES.iter().position(|mode| *mode == drive).expect("known");
        slot.set_without_host(choice as f64);
        let mut screen = Screen::new(&plugin);
        for (size, scale) in SIZES.into_iter().flat_map(|size| [(size, 1.0), (size, 2.0)]) {
            for page in Page::ALL {
                let words = screen.words(page, Vec2::new(size.0, size.1), scale);
                assert!(words.len() > 20, "{page:?} is not drawn");
                let case = format!("{page:?}, {drive}, {size:?} ×{scale}");
                faults.extend(cut(page, &words).map(|what| format!("{case}: {what}")));
                if page == Page::Play {
                    faults.extend(overlaps(&words).map(|what| format!("{case}: {what}")));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

fn cut(page: Page, words: &[Word]) -> impl Iterator<Item = String> {
    let is_cut = move |word: &Word| {
        let seen = word.clip.expand(SLACK);
        let is_across = word.place.left() < seen.left() || word.place.right() > seen.right();
        let is_along = word.place.top() < seen.top() || word.place.bottom() > seen.bottom();
        is_across || !scrolls(page) && (is_along || word.is_elided)
    };
    words.iter().filter(move |word| is_cut(word)).map(|word| {
        format!(
            "\"{}\" at {:?} is cut by {:?}{}",
            word.text,
            word.place,
            word.clip,
            if word.is_elided { ", …" } else { "" }
        )
    })
}

fn overlaps(words: &[Word]) -> impl Iterator<Item = String> {
    let pairs = words.iter().enumerate().flat_map(move |(n, a)| words[n + 1..].iter().map(move |b| (a, b)));
    let on_another = |(a, b): &(&Word, &Word)| a.place.shrink(SLACK).intersects(b.place.shrink(SLACK));
    pairs.filter(on_another).map(|(a, b)| format!("\"{}\" at {:?} on \"{}\" at {:?}", a.text, a.place, b.text, b.place))
}
