//! Every page at every size: no word is cut, and on the Play page none stands on another.

use std::path::PathBuf;

use crate::playing::Playing;
use crate::screen::Screen;
use egui::epaint::{ClippedShape, Shape, TextShape};
use egui::{Rect, Vec2};
use pyrophone::Pyrophone;
use pyrophone::editor::controls::Page;
use pyrophone_settings::table::DRIVE_MODES;
use pyrophone_settings::{Preset, index_of};

/// Sizes of the window, in points.
pub const SIZES: [(f32, f32); 6] =
    [(700.0, 450.0), (800.0, 500.0), (1000.0, 700.0), (1100.0, 790.0), (1600.0, 1000.0), (3840.0, 2160.0)];
/// Points by which glyphs may reach beyond their line.
const SLACK: f32 = 1.5;

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
    shapes.iter().for_each(|ClippedShape { clip_rect, shape, .. }| collect(shape, *clip_rect, &mut found));
    found
}

/// The words of a page, once it has settled.
fn words_of(screen: &mut Screen, page: Page, size: Vec2, scale: f32) -> Vec<Word> {
    screen.turn_to(page, size, scale);
    (0..3).for_each(|_| drop(screen.draw()));
    words(&screen.draw())
}

/// Pages that scroll may show a part of a line at their edges.
pub fn scrolls(page: Page) -> bool {
    page != Page::Play
}

#[test]
fn no_word_is_cut_and_none_stands_on_another() {
    let plugin = Pyrophone::default();
    let mut faults = vec![];
    for drive in ["pressure", "envelope", "input envelope", "flame"] {
        let slot = plugin.effect_params().slot(index_of("drive_mode").expect("known"));
        let choice = DRIVE_MODES.iter().position(|mode| *mode == drive).expect("known");
        slot.set_without_host(choice as f64);
        let mut screen = Screen::new(plugin.window());
        for (size, scale) in SIZES.into_iter().flat_map(|size| [(size, 1.0), (size, 2.0)]) {
            for page in Page::ALL {
                let words = words_of(&mut screen, page, Vec2::new(size.0, size.1), scale);
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

/// Pictures of all pages while they play, to be looked at: `cargo test --test it pages -- --ignored`.
#[test]
#[ignore = "writes pictures into the target folder, for people"]
fn pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = pictures_folder();
    for (case, preset) in [("track", "drums-to-fire"), ("built-in", "bonfire")] {
        let mut playing = Playing::new(folder.path());
        let values = Preset::find(preset).expect("a factory preset").values;
        for (index, plain) in values.as_slice().iter().enumerate() {
            playing.plugin.effect_params().slot(index).set_without_host(*plain);
        }
        playing.plugin.effect_params().takes.add();
        for (width, height, scale) in
            [(1000.0, 700.0, 1.0), (700.0, 450.0, 1.0), (1600.0, 1000.0, 1.0), (700.0, 450.0, 2.0)]
        {
            let mut screen = Screen::new(playing.plugin.window());
            for page in Page::ALL {
                screen.turn_to(page, Vec2::new(width, height), scale);
                for _ in 0..if page == Page::Play { 500 } else { 3 } {
                    playing.play_a_block();
                    screen.draw();
                }
                screen.save(&out.join(format!("{case}-{page:?}-{width}x{height}@{scale}.png")));
            }
        }
    }
    println!("{}", out.display());
}

/// Pictures of all pages before anything plays.
#[test]
#[ignore = "writes pictures into the target folder, for people"]
fn pictures_at_first() {
    let out = pictures_folder();
    let mut screen = Screen::new(Pyrophone::default().window());
    for (width, height, scale) in
        [(1000.0, 700.0, 1.0), (700.0, 450.0, 1.0), (1600.0, 1000.0, 1.0), (700.0, 450.0, 2.0)]
    {
        for page in Page::ALL {
            screen.turn_to(page, Vec2::new(width, height), scale);
            (0..4).for_each(|_| drop(screen.draw()));
            screen.save(&out.join(format!("empty-{page:?}-{width}x{height}@{scale}.png")));
        }
    }
    println!("{}", out.display());
}

fn pictures_folder() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("pages");
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}
