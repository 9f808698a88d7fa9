//! Saved bytes: the same values always give the same bytes.
//!
//! The framework saves 32-bit values as the host last set them, slightly off the table's grid (232.90001), and reads
//! them back on the grid (232.9): a state would change by being loaded and saved.

use nice_plug::prelude::PluginState;
use nice_plug_core::plugin::ParamValue;
use pyrophone_settings::{PARAMETERS, ParameterKind};

use crate::parameters::sanitize;

/// A parameter's index in the table, and the plain value that the host has set and no block has carried yet.
pub type Pending = (usize, f64);

/// The framework's JSON with every value on the table's grid, and `pending` values in place of those still held by the
/// engines; unchanged if it is not a state.
pub fn normalise(json: &[u8], pending: &[Pending]) -> Vec<u8> {
    let Ok(mut state) = serde_json::from_slice::<PluginState>(json) else { return json.to_owned() };
    for (index, plain) in pending {
        let parameter = &PARAMETERS[*index];
        let value = match parameter.kind {
            ParameterKind::Float { .. } => ParamValue::F32(*plain as f32),
            ParameterKind::Int { .. } | ParameterKind::Choice { .. } => ParamValue::I32(*plain as i32),
            ParameterKind::Toggle { .. } => ParamValue::Bool(*plain > 0.5),
        };
        state.params.insert(parameter.id.to_owned(), value);
    }
    sanitize(&mut state);
    serde_json::to_vec(&state).unwrap_or_else(|_| json.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATE: &[u8] =
        br#"{"version":"0.1.0","params":{"cutoff":{"f32":232.90001},"levels":{"i32":6},"bypass":{"bool":false}},"fields":{}}"#;

    fn value(json: &[u8], id: &str) -> String {
        let value: serde_json::Value = serde_json::from_slice(json).unwrap();
        value["params"][id].to_string()
    }

    #[test]
    fn values_are_saved_on_the_grid_and_stay_there() {
        let once = normalise(STATE, &[]);
        assert_eq!(value(&once, "cutoff"), r#"{"f32":232.9}"#);
        assert_eq!(normalise(&once, &[]), once);
    }

    #[test]
    fn pending_values_are_saved() {
        let index = |id| pyrophone_settings::index_of(id).unwrap();
        let saved = normalise(STATE, &[(index("bypass"), 1.0), (index("levels"), 4.0), (index("cutoff"), 100.0)]);
        assert_eq!(value(&saved, "bypass"), r#"{"bool":true}"#);
        assert_eq!(value(&saved, "levels"), r#"{"i32":4}"#);
        assert_eq!(value(&saved, "cutoff"), r#"{"f32":100.0}"#);
    }

    #[test]
    fn bytes_that_are_no_state_are_left_alone() {
        assert_eq!(normalise(b"{", &[]), b"{");
    }
}
