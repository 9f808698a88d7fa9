//! A flow that is simulated while it sounds: the coarse simulation of Dobashi et al. 2004, §6, at some 60 steps a second.
//!
//! It is simulated elsewhere, since a step takes longer than a block may. Steps are counted from reset, and what an
//! envelope has told during step k is asked for at the end of it, to be heard from the end of step k + 1 on: a whole
//! step of time for the simulation, so that every start repeats. A step that is late holds the one before.

use super::field::{FARTHEST_M, SourceState};
use crate::error::Error;

/// Speed in m/s that is taken off all: what it leaves of gas that nothing blows at is nothing, within some seconds.
const CALM_M_S: f32 = 0.25;

/// Fastest speed that is believed, in m/s.
const FASTEST_M_S: f32 = 1e4;

/// About how many steps there are per second.
const STEPS_PER_S: f64 = 60.0;

/// What a simulation is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// Which start of the sound the step belongs to; every one begins in still gas.
    pub run: u64,
    /// Number of the step, from 0; a run's steps are asked for in their order.
    pub step: u64,
    /// Speed in m/s at which gas comes in.
    pub speed_m_s: f64,
}

/// A simulation of gas, here or elsewhere. Both calls are made on the audio thread.
pub trait Simulator: Send {
    /// Takes note of a step to be simulated.
    fn ask(&mut self, asked: Asked);

    /// Writes the sources' speeds in m/s after a step that was asked for; whether they are there.
    fn answer(&mut self, run: u64, step: u64, speeds_m_s: &mut [f32]) -> bool;
}

/// The audio thread's side of a simulation.
pub(super) struct Live {
    simulator: Box<dyn Simulator>,
    places: Vec<[f64; 3]>,
    /// Speeds between which the present step leads, and room for those to come.
    speeds: [Vec<f32>; 2],
    coming: Vec<f32>,
    hops_per_step: u64,
    run: u64,
    /// Hops since the run began; none before.
    hop: Option<u64>,
    /// Hops since the present step began; what is stopped stands still there.
    into: u64,
    /// Sum over the step's hops of the speed that is asked for.
    asked_m_s: f64,
    late: u64,
}

impl std::fmt::Debug for Live {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Live").field("run", &self.run).field("hop", &self.hop).finish_non_exhaustive()
    }
}

/// Hops of a step.
pub fn hops_per_step(sample_rate_hz: f64, hop: usize) -> u64 {
    (sample_rate_hz / (STEPS_PER_S * hop as f64)).round().max(1.0) as u64
}

impl Live {
    /// For sources at `places`, in m to the right, to the front and up.
    ///
    /// Fails without a place, and where one is no number or farther than 100 km.
    pub fn new(simulator: Box<dyn Simulator>, places: &[[f32; 3]], hops_per_step: u64) -> Result<Self, Error> {
        let far = |value: &f32| !(-FARTHEST_M..=FARTHEST_M).contains(value);
        if places.is_empty() || places.iter().flatten().any(far) {
            return Err(Error::SpeedField {
                reason: "a simulation has no positions, or some are out of range".to_owned(),
            });
        }
        let still = vec![0.0; places.len()];
        Ok(Self {
            simulator,
            places: places.iter().map(|place| place.map(f64::from)).collect(),
            speeds: [still.clone(), still.clone()],
            coming: still,
            hops_per_step: hops_per_step.max(1),
            run: 0,
            hop: None,
            into: 0,
            asked_m_s: 0.0,
            late: 0,
        })
    }

    /// Number of sources.
    pub fn sources(&self) -> usize {
        self.places.len()
    }

    /// Steps that came too late since the last call.
    pub fn take_late(&mut self) -> u64 {
        std::mem::take(&mut self.late)
    }

    /// Still gas.
    pub fn reset(&mut self) {
        self.stop();
        self.into = 0;
        self.speeds.iter_mut().for_each(|speeds| speeds.fill(0.0));
    }

    /// The next hop starts a run of its own.
    pub fn stop(&mut self) {
        self.hop = None;
    }

    /// One hop on, for which gas comes in at `speed_m_s`.
    pub fn advance(&mut self, speed_m_s: f64) {
        let hop = match self.hop {
            Some(hop) => hop + 1,
            None => {
                self.run += 1;
                self.speeds.iter_mut().for_each(|speeds| speeds.fill(0.0));
                self.asked_m_s = 0.0;
                0
            }
        };
        self.hop = Some(hop);
        self.into = hop % self.hops_per_step;
        if hop > 0 && hop.is_multiple_of(self.hops_per_step) {
            let step = hop / self.hops_per_step;
            let speed_m_s = std::mem::take(&mut self.asked_m_s) / self.hops_per_step as f64;
            if let Some(heard) = step.checked_sub(2) {
                self.take(heard);
            }
            self.simulator.ask(Asked { run: self.run, step: step - 1, speed_m_s });
        }
        self.asked_m_s += speed_m_s;
    }

    /// From what was heard to a step's speeds.
    fn take(&mut self, step: u64) {
        let [from, to] = &mut self.speeds;
        std::mem::swap(from, to);
        if self.simulator.answer(self.run, step, &mut self.coming) {
            for (to, speed) in to.iter_mut().zip(&self.coming) {
                // What is no number is calm too.
                *to = if *speed > CALM_M_S { (speed - CALM_M_S).min(FASTEST_M_S) } else { 0.0 };
            }
        } else {
            to.copy_from_slice(from);
            self.late += 1;
        }
    }

    /// A source at the start of the hop, or at its end.
    pub fn at(&self, source: usize, end: bool) -> SourceState {
        let into = self.into + u64::from(end && self.hop.is_some());
        let part = into as f32 / self.hops_per_step as f32;
        let [from, to] = [0, 1].map(|which: usize| self.speeds[which][source]);
        SourceState { position: self.places[source], speed_m_s: f64::from(from + part * (to - from)), presence: 1.0 }
    }
}
