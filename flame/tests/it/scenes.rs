//! Every scene burns, whatever is asked of it.

use pyrophone_flame::Front;
use pyrophone_flame::scenes::{Options, Scene, Simulation};

fn options(resolution: usize) -> Options {
    Options { resolution, ..Options::default() }
}

/// Seconds that each scene is run for.
fn seconds() -> f64 {
    if std::env::var_os("PYROPHONE_SOAK").is_some() { 10.0 } else { 0.15 }
}

#[test]
fn no_extreme_makes_a_scene_lose_its_numbers() {
    for scene in Scene::ALL {
        for (intensity, wind, turbulence) in [(1.0, 1.0, 1.0), (4.0, 4.0, 4.0), (0.0, 4.0, 0.0), (4.0, 0.0, 4.0)] {
            let options = Options { intensity, wind, turbulence, ..options(16) };
            let mut simulation = Simulation::new(scene, options).unwrap();
            for _ in 0..(360.0 * seconds()) as usize {
                simulation.step();
                assert!(
                    simulation.solver().is_finite(),
                    "{}: {options:?} at step {}",
                    scene.name(),
                    simulation.steps()
                );
            }
        }
    }
}

#[test]
fn every_scene_burns_and_repeats_by_seed() {
    for scene in Scene::ALL {
        let run = |seed: u64| {
            let mut simulation = Simulation::new(scene, Options { seed, ..options(16) }).unwrap();
            for _ in 0..60 {
                simulation.step();
            }
            simulation.solver().centred()
        };
        let first = run(1);
        assert!(first.0.iter().any(|value| value[0] > 0.5), "{}: nothing burns", scene.name());
        assert_eq!(first, run(1), "{}", scene.name());
        assert_ne!(first, run(2), "{}: the seed changes nothing", scene.name());
    }
}

/// Leaving out the flow away from the front does not change the flux.
#[test]
fn flux_needs_the_flow_near_the_front_alone() {
    let front = Front::new(0.5, 2).unwrap();
    for scene in Scene::ALL {
        let mut simulation = Simulation::new(scene, options(32)).unwrap();
        for _ in 0..50 {
            simulation.step();
        }
        let (whole, near) = (simulation.frame().unwrap(), simulation.front_frame().unwrap());
        let measured = front.measure(&near).unwrap();
        assert_eq!(front.measure(&whole).unwrap(), measured, "{}", scene.name());
        assert!(measured.area > 0.0 && near.number == whole.number, "{}", scene.name());
    }
}

#[test]
fn a_saved_scene_goes_on_as_if_nothing_had_been() {
    let scene = Scene::Torch;
    let mut whole = Simulation::new(scene, options(16)).unwrap();
    let mut first = Simulation::new(scene, options(16)).unwrap();
    let mut saved = vec![];
    for step in 0..20 {
        whole.step();
        if step < 8 {
            first.step();
        }
    }
    first.save(&mut saved).unwrap();
    let mut second = Simulation::new(scene, options(16)).unwrap();
    second.load(saved.as_slice()).unwrap();
    assert_eq!(second.steps(), 8);
    for _ in 8..20 {
        second.step();
    }
    assert_eq!(whole.solver().centred(), second.solver().centred());
    assert!(second.load(&saved[..40]).is_err());
    assert_eq!(second.steps(), 0);
}

#[test]
fn names_lead_to_their_scenes() {
    for scene in Scene::ALL {
        assert_eq!(Scene::from_name(scene.name()), Some(scene));
    }
    assert_eq!(Scene::from_name("bonfire"), None);
    assert!(Simulation::new(Scene::Candle, options(7)).is_err());
    assert!(Simulation::new(Scene::Candle, Options { wind: f64::NAN, ..options(16) }).is_err());
}

/// Dobashi's flamethrower is as small as the paper's.
#[test]
fn the_smallest_flamethrower_is_ten_by_twenty_by_ten() {
    let simulation = Simulation::new(Scene::Flamethrower, options(20)).unwrap();
    assert_eq!(simulation.solver().domain().shape(), [10, 20, 10]);
}
