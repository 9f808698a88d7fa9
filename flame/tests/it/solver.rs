//! The solver against what is known of flows.

use std::f64::consts::{PI, TAU};

use pyrophone_flame::solver::{
    Combustion, Cooling, Domain, Emitter, EmitterShape, Forcing, Mixing, Parameters, Poisson, Random, Side, Solver,
};
use pyrophone_flame::{Frame, Front};

/// The lower and upper side of each axis.
type Sides = [[Side; 2]; 3];

const OPEN: Sides = [[Side::Open; 2]; 3];
const CLOSED: Sides = [[Side::Wall; 2]; 3];
const PERIODIC: Sides = [[Side::Periodic; 2]; 3];

fn burner(centre_m: [f64; 3], radius_m: f64) -> Emitter {
    Emitter {
        shape: EmitterShape::Ball { radius_m },
        centre_m,
        velocity_m_s: [0.0, 0.0, 1.0],
        drag_hz: 50.0,
        fuel: 1.0,
        flicker: 0.5,
        temperature: 1.0,
        outflow_hz: 0.0,
    }
}

fn burning() -> Parameters {
    Parameters {
        combustion: Some(Combustion::Fuel { ignition: 0.2, rate_hz: 8.0, heat: 1.5, expansion: 2.0 }),
        cooling: Cooling { radiation_hz: 2.0, dissipation_hz: 0.5 },
        buoyancy_m_s2: 25.0,
        confinement: 0.3,
        turbulence_m_s2: 30.0,
        turbulence_scale_m: 0.3,
        turbulence_rate_hz: 6.0,
        mixing: Mixing { spread: 0.8, scale_m: 0.1, slowest_hz: 8.0, fastest_hz: 170.0 },
        ..Parameters::still()
    }
}

/// Largest divergence of the faces' flow less `source`, in 1/s.
fn divergence(solver: &Solver, source: impl Fn([usize; 3]) -> f64) -> f64 {
    let domain = solver.domain();
    let [nx, ny, nz] = domain.shape();
    let faces = solver.face_velocities();
    let value = |axis: usize, place: [usize; 3]| {
        let shape = domain.face_shape(axis);
        f64::from(faces[axis][(place[0] * shape[1] + place[1]) * shape[2] + place[2]])
    };
    let mut worst = 0.0f64;
    for place in (0..nx).flat_map(|i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k]))) {
        let leaving: f64 = (0..3)
            .map(|axis| {
                let mut after = place;
                after[axis] += 1;
                value(axis, after) - value(axis, place)
            })
            .sum();
        worst = worst.max((leaving / domain.voxel_size_m() - source(place)).abs());
    }
    worst
}

fn fastest(solver: &Solver) -> f64 {
    solver.face_velocities().iter().flat_map(|values| values.iter()).fold(0.0, |most, v| most.max(f64::from(v.abs())))
}

/// A flow that was random is free of divergence after one step, whatever the sides and sizes.
#[test]
fn pressure_leaves_no_divergence() {
    let mut mixed = OPEN;
    mixed[0] = [Side::Periodic; 2];
    mixed[2] = [Side::Inflow(1.5), Side::Open];
    for (name, sides) in [("open", OPEN), ("closed", CLOSED), ("periodic", PERIODIC), ("mixed", mixed)] {
        for shape in [[16, 16, 16], [10, 20, 10], [15, 15, 20], [5, 7, 9], [32, 16, 24]] {
            let domain = Domain::new(shape, 0.05, sides).unwrap();
            let mut solver = Solver::new(domain, Parameters::still(), 1).unwrap();
            let random = std::cell::RefCell::new(Random::new(7));
            solver.set_velocity(|_, _| random.borrow_mut().normal());
            let step = solver.step(1.0 / 360.0, &Forcing::default());
            let left = divergence(&solver, |_| 0.0);
            let allowed = 1e-4 * fastest(&solver) / 0.05;
            assert!(left <= allowed, "{name} {shape:?}: {left} 1/s left, {allowed} allowed");
            assert!(step.divergence_hz <= allowed, "{name} {shape:?}: told {}", step.divergence_hz);
            assert!(fastest(&solver) > 0.1, "{name} {shape:?}: nothing moves any more");
        }
    }
}

/// A source of volume is what the divergence becomes; in a closed box less its mean.
#[test]
fn a_burst_is_the_divergence() {
    for (sides, closed) in [(OPEN, false), (CLOSED, true)] {
        let domain = Domain::new([16; 3], 0.1, sides).unwrap();
        let mut solver = Solver::new(domain, Parameters::still(), 1).unwrap();
        let origin = solver.origin_m();
        let ball = Emitter { outflow_hz: 20.0, drag_hz: 0.0, ..burner([0.0, 0.0, 0.8], 0.3) };
        solver.step(1.0 / 360.0, &Forcing { emitters: vec![ball], ..Forcing::default() });
        let source = |place: [usize; 3]| {
            let place = std::array::from_fn(|axis| origin[axis] + place[axis] as f64 * 0.1);
            20.0 * ball.cover(place, 0.1)
        };
        let cells = (0..16).flat_map(|i| (0..16).flat_map(move |j| (0..16).map(move |k| [i, j, k])));
        let mean = if closed { cells.map(source).sum::<f64>() / 4096.0 } else { 0.0 };
        let left = divergence(&solver, |place| source(place) - mean);
        assert!(left < 1e-3 * 20.0, "closed {closed}: {left} 1/s off");
    }
}

/// Poisson's equation with a known solution: second order, on all kinds of sides.
#[test]
fn pressure_converges_with_second_order() {
    let errors = |sides: Sides, wave: fn(f64) -> f64| {
        [16usize, 32].map(|n| {
            let h = 1.0 / n as f64;
            let domain = Domain::new([n; 3], h, sides).unwrap();
            let at = |i: usize| wave((i as f64 + 0.5) * h);
            let exact = |index: usize| at(index / (n * n)) * at(index / n % n) * at(index % n);
            let mut right: Vec<f32> = (0..n * n * n).map(|index| (-3.0 * PI * PI * exact(index)) as f32).collect();
            let mut found = vec![0.0; n * n * n];
            Poisson::new(&domain).solve(&mut right, &mut found, 1e-3);
            (0..n * n * n).map(|index| (f64::from(found[index]) - exact(index)).abs()).fold(0.0, f64::max)
        })
    };
    let open = errors(OPEN, |x| (PI * x).sin());
    let closed = errors(CLOSED, |x| (PI * x).cos());
    for (name, [coarse, fine]) in [("open", open), ("closed", closed)] {
        assert!(coarse < 0.01 && coarse / fine > 3.5, "{name}: error {coarse}, then {fine}");
    }
}

/// Two-dimensional Taylor-Green vortices in a periodic box keep their shape and decay as exp(-2 nu k² t). What the method
/// itself takes of their energy is little, and halves with the grid and the step: advection and projection are split.
#[test]
fn taylor_green_vortices_decay_at_the_analytic_rate() {
    let energy = |solver: &Solver| -> f64 {
        solver.face_velocities()[..2].iter().flat_map(|v| v.iter()).map(|v| f64::from(*v).powi(2)).sum()
    };
    for viscosity_m2_s in [0.01, 0.0] {
        let lost = [32usize, 64].map(|n| {
            let domain = Domain::new([n, n, 4], TAU / n as f64, PERIODIC).unwrap();
            let mut solver = Solver::new(domain, Parameters { viscosity_m2_s, ..Parameters::still() }, 1).unwrap();
            solver.set_velocity(|axis, [x, y, _]| match axis {
                0 => x.cos() * y.sin(),
                1 => -x.sin() * y.cos(),
                _ => 0.0,
            });
            let before = energy(&solver);
            let (steps, dt_s) = (n + n / 2, 64.0 * 0.02 / n as f64);
            for _ in 0..steps {
                solver.step(dt_s, &Forcing::default());
            }
            // Energy goes with the square of the speed.
            let expected = (-4.0 * viscosity_m2_s * steps as f64 * dt_s).exp();
            1.0 - energy(&solver) / before / expected
        });
        assert!((0.0..0.02).contains(&lost[1]), "viscosity {viscosity_m2_s}: {} of the energy is lost", lost[1]);
        assert!(lost[0] / lost[1] > 1.8, "viscosity {viscosity_m2_s}: lost {lost:?}");
    }
}

/// A hot ball that rests rises straight up, alike on all sides.
#[test]
fn a_buoyant_column_stays_symmetric() {
    let n = 24usize;
    let domain = Domain::new([n, n, 32], 0.05, OPEN).unwrap();
    let parameters = Parameters { buoyancy_m_s2: 20.0, confinement: 0.3, ..Parameters::still() };
    let mut solver = Solver::new(domain, parameters, 1).unwrap();
    let ball = Emitter { flicker: 0.0, drag_hz: 0.0, ..burner([0.0, 0.0, 0.4], 0.2) };
    for _ in 0..60 {
        solver.step(1.0 / 120.0, &Forcing { emitters: vec![ball], ..Forcing::default() });
    }
    let temperatures: Vec<f32> = solver.temperatures().collect();
    let at = |i: usize, j: usize, k: usize| temperatures[(i * n + j) * 32 + k];
    let mut rise = 0.0f32;
    for (i, j, k) in (0..n).flat_map(|i| (0..n).flat_map(move |j| (0..32).map(move |k| (i, j, k)))) {
        for other in [at(n - 1 - i, j, k), at(i, n - 1 - j, k), at(j, i, k)] {
            assert!((at(i, j, k) - other).abs() < 1e-3, "({i}, {j}, {k}): {} and {other}", at(i, j, k));
        }
        if at(i, j, k) > 0.5 {
            rise = rise.max(k as f32);
        }
    }
    assert!(rise > 20.0, "the column reaches cell {rise} only");
}

/// A blue core's ball of gas that nothing feeds is eaten up at the flame's speed.
#[test]
fn a_blue_core_shrinks_at_the_flame_speed() {
    let (n, h, speed) = (32usize, 0.02, 0.5);
    let parameters = Parameters {
        combustion: Some(Combustion::BlueCore { flame_speed_m_s: speed, expansion: 0.0, depth_m: 0.06, fall_s: 0.2 }),
        ..Parameters::still()
    };
    let mut solver = Solver::new(Domain::new([n; 3], h, OPEN).unwrap(), parameters, 1).unwrap();
    let ball = Emitter { drag_hz: 0.0, ..burner([0.0, 0.0, 0.32], 0.2) };
    solver.step(1e-6, &Forcing { emitters: vec![ball], ..Forcing::default() });
    let radius = |solver: &Solver| {
        let inside = solver.fuels().filter(|distance| *distance < 0.0).count() as f64;
        (3.0 * inside / (4.0 * PI)).cbrt() * h
    };
    let (first, steps) = (radius(&solver), 54);
    for _ in 0..steps {
        solver.step(1.0 / 360.0, &Forcing::default());
    }
    let eaten = first - radius(&solver);
    let expected = speed * f64::from(steps) / 360.0;
    for _ in 0..150 {
        solver.step(1.0 / 360.0, &Forcing::default());
    }
    assert!(radius(&solver) == 0.0, "a wisp of {} m burns for ever", radius(&solver));
    // What is listened to goes out with it.
    assert!(solver.centred().0.iter().all(|value| value[0] < 0.5), "hot gas stays behind");
    assert!((eaten / expected - 1.0).abs() < 0.1, "{eaten} m eaten instead of {expected}");
}

/// A ball of burning gas that the wind carries through the cells: its front keeps its size while it is carried, rather than
/// to gain and lose whole cells, which would be heard.
#[test]
fn a_front_is_carried_without_steps() {
    let (h, n) = (0.025, 32usize);
    let combustion = Some(Combustion::Fuel { ignition: 0.2, rate_hz: 0.5, heat: 0.0, expansion: 0.0 });
    let parameters = Parameters { combustion, ..Parameters::still() };
    let mut solver = Solver::new(Domain::new([n; 3], h, PERIODIC).unwrap(), parameters, 1).unwrap();
    let ball = Emitter { drag_hz: 0.0, flicker: 0.0, ..burner([0.0, 0.0, 0.4], 0.15) };
    solver.set_velocity(|axis, _| [1.0, 0.7, 0.4][axis]);
    solver.step(1.0 / 360.0, &Forcing { emitters: vec![ball], ..Forcing::default() });
    let front = Front::new(0.5, 2).unwrap();
    let measured: Vec<[f64; 2]> = (0..90)
        .map(|_| {
            solver.step(1.0 / 360.0, &Forcing::default());
            let frame = solver.front_frame(0).unwrap();
            // The same with whole cells that burn or do not.
            let switched = frame.field.clone().map(|[value]| [if value > 0.5 { 1.0 } else { 0.0 }]);
            [frame.clone(), Frame { field: switched, ..frame }].map(|frame| front.measure(&frame).unwrap().area)
        })
        .collect();
    // What is left beside the slow change as the ball burns out and blurs.
    let [carried, switched] = [0, 1].map(|which: usize| {
        let bends = measured.windows(3).map(|w| (w[0][which] - 2.0 * w[1][which] + w[2][which]) / w[1][which]);
        (bends.map(|x| x * x).sum::<f64>() / measured.len() as f64).sqrt()
    });
    assert!(measured[89][0] > 0.1, "area {:?} m²", measured[89]);
    assert!(carried < 0.2 * switched, "steps of {carried:.1e}, with whole cells {switched:.1e}");
}

/// Gas that is mixed twice as fast burns twice as fast.
#[test]
fn mixing_sets_the_burn_rate() {
    let released = |mixing_boost: f64| {
        let parameters = Parameters { mixing: Mixing::EVEN, ..burning() };
        let mut solver = Solver::new(Domain::new([16; 3], 0.05, OPEN).unwrap(), parameters, 3).unwrap();
        let emitters = vec![Emitter { flicker: 0.0, ..burner([0.0, 0.0, 0.4], 0.2) }];
        solver.step(1.0 / 360.0, &Forcing { emitters, mixing_boost, ..Forcing::default() });
        solver.sources().map(f64::from).sum::<f64>()
    };
    let (usual, twice, none) = (released(0.0), released(1.0), released(-1.0));
    assert!((twice / usual - 2.0).abs() < 0.05, "{twice} after {usual}");
    assert!(none < 0.01 * usual, "{none} without any mixing");
}

/// The number of threads, and an interruption, change nothing.
#[test]
fn runs_repeat_bit_for_bit() {
    let make = || {
        let domain = Domain::new([24, 16, 24], 0.04, OPEN).unwrap();
        Solver::new(domain, burning(), 3).unwrap()
    };
    let surroundings = Forcing { emitters: vec![burner([0.0, 0.0, 0.2], 0.12)], ..Forcing::default() };
    let run = |solver: &mut Solver, steps: usize| {
        for _ in 0..steps {
            solver.step(1.0 / 360.0, &surroundings);
        }
    };
    let mut whole = make();
    run(&mut whole, 20);
    assert!(whole.centred().0.iter().any(|value| value[0] > 0.5), "nothing burns");

    let mut alone = make();
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| run(&mut alone, 20));
    assert_eq!(whole.centred(), alone.centred());

    let mut first = make();
    run(&mut first, 9);
    let mut saved = vec![];
    first.save(&mut saved).unwrap();
    let mut second = make();
    run(&mut second, 3);
    second.load(saved.as_slice()).unwrap();
    run(&mut second, 11);
    assert_eq!(whole.centred(), second.centred());
    second.reset();
    run(&mut second, 20);
    assert_eq!(whole.centred(), second.centred());

    for broken in [&saved[..saved.len() - 1], &saved[..10], &[], &saved[1..]] {
        assert!(second.load(broken).is_err());
        assert_eq!(second.time_s(), 0.0);
    }
    let mut other = Solver::new(Domain::new([24, 16, 24], 0.04, OPEN).unwrap(), burning(), 4).unwrap();
    assert!(other.load(saved.as_slice()).is_err(), "another seed's run was taken");
}

#[test]
fn senseless_boxes_and_gases_are_refused() {
    assert!(Domain::new([0, 8, 8], 0.1, OPEN).is_err());
    assert!(Domain::new([1024; 3], 0.1, OPEN).is_err());
    assert!(Domain::new([8; 3], f64::NAN, OPEN).is_err());
    assert!(Domain::new([8; 3], 0.1, [[Side::Periodic, Side::Open]; 3]).is_err());
    assert!(Domain::new([8; 3], 0.1, [[Side::Inflow(f64::INFINITY), Side::Open]; 3]).is_err());
    let domain = Domain::new([8; 3], 0.1, OPEN).unwrap();
    for broken in [
        Parameters { buoyancy_m_s2: f64::NAN, ..burning() },
        Parameters { turbulence_scale_m: 0.0, ..burning() },
        Parameters { viscosity_m2_s: -1.0, ..burning() },
        Parameters { mixing: Mixing { spread: 9.0, ..Mixing::EVEN }, ..burning() },
        Parameters { mixing: Mixing { fastest_hz: 0.5, ..Mixing::EVEN }, ..burning() },
    ] {
        assert!(Solver::new(domain.clone(), broken, 1).is_err());
    }
}
