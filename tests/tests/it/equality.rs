//! A bounce through the bundles is what `pyrophone render` writes, bit for bit.

use std::path::Path;
use std::process::Command;

use pyrophone_host::bounce::{AutomationPoint, BlockSize, BounceOptions};
use pyrophone_host::{BusLayout, Format, numeric_id};
use pyrophone_settings::{Id, Preset};
use pyrophone_tests::{
    MONO, RATE_HZ, STEREO, await_recording, command_line, differing, flame, is_soak, learned, load_session, open, peak,
    play, preset, recording, reference, session, write_wav,
};

const AUTOMATION: &str = "\
sample,id,value
1000,alpha,3.5
1000,scaling_alpha,0.25
13333,alpha,2.0
20001,scaling_alpha,0.9
20001,texture_level,-6
31007,alpha,4.0
40000,cutoff,240
";

fn render(folder: &Path, preset: &str, training: &Path, automation: Option<&Path>, channels: usize) -> Vec<Vec<f32>> {
    let output = folder.join("rendered.wav");
    let mut command = Command::new(command_line());
    command.args(["render", "--preset", preset, "--channels", &channels.to_string()]);
    command.arg("--input").arg(folder.join("input.wav")).arg("--training").arg(training);
    command.arg("--output").arg(&output);
    // What many presets learn alike is learnt once: for all tests, where they have a folder, else for these.
    if std::env::var_os("PYROPHONE_CACHE").is_none_or(|folder| folder.is_empty()) {
        command.env("PYROPHONE_CACHE", folder.join("cache"));
    }
    if let Some(automation) = automation {
        command.arg("--automation").arg(automation);
    }
    let done = command.output().expect("the command line runs");
    assert!(done.status.success(), "{preset}: {}", String::from_utf8_lossy(&done.stderr));
    let (channels, _) = reference::read_wav(&output);
    channels.iter().map(|x| x.iter().map(|x| *x as f32).collect()).collect()
}

#[test]
fn every_preset_in_mono_is_the_command_lines() {
    every_preset_in_every_format_with_and_without_automation(1, MONO);
}

#[test]
fn every_preset_in_stereo_is_the_command_lines() {
    every_preset_in_every_format_with_and_without_automation(2, STEREO);
}

fn every_preset_in_every_format_with_and_without_automation(inputs: usize, layout: BusLayout) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let training = recording(folder.path(), "training.wav", 2, 60_000);
    let csv = folder.path().join("automation.csv");
    std::fs::write(&csv, AUTOMATION).expect("written");
    let points: Vec<(i64, &str, &str)> = AUTOMATION
        .lines()
        .skip(1)
        .map(|line| {
            let mut fields = line.split(',');
            let mut next = || fields.next().expect("three fields");
            (next().parse().expect("a sample"), next(), next())
        })
        .collect();
    let presets = Preset::factory().expect("factory presets");
    assert!(presets.len() >= 4);
    let input = flame(7, inputs, 50_000);
    write_wav(&folder.path().join("input.wav"), &input, RATE_HZ as u32);
    // An instance that lives on until the next one has its recording shares what was learnt with it.
    let mut alive = Format::ALL.map(open);
    for (number, factory) in presets.iter().enumerate() {
        for automated in [false, true] {
            // Each preset with automation in one layout and without in the other; all with all in the long tests only.
            if !is_soak() && automated == (number + inputs).is_multiple_of(2) {
                continue;
            }
            let automation = automated.then_some(csv.as_path());
            let expected = render(folder.path(), &factory.name, &training, automation, inputs);
            assert!(peak(&expected[0]) > 1e-3, "{} is silent", factory.name);
            let values = preset(&factory.name, &[]);
            let is_learned = values.get(Id::DynamicRange) == 1.0;
            let learned = is_learned.then(|| learned(&values, &input, RATE_HZ));
            let session = session(Some(&training), learned);
            for (side, (alive, format)) in alive.iter_mut().zip(Format::ALL).enumerate() {
                let mut blocks = vec![BlockSize::Fixed(64), BlockSize::Random { seed: 5, max: 3000 }];
                if !is_soak() {
                    // Each preset in one format in mono and in the other in stereo, in one of the blocks; all of it in the
                    // long tests only. Halves and quarters, so that every format meets every block and automation.
                    if !(number / 2 + side + inputs).is_multiple_of(2) {
                        continue;
                    }
                    blocks = vec![blocks.swap_remove((number / 4 + side) % 2)];
                }
                for block in blocks {
                    let mut plugin = open(format);
                    load_session(plugin.as_mut(), &values, &session);
                    await_recording(plugin.as_mut(), RATE_HZ, layout);
                    let automation = points.iter().filter(|_| automated).map(|(sample, id, text)| {
                        let id = numeric_id(id);
                        AutomationPoint { sample: *sample, id, value: plugin.parse(id, text).expect("a value") }
                    });
                    let options = BounceOptions {
                        block: block.clone(),
                        automation: automation.collect(),
                        offline: false,
                        ..BounceOptions::new(RATE_HZ, layout)
                    };
                    let output = play(plugin.as_mut(), &input, &options);
                    let context = format!("{}, {format}, {block:?}, automated {automated}", factory.name);
                    for (channel, (found, expected)) in output.iter().zip(&expected).enumerate() {
                        assert_eq!(differing(found, expected), 0, "{context}, channel {channel}");
                    }
                    *alive = plugin;
                }
            }
        }
    }
}
