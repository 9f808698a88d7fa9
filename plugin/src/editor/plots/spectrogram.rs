//! A spectrogram that runs: the newest at the right.

use std::sync::Arc;

use egui::{Color32, ColorImage, Pos2, Rect, TextureHandle, TextureOptions, Ui, Vec2};

use super::super::theme;
use pyrophone_analysis::bands::{BANDS, decibels};
use pyrophone_analysis::recording_overview::COLUMNS as PORTRAIT_COLUMNS;
use pyrophone_analysis::{FLOOR_DB, RecordingOverview};

/// Number of columns stored: eight seconds.
pub const COLUMNS: usize = 480;
/// Levels from dark to light, in dB per Hz below the recent maximum.
const RANGE_DB: f32 = 70.0;
/// Decay of the recent maximum, in dB per column.
const FORGET_DB: f32 = 0.01;

/// A running spectrogram.
pub struct Spectrogram {
    name: &'static str,
    columns: Vec<[f32; BANDS]>,
    /// Index of the next column, and number of columns not yet in the picture.
    next: usize,
    pending: usize,
    loudest_db: f32,
    picture: Option<TextureHandle>,
}

impl Spectrogram {
    /// An empty one.
    pub fn new(name: &'static str) -> Self {
        let columns = vec![[FLOOR_DB; BANDS]; COLUMNS];
        Self { name, columns, next: 0, pending: COLUMNS, loudest_db: FLOOR_DB, picture: None }
    }

    /// Forgets everything, the picture included.
    pub fn clear(&mut self) {
        *self = Self::new(self.name);
    }

    /// Adds the power densities of one step.
    pub fn push(&mut self, density: &[f32; BANDS]) {
        let column = &mut self.columns[self.next];
        *column = density.map(decibels);
        let loudest = column.iter().copied().fold(FLOOR_DB, f32::max);
        self.loudest_db = loudest.max(self.loudest_db - FORGET_DB);
        self.next = (self.next + 1) % COLUMNS;
        self.pending = (self.pending + 1).min(COLUMNS);
    }

    /// Draws it, with its name in a corner.
    pub fn show(&mut self, ui: &Ui, rect: Rect, color: Color32) {
        self.show_picture(ui, rect);
        label(ui, rect, self.name, color);
    }

    /// Draws the picture alone.
    pub fn show_picture(&mut self, ui: &Ui, rect: Rect) {
        // Nothing louder than this is silence, and stays dark.
        let top_db = self.loudest_db.max(FLOOR_DB + RANGE_DB);
        let picture = self.picture.get_or_insert_with(|| {
            let black = ColorImage::filled([COLUMNS, BANDS], theme::glow(0.0));
            ui.ctx().load_texture(self.name, black, TextureOptions::LINEAR)
        });
        // New columns are one piece, or two where they reach round the end.
        let first = (self.next + COLUMNS - self.pending) % COLUMNS;
        let before_end = self.pending.min(COLUMNS - first);
        for (from, count) in [(first, before_end), (0, self.pending - before_end)] {
            if count > 0 {
                let image = columns_image(&self.columns[from..from + count], top_db);
                picture.set_partial([from, 0], image, TextureOptions::LINEAR);
            }
        }
        self.pending = 0;
        let seam = self.next as f32 / COLUMNS as f32;
        let split = rect.left() + (1.0 - seam) * rect.width();
        let part = |left: f32, right: f32, from: f32, to: f32| {
            let place = Rect::from_min_max(Pos2::new(left, rect.top()), Pos2::new(right, rect.bottom()));
            let of = Rect::from_min_max(Pos2::new(from, 0.0), Pos2::new(to, 1.0));
            ui.painter().image(picture.id(), place, of, Color32::WHITE);
        };
        part(rect.left(), split, seam, 1.0);
        part(split, rect.right(), 0.0, seam);
    }
}

/// A whole recording's spectrogram.
#[derive(Default)]
pub struct Still {
    of: Option<Arc<RecordingOverview>>,
    picture: Option<TextureHandle>,
}

impl Still {
    /// Draws a recording's course.
    pub fn show(&mut self, ui: &Ui, rect: Rect, overview: &Arc<RecordingOverview>) {
        let is_same = self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, overview));
        if !is_same || self.picture.is_none() {
            let levels = overview.course_db.iter().flatten().copied();
            let top_db = levels.fold(FLOOR_DB, f32::max).max(-100.0) - 6.0;
            let mut image = ColorImage::filled([PORTRAIT_COLUMNS, BANDS], theme::glow(0.0));
            for (x, column) in overview.course_db.iter().enumerate() {
                for (band, level) in column.iter().enumerate() {
                    image.pixels[(BANDS - 1 - band) * PORTRAIT_COLUMNS + x] = theme::glow(shade(*level, top_db));
                }
            }
            self.picture = Some(ui.ctx().load_texture("recording", image, TextureOptions::LINEAR));
            self.of = Some(overview.clone());
        }
        if let Some(picture) = &self.picture {
            let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            ui.painter().image(picture.id(), rect, all, Color32::WHITE);
        }
        label(ui, rect, "recording", theme::ASH);
    }

    /// Drops the picture, whose window is gone.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

fn shade(level_db: f32, top_db: f32) -> f32 {
    1.0 + (level_db - top_db) / RANGE_DB
}

/// Columns side by side, the highest band on top.
fn columns_image(columns: &[[f32; BANDS]], top_db: f32) -> ColorImage {
    let pixels = (0..BANDS).rev().flat_map(|band| columns.iter().map(move |levels| levels[band]));
    let pixels = pixels.map(|level| theme::glow(shade(level, top_db))).collect();
    ColorImage::new([columns.len(), BANDS], pixels)
}

/// A plot's name in its upper left corner, readable over anything.
pub fn label(ui: &Ui, rect: Rect, text: &str, color: Color32) {
    let place = rect.left_top() + Vec2::new(6.0, 4.0);
    let galley = ui.painter().layout_no_wrap(text.to_owned(), theme::small(), color);
    let behind = Rect::from_min_size(place, galley.size()).expand(2.0);
    ui.painter().rect_filled(behind, 2.0, theme::text_background());
    ui.painter().galley(place, galley, color);
}
