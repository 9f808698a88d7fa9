//! Cost of the window while sound plays: layout, drawing and tessellation, without the graphics card's part. Sixty
//! frames a second at 1000×700 points; one page of parameters each. `-- instructions` draws a few frames of the first
//! page, for callgrind. Times are the processor's, not the clock's: other programs may run beside it.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/deaf_host.rs"]
mod deaf_host;
#[path = "../tests/common/playing.rs"]
mod playing;

use std::time::Duration;

use egui::{Context, Pos2, RawInput, Rect, Vec2};
use playing::Playing;
use pyrophone::editor::Window;
use pyrophone::editor::controls::Page;

const FRAMES_HZ: f64 = 60.0;
const SIZE: Vec2 = Vec2::new(1000.0, 700.0);
/// Frames before those that count, and those.
const BEFORE: usize = 300;
const COUNTED: usize = 600;
const COUNTED_INSTRUCTIONS: usize = 60;

/// Processor time of this thread so far.
#[cfg(unix)]
fn thread_time() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: a writable location.
    let result = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    assert_eq!(result, 0, "every system has this clock");
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// There is nothing better than the clock.
#[cfg(not(unix))]
fn thread_time() -> Duration {
    static BEGAN: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    BEGAN.elapsed()
}

/// The window without a screen.
struct Screen {
    window: Window,
    context: Context,
    frame: usize,
}

impl Screen {
    fn new(window: Window) -> Self {
        let mut screen = Self { window, context: Context::default(), frame: 0 };
        screen.window.open(&screen.context, deaf_host::context());
        screen
    }

    /// Draws a frame; returns the time for its contents, the time for tessellation, and the number of triangles.
    #[inline(never)]
    fn counted_frame(&mut self) -> (Duration, Duration, usize) {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE)),
            time: Some(self.frame as f64 / FRAMES_HZ),
            focused: true,
            ..RawInput::default()
        };
        self.frame += 1;
        let began = thread_time();
        let mut output = self.context.run_ui(input, |ui| self.window.show(ui));
        output.textures_delta.clear();
        let drawn = thread_time();
        let shapes = self.context.tessellate(output.shapes, output.pixels_per_point);
        let done = thread_time();
        let vertices = shapes.iter().map(|shape| match &shape.primitive {
            egui::epaint::Primitive::Mesh(mesh) => mesh.vertices.len(),
            egui::epaint::Primitive::Callback(_) => 0,
        });
        (drawn - began, done - drawn, vertices.sum())
    }
}

/// Prints a line of the table: median milliseconds of a frame, and the share of a core that sixty frames a second need.
fn print(name: &str, mut times: Vec<Duration>) -> f64 {
    times.sort();
    let (middle, mean) = (times[times.len() / 2], times.iter().sum::<Duration>() / times.len() as u32);
    let percent = 100.0 * mean.as_secs_f64() * FRAMES_HZ;
    println!("| {name} | {:.3} | {:.3} | {percent:.1} % |", 1e3 * middle.as_secs_f64(), 1e3 * mean.as_secs_f64());
    percent
}

fn main() {
    let counts_instructions = std::env::args().any(|argument| argument == "instructions");
    let folder = tempfile::tempdir().expect("a folder");
    let mut playing = Playing::new(folder.path());
    let mut screen = Screen::new(playing.plugin.window());
    for _ in 0..if counts_instructions { 60 } else { BEFORE } {
        playing.play_a_block();
        screen.counted_frame();
    }
    if counts_instructions {
        for _ in 0..COUNTED_INSTRUCTIONS {
            playing.play_a_block();
            screen.counted_frame();
        }
        println!("{COUNTED_INSTRUCTIONS}");
        return;
    }
    println!("### The window, {}×{} points, {FRAMES_HZ} frames a second\n", SIZE.x, SIZE.y);
    println!("| page | median, ms | mean, ms | of a core |\n|---|---|---|---|");
    let (mut engine, mut vertices) = (Duration::ZERO, 0);
    for page in Page::ALL {
        screen.window.turn_to(page);
        let (mut contents, mut triangles) = (vec![], vec![]);
        for _ in 0..COUNTED {
            let began = thread_time();
            playing.play_a_block();
            engine += thread_time() - began;
            let (drawn, made, count) = screen.counted_frame();
            contents.push(drawn);
            triangles.push(made);
            vertices = count;
        }
        print(&format!("{page:?}: contents"), contents);
        print(&format!("{page:?}: triangles"), triangles);
    }
    println!(
        "\n{vertices} vertices. The engines beside it: {:.1} % of a core.",
        100.0 * engine.as_secs_f64() / (Page::ALL.len() * COUNTED) as f64 * FRAMES_HZ
    );
}
