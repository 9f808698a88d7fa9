//! Extents of the output pyramid's levels, for display.

/// Extent of one level in a frame of a sixtieth of a second. Each level runs at its own pace: coarse levels are ahead
/// of fine ones, by at most the latency.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extent {
    /// Pyramid level, 0 the finest.
    pub level: u8,
    /// Least sample, 0 at most.
    pub low: f32,
    /// Largest sample, 0 at least.
    pub high: f32,
}

/// Frames per second.
const FRAMES_HZ: f64 = 60.0;
/// Largest number of stored extents; later ones are lost.
const CAPACITY: usize = 512;

/// The present frame of each level, and the finished ones.
#[derive(Debug)]
pub(super) struct Extents {
    frame_samples: i64,
    levels: Vec<ExtentFrame>,
    done: Vec<Extent>,
}

#[derive(Debug, Clone, Copy, Default)]
struct ExtentFrame {
    low: f64,
    high: f64,
    /// The finest level's first sample after it.
    end: i64,
}

impl Extents {
    /// Extents of `levels` levels, the finest at `sample_rate_hz`.
    pub fn new(levels: usize, sample_rate_hz: f64) -> Self {
        Self {
            frame_samples: ((sample_rate_hz / FRAMES_HZ).round() as i64).max(1),
            levels: vec![ExtentFrame::default(); levels],
            done: Vec::with_capacity(CAPACITY),
        }
    }

    /// Restarts with sample `origin` of the finest level.
    pub fn reset(&mut self, origin: i64) {
        self.levels.fill(ExtentFrame { end: origin + self.frame_samples, ..ExtentFrame::default() });
        self.done.clear();
    }

    /// Adds the sample at `index` of `level`; real-time safe.
    #[inline]
    pub fn add_sample(&mut self, level: usize, index: i64, sample: f64) {
        let frame = &mut self.levels[level];
        while index << level >= frame.end {
            if self.done.len() < CAPACITY {
                self.done.push(Extent { level: level as u8, low: frame.low as f32, high: frame.high as f32 });
            }
            (frame.low, frame.high) = (0.0, 0.0);
            frame.end += self.frame_samples;
        }
        frame.low = frame.low.min(sample);
        frame.high = frame.high.max(sample);
    }

    /// Adds samples of `level` from `first` on; real-time safe.
    pub fn add_samples(&mut self, level: usize, first: i64, samples: &[f64]) {
        let frame = &mut self.levels[level];
        if (first + samples.len() as i64) << level > frame.end {
            (first..).zip(samples).for_each(|(index, sample)| self.add_sample(level, index, *sample));
            return;
        }
        for sample in samples {
            frame.low = frame.low.min(*sample);
            frame.high = frame.high.max(*sample);
        }
    }

    /// Returns the extents finished since the last call.
    pub fn drain(&mut self) -> std::vec::Drain<'_, Extent> {
        self.done.drain(..)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_taken_together_count_as_those_taken_one_by_one() {
        let (mut together, mut single) = (Extents::new(2, 600.0), Extents::new(2, 600.0));
        [&mut together, &mut single].into_iter().for_each(|extents| extents.reset(4));
        let samples: Vec<f64> = (0..400).map(|n| f64::from(n * n % 71) - 35.0).collect();
        for (number, part) in samples.chunks(4).enumerate() {
            for level in 0..2 {
                let first = (4 >> level) + 4 * number as i64;
                together.add_samples(level, first, part);
                (first..).zip(part).for_each(|(index, sample)| single.add_sample(level, index, *sample));
            }
        }
        let done: Vec<Extent> = together.drain().collect();
        assert!(done.len() > 50 && done == single.drain().collect::<Vec<_>>());
    }

    #[test]
    fn frames_of_all_levels_keep_pace() {
        let mut extents = Extents::new(3, 48_000.0);
        extents.reset(16);
        for n in 16..48_016 {
            let sample = if n == 4_100 { -2.0 } else { 0.5 };
            (0..3)
                .filter(|level| n % (1 << level) == 0)
                .for_each(|level| extents.add_sample(level, n >> level, sample));
            // A level without a reader must not hold up the others.
            if n % 1_000 == 0 && n > 40_000 {
                assert!(extents.done.len() <= CAPACITY);
            }
        }
        let done: Vec<Extent> = extents.drain().collect();
        for level in 0..3 {
            let found: Vec<&Extent> = done.iter().filter(|extent| extent.level == level).collect();
            assert_eq!(found.len(), 59, "level {level}");
            let deep: Vec<usize> = (0..59).filter(|frame| found[*frame].low < 0.0).collect();
            assert_eq!(deep, [5], "level {level}: the dip lies in the sixth frame");
            assert!(found.iter().all(|extent| extent.high == 0.5));
        }
    }
}
