//! The sample at which each window of each level is matched.
//!
//! Window w of level l is matched at sample w W 2^l + offset(l): as soon as everything that it reads is known,
//! regardless of later samples. The work is therefore a function of the sample counter alone and evenly distributed
//! (level 0 every W samples, level 1 every 2 W ...), and the latency is that of the data.

use super::shape::PyramidConfig;

/// Offset and period of each level's windows, in samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schedule {
    /// Samples from a window's centre to the moment it is matched, per level below the top.
    pub offset: Vec<i64>,
    /// Samples between windows, per level below the top.
    pub period: Vec<i64>,
}

impl Schedule {
    /// The schedule of `shape`. Spare latency is used to match the windows of different levels at different samples.
    pub fn new(shape: &PyramidConfig) -> Self {
        let top = shape.top();
        let w = shape.window as i64;
        let period: Vec<i64> = (0..top).map(|level| w << level).collect();
        let mut offset = vec![0; top];
        let mut spare = shape.latency_samples() as i64 - (w - 1) - earliest(shape);
        for level in (0..top).rev() {
            let due = offset_after(shape, level, &offset);
            let delay = free_slot(due, &offset[level + 1..], &period, level, w, spare);
            offset[level] = due + delay;
            spare -= delay;
        }
        Self { offset, period }
    }
}

/// Offset of level 0 when every level is matched as early as can be.
fn earliest(shape: &PyramidConfig) -> i64 {
    let mut offset = vec![0; shape.top()];
    for level in (0..shape.top()).rev() {
        offset[level] = offset_after(shape, level, &offset);
    }
    offset[0]
}

/// The least offset of `level`, given those of the coarser levels.
fn offset_after(shape: &PyramidConfig, level: usize, offset: &[i64]) -> i64 {
    let (w, reach, top) = (shape.window as i64, shape.reach() as i64, shape.top());
    // Two consecutive windows cover every position of their centres between coarse samples.
    let of_window = |window: i64| {
        let centre = window * w;
        let coarse = (centre + 1) / 2 + reach;
        let known_at = if level + 1 == top {
            (coarse << top) + 2 * ((1 << top) - 1)
        } else {
            let last = (coarse + w - 1) / w;
            ((last * w) << (level + 1)) + offset[level + 1]
        };
        known_at - (centre << level)
    };
    of_window(0).max(of_window(1))
}

/// The smallest delay, up to `spare`, at which windows of `level` never coincide with those of a coarser one. The coarse
/// levels share one sample in every W among them and leave the others to level 0.
fn free_slot(due: i64, coarser: &[i64], period: &[i64], level: usize, w: i64, spare: i64) -> i64 {
    let Some(slot) = coarser.last().map(|offset| offset.rem_euclid(w)) else { return 0 };
    let meets = |delay: i64| coarser.iter().any(|offset| (due + delay - offset).rem_euclid(period[level]) == 0);
    let tidy = |delay: i64| ((due + delay).rem_euclid(w) == slot) == (level > 0);
    let all = 0..=spare.max(0);
    all.clone()
        .find(|delay| !meets(*delay) && tidy(*delay))
        .or_else(|| all.clone().find(|delay| !meets(*delay)))
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> impl Iterator<Item = PyramidConfig> {
        let sizes = (2..=10).flat_map(|levels| (2..=16).map(move |window| (levels, window)));
        sizes.flat_map(|(levels, window)| {
            (1..=6).map(move |feature| PyramidConfig { levels, window, feature, falloff: 0.0 })
        })
    }

    #[test]
    fn every_level_fits_into_the_latency() {
        for shape in shapes() {
            let schedule = Schedule::new(&shape);
            let last = schedule.offset[0] + shape.window as i64 - 1;
            assert!(last <= shape.latency_samples() as i64, "{shape:?}: {last}");
        }
    }

    #[test]
    fn windows_are_matched_after_all_that_they_read() {
        for shape in shapes() {
            let Schedule { offset, .. } = Schedule::new(&shape);
            let (w, reach, top) = (shape.window as i64, shape.reach() as i64, shape.top());
            for level in 0..top {
                for window in 0..8 {
                    let now = ((window * w) << level) + offset[level];
                    let needed = (window * w + 1) / 2 + reach;
                    let ready = if level + 1 == top {
                        // The top level's sample j reads the input up to 2^top j + 2 (2^top - 1).
                        (needed << top) + 2 * ((1 << top) - 1) <= now
                    } else {
                        // Every window that adds to the sample has been matched.
                        let mut windows = (0..).take_while(|v| v * w - w < needed);
                        windows.all(|v| ((v * w) << (level + 1)) + offset[level + 1] <= now)
                    };
                    assert!(ready, "{shape:?} level {level} window {window}");
                }
            }
        }
    }

    #[test]
    fn the_papers_levels_never_meet() {
        let shape = PyramidConfig::default();
        let Schedule { offset, period } = Schedule::new(&shape);
        let busiest =
            (0..1024i64).map(|t| (0..shape.top()).filter(|l| (t - offset[*l]).rem_euclid(period[*l]) == 0).count());
        assert_eq!(busiest.max(), Some(1));
    }
}
