//! The streaming extension against the golden data and the reference module.

use crate::common::{read_f64, read_wav, reference_dir};
use crate::extend::*;
use maths::fft::ComplexTransform;
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::controls::ExtendControls;
use pyrophone_synthesis::extend::Extend;
use pyrophone_synthesis::extend::noise::NoiseSource;
use pyrophone_synthesis::extend::reference;

const GOLDENS: [(&str, &str); 5] =
    [("burning_brick", "2.5"), ("burning_brick", "3.0"), ("burning_brick", "3.5"), ("dragon", "2.5"), ("torch", "3.0")];

/// The golden data's own noise, made real: twice the real part keeps the spectrum at positive
/// frequencies, so beta keeps its unit and the output gains 6.02 dB.
struct GoldenNoise {
    samples: Vec<f64>,
    level: f64,
}

impl GoldenNoise {
    fn new(samples: usize, rate_hz: f64, alpha: f64) -> Self {
        let bins = samples.next_power_of_two();
        let axis = reference::frequency_axis(bins, rate_hz);
        let (_, upper) = reference::blend_ramps(&axis, 165.0, 195.0);
        let mut noise = reference::noise_spectrum(&axis, alpha, &mut reference::Pcg32::new(42));
        noise.iter_mut().zip(&upper).for_each(|(bin, upper)| *bin *= upper);
        ComplexTransform::new(bins).inverse(&mut noise);
        Self {
            samples: noise[..samples].iter().map(|sample| 2.0 * sample.re / bins as f64).collect(),
            level: 180f64.powf(-alpha / 2.0) / (bins as f64).sqrt(),
        }
    }
}

impl NoiseSource for GoldenNoise {
    fn fill(&mut self, _channel: usize, start: i64, _controls: &ExtendControls, out: &mut [f64]) {
        for (at, sample) in (start..).zip(out) {
            *sample = usize::try_from(at).ok().and_then(|at| self.samples.get(at)).copied().unwrap_or(0.0);
        }
    }

    fn level(&self, _controls: &ExtendControls) -> f64 {
        self.level
    }
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product =
        |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 { x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum() };
    product(a, mean_a, b, mean_b) / (product(a, mean_a, a, mean_a) * product(b, mean_b, b, mean_b)).sqrt()
}

#[test]
fn with_the_goldens_noise_it_gives_the_goldens_betas_and_levels() {
    let Some(folder) = reference_dir() else { return };
    let export = std::env::var_os("PYROPHONE_EXPORT");
    for (name, alpha) in GOLDENS {
        let (channels, rate) = read_wav(&folder.join(format!("signals/{name}.wav")));
        let drive = &channels[0];
        let rate_hz = f64::from(rate);
        let controls = ExtendControls { alpha: alpha.parse().expect("alpha"), ..ExtendControls::default() };
        let source = GoldenNoise::new(drive.len(), rate_hz, controls.alpha);
        let mut engine = Extend::with_noise(&EngineConfig::default(), 1, rate_hz, source).expect("engine");
        let found = run(&mut engine, 1, drive, |_| controls, std::iter::repeat(500));

        let golden_betas = read_f64(&folder.join(format!("extend/{name}_alpha{alpha}.betas.f64")));
        // A stream does not know what comes before a file's begin and after its end, where the
        // reference mirrors the signal for its envelope: the two windows at either end, which
        // reach within a half-width and the envelope filter's length of them, differ by nature.
        let inner = 2..drive.len() / 500 - 1;
        assert!(found.fits.len() > inner.end);
        let pairs = inner
            .map(|window| (found.fits[window].raw, golden_betas[window]))
            .filter(|(found, golden)| *found > 0.0 && *golden > 0.0);
        let (logs, golden_logs): (Vec<f64>, Vec<f64>) = pairs.map(|(found, golden)| (found.ln(), golden.ln())).unzip();
        assert!(logs.len() > 400, "{name}: only {} windows with sound", logs.len());
        let correlated = correlation(&logs, &golden_logs);

        let golden: Vec<f64> =
            read_f64(&folder.join(format!("extend/{name}_alpha{alpha}.f64"))).iter().map(|x| 2.0 * x).collect();
        let sum = found.sum();
        if let Some(folder) = &export {
            let bytes: Vec<u8> = sum.iter().flat_map(|x| x.to_le_bytes()).collect();
            let path = std::path::Path::new(folder).join(format!("{name}_alpha{alpha}_golden_noise.f64"));
            std::fs::write(path, bytes).expect("export");
        }
        let (bias, deviation) =
            level_difference(&third_octaves(&sum, rate as usize), &third_octaves(&golden, rate as usize));

        let applied: Vec<f64> = found.fits.iter().map(|fit| fit.applied).collect();
        let raw: Vec<f64> = found.fits.iter().map(|fit| fit.raw).collect();
        println!(
            "{name} alpha {alpha}: log beta correlation {correlated:.5}; levels off by {bias:+.2} dB, {deviation:.2} dB \
             absolute; maximum/median of beta: golden {:.1}, raw {:.1}, applied {:.1}",
            spread(&golden_betas),
            spread(&raw),
            spread(&applied)
        );
        assert!(correlated >= 0.995, "{name} {alpha}: {correlated}");
        assert!(deviation <= 1.0, "{name} {alpha}: {deviation} dB");
        assert!(spread(&applied) < spread(&golden_betas), "{name} {alpha}");
    }
}

#[test]
fn over_many_seeds_it_has_the_references_levels_and_tamer_betas() {
    const SEEDS: u32 = 16;
    let Some(folder) = reference_dir() else { return };
    let export = std::env::var_os("PYROPHONE_EXPORT");
    // Fewer seeds would leave the mean of their levels too uncertain: one drive in every run, all in the long tests.
    let drives = [("burning_brick", 2.5), ("torch", 3.0), ("dragon", 2.5)];
    let count = if std::env::var_os("PYROPHONE_SOAK").is_some() { drives.len() } else { 1 };
    for (name, alpha) in drives.into_iter().take(count) {
        let (channels, rate) = read_wav(&folder.join(format!("signals/{name}.wav")));
        let drive = &channels[0];
        let rate_hz = f64::from(rate);
        let (mut found, mut expected): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        let (mut found_spread, mut expected_spread) = (0.0, 0.0);
        for seed in 0..SEEDS {
            let controls = ExtendControls { alpha, seed, ..ExtendControls::default() };
            let product = run_simply(drive, rate_hz, controls);
            let settings = reference::Settings { alpha, seed: seed.into(), ..reference::Settings::new(rate_hz) };
            let published = reference::extend(drive, &settings, &mut |_| true).expect("extends");
            let raised: Vec<f64> = published.samples.iter().map(|x| 2.0 * x).collect();
            for (levels, signal) in [(&mut found, product.sum()), (&mut expected, raised)] {
                let rows = third_octaves(&signal, rate as usize);
                levels.resize(rows.len(), vec![0.0; rows[0].len()]);
                for (sum, row) in levels.iter_mut().zip(&rows) {
                    sum.iter_mut().zip(row).for_each(|(sum, level)| *sum += level / f64::from(SEEDS));
                }
            }
            if let Some(folder) = &export {
                for (kind, signal) in [("engine", product.sum()), ("reference", published.samples.clone())] {
                    let bytes: Vec<u8> = signal.iter().flat_map(|x| x.to_le_bytes()).collect();
                    let path = std::path::Path::new(folder).join(format!("{name}_{seed}_{kind}.f64"));
                    std::fs::write(path, bytes).expect("export");
                }
            }
            let applied: Vec<f64> = product.fits.iter().map(|fit| fit.applied).collect();
            found_spread += spread(&applied) / f64::from(SEEDS);
            expected_spread += spread(&published.betas) / f64::from(SEEDS);
        }
        let (bias, deviation) = level_difference(&found, &expected);
        println!(
            "{name}: mean levels off by {bias:+.2} dB, {deviation:.2} dB absolute; mean maximum/median of beta: \
             reference {expected_spread:.1}, applied {found_spread:.1}"
        );
        assert!(deviation <= 1.5, "{name}: {deviation} dB");
        assert!(found_spread < expected_spread, "{name}: {found_spread} against {expected_spread}");
    }
}
