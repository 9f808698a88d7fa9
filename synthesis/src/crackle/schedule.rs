//! Times of the crackles, as a function of seed and position alone.
//!
//! The recording's time is divided into runs of equal length ([`Crackles`]). A stream plays them one after another, in
//! a different order in every pass, so that each is played once before any is repeated, and preserves the gaps within
//! them. Several streams, each with its own order, give a higher density than the recording's.

use super::event::Crackles;
use crate::dsp::White;

/// Number of streams: the largest multiple of a recording's density. The control goes up to 4, and the macro multiplies
/// it by up to 4.
pub(super) const STREAMS: usize = 16;
/// First of the white-noise streams that no other stage uses; three for each stream, one of them unused.
const FIRST: u32 = 0x4352_4100;
/// Random numbers for each event, not all in use; the last decides at which density it is audible.
const DRAWS: i64 = 8;
/// Events of one run that draw numbers of their own; any further ones share the last event's.
const DRAWING: i64 = 1 << 16;

/// A crackle that is due.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Due {
    /// Index among the recording's events.
    pub event: usize,
    /// Share, 0-1, of a stream's full density at which it becomes audible, plus the stream's number. Every crackle has a
    /// share of its own: gaps between crackles that remain stay as variable as the recording's, whereas runs that are
    /// missing as a whole would leave longer ones.
    pub threshold: f64,
    /// Its own random numbers, uniform in -1..1.
    pub draws: [f64; DRAWS as usize - 1],
}

#[derive(Debug, Clone, Copy)]
struct Stream {
    number: usize,
    orders: White,
    draws: White,
    /// Samples by which it is ahead of the timeline.
    shift: i64,
    /// The present run, counted from the timeline's start, its position in the recording, and its remaining events.
    run: i64,
    place: usize,
    next: usize,
    end: usize,
    /// Position of the next event, or of the run's end if there is none left.
    due: i64,
}

/// All streams.
#[derive(Debug, Clone)]
pub(super) struct Schedule {
    streams: [Stream; STREAMS],
}

impl Schedule {
    /// The schedule of `seed` for a recording, from `position` on.
    pub fn new(seed: u32, crackles: &Crackles, position: i64) -> Self {
        Self { streams: std::array::from_fn(|number| Stream::new(number, seed, crackles, position)) }
    }

    /// Samples from `position` until the next call of [`next_due`](Self::next_due) is needed.
    pub fn wait(&self, position: i64) -> i64 {
        self.streams.iter().map(|stream| stream.due.wrapping_sub(position)).min().unwrap_or(i64::MAX)
    }

    /// Advances the earliest stream; returns the crackle that is due now, unless it is the end of a run.
    pub fn next_due(&mut self, position: i64, crackles: &Crackles) -> Option<Due> {
        let stream = self.streams.iter_mut().min_by_key(|stream| stream.due.wrapping_sub(position))?;
        stream.next_in_pass(crackles)
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
        let mut stream = Self { number, orders, draws: noise(2), shift, run, place: 0, next: 0, end: 0, due: 0 };
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

    /// Start of the present run.
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

    fn next_in_pass(&mut self, crackles: &Crackles) -> Option<Due> {
        if self.next >= self.end {
            self.enter(self.run.wrapping_add(1), crackles);
            return None;
        }
        let within_run = (self.next - crackles.run(self.place).start) as i64;
        let counter = self.run.wrapping_mul(DRAWING).wrapping_add(within_run.min(DRAWING - 1)).wrapping_mul(DRAWS);
        let due = Due {
            event: self.next,
            threshold: self.number as f64 + 0.5 + 0.5 * self.draws.unit(counter.wrapping_add(DRAWS - 1)),
            draws: std::array::from_fn(|i| self.draws.unit(counter.wrapping_add(i as i64))),
        };
        self.next += 1;
        self.aim(crackles);
        Some(due)
    }
}

/// Position of `step` in the order of `count` given by `key`: every number below `count` is the result of exactly one
/// step.
///
/// A bijection of the numbers below the next power of two, repeated until the result is below `count` (the idea is from
/// Kensler 2013, "Correlated multi-jittered sampling"). It takes two rounds on average; at worst, a cycle through all
/// numbers above `count`.
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
