//! Controls as the hops see them: within their ranges, and without jumps.

use super::acoustics::NEAR_M;
use crate::controls::VortexControls;
use crate::dsp::Smoothed;
use crate::error::within;

/// Time constant in seconds with which a value follows its control, applied twice: not even its speed jumps, which for
/// a distance is the pitch.
const FOLLOW_S: f64 = 0.04;

/// Values of a [`HopControls`].
const VALUES: usize = 14;

/// Control values at the edge of a hop.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct HopControls {
    pub speed_m_s: f64,
    pub curve: f64,
    pub variation: f64,
    pub field_speed: f64,
    pub range: f64,
    /// Natural logarithm of the reference speed in m/s.
    pub ln_reference: f64,
    pub level: f64,
    pub max_pressure_pa: f64,
    pub pose: PoseControls,
}

/// The part of the control values that sets the sources' positions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct PoseControls {
    distance_m: f64,
    spread_m: f64,
    /// Sine and cosine of the azimuth, up to a common factor: a moving azimuth takes the shorter way round.
    azimuth: [f64; 2],
    elevation: f64,
    exponent: f64,
}

impl HopControls {
    /// The values of `controls`, within their ranges.
    pub fn of_controls(controls: &VortexControls) -> Self {
        let azimuth = maths::sin_cos(within(controls.azimuth_deg % 360.0, -360.0, 360.0).to_radians());
        Self {
            speed_m_s: within(controls.speed_m_s, 0.0, 100.0),
            curve: within(controls.curve, 0.1, 4.0),
            variation: within(controls.variation, 0.0, 1.0),
            field_speed: within(controls.field_speed, 0.0, 10.0),
            range: within(controls.range, 0.0, 1.0),
            ln_reference: maths::ln(within(controls.reference_m_s, 0.1, 100.0)),
            level: within(controls.level, 0.0, 1e6),
            max_pressure_pa: within(controls.max_pressure_pa, 1e-6, 1e9),
            pose: PoseControls {
                distance_m: within(controls.distance_m, 0.0, 1000.0),
                spread_m: within(controls.spread_m, 0.0, 100.0),
                azimuth: azimuth.into(),
                elevation: within(controls.elevation_deg, -90.0, 90.0).to_radians(),
                exponent: within(controls.exponent, 1.0, 3.0),
            },
        }
    }

    fn values(&mut self) -> [&mut f64; VALUES] {
        let pose = &mut self.pose;
        let [sin, cos] = &mut pose.azimuth;
        [
            &mut self.speed_m_s,
            &mut self.curve,
            &mut self.variation,
            &mut self.field_speed,
            &mut self.range,
            &mut self.ln_reference,
            &mut self.level,
            &mut self.max_pressure_pa,
            &mut pose.distance_m,
            &mut pose.spread_m,
            sin,
            cos,
            &mut pose.elevation,
            &mut pose.exponent,
        ]
    }
}

/// A [`PoseControls`] with its angles converted.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pose {
    spread_m: f64,
    sin: f64,
    cos: f64,
    /// Front and up, of the middle.
    front_m: f64,
    up_m: f64,
    exponent: f64,
}

impl PoseControls {
    /// The pose of the sources.
    pub fn pose(&self) -> Pose {
        let [sin, cos] = self.azimuth;
        let norm = maths::hypot(sin, cos);
        // Half-way between opposite azimuths both are 0, and any direction will do.
        let (sin, cos) = if norm > 1e-6 { (sin / norm, cos / norm) } else { (0.0, 1.0) };
        let (rise, flat) = maths::sin_cos(self.elevation);
        Pose {
            spread_m: self.spread_m,
            sin,
            cos,
            front_m: self.distance_m * flat,
            up_m: self.distance_m * rise,
            exponent: self.exponent,
        }
    }
}

impl Pose {
    /// Right, front and up from the listener, in m, for a position in the ball over which sources are spread.
    pub fn in_ball(&self, ball: [f64; 3]) -> [f64; 3] {
        self.position_of(ball.map(|x| self.spread_m * x))
    }

    /// The same for a position in m from the centre. Right and front are those of a listener who faces the centre.
    pub fn position_of(&self, [right, front, up]: [f64; 3]) -> [f64; 3] {
        let front = front + self.front_m;
        [right * self.cos + front * self.sin, front * self.cos - right * self.sin, up + self.up_m]
    }

    /// Factor on the pressure at 1 m for a distance in m.
    pub fn attenuation(&self, distance_m: f64) -> f64 {
        let square = distance_m * distance_m + NEAR_M * NEAR_M;
        if self.exponent == 1.0 { 1.0 / square.sqrt() } else { maths::pow(square, -0.5 * self.exponent) }
    }
}

/// A frame that follows the controls hop by hop.
#[derive(Debug)]
pub(super) struct ControlSnapshot {
    now: HopControls,
    smoothed: [[Smoothed; 2]; VALUES],
}

impl ControlSnapshot {
    /// `hop_rate_hz` is the number of hops per second.
    pub fn new(hop_rate_hz: f64) -> Self {
        Self { now: HopControls::default(), smoothed: [[Smoothed::new(FOLLOW_S, hop_rate_hz); 2]; VALUES] }
    }

    /// The frame as it is.
    pub fn now(&self) -> HopControls {
        self.now
    }

    /// Applies the controls' values at once.
    pub fn jump(&mut self, controls: &VortexControls) {
        self.now = HopControls::of_controls(controls);
        for (stages, value) in self.smoothed.iter_mut().zip(self.now.values()) {
            stages.iter_mut().for_each(|stage| stage.value = *value);
        }
    }

    /// One hop later.
    pub fn next(&mut self, controls: &VortexControls) -> HopControls {
        self.now = HopControls::of_controls(controls);
        for (stages, value) in self.smoothed.iter_mut().zip(self.now.values()) {
            *value = stages.iter_mut().fold(*value, |target, stage| stage.next(target));
        }
        self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pose_places_sources_by_distance_azimuth_and_elevation() {
        let controls = VortexControls { distance_m: 2.0, azimuth_deg: 90.0, ..VortexControls::default() };
        let pose = HopControls::of_controls(&controls).pose.pose();
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(pose.in_ball([0.0; 3]), [2.0, 0.0, 0.0]));
        assert!(close(pose.position_of([0.0, 1.0, 0.0]), [3.0, 0.0, 0.0]));
        assert!(close(pose.position_of([1.0, 0.0, 0.5]), [2.0, -1.0, 0.5]));
        let above = HopControls::of_controls(&VortexControls { elevation_deg: 90.0, ..controls }).pose.pose();
        assert!(close(above.in_ball([0.0; 3]), [0.0, 0.0, 2.0]));
    }

    #[test]
    fn every_value_follows_and_arrives() {
        let mut moving = ControlSnapshot::new(750.0);
        moving.jump(&VortexControls { azimuth_deg: 170.0, ..VortexControls::default() });
        let target = VortexControls { azimuth_deg: -170.0, distance_m: 9.0, level: 3.0, ..VortexControls::default() };
        let mut before = moving.now().pose.pose().position_of([0.0; 3]);
        for _ in 0..600 {
            let at = moving.next(&target).pose.pose().position_of([0.0; 3]);
            // The short way, behind the listener.
            assert!(at[1] < 0.0 && (at[0] - before[0]).abs() < 0.5);
            before = at;
        }
        assert_eq!(moving.now(), HopControls::of_controls(&target));
    }

    #[test]
    fn nan_and_infinite_controls_give_finite_frames() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let controls = VortexControls {
                speed_m_s: bad,
                curve: bad,
                variation: bad,
                field_speed: bad,
                range: bad,
                reference_m_s: bad,
                level: bad,
                max_pressure_pa: bad,
                distance_m: bad,
                spread_m: bad,
                azimuth_deg: bad,
                elevation_deg: bad,
                exponent: bad,
                ..VortexControls::default()
            };
            assert!(HopControls::of_controls(&controls).values().iter().all(|value| value.is_finite()), "{bad}");
        }
    }
}
