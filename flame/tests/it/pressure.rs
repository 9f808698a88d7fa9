//! From flux to pressure, and the tables in between.

use std::f64::consts::TAU;

use proptest::prelude::*;
use pyrophone_flame::Error;
use pyrophone_flame::flux::{Flux, FluxShard, Row, Steps};
use pyrophone_flame::pressure::{Advice, Options, PressureKind, derivative, render};

fn row(frame: i64, flux: f64) -> Row {
    Row { frame, flux, area: 2.0 * flux.abs(), mean_curvature: Some(0.1 * flux) }
}

proptest! {
    /// A constant flux makes no sound, not even at its ends, at any rate.
    #[test]
    fn a_constant_flux_is_silence(
        value in any::<f64>().prop_filter("finite", |x| x.abs() < 1e300),
        count in 1usize..200,
        rate_hz in 1.0f64..5000.0,
        sample_rate_hz in prop_oneof![Just(8_000), Just(44_100), Just(96_000)],
    ) {
        let flux = vec![value; count];
        prop_assert!(derivative(&flux, rate_hz, f64::from(sample_rate_hz)).iter().all(|sample| *sample == 0.0));
        let options = Options { rate_hz, sample_rate_hz, ..Options::default() };
        let sound = render(&flux, &options).unwrap();
        prop_assert!(sound.samples.iter().all(|sample| *sample == 0.0));
        prop_assert_eq!(sound.scale, 1.0);
        let expected = count as f64 / rate_hz * f64::from(sample_rate_hz);
        prop_assert!((sound.samples.len() as f64 - expected).abs() <= 0.5);
    }

    /// A partial table and a table read back as the same numbers.
    #[test]
    fn tables_read_back(
        values in proptest::collection::vec(proptest::option::weighted(0.9, any::<[f64; 3]>()), 1..60),
        first in 0i64..1000,
    ) {
        let row = |frame, values: [f64; 3]| {
            let [flux, area, curvature] = values.map(|x| if x.is_finite() { x } else { 0.25 });
            Row { frame, flux, area, mean_curvature: Some(curvature) }
        };
        let steps: Steps =
            (first..).zip(&values).map(|(frame, values)| (frame, values.map(|values| row(frame, values)))).collect();
        let part = FluxShard {
            settings: "iso 0.5; field flame, or \"so\"".into(),
            cache: "0123abc".into(),
            rate_hz: Some(24000.0 / 1001.0),
            changes: [(first, vec![0.1, -2e-300])].into(),
            steps,
            ..FluxShard::default()
        };
        let mut text = vec![];
        part.write(&mut text).unwrap();
        let back = FluxShard::read(std::str::from_utf8(&text).unwrap(), "shard").unwrap();
        prop_assert_eq!(&back, &part);
        match Flux::from_steps(&part.steps) {
            Ok(flux) => {
                let mut text = vec![];
                flux.write_csv(Some(24.0), |step| step.to_string(), &mut text).unwrap();
                let back = Flux::read_csv(std::str::from_utf8(&text).unwrap(), "table").unwrap();
                prop_assert_eq!(bits(&back), bits(&flux));
            }
            Err(error) => prop_assert!(values.iter().all(Option::is_none), "{}", error),
        }
    }

    /// However a run is cut into shards, putting them together gives what one run gives.
    #[test]
    fn shards_merge_to_one_run(
        values in proptest::collection::vec(proptest::option::weighted(0.8, -1e3f64..1e3), 2..80),
        cuts in proptest::collection::vec(0usize..80, 0..5),
        turn in 0usize..6,
    ) {
        let steps: Steps =
            (10..).zip(&values).map(|(frame, flux)| (frame, flux.map(|flux| row(frame, flux)))).collect();
        let whole = FluxShard { settings: "the same".into(), steps, ..FluxShard::default() };
        let mut edges: Vec<i64> = cuts.iter().map(|cut| 10 + (*cut).min(values.len()) as i64).collect();
        edges.extend([10, 10 + values.len() as i64]);
        edges.sort_unstable();
        let mut parts: Vec<(String, FluxShard)> = edges.windows(2).enumerate().map(|(number, edge)| {
            let steps = whole.steps.range(edge[0]..edge[1]).map(|(frame, row)| (*frame, *row)).collect();
            (format!("shard {number}"), FluxShard { settings: "the same".into(), steps, ..FluxShard::default() })
        }).collect();
        let count = parts.len();
        parts.rotate_left(turn % count);
        match FluxShard::merge(&parts) {
            Ok(merged) => prop_assert_eq!(merged, whole),
            Err(error) => prop_assert!(values.iter().all(Option::is_none), "{}", error),
        }
    }

    /// Nothing that a file may hold brings the readers down.
    #[test]
    fn any_text_is_read_or_refused(
        text in "(# pyrophone flux 1; a\n)?(frame,flux,area\n)?([0-9,.eE+\\-infa ]{0,30}\n){0,6}.{0,60}",
    ) {
        let _ = FluxShard::read(&text, "x");
        let _ = Flux::read_csv(&text, "x");
    }
}

fn bits(flux: &Flux) -> Vec<(i64, u64, u64)> {
    flux.rows.iter().map(|row| (row.frame, row.flux.to_bits(), row.area.to_bits())).collect()
}

/// Amplitude and phase of the cosine at `hz` in the middle of a sound, which begins after whole periods.
fn tone(sound: &[f64], sample_rate_hz: f64, hz: f64) -> (f64, f64) {
    // Whole periods of every frequency asked for.
    let middle = &sound[sound.len() / 4..][..sample_rate_hz as usize];
    let (re, im) = middle.iter().enumerate().fold((0.0, 0.0), |(re, im), (n, sample)| {
        let angle = TAU * hz * n as f64 / sample_rate_hz;
        (re + sample * angle.cos(), im + sample * angle.sin())
    });
    (2.0 * re.hypot(im) / sample_rate_hz, (-im).atan2(re))
}

/// The kernel's spectrum by summing its samples: what a step rate lets through.
fn response(hz: f64, rate_hz: f64) -> f64 {
    let kernel = |x: f64| match x.abs() {
        a if a < 1.0 => (7.0 * a * a * a - 12.0 * a * a + 16.0 / 3.0) / 6.0,
        a if a < 2.0 => (-7.0 / 3.0 * a * a * a + 12.0 * a * a - 20.0 * a + 32.0 / 3.0) / 6.0,
        _ => 0.0,
    };
    let steps = 200_000;
    let at = |n: usize| -2.0 + 4.0 * (n as f64 + 0.5) / steps as f64;
    (0..steps).map(|n| kernel(at(n)) * (TAU * hz / rate_hz * at(n)).cos()).sum::<f64>() * 4.0 / steps as f64
}

#[test]
fn a_sine_becomes_its_derivative() {
    let (rate_hz, sample_rate_hz) = (360.0, 44_100.0);
    for hz in [10.0, 60.0, 120.0] {
        let flux: Vec<f64> = (0..720).map(|step| (TAU * hz * f64::from(step) / rate_hz + 0.3).sin()).collect();
        let sound = derivative(&flux, rate_hz, sample_rate_hz);
        assert_eq!(sound.len(), 88_200);
        let expected = TAU * hz * response(hz, rate_hz);
        let (level, phase) = tone(&sound, sample_rate_hz, hz);
        let off_db = 20.0 * (level / expected).log10();
        assert!(off_db.abs() < 0.1, "{hz} Hz: {off_db} dB");
        // And in phase: a cosine begun at the same angle.
        assert!((phase - 0.3).abs() < 1e-3, "{hz} Hz: {phase}");
    }
}

#[test]
fn a_ramp_has_an_even_slope() {
    let flux: Vec<f64> = (0..100).map(|step| 0.5 * f64::from(step)).collect();
    let sound = derivative(&flux, 100.0, 8000.0);
    assert!(sound[160..7700].iter().all(|sample| (sample - 50.0).abs() < 1e-9));
}

#[test]
fn steps_denser_than_samples_do_not_alias() {
    // 40 kHz steps at 8 kHz of sound: 500 Hz passes, 7,500 Hz (which would fold onto 500 Hz) does not.
    let (rate_hz, sample_rate_hz) = (40_300.0, 8_000.0);
    let level = |hz: f64| {
        let flux: Vec<f64> =
            (0..80_600).map(|step| (TAU * hz * f64::from(step) / rate_hz).sin() / (TAU * hz)).collect();
        let sound = derivative(&flux, rate_hz, sample_rate_hz);
        tone(&sound, sample_rate_hz, 500.0).0
    };
    let (passed, folded) = (level(500.0), level(7_500.0));
    assert!((20.0 * passed.log10()).abs() < 0.2, "{passed}");
    assert!(20.0 * folded.log10() < -30.0, "{folded}");
}

#[test]
fn the_peak_is_as_asked_for_and_its_scale_is_stated() {
    let flux: Vec<f64> = (0..360).map(|step| (TAU * 60.0 * f64::from(step) / 360.0).sin() * 1e-3).collect();
    for kind in [PressureKind::Pressure, PressureKind::Envelope] {
        let quiet = Options { kind, high_pass_hz: 0.0, peak_db: -12.0, ..Options::default() };
        let sound = render(&flux, &quiet).unwrap();
        let peak = sound.samples.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
        assert!((20.0 * peak.log10() + 12.0).abs() < 1e-4, "{peak}");
        let louder = render(&flux.iter().map(|value| 3.0 * value).collect::<Vec<_>>(), &quiet).unwrap();
        assert!((sound.scale / louder.scale - 3.0).abs() < 1e-9);
        if kind == PressureKind::Pressure {
            let plain = derivative(&flux, 360.0, 44_100.0);
            let scaled = plain.iter().map(|sample| (sample * sound.scale) as f32);
            assert!(scaled.zip(&sound.samples).all(|(a, b)| (a - b).abs() < 1e-6));
        }
    }
}

#[test]
fn the_high_pass_takes_what_is_slow() {
    let level = |hz: f64, high_pass_hz: f64| {
        let flux: Vec<f64> = (0..1440).map(|step| (TAU * hz * f64::from(step) / 360.0).cos()).collect();
        let sound = render(&flux, &Options { high_pass_hz, ..Options::default() }).unwrap();
        let unscaled: Vec<f64> = sound.samples.iter().map(|sample| f64::from(*sample) / sound.scale).collect();
        tone(&unscaled, 44_100.0, hz).0
    };
    let gain_db = |hz: f64| 20.0 * (level(hz, 30.0) / level(hz, 0.0)).log10();
    assert!((gain_db(30.0) + 3.0).abs() < 0.2, "{}", gain_db(30.0));
    assert!(gain_db(6.0) < -25.0 && gain_db(100.0).abs() < 0.1);
}

#[test]
fn an_envelope_follows_the_size_of_the_flux() {
    let flux: Vec<f64> = (0..48).map(|step| if step < 24 { -2.0 } else { 1.0 }).collect();
    let options = Options { rate_hz: 24.0, kind: PressureKind::Envelope, peak_db: 0.0, ..Options::default() };
    let sound = render(&flux, &options).unwrap();
    assert!(sound.samples.iter().all(|sample| *sample >= 0.0));
    let (early, late) = (sound.samples[22_050], sound.samples[66_150]);
    assert!((early / late - 2.0).abs() < 1e-4, "{early} {late}");
}

#[test]
fn step_rates_are_judged() {
    assert_eq!(Advice::on(24.0), Advice::EnvelopeOnly { nyquist_hz: 12.0 });
    assert_eq!(Advice::on(60.0), Advice::EnvelopeOnly { nyquist_hz: 30.0 });
    assert_eq!(Advice::on(120.0), Advice::Narrow { nyquist_hz: 60.0 });
    assert_eq!(Advice::on(360.0), Advice::Full);
    assert!(Advice::on(24.0).to_string().contains("12 Hz only") && !Advice::on(24.0).to_string().contains('\n'));
}

#[test]
fn options_out_of_range_are_refused() {
    let good = Options::default();
    for bad in [
        Options { rate_hz: 0.0, ..good },
        Options { rate_hz: f64::NAN, ..good },
        Options { sample_rate_hz: 100, ..good },
        Options { high_pass_hz: -1.0, ..good },
        Options { peak_db: 6.0, ..good },
    ] {
        assert!(matches!(render(&[0.0, 1.0], &bad), Err(Error::OutOfRange { .. })), "{bad:?}");
    }
    assert_eq!(render(&[], &good), Err(Error::NoFrames));
    assert_eq!(render(&[0.0, f64::NAN], &good), Err(Error::NotFinite { what: "flux" }));
    assert!(matches!(render(&[0.0; 4000], &Options { rate_hz: 1.0, ..good }), Err(Error::OutOfRange { .. })));
}

#[test]
fn gaps_are_filled_linearly_and_reported() {
    let steps: Steps =
        [(3, None), (4, Some(row(4, 1.0))), (5, None), (6, None), (7, Some(row(7, 4.0))), (8, None)].into();
    let flux = Flux::from_steps(&steps).unwrap();
    assert_eq!(flux.values(), [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
    assert_eq!(flux.interpolated, [3, 5, 6, 8]);
    assert_eq!(flux.rows.iter().map(|row| row.frame).collect::<Vec<_>>(), [3, 4, 5, 6, 7, 8]);
    assert!((flux.rows[2].area - 4.0).abs() < 1e-12);
    assert_eq!(Flux::from_steps(&[(1, None)].into()), Err(Error::NoFrames));
    let far: Steps = [(1, Some(row(1, 1.0))), (i64::MAX, Some(row(2, 1.0)))].into();
    assert!(matches!(Flux::from_steps(&far), Err(Error::OutOfRange { .. })));
}

#[test]
fn shards_that_do_not_fit_are_refused() {
    let part = |settings: &str, frames: std::ops::Range<i64>| FluxShard {
        settings: settings.into(),
        steps: frames.map(|frame| (frame, Some(row(frame, 1.0)))).collect(),
        ..FluxShard::default()
    };
    let merge = |a: FluxShard, b: FluxShard| FluxShard::merge(&[("a.csv".into(), a), ("b.csv".into(), b)]).unwrap_err();
    let error = merge(part("iso 0.5", 1..5), part("iso 0.6", 5..9));
    assert!(["a.csv", "b.csv", "iso 0.5", "iso 0.6"].iter().all(|part| error.to_string().contains(part)), "{error}");
    let error = merge(part("x", 1..5), part("x", 4..9)).to_string();
    assert!(["frame 4", "a.csv", "b.csv"].iter().all(|part| error.contains(part)), "{error}");
    assert_eq!(merge(part("x", 1..5), part("x", 7..9)), Error::Hole { frame: 5 });
    let of_cache = |cache: &str, frames| FluxShard { cache: cache.into(), ..part("x", frames) };
    let error = merge(of_cache("one", 1..5), of_cache("other", 5..9)).to_string();
    assert!(["a.csv", "b.csv", "different caches"].iter().all(|part| error.contains(part)), "{error}");
    // Nothing was measured in the second one, so that nobody knows how it would have been.
    let empty = FluxShard { steps: [(5, None)].into(), ..part("", 0..0) };
    assert_eq!(FluxShard::merge(&[("a".into(), part("x", 1..5)), ("b".into(), empty)]).unwrap().steps.len(), 5);
    const HEAD: &str = "# pyrophone flux 3; x\n# cache c; rate 24.0; steps 1 1 0\nframe,flux,area,mean_curvature\n";
    for (text, says) in [
        ("frame,flux,area\n1,2,3\n".to_owned(), "line 1"),
        (
            "# pyrophone flux 3; x\nframe,flux,area,mean_curvature\n".to_owned(),
            "line 2: the line with the cache is missing",
        ),
        (format!("{HEAD}1,2,3,4\n1,2,3,4\n"), "line 5: duplicate frame 1"),
        (format!("{HEAD}1,NaN,3,4\n"), "line 4: 'NaN'"),
        (format!("{HEAD}1,2\n"), "line 4"),
        (format!("{HEAD}1.5,2,3,4\n"), "line 4: '1.5'"),
    ] {
        let error = FluxShard::read(&text, "shard.csv").unwrap_err().to_string();
        assert!(error.contains("shard.csv") && error.contains(says), "{error}");
    }
}

#[test]
fn a_part_that_was_cut_or_changed_is_refused() {
    let steps: Steps = (1..9).map(|frame| (frame, Some(row(frame, frame as f64)))).collect();
    let mut bytes = vec![];
    FluxShard { settings: "x".into(), steps, ..FluxShard::default() }.write(&mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    assert!(FluxShard::read(&text, "a.csv").is_ok());
    for end in (text.find("4,4.0").unwrap()..text.len()).step_by(3) {
        let error = FluxShard::read(&text[..end], "a.csv").unwrap_err().to_string();
        assert!(error.contains("a.csv"), "cut at {end}: {error}");
    }
    let error = FluxShard::read(&text.replace("4,4.0", "4,4.5"), "a.csv").unwrap_err().to_string();
    assert!(error.contains("truncated or modified"), "{error}");
}
