//! Sources whose positions and speeds come from a simulation.

use super::acoustics::SPEED_OF_SOUND_M_S;
use crate::error::Error;

/// Speed beyond which a source has been relocated: it fades out and in again instead of being heard to move.
const FASTEST_M_S: f64 = 0.45 * SPEED_OF_SOUND_M_S;

/// Largest number of values of a field.
const MOST_VALUES: usize = 1 << 26;
/// Bounds of the rate in Hz; half a step lasts longer than a hop.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.1..=120.0;
/// Bounds of a coordinate in m and of a speed in m/s.
pub(super) const FARTHEST_M: f32 = 1e5;
const FASTEST_FLOW_M_S: f32 = 1e4;

/// Behaviour of a field beyond its last step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum End {
    /// The first step follows the last.
    #[default]
    Periodic,
    /// Holds the last step, and before the start of the timeline the first.
    Clamped,
}

/// Positions and flow speeds of sources over time: the speed field of a simulated flow (Dobashi et al. 2004, §6).
///
/// Step k is at `start_s` + k / `rate_hz` seconds on the timeline; positions and speeds are linear between steps.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedField {
    rate_hz: f64,
    start_s: f64,
    end: End,
    sources: usize,
    positions: Vec<[f32; 3]>,
    speeds: Vec<f32>,
}

/// Two steps, and the fraction of the way from one to the other (0-1).
pub(super) type Moment = (usize, usize, f64);

/// One source of a field at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SourceState {
    /// Right, front and up from the field's origin, in m.
    pub position: [f64; 3],
    pub speed_m_s: f64,
    /// 1, except for a source that is being relocated.
    pub presence: f64,
}

impl SpeedField {
    /// A field of `sources` sources at `rate_hz` (0.1-120) steps per second.
    ///
    /// `positions` are in m to the right, to the front (away from the listener) and up, from an origin set by the
    /// controls; `speeds` are in m/s. Both are ordered by step and, within a step, by source; `positions` of a single
    /// step apply to all steps. Fails if lengths do not match, if a value is not finite, if a position is farther than
    /// 100 km, or if a speed is not within 0-10,000 m/s.
    pub fn new(
        rate_hz: f64,
        sources: usize,
        positions: Vec<[f32; 3]>,
        speeds: Vec<f32>,
        end: End,
    ) -> Result<Self, Error> {
        let refuse = |reason: String| Err(Error::SpeedField { reason });
        if !RATES_HZ.contains(&rate_hz) {
            return refuse(format!("its rate is {rate_hz} Hz, but must lie between 0.1 and 120 Hz"));
        }
        if sources == 0 || speeds.is_empty() || !speeds.len().is_multiple_of(sources) || speeds.len() > MOST_VALUES {
            return refuse(format!("{} speeds do not divide into steps of {sources} sources", speeds.len()));
        }
        if positions.len() != sources && positions.len() != speeds.len() {
            let (found, expected) = (positions.len(), speeds.len());
            return refuse(format!("it has {found} positions instead of {sources} or {expected}"));
        }
        if let Some(bad) = speeds.iter().position(|speed| !(0.0..=FASTEST_FLOW_M_S).contains(speed)) {
            return refuse(format!("speed {bad} is {} m/s", speeds[bad]));
        }
        let far = |value: &f32| !(-FARTHEST_M..=FARTHEST_M).contains(value);
        if let Some(bad) = positions.iter().position(|position| position.iter().any(far)) {
            return refuse(format!("position {bad} is {:?} m", positions[bad]));
        }
        Ok(Self { rate_hz, start_s: 0.0, end, sources, positions, speeds })
    }

    /// The same field, with its first step at `start_s` seconds on the timeline; a non-finite time counts as 0.
    pub fn starting_at(self, start_s: f64) -> Self {
        Self { start_s: if start_s.is_finite() { start_s } else { 0.0 }, ..self }
    }

    /// Seconds from the timeline's start to the first step.
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// Behaviour beyond its last step.
    pub fn end(&self) -> End {
        self.end
    }

    /// Positions of the sources in m: of one step, which applies to all, or step by step.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Speeds in m/s, step by step.
    pub fn speeds(&self) -> &[f32] {
        &self.speeds
    }

    /// Steps per second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Number of sources.
    pub fn sources(&self) -> usize {
        self.sources
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.speeds.len() / self.sources
    }

    /// The steps around a time in seconds, and the fraction of the way from one to the other (0-1).
    pub(super) fn moment(&self, time_s: f64) -> Moment {
        let steps = self.steps();
        let at = (time_s - self.start_s) * self.rate_hz;
        match self.end {
            End::Periodic => {
                let at = at.rem_euclid(steps as f64);
                let step = (at as usize).min(steps - 1);
                (step, (step + 1) % steps, at - step as f64)
            }
            End::Clamped => {
                let at = at.clamp(0.0, (steps - 1) as f64);
                let step = at as usize;
                (step, (step + 1).min(steps - 1), at - step as f64)
            }
        }
    }

    /// A source at a [`place`](Self::place) in time.
    pub(super) fn state_at(&self, source: usize, (from, to, part): Moment) -> SourceState {
        let speed = |step: usize| f64::from(self.speeds[step * self.sources + source]);
        let speed_m_s = speed(from) + part * (speed(to) - speed(from));
        if self.positions.len() == self.sources {
            return SourceState { position: self.positions[source].map(f64::from), speed_m_s, presence: 1.0 };
        }
        let position = |step: usize| self.positions[step * self.sources + source].map(f64::from);
        let (a, b) = (position(from), position(to));
        let moved = a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt() * self.rate_hz;
        let (position, presence) = if moved > FASTEST_M_S {
            // Silent for half a step, in the middle of which it is relocated.
            (if part < 0.5 { a } else { b }, (2.0 * (1.0 - 2.0 * part).abs() - 1.0).max(0.0))
        } else {
            (std::array::from_fn(|axis| a[axis] + part * (b[axis] - a[axis])), 1.0)
        };
        SourceState { position, speed_m_s, presence }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(end: End) -> SpeedField {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0], [90.0, 0.0, 0.0]];
        SpeedField::new(10.0, 2, positions, vec![1.0, 5.0, 3.0, 7.0], end).expect("a field")
    }

    #[test]
    fn is_linear_between_steps_and_ends_as_asked() {
        let at = |end: End, source: usize, time_s: f64| field(end).state_at(source, field(end).moment(time_s));
        let middle = at(End::Periodic, 0, 0.05);
        assert!((middle.position[0] - 0.25).abs() < 1e-9 && (middle.speed_m_s - 2.0).abs() < 1e-9);
        assert!((at(End::Periodic, 0, 0.15).speed_m_s - 2.0).abs() < 1e-9);
        assert!((at(End::Periodic, 0, -0.05).speed_m_s - 2.0).abs() < 1e-9);
        assert_eq!(at(End::Clamped, 0, 0.15).speed_m_s, 3.0);
        assert_eq!(at(End::Clamped, 0, -1.0).speed_m_s, 1.0);
    }

    #[test]
    fn a_source_that_is_put_elsewhere_is_silent_meanwhile() {
        let field = field(End::Clamped);
        let state = |part: f64| field.state_at(1, (0, 1, part));
        assert_eq!([0.0, 0.3, 0.7, 1.0].map(|part| state(part).presence > 0.0), [true, false, false, true]);
        assert_eq!([0.49, 0.51].map(|part| state(part).position[0]), [1.0, 90.0]);
        assert_eq!(field.state_at(0, (0, 1, 0.5)).presence, 1.0);
    }

    #[test]
    fn field_with_mismatched_lengths_or_rate_is_refused() {
        let make = |rate, sources, positions: usize, speeds: Vec<f32>| {
            SpeedField::new(rate, sources, vec![[0.0; 3]; positions], speeds, End::Periodic)
        };
        assert!(make(30.0, 2, 2, vec![1.0; 6]).is_ok());
        for rate in [0.0, 121.0, f64::NAN, f64::INFINITY] {
            assert!(make(rate, 2, 2, vec![1.0; 6]).is_err());
        }
        assert!(make(30.0, 0, 0, vec![]).is_err());
        assert!(make(30.0, 2, 2, vec![1.0; 5]).is_err());
        assert!(make(30.0, 2, 4, vec![1.0; 6]).is_err());
        assert!(make(30.0, 2, 2, vec![1.0, f32::NAN]).is_err());
        assert!(make(30.0, 2, 2, vec![1.0, -1.0]).is_err());
        let far = SpeedField::new(30.0, 1, vec![[0.0, f32::INFINITY, 0.0]], vec![1.0], End::Periodic);
        assert!(far.is_err());
    }
}
