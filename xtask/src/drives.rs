//! `cargo xtask drives`: the built-in flames of the plugin.
//!
//! Each scene is simulated in two ways, and the flux of every step written as a loop: `presets/drives/SCENE.wav`, a
//! channel per way, a sample per step. The local gas speeds, in the flame as designed, are written beside it as a speed
//! field of the same loop: `presets/fields/SCENE.field`. The crate `assets` includes these files in the build.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use hound::{SampleFormat, WavSpec, WavWriter};
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene};
use pyrophone_flame::seam::seamless;
use pyrophone_flame::speed_field::Up;
use pyrophone_recording::write_file;
use pyrophone_synthesis::vortex::{End, SpeedField};

use crate::project;
use crate::simulated::{self, MOTION_RATE_HZ, SimulatedFlame};

/// Length of a loop in seconds, at most: whole periods of scenes that have one.
const LOOP_S: f64 = 10.0;
/// Seconds over which a loop's end fades into its beginning.
const FADE_S: f64 = 1.0;

/// Change of a variant against the scene as designed.
pub type Way = fn(Options) -> Options;

/// Variants in which every scene is simulated, in the order that the synthesis crate expects: as designed, windy.
pub const WAYS: [(&str, Way); 2] =
    [("plain", |designed| designed), ("windy", |designed| Options { wind: 2.0, turbulence: 2.0, ..designed })];

/// Options of `cargo xtask drives`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scenes to simulate, by name [default: all, which takes about 40 minutes on two cores]
    scenes: Vec<String>,
    /// Folder for the folders `drives` and `fields` [default: presets]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Write only the speed fields, for which each scene is simulated only once
    #[arg(long)]
    fields_only: bool,
    /// Cells along the longest side of each scene's box
    #[arg(long, default_value_t = simulated::RESOLUTION)]
    cells: usize,
}

/// Simulates and writes.
pub fn run(args: &Args) -> Result<()> {
    let presets = args.output.clone().unwrap_or_else(|| project::root().join("presets"));
    let (drives, fields) = (presets.join("drives"), presets.join("fields"));
    for folder in [&drives, &fields] {
        std::fs::create_dir_all(folder).with_context(|| format!("creating {}", folder.display()))?;
    }
    for scene in simulated::scenes(&args.scenes)? {
        let wanted = if args.fields_only { 1 } else { WAYS.len() };
        let ways: Vec<SimulatedFlame> = WAYS[..wanted]
            .iter()
            .map(|(way, options)| burn(scene, way, *options, args.cells))
            .collect::<Result<_>>()?;
        let path = fields.join(format!("{}.field", scene.name()));
        let bytes = field(&ways[0])?.to_bytes();
        write_file(&path, |file| file.write_all(&bytes))?;
        println!("{}", path.display());
        if args.fields_only {
            continue;
        }
        let loops: Vec<Vec<f64>> =
            ways.iter().map(|way| seamless(&way.flux, (FADE_S * STEP_RATE_HZ) as usize)).collect();
        let path = drives.join(format!("{}.wav", scene.name()));
        write(&path, &loops).with_context(|| format!("writing {}", path.display()))?;
        println!("{}", path.display());
    }
    Ok(())
}

/// One scene over a loop and the second for its crossfade.
fn burn(scene: Scene, way: &str, options: Way, resolution: usize) -> Result<SimulatedFlame> {
    let options = options(Options { resolution, ..Options::default() });
    // A loop continues from its end, not from an unlit box.
    let pre_roll_s = scene.period_s().unwrap_or(scene.default_pre_roll_s());
    let what = format!("{}, {way}", scene.name());
    simulated::burn(scene, options, pre_roll_s, loop_s(scene) + FADE_S, &what)
}

/// The loop's speed field.
fn field(burnt: &SimulatedFlame) -> Result<SpeedField> {
    let series = |region: usize| {
        let speeds: Vec<f64> = burnt.motion.iter().map(|step| f64::from(step[region])).collect();
        // An equal-power fade may undershoot the slowest speed, and even zero.
        seamless(&speeds, (FADE_S * MOTION_RATE_HZ) as usize).into_iter().map(|speed| speed.max(0.0) as f32)
    };
    let looped: Vec<Vec<f32>> = (0..burnt.regions.len()).map(|region| series(region).collect()).collect();
    let steps = looped.first().map_or(0, Vec::len);
    let steps: Vec<Vec<f32>> = (0..steps).map(|step| looped.iter().map(|series| series[step]).collect()).collect();
    Ok(burnt.regions.field(&steps, MOTION_RATE_HZ, Up::Z, End::Periodic)?)
}

fn loop_s(scene: Scene) -> f64 {
    scene.period_s().map_or(LOOP_S, |period_s| (LOOP_S / period_s).floor() * period_s)
}

/// Writes the variants as channels, as loudly as possible: the sound depends on their slope, at a separate level.
fn write(path: &Path, ways: &[Vec<f64>]) -> Result<()> {
    let steps = ways.iter().map(Vec::len).min().unwrap_or(0);
    let middles: Vec<f64> = ways.iter().map(|way| way.iter().sum::<f64>() / way.len() as f64).collect();
    let beside = |way: usize, step: usize| ways[way][step] - middles[way];
    let largest = (0..ways.len()).flat_map(|way| (0..steps).map(move |step| (way, step)));
    let largest = largest.map(|(way, step)| beside(way, step).abs()).fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        bail!("there is no flame in it");
    }
    let spec = WavSpec {
        channels: ways.len() as u16,
        sample_rate: STEP_RATE_HZ as u32,
        bits_per_sample: 16,
        sample_format: SampleFormat::Int,
    };
    // The old file stays complete until the new one is.
    let partial = path.with_extension("wav.partial");
    let mut writer = WavWriter::create(&partial, spec)?;
    for step in 0..steps {
        for way in 0..ways.len() {
            writer.write_sample((32_767.0 * beside(way, step) / largest).round() as i16)?;
        }
    }
    writer.finalize()?;
    Ok(std::fs::rename(&partial, path)?)
}

#[cfg(test)]
mod tests {
    use pyrophone_flame::pressure::derivative;
    use pyrophone_synthesis::controls::{DriveControls, DriveMode, FlameControls};
    use pyrophone_synthesis::drive::{Drive, SCENES};

    use super::*;

    #[test]
    fn every_scene_has_a_speed_field_as_long_as_its_loop() {
        let presets = crate::project::root().join("presets");
        for scene in Scene::ALL {
            let drive = hound::WavReader::open(presets.join(format!("drives/{}.wav", scene.name()))).unwrap();
            let seconds = f64::from(drive.duration()) / f64::from(drive.spec().sample_rate);
            let field = std::fs::read(presets.join(format!("fields/{}.field", scene.name()))).unwrap();
            let field = SpeedField::from_bytes(&field).unwrap();
            assert_eq!(field.steps() as f64 / field.rate_hz(), seconds, "{}", scene.name());
        }
    }

    #[test]
    fn the_plugin_knows_these_scenes() {
        assert_eq!(Scene::ALL.map(Scene::name), SCENES);
    }

    /// The plugin plays the pressure that the command line makes of the same flux.
    #[test]
    fn the_plugin_plays_the_flux_that_is_written() {
        for (scene, name) in SCENES.iter().enumerate() {
            let mut reader =
                hound::WavReader::open(project::root().join(format!("presets/drives/{name}.wav"))).expect("a drive");
            let rate_hz = f64::from(reader.spec().sample_rate);
            let samples: Vec<f64> = reader.samples::<i16>().map(|x| f64::from(x.expect("a sample"))).collect();
            let plain: Vec<f64> = samples.chunks_exact(WAYS.len()).map(|step| step[0]).collect();
            let pressure = derivative(&plain, rate_hz, 48_000.0);

            let controls = DriveControls {
                mode: DriveMode::Flame,
                high_pass_hz: 0.0,
                flame: FlameControls { scene, ..FlameControls::default() },
                ..DriveControls::default()
            };
            let mut played = vec![0.0; pressure.len()];
            Drive::new(48_000.0).expect("a drive").process(&[], &[], &controls, &mut played);
            // Only near the ends does a loop go on where a series stops.
            let inside = 1000..pressure.len() - 1000;
            let (a, b) = (&pressure[inside.clone()], &played[inside]);
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let scale = product(a, b) / product(a, a);
            let off = a.iter().zip(b).map(|(a, b)| (scale * a - b).abs()).fold(0.0, f64::max);
            let largest = b.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
            assert!(off < 1e-6 * largest, "{name}: off by {off} of {largest}");
        }
    }

    #[test]
    fn loops_are_whole_periods() {
        for scene in Scene::ALL {
            let loop_s = loop_s(scene);
            assert!((8.0..=LOOP_S).contains(&loop_s), "{}: {loop_s}", scene.name());
            let periods = scene.period_s().map_or(1.0, |period_s| loop_s / period_s);
            assert_eq!(periods.fract(), 0.0, "{}", scene.name());
        }
    }

    #[test]
    fn written_drive_is_centred_and_scaled_to_full_range() {
        let folder = std::env::temp_dir().join(format!("pyrophone-drives-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("test.wav");
        let ways: Vec<Vec<f64>> =
            (1..=2).map(|way| (0..100).map(|n| f64::from(7 + way * (n % 10))).collect()).collect();
        write(&path, &ways).expect("written");
        let mut reader = hound::WavReader::open(&path).expect("readable");
        assert_eq!((reader.spec().channels, reader.spec().sample_rate), (2, 360));
        let samples: Vec<i16> = reader.samples().map(|sample| sample.expect("a sample")).collect();
        for (n, step) in samples.chunks_exact(2).enumerate() {
            for (way, sample) in step.iter().enumerate() {
                // The louder variant, twice 0-9, reaches 9 off its middle.
                let expected = (way + 1) as f64 * ((n % 10) as f64 - 4.5) / 9.0 * 32_767.0;
                assert!((f64::from(*sample) - expected).abs() <= 0.51, "step {n}, way {way}: {sample}, {expected}");
            }
        }
        assert!(write(&path, &vec![vec![1.0; 9]; 2]).is_err(), "a flame that does not move is none");
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
