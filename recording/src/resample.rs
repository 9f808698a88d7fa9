//! Conversion to another sample rate, by windowed sinc.

use std::f64::consts::PI;

use maths::fft::{Complex64, RealTransform};

use crate::{Error, MAX_SAMPLES, Progress, Recording, format};

/// Least taps of the sinc, counted at the lower of the two rates. With the squared Blackman-Harris
/// window it passes up to 0.97 of the lower Nyquist frequency.
const LEAST_SINC_TAPS: usize = 1024;

/// The recording at `rate_hz`: round(samples * ratio) samples long, without delay. At its own rate it is returned
/// unchanged, bit for bit. Name and hash are unchanged, since they identify the file.
///
/// # Errors
/// If the rate is outside the limits of this crate, if the result would be too large, or if `progress` cancels the
/// work.
pub fn resample(recording: &Recording, rate_hz: u32, progress: Progress) -> Result<Recording, Error> {
    format::check_layout(recording.channels.len(), Some(rate_hz), &recording.name)?;
    format::check_layout(recording.channels.len(), Some(recording.sample_rate_hz), &recording.name)?;
    if rate_hz == recording.sample_rate_hz {
        return Ok(recording.clone());
    }
    let ratio = f64::from(rate_hz) / f64::from(recording.sample_rate_hz);
    let samples_out = ((recording.len_samples() as f64 * ratio).round() as usize).max(1);
    let found = samples_out as u64 * recording.channels.len() as u64;
    if found > MAX_SAMPLES as u64 {
        return Err(Error::TooManySamples { name: recording.name.clone(), found });
    }
    let mut channels = Vec::with_capacity(recording.channels.len());
    for (index, samples) in recording.channels.iter().enumerate() {
        let share = |done: f32| progress((index as f32 + done) / recording.channels.len() as f32);
        channels.push(resample_channel(samples, (recording.sample_rate_hz, rate_hz), samples_out, &share)?);
    }
    Ok(Recording { channels, sample_rate_hz: rate_hz, ..recording.clone() })
}

fn resample_channel(
    samples: &[f32],
    rates_hz: (u32, u32),
    samples_out: usize,
    progress: Progress,
) -> Result<Vec<f32>, Error> {
    let divisor = greatest_common_divisor(rates_hz.0, rates_hz.1) as usize;
    let (block_in, block_out) = (rates_hz.0 as usize / divisor, rates_hz.1 as usize / divisor);
    // An even number of blocks: the sinc's centre then falls on a sample at both rates, and cutting off its delay
    // leaves none.
    let blocks = LEAST_SINC_TAPS.div_ceil(block_in.min(block_out)).next_multiple_of(2);
    let mut resampler = Resampler::new(blocks * block_in, blocks * block_out);
    let delay = blocks * block_out / 2;
    let mut resampled = Vec::with_capacity(delay + samples_out + blocks * block_out);
    let mut chunks = samples.chunks(blocks * block_in);
    while resampled.len() < delay + samples_out {
        resampled.extend(resampler.next(chunks.next().unwrap_or_default()).map(|sample| sample as f32));
        if !progress((resampled.len() as f32 / (delay + samples_out) as f32).min(1.0)) {
            return Err(Error::Cancelled);
        }
    }
    resampled.drain(..delay);
    resampled.truncate(samples_out);
    Ok(resampled)
}

/// Chunk by chunk: to the spectrum at one rate, through the filter, and back at the other; chunks overlap by the filter's length.
struct Resampler {
    forward: RealTransform,
    inverse: RealTransform,
    /// The filter's spectrum, and the transforms' scale.
    filter: Vec<Complex64>,
    input: Vec<f64>,
    /// Bins of both rates.
    spectrum: Vec<Complex64>,
    output: Vec<f64>,
    /// Contribution of the previous chunk to this one.
    overlap: Vec<f64>,
    room: Vec<f64>,
}

impl Resampler {
    /// A resampler from chunks of `chunk_in` samples to chunks of `chunk_out`.
    fn new(chunk_in: usize, chunk_out: usize) -> Self {
        let (forward, inverse) = (RealTransform::new(2 * chunk_in), RealTransform::new(2 * chunk_out));
        let mut input = vec![0.0; 2 * chunk_in];
        input[..chunk_in].copy_from_slice(&windowed_sinc(chunk_in, chunk_out.min(chunk_in)));
        input.iter_mut().for_each(|tap| *tap /= 2.0 * chunk_in as f64);
        Self {
            filter: forward.spectrum(&input),
            input,
            spectrum: vec![Complex64::default(); forward.bins().max(inverse.bins())],
            output: vec![0.0; 2 * chunk_out],
            overlap: vec![0.0; chunk_out],
            room: vec![0.0; forward.room().max(inverse.room())],
            forward,
            inverse,
        }
    }

    /// The next output chunk from the next input chunk, which is padded with silence.
    fn next(&mut self, chunk: &[f32]) -> impl Iterator<Item = f64> {
        self.input.fill(0.0);
        self.input.iter_mut().zip(chunk).for_each(|(to, from)| *to = f64::from(*from));
        self.forward.forward(&self.input, &mut self.spectrum, &mut self.room);
        // Going down, the bin at half the new rate would be its own mirror image: it is left out.
        let kept =
            self.forward.bins().min(self.inverse.bins() - usize::from(self.inverse.bins() < self.forward.bins()));
        self.spectrum.iter_mut().zip(&self.filter).take(kept).for_each(|(bin, filter)| *bin *= filter);
        self.spectrum[kept..].fill(Complex64::default());
        self.inverse.inverse(&self.spectrum, &mut self.output, &mut self.room);
        let (now, later) = self.output.split_at_mut(self.overlap.len());
        now.iter_mut().zip(&self.overlap).for_each(|(sample, before)| *sample += before);
        self.overlap.copy_from_slice(later);
        now.iter().copied()
    }
}

/// A sinc of `taps` taps whose cutoff suits a filter of `narrow` taps at the lower rate, in a squared Blackman-Harris window.
fn windowed_sinc(taps: usize, narrow: usize) -> Vec<f64> {
    // The cutoff at which the window's slope ends at half the rate, fitted by rubato's authors for 32 to 2048 taps.
    let n = narrow as f64;
    let cutoff = 1.0
        / (1.0 + 13.745_202_940_783_823 / n + 121.735_325_863_749_34 / (n * n) + 5_964.163_279_612_051 / (n * n * n));
    let cutoff = cutoff * n / taps as f64;
    let tap = |at: usize| {
        let turn = 2.0 * PI * at as f64 / taps as f64;
        let window = 0.358_75 - 0.488_29 * maths::cos(turn) + 0.141_28 * maths::cos(2.0 * turn)
            - 0.011_68 * maths::cos(3.0 * turn);
        let angle = PI * cutoff * (at as f64 - (taps / 2) as f64);
        let sinc = if angle == 0.0 { 1.0 } else { maths::sin(angle) / angle };
        window * window * sinc
    };
    let mut sinc: Vec<f64> = (0..taps).map(tap).collect();
    let sum: f64 = sinc.iter().sum();
    sinc.iter_mut().for_each(|tap| *tap /= sum);
    sinc
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}
