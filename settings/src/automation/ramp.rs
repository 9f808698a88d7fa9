//! A ramp as a series of steps for engines and hosts.

use super::Event;
use crate::{PARAMETERS, ParameterKind};

/// Shortest step of a ramp in seconds.
///
/// A block of the engines ends at every step; shorter ones would cost more without being audible, since windows are
/// longer and levels are smoothed.
pub const RAMP_STEP_S: f64 = 0.001;

/// The steps strictly between two rows of one parameter, in order.
pub(super) fn between(from: Event, to: Event, sample_rate_hz: f64) -> impl DoubleEndedIterator<Item = Event> {
    let parameter = &PARAMETERS[from.parameter];
    let samples = to.sample.saturating_sub(from.sample);
    let unit = match parameter.kind {
        ParameterKind::Float { decimals, .. } => maths::powi(10.0, -(decimals as i32)),
        _ => 1.0,
    };
    let most_by_value = ((to.value - from.value).abs() / unit).round() as u64;
    let most_by_time = (samples as f64 / (sample_rate_hz * RAMP_STEP_S)).floor() as u64;
    let steps = most_by_value.min(most_by_time);
    (1..steps).map(move |step| {
        // Wide enough for any sample: times count from zero to the end of 64 bits.
        let passed = u128::from(samples) * u128::from(step) / u128::from(steps);
        let share = step as f64 / steps as f64;
        Event {
            sample: from.sample + passed as u64,
            parameter: from.parameter,
            value: parameter.snap(from.value + share * (to.value - from.value)),
        }
    })
}
