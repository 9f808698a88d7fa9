//! Made-up textures and fields, running the renderer, and measuring what comes out.
#![allow(dead_code)]

use std::f64::consts::TAU;
use std::sync::Arc;

use maths::fft::{Complex64, ComplexTransform};
use pyrophone_synthesis::controls::VortexControls;
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::vortex::texture::Row;
use pyrophone_synthesis::vortex::{Bank, End, SpeakerLayout, SpeedField, Vortex, VortexTexture};

/// Rows of white noise at 1, 2, 4 ... m/s whose levels rise by 30 dB each from 0.001 Pa.
pub fn noise_texture(rows: usize, steps: usize) -> VortexTexture {
    let share = 0.2f64.sqrt();
    let row = |index: usize| Row {
        speed_m_s: (1 << index.min(20)) as f64 * if index > 20 { index as f64 } else { 1.0 },
        gain: 1e-3 * 10f64.powf(1.5 * index as f64),
        components: std::array::from_fn(|component| {
            let noise = White::new(index as u32, component as u32);
            (0..steps).map(|step| (share * noise.sample_at(step as i64)) as f32).collect()
        }),
    };
    VortexTexture::new(4000.0, (0..rows).map(row).collect()).expect("a texture")
}

/// A row of 1 s at 1 m/s with a tone in every component.
pub fn tone_texture(frequency_hz: f64) -> VortexTexture {
    let tone = |component: usize| {
        let sample = |step: usize| TAU * (frequency_hz * step as f64 / 4000.0 + 0.1 * component as f64);
        (0..4000).map(|step| (0.4f64.sqrt() * sample(step).sin()) as f32).collect()
    };
    let row = Row { speed_m_s: 1.0, gain: 1.0, components: std::array::from_fn(tone) };
    VortexTexture::new(4000.0, vec![row]).expect("a texture")
}

/// Sources that wander, one of which is put elsewhere now and then.
pub fn wandering(sources: usize, steps: usize, end: End) -> SpeedField {
    let white = White::new(5, 5);
    let wave = |source: usize, step: usize, which: i64| {
        let phase = white.sample_at(source as i64 * 4 + which) + TAU * step as f64 / steps as f64;
        phase.sin()
    };
    let each = |step: usize| (0..sources).map(move |source| (source, step));
    let positions = (0..steps).flat_map(each).map(|(source, step)| {
        let elsewhere = if source == 0 && step % 8 > 4 { 40.0 } else { 0.0 };
        [0, 1, 2].map(|axis| (elsewhere + wave(source, step, axis)) as f32)
    });
    let speeds = (0..steps).flat_map(each).map(|(source, step)| (4.0 + 3.0 * wave(source, step, 3)) as f32);
    SpeedField::new(30.0, sources, positions.collect(), speeds.collect(), end).expect("a field")
}

/// One source that stands in the middle and flows at 16 m/s.
pub fn point() -> VortexControls {
    VortexControls {
        count: 1,
        spread_m: 0.0,
        variation: 0.0,
        threshold: 0.0,
        attack_s: 1e-4,
        ..VortexControls::default()
    }
}

/// Sources that stand in a ball and flow alike.
pub fn crowd(count: usize) -> VortexControls {
    VortexControls { count, spread_m: 1.0, ..point() }
}

/// Controls that change at odd places.
pub fn busy(at: usize) -> VortexControls {
    let step = at / 2345;
    let part = (step % 5) as f64 / 4.0;
    VortexControls {
        speed_m_s: 4.0 + 8.0 * part,
        curve: 0.5 + part,
        variation: part,
        count: 3 + 10 * (step % 4),
        seed: (at / 4690) as u32,
        distance_m: 0.5 + 5.0 * part,
        spread_m: 2.0 * part,
        azimuth_deg: 100.0 * (step % 7) as f64,
        elevation_deg: 40.0 * part,
        exponent: 1.0 + part,
        range: 1.0 - 0.5 * part,
        level: 1.0 + part,
        max_pressure_pa: 1.0 + part,
        ..VortexControls::default()
    }
}

/// A drive with silences.
pub fn bursts(samples: usize) -> Vec<f64> {
    let white = White::new(3, 3);
    (0..samples).map(|at| if at / 1700 % 3 == 2 { 0.0 } else { 0.5 * white.sample_at(at as i64) }).collect()
}

/// A renderer with a bank of `texture`.
pub fn engine(rate_hz: f64, layout: SpeakerLayout, texture: &VortexTexture, sources: usize) -> Vortex {
    let mut engine = Vortex::new(rate_hz, layout, sources).expect("engine");
    engine.swap_bank(Some(Arc::new(Bank::new(texture, rate_hz).expect("a bank"))));
    engine
}

/// Plays `drive` in `blocks`, cut where the controls, told by sample, may change.
pub fn play(
    engine: &mut Vortex,
    drive: &[f64],
    controls: &impl Fn(usize) -> VortexControls,
    blocks: impl IntoIterator<Item = usize>,
) -> Vec<Vec<f64>> {
    let mut out = vec![vec![0.0; drive.len()]; engine.channels()];
    let mut at = 0;
    for block in blocks {
        let end = (at + block).min(drive.len());
        loop {
            let stop = end.min((at / 2345 + 1) * 2345);
            let mut outputs: Vec<&mut [f64]> = out.iter_mut().map(|channel| &mut channel[at..stop]).collect();
            engine.process(&drive[at..stop], &controls(at), &mut outputs);
            at = stop;
            if at >= end {
                break;
            }
        }
        if at == drive.len() {
            return out;
        }
    }
    panic!("blocks ended early");
}

/// What a new renderer makes of a drive of full scale, after 0.1 s for the envelope; `drive` instead where there is one.
pub fn render(
    rate_hz: f64,
    layout: SpeakerLayout,
    texture: &VortexTexture,
    sources: usize,
    drive: &[f64],
    controls: &VortexControls,
    samples: usize,
) -> Vec<Vec<f64>> {
    assert!(drive.is_empty() || drive.len() == samples);
    render_by(rate_hz, layout, texture, sources, &|_| *controls, samples)
}

/// The same with controls by sample.
pub fn render_by(
    rate_hz: f64,
    layout: SpeakerLayout,
    texture: &VortexTexture,
    sources: usize,
    controls: &impl Fn(usize) -> VortexControls,
    samples: usize,
) -> Vec<Vec<f64>> {
    let mut engine = engine(rate_hz, layout, texture, sources);
    let settle = 4800;
    let mut out = play(&mut engine, &vec![1.0; samples + settle], controls, std::iter::repeat(1024));
    out.iter_mut().for_each(|channel| drop(channel.drain(..settle)));
    out
}

/// Mean square.
pub fn power(signal: &[f64]) -> f64 {
    signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64
}

/// Root mean square.
pub fn rms(signal: &[f64]) -> f64 {
    power(signal).sqrt()
}

/// Decibels of a ratio of amplitudes.
pub fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// By how many samples `b` is later than `a`, near `about`, and its gain there: from the slope of the phase between 100
/// and 1500 Hz at 48 kHz.
pub fn lag(a: &[f64], b: &[f64], about: usize) -> (f64, f64) {
    let len = 32_768;
    let fft = ComplexTransform::new(len);
    let transform = |signal: &[f64]| {
        let hann = |i: usize| 0.5 - 0.5 * (TAU * i as f64 / len as f64).cos();
        let mut bins: Vec<Complex64> = (0..len).map(|i| (signal[i] * hann(i)).into()).collect();
        fft.forward(&mut bins);
        bins
    };
    let (a, b) = (transform(a), transform(&b[about..]));
    let bins = 68..1024;
    let (mut moment, mut weight, mut cross, mut own) = (0.0, 0.0, 0.0, 0.0);
    for bin in bins {
        let turn = TAU * bin as f64 / len as f64;
        let product = b[bin] * a[bin].conj();
        moment -= product.arg() * turn * product.norm();
        weight += turn * turn * product.norm();
        cross += product.norm();
        own += a[bin].norm_sqr();
    }
    (about as f64 + moment / weight, cross / own)
}

/// Power by bin of 1 s at 48 kHz, under a window whose sidelobes are 92 dB down.
pub fn spectrum(signal: &[f64]) -> Vec<f64> {
    let len = signal.len();
    let window = |i: usize| {
        let turn = TAU * i as f64 / len as f64;
        0.35875 - 0.48829 * turn.cos() + 0.14128 * (2.0 * turn).cos() - 0.01168 * (3.0 * turn).cos()
    };
    let mut bins: Vec<Complex64> = signal.iter().enumerate().map(|(i, x)| (x * window(i)).into()).collect();
    ComplexTransform::new(len).forward(&mut bins);
    bins[..len / 2].iter().map(|bin| bin.norm_sqr()).collect()
}

/// Levels in dB of the third octaves 63 Hz - 1.6 kHz.
pub fn third_octaves(signal: &[f64], rate_hz: f64) -> Vec<f64> {
    let len = signal.len();
    let mut bins: Vec<Complex64> = signal.iter().map(|x| (*x).into()).collect();
    ComplexTransform::new(len).forward(&mut bins);
    let bin_hz = rate_hz / len as f64;
    let band = |third: i32| {
        let center = 1000.0 * 2f64.powf(f64::from(third) / 3.0);
        let edge = |sixth: f64| (center * 2f64.powf(sixth / 6.0) / bin_hz).ceil() as usize;
        10.0 * bins[edge(-1.0)..edge(1.0)].iter().map(|bin| bin.norm_sqr()).sum::<f64>().log10()
    };
    (-12..=2).map(band).collect()
}

/// What lies above 6 kHz at 48 kHz, by a windowed sinc of 255 taps.
pub fn highs(signal: &[f64]) -> Vec<f64> {
    let reach = 127i32;
    let tap = |k: i32| {
        let x = f64::from(k);
        let window = 0.42 + 0.5 * (0.5 * TAU * x / 128.0).cos() + 0.08 * (TAU * x / 128.0).cos();
        let low = if k == 0 { 0.25 } else { (0.25 * 0.5 * TAU * x).sin() / (0.5 * TAU * x) };
        window * (f64::from(u8::from(k == 0)) - low)
    };
    let taps: Vec<f64> = (-reach..=reach).map(tap).collect();
    signal.windows(taps.len()).map(|part| part.iter().zip(&taps).map(|(a, b)| a * b).sum()).collect()
}
