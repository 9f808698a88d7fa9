//! Channels, sidechain, in place or not, blocks of any size, silence, and input that is no sound.

use pyrophone_host::bounce::{BlockSize, BounceOptions, bounce};
use pyrophone_host::{BusLayout, Format, Plugin, Tail};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    MONO, RATE_HZ, STEREO, assert_same, assert_sounds, await_recording, differing, flame, is_soak, load_session, open,
    part, peak, play, preset, recording, session,
};

const fn layout(input: u32, sidechain: u32, output: u32) -> BusLayout {
    BusLayout { input, sidechain, output }
}

const LAYOUTS: [BusLayout; 8] = [
    layout(1, 0, 1),
    layout(1, 0, 2),
    layout(2, 0, 2),
    layout(1, 1, 1),
    layout(1, 1, 2),
    layout(2, 2, 2),
    layout(6, 6, 6),
    layout(2, 0, 6),
];

/// The channel of low-frequency effects of 5.1.
const EFFECTS: usize = 3;

struct Studio {
    folder: tempfile::TempDir,
    /// While they have the recording, others need not learn from it anew.
    _keepers: Vec<Box<dyn Plugin>>,
}

impl Studio {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        recording(folder.path(), "fire.wav", 2, 40_000);
        let mut studio = Self { folder, _keepers: Vec::new() };
        studio._keepers = Format::ALL.map(|format| studio.instance(format, "default", &[], STEREO)).into();
        studio
    }

    fn instance(&self, format: Format, name: &str, changes: &[(&str, &str)], layout: BusLayout) -> Box<dyn Plugin> {
        let mut plugin = open(format);
        let session = session(Some(&self.folder.path().join("fire.wav")), None);
        load_session(plugin.as_mut(), &preset(name, changes), &session);
        await_recording(plugin.as_mut(), RATE_HZ, layout);
        plugin
    }
}

fn play_all(
    plugin: &mut dyn Plugin,
    input: &[Vec<f32>],
    sidechain: &[Vec<f32>],
    options: &BounceOptions,
) -> Vec<Vec<f32>> {
    let sidechain = (options.layout.sidechain > 0).then_some(sidechain);
    bounce(plugin, input, sidechain, options).unwrap_or_else(|error| panic!("{error}")).channels
}

#[test]
fn any_block_size_in_place_or_not_gives_the_same() {
    let studio = Studio::new();
    for format in Format::ALL {
        for (number, layout) in LAYOUTS.into_iter().enumerate() {
            let input = flame(61, layout.input as usize, 20_000);
            let sidechain = flame(62, layout.sidechain as usize, 20_000);
            let mut plugin = studio.instance(format, "default", &[], layout);
            let options =
                |block: BlockSize, in_place| BounceOptions { block, in_place, ..BounceOptions::new(RATE_HZ, layout) };
            let expected = play_all(plugin.as_mut(), &input, &sidechain, &options(BlockSize::Fixed(512), false));
            // That channel is silent where the input has none like it.
            let burning = |mut channels: Vec<Vec<f32>>| {
                if layout.output == 6 {
                    channels.remove(EFFECTS);
                }
                channels
            };
            let expected = burning(expected);
            assert_sounds(&part(&expected, 4000..20_000), 2000, &format!("{format}, {layout}"));
            let blocks = [
                BlockSize::Cycle(vec![0, 1, 2, 17, 0, 64, 480, 1024, 4096, 8192]),
                BlockSize::Fixed(8192),
                BlockSize::Random { seed: 9, max: 700 },
                BlockSize::Fixed(1),
            ];
            for (block, is_even) in blocks.into_iter().zip([true, false].into_iter().cycle()) {
                // Every block is tried both ways, but only in the long tests in every layout.
                for in_place in if is_soak() { vec![false, true] } else { vec![is_even == number.is_multiple_of(2)] } {
                    let found = play_all(plugin.as_mut(), &input, &sidechain, &options(block.clone(), in_place));
                    let found = burning(found);
                    assert_same(&found, &expected, &format!("{format}, {layout}, {block:?}, in place {in_place}"));
                }
            }
        }
    }
}

#[test]
fn the_sidechain_is_not_heard_unless_the_drive_is_its_envelope() {
    let studio = Studio::new();
    for format in Format::ALL {
        for (with, without) in [(layout(1, 1, 1), MONO), (layout(1, 1, 2), layout(1, 0, 2)), (layout(2, 2, 2), STEREO)]
        {
            let input = flame(63, with.input as usize, 20_000);
            let sidechain = flame(64, with.sidechain as usize, 20_000);
            let mut plugin = studio.instance(format, "default", &[], with);
            let connected = play_all(plugin.as_mut(), &input, &sidechain, &BounceOptions::new(RATE_HZ, with));
            let unconnected = play_all(plugin.as_mut(), &input, &[], &BounceOptions::new(RATE_HZ, without));
            assert_same(&connected, &unconnected, &format!("{format}, {with}"));
        }
    }
}

#[test]
fn the_sidechains_envelope_makes_fire() {
    let studio = Studio::new();
    let (quiet, loud) = (20_000, 50_000);
    for format in Format::ALL {
        for layout in [layout(1, 1, 1), layout(1, 1, 2), layout(2, 2, 2)] {
            let silence = vec![vec![0.0; 100_000]; layout.input as usize];
            // A sound of no low frequencies at all: 3 kHz, for a while.
            let burst: Vec<f32> = (0..100_000)
                .map(|i| {
                    if (quiet..loud).contains(&i) {
                        0.5 * (i as f32 * 3000.0 * std::f32::consts::TAU / 44_100.0).sin()
                    } else {
                        0.0
                    }
                })
                .collect();
            let sidechain = vec![burst; layout.sidechain as usize];
            for name in ["extend", "texture"] {
                let context = format!("{format}, {layout}, {name}");
                let changes = [("drive_mode", "envelope"), ("threshold", "-40"), ("release", "20")];
                let mut plugin = studio.instance(format, name, &changes, layout);
                let options = BounceOptions::new(RATE_HZ, layout);
                let output = play_all(plugin.as_mut(), &silence, &sidechain, &options);
                assert_sounds(&part(&output, quiet + 4000..loud), 4000, &context);
                for channel in &output {
                    // Texture reaches about its longest window ahead of what it follows.
                    assert!(peak(&channel[..quiet - 8000]) < 1e-3 * peak(channel), "{context}: sound before the burst");
                    assert_eq!(peak(&channel[80_000..]), 0.0, "{context}: sound long after the burst");
                }
                let unmoved = play_all(plugin.as_mut(), &silence, &silence[..layout.sidechain as usize], &options);
                assert!(unmoved.iter().all(|channel| peak(channel) == 0.0), "{context}: sound from silence");
            }
        }
    }
}

#[test]
fn one_channel_becomes_two_different_ones() {
    let studio = Studio::new();
    let layout = layout(1, 0, 2);
    let input = flame(65, 1, 40_000);
    for format in Format::ALL {
        for name in ["extend", "texture"] {
            let wide =
                play(studio.instance(format, name, &[], layout).as_mut(), &input, &BounceOptions::new(RATE_HZ, layout));
            assert!(differing(&wide[0], &wide[1]) > 20_000, "{format}, {name}");
            let changes = [("extension_width", "0"), ("texture_width", "0")];
            let mut narrow = studio.instance(format, name, &changes, layout);
            let narrow = play(narrow.as_mut(), &input, &BounceOptions::new(RATE_HZ, layout));
            assert_same(&narrow[..1], &narrow[1..], &format!("{format}, {name}"));
        }
    }
}

#[test]
fn every_loudspeaker_burns_by_itself_and_low_frequency_effects_pass() {
    let studio = Studio::new();
    for format in Format::ALL {
        for layout in [layout(6, 6, 6), layout(6, 0, 6), layout(2, 2, 6), layout(1, 0, 6), layout(5, 5, 5)] {
            let context = format!("{format}, {layout}");
            let input = flame(66, layout.input as usize, 40_000);
            let mut plugin = studio.instance(format, "default", &[("vortex_level", "0")], layout);
            let output = play(plugin.as_mut(), &input, &BounceOptions::new(RATE_HZ, layout));
            assert_eq!(output.len(), layout.output as usize, "{context}");
            let effects = (layout.output == 6).then_some(EFFECTS);
            let burning: Vec<usize> = (0..output.len()).filter(|channel| Some(*channel) != effects).collect();
            for (a, b) in burning.iter().flat_map(|a| burning.iter().map(move |b| (*a, *b))).filter(|(a, b)| a < b) {
                assert!(differing(&output[a], &output[b]) > 20_000, "{context}: channels {a} and {b}");
            }
            if let Some(effects) = effects {
                let silence = vec![0.0; 40_000];
                let passed = input.get(EFFECTS).unwrap_or(&silence);
                assert_eq!(differing(&output[effects], passed), 0, "{context}: low-frequency effects");
            }
        }
    }
}

#[test]
fn after_the_tail_comes_silence() {
    let studio = Studio::new();
    for format in Format::ALL {
        for name in ["default", "extend", "texture"] {
            let mut live = Live::start(studio.instance(format, name, &[], STEREO), RATE_HZ, STEREO);
            let context = format!("{format}, {name}");
            let zeros = vec![vec![0.0; 8192]; 2];
            assert!(
                live.play(&zeros, Clock::Playing(0), 512).iter().all(|x| peak(x) == 0.0),
                "{context}: from silence"
            );
            let input = flame(66, 2, 40_000);
            let output = live.play(&input, Clock::Playing(8192), 512);
            assert_sounds(&part(&output, 10_000..40_000), 5000, &context);
            let Tail::Samples(tail) = live.tail() else { panic!("{context}: no end") };
            assert!((1000..200_000).contains(&tail), "{context}: a tail of {tail}");
            let silence = vec![vec![0.0; 130_000]; 2];
            let ringing = live.play(&silence, Clock::Playing(48_192), 512);
            for channel in &ringing {
                let last = channel.iter().rposition(|x| *x != 0.0).expect("it rings");
                let (loudest, left) = (peak(&output[0]), peak(&channel[tail as usize..]));
                println!("{context}: tail of {tail}, silent after {last}, {left} of {loudest} left after the tail");
                // What the filters still hold then is inaudible.
                assert!(left < 1e-5 * loudest, "{context}: {left} after a tail of {tail}");
                assert!(last > 1000, "{context}: cut off");
                assert!(last < 60_000, "{context}: still sounding after {last}");
            }
            assert_eq!(live.tail(), Tail::Samples(0), "{context}: not asleep");
            let again = live.play(&input, Clock::Playing(178_192), 512);
            assert_sounds(&part(&again, 10_000..40_000), 5000, &format!("{context}, awake again"));
            drop(live.stop());
        }
    }
}

#[test]
fn a_flame_burns_over_silence_without_end() {
    let studio = Studio::new();
    for format in Format::ALL {
        for (name, intensity) in [("flame", "1"), ("extend", "1"), ("flame", "0")] {
            let context = format!("{format}, {name}, intensity {intensity}");
            let changes = [("drive_mode", "flame"), ("flame_intensity", intensity)];
            let mut live = Live::start(studio.instance(format, name, &changes, STEREO), RATE_HZ, STEREO);
            let silence = vec![vec![0.0; 480_000]; 2];
            let output = live.play(&silence, Clock::Playing(0), 512);
            if intensity == "0" {
                assert!(output.iter().all(|channel| peak(channel) == 0.0), "{context}");
            } else {
                assert_sounds(&part(&output, 5000..480_000), 20_000, &context);
            }
            // A flame that is out may be lit at any time.
            assert_eq!(live.tail(), Tail::Infinite, "{context}");
            drop(live.stop());
        }
    }
}

#[test]
fn input_that_is_no_sound_stays_outside() {
    let studio = Studio::new();
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE / 2.0, -0.0];
    for format in Format::ALL {
        for mode in ["pressure", "flux", "envelope"] {
            let layout = layout(2, 2, 2);
            let mut plugin = studio.instance(format, "default", &[("drive_mode", mode)], layout);
            let options = BounceOptions { extra_after: 10_000, ..BounceOptions::new(RATE_HZ, layout) };
            let mut input = flame(67, 2, 40_000);
            let mut sidechain = flame(68, 2, 40_000);
            let clean = play_all(plugin.as_mut(), &input, &sidechain, &options);
            for (index, value) in bad.iter().enumerate() {
                input[index % 2][5000 + 333 * index..][..100].fill(*value);
                sidechain[(index + 1) % 2][5000 + 333 * index..][..100].fill(*value);
            }
            let output = play_all(plugin.as_mut(), &input, &sidechain, &options);
            for channel in &output {
                assert!(channel.iter().all(|x| x.is_finite()), "{format}, {mode}: not a number came out");
                assert!(peak(&channel[30_000..40_000]) > 1e-5, "{format}, {mode}: silent ever after");
            }
            let again = play_all(plugin.as_mut(), &flame(67, 2, 40_000), &flame(68, 2, 40_000), &options);
            assert_same(&again, &clean, &format!("{format}, {mode}, after it"));
        }
    }
}

#[test]
fn bypass_is_the_input_delayed() {
    let studio = Studio::new();
    for format in Format::ALL {
        for layout in LAYOUTS {
            let input = flame(69, layout.input as usize, 20_000);
            let sidechain = flame(70, layout.sidechain as usize, 20_000);
            let mut plugin = studio.instance(format, "default", &[("bypass", "on")], layout);
            let output = play_all(plugin.as_mut(), &input, &sidechain, &BounceOptions::new(RATE_HZ, layout));
            for (channel, output) in output.iter().enumerate() {
                let silence = vec![0.0; output.len()];
                let expected = match (&input[..], channel) {
                    ([only], 0 | 1) => only,
                    (all, channel) => all.get(channel).unwrap_or(&silence),
                };
                assert_eq!(differing(output, expected), 0, "{format}, {layout}, channel {channel}");
            }
        }
    }
}
