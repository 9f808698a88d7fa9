//! Costs of the engines, in the rows of `docs/performance.md`: CPU seconds per second of sound, and the largest block
//! as a share of its deadline. Nothing is asserted, because machines differ and are noisy. `-- ROW...` prints only rows
//! whose names contain one of these words; `-- instructions ENGINE` runs one fixed second of an engine, for callgrind.

mod blocks;
mod instructions;
mod start;
mod texture;

#[path = "../search/pairs.rs"]
#[allow(dead_code)]
mod pairs;
#[path = "../../tests/common/signals.rs"]
mod signals;

use std::time::{Duration, Instant};

/// Sample rate in Hz of all pairs.
const RATE_HZ: f64 = 44_100.0;

/// A measurement that returns its results as text.
type Figures = Box<dyn Fn(&[pairs::Pair]) -> String>;

/// A row: its name, its goal, and its measurement.
struct Row {
    name: &'static str,
    goal: &'static str,
    figures: Figures,
}

fn row(name: &'static str, goal: &'static str, figures: impl Fn(&[pairs::Pair]) -> String + 'static) -> Row {
    Row { name, goal, figures: Box::new(figures) }
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|x| !x.starts_with("--")).collect();
    if let [command, engine] = wanted.as_slice()
        && command == "instructions"
    {
        instructions::run(engine);
        return;
    }
    let pairs = pairs::all();
    println!("| row | goal | found |\n|---|---|---|");
    for Row { name, goal, figures } in texture::rows().into_iter().chain(blocks::rows()).chain(start::rows()) {
        if wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str())) {
            println!("| {name} | {goal} | {} |", figures(&pairs));
        }
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed())
}

/// The shortest of three runs: other load on the machine can only add time.
fn shortest(mut work: impl FnMut() -> f64) -> f64 {
    (0..3).map(|_| work()).fold(f64::INFINITY, f64::min)
}

/// CPU seconds of all threads since the start, if the system reports them; otherwise elapsed time.
fn cpu_s() -> f64 {
    let read = || -> Option<f64> {
        let text = std::fs::read_to_string("/proc/self/stat").ok()?;
        // The program's name, in brackets, may contain anything.
        let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
        let ticks: f64 = fields.next()?.parse::<f64>().ok()? + fields.next()?.parse::<f64>().ok()?;
        Some(ticks / 100.0)
    };
    static BEGIN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    read().unwrap_or_else(|| BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64())
}
