//! When which crackle is due: a function of seed and position alone.
//!
//! The recording's time is cut into runs of equal length ([`Crackles`]). A stream plays them one after the other, in
//! another order in every pass, so that each comes once before any comes again, and keeps the gaps within them. Several
//! streams, each in an order of its own, make what is denser than the recording.

use super::event::Crackles;
use crate::noise::White;

/// Streams side by side: the most that can come of a recording's density.
pub(super) const STREAMS: usize = 16;
/// Streams of white noise from here on are used by no other stage; three for each stream.
const FIRST: u32 = 0x4352_4100;
/// Most draws for one event.
const DRAWS: i64 = 8;
/// Most events that draw in one run.
const DRAWING: i64 = 1 << 16;

/// A crackle that is due.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Due {
    /// Its place in the recording's events.
    pub event: usize,
    /// The part, 0-1, of a stream's full density at which the run that it is of begins to be heard, plus the stream's number.
    pub threshold: f64,
    /// Draws of its own, in -1..1, evenly distributed.
    pub draws: [f64; DRAWS as usize],
}

#[derive(Debug, Clone, Copy)]
struct Stream {
    number: usize,
    orders: White,
    thresholds: White,
    draws: White,
    /// Samples by which it is ahead of the timeline.
    shift: i64,
    /// The run under way, counted from the timeline's start, the place in the recording that it is of, and its events to come.
    run: i64,
    place: usize,
    next: usize,
    end: usize,
    /// Position of the next event, or of the run's end where none is left.
    due: i64,
}

/// All streams.
#[derive(Debug, Clone)]
pub(super) struct Schedule {
    streams: [Stream; STREAMS],
}

impl Schedule {
    /// What `seed` makes of a recording, from `position` on.
    pub fn new(seed: u32, crackles: &Crackles, position: i64) -> Self {
        Self { streams: std::array::from_fn(|number| Stream::new(number, seed, crackles, position)) }
    }

    /// Samples from `position` until the next stream wants to be [asked](Self::take).
    pub fn wait(&self, position: i64) -> i64 {
        self.streams.iter().map(|stream| stream.due.wrapping_sub(position)).min().unwrap_or(i64::MAX)
    }

    /// Asks the stream that has waited longest: the crackle that is due now, if it is not the end of a run.
    pub fn take(&mut self, position: i64, crackles: &Crackles) -> Option<Due> {
        let stream = self.streams.iter_mut().min_by_key(|stream| stream.due.wrapping_sub(position))?;
        stream.take(crackles)
    }
}

impl Stream {
    fn new(number: usize, seed: u32, crackles: &Crackles, position: i64) -> Self {
        let noise = |kind: u32| White::new(seed, FIRST + 3 * number as u32 + kind);
        let (runs, run_samples) = crackles.runs();
        let orders = noise(0);
        let period = (runs * run_samples) as u64;
        let shift = (orders.bits(-1) % period) as i64;
        let run = position.wrapping_add(shift).div_euclid(run_samples as i64);
        let mut stream = Self {
            number,
            orders,
            thresholds: noise(1),
            draws: noise(2),
            shift,
            run,
            place: 0,
            next: 0,
            end: 0,
            due: 0,
        };
        stream.enter(run, crackles);
        let begin = stream.begin(run_samples);
        let passed = |at: &usize| {
            let into = crackles.events()[*at].onset - stream.place * run_samples;
            begin.wrapping_add(into as i64).wrapping_sub(position) < 0
        };
        stream.next += (stream.next..stream.end).take_while(passed).count();
        stream.aim(crackles);
        stream
    }

    /// Position at which the run under way begins.
    fn begin(&self, run_samples: usize) -> i64 {
        self.run.wrapping_mul(run_samples as i64).wrapping_sub(self.shift)
    }

    fn enter(&mut self, run: i64, crackles: &Crackles) {
        let (runs, _) = crackles.runs();
        self.run = run;
        let (pass, step) = (run.div_euclid(runs as i64), run.rem_euclid(runs as i64) as usize);
        self.place = shuffled(step, runs, self.orders.bits(pass));
        let events = crackles.run(self.place);
        (self.next, self.end) = (events.start, events.end);
        self.aim(crackles);
    }

    fn aim(&mut self, crackles: &Crackles) {
        let (_, run_samples) = crackles.runs();
        let into = match crackles.events()[..self.end].get(self.next) {
            Some(event) => event.onset - self.place * run_samples,
            None => run_samples,
        };
        self.due = self.begin(run_samples).wrapping_add(into as i64);
    }

    fn take(&mut self, crackles: &Crackles) -> Option<Due> {
        if self.next >= self.end {
            self.enter(self.run.wrapping_add(1), crackles);
            return None;
        }
        let within_run = (self.next - crackles.run(self.place).start) as i64;
        let counter = self.run.wrapping_mul(DRAWING).wrapping_add(within_run.min(DRAWING - 1)).wrapping_mul(DRAWS);
        let due = Due {
            event: self.next,
            threshold: self.number as f64 + 0.5 + 0.5 * self.thresholds.unit(self.run),
            draws: std::array::from_fn(|i| self.draws.unit(counter.wrapping_add(i as i64))),
        };
        self.next += 1;
        self.aim(crackles);
        Some(due)
    }
}

/// Where `step` of `count` stands in the order that `key` makes: every number below `count` is one step's.
///
/// A bijection of the numbers below the next power of two, asked again until it stays below `count` (Kensler 2013,
/// "Correlated multi-jittered sampling", has the idea). Twice on average; on a cycle through all numbers above `count` at worst.
fn shuffled(step: usize, count: usize, key: u64) -> usize {
    let bits = usize::BITS - count.saturating_sub(1).leading_zeros();
    let mask = 1usize.wrapping_shl(bits).wrapping_sub(1);
    let half = (bits / 2).max(1);
    let mut value = step;
    for _ in 0..=mask {
        for round in 0..4 {
            let part = (key >> (16 * round)) as usize;
            // Adding, multiplying by an odd number and folding the upper half in can each be undone.
            value = value.wrapping_add(part) & mask;
            value = value.wrapping_mul(part << 1 | 1) & mask;
            value ^= value >> half;
        }
        if value < count {
            return value;
        }
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_has_every_run_once_and_orders_differ() {
        for count in [1, 2, 3, 7, 8, 20, 44, 333, 1025] {
            let order = |pass: i64| -> Vec<usize> {
                let key = White::new(5, 6).bits(pass);
                (0..count).map(|step| shuffled(step, count, key)).collect()
            };
            let mut sorted = order(3);
            sorted.sort_unstable();
            assert_eq!(sorted, (0..count).collect::<Vec<_>>(), "{count} runs");
            if count > 7 {
                assert_ne!(order(3), order(4), "{count} runs");
                let stays =
                    (0..40).flat_map(|pass| order(pass).into_iter().enumerate()).filter(|(a, b)| a == b).count();
                assert!(stays < 40 * 4, "{count} runs: {stays} of 40 passes stay in place");
            }
        }
    }
}
