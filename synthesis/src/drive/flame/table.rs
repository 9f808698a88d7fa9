//! Flux of the built-in simulated flames.

use std::io::Cursor;
use std::sync::LazyLock;

use crate::dsp::mitchell_netravali;
use crate::error::Error;

/// The scenes' names. Indices are a promise: names may only be appended.
pub const SCENES: &[&str] = &names();

const fn names() -> [&'static str; pyrophone_assets::SCENES.len()] {
    let mut names = [""; pyrophone_assets::SCENES.len()];
    let mut scene = 0;
    while scene < names.len() {
        names[scene] = pyrophone_assets::SCENES[scene].name;
        scene += 1;
    }
    names
}

/// Variants in which each scene was simulated.
pub const WAYS: usize = 2;

/// Simulated as designed.
pub const PLAIN: usize = 0;
/// The variant with twice the wind, motion and turbulence.
pub const WINDY: usize = 1;

/// Level of a plain scene's pressure before the high-pass: that of the paper's own signals.
const RMS: f64 = 0.08;
/// Largest pressure of a plain scene, if that requires a lower level.
const PEAK: f64 = 0.7;

static TABLES: LazyLock<Result<Vec<Table>, Error>> =
    LazyLock::new(|| pyrophone_assets::SCENES.iter().map(|scene| Table::read(scene.name, scene.drive)).collect());

/// Tables of all scenes, in the order of [`SCENES`]; read at the first call.
pub fn tables() -> Result<&'static [Table], Error> {
    TABLES.as_deref().map_err(Error::clone)
}

/// A scene's flux over one period, for each variant.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    rate_hz: f64,
    /// Steps of a period, with those beyond its ends that the kernel's taps reach: one step before and two after.
    steps: Vec<[f32; WAYS]>,
    /// Conversion factor from flux per step to pressure.
    gain: f64,
}

impl Table {
    /// A table of a period's steps, [`WAYS`] values each, with pressure at the level that every scene has.
    fn new(rate_hz: f64, period: Vec<[f32; WAYS]>) -> Self {
        let [.., end] = period[..] else { return Self { rate_hz, steps: vec![[0.0; WAYS]; 4], gain: 0.0 } };
        let starts = [period[0], period[1 % period.len()]];
        let steps: Vec<[f32; WAYS]> = [end].into_iter().chain(period).chain(starts).collect();
        let differences =
            || steps[1..steps.len() - 1].windows(2).map(|w| f64::from(w[1][PLAIN]) - f64::from(w[0][PLAIN]));
        let rms = (differences().map(|x| x * x).sum::<f64>() / differences().count() as f64).sqrt();
        let peak = differences().fold(0.0, |peak: f64, x| peak.max(x.abs()));
        let gain = if peak > 0.0 { (RMS / rms).min(PEAK / peak) } else { 0.0 };
        Self { rate_hz, steps, gain }
    }

    fn read(scene: &'static str, file: &[u8]) -> Result<Self, Error> {
        let broken = |reason: String| Error::FactoryDrive { scene, reason };
        let mut reader = hound::WavReader::new(Cursor::new(file)).map_err(|error| broken(error.to_string()))?;
        let spec = reader.spec();
        if usize::from(spec.channels) != WAYS {
            return Err(broken(format!("it has {} channels instead of {WAYS}", spec.channels)));
        }
        let samples: Vec<i16> =
            reader.samples::<i16>().collect::<Result<_, _>>().map_err(|error| broken(error.to_string()))?;
        let period: Vec<[f32; WAYS]> = samples.as_chunks().0.iter().map(|step| step.map(f32::from)).collect();
        if period.len() < 4 {
            return Err(broken(format!("it has {} steps, which is not a period", period.len())));
        }
        Ok(Self::new(f64::from(spec.sample_rate), period))
    }

    /// Pressure at a time, the ways mixed by `weights` (Chadwick & James 2011, eq. 9-10).
    pub fn pressure(&self, time_s: f64, weights: &[f64; WAYS]) -> f64 {
        let period = self.steps.len() - 3;
        let step = (time_s * self.rate_hz).rem_euclid(period as f64);
        // The remainder may round up to the period itself.
        let first = (step as usize).min(period - 1);
        let part = step - first as f64;
        let mut pressure = 0.0;
        for (tap, values) in self.steps[first..first + 4].iter().enumerate() {
            let (_, slope) = mitchell_netravali(part + 1.0 - tap as f64);
            let value: f64 = values.iter().zip(weights).map(|(value, weight)| f64::from(*value) * weight).sum();
            pressure += slope * value;
        }
        self.gain * pressure
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 360.0;

    fn period_s(table: &Table) -> f64 {
        (table.steps.len() - 3) as f64 / table.rate_hz
    }

    fn rms(table: &Table, weights: &[f64; WAYS]) -> f64 {
        let samples = (period_s(table) * 4000.0) as usize;
        let power: f64 = (0..samples).map(|n| table.pressure(n as f64 / 4000.0, weights).powi(2)).sum();
        (power / samples as f64).sqrt()
    }

    #[test]
    fn a_sine_of_flux_becomes_its_derivative_without_a_seam() {
        let turns = 20.0;
        let period = (0..360).map(|n| [(turns * std::f64::consts::TAU * f64::from(n) / RATE_HZ).sin() as f32; WAYS]);
        let table = Table::new(RATE_HZ, period.collect());
        assert_eq!(period_s(&table), 1.0);
        let weights = [1.0, 0.0];
        // The kernel leaves images of 20 Hz around 360 Hz: 1.2 % of it.
        let peak = (0..5000).map(|n| table.pressure(f64::from(n) / 5000.0, &weights)).fold(0.0, f64::max);
        for n in -7000..7000 {
            let time_s = f64::from(n) / 5000.0;
            let expected = peak * (turns * std::f64::consts::TAU * time_s).cos();
            let found = table.pressure(time_s, &weights);
            assert!((found - expected).abs() < 0.015 * peak, "at {time_s} s: {found}, expected {expected}");
            let later = table.pressure(time_s + 1000.0, &weights);
            assert!((found - later).abs() < 1e-6, "at {time_s} s: {found}, a thousand periods later {later}");
        }
    }

    #[test]
    fn constant_flux_is_silent() {
        let table = Table { rate_hz: RATE_HZ, steps: vec![[1.0; WAYS]; 40], gain: 1.0 };
        for n in 0..1000 {
            let pressure = table.pressure(f64::from(n) * 0.001, &[0.25; WAYS]);
            assert!(pressure.abs() < 1e-14, "{pressure}");
        }
    }

    #[test]
    fn every_scene_is_there_at_its_level_in_every_way() {
        let tables = tables().expect("factory drives");
        assert_eq!(tables.len(), SCENES.len());
        for (scene, table) in SCENES.iter().zip(tables) {
            assert!((8.0..=11.0).contains(&period_s(table)), "{scene}: {} s", period_s(table));
            let plain = rms(table, &[1.0, 0.0]);
            assert!((0.02..=RMS).contains(&plain), "{scene}: {plain}");
            let windy = rms(table, &[0.0, 1.0]);
            assert!(windy > 0.2 * plain, "{scene}: {windy} in wind beside {plain}");
        }
    }

    #[test]
    fn file_that_is_not_a_drive_is_refused() {
        let wav = |channels: u16, steps: usize| {
            let spec = hound::WavSpec {
                channels,
                sample_rate: 360,
                bits_per_sample: 16,
                sample_format: hound::SampleFormat::Int,
            };
            let mut bytes = Cursor::new(vec![]);
            let mut writer = hound::WavWriter::new(&mut bytes, spec).expect("a writer");
            (0..steps * usize::from(channels)).for_each(|_| writer.write_sample(1i16).expect("written"));
            writer.finalize().expect("finished");
            bytes.into_inner()
        };
        assert!(Table::read("candle", &wav(2, 100)).is_ok());
        for bad in [vec![], b"RIFF".to_vec(), wav(3, 100), wav(2, 3), wav(2, 100)[..100].to_vec()] {
            let error = Table::read("candle", &bad).expect_err("refused");
            assert!(error.to_string().contains("candle"), "{error}");
        }
    }
}
