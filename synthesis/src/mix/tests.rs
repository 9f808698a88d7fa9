use super::*;

fn layers_of_ones(samples: usize) -> (Vec<f64>, Vec<Vec<f64>>, Vec<Vec<f32>>) {
    (vec![1.0; samples], vec![vec![0.0; samples]; 2], vec![vec![0.25; samples]; 2])
}

#[test]
fn a_step_acts_on_the_sound_it_arrived_with() {
    let (low, silent, dry) = layers_of_ones(6000);
    let run = |cut: usize| {
        let mut mix = Mix::new(1000, 48_000.0, SpeakerLayout::Stereo);
        let mut outputs = [vec![0.0f32; 6000], vec![0.0f32; 6000]];
        let mut start = 0;
        for (end, gain) in [(500, 1.0), (6000, 0.5)] {
            while start < end {
                let stop = end.min(start + cut);
                let part = |x: &Vec<f64>| x[start..stop].to_vec();
                let silent: Vec<Vec<f64>> = silent.iter().map(part).collect();
                let dry: Vec<_> = dry.iter().map(|x| x[start..stop].to_vec()).collect();
                let layers = Layers {
                    low: &low[start..stop],
                    extension: &silent,
                    texture: &silent,
                    vortex: &silent,
                    crackle: &silent,
                    hiss: &silent,
                    body: &silent,
                    dry: &dry,
                };
                let mut outs: Vec<&mut [f32]> = outputs.iter_mut().map(|x| &mut x[start..stop]).collect();
                mix.process(&layers, &MixControls { low: gain, ..MixControls::default() }, &mut outs);
                start = stop;
            }
        }
        outputs[0].clone()
    };
    let whole = run(6000);
    assert!(whole[..1500].iter().all(|x| *x == 1.0));
    assert!(whole[1500] < 1.0);
    assert_eq!(*whole.last().unwrap(), 0.5);
    for cut in [1, 17, 480] {
        assert_eq!(run(cut), whole, "cut into {cut}");
    }
}

/// Noise that is now and then zero, loud, or no number.
fn rough(random: &mut u64) -> f64 {
    *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    let x = (*random >> 40) as f64 / f64::from(1 << 23) - 1.0;
    match *random >> 33 & 127 {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => -0.0,
        3..10 => 0.0,
        10..20 => 40.0 * x,
        _ => 0.1 * x,
    }
}

#[test]
fn settled_levels_give_the_bits_that_moving_ones_give() {
    let mut random = 1;
    let layouts = [SpeakerLayout::Mono, SpeakerLayout::Stereo, SpeakerLayout::Surround51, SpeakerLayout::Surround712];
    let mut ceilings = 0;
    for (case, layout) in layouts.into_iter().cycle().take(48).enumerate() {
        let (channels, samples) = (layout.channels(), 1 + case * 7);
        let mut layer = || -> Vec<Vec<f64>> {
            // Negative zero in all layers at once: only what is added to it decides its sign.
            let mut channel = || std::iter::once(-0.0).chain((1..samples).map(|_| rough(&mut random))).collect();
            (0..channels).map(|_| channel()).collect()
        };
        let all: [Vec<Vec<f64>>; 7] = std::array::from_fn(|_| layer());
        let dry: Vec<Vec<f32>> = layer().iter().map(|x| x.iter().map(|x| *x as f32).collect()).collect();
        let layers = Layers {
            low: &all[0][0],
            extension: &all[1],
            texture: &all[2],
            vortex: &all[3],
            crackle: &all[4],
            hiss: &all[5],
            body: &all[6],
            dry: &dry,
        };
        let controls = MixControls {
            hiss: if case % 3 == 0 { 0.0 } else { 0.7 },
            width: if case % 2 == 0 { 1.0 } else { 0.3 },
            ceiling: case % 5 != 0,
            bypass: case % 7 == 0,
            ..MixControls::default()
        };
        let mut mix = Mix::new(0, 48_000.0, layout);
        mix.jump(&controls);
        assert!(mix.is_settled(&controls));
        let levels = mix.next_levels(&controls);
        let mut run = |is_settled: bool| {
            let mut peaks = Peaks::default();
            let mut outputs = vec![vec![0.0f32; samples]; channels];
            let mut outs: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
            if is_settled {
                let (has_ceiling, effects, wets) = (controls.ceiling, mix.effects, &mut mix.wets[..]);
                let mut settled = Settled { levels: &levels, has_ceiling, effects, wets };
                settled.process(&layers, 0..samples, &mut outs, &mut peaks);
            } else {
                (0..samples).for_each(|i| mix.sample(&layers, &controls, &levels, i, &mut outs, &mut peaks));
            }
            let bits: Vec<Vec<u32>> = outputs.iter().map(|x| x.iter().map(|x| x.to_bits()).collect()).collect();
            (bits, peaks)
        };
        let (settled, moving) = (run(true), run(false));
        assert_eq!(settled.0, moving.0, "case {case}");
        let bits = |peaks: Peaks| {
            let Peaks { low, extension, texture, vortex, crackle, hiss, body, output } = peaks;
            [low, extension, texture, vortex, crackle, hiss, body, output].map(f64::to_bits)
        };
        assert_eq!(bits(settled.1), bits(moving.1), "case {case}");
        ceilings += usize::from(controls.ceiling && settled.1.output > 0.9);
    }
    assert!(ceilings > 9, "the ceiling held in {ceilings} cases only");
}

#[test]
fn bypass_is_the_dry_sound_exactly() {
    let (low, silent, dry) = layers_of_ones(100);
    let mut mix = Mix::new(10, 48_000.0, SpeakerLayout::Stereo);
    let mut outputs = [vec![0.0f32; 100], vec![0.0f32; 100]];
    let layers = Layers {
        low: &low,
        extension: &silent,
        texture: &silent,
        vortex: &silent,
        crackle: &silent,
        hiss: &silent,
        body: &silent,
        dry: &dry,
    };
    let mut outs: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    mix.process(&layers, &MixControls { bypass: true, ..MixControls::default() }, &mut outs);
    assert_eq!(outputs[0], dry[0]);
}
