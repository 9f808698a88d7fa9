//! A flow simulated during playback: the coarse simulation of Dobashi et al. 2004, §6, at some 60 steps per second.
//!
//! It is simulated elsewhere, since a step takes longer than a block may. Steps are counted from reset; the envelope
//! during step k becomes a request at the end of that step, and the result is heard from the end of step k + 1 on. The
//! simulation therefore has a whole step of time, and every start repeats. A late step repeats the one before.

use super::field::{FARTHEST_M, SourceState};
use crate::error::Error;

/// Speed in m/s that is subtracted from all speeds, so that gas at which nothing blows becomes silent within some
/// seconds.
const CALM_M_S: f32 = 0.25;

/// Fastest speed that is believed, in m/s.
const FASTEST_M_S: f32 = 1e4;

/// Approximate number of steps per second.
const STEPS_PER_S: f64 = 60.0;

/// A request to a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepRequest {
    /// Run that the step belongs to, counted by starts of the sound; every run begins in still gas.
    pub run: u64,
    /// Number of the step, from 0; a run's steps are requested in order.
    pub step: u64,
    /// Speed in m/s of the incoming gas.
    pub speed_m_s: f64,
}

/// A simulation of gas, local or remote. Both calls are made on the audio thread.
pub trait Simulator: Send {
    /// Requests a step.
    fn request(&mut self, request: StepRequest);

    /// Writes the sources' speeds in m/s after a requested step; returns whether they are available.
    fn answer(&mut self, run: u64, step: u64, speeds_m_s: &mut [f32]) -> bool;
}

/// The audio thread's side of a simulation.
pub(super) struct Live {
    simulator: Box<dyn Simulator>,
    positions: Vec<[f64; 3]>,
    /// Speeds at the ends of the present step, and working memory for the next.
    speeds: [Vec<f32>; 2],
    coming: Vec<f32>,
    hops_per_step: u64,
    run: u64,
    /// Hops since the run began; none before that.
    hop: Option<u64>,
    /// Hops since the present step began; constant while stopped.
    into: u64,
    /// Sum over the step's hops of the requested speed.
    requested_m_s: f64,
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
    /// A live flow for sources at `positions`, in m to the right, to the front and up.
    ///
    /// Fails without positions, and if one is not finite or farther than 100 km.
    pub fn new(simulator: Box<dyn Simulator>, positions: &[[f32; 3]], hops_per_step: u64) -> Result<Self, Error> {
        let far = |value: &f32| !(-FARTHEST_M..=FARTHEST_M).contains(value);
        if positions.is_empty() || positions.iter().flatten().any(far) {
            return Err(Error::SpeedField {
                reason: "a simulation has no positions, or some are out of range".to_owned(),
            });
        }
        let still = vec![0.0; positions.len()];
        Ok(Self {
            simulator,
            positions: positions.iter().map(|position| position.map(f64::from)).collect(),
            speeds: [still.clone(), still.clone()],
            coming: still,
            hops_per_step: hops_per_step.max(1),
            run: 0,
            hop: None,
            into: 0,
            requested_m_s: 0.0,
            late: 0,
        })
    }

    /// Number of sources.
    pub fn sources(&self) -> usize {
        self.positions.len()
    }

    /// Number of steps that came too late since the last call.
    pub fn take_late_steps(&mut self) -> u64 {
        std::mem::take(&mut self.late)
    }

    /// Resets to still gas.
    pub fn reset(&mut self) {
        self.stop();
        self.into = 0;
        self.speeds.iter_mut().for_each(|speeds| speeds.fill(0.0));
    }

    /// Makes the next hop start a new run.
    pub fn stop(&mut self) {
        self.hop = None;
    }

    /// Moves on by one hop, in which gas enters at `speed_m_s`.
    pub fn advance(&mut self, speed_m_s: f64) {
        let hop = match self.hop {
            Some(hop) => hop + 1,
            None => {
                self.run += 1;
                self.speeds.iter_mut().for_each(|speeds| speeds.fill(0.0));
                self.requested_m_s = 0.0;
                0
            }
        };
        self.hop = Some(hop);
        self.into = hop % self.hops_per_step;
        if hop > 0 && hop.is_multiple_of(self.hops_per_step) {
            let step = hop / self.hops_per_step;
            let speed_m_s = std::mem::take(&mut self.requested_m_s) / self.hops_per_step as f64;
            if let Some(audible_step) = step.checked_sub(2) {
                self.receive_step(audible_step);
            }
            self.simulator.request(StepRequest { run: self.run, step: step - 1, speed_m_s });
        }
        self.requested_m_s += speed_m_s;
    }

    /// Moves from the present speeds to those of a step.
    fn receive_step(&mut self, step: u64) {
        let [from, to] = &mut self.speeds;
        std::mem::swap(from, to);
        if self.simulator.answer(self.run, step, &mut self.coming) {
            for (to, speed) in to.iter_mut().zip(&self.coming) {
                // NaN counts as calm too.
                *to = if *speed > CALM_M_S { (speed - CALM_M_S).min(FASTEST_M_S) } else { 0.0 };
            }
        } else {
            to.copy_from_slice(from);
            self.late += 1;
        }
    }

    /// A source at the start of the hop, or at its end.
    pub fn state_at(&self, source: usize, end: bool) -> SourceState {
        let into = self.into + u64::from(end && self.hop.is_some());
        let part = into as f32 / self.hops_per_step as f32;
        let [from, to] = [0, 1].map(|which: usize| self.speeds[which][source]);
        SourceState { position: self.positions[source], speed_m_s: f64::from(from + part * (to - from)), presence: 1.0 }
    }
}
