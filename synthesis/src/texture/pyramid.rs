//! Gaussian pyramids (§5.1): of a whole padded signal, and of a stream.

use super::shape::{Padding, PyramidConfig};
use crate::Error;

/// The five-tap low-pass of Burt & Adelson (1983) with a = 0.4.
const TAPS: [f64; 5] = [0.05, 0.25, 0.40, 0.25, 0.05];

/// All levels of a padded signal.
#[derive(Debug, Clone)]
pub struct Pyramid {
    /// Samples of each level, finest first.
    pub levels: Vec<Vec<f64>>,
    /// Position of the signal in the levels.
    pub padding: Padding,
}

impl Pyramid {
    /// The pyramid of an input: zeros around it.
    pub fn of_input(signal: &[f64], shape: &PyramidConfig) -> Result<Self, Error> {
        let padding = Padding::new(signal.len(), shape.levels, "input")?;
        let mut padded = vec![0.0; padding.size[0]];
        padded[padding.start[0]..padding.end[0]].copy_from_slice(signal);
        Ok(Self::of_padded(padded, padding))
    }

    /// The pyramid of a recording: mirrored at both ends, the end sample not repeated.
    pub fn of_recording(signal: Vec<f64>, shape: &PyramidConfig) -> Result<Self, Error> {
        let padding = Padding::new(signal.len(), shape.levels, "recording")?;
        let padded = mirrored(signal, &padding);
        Ok(Self::of_padded(padded, padding))
    }

    fn of_padded(padded: Vec<f64>, padding: Padding) -> Self {
        let mut levels = vec![padded];
        for size in &padding.size[1..] {
            let finer = &levels[levels.len() - 1];
            levels.push((0..*size).map(|i| coarser_sample(finer, i)).collect());
        }
        Self { levels, padding }
    }

    /// Magnitudes of the top level within the signal.
    pub fn top_magnitudes(&self) -> Vec<f64> {
        let top = self.levels.len() - 1;
        let (start, end) = (self.padding.start[top], self.padding.end[top]);
        self.levels[top][start..end].iter().map(|x| x.abs()).collect()
    }
}

/// The recording in its padded array, mirrored at both ends.
pub fn mirrored(signal: Vec<f64>, padding: &Padding) -> Vec<f64> {
    let (start, end) = (padding.start[0], padding.end[0]);
    let mut padded = vec![0.0; padding.size[0]];
    padded[start..end].copy_from_slice(&signal);
    for (i, before) in padded[..start].iter_mut().enumerate() {
        *before = signal.get(start - i).copied().unwrap_or(0.0);
    }
    drop(signal);
    for i in end..padded.len() {
        padded[i] = (2 * end).checked_sub(i + 2).map_or(0.0, |mirror| padded[mirror]);
    }
    padded
}

fn coarser_sample(finer: &[f64], i: usize) -> f64 {
    let mut sum = 0.0;
    for (tap, weight) in TAPS.iter().enumerate() {
        if let Some(x) = (2 * i + tap).checked_sub(2).and_then(|at| finer.get(at)) {
            sum += weight * x;
        }
    }
    sum
}

/// The pyramid of a stream, sample by sample: gives the top level as it becomes known.
#[derive(Debug, Clone)]
pub struct PyramidStream {
    stages: Vec<Stage>,
}

/// One halving: the last four samples of its input, and their number.
#[derive(Debug, Clone)]
struct Stage {
    history: [f64; 4],
    /// Index of the next input sample.
    next: i64,
    /// First existing output index; earlier outputs are dropped.
    first: i64,
    /// One past the last existing output index; outputs beyond it read as zero.
    end: i64,
}

impl PyramidStream {
    /// A stream whose first sample has index 0.
    pub fn new(shape: &PyramidConfig) -> Self {
        let stage = Stage { history: [0.0; 4], next: 0, first: 0, end: i64::MAX };
        let mut stream = Self { stages: vec![stage; shape.top()] };
        stream.reset(0, None);
        stream
    }

    /// Restarts: the next sample has index `origin` (0 or more), with zeros before it. `sizes` bounds the array of each
    /// level, finest first, for a signal of known length.
    pub fn reset(&mut self, origin: i64, sizes: Option<&[usize]>) {
        let mut next = origin;
        for (i, stage) in self.stages.iter_mut().enumerate() {
            let level = i + 1;
            let first = (origin + (1 << level) - 1) >> level;
            let end = sizes.map_or(i64::MAX, |sizes| sizes[level] as i64);
            *stage = Stage { history: [0.0; 4], next, first, end };
            // The first output that this stage hands on is the first one that exists.
            next = first;
        }
    }

    /// Adds the next sample; returns the top level's new sample with its index, if there is one.
    pub fn push(&mut self, sample: f64) -> Option<(i64, f64)> {
        let mut value = sample;
        let mut index = 0;
        for stage in &mut self.stages {
            (index, value) = stage.push(value)?;
        }
        Some((index, value))
    }
}

impl Stage {
    fn push(&mut self, sample: f64) -> Option<(i64, f64)> {
        let [a, b, c, d] = self.history;
        let newest = self.next;
        self.history = [b, c, d, sample];
        self.next += 1;
        let output = (newest - 2) >> 1;
        if newest & 1 != 0 || output < self.first {
            return None;
        }
        if output >= self.end {
            return Some((output, 0.0));
        }
        let mut sum = 0.0;
        for (weight, x) in TAPS.iter().zip([a, b, c, d, sample]) {
            sum += weight * x;
        }
        Some((output, sum))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stream_equals_whole_signal() {
        let shape = PyramidConfig { levels: 5, ..PyramidConfig::default() };
        let signal: Vec<f64> = (0..3000).map(|i| ((i * i) as f64 * 0.37).sin()).collect();
        let whole = Pyramid::of_input(&signal, &shape).unwrap();
        let mut stream = PyramidStream::new(&shape);
        stream.reset(0, Some(&whole.padding.size));
        let mut top = Vec::new();
        let tail = std::iter::repeat_n(&0.0, 200);
        for sample in whole.levels[0].iter().chain(tail) {
            if let Some((index, value)) = stream.push(*sample) {
                assert_eq!(index, top.len() as i64);
                top.push(value);
            }
        }
        assert_eq!(top[..whole.levels[4].len()], whole.levels[4][..]);
        assert!(top[whole.levels[4].len()..].iter().all(|x| *x == 0.0));
    }

    #[test]
    fn a_start_anywhere_on_the_grid_is_the_same() {
        let shape = PyramidConfig { levels: 4, ..PyramidConfig::default() };
        let signal: Vec<f64> = (0..500).map(|i| (i as f64 * 0.21).sin()).collect();
        let run = |origin: i64| -> Vec<(i64, f64)> {
            let mut stream = PyramidStream::new(&shape);
            stream.reset(origin, None);
            signal.iter().filter_map(|x| stream.push(*x)).map(|(i, v)| (i - origin / 8, v)).collect()
        };
        assert_eq!(run(0), run(64));
    }
}
