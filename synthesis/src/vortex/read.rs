//! The inner loop: one source's sound over one hop.
//!
//! Rows are summed step by step before anything is interpolated, so that a source costs one pass of interpolation
//! whatever rows it sounds by. Amplitudes that move are linear in the output's time; so the sum is kept in two parts,
//! that with the amplitudes of the hop's start, and that with their change, which grows over the hop. The cubic of
//! every interval is worked out once, for the several output samples that fall into it.

use super::bank::LONGEST_READ;

/// Steps that a cubic needs around its interval.
const AROUND: usize = 3;

/// A series and its amplitude over a hop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<'a> {
    /// Coefficients from that before the hop's first step on.
    pub series: &'a [i16],
    /// Amplitude at the start, and how much it changes until the end.
    pub from: f32,
    pub change: f32,
}

/// A channel's gain for a source over a hop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gain {
    pub channel: usize,
    /// At the hop's start and at its end.
    pub from: f32,
    pub to: f32,
}

/// Memory for one hop of one source.
#[derive(Debug)]
pub(super) struct Reader {
    /// Weighted sums of the series: at the start, and the change.
    sums: [Vec<f32>; 2],
    /// Cubics by interval, of both sums: constant, linear, square and cubic coefficient.
    cubics: Box<[[f32; 8]; LONGEST_READ]>,
    /// The source's sound.
    sound: Vec<f32>,
}

impl Reader {
    /// For hops of `hop` samples.
    pub fn new(hop: usize) -> Self {
        let cubics = vec![[0.0; 8]; LONGEST_READ].into_boxed_slice();
        let sums = || vec![0.0; LONGEST_READ];
        // The slice has just that length.
        let cubics = cubics.try_into().unwrap_or_else(|_| Box::new([[0.0; 8]; LONGEST_READ]));
        Self { sums: [sums(), sums()], cubics, sound: vec![0.0; hop] }
    }

    /// Adds the sum of `parts` to `channels`, whose lengths are a hop. The first sample lies `phase` (0-1) after a
    /// series' first step, each other one `step` later.
    pub fn process(&mut self, parts: &[Part<'_>], phase: f32, step: f32, gains: &[Gain], channels: &mut [Vec<f32>]) {
        // For the widest vectors that this machine has.
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                let mut sound = std::mem::take(&mut self.sound);
                self.read(parts, phase, step, &mut sound);
                for Gain { channel, from, to } in gains {
                    mix(&mut channels[*channel], &sound, *from, *to);
                }
                self.sound = sound;
            },
        );
    }

    #[inline(always)]
    fn read(&mut self, parts: &[Part<'_>], phase: f32, step: f32, out: &mut [f32]) {
        let intervals = (phase + step * out.len() as f32) as usize + 1;
        let intervals = intervals.min(LONGEST_READ - AROUND);
        let moving = parts.iter().any(|part| part.change != 0.0);
        let count = intervals + AROUND;
        self.sum(parts, count, 0, |part| part.from);
        if moving {
            self.sum(parts, count, 1, |part| part.change);
            self.fit::<1>(intervals);
        }
        self.fit::<0>(intervals);
        let per_sample = 1.0 / out.len() as f32;
        for (n, out) in out.iter_mut().enumerate() {
            let at = phase + step * n as f32;
            let interval = at as i32;
            let x = at - interval as f32;
            let c = &self.cubics[interval as usize & (LONGEST_READ - 1)];
            let start = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
            *out = if moving {
                let change = c[4] + x * (c[5] + x * (c[6] + x * c[7]));
                start + n as f32 * per_sample * change
            } else {
                start
            };
        }
    }

    #[inline(always)]
    fn sum(&mut self, parts: &[Part<'_>], count: usize, which: usize, weight: impl Fn(&Part<'_>) -> f32) {
        let sums = &mut self.sums[which][..count];
        sums.fill(0.0);
        for part in parts {
            let weight = weight(part);
            for (sum, coefficient) in sums.iter_mut().zip(part.series) {
                *sum += weight * f32::from(*coefficient);
            }
        }
    }

    /// From a spline's coefficients to a polynomial per interval.
    #[inline(always)]
    fn fit<const WHICH: usize>(&mut self, intervals: usize) {
        const SIXTH: f32 = 1.0 / 6.0;
        let sums = &self.sums[WHICH][..intervals + AROUND];
        for (cubic, s) in self.cubics[..intervals].iter_mut().zip(sums.windows(4)) {
            let (ends, middle) = (s[0] + s[2], s[1]);
            let cubic = &mut cubic[4 * WHICH..][..4];
            cubic[0] = SIXTH * (ends + 4.0 * middle);
            cubic[1] = 0.5 * (s[2] - s[0]);
            cubic[2] = 0.5 * ends - middle;
            cubic[3] = SIXTH * (s[3] - s[0]) + 0.5 * (middle - s[2]);
        }
    }
}

/// Adds `sound` to `channel` with a gain that goes from `from` to `to`.
#[inline(always)]
fn mix(channel: &mut [f32], sound: &[f32], from: f32, to: f32) {
    if from == to {
        channel.iter_mut().zip(sound).for_each(|(sum, x)| *sum += from * x);
    } else {
        let step = (to - from) / channel.len() as f32;
        for (n, (sum, x)) in channel.iter_mut().zip(sound).enumerate() {
            *sum += (from + step * n as f32) * x;
        }
    }
}
