//! A small flow, simulated during playback (Dobashi et al. 2004, §6: 15 × 15 × 20 voxels).

use pyrophone_synthesis::vortex::{Simulator, StepRequest};

use crate::error::Error;
use crate::solver::{Domain, Emitter, EmitterShape, Forcing, Parameters, Side, Solver};
use crate::speed_field::{Regions, Up};

/// Voxels of the box, vertical axis last, and their edge in m.
const VOXELS: [usize; 3] = [15, 15, 20];
const VOXEL_M: f64 = 0.05;

/// Radius and half-height in m of the hot-gas inlet at the bottom.
const RADIUS_M: f64 = 0.15;
const HALF_HEIGHT_M: f64 = 0.05;

/// Speed in m/s at which the incoming gas reaches its highest temperature.
const HOT_M_S: f64 = 1.0;
/// Speed in m/s below which nothing blows.
const CALM_M_S: f64 = 0.05;
/// Upward acceleration of the hottest gas in m/s²: three times the temperature of air.
const BUOYANCY_M_S2: f64 = 20.0;
/// Cooling rate of the hottest gas, in 1/s.
const COOLING_HZ: f64 = 30.0;
/// Stirring of hot gas, rms in m/s² per component, and its scale in m and pace in 1/s.
const STIRRING_M_S2: f64 = 15.0;
const STIRRING_M: f64 = 0.3;
const STIRRING_HZ: f64 = 6.0;
/// Damping rate of gas that nothing drives, in 1/s.
const REST_HZ: f64 = 2.5;
const CONFINEMENT: f64 = 4.0;

/// Seed of all randomness.
const SEED: u64 = 1;

/// Hot gas, blown in at the bottom of an open box at a speed that changes from step to step.
#[derive(Debug)]
pub struct LiveFlow {
    solver: Solver,
    regions: Regions,
    step_s: f64,
}

impl LiveFlow {
    /// Gas at rest, with a step of `step_s` (0.0001-1 s).
    ///
    /// # Errors
    /// If `step_s` is out of range.
    pub fn new(step_s: f64) -> Result<Self, Error> {
        crate::error::in_range("time step in s", step_s, 1e-4, 1.0)?;
        let sides = [[Side::Open; 2], [Side::Open; 2], [Side::Wall, Side::Open]];
        let mut parameters = Parameters {
            buoyancy_m_s2: BUOYANCY_M_S2,
            confinement: CONFINEMENT,
            turbulence_m_s2: STIRRING_M_S2,
            turbulence_scale_m: STIRRING_M,
            turbulence_rate_hz: STIRRING_HZ,
            ..Parameters::still()
        };
        parameters.cooling.radiation_hz = COOLING_HZ;
        let solver = Solver::new(Domain::new(VOXELS, VOXEL_M, sides)?, parameters, SEED)?;
        let regions = Regions::of_solver(&solver);
        Ok(Self { solver, regions, step_s })
    }

    /// Returns to gas at rest.
    pub fn reset(&mut self) {
        self.solver.reset();
    }

    /// Positions of the sub-volumes in m: to the right, to the front and up from the centre of the bottom.
    pub fn places(&self) -> Vec<[f32; 3]> {
        self.regions.places(Up::Z)
    }

    /// Takes one step, with gas entering at `speed_m_s` (0-100), and returns the sub-volumes' mean speeds in m/s.
    ///
    /// # Errors
    /// If the gas's velocity has no field, which is a fault of the solver.
    pub fn step(&mut self, speed_m_s: f64) -> Result<Vec<f32>, Error> {
        let speed_m_s = if speed_m_s.is_nan() { 0.0 } else { speed_m_s.clamp(0.0, 100.0) };
        let emitter = Emitter {
            shape: EmitterShape::Cylinder { radius_m: RADIUS_M, half_height_m: HALF_HEIGHT_M },
            centre_m: [0.0, 0.0, HALF_HEIGHT_M],
            velocity_m_s: [0.0, 0.0, speed_m_s],
            drag_hz: 0.5 / self.step_s,
            fuel: 0.0,
            flicker: 0.0,
            temperature: (speed_m_s / HOT_M_S).min(1.0),
            outflow_hz: 0.0,
        };
        let half_m = VOXELS.map(|voxels| 0.5 * voxels as f64 * VOXEL_M);
        let rest = Emitter {
            shape: EmitterShape::Box { half_m },
            centre_m: [0.0, 0.0, half_m[2]],
            velocity_m_s: [0.0; 3],
            drag_hz: REST_HZ,
            temperature: 0.0,
            ..emitter
        };
        // Gas held at rest would stay hot there for good.
        let blows = Some(emitter).filter(|_| speed_m_s > CALM_M_S);
        let emitters = std::iter::once(rest).chain(blows).collect();
        let surroundings = Forcing { emitters, ..Forcing::default() };
        self.solver.step(self.step_s, &surroundings);
        Ok(self.regions.mean_speeds(&self.solver.frame(0)?.velocity))
    }
}

/// A simulation on the calling thread: for renders, which wait for their results.
#[derive(Debug)]
pub struct Inline {
    flow: LiveFlow,
    run: u64,
    /// The last two requested steps, with their speeds.
    done: [Option<(u64, Vec<f32>)>; 2],
}

impl Inline {
    /// A simulation before its first run.
    pub fn new(flow: LiveFlow) -> Self {
        Self { flow, run: 0, done: [None, None] }
    }
}

impl Simulator for Inline {
    fn request(&mut self, request: StepRequest) {
        if request.run != self.run {
            self.run = request.run;
            self.flow.reset();
            self.done = [None, None];
        }
        let [older, newer] = &mut self.done;
        *older = newer.take();
        *newer = self.flow.step(request.speed_m_s).ok().map(|speeds| (request.step, speeds));
    }

    fn answer(&mut self, run: u64, step: u64, speeds_m_s: &mut [f32]) -> bool {
        let done = self.done.iter().flatten().find(|(done, speeds)| *done == step && speeds.len() == speeds_m_s.len());
        match done {
            Some((_, speeds)) if run == self.run => {
                speeds_m_s.copy_from_slice(speeds);
                true
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.016;

    fn run(flow: &mut LiveFlow, steps: usize, speed: impl Fn(usize) -> f64) -> Vec<Vec<f32>> {
        (0..steps).map(|step| flow.step(speed(step)).unwrap()).collect()
    }

    fn fastest(speeds: &[f32]) -> f32 {
        speeds.iter().copied().fold(0.0, f32::max)
    }

    #[test]
    fn gas_follows_what_blows_and_comes_to_rest() {
        let mut flow = LiveFlow::new(STEP_S).unwrap();
        let steps = run(&mut flow, 700, |step| if step < 100 { 6.0 } else { 0.0 });
        let (blown, over) = (fastest(&steps[90]), fastest(&steps[699]));
        assert!((1.5..9.0).contains(&blown), "{blown} m/s");
        assert!(over < 0.2, "{over} m/s ten seconds later, which is heard no more");
        let slower = fastest(&run(&mut LiveFlow::new(STEP_S).unwrap(), 91, |_| 3.0)[90]);
        assert!(slower < 0.8 * blown, "{slower} and {blown} m/s");
        // Gas blown in below arrives at the top later.
        let places = flow.places();
        let first = |which: &dyn Fn(f32) -> bool| {
            let moves = |step: &Vec<f32>| step.iter().zip(&places).any(|(v, place)| which(place[2]) && *v > 0.5);
            steps.iter().position(moves).unwrap()
        };
        assert!(first(&|up| up < 0.2) < first(&|up| up > 0.8));
    }

    #[test]
    fn a_reset_flow_is_a_fresh_one() {
        let mut used = LiveFlow::new(STEP_S).unwrap();
        run(&mut used, 30, |step| step as f64 * 0.1);
        used.reset();
        let mut fresh = LiveFlow::new(STEP_S).unwrap();
        assert_eq!(run(&mut used, 40, |_| 5.0), run(&mut fresh, 40, |_| 5.0));
    }

    #[test]
    fn bad_speeds_leave_finite_gas() {
        let mut flow = LiveFlow::new(STEP_S).unwrap();
        for bad in [f64::NAN, f64::INFINITY, -5.0, 1e300] {
            assert!(run(&mut flow, 20, |_| bad).iter().flatten().all(|speed| speed.is_finite()), "{bad}");
        }
        assert!(LiveFlow::new(0.0).is_err() && LiveFlow::new(f64::NAN).is_err());
    }

    #[test]
    fn inline_answers_the_last_two_steps_of_the_run() {
        let mut inline = Inline::new(LiveFlow::new(STEP_S).unwrap());
        let mut speeds = vec![0.0; inline.flow.places().len()];
        let request = |run, step| StepRequest { run, step, speed_m_s: 4.0 };
        (0..3).for_each(|step| inline.request(request(1, step)));
        assert!(
            !inline.answer(1, 0, &mut speeds) && inline.answer(1, 1, &mut speeds) && inline.answer(1, 2, &mut speeds)
        );
        assert!(!inline.answer(2, 2, &mut speeds) && !inline.answer(1, 2, &mut speeds[1..]));
        let mut flow = LiveFlow::new(STEP_S).unwrap();
        assert_eq!(speeds, run(&mut flow, 3, |_| 4.0)[2]);
        inline.request(request(2, 0));
        assert!(inline.answer(2, 0, &mut speeds));
        assert_eq!(speeds, run(&mut LiveFlow::new(STEP_S).unwrap(), 1, |_| 4.0)[0]);
    }
}
