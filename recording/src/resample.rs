//! To another sample rate, by windowed sinc.

use audioadapter_buffers::direct::SequentialSlice;
use rubato::{Fft, FixedSync, Indexing, Resampler, WindowFunction};

use crate::{Error, MAX_SAMPLES, Progress, Recording, format};

/// Least taps of the sinc, counted at the lower of the two rates. With the squared Blackman-Harris
/// window it passes up to 0.97 of the lower Nyquist frequency.
const LEAST_SINC_TAPS: usize = 1024;

/// The recording at `rate_hz`: round(samples * ratio) samples long, without delay. At its own rate
/// it comes back unchanged, bit for bit. Name and hash stay: they name the file.
///
/// # Errors
/// Fails at a rate outside the limits of this crate, where the result would be too large, and where
/// `progress` calls it off.
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
        channels.push(resample_channel(
            samples,
            (recording.sample_rate_hz, rate_hz),
            samples_out,
            &share,
            &recording.name,
        )?);
    }
    Ok(Recording { channels, sample_rate_hz: rate_hz, ..recording.clone() })
}

fn resample_channel(
    samples: &[f32],
    rates_hz: (u32, u32),
    samples_out: usize,
    progress: Progress,
    name: &str,
) -> Result<Vec<f32>, Error> {
    let divisor = greatest_common_divisor(rates_hz.0, rates_hz.1) as usize;
    let (block_in, block_out) = (rates_hz.0 as usize / divisor, rates_hz.1 as usize / divisor);
    // An even number of blocks: then the sinc's centre falls on a sample at both rates, and cutting
    // off its delay leaves none.
    let blocks = LEAST_SINC_TAPS.div_ceil(block_in.min(block_out)).next_multiple_of(2);
    let (chunk_in, chunk_out) = (blocks * block_in, blocks * block_out);
    let failure = |error: &dyn std::fmt::Display| Error::Damaged { name: name.into(), reason: error.to_string() };
    let mut resampler =
        Fft::<f64>::new_custom(block_in, block_out, chunk_in, 1, 1, WindowFunction::BlackmanHarris2, FixedSync::Both)
            .map_err(|error| failure(&error))?;
    let delay = resampler.output_delay();
    let mut input = vec![0.0; chunk_in];
    let mut output = vec![0.0; chunk_out];
    let mut resampled = Vec::with_capacity(delay + samples_out + chunk_out);
    let mut chunks = samples.chunks(chunk_in);
    while resampled.len() < delay + samples_out {
        let chunk = chunks.next().unwrap_or_default();
        for (to, from) in input.iter_mut().zip(chunk) {
            *to = f64::from(*from);
        }
        let source = SequentialSlice::new(&input, 1, chunk_in).map_err(|error| failure(&error))?;
        let mut target = SequentialSlice::new_mut(&mut output, 1, chunk_out).map_err(|error| failure(&error))?;
        let partial = Indexing::new().partial_len(chunk.len());
        resampler.process_into_buffer(&source, &mut target, Some(&partial)).map_err(|error| failure(&error))?;
        resampled.extend(output.iter().map(|sample| *sample as f32));
        if !progress((resampled.len() as f32 / (delay + samples_out) as f32).min(1.0)) {
            return Err(Error::Cancelled);
        }
    }
    resampled.drain(..delay);
    resampled.truncate(samples_out);
    Ok(resampled)
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}
