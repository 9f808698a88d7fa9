//! Simulators' names for their fields.

/// Names of burning fields in the order of preference, with those of physical units last.
pub(super) const FIELDS: [&str; 10] =
    ["flame", "flames", "fire", "flamefront", "flame_front", "burn", "react", "heat", "fuel", "temperature"];

/// Number of [`FIELDS`] without a unit: near 1 in the flame, 0 elsewhere.
pub(super) const WITHOUT_UNIT: usize = 7;

/// Names of the field of volume sources, in order of preference.
pub(super) const DIVERGENCES: [&str; 3] = ["divergence", "div", "expansion"];

/// Names of fields that are carried by the gas and otherwise change little, in order of preference.
pub(super) const CARRIED: [&str; 4] = ["density", "smoke", "temperature", "temp"];

/// Names of velocities in the order of preference.
pub(super) const VELOCITIES: [&str; 3] = ["velocity", "vel", "v"];

/// True for the name of a quantity with a unit.
pub(super) fn is_unit_dependent(name: &str) -> bool {
    FIELDS[WITHOUT_UNIT..].iter().any(|field| field.eq_ignore_ascii_case(name.trim()))
}

/// True for the name of a signed distance, whatever class its grid declares.
pub(super) fn is_distance(name: &str) -> bool {
    ["flamefront", "flame_front"].iter().any(|known| known.eq_ignore_ascii_case(name.trim()))
}
