//! Vortex sound as a whole: levels, delays, speeds, blocks, reset, channels, automation.

use std::sync::Arc;

use crate::rendering::*;
use pyrophone_synthesis::controls::{Flow, VortexControls};
use pyrophone_synthesis::vortex::{Bank, End, SPEED_OF_SOUND_M_S, SpeakerLayout, SpeedField, Vortex};

const RATES_HZ: [f64; 3] = [44_100.0, 48_000.0, 96_000.0];

#[test]
fn pressure_falls_with_distance_and_comes_as_much_later() {
    let rate_hz = 48_000.0;
    for exponent in [1.0, 2.0, 3.0] {
        for distance_m in [4.0, 7.5, 16.0] {
            let at = |distance_m: f64| {
                let controls = VortexControls { distance_m, exponent, ..point() };
                render(rate_hz, SpeakerLayout::Mono, &noise_texture(3, 4096), 1, &[], &controls, 48_000).remove(0)
            };
            let (near, far) = (at(distance_m), at(2.0 * distance_m));
            let decibels = 20.0 * (rms(&far) / rms(&near)).log10();
            // The delays differ, so the ends of the stretch do: 1 s is not a whole period of 1.024 s.
            let samples = distance_m / SPEED_OF_SOUND_M_S * rate_hz;
            let (late, gain) = lag(&near, &far, samples.round() as usize);
            assert!((late - samples).abs() < 0.1, "{distance_m} m: {late} instead of {samples} samples");
            let decibels_aligned = 20.0 * gain.log10();
            let expected = -20.0 * exponent * 2f64.log10();
            assert!((decibels_aligned - expected).abs() < 0.05, "n = {exponent}: {decibels_aligned:.3} dB");
            assert!((decibels - expected).abs() < 0.5, "n = {exponent}: {decibels:.3} dB overall");
        }
    }
}

#[test]
fn the_near_field_stays_finite() {
    let level = |distance_m: f64| {
        let controls = VortexControls { distance_m, exponent: 3.0, ..point() };
        rms(&render(48_000.0, SpeakerLayout::Mono, &noise_texture(1, 4096), 1, &[], &controls, 24_000)[0])
    };
    let (at, close, far) = (level(0.0), level(0.1), level(1.0));
    // Softened by 0.25 m: (17 / 1)^1.5 = 70.1.
    assert!(at < 70.5 * far && at > close && close > far, "{at} {close} {far}");
}

#[test]
fn levels_over_speed_are_the_tables() {
    let texture = noise_texture(5, 8192);
    let level = |speed: f64, range: f64| {
        let controls = VortexControls { speed_m_s: speed, range, reference_m_s: 4.0, ..crowd(48) };
        10.0 * power(&render(48_000.0, SpeakerLayout::Mono, &texture, 48, &[], &controls, 96_000)[0]).log10()
    };
    // Rows stand at 1, 2, 4, 8, 16 m/s and rise by 30 dB each.
    let reference = level(4.0, 1.0);
    for (speed, expected) in [(1.0, -60.0), (2.0, -30.0), (8.0, 30.0), (16.0, 60.0), (40.0, 60.0), (0.5, -90.0)] {
        let found = level(speed, 1.0) - reference;
        assert!((found - expected).abs() < 0.8, "{speed} m/s: {found:.2} dB instead of {expected}");
        let half = level(speed, 0.5) - reference;
        assert!((half - 0.5 * expected).abs() < 0.8, "{speed} m/s at half the range: {half:.2} dB");
    }
    // Between rows too: powers add.
    let between = level(4.0 * 2f64.sqrt(), 1.0) - reference;
    assert!((between - 15.0).abs() < 0.8, "{between:.2} dB");
}

#[test]
fn blocks_resets_and_places_on_the_timeline_do_not_matter() {
    let texture = noise_texture(4, 2000);
    for rate_hz in RATES_HZ {
        for channels in [1, 2, 6, 8, 10] {
            for sources in [1, 7, 40] {
                let layout = SpeakerLayout::of_channels(channels).expect("a layout");
                let mut engine = engine(rate_hz, layout, &texture, sources);
                let drive = bursts(12_000);
                let start = 1_000_003;
                engine.reset(start);
                let whole = play(&mut engine, &drive, &busy, [12_000]);
                assert!(rms(&whole[0]) > 0.0);
                for blocks in [vec![1, 0, 17, 64, 333], vec![4096], vec![8192], vec![63, 65]] {
                    engine.reset(start);
                    let cut = play(&mut engine, &drive, &busy, blocks.iter().copied().cycle());
                    assert!(cut == whole, "{rate_hz} Hz, {channels} channels, {sources} sources, blocks {blocks:?}");
                }
                let mut fresh = self::engine(rate_hz, layout, &texture, sources);
                fresh.reset(start);
                assert!(play(&mut fresh, &drive, &busy, [12_000]) == whole, "a fresh one differs");
            }
        }
    }
}

#[test]
fn a_field_is_a_function_of_the_position() {
    let texture = noise_texture(4, 2000);
    for rate_hz in RATES_HZ {
        for end in [End::Periodic, End::Clamped] {
            let mut engine = engine(rate_hz, SpeakerLayout::Stereo, &texture, 9);
            engine.swap_field(Some(Arc::new(wandering(9, 40, end))));
            let controls = VortexControls { flow: Flow::Field, ..VortexControls::default() };
            let mut run = |from: i64, samples: usize| {
                engine.reset(from);
                play(&mut engine, &vec![0.0; samples], &|_| controls, std::iter::repeat(500))
            };
            for from in [0, 70_000, -5000] {
                let whole = run(from, 20_000);
                assert!(rms(&whole[0]) > 0.0);
                for later in [1, 64, 5001, 7777] {
                    let part = run(from + later, 20_000 - later as usize);
                    assert!(part[0] == whole[0][later as usize..], "{rate_hz} Hz, {end:?}, {later} after {from}");
                }
            }
        }
    }
}

#[test]
fn a_tone_that_moves_changes_its_pitch_and_has_no_images() {
    let rate_hz = 48_000.0;
    let samples = 48_000;
    for frequency_hz in [250.0, 1000.0, 1750.0, 1990.0] {
        let texture = tone_texture(frequency_hz);
        for speed_m_s in [-30.0, 0.0, 30.0] {
            let mut engine = engine(rate_hz, SpeakerLayout::Mono, &texture, 1);
            let steps = 121;
            let position = |step: usize| [0.0, 100.0 + (speed_m_s * step as f64 / 60.0) as f32, 0.0];
            let field = SpeedField::new(60.0, 1, (0..steps).map(position).collect(), vec![1.0; steps], End::Clamped);
            engine.swap_field(Some(Arc::new(field.expect("a field"))));
            let controls = VortexControls { flow: Flow::Field, distance_m: 0.0, range: 1.0, ..point() };
            let sound = play(&mut engine, &vec![0.0; samples], &|_| controls, [samples]).remove(0);
            let distance = |at: usize| 100.0 + speed_m_s * at as f64 / rate_hz;
            let flat: Vec<f64> = sound.iter().enumerate().map(|(at, x)| x * distance(at)).collect();
            let expected = frequency_hz * (1.0 - speed_m_s / SPEED_OF_SOUND_M_S);
            let spectrum = spectrum(&flat);
            let peak = (1..spectrum.len()).max_by(|a, b| spectrum[*a].total_cmp(&spectrum[*b])).expect("bins");
            assert!((peak as f64 - expected).abs() <= 1.0, "{frequency_hz} Hz at {speed_m_s} m/s: {peak} Hz");
            let tone: f64 = spectrum[peak.saturating_sub(12)..=peak + 12].iter().sum();
            let rest: f64 = spectrum.iter().sum::<f64>() - tone;
            let down = 10.0 * (tone / rest).log10();
            println!("{frequency_hz} Hz at {speed_m_s} m/s: all else is {down:.1} dB down");
            assert!(down >= 60.0, "{frequency_hz} Hz at {speed_m_s} m/s: all else is {down:.1} dB down");
        }
    }
}

#[test]
fn a_fold_down_does_not_comb() {
    let texture = noise_texture(1, 16_384);
    let samples = 48_000 * 4;
    // Before the listener, and all around.
    for (distance_m, spread_m, around) in [(3.0, 1.0, false), (2.0, 6.0, true)] {
        let controls = VortexControls { distance_m, spread_m, ..crowd(100) };
        let sound = |layout: SpeakerLayout| render(48_000.0, layout, &texture, 100, &[], &controls, samples);
        let mono = third_octaves(&sound(SpeakerLayout::Mono)[0], 48_000.0);
        for layout in
            [SpeakerLayout::Stereo, SpeakerLayout::Surround51, SpeakerLayout::Surround71, SpeakerLayout::Surround712]
        {
            let folded = sound(layout).into_iter().reduce(|mut sum, channel| {
                sum.iter_mut().zip(channel).for_each(|(sum, x)| *sum += x);
                sum
            });
            let half: Vec<f64> = folded.expect("channels").iter().map(|x| x * 0.5f64.sqrt()).collect();
            let octaves = third_octaves(&half, 48_000.0);
            let off: Vec<f64> = octaves.iter().zip(&mono).map(|(folded, mono)| folded - mono).collect();
            let mean = off.iter().sum::<f64>() / off.len() as f64;
            println!("{layout:?}, spread {spread_m} m: {mean:.2} dB, {off:.2?}");
            // By itself a loudspeaker is 3 dB below the two that make up the middle; three and more are above.
            assert!((-3.1..1.5).contains(&mean), "{layout:?}: {mean:.2} dB");
            assert!(off.iter().all(|off| (off - mean).abs() <= 0.6), "{layout:?}: {off:.2?}");
            assert!(around || off.iter().all(|off| off.abs() <= 1.5), "{layout:?}: {off:.2?}");
        }
    }
}

#[test]
fn sources_sound_from_their_positions() {
    let at = |azimuth_deg: f64, layout: SpeakerLayout| {
        let controls = VortexControls { azimuth_deg, ..point() };
        let sound = render(48_000.0, layout, &noise_texture(1, 4096), 1, &[], &controls, 24_000);
        sound.iter().map(|channel| power(channel)).collect::<Vec<f64>>()
    };
    let left = at(-30.0, SpeakerLayout::Stereo);
    assert!(left[0] > 0.0 && left[1] < 1e-6 * left[0], "{left:?}");
    let middle = at(0.0, SpeakerLayout::Stereo);
    assert!((middle[0] / middle[1] - 1.0).abs() < 1e-3, "{middle:?}");
    let rear = at(135.0, SpeakerLayout::Surround712);
    assert!(rear.iter().enumerate().all(|(channel, power)| (channel == 5) == (*power > 1e-6 * rear[5])), "{rear:?}");
}

#[test]
fn many_sources_add_by_power_and_neither_comb_nor_repeat() {
    let texture = noise_texture(1, 16_384);
    let level = |count: usize, seed: u32| {
        let controls = VortexControls { seed, ..crowd(count) };
        let sound = render(48_000.0, SpeakerLayout::Mono, &texture, count, &[], &controls, 48_000 * 4).remove(0);
        third_octaves(&sound, 48_000.0)
    };
    let mean = |count: usize| {
        let all: Vec<Vec<f64>> = (0..4).map(|seed| level(count, seed)).collect();
        (0..all[0].len()).map(|band| all.iter().map(|one| one[band]).sum::<f64>() / 4.0).collect::<Vec<f64>>()
    };
    let (few, many) = (mean(24), mean(192));
    let off: Vec<f64> = few.iter().zip(&many).map(|(few, many)| many - few - 10.0 * 8f64.log10()).collect();
    println!("{off:.2?}");
    assert!(off.iter().all(|off| off.abs() < 1.5), "{off:.2?}");
}

#[test]
fn silent_drive_is_silent_and_so_is_the_end_of_the_tail() {
    for rate_hz in RATES_HZ {
        for threshold in [0.001, 0.1] {
            let controls = VortexControls { threshold, release_s: 0.02, count: 20, ..VortexControls::default() };
            let mut engine = engine(rate_hz, SpeakerLayout::Stereo, &noise_texture(3, 2000), 20);
            let tail = engine.tail_samples(&controls).expect("an end");
            let mut drive = vec![0.0; 30_000];
            drive[3000..6000].fill(1.0);
            let out = play(&mut engine, &drive, &|_| controls, std::iter::repeat(480));
            assert!(6000 + tail < 28_000);
            for channel in &out {
                assert!(channel[..3000].iter().chain(&channel[6000 + tail..]).all(|x| *x == 0.0), "{rate_hz} Hz");
                assert!(rms(&channel[4000..6000]) > 0.0);
            }
        }
    }
}

#[test]
fn no_bank_and_a_bank_of_another_rate_are_silent() {
    let mut engine = Vortex::new(48_000.0, SpeakerLayout::Stereo, 4).expect("engine");
    let controls = VortexControls::default();
    let drive = vec![1.0; 4000];
    assert!(play(&mut engine, &drive, &|_| controls, [4000]).iter().flatten().all(|x| *x == 0.0));
    let bank = Bank::new(&noise_texture(2, 500), 44_100.0).expect("a bank");
    assert!(engine.swap_bank(Some(Arc::new(bank))).is_none());
    assert!(play(&mut engine, &drive, &|_| controls, [4000]).iter().flatten().all(|x| *x == 0.0));
    let bank = Bank::new(&noise_texture(2, 500), 48_000.0).expect("a bank");
    assert!(engine.swap_bank(Some(Arc::new(bank))).is_some());
    assert!(rms(&play(&mut engine, &drive, &|_| controls, [4000])[0]) > 0.0);
    let field = VortexControls { flow: Flow::Field, ..controls };
    engine.reset(0);
    assert!(play(&mut engine, &drive, &|_| field, [4000]).iter().flatten().all(|x| *x == 0.0));
}

#[test]
fn automation_and_exchanges_do_not_click() {
    let texture = noise_texture(5, 8192);
    let base = VortexControls { range: 0.2, count: 30, ..VortexControls::default() };
    let changes: [(&str, VortexControls); 14] = [
        ("speed", VortexControls { speed_m_s: 4.0, ..base }),
        ("curve", VortexControls { curve: 1.5, ..base }),
        ("variation", VortexControls { variation: 0.9, ..base }),
        ("count", VortexControls { count: 10, ..base }),
        ("seed", VortexControls { seed: 1, ..base }),
        ("distance", VortexControls { distance_m: 9.0, ..base }),
        ("spread", VortexControls { spread_m: 2.5, ..base }),
        ("azimuth", VortexControls { azimuth_deg: 150.0, ..base }),
        ("elevation", VortexControls { elevation_deg: 60.0, ..base }),
        ("exponent", VortexControls { exponent: 3.0, ..base }),
        ("range", VortexControls { range: 0.25, ..base }),
        ("level", VortexControls { level: 0.3, ..base }),
        ("limit", VortexControls { max_pressure_pa: 1.0, ..base }),
        ("flow", VortexControls { flow: Flow::Field, ..base }),
    ];
    let samples = 48_000;
    let drive: Vec<f64> = (0..samples).map(|at| 0.5 + 0.2 * (at as f64 * 1e-3).sin()).collect();
    let run = |other: VortexControls, swap: bool, steady: bool| {
        let mut engine = engine(48_000.0, SpeakerLayout::Surround712, &texture, 30);
        engine.swap_field(Some(Arc::new(wandering(30, 40, End::Periodic))));
        let bank = Arc::new(Bank::new(&noise_texture(4, 5000), 48_000.0).expect("a bank"));
        let mut out = vec![vec![0.0; samples]; 10];
        for block in 0..samples / 240 {
            let controls = if steady || block / 20 % 2 == 1 { other } else { base };
            if swap && block % 40 == 39 {
                engine.swap_bank(Some(bank.clone()));
            }
            let range = block * 240..(block + 1) * 240;
            let mut outputs: Vec<&mut [f64]> = out.iter_mut().map(|channel| &mut channel[range.clone()]).collect();
            engine.process(&drive[range.clone()], &controls, &mut outputs);
        }
        out
    };
    // Content ends at 2 kHz; a click is what reaches far above it. The start is one of its own.
    let loudest = |sound: &[Vec<f64>]| {
        let highs =
            sound.iter().map(|channel| highs(&channel[4800..]).iter().fold(0.0f64, |most, x| most.max(x.abs())));
        highs.fold(0.0, f64::max)
    };
    let (largest, still) = (
        run(base, false, true).iter().flatten().fold(0.0f64, |most, x| most.max(x.abs())),
        loudest(&run(base, false, true)),
    );
    for (what, other) in changes {
        let largest = run(other, false, true).iter().flatten().fold(largest, |most, x| most.max(x.abs()));
        let moving = loudest(&run(other, false, false));
        println!("{what}: {:.1} dB, still {:.1} dB", db(moving / largest), db(still / largest));
        assert!(moving < 2e-3 * largest, "{what}: {:.1} dB", db(moving / largest));
    }
    let swapped = loudest(&run(base, true, true));
    println!("exchange: {:.1} dB", db(swapped / largest));
    assert!(swapped < 1e-2 * largest, "exchange: {:.1} dB", db(swapped / largest));
}

#[test]
fn a_jump_of_distance_is_walked_and_arrives() {
    let controls = |at: usize| VortexControls { distance_m: if at < 4800 { 1.0 } else { 60.0 }, ..point() };
    let texture = noise_texture(1, 4096);
    let jumped = render_by(48_000.0, SpeakerLayout::Mono, &texture, 1, &controls, 96_000).remove(0);
    let there = render_by(48_000.0, SpeakerLayout::Mono, &texture, 1, &|_| controls(5000), 96_000).remove(0);
    assert!(rms(&jumped[4800..9600]) > 0.0);
    let off: Vec<f64> = jumped[72_000..].iter().zip(&there[72_000..]).map(|(a, b)| a - b).collect();
    assert!(rms(&off) < 1e-5 * rms(&there), "{:e}", rms(&off) / rms(&there));
}

#[test]
fn the_microphone_has_a_largest_pressure() {
    let texture = noise_texture(5, 4096);
    let at = |max_pressure_pa: f64| {
        let controls = VortexControls { max_pressure_pa, range: 1.0, level: 0.5, ..crowd(30) };
        render(48_000.0, SpeakerLayout::Stereo, &texture, 30, &[], &controls, 48_000)
    };
    let free = at(1e9);
    let most = free.iter().flatten().fold(0.0f64, |most, x| most.max(x.abs()));
    let tight = at(most);
    assert!(tight.iter().flatten().all(|x| x.abs() <= 0.5 * most * (1.0 + 1e-9)));
    let unchanged = at(4.0 * most);
    assert!(unchanged == free);
    assert!(tight != free);
}

#[test]
fn bad_input_leaves_finite_output_and_no_trace() {
    let texture = noise_texture(3, 2000);
    let mut engine = engine(48_000.0, SpeakerLayout::Surround51, &texture, 16);
    engine.swap_field(Some(Arc::new(wandering(8, 10, End::Periodic))));
    let bads = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0];
    for (which, bad) in bads.iter().copied().cycle().take(36).enumerate() {
        let drive: Vec<f64> = (0..700).map(|at| if at % 3 == 0 { bad } else { 0.5 }).collect();
        let controls = VortexControls {
            texture: usize::MAX,
            field_offset_s: bad,
            flow: if which % 2 == 0 { Flow::Envelope } else { Flow::Field },
            attack_s: bad,
            release_s: bad,
            threshold: bad,
            speed_m_s: bad,
            curve: bad,
            variation: bad,
            field_speed: bad,
            count: usize::MAX,
            seed: u32::MAX,
            distance_m: bad,
            spread_m: bad,
            azimuth_deg: bad,
            elevation_deg: bad,
            exponent: bad,
            range: bad,
            reference_m_s: bad,
            level: bad,
            max_pressure_pa: bad,
        };
        let one_bad = VortexControls { distance_m: bad, azimuth_deg: bad, ..VortexControls::default() };
        for controls in [controls, one_bad] {
            let out = play(&mut engine, &drive, &|_| controls, [700]);
            assert!(out.iter().flatten().all(|x| x.is_finite()), "{bad}");
        }
        engine.reset([i64::MAX, i64::MIN, 12][which % 3]);
    }
    // Outputs of other numbers and lengths than they should be.
    let controls = VortexControls::default();
    let mut extra = vec![vec![1.0; 100]; 12];
    let mut outputs: Vec<&mut [f64]> = extra.iter_mut().map(Vec::as_mut_slice).collect();
    engine.process(&[1.0; 100], &controls, &mut outputs);
    assert!(extra[6..].iter().flatten().all(|x| *x == 0.0));
    engine.process(&[1.0; 100], &controls, &mut [&mut [0.0; 7], &mut [0.0; 300]]);
    engine.process(&[1.0; 100], &controls, &mut []);
    // A reset leaves nothing of it.
    let mut fresh = self::engine(48_000.0, SpeakerLayout::Surround51, &texture, 16);
    fresh.swap_field(Some(Arc::new(wandering(8, 10, End::Periodic))));
    engine.reset(5);
    fresh.reset(5);
    let drive = bursts(5000);
    assert!(play(&mut engine, &drive, &busy, [5000]) == play(&mut fresh, &drive, &busy, [5000]));
    for (rate_hz, sources) in [(f64::NAN, 1), (7999.0, 1), (48_000.0, 0), (48_000.0, 20_000)] {
        assert!(Vortex::new(rate_hz, SpeakerLayout::Mono, sources).is_err());
    }
    assert!(Bank::new(&texture, f64::INFINITY).is_err());
    assert!(Bank::new(&noise_texture(12, 1 << 18), 48_000.0).is_err(), "too large");
}

#[test]
fn seeds_differ_and_repeat() {
    let texture = noise_texture(3, 4096);
    let run = |seed: u32| {
        let controls = VortexControls { seed, count: 5, ..VortexControls::default() };
        render(48_000.0, SpeakerLayout::Stereo, &texture, 5, &[], &controls, 24_000)
    };
    assert!(run(1) == run(1));
    let (a, b) = (run(1), run(2));
    let product: f64 = a[0].iter().zip(&b[0]).map(|(a, b)| a * b).sum::<f64>() / a[0].len() as f64;
    assert!(product.abs() < 0.3 * rms(&a[0]) * rms(&b[0]));
}

#[test]
fn the_audio_thread_neither_allocates_nor_frees() {
    for (rate_hz, layout) in [(44_100.0, SpeakerLayout::Stereo), (96_000.0, SpeakerLayout::Surround712)] {
        let mut engine = engine(rate_hz, layout, &noise_texture(5, 2000), 50);
        let drive = bursts(8192);
        let mut out = vec![vec![0.0; 8192]; layout.channels()];
        let field = Arc::new(wandering(30, 20, End::Periodic));
        for round in 0..120 {
            let block = [0, 1, 17, 64, 480, 1024, 4096, 8192][round % 8];
            let flow = if round / 10 % 2 == 0 { Flow::Envelope } else { Flow::Field };
            let controls = VortexControls { flow, ..busy(2345 * round) };
            let bank = (round % 7 == 0)
                .then(|| Arc::new(Bank::new(&noise_texture(2 + round % 3, 300), rate_hz).expect("a bank")));
            let mut new_field = (round % 9 == 0).then(|| field.clone());
            let mut outputs: Vec<&mut [f64]> = out.iter_mut().map(|channel| &mut channel[..block]).collect();
            let mut old = (None, None);
            let seen = allocation_counter::measure(|| {
                engine.process(&drive[..block], &controls, &mut outputs);
                if let Some(bank) = bank {
                    old.0 = engine.swap_bank(Some(bank));
                }
                if round % 9 == 0 {
                    old.1 = engine.swap_field(new_field.take());
                }
                if round % 25 == 24 {
                    engine.reset(round as i64 * 1000);
                }
                let _ = (engine.tail_samples(&controls), engine.latency_samples());
            });
            assert_eq!((seen.count_total, seen.count_current), (0, 0), "round {round}, block of {block}");
        }
    }
}

#[test]
fn a_crowd_is_as_loud_as_its_gain_says() {
    // Over directions and times, N sources of gain g at distance r have the mean square N (g / r)^2.
    let texture = noise_texture(3, 16_384);
    let controls = VortexControls { distance_m: 5.0, spread_m: 0.5, range: 1.0, ..crowd(240) };
    let sound = render(48_000.0, SpeakerLayout::Stereo, &texture, 240, &[], &controls, 48_000 * 4);
    // The highest row's gain is 1 Pa at 1 m.
    let expected = 240.0 / 25.0;
    let found = power(&sound[0]) + power(&sound[1]);
    assert!((10.0 * (found / expected).log10()).abs() < 0.5, "{found} instead of {expected}");
}
