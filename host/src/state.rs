//! Format of the state that nice-plug saves, so that tests can parse states and make bad ones.
//!
//! It is JSON: `{"version": "0.1.0", "params": {"alpha": {"f32": 2.5}, "levels": {"i32": 6}, "bypass": {"bool": false},
//! "drive": {"string": "flux"}}, "fields": {"recording": "{\"path\":\"/a.wav\"}"}}`. Parameters are stored under their
//! string ids with their plain values; persistent fields are JSON texts within a JSON string. In CLAP, the length of
//! the JSON precedes it, as an unsigned 64-bit little-endian number.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{Format, HostError};

/// The plain value of a parameter in a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StateValue {
    /// Value of a continuous parameter, in its own unit.
    F32(f32),
    /// Value of an integer parameter, or the index of a choice.
    I32(i32),
    /// Value of a switch.
    Bool(bool),
    /// The id of a choice.
    String(String),
}

/// A parsed state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Version of the plugin that wrote it.
    #[serde(default)]
    pub version: String,
    /// Parameters by string id.
    pub params: BTreeMap<String, StateValue>,
    /// Persistent fields by name, each a JSON text.
    pub fields: BTreeMap<String, String>,
}

impl State {
    /// Parses a state.
    ///
    /// # Errors
    /// [`HostError::StateFormat`] if it is not in nice-plug's format.
    pub fn from_bytes(format: Format, bytes: &[u8]) -> Result<Self, HostError> {
        let json = json_of(format, bytes)?;
        serde_json::from_slice(json).map_err(|error| HostError::StateFormat(error.to_string()))
    }

    /// Serialises the state.
    ///
    /// # Errors
    /// [`HostError::StateFormat`] if a number in it cannot be written as JSON.
    pub fn to_bytes(&self, format: Format) -> Result<Vec<u8>, HostError> {
        let json = serde_json::to_vec(self).map_err(|e| HostError::StateFormat(e.to_string()))?;
        Ok(wrap(format, &json))
    }
}

/// The JSON within a state.
///
/// # Errors
/// [`HostError::StateFormat`] if it is shorter than it states.
pub fn json_of(format: Format, bytes: &[u8]) -> Result<&[u8], HostError> {
    if format == Format::Vst3 {
        return Ok(bytes);
    }
    let (length, json) = bytes.split_first_chunk::<8>().ok_or_else(|| {
        HostError::StateFormat(format!("{} bytes, too short for the length that CLAP states begin with", bytes.len()))
    })?;
    let length = u64::from_le_bytes(*length);
    usize::try_from(length)
        .ok()
        .and_then(|length| json.get(..length))
        .ok_or_else(|| HostError::StateFormat(format!("{} bytes where it says {length}", json.len())))
}

/// Any bytes in the envelope of a format, for states that are intended to be bad.
#[must_use]
pub fn wrap(format: Format, json: &[u8]) -> Vec<u8> {
    match format {
        Format::Vst3 => json.to_vec(),
        Format::Clap => [&(json.len() as u64).to_le_bytes(), json].concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_and_writes_both_envelopes() {
        let json = br#"{"version":"1","params":{"a":{"f32":2.5},"b":{"bool":true},"c":{"string":"x"},"d":{"i32":-3}},"fields":{"f":"\"t\""}}"#;
        for format in Format::ALL {
            let bytes = wrap(format, json);
            let state = State::from_bytes(format, &bytes).unwrap();
            assert_eq!(state.params["a"], StateValue::F32(2.5));
            assert_eq!(state.params["d"], StateValue::I32(-3));
            assert_eq!(state.fields["f"], "\"t\"");
            assert_eq!(state.to_bytes(format).unwrap(), bytes);
            assert!(State::from_bytes(format, &bytes[..bytes.len() - 1]).is_err());
        }
        assert!(State::from_bytes(Format::Clap, &[1, 2]).is_err());
    }
}
