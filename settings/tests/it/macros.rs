//! Macros: neutral where they are not used, and each one heard and monotone in its stated figure over its whole range.

use std::sync::{Arc, LazyLock};

use maths::fft::RealTransform;
use pyrophone_settings::macros::{MACROS, Macro};
use pyrophone_settings::{Id, Values};
use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::texture::PyramidConfig;

const RATE_HZ: f64 = 44_100.0;
const SAMPLES: usize = 9 * 44_100;
/// What comes before is not judged: latency, and means that are not known yet.
const FIRST: usize = 44_100;
/// Length of a level, 50 ms.
const STEP: usize = 2205;
/// Amounts at which a figure is taken in every run, and in the long tests.
const AMOUNTS: [&[f64]; 2] = [&[-100.0, 0.0, 100.0], &[-100.0, -50.0, 0.0, 50.0, 100.0]];

/// Low-passed noise of unit variance, about.
fn rumble(seed: u32, corner_hz: f64, samples: usize) -> Vec<f64> {
    let noise = White::new(seed, 0);
    let part = 1.0 - (-std::f64::consts::TAU * corner_hz / RATE_HZ).exp();
    let mut poles = [0.0; 2];
    let sample = |n: usize| {
        poles[0] += part * (noise.sample_at(n as i64) - poles[0]);
        poles[1] += part * (poles[0] - poles[1]);
        poles[1] / part.sqrt()
    };
    (0..samples).map(sample).collect()
}

/// A flame's pressure, whose loudness swings by itself.
fn flame() -> Vec<f32> {
    let slow = rumble(3, 1.0, SAMPLES);
    let fast = rumble(4, 90.0, SAMPLES);
    slow.iter().zip(fast).map(|(slow, fast)| (0.06 * (0.8 * slow).exp() * fast) as f32).collect()
}

/// A fire: a bed of noise, and clicks of several loudnesses.
fn recording() -> Vec<f64> {
    let samples = 6 * 44_100;
    let mut fire: Vec<f64> =
        rumble(5, 500.0, samples).iter().zip(rumble(6, 9000.0, samples)).map(|(a, b)| 0.02 * a + 0.004 * b).collect();
    let (place, tone) = (White::new(7, 0), White::new(8, 0));
    for click in 0..60 {
        let at = ((0.5 + place.sample_at(click) / 3.5).clamp(0.0, 0.98) * samples as f64) as usize;
        let level = 0.05 * (0.6 * place.sample_at(1000 + click)).exp2();
        for n in 0..400usize.min(samples - at) {
            fire[at + n] += level * tone.sample_at(click * 1000 + n as i64) * (-(n as f64) / 60.0).exp();
        }
    }
    fire
}

static DICTIONARY: LazyLock<Arc<RecordingDictionary>> = LazyLock::new(|| {
    let shape = PyramidConfig::at_rate(&Values::default().structure(), RATE_HZ);
    Arc::new(RecordingDictionary::companded(&[recording()], RATE_HZ, &shape, &|_| true).expect("a dictionary"))
});

/// What is heard of a flame, and the flame itself, in time with it.
struct Heard {
    output: Vec<f64>,
    drive: Vec<f64>,
}

/// Plays with all layers on, but for those that are set to off.
fn play(line: &Macro, amount: f64, off: &[&str]) -> Heard {
    let mut values = Values::default();
    values.set_text("vortex_level", "-12").unwrap();
    values.set_text("extension_level", "-30").unwrap();
    values.set_text("ceiling", "off").unwrap();
    off.iter().for_each(|id| values.set_text(id, "off").unwrap());
    values.set(line.id as usize, amount).unwrap();
    let channels = Channels { input: 1, sidechain: 0, output: 1 };
    let mut chain = Chain::new(RATE_HZ, channels, &values.structure()).unwrap();
    chain.swap_dictionary(Some(DICTIONARY.clone()));
    let latency = chain.latency_samples();
    let drive = flame();
    let mut output = drive.clone();
    let controls = values.controls();
    for (number, block) in output.chunks_mut(1024).enumerate() {
        let position = Some(1024 * number as i64);
        chain.process(&mut [block], &[], &controls, Transport { playing: true, position });
    }
    let heard = output[latency + FIRST..].iter().map(|x| f64::from(*x)).collect();
    Heard { output: heard, drive: drive[FIRST..SAMPLES - latency].iter().map(|x| f64::from(*x)).collect() }
}

/// Power by frequency bin, and the width of a bin in Hz.
fn spectrum(signal: &[f64]) -> (Vec<f64>, f64) {
    const LENGTH: usize = 4096;
    let transform = RealTransform::new(LENGTH);
    let mut power = vec![0.0; transform.bins()];
    for start in (0..signal.len() - LENGTH).step_by(LENGTH / 2) {
        let window = |n: usize| (std::f64::consts::PI * n as f64 / LENGTH as f64).sin().powi(2);
        let piece: Vec<f64> = (0..LENGTH).map(|n| window(n) * signal[start + n]).collect();
        power.iter_mut().zip(&transform.spectrum(&piece)).for_each(|(power, bin)| *power += bin.norm_sqr());
    }
    (power, RATE_HZ / LENGTH as f64)
}

/// Share of the power between two frequencies in Hz.
fn share(signal: &[f64], low_hz: f64, high_hz: f64) -> f64 {
    let (power, width_hz) = spectrum(signal);
    let inside = |bin: usize| (low_hz..high_hz).contains(&(bin as f64 * width_hz));
    let sum: f64 = power.iter().enumerate().filter(|(bin, _)| inside(*bin)).map(|(_, power)| power).sum();
    sum / power.iter().sum::<f64>()
}

fn centroid_hz(signal: &[f64]) -> f64 {
    let (power, width_hz) = spectrum(signal);
    let sum: f64 = power.iter().enumerate().map(|(bin, power)| bin as f64 * width_hz * power).sum();
    sum / power.iter().sum::<f64>()
}

fn power(signal: &[f64]) -> f64 {
    signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64
}

fn levels_db(signal: &[f64]) -> Vec<f64> {
    signal.chunks_exact(STEP).map(|step| 10.0 * power(step).max(1e-14).log10()).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean of the products of what lies apart from the means.
fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum::<f64>() / a.len() as f64
}

/// Fourth moment over the square of the second, of what lies above 4 kHz.
fn kurtosis(signal: &[f64]) -> f64 {
    let part = 1.0 - (-std::f64::consts::TAU * 4000.0 / RATE_HZ).exp();
    let mut poles = [0.0; 2];
    let high: Vec<f64> = signal
        .iter()
        .map(|x| {
            poles.iter_mut().fold(*x, |x, pole| {
                *pole += part * (x - *pole);
                x - *pole
            })
        })
        .collect();
    high.iter().map(|x| x.powi(4)).sum::<f64>() / high.len() as f64 / power(&high).powi(2)
}

/// Onsets: 1 ms that is four times as loud as the 20 ms before, at most one in 5 ms.
fn onsets(signal: &[f64]) -> f64 {
    let steps: Vec<f64> = signal.chunks_exact(44).map(power).collect();
    let (mut count, mut last) = (0, 0);
    for at in 20..steps.len() {
        let before = mean(&steps[at - 20..at - 1]);
        if steps[at] > 4.0 * before.max(1e-12) && steps[at] > 1e-9 && at - last > 5 {
            (count, last) = (count + 1, at);
        }
    }
    f64::from(count)
}

/// The amounts of this run.
fn amounts() -> &'static [f64] {
    AMOUNTS[usize::from(std::env::var_os("PYROPHONE_SOAK").is_some())]
}

/// The stated figure of a macro at each of the amounts.
fn figures(id: Id, mut of: impl FnMut(&Macro, f64) -> f64) -> Vec<f64> {
    let line = Macro::of_id(id).unwrap();
    let found: Vec<f64> = amounts().iter().map(|amount| of(line, *amount)).collect();
    println!("{} ({}): {found:.4?}", line.name, line.figure);
    found
}

#[track_caller]
fn assert_rises(figures: &[f64], by: f64) {
    assert!(figures.windows(2).all(|pair| pair[1] > pair[0]), "not monotone: {figures:?}");
    let span = figures[figures.len() - 1] - figures[0];
    assert!(span >= by, "rises by {span} only: {figures:?}");
}

#[test]
fn size_lowers_the_centroid() {
    let found = figures(Id::MacroSize, |line, amount| -centroid_hz(&play(line, amount, &[]).output).log2());
    assert_rises(&found, 1.0);
}

#[test]
fn fury_raises_the_variance_of_the_level() {
    let found = figures(Id::MacroFury, |line, amount| {
        let levels = levels_db(&play(line, amount, &[]).output);
        covariance(&levels, &levels)
    });
    assert_rises(&found, 10.0);
}

#[test]
fn crackle_raises_the_rate_of_events() {
    let alone = ["texture_level", "vortex_level", "extension_level"];
    let found = figures(Id::MacroCrackle, |line, amount| onsets(&play(line, amount, &alone).output));
    assert_rises(&found, 20.0);
}

#[test]
fn sharpness_raises_the_kurtosis_of_the_highs() {
    let found = figures(Id::MacroSharpness, |line, amount| kurtosis(&play(line, amount, &[]).output).log2());
    assert_rises(&found, 1.0);
}

#[test]
fn hiss_raises_the_share_of_the_highs() {
    let found = figures(Id::MacroHiss, |line, amount| 10.0 * share(&play(line, amount, &[]).output, 6e3, 16e3).log10());
    assert_rises(&found, 10.0);
}

#[test]
fn whoosh_raises_the_share_of_vortex_sound() {
    let alone = ["texture_level", "crackle_level", "extension_level"];
    let found = figures(Id::MacroWhoosh, |line, amount| {
        10.0 * (power(&play(line, amount, &alone).output) / power(&play(line, amount, &[]).output)).log10()
    });
    assert_rises(&found, 10.0);
}

#[test]
fn tightness_raises_the_correlation_with_the_flame() {
    let found = figures(Id::MacroTightness, |line, amount| {
        let heard = play(line, amount, &["vortex_level"]);
        let (a, b) = (levels_db(&heard.output), levels_db(&heard.drive));
        covariance(&a, &b) / (covariance(&a, &a) * covariance(&b, &b)).sqrt()
    });
    assert_rises(&found, 0.05);
}

#[test]
fn distance_takes_level_and_highs() {
    let mut highs = Vec::new();
    let level = figures(Id::MacroDistance, |line, amount| {
        let heard = play(line, amount, &[]).output;
        highs.push(-10.0 * share(&heard, 4e3, 16e3).log10());
        -10.0 * power(&heard).log10()
    });
    assert_rises(&level, 20.0);
    assert_rises(&highs, 10.0);
}

#[test]
fn every_macro_is_neutral_at_zero_and_moves_what_it_says() {
    let neutral = Values::default().controls();
    for line in MACROS {
        let parameter = line.id.parameter();
        assert_eq!(parameter.name, format!("Macro: {}", line.name));
        assert!(parameter.id.starts_with("macro_") && parameter.automatable);
        assert_eq!((parameter.low(), parameter.high(), parameter.default_value()), (-100.0, 100.0, 0.0));
        assert!(!line.effects.is_empty() && !line.figure.is_empty());
        for amount in [-100.0, 100.0] {
            let mut values = Values::default();
            values.set_text("vortex_level", "-12").unwrap();
            let before = values.controls();
            values.set(line.id as usize, amount).unwrap();
            assert_ne!(values.controls(), before, "{} at {amount} %", line.name);
            values.set(line.id as usize, 0.0).unwrap();
            assert_eq!(values.controls(), before, "{} comes back", line.name);
        }
    }
    assert_eq!(Values::default().controls(), neutral);
}

#[test]
fn controls_stay_in_their_ranges_whatever_the_macros() {
    for amount in [-100.0, 100.0] {
        for extreme in [f64::NEG_INFINITY, f64::INFINITY] {
            let mut values = Values::default();
            (0..pyrophone_settings::COUNT).for_each(|index| values.set_nearest(index, extreme));
            MACROS.iter().for_each(|line| values.set(line.id as usize, amount).unwrap());
            let c = values.controls();
            assert!((1e-4..=1.0).contains(&c.drive.attack_s) && (1e-3..=5.0).contains(&c.drive.release_s));
            assert!((-1.0..=2.0).contains(&c.drive.swell) && (0.0..=1.0).contains(&c.drive.flame.wind));
            assert!((0.0..=6.0).contains(&c.extend.alpha) && (0.0..=1.0).contains(&c.extend.width));
            assert!((0.0..=1.0).contains(&c.texture.companding.dynamics));
            assert!((0.0..=4.0).contains(&c.crackle.density) && (-1.0..=1.0).contains(&c.crackle.sharpness));
            assert!((0.0..=2.0).contains(&c.crackle.spread) && (0.0..=2.0).contains(&c.crackle.follow));
            assert!((0.0..=1.0).contains(&c.mix.width) && c.mix.vortex >= 0.0 && c.mix.vortex.is_finite());
        }
    }
}

#[test]
fn another_take_has_other_seeds_and_take_zero_none() {
    let mut values = Values::default();
    values.set_text("take_amount", "80").unwrap();
    let zero = values.controls();
    assert_eq!(zero, Values::default().controls(), "an amount alone changes nothing");
    values.set_text("take", "7").unwrap();
    let seven = values.controls();
    assert_eq!(seven.texture.variety, 0.8);
    let seeds =
        |c: pyrophone_synthesis::Controls| [c.drive.seed, c.extend.seed, c.texture.seed, c.crackle.seed, c.vortex.seed];
    assert!(seeds(zero).iter().zip(seeds(seven)).all(|(a, b)| *a != b));
}
