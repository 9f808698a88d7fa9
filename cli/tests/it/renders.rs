//! Output of the commands: length, rate, channels, and the effect of the options.

use std::path::Path;

use crate::common::{hiss, read, refuses, rumble, succeeds, write};
use pyrophone_synthesis::vortex::SpeedField;
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "mono.wav", &[rumble(30_000, 48_000)], 48_000);
    write(at, "stereo.wav", &[rumble(30_000, 48_000), rumble(30_000, 48_000)], 48_000);
    write(at, "fire.wav", &[hiss(40_000, 1), hiss(40_000, 2)], 44_100);
    write(at, "side.wav", &[hiss(9_000, 4)], 32_000);
    folder
}

fn peak(path: &Path) -> f32 {
    read(path).channels.iter().flatten().fold(0.0, |peak, sample| peak.max(sample.abs()))
}

/// Runs a command with its output, and gives the output's path.
#[track_caller]
fn made(folder: &TempDir, name: &str, arguments: &str) -> std::path::PathBuf {
    succeeds(folder.path(), &format!("{arguments} --output {name}"));
    folder.path().join(name)
}

#[test]
fn a_part_of_the_recording_is_learnt_from_at_its_level() {
    let folder = folder();
    let whole = read(&folder.path().join("fire.wav"));
    let part: Vec<Vec<f32>> = whole.channels.iter().map(|channel| channel[11_025..33_075].to_vec()).collect();
    let half = part.iter().map(|channel| channel.iter().map(|sample| 0.5 * sample).collect()).collect::<Vec<_>>();
    write(folder.path(), "part.wav", &part, 44_100);
    write(folder.path(), "half.wav", &half, 44_100);
    let render = |name: &str, training: &str| {
        read(&made(&folder, name, &format!("render --preset default --input mono.wav --training {training}"))).channels
    };
    let from_part = render("a.wav", "part.wav");
    assert_eq!(render("b.wav", "fire.wav --training-region 0.25-0.75"), from_part);
    assert_eq!(render("c.wav", "half.wav --training-gain 6.020599913279624"), from_part);
    let full = render("d.wav", "part.wav --training-normalise");
    assert_eq!(render("e.wav", "half.wav --training-normalise"), full, "whatever its level was");
    assert_ne!(render("f.wav", "fire.wav"), from_part);
    let run = "render --preset default --input mono.wav --training fire.wav --output g.wav --training-region";
    let duration_s = whole.len_samples() as f64 / 44_100.0;
    let beyond = format!("{run} {}-{}", duration_s + 1.0, duration_s + 2.0);
    refuses(folder.path(), &beyond, 1, &["--training-region is", &format!("{duration_s:.3} s")]);
    succeeds(folder.path(), &format!("{run} 0.25-400"));
}

#[test]
fn a_presets_recording_is_that_of_training() {
    let folder = folder();
    let at = folder.path();
    std::fs::create_dir(at.join("Öfen")).unwrap();
    std::fs::rename(at.join("fire.wav"), at.join("Öfen/fire 火.wav")).unwrap();
    let preset = |name: &str, recording: &str| {
        let text = format!("version = 3\nname = \"{name}\"\n[recording]\n{recording}\n");
        std::fs::write(at.join("Öfen").join(format!("{name}.toml")), text).unwrap();
    };
    preset("part", "file = \"fire 火.wav\"\nregion_s = [0.25, 0.75]\ngain_db = -3.0");
    let render = |name: &str, preset: &str| {
        read(&made(&folder, name, &format!("render --input mono.wav --preset {preset}"))).channels
    };
    let named = render("a.wav", "Öfen/part.toml");
    let given = |part: &str| format!("default --training Öfen/copy-火.wav {part}");
    std::fs::copy(at.join("Öfen/fire 火.wav"), at.join("Öfen/copy-火.wav")).unwrap();
    assert_eq!(render("b.wav", &given("--training-region 0.25-0.75 --training-gain -3")), named);
    let whole = render("c.wav", &given(""));
    assert_ne!(whole, named);
    let instead = "--training Öfen/copy-火.wav";
    assert_eq!(render("d.wav", &format!("Öfen/part.toml {instead}")), whole, "--training wins");
    preset("gone", "file = \"gone.wav\"");
    let run = "render --input mono.wav --output e.wav --preset Öfen/gone.toml";
    refuses(at, run, 1, &["gone.wav: there is no such file", "--training"]);
    preset("itself", "file = \"../mono.wav\"");
    refuses(at, "render --input stereo.wav --output mono.wav --preset Öfen/itself.toml", 1, &["mono.wav"]);
    preset("beyond", "file = \"fire 火.wav\"\nregion_s = [20.0, 30.0]");
    refuses(at, "render --input mono.wav --output f.wav --preset Öfen/beyond.toml", 1, &["region_s", "inside"]);
}

#[test]
fn factory_fire_is_its_presets_sound_and_is_learnt_from_like_a_file() {
    let folder = folder();
    let at = folder.path();
    let render = |name: &str, options: &str| read(&made(&folder, name, &format!("render {options}"))).channels;
    let learnt = render("a.wav", "--preset default --input mono.wav --training factory:grass-fire");
    render("grass.wav", "--preset grass-fire --seconds 24 --sample-rate 48000");
    assert_eq!(render("b.wav", "--preset default --input mono.wav --training grass.wav"), learnt);
    assert_ne!(render("c.wav", "--preset default --input mono.wav --training factory:wet-logs"), learnt);
    // A preset finds it from any folder.
    std::fs::create_dir(at.join("presets")).unwrap();
    let text = "version = 3\nname = \"own\"\n[recording]\nfile = \"factory:grass-fire\"\n";
    std::fs::write(at.join("presets/own.toml"), text).unwrap();
    assert_eq!(render("d.wav", "--preset presets/own.toml --input mono.wav"), learnt);
    let run = "render --preset default --input mono.wav --output e.wav --training factory:gras-fire";
    refuses(at, run, 1, &["did you mean `grass-fire`", "hearth"]);
}

/// Settings that leave vortex sound alone.
const WHOOSH: &str = "--set texture_level=off --set vortex_level=0 --set threshold=off";

#[test]
fn vortex_sound_has_its_direction_in_every_layout() {
    let folder = folder();
    // Channels in the order of the layout, those that face an azimuth, and those that stay silent.
    for (number, (channels, azimuth, louder, silent)) in [
        (1, 0.0, vec![0], vec![]),
        (2, -30.0, vec![0], vec![]),
        (2, 30.0, vec![1], vec![]),
        (6, 0.0, vec![2], vec![3]),
        (6, 110.0, vec![5], vec![3]),
        (8, -135.0, vec![4], vec![3]),
        (8, 90.0, vec![7], vec![3]),
        (10, -90.0, vec![6], vec![3]),
    ]
    .into_iter()
    .enumerate()
    {
        let place = format!("--set vortex_azimuth={azimuth} --set vortex_spread=0 --set vortex_distance=10");
        let command = format!("render --preset default --input mono.wav --channels {channels} {WHOOSH} {place}");
        let output = read(&made(&folder, &format!("place_{number}.wav"), &command));
        assert_eq!(output.channels.len(), channels, "{command}");
        let power = |channel: usize| output.channels[channel].iter().map(|x| x * x).sum::<f32>();
        let most = (0..channels).max_by(|a, b| power(*a).total_cmp(&power(*b))).unwrap();
        assert!(louder.contains(&most) && power(most) > 0.0, "{command}: channel {most} is the loudest");
        assert!(silent.iter().all(|channel: &usize| power(*channel) == 0.0), "{command}: the LFE channel sounds");
    }
}

#[test]
fn a_speed_field_is_written_by_simulate_and_heard_by_render() {
    let folder = folder();
    succeeds(folder.path(), "simulate campfire --seconds 0.5 --resolution 16 --speed-field gas.field --output p.wav");
    let field = "--set vortex_flow=field --speed-field gas.field";
    let heard = made(&folder, "field.wav", &format!("render --preset default --input mono.wav {WHOOSH} {field}"));
    assert!(peak(&heard) > 1e-6, "silence");
    let envelope = made(&folder, "envelope.wav", &format!("render --preset default --input mono.wav {WHOOSH}"));
    let live =
        made(&folder, "live.wav", &format!("render --preset default --input mono.wav {WHOOSH} --set vortex_flow=live"));
    let sounds = [&heard, &envelope, &live].map(|path| read(path).channels);
    assert!(sounds[0] != sounds[1] && sounds[1] != sounds[2]);
    // A later place on the timeline starts the field later.
    succeeds(
        folder.path(),
        "simulate campfire --seconds 0.5 --resolution 16 --time-reference 44100 --speed-field later.field --output p.wav",
    );
    let later = std::fs::read(folder.path().join("later.field")).unwrap();
    let gas = std::fs::read(folder.path().join("gas.field")).unwrap();
    assert_eq!((&later[..16], &later[24..]), (&gas[..16], &gas[24..]));
    assert_eq!(f64::from_le_bytes(later[16..24].try_into().unwrap()), 1.0);
}

/// Speeds of a source, step by step.
fn course(field: &SpeedField, source: usize) -> impl Iterator<Item = f32> {
    field.speeds().iter().skip(source).step_by(field.sources()).copied()
}

/// Sources of two fields that stand at the same places.
fn same_places(a: &SpeedField, b: &SpeedField) -> Vec<(usize, usize)> {
    let is_same = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
    let partner = |place: [f32; 3]| b.positions().iter().position(|other| is_same(place, *other));
    a.positions().iter().enumerate().filter_map(|(source, place)| Some((source, partner(*place)?))).collect()
}

#[test]
fn flux_writes_the_speed_field_that_simulate_does() {
    let folder = folder();
    // Fine enough for speeds at voxels' centres to be much like those at their faces, and long enough for the whole box
    // to move: between bursts much of it is near the edge of what counts as moving.
    succeeds(
        folder.path(),
        "simulate campfire --seconds 0.4 --resolution 24 --cache frames --speed-field a.field --output p.wav",
    );
    succeeds(folder.path(), "flux --input frames --speed-field b.field --output q.wav");
    let [a, b] = ["a.field", "b.field"]
        .map(|name| SpeedField::from_bytes(&std::fs::read(folder.path().join(name)).unwrap()).unwrap());
    assert_eq!((a.steps(), a.rate_hz(), a.start_s()), (b.steps(), b.rate_hz(), b.start_s()));
    // The same sub-volumes of the same gas, whose velocities the cache has at the voxels' centres instead of their faces.
    let pairs = same_places(&a, &b);
    for (one, other, pairs) in [(&a, &b, pairs.clone()), (&b, &a, pairs.iter().map(|(a, b)| (*b, *a)).collect())] {
        assert!(pairs.len() + 4 > other.sources(), "{} of {} and {}", pairs.len(), one.sources(), other.sources());
        // A sub-volume that one of them has alone lies at the edge of what counts as moving, a twentieth of the fastest. At
        // the box's sides the cache's samples end half a voxel inside, and speeds come out as low as half.
        let top = one.speeds().iter().copied().fold(0.0f32, f32::max);
        for alone in (0..one.sources()).filter(|source| pairs.iter().all(|(paired, _)| paired != source)) {
            let fastest = course(one, alone).fold(0.0f32, f32::max);
            assert!(fastest < 0.12 * top, "{fastest} of {top} m/s");
        }
    }
    let dot = |a: &SpeedField, b: &SpeedField, pairs: &[(usize, usize)]| -> f64 {
        let products = pairs.iter().flat_map(|(one, other)| course(a, *one).zip(course(b, *other)));
        products.map(|(a, b)| f64::from(a * b)).sum()
    };
    let own = |field: &SpeedField, of: fn(&(usize, usize)) -> usize| {
        let own: Vec<(usize, usize)> = pairs.iter().map(|pair| (of(pair), of(pair))).collect();
        dot(field, field, &own)
    };
    let alike = dot(&a, &b, &pairs) / (own(&a, |pair| pair.0) * own(&b, |pair| pair.1)).sqrt();
    assert!(alike > 0.97, "{alike}");
    // A gap of frames that are missing is held, and what comes after it stays in its place.
    for number in 24..36 {
        std::fs::remove_file(folder.path().join(format!("frames/campfire_{number:06}.npz"))).unwrap();
    }
    succeeds(folder.path(), "flux --input frames --skip-bad --speed-field c.field --output r.wav");
    let c = SpeedField::from_bytes(&std::fs::read(folder.path().join("c.field")).unwrap()).unwrap();
    let step = |field: &SpeedField, step: usize| field.speeds()[step * field.sources()..][..field.sources()].to_vec();
    assert_eq!(c.steps(), b.steps());
    assert!(step(&c, 2) == step(&c, 1) && step(&c, 1) == step(&b, 1) && step(&c, 4) == step(&b, 4));
}

#[test]
fn length_rate_and_channels() {
    let folder = folder();
    for (number, (arguments, channels)) in [
        ("texture --input mono.wav --training fire.wav", 2),
        ("texture --input stereo.wav --training side.wav", 1),
        ("extend --input mono.wav", 1),
        ("extend --input stereo.wav", 2),
        ("extend --reference --input stereo.wav", 2),
        ("render --preset default --input mono.wav --training fire.wav", 1),
        ("render --preset default --input mono.wav --training fire.wav --channels 2", 2),
        ("render --preset default --input stereo.wav --training fire.wav", 2),
        ("render --preset extend --input mono.wav --sidechain side.wav --set drive_mode=envelope", 1),
        ("render --preset texture-paper --input mono.wav --training fire.wav --dynamic-range running", 1),
    ]
    .iter()
    .enumerate()
    {
        let path = made(&folder, &format!("{number}.wav"), arguments);
        let output = read(&path);
        assert_eq!(
            (output.sample_rate_hz, output.len_samples(), output.channels.len()),
            (48_000, 30_000, *channels),
            "{arguments}"
        );
        assert!(peak(&path) > 1e-3, "{arguments}: silence");
    }
}

#[test]
fn the_same_twice_and_other_with_another_seed() {
    let folder = folder();
    let once = std::fs::read(made(&folder, "1.wav", "extend --input mono.wav")).unwrap();
    let twice = std::fs::read(made(&folder, "2.wav", "extend --input mono.wav --seed 42")).unwrap();
    let other = std::fs::read(made(&folder, "3.wav", "extend --input mono.wav --seed 43")).unwrap();
    assert_eq!(once, twice);
    assert_ne!(once, other);
}

#[test]
fn low_part_of_the_extension_is_in_time() {
    let folder = folder();
    let path = made(&folder, "low.wav", "extend --input mono.wav --noise-amplitude 0 --cutoff 400 --fit-center 400");
    let (input, output) = (rumble(30_000, 48_000), read(&path));
    for (n, (output, input)) in output.channels[0].iter().zip(&input).enumerate().take(24_000).skip(6000) {
        assert!((output - input).abs() < 0.005, "sample {n}: {output} instead of {input}");
    }
}

#[test]
fn settings_and_automation_act() {
    let folder = folder();
    // Without the ceiling, which bends what is loud.
    let plain = "render --preset extend --input mono.wav --set ceiling=off --set output_level=0";
    let unautomated = read(&made(&folder, "plain.wav", plain));
    let silent = made(&folder, "off.wav", "render --preset extend --input mono.wav --set output_level=-60");
    assert!(peak(&silent) < 0.002 * unautomated.channels[0].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs())));

    std::fs::write(folder.path().join("steps.csv"), "sample,id,value\n15000,output_level,-60\n").unwrap();
    let stepped = format!("{plain} --automation steps.csv");
    let stepped = read(&made(&folder, "stepped.wav", &stepped));
    assert_eq!(stepped.channels[0][..14_000], unautomated.channels[0][..14_000]);
    for (stepped, plain) in stepped.channels[0].iter().zip(&unautomated.channels[0]).skip(18_000) {
        assert!(
            (stepped - 0.001 * plain).abs() < 1e-4 * plain.abs() + 1e-7,
            "{stepped} after the step, {plain} without"
        );
    }
}

#[test]
fn learning_from_the_input_is_the_default() {
    let folder = folder();
    let render = "render --preset texture --training fire.wav --input mono.wav --dynamic-range learned";
    let pass = std::fs::read(made(&folder, "pass.wav", render)).unwrap();
    let same = std::fs::read(made(&folder, "same.wav", &format!("{render} --learn mono.wav"))).unwrap();
    let other = std::fs::read(made(&folder, "other.wav", &format!("{render} --learn side.wav"))).unwrap();
    assert_eq!(pass, same);
    assert_ne!(pass, other);
}

#[test]
fn bypass_is_the_input() {
    let folder = folder();
    let path = made(&folder, "dry.wav", "render --preset default --training fire.wav --input mono.wav --set bypass=on");
    assert_eq!(read(&path).channels, [rumble(30_000, 48_000)]);
}

#[test]
fn betas_without_reference() {
    let folder = folder();
    made(&folder, "out.wav", "extend --input mono.wav --betas betas.csv");
    let text = std::fs::read_to_string(folder.path().join("betas.csv")).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    // 500 samples at 44.1 kHz are 544 at 48 kHz.
    assert_eq!(rows[0], "window,time_s,beta");
    assert_eq!(rows.len(), 1 + 30_000usize.div_ceil(544) + 1);
    assert!(rows[2].starts_with("1,0.01133333"), "{}", rows[2]);
    let betas: Vec<f64> = rows[1..].iter().map(|row| row.rsplit(',').next().unwrap().parse().unwrap()).collect();
    assert!(betas[5..50].iter().all(|beta| *beta > 0.0), "{betas:?}");
}

#[test]
fn ignored_inputs_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "in.wav", &[rumble(4_800, 48_000)], 48_000);
    let notes = |options: &str| {
        let run = format!("render --preset hearth --input in.wav --output o.wav {options}");
        let output = crate::common::pyrophone(folder.path(), &run);
        assert!(output.status.success(), "{run}");
        String::from_utf8(output.stderr).unwrap()
    };
    let found = notes("--sidechain in.wav");
    assert!(found.contains("only sets length") && found.contains("the sidechain is not used"), "{found}");
    let found = notes("--sidechain in.wav --set drive_mode=envelope");
    assert!(!found.contains("only sets length") && !found.contains("is not used"), "{found}");
}
