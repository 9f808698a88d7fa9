//! The Play page: the flame, its sound, and their character.
//!
//! | module | content |
//! |---|---|
//! | [`flame`] | the driving signal: track, sidechain or a built-in flame |
//! | [`output`] | the output's running spectrogram, and its match with the recording |
//! | [`recording`] | the recording, and the part used for learning |
//! | [`layers`] | faders, meters, solo and mute; monitoring |
//! | [`character`] | the eight macros, and a [`pad`] for two of them |
//! | [`variations`] | takes; recording of the output |

pub mod character;
pub mod flame;
pub mod layers;
pub mod output;
pub mod pad;
pub mod recording;
pub mod variations;

use egui::{Rect, Ui};

use super::levels::Levels;
use super::listen::ListenPanel;
use super::monitor::Monitor;
use super::param_editor::ParamEditor;
use super::plots::spectrum::Advice;
use super::recording::RecordingPanel;
use crate::loader::LoaderHandle;
use crate::loader::status::View;
use crate::meters::Meters;
use pad::Pad;

/// Between panels, in points.
const GAP: f32 = 8.0;
/// Shares of the page's width of the columns left and right, with their bounds in points.
const LEFT: (f32, f32, f32) = (0.208, 164.0, 290.0);
const RIGHT: (f32, f32, f32) = (0.236, 188.0, 300.0);
/// Shares of the height of the upper row, and of the spectrogram in it.
const UPPER: f32 = 0.55;
const SPECTROGRAM: f32 = 0.58;

/// State shown and changed by the page, besides the parameters.
pub struct Parts<'a> {
    /// Recent sound and telemetry.
    pub monitor: &'a mut Monitor,
    /// Meters, solo and mute.
    pub levels: &'a mut Levels,
    /// The recording's panel.
    pub recording: &'a mut RecordingPanel,
    /// Monitoring, and recording of the output.
    pub listen: &'a mut ListenPanel,
    /// The pad.
    pub pad: &'a mut Pad,
    /// The loader.
    pub loader: &'a LoaderHandle,
    /// Levels from the audio thread.
    pub meters: &'a Meters,
    /// State of the loader.
    pub view: &'a View,
    /// Match of the output.
    pub assessment: Advice,
}

/// The page.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let (upper, lower) = rect.split_top_bottom_at_fraction(UPPER);
    let (upper, lower) = (upper.with_max_y(upper.bottom() - 0.5 * GAP), lower.with_min_y(lower.top() + 0.5 * GAP));
    let left = rect.left() + column(LEFT, rect.width());
    let right = rect.right() - column(RIGHT, rect.width());
    let middle = upper.with_min_x(left + GAP).with_max_x(right - GAP);
    let (above, below) = middle.split_top_bottom_at_fraction(SPECTROGRAM);

    flame::show(ui, upper.with_max_x(left), parts, edit);
    output::show(ui, above.with_max_y(above.bottom() - 0.5 * GAP), parts, edit);
    recording::show(ui, below.with_min_y(below.top() + 0.5 * GAP), parts, edit);
    layers::show(ui, upper.with_min_x(right), parts, edit);
    character::show(ui, lower.with_max_x(right - GAP), parts, edit);
    variations::show(ui, lower.with_min_x(right), parts, edit);
}

fn column((share, least, most): (f32, f32, f32), width: f32) -> f32 {
    (share * width).clamp(least, most)
}
