use super::*;

const RATE_HZ: f64 = 44_100.0;
const BLOCK: usize = 500;

/// The matched signal, and the factor on texture, while the controls go back and forth.
fn run(calm: &TextureControls, moved: &TextureControls) -> [Vec<f64>; 2] {
    let mut noise = vec![0.0; 30_000];
    White::new(1, 2).fill(0, &mut noise);
    let (_, profile) = Profile::compress(&mut [noise], RATE_HZ);
    let mut companding = Companding::new(RATE_HZ, 1, 900, 2048, BLOCK);
    let (mut flats, mut gains) = (vec![], vec![]);
    for block in 0..200 {
        let drive: Vec<f64> = (0..BLOCK)
            .map(|i| 0.5 * (2.0 * std::f64::consts::PI * 50.0 * (block * BLOCK + i) as f64 / RATE_HZ).sin())
            .collect();
        let (mut flat, mut loudness, mut gain) = (vec![0.0; BLOCK], vec![0.0; BLOCK], vec![1.0; BLOCK]);
        let controls = if block / 20 % 2 == 0 { calm } else { moved };
        companding.compress(DriveBlock::of(&drive), controls, Some(&profile), &mut flat, &mut loudness);
        companding.expand_one(Some(&profile), &mut [&mut gain]);
        flats.extend(flat);
        gains.extend(gain);
    }
    [flats, gains]
}

#[test]
fn loudness_of_an_envelope_is_the_envelope_without_its_delay() {
    let (latency, delay_s) = (2048, 0.008);
    let bump = |sample: f64| 0.1 + 0.4 * (-((sample - 40_000.0) / 2000.0).powi(2)).exp();
    let mut companding = Companding::new(RATE_HZ, 1, 900, latency, BLOCK);
    let controls = TextureControls { dynamic_range: DynamicRange::Off, ..TextureControls::default() };
    let mut relative = vec![];
    for start in (0..80_000).step_by(BLOCK) {
        let drive: Vec<f64> = (start..start + BLOCK).map(|at| White::new(3, 3).sample_at(at as i64)).collect();
        let values: Vec<f64> = (start..start + BLOCK).map(|at| bump(at as f64 - delay_s * RATE_HZ)).collect();
        let (mut flat, mut loudness, mut out) = (vec![0.0; BLOCK], vec![0.0; BLOCK], vec![0.0; BLOCK]);
        let envelope = Some(DriveEnvelope { values: &values, delay_s });
        companding.compress(DriveBlock { samples: &drive, envelope }, &controls, None, &mut flat, &mut loudness);
        companding.expand_one(None, &mut [&mut out]);
        relative.extend_from_slice(companding.relative_loudness(BLOCK));
    }
    for at in (20_000..70_000).step_by(500) {
        let (found, wanted) = (relative[at] * level::NOMINAL, bump((at - latency) as f64));
        assert!((found / wanted - 1.0).abs() < 0.02, "at {at}: {found} for {wanted}");
    }
}

#[test]
fn no_control_makes_a_step() {
    let calm = TextureControls {
        companding: CompandingControls { low_end_hz: 0.0, ..CompandingControls::default() },
        ..TextureControls::default()
    };
    let with = |change: &dyn Fn(&mut TextureControls)| {
        let mut moved = calm;
        change(&mut moved);
        run(&calm, &moved)
    };
    let step = |signal: &[f64]| signal[20_000..].windows(2).map(|x| (x[1] - x[0]).abs()).fold(0.0, f64::max);
    let largest = |signal: &[f64]| signal[20_000..].iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let still = run(&calm, &calm);
    let changes: [&dyn Fn(&mut TextureControls); 3] = [
        &|controls| controls.companding.dynamics = 0.0,
        &|controls| controls.companding.drive_match = 4.0,
        &|controls| controls.dynamic_range = DynamicRange::Off,
    ];
    for (number, change) in changes.iter().enumerate() {
        let moving = with(change);
        assert_ne!(moving, still, "change {number} does something");
        // 20 ms: a thousandth of the way, about, in every sample.
        let gain = &moving[1];
        assert!(step(gain) < 3e-3 * largest(gain), "change {number}: {} of {}", step(gain), largest(gain));
        let (flat, calm) = (step(&moving[0]) / largest(&moving[0]), step(&still[0]) / largest(&still[0]));
        assert!(flat < 1.1 * calm, "change {number}: {flat} against {calm}");
    }
}
