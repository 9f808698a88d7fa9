//! Windows by the length of their features.

use std::ops::Range;

use bitcode::{Decode, Encode};
use rayon::prelude::*;

use super::tree::Tree;
use crate::bulk::bulk_fields;
use crate::texture::feature::Features;

/// Largest number of shells: they span 144 dB, as samples of 24 bits do. The last one takes everything quieter.
pub const SHELLS: usize = 12;
/// Length of a shell's loudest feature over its quietest: 12 dB.
const RATIO: f64 = 4.0;
/// Windows handled by one task.
const CHUNK: usize = 4096;

/// Windows whose features are about equally long, indexed.
#[derive(Debug, Encode, Decode)]
pub struct Shell {
    /// Length of the shortest feature, rounded down.
    pub least: f32,
    /// Length of the longest, rounded up.
    pub most: f32,
    /// Largest distance of a window from the mean of all shells.
    pub radius: f32,
    /// Numbers of a point.
    pub axes: usize,
    /// The windows.
    pub tree: Tree,
}

bulk_fields!(Shell: tree);

impl Shell {
    /// No window is nearer than this to a query of this length.
    #[inline(always)]
    pub fn bound(&self, length: f32) -> f32 {
        (self.least - length).max(length - self.most).max(0.0)
    }
}

/// Windows of one shell.
#[derive(Debug)]
pub struct Part {
    /// Their numbers, rising.
    pub windows: Vec<u32>,
    /// As in [`Shell`].
    pub least: f32,
    /// As in [`Shell`].
    pub most: f32,
}

/// Divides `windows` into shells, the loudest first. A recording may contain minutes of digital silence: of consecutive
/// equal windows, the first, which wins ties, represents all.
pub fn divide(features: &Features<'_>, windows: Range<usize>) -> Vec<Part> {
    let numbers: Vec<u32> = windows.clone().map(|window| window as u32).collect();
    let measure = |windows: &[u32]| -> Vec<f32> {
        let mut feature = vec![0.0; features.shape.feature_len()];
        let length = |window: &u32| {
            features.write(*window as usize, &mut feature);
            feature.iter().map(|x| x * x).sum::<f64>().sqrt() as f32
        };
        windows.iter().map(length).collect()
    };
    let lengths: Vec<f32> = numbers.par_chunks(CHUNK).flat_map_iter(measure).collect();
    let longest = f64::from(lengths.iter().fold(0.0f32, |most, length| most.max(*length)));
    let shell_of = |length: f32| {
        let below = longest / f64::from(length);
        if below < f64::INFINITY {
            ((maths::ln(below) / maths::ln(RATIO)) as usize).min(SHELLS - 1)
        } else {
            SHELLS - 1
        }
    };
    let nothing = || Part { windows: Vec::new(), least: f32::INFINITY, most: 0.0 };
    let mut parts: Vec<Part> = (0..SHELLS).map(|_| nothing()).collect();
    for (window, length) in numbers.iter().zip(&lengths) {
        if (*window as usize) > windows.start && features.equal(*window as usize - 1, *window as usize) {
            continue;
        }
        let part = &mut parts[shell_of(*length)];
        part.windows.push(*window);
        // Single precision may have rounded the length either way.
        part.least = part.least.min(length.next_down().max(0.0));
        part.most = part.most.max(length.next_up());
    }
    parts.retain(|part| !part.windows.is_empty());
    parts
}
