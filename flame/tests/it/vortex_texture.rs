//! Vortex-sound textures against what is known of vortex sound.

use std::f64::consts::{PI, TAU};

use pyrophone_flame::scenes::Wander;
use pyrophone_flame::solver::Random;
use pyrophone_flame::vortex_texture::{Band, FlowModel, Integral, Origin, Recipe, Series, Vorticity, speeds};
use pyrophone_synthesis::vortex::texture::{VortexTexture, directivity};

const SHAPE: [usize; 3] = [24, 24, 16];
const VOXEL_M: f64 = 0.02;

/// A receiver that lies on no axis of symmetry.
const RECEIVER: [f64; 3] = [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0];

/// Small and short, so that a test can record several.
fn recipe(kind: FlowModel) -> Recipe {
    Recipe { kind, voxels: [8, 8, 12], rate_hz: 2_000.0, period_s: 0.25, ..Recipe::default() }
}

/// Pressure source at [`RECEIVER`] over one revolution of two equal line vortices that circle each other at `speed_m_s`:
/// its strongest harmonic of the revolution, and its amplitude; and the amplitude by theory.
fn circling_pair(speed_m_s: f64) -> (usize, f64, f64) {
    const STEPS: usize = 96;
    let apart_m = 0.18;
    let core_m = 0.02;
    // Each is moved by the other: v = Γ / (2π d); they circle on a radius of d/2.
    let circulation = TAU * apart_m * speed_m_s;
    let rate = speed_m_s / (0.5 * apart_m);
    let integral = Integral::new(SHAPE, VOXEL_M, Origin::Centre);
    let values: Vec<_> = (0..STEPS)
        .map(|step| {
            let (sin, cos) = (TAU * step as f64 / STEPS as f64).sin_cos();
            let field = Vorticity::from_fn(SHAPE, VOXEL_M, |[x, y, _]| {
                let core = |sign: f64| {
                    let [dx, dy] = [x - sign * 0.5 * apart_m * cos, y - sign * 0.5 * apart_m * sin];
                    (-(dx * dx + dy * dy) / (core_m * core_m)).exp() / (PI * core_m * core_m)
                };
                [0.0, 0.0, circulation * (core(1.0) + core(-1.0))]
            });
            integral.components(&field)
        })
        .collect();
    let step_s = TAU / rate / STEPS as f64;
    let sound = Series::looped(&values, STEPS, step_s).sound(STEPS, Band { pass_hz: 1e9, stop_hz: 2e9 });
    let heard: Vec<f64> = sound
        .values()
        .0
        .iter()
        .map(|value| value.iter().zip(directivity(RECEIVER)).map(|(c, b)| c * b).sum())
        .collect();
    let amplitude = |harmonic: usize| {
        let (re, im) = heard.iter().enumerate().fold((0.0, 0.0), |(re, im), (step, value)| {
            let (sin, cos) = (TAU * (harmonic * step % STEPS) as f64 / STEPS as f64).sin_cos();
            (re + value * cos, im + value * sin)
        });
        2.0 / STEPS as f64 * re.hypot(im)
    };
    let strongest = (1..STEPS / 2).max_by(|a, b| amplitude(*a).total_cmp(&amplitude(*b))).unwrap();
    // T = Γ L d²/4 [[sin 2φ, -cos 2φ], [-cos 2φ, -sin 2φ]] over the length L that counts: the box's height less the
    // halves of both tapers. Thrice derived it gains (2Ω)³; across the axis it is heard by (x² + y²).
    let length_m = 0.75 * SHAPE[2] as f64 * VOXEL_M;
    let across = RECEIVER[0].powi(2) + RECEIVER[1].powi(2);
    let expected = circulation * length_m * apart_m.powi(2) / 4.0 * (2.0 * rate).powi(3) * across;
    (strongest, amplitude(strongest), expected)
}

#[test]
fn a_pair_of_vortices_sounds_at_twice_its_rotation_and_with_the_fourth_power_of_its_speed() {
    let points: Vec<(f64, f64)> = [1.0, 2.0, 4.0, 8.0]
        .into_iter()
        .map(|speed| {
            let (harmonic, amplitude, expected) = circling_pair(speed);
            println!("{speed} m/s: harmonic {harmonic}, amplitude {amplitude:.4e}, by theory {expected:.4e}");
            assert_eq!(harmonic, 2, "{speed} m/s");
            assert!((amplitude / expected - 1.0).abs() < 0.02, "{speed} m/s: {amplitude} instead of {expected}");
            (f64::ln(speed), amplitude.ln())
        })
        .collect();
    let mean = |value: fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let power = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
    println!("amplitude grows with speed to the power of {power:.4}");
    // Circulation grows with the speed, and each derivative gives one more.
    assert!((power - 4.0).abs() < 1e-3, "{power}");
}

fn noise(seed: u64, counts: impl Fn([f64; 3]) -> f64) -> Vorticity {
    let random = std::cell::RefCell::new(Random::new(seed));
    Vorticity::from_fn(SHAPE, VOXEL_M, |place| std::array::from_fn(|_| counts(place) * random.borrow_mut().normal()))
}

#[test]
fn the_source_has_no_trace_and_no_mean_over_directions() {
    for origin in [Origin::Centre, Origin::Cells] {
        let integral = Integral::new(SHAPE, VOXEL_M, origin);
        let field = noise(3, |_| 1.0);
        let tensor = integral.tensor(&field);
        let size = tensor.iter().flatten().map(|t| t * t).sum::<f64>().sqrt();
        assert!(size > 0.0);
        let trace = tensor[0][0] + tensor[1][1] + tensor[2][2];
        assert!(trace.abs() < 1e-12 * size, "{origin:?}: trace {trace} of {size}");
        let components = integral.components(&field);
        let heard = |x: [f64; 3]| components.iter().zip(directivity(x)).map(|(c, b)| c * b).sum::<f64>();
        // The corners of an icosahedron: their mean is that over the sphere for all up to the fifth degree.
        let golden = 0.5 * (1.0 + 5f64.sqrt());
        let norm = (1.0 + golden * golden).sqrt();
        let mut mean = 0.0;
        for axis in 0..3 {
            for signs in 0..4 {
                let mut x = [0.0; 3];
                x[axis] = if signs & 1 == 0 { 1.0 } else { -1.0 } / norm;
                x[(axis + 1) % 3] = if signs & 2 == 0 { golden } else { -golden } / norm;
                let direct: f64 = (0..3).map(|i| (0..3).map(|j| x[i] * tensor[i][j] * x[j]).sum::<f64>()).sum();
                assert!((heard(x) - direct).abs() < 1e-12 * size, "{origin:?}: {x:?}");
                mean += heard(x) / 12.0;
            }
        }
        assert!(mean.abs() < 1e-12 * size, "{origin:?}: mean {mean} of {size}");
    }
}

/// The paper's cells hear nothing of what happens in the interior; at the sides they do.
#[test]
fn the_papers_cells_cancel_in_the_interior() {
    let size = |field: &Vorticity, origin| {
        let tensor = Integral::new(SHAPE, VOXEL_M, origin).tensor(field);
        tensor.iter().flatten().map(|t| t * t).sum::<f64>().sqrt()
    };
    let half = SHAPE.map(|size| 0.5 * size as f64 * VOXEL_M);
    let depth = move |place: [f64; 3]| {
        (0..3).map(|axis| (half[axis] - place[axis].abs()) / VOXEL_M).fold(f64::INFINITY, f64::min)
    };
    // What one cell hears of a voxel beside its own, of which all cells' sum must be seen.
    let single = |field: &Vorticity| {
        let power: f64 = field.values().iter().flatten().map(|w| w * w).sum();
        power.sqrt() * VOXEL_M.powi(5)
    };
    let inner = noise(5, |place| if depth(place) > 1.0 { 1.0 } else { 0.0 });
    let all = noise(5, |_| 1.0);
    let level = |field: &Vorticity| 20.0 * (size(field, Origin::Cells) / single(field)).log10();
    println!("paper's cells: interior {:.0} dB, with the sides {:.1} dB", level(&inner), level(&all));
    assert!(level(&inner) < -72.0);
    assert!(level(&all) > -40.0);
    assert!(size(&inner, Origin::Centre) > 1e3 * size(&inner, Origin::Cells));
}

#[test]
fn an_even_flow_is_silent() {
    let gain = |perturbation| Recipe { perturbation, ..recipe(FlowModel::Wind) }.record(4.0, |_| true).unwrap().gain;
    let (even, disturbed) = (gain(0.0), gain(0.1));
    println!("even {even:.2e} Pa, disturbed by a tenth {disturbed:.2e} Pa");
    assert!(disturbed > 0.0 && even < 1e-6 * disturbed, "{even} beside {disturbed}");
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    for kind in [FlowModel::Fire, FlowModel::Jet] {
        let bytes = |seed: u64, threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let recipe = Recipe { seed, ..recipe(kind) };
                let record = |speed| recipe.record(speed, |_| true).unwrap();
                let rows = speeds(2.0, 4.0, 2).unwrap().into_iter().map(record).collect();
                VortexTexture::new(recipe.rate_hz, rows).unwrap().to_bytes()
            })
        };
        let one = bytes(1, 1);
        assert!(one == bytes(1, 3), "{kind:?}");
        assert!(one != bytes(2, 1), "{kind:?}");
    }
}

/// Without the crossfade the period's end would be heard.
#[test]
fn a_period_has_no_seam() {
    // Waves whose power falls steeply, as the source's does.
    let waves: Vec<[Wander; 5]> = (0..6u32)
        .map(|octave| {
            let low_hz = 4.0 * f64::from(1 << octave);
            std::array::from_fn(|c| Wander::new(u64::from(10 * octave) + c as u64, low_hz, 2.0 * low_hz))
        })
        .collect();
    let rate_hz = 1_000.0;
    let at = |step: usize| -> [f64; 5] {
        let wave =
            |octave: usize, c: usize| waves[octave][c].value_at(step as f64 / rate_hz) * 0.125f64.powi(octave as i32);
        std::array::from_fn(|c| 7.0 + (0..6).map(|octave| wave(octave, c)).sum::<f64>())
    };
    let values: Vec<[f64; 5]> = (0..5_000).map(at).collect();
    let seam = |recorded: usize| {
        let band = Band { pass_hz: 300.0, stop_hz: 400.0 };
        let row = Series::looped(&values[..recorded], 4_000, 1.0 / rate_hz).sound(16_000, band).row(1.0, 1.0);
        let power: f64 = row.components.iter().flatten().map(|value| f64::from(*value).powi(2)).sum();
        assert!((power / 16_000.0 - 1.0).abs() < 1e-3);
        crate::vortex_common::seam(row.components.each_ref().map(Vec::as_slice))
    };
    let ((faded, most), (cut, most_cut)) = (seam(5_000), seam(4_000));
    println!("across the seam {faded:.2} (99 of 100: {most:.2}); without a fade {cut:.2} ({most_cut:.2})");
    assert!(faded < most && cut > most_cut);
}

#[test]
fn senseless_recipes_are_refused() {
    let good = recipe(FlowModel::Fire);
    let says = |recipe: Recipe, part: &str| {
        let error = recipe.record(1.0, |_| true).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    };
    says(Recipe { voxels: [7, 8, 8], ..good }, "between 8 and 128");
    says(Recipe { voxel_size_m: f64::NAN, ..good }, "voxel size");
    says(Recipe { rate_hz: 1_999.0, ..good }, "2000");
    says(Recipe { rate_hz: 4_000.5, ..good }, "whole");
    says(Recipe { period_s: 0.0, ..good }, "period");
    says(Recipe { perturbation: 2.0, ..good }, "perturbation");
    assert!(good.record(0.0, |_| true).unwrap_err().to_string().contains("speed"));
    assert_eq!(good.record(1.0, |_| false).unwrap_err(), pyrophone_flame::Error::Cancelled);
    for (low, high, count) in [(0.0, 1.0, 3), (2.0, 1.0, 3), (1.0, 1.0, 3), (1.0, 1e9, 3), (1.0, 2.0, 0)] {
        assert!(speeds(low, high, count).is_err(), "{low}:{high}:{count}");
    }
    assert_eq!(speeds(1.0, 16.0, 3).unwrap(), [1.0, 4.0, 16.0]);
}
