//! Transport stopped, looping, jumping, negative and absent, in both formats.

use pyrophone_host::bounce::{AutomationPoint, BounceOptions};
use pyrophone_host::{Format, Plugin, numeric_id};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    RATE_HZ, STEREO, assert_same, await_recording, differing, flame, load_session, open, part, play, preset, recording,
    session,
};

const BLOCK: usize = 480;
/// Length of the crossfade after a jump, in samples.
const CROSSFADE: usize = 441;

/// A place for the recording, and instances with both engines and that recording.
struct Studio {
    folder: tempfile::TempDir,
    /// While they have the recording, others need not learn from it anew.
    _keepers: Vec<Box<dyn Plugin>>,
}

impl Studio {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        recording(folder.path(), "fire.wav", 2, 60_000);
        let mut studio = Self { folder, _keepers: Vec::new() };
        studio._keepers = Format::ALL.map(|format| studio.instance(format)).into();
        studio
    }

    fn instance(&self, format: Format) -> Box<dyn Plugin> {
        let mut plugin = open(format);
        let session = session(Some(&self.folder.path().join("fire.wav")), None);
        load_session(plugin.as_mut(), &preset("default", &[]), &session);
        await_recording(plugin.as_mut(), RATE_HZ, STEREO);
        plugin
    }

    fn live(&self, format: Format) -> Live {
        Live::start(self.instance(format), RATE_HZ, STEREO)
    }
}

/// From where on nothing of what was played before a jump is left.
fn settled(live: &mut Live) -> usize {
    live.plugin().latency_samples() as usize + CROSSFADE
}

#[test]
fn passes_of_a_loop_are_identical() {
    let studio = Studio::new();
    let input = flame(11, 2, 40_000);
    for format in Format::ALL {
        for position in [0, 54_321, -7_000] {
            let mut live = studio.live(format);
            let settled = settled(&mut live);
            assert!(settled < 30_000, "the loop is too short for {settled}");
            let mut passes = (0..4).map(|_| live.play(&input, Clock::Playing(position), BLOCK));
            let first = passes.next().expect("a pass");
            for (number, pass) in passes.enumerate() {
                let context = format!("{format} from {position}, pass {}", number + 2);
                assert_same(&part(&pass, settled..40_000), &part(&first, settled..40_000), &context);
            }
        }
    }
}

#[test]
fn a_loop_of_odd_length_in_odd_blocks_is_the_same_loop() {
    let studio = Studio::new();
    let input = flame(12, 2, 33_333);
    for format in Format::ALL {
        let mut live = studio.live(format);
        let settled = settled(&mut live);
        let passes: Vec<_> = [480, 37, 8192].map(|block| live.play(&input, Clock::Playing(777), block)).into();
        for pass in &passes[1..] {
            let tail = settled..33_333;
            assert_same(&part(pass, tail.clone()), &part(&passes[0], tail), &format!("{format}"));
        }
    }
}

#[test]
fn after_a_jump_it_sounds_as_if_started_there() {
    let studio = Studio::new();
    let (before, after) = (flame(13, 2, 20_000), flame(14, 2, 30_000));
    for format in Format::ALL {
        for position in [100_000, 5_000, -30_000, 1_000_003, 20_002] {
            let mut live = studio.live(format);
            let settled = settled(&mut live);
            let old = live.play(&before, Clock::Playing(0), BLOCK);
            let jumped = live.play(&after, Clock::Playing(position), BLOCK);
            let fresh = studio.live(format).play(&after, Clock::Playing(position), BLOCK);
            let context = format!("{format}, jump to {position}");
            assert_same(&part(&jumped, settled..30_000), &part(&fresh, settled..30_000), &context);
            // What was played before the jump still comes out.
            let mut unbroken = studio.live(format);
            assert_same(&unbroken.play(&before, Clock::Playing(0), BLOCK), &old, &context);
            let still = settled - CROSSFADE;
            let rest = unbroken.play(&after, Clock::Playing(20_000), BLOCK);
            assert_same(&part(&jumped, 0..still), &part(&rest, 0..still), &context);
        }
    }
}

#[test]
fn jumps_in_quick_succession_end_where_the_last_one_went() {
    let studio = Studio::new();
    let (scrap, after) = (flame(15, 2, 700), flame(16, 2, 40_000));
    for format in Format::ALL {
        let mut live = studio.live(format);
        let settled = settled(&mut live);
        for jump in 0..40 {
            live.play(&scrap, Clock::Playing(jump * 9_001), 64);
        }
        // A jump during a takeover waits for its end, so the last one begins up to one takeover late; from there on it
        // is a fresh start, seen in the next loop.
        live.play(&after, Clock::Playing(1_000), BLOCK);
        let looped = live.play(&after, Clock::Playing(1_000), BLOCK);
        let fresh = studio.live(format).play(&after, Clock::Playing(1_000), BLOCK);
        assert_same(&part(&looped, settled..40_000), &part(&fresh, settled..40_000), &format!("{format}"));
    }
}

#[test]
fn stopped_or_absent_it_runs_on() {
    let studio = Studio::new();
    let input = flame(17, 2, 40_000);
    for format in Format::ALL {
        let playing = studio.live(format).play(&input, Clock::Playing(0), BLOCK);
        for clock in [Clock::Stopped(0), Clock::Absent] {
            let found = studio.live(format).play(&input, clock, BLOCK);
            assert_same(&found, &playing, &format!("{format}, {clock:?}"));
        }
        for clock in [Clock::Stopped(20_000), Clock::Stopped(-5), Clock::Absent] {
            let mut live = studio.live(format);
            live.play(&part(&input, 0..20_000), Clock::Playing(0), BLOCK);
            let found = live.play(&part(&input, 20_000..40_000), clock, BLOCK);
            assert_same(&found, &part(&playing, 20_000..40_000), &format!("{format}, then {clock:?}"));
        }
    }
}

#[test]
fn a_start_after_a_stop_is_a_fresh_start() {
    let studio = Studio::new();
    let input = flame(18, 2, 30_000);
    for format in Format::ALL {
        let mut live = studio.live(format);
        let settled = settled(&mut live);
        live.play(&input, Clock::Playing(0), BLOCK);
        live.play(&input, Clock::Stopped(30_000), BLOCK);
        let found = live.play(&input, Clock::Playing(30_000), BLOCK);
        let fresh = studio.live(format).play(&input, Clock::Playing(30_000), BLOCK);
        assert_same(&part(&found, settled..30_000), &part(&fresh, settled..30_000), &format!("{format}"));
    }
}

#[test]
fn negative_positions_are_positions() {
    let studio = Studio::new();
    let input = flame(19, 2, 40_000);
    for format in Format::ALL {
        let through_zero = studio.live(format).play(&input, Clock::Playing(-20_000), BLOCK);
        let again = studio.live(format).play(&input, Clock::Playing(-20_000), 8192);
        assert_same(&through_zero, &again, &format!("{format}"));
        let elsewhere = studio.live(format).play(&input, Clock::Playing(-20_500), BLOCK);
        let different = differing(&through_zero[0], &elsewhere[0]);
        assert!(different > 10_000, "{format}: noise must depend on the position, but {different} samples differ");
    }
}

#[test]
fn bounces_repeat_and_offline_is_real_time() {
    let studio = Studio::new();
    let input = flame(20, 2, 40_000);
    for format in Format::ALL {
        let mut plugin = studio.instance(format);
        let options = BounceOptions { start_position: 12_345, ..BounceOptions::new(RATE_HZ, STEREO) };
        let first = play(plugin.as_mut(), &input, &options);
        for offline in [true, false] {
            let options = BounceOptions { offline, ..options.clone() };
            let context = format!("{format}, offline {offline}");
            assert_same(&play(plugin.as_mut(), &input, &options), &first, &context);
            assert_same(&play(studio.instance(format).as_mut(), &input, &options), &first, &context);
        }
    }
}

#[test]
fn bounces_that_start_in_the_same_silence_agree() {
    let studio = Studio::new();
    let mut input = flame(21, 2, 60_000);
    let onset = 30_000;
    input.iter_mut().for_each(|channel| channel[..onset].fill(0.0));
    for format in Format::ALL {
        let bounce_from = |position: usize| {
            let options = BounceOptions { start_position: position as i64, ..BounceOptions::new(RATE_HZ, STEREO) };
            let played = play(studio.instance(format).as_mut(), &part(&input, position..60_000), &options);
            part(&played, onset - position..60_000 - position)
        };
        let from_zero = bounce_from(0);
        for position in [16_000, 500, 128, 20_001] {
            assert_same(&bounce_from(position), &from_zero, &format!("{format} from {position}"));
        }
    }
}

#[test]
fn automation_without_tempo_is_no_jump() {
    let studio = Studio::new();
    let input = flame(22, 2, 40_000);
    for format in Format::ALL {
        let run = |clock: Clock, block: usize| {
            let mut live = studio.live(format);
            let points: Vec<AutomationPoint> = (0..400)
                .map(|step| {
                    let id = numeric_id(["alpha", "scaling_alpha"][step % 2]);
                    AutomationPoint { sample: 50 + 97 * step as i64, id, value: (step % 11) as f64 / 10.0 }
                })
                .collect();
            live.play_automated(&input, clock, block, &points)
        };
        let with_tempo = run(Clock::Playing(300), 64);
        for block in [64, 1000, 8192] {
            let context = format!("{format}, blocks of {block}");
            assert_same(&run(Clock::WithoutTempo(300), block), &with_tempo, &context);
        }
    }
}
