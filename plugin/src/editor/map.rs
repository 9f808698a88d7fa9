//! Map of the items in the window: a text file for tests, which have no other way to find them.
//!
//! It is written only where the environment variable `PYROPHONE_EDITOR_MAP` names a file, and then with every frame.
//! Its first lines are `frame`, the number of frames since the window opened; `size`, the window's width and height;
//! and `ui_us`, microseconds of processor time for layout and drawing in all these frames, without tessellation and the
//! graphics card's part. They are followed by a line for each visible item: left, top, right, bottom and name. All are
//! in physical pixels. With `PYROPHONE_EDITOR_ITEMS=0` the items are left out, so that measurements do not include the cost
//! of listing them. `analysis_us` is the part of `ui_us` that grows with the sound and not with the frames.

use std::fmt::{Display, Write};
use std::path::PathBuf;
use std::sync::LazyLock;
use std::time::Duration;

use egui::{Context, Id, Rect, Ui};

const VARIABLE: &str = "PYROPHONE_EDITOR_MAP";
const ITEMS_VARIABLE: &str = "PYROPHONE_EDITOR_ITEMS";

static FILE: LazyLock<Option<PathBuf>> = LazyLock::new(|| std::env::var_os(VARIABLE).map(PathBuf::from));

static LISTS_ITEMS: LazyLock<bool> =
    LazyLock::new(|| FILE.is_some() && std::env::var_os(ITEMS_VARIABLE).is_none_or(|value| value != "0"));

/// Notes of a window so far.
#[derive(Debug, Clone, Default)]
struct Notes {
    frames: u64,
    spent: Duration,
    analysing: Duration,
    /// Items of the current frame.
    things: String,
}

/// Begins a frame; none if no map is wanted.
pub fn begin(context: &Context) -> Option<Duration> {
    FILE.as_ref()?;
    with_notes(context, |notes| notes.things.clear());
    Some(thread_time())
}

/// Notes the time since `began` as analysis of the sound.
pub fn analysed(context: &Context, began: Option<Duration>) {
    let Some(began) = began else { return };
    let spent = thread_time().saturating_sub(began);
    with_notes(context, |notes| notes.analysing += spent);
}

/// Processor time of this thread: on a busy machine, wall time would include other threads' work.
#[cfg(unix)]
fn thread_time() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: a writable location.
    let result = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    if result == 0 { Duration::new(time.tv_sec as u64, time.tv_nsec as u32) } else { Duration::ZERO }
}

/// There is nothing better than the clock.
#[cfg(not(unix))]
fn thread_time() -> Duration {
    static BEGAN: LazyLock<std::time::Instant> = LazyLock::new(std::time::Instant::now);
    BEGAN.elapsed()
}

/// Notes the visible part of an item.
pub fn note(ui: &Ui, name: impl Display, place: Rect) {
    if !*LISTS_ITEMS {
        return;
    }
    let seen = place.intersect(ui.clip_rect());
    if seen.is_positive() {
        let scale = ui.ctx().pixels_per_point();
        let [left, top, right, bottom] =
            [seen.left(), seen.top(), seen.right(), seen.bottom()].map(|at| (at * scale).round());
        // Writing to a string does not fail.
        with_notes(ui.ctx(), |notes| writeln!(notes.things, "{left} {top} {right} {bottom} {name}")).ok();
    }
}

/// Ends a frame; `began` is the value returned at its start.
pub fn end(context: &Context, began: Option<Duration>) {
    let (Some(began), Some(file)) = (began, FILE.as_ref()) else { return };
    let spent = thread_time().saturating_sub(began);
    let size = context.content_rect().size() * context.pixels_per_point();
    let text = with_notes(context, |notes| {
        notes.frames += 1;
        notes.spent += spent;
        let (frames, us, things) = (notes.frames, notes.spent.as_micros(), &notes.things);
        let (width, height, analysis_us) = (size.x.round(), size.y.round(), notes.analysing.as_micros());
        format!("frame {frames}\nsize {width} {height}\nui_us {us}\nanalysis_us {analysis_us}\n{things}")
    });
    // Renamed when complete, so that a reader never sees half a frame.
    let unfinished = file.with_extension("unfinished");
    if let Err(error) = std::fs::write(&unfinished, text).and_then(|()| std::fs::rename(&unfinished, file)) {
        nice_plug::prelude::nice_warn!("Pyrophone cannot write {}: {error}", file.display());
    }
}

fn with_notes<T>(context: &Context, work: impl FnOnce(&mut Notes) -> T) -> T {
    context.data_mut(|data| work(data.get_temp_mut_or_default(Id::NULL)))
}
