//! Costs of the search of texture synthesis, as Markdown tables. Nothing is asserted, because machines differ and are
//! noisy.
//!
//! Pairs come from the reference folder (`PYROPHONE_REFERENCE`, else `../shared/reference` from the project's root);
//! without it, two generated pairs are used. `-- companded` prints only the table of the companded mode.

mod blocks;
#[path = "../../tests/common/brute.rs"]
mod brute;
mod growth;
mod pairs;
#[path = "../../tests/common/queries.rs"]
mod queries;
mod rivals;
#[path = "../../tests/common/signals.rs"]
mod signals;

use std::time::{Duration, Instant};

/// Sample rate in Hz of all pairs.
const RATE_HZ: f64 = 44_100.0;

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed())
}

/// The shortest of three runs: other load on the machine can only add time.
fn shortest(mut work: impl FnMut() -> f64) -> f64 {
    (0..3).map(|_| work()).fold(f64::INFINITY, f64::min)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|x| x != "--bench").collect();
    let pairs = pairs::all();
    if arguments == ["companded"] {
        blocks::companded_table(&pairs);
        return;
    }
    pairs::dictionary_table(&pairs);
    rivals::table(&pairs);
    blocks::table(&pairs);
    blocks::companded_table(&pairs);
    blocks::channels_table(&pairs);
    growth::table(&pairs);
}
