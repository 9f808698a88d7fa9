//! The inner loop: one source's sound over one hop.
//!
//! Rows are summed step by step before interpolation, so that a source costs one pass of interpolation, whatever its
//! rows. Moving amplitudes are linear in the output's time, so the sum has two parts: that with the amplitudes at the
//! hop's start, and that with their change, which grows over the hop.
//!
//! Loops over steps or samples are compiled for the widest vectors of the machine. Reads at the samples' positions are
//! not: compilers would use gather instructions, which take longer than single reads.

use super::bank::LONGEST_READ;

/// Steps that a cubic needs around its interval.
const AROUND: usize = 3;

/// A series and its amplitude over a hop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<'a> {
    /// Coefficients from that before the hop's first step on.
    pub series: &'a [i16],
    /// Amplitude at the start, and its change until the end.
    pub from: f32,
    pub change: f32,
}

/// A channel's gain for a source over a hop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gain {
    pub channel: usize,
    /// Values at the hop's start and at its end.
    pub from: f32,
    pub to: f32,
}

/// Number of steps summed at once: reads are short, and the remainders at their ends would be summed one by one.
const LANES: usize = 16;

/// Length of the sums: any position up to the longest read has its cubic's steps.
const ROOM: usize = LONGEST_READ + AROUND;

/// Number of samples weighted at once; every hop is a multiple.
const SAMPLES: usize = 8;

/// Positions of some samples: the step before each, and the weights of that step and the next three.
#[derive(Debug, Clone, Copy, Default)]
struct Places {
    steps: [u32; SAMPLES],
    weights: [[f32; SAMPLES]; 4],
}

/// Memory for one hop of one source.
#[derive(Debug)]
pub(super) struct Reader {
    /// Weighted sums of the series: at the start, and the change.
    start: Box<[f32; ROOM]>,
    change: Box<[f32; ROOM]>,
    places: Vec<Places>,
    /// Progress of the hop by sample (0-1).
    parts: Vec<[f32; SAMPLES]>,
    /// The source's sound.
    sound: Vec<[f32; SAMPLES]>,
}

impl Reader {
    /// A reader for hops of `hop` samples, a multiple of 8.
    pub fn new(hop: usize) -> Self {
        let count = hop / SAMPLES;
        let part = |n: usize| n as f32 / hop as f32;
        Self {
            start: Box::new([0.0; ROOM]),
            change: Box::new([0.0; ROOM]),
            places: vec![Places::default(); count],
            parts: (0..count).map(|at| std::array::from_fn(|n| part(SAMPLES * at + n))).collect(),
            sound: vec![[0.0; SAMPLES]; count],
        }
    }

    /// Adds the sum of `parts` to `channels`, whose lengths are a hop. The first sample is `phase` (0-1) after a
    /// series' first step, and each further sample one `step` later.
    pub fn process(&mut self, parts: &[Part<'_>], phase: f32, step: f32, gains: &[Gain], channels: &mut [Vec<f32>]) {
        let moving = parts.iter().any(|part| part.change != 0.0);
        let arch = pulp::Arch::new();
        arch.dispatch(Prepare { reader: self, parts, phase, step, moving });
        for (at, places) in self.places.iter_mut().enumerate() {
            weigh(phase, step, (SAMPLES * at) as f32, places);
        }
        if moving {
            self.interpolate::<true>();
        } else {
            self.interpolate::<false>();
        }
        arch.dispatch(Mix { reader: self, gains, channels });
    }

    /// The sound from sums and weights.
    fn interpolate<const MOVING: bool>(&mut self) {
        let (start, change) = (&*self.start, &*self.change);
        for ((sound, places), parts) in self.sound.iter_mut().zip(&self.places).zip(&self.parts) {
            let [a, b, c, d] = &places.weights;
            for n in 0..SAMPLES {
                // A mask instead of a bounds check: no position lies beyond it.
                let at = places.steps[n] as usize & (LONGEST_READ - 1);
                let mut sum = (a[n] * start[at] + b[n] * start[at + 1]) + (c[n] * start[at + 2] + d[n] * start[at + 3]);
                if MOVING {
                    let (first, last) = (a[n] * change[at] + b[n] * change[at + 1], c[n] * change[at + 2]);
                    sum += parts[n] * (first + (last + d[n] * change[at + 3]));
                }
                sound[n] = sum;
            }
        }
    }
}

/// Work by steps. A separate type, because closures are not certain to be compiled for wide vectors.
struct Prepare<'a> {
    reader: &'a mut Reader,
    parts: &'a [Part<'a>],
    phase: f32,
    step: f32,
    moving: bool,
}

impl pulp::WithSimd for Prepare<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { reader, parts, phase, step, moving } = self;
        let samples = SAMPLES * reader.places.len();
        let count = (phase + step * samples as f32) as usize + 1 + AROUND;
        let count = count.next_multiple_of(LANES).min(LONGEST_READ);
        sum(parts, |part| part.from, &mut reader.start[..count]);
        if moving {
            sum(parts, |part| part.change, &mut reader.change[..count]);
        }
    }
}

/// Work by samples.
struct Mix<'a> {
    reader: &'a Reader,
    gains: &'a [Gain],
    channels: &'a mut [Vec<f32>],
}

impl pulp::WithSimd for Mix<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for Gain { channel, from, to } in self.gains {
            let change = to - from;
            let channel = self.channels[*channel].as_chunks_mut::<SAMPLES>().0;
            for ((sums, sound), parts) in channel.iter_mut().zip(&self.reader.sound).zip(&self.reader.parts) {
                for n in 0..SAMPLES {
                    sums[n] += (from + change * parts[n]) * sound[n];
                }
            }
        }
    }
}

/// Positions of the samples from `first` on, with their cubic B-spline weights.
///
/// Not inlined: compilers would combine samples of several groups and scatter them.
#[inline(never)]
fn weigh(phase: f32, step: f32, first: f32, places: &mut Places) {
    const SIXTH: f32 = 1.0 / 6.0;
    // From here on numbers are integers, and so are their last bits: a cast would have to check for values that do not
    // fit.
    const WHOLE: f32 = 12_582_912.0;
    let Places { steps, weights: [a, b, c, d] } = places;
    for n in 0..SAMPLES {
        let at = phase + step * (first + n as f32);
        // Half-way it may round to either side, where the two cubics are equal.
        let whole = at - 0.5 + WHOLE;
        let x = at - (whole - WHOLE);
        let (y, xx) = (1.0 - x, x * x);
        steps[n] = whole.to_bits() - WHOLE.to_bits();
        a[n] = SIXTH * y * y * y;
        d[n] = SIXTH * xx * x;
        b[n] = 2.0 / 3.0 - xx + 3.0 * d[n];
        c[n] = 1.0 - a[n] - b[n] - d[n];
    }
}

/// Sum of `parts`, weighted by `weight`.
#[inline(always)]
fn sum(parts: &[Part<'_>], weight: impl Fn(&Part<'_>) -> f32, sums: &mut [f32]) {
    sums.fill(0.0);
    for part in parts {
        let weight = weight(part);
        let coefficients = part.series.as_chunks::<LANES>().0;
        for (sums, coefficients) in sums.as_chunks_mut::<LANES>().0.iter_mut().zip(coefficients) {
            for n in 0..LANES {
                sums[n] += weight * f32::from(coefficients[n]);
            }
        }
    }
}
