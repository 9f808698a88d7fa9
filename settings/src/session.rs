//! Session data besides the parameters: the recordings, the learned distribution, the speed field.
//!
//! It is JSON text, stored in the plug-in's state in the field [`FIELD`]. Text that this version does not understand is
//! rejected as a whole; the caller then keeps it unchanged.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

use pyrophone_synthesis::controls::SLOTS;

use crate::{Error, PARAMETERS, ParameterKind, Values};

/// Name of the session's field in the plugin's state.
pub const FIELD: &str = "pyrophone";

/// The version that [`Session::to_json`] writes.
pub const VERSION: u64 = 1;

/// Conversions of a session from version `index + 1` to the next version.
const MIGRATIONS: &[fn(&mut serde_json::Value)] = &[];

const _: () = assert!(MIGRATIONS.len() as u64 == VERSION - 1, "each version needs its way to the next");

/// Parameters that a plugin's state of an earlier version does not have, and the plain values that it was saved with.
pub const EARLIER: &[(&str, f64)] = &[
    ("dynamics_mode", 0.0),
    ("scaling_auto", 0.0),
    ("ceiling", 0.0),
    ("loudness", -60.0),
    ("fuel", 0.0),
    ("hiss_level", -72.0),
    ("body_level", -72.0),
    ("macro_size", 0.0),
    ("macro_fury", 0.0),
    ("macro_crackle", 0.0),
    ("macro_sharpness", 0.0),
    ("macro_hiss", 0.0),
    ("macro_whoosh", 0.0),
    ("macro_tightness", 0.0),
    ("macro_distance", 0.0),
    ("take", 0.0),
    ("recording_slot", 0.0),
    ("recording_blend", 0.0),
    ("averaging", 0.0),
];

/// Largest number of quantiles in a learned distribution.
pub const MAX_QUANTILES: usize = 65_536;

/// Session data besides the parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Session {
    /// The recording that texture synthesis draws on.
    pub recording: Option<RecordingReference>,
    /// True if the user wants the recording itself in the session.
    pub embed: bool,
    /// The learned distribution of the drive's amplitudes.
    pub learned: Option<Learned>,
    /// The speed field that vortex sound follows.
    pub field: Option<FieldReference>,
    /// Part of the recording that is learnt from, and its level.
    pub cut: Cut,
    /// The recordings of the slots after the first.
    pub others: [Slot; SLOTS - 1],
}

/// A recording in addition to the first, with the part of it that is learnt from.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Slot {
    /// The recording; none if the slot is empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<RecordingReference>,
    /// Part and level of the recording.
    #[serde(default, skip_serializing_if = "Cut::is_whole")]
    pub cut: Cut,
}

/// Part of the recording that is learnt from, and its level.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Cut {
    /// Start and end in seconds; none for the whole recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region_s: Option<[f64; 2]>,
    /// Gain in dB, within ±[`MAX_CUT_GAIN_DB`].
    #[serde(default)]
    pub gain_db: f64,
    /// True if the part is first normalised to full scale.
    #[serde(default)]
    pub normalise: bool,
}

/// Most gain of a [`Cut`], up or down, in dB.
pub const MAX_CUT_GAIN_DB: f64 = 60.0;

impl Cut {
    fn is_whole(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn check(self) -> Result<Self, String> {
        let region = self.region_s.is_none_or(|[start_s, end_s]| start_s < end_s && end_s.is_finite());
        if !(region && (-MAX_CUT_GAIN_DB..=MAX_CUT_GAIN_DB).contains(&self.gain_db)) {
            return Err(
                "the selected part of its recording is not a time range, or its gain is beyond 60 dB".to_owned()
            );
        }
        Ok(self)
    }
}

/// Location and identity of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordingReference {
    /// Absolute path at the time of saving.
    pub path: String,
    /// BLAKE3 of the file's bytes in hexadecimal.
    pub content_hash: String,
    /// The file itself, packed by the `recording` crate; none unless the user wants it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub embedded: Option<String>,
}

/// A speed field, itself in the session: it is small.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldReference {
    /// Absolute path when it was loaded.
    pub path: String,
    /// The file's bytes, at most [`MAX_FIELD_BYTES`].
    pub bytes: Vec<u8>,
}

/// Largest speed field in a session, in bytes: half an hour of 80 sources at 30 steps per second.
pub const MAX_FIELD_BYTES: usize = 4 << 20;

/// A field's bytes in Base64.
#[derive(Serialize, Deserialize)]
struct PackedField {
    path: String,
    bytes: String,
}

/// Quantiles of the drive pyramid's top level, or in the companded mode of its loudness, and the settings that they
/// apply to.
#[derive(Debug, Clone, PartialEq)]
pub struct Learned {
    /// Sample rate in Hz.
    pub sample_rate_hz: f64,
    /// Pyramid levels at 44.1 kHz ([`pyrophone_synthesis::EngineConfig::levels`]).
    pub levels: usize,
    /// True if they belong to the companded mode.
    pub companded: bool,
    /// Sorted magnitudes at equal steps of probability, 1 to [`MAX_QUANTILES`].
    pub quantiles: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
struct File {
    version: u64,
    #[serde(default)]
    recording: Option<RecordingReference>,
    #[serde(default)]
    embed: bool,
    #[serde(default)]
    learned: Option<PackedLearned>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    field: Option<PackedField>,
    #[serde(default, skip_serializing_if = "Cut::is_whole")]
    cut: Cut,
    /// Up to the last that is not empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    others: Vec<Slot>,
}

/// Quantiles as little-endian 64-bit floats in Base64: exact, and an eighth of their size as text.
#[derive(Serialize, Deserialize)]
struct PackedLearned {
    sample_rate_hz: f64,
    levels: usize,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    companded: bool,
    quantiles: String,
}

impl Session {
    /// The recording of a slot.
    pub fn recording_in(&self, slot: usize) -> Option<&RecordingReference> {
        match slot.checked_sub(1) {
            None => self.recording.as_ref(),
            Some(other) => self.others.get(other)?.recording.as_ref(),
        }
    }

    /// Mutable recording of a slot; a slot beyond the last is the last.
    pub fn recording_in_mut(&mut self, slot: usize) -> &mut Option<RecordingReference> {
        match slot.checked_sub(1) {
            None => &mut self.recording,
            Some(other) => &mut self.others[other.min(SLOTS - 2)].recording,
        }
    }

    /// Part of a slot's recording that is learnt from.
    pub fn cut_in(&self, slot: usize) -> Cut {
        match slot.checked_sub(1) {
            None => self.cut,
            Some(other) => self.others.get(other).map_or_else(Cut::default, |slot| slot.cut),
        }
    }

    /// The same, mutable; a slot beyond the last is the last.
    pub fn cut_in_mut(&mut self, slot: usize) -> &mut Cut {
        match slot.checked_sub(1) {
            None => &mut self.cut,
            Some(other) => &mut self.others[other.min(SLOTS - 2)].cut,
        }
    }

    /// The session as JSON text.
    pub fn to_json(&self) -> String {
        let learned = self.learned.as_ref().map(|learned| PackedLearned {
            sample_rate_hz: learned.sample_rate_hz,
            levels: learned.levels,
            companded: learned.companded,
            quantiles: STANDARD.encode(learned.quantiles.iter().flat_map(|q| q.to_le_bytes()).collect::<Vec<u8>>()),
        });
        let field = self
            .field
            .as_ref()
            .map(|field| PackedField { path: field.path.clone(), bytes: STANDARD.encode(&field.bytes) });
        let (recording, cut) = (self.recording.clone(), self.cut);
        let used = self.others.iter().rposition(|slot| *slot != Slot::default()).map_or(0, |last| last + 1);
        let others = self.others[..used].to_vec();
        let file = File { version: VERSION, recording, embed: self.embed, learned, field, cut, others };
        // Strings, numbers and booleans always have a JSON form.
        serde_json::to_string(&file).unwrap_or_default()
    }

    /// Reads a session's JSON text.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let damaged = |message: String| Error::Session { message };
        let mut value: serde_json::Value = serde_json::from_str(text).map_err(|error| damaged(error.to_string()))?;
        let found = value.get("version").and_then(serde_json::Value::as_u64);
        match found {
            Some(version @ 1..=VERSION) => {
                MIGRATIONS[version as usize - 1..].iter().for_each(|migrate| migrate(&mut value));
            }
            Some(found) => return Err(Error::SessionVersion { found, newest: VERSION }),
            None => return Err(damaged("it has no version".to_owned())),
        }
        let file: File = serde_json::from_value(value).map_err(|error| damaged(error.to_string()))?;
        let learned = file.learned.map(PackedLearned::unpack).transpose().map_err(damaged)?;
        let field = file.field.map(PackedField::unpack).transpose().map_err(damaged)?;
        let cut = file.cut.check().map_err(damaged)?;
        if file.others.len() > SLOTS - 1 {
            return Err(damaged(format!("it has more than {SLOTS} recordings")));
        }
        let mut others: [Slot; SLOTS - 1] = Default::default();
        for (slot, found) in others.iter_mut().zip(file.others) {
            *slot = Slot { cut: found.cut.check().map_err(damaged)?, ..found };
        }
        Ok(Self { recording: file.recording, embed: file.embed, learned, field, cut, others })
    }
}

impl PackedField {
    fn unpack(self) -> Result<FieldReference, String> {
        // Four characters encode three bytes.
        if self.bytes.len() / 4 > MAX_FIELD_BYTES / 3 + 1 {
            return Err(format!("its speed field is larger than {} MB", MAX_FIELD_BYTES >> 20));
        }
        let bytes = STANDARD.decode(&self.bytes).map_err(|error| error.to_string())?;
        Ok(FieldReference { path: self.path, bytes })
    }
}

impl PackedLearned {
    fn unpack(self) -> Result<Learned, String> {
        let bytes = STANDARD.decode(&self.quantiles).map_err(|error| error.to_string())?;
        let (numbers, rest) = bytes.as_chunks::<8>();
        let quantiles: Vec<f64> = numbers.iter().map(|number| f64::from_le_bytes(*number)).collect();
        let sound = rest.is_empty()
            && (1..=MAX_QUANTILES).contains(&quantiles.len())
            && quantiles.iter().all(|quantile| quantile.is_finite() && *quantile >= 0.0)
            && quantiles.is_sorted()
            && self.sample_rate_hz.is_finite();
        if !sound {
            return Err("its learned distribution is not 1 to 65536 rising amplitudes".to_owned());
        }
        let Self { sample_rate_hz, levels, companded, .. } = self;
        Ok(Learned { sample_rate_hz, levels, companded, quantiles })
    }
}

/// A value in the plugin's state.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum StateValue {
    F32(f32),
    I32(i32),
    Bool(bool),
}

/// The plug-in's whole state as JSON text, as it would save it itself: the bare state of the VST3 plug-in. The CLAP
/// plug-in's is the same after its length in bytes, 64 bits, little-endian.
pub fn plugin_state(values: &Values, session: &Session) -> String {
    // The fields of a state are themselves JSON.
    let session = serde_json::to_string(&session.to_json()).unwrap_or_default();
    parameters_json(values, BTreeMap::from([(FIELD, session)]))
}

/// A plugin's state with these values and fields, as JSON text.
pub(crate) fn parameters_json(values: &Values, fields: BTreeMap<&'static str, String>) -> String {
    #[derive(Serialize)]
    struct State {
        version: &'static str,
        params: BTreeMap<&'static str, StateValue>,
        fields: BTreeMap<&'static str, String>,
    }
    let params = PARAMETERS.iter().zip(values.as_slice()).map(|(parameter, plain)| {
        let value = match parameter.kind {
            ParameterKind::Float { .. } => StateValue::F32(*plain as f32),
            ParameterKind::Int { .. } | ParameterKind::Choice { .. } => StateValue::I32(*plain as i32),
            ParameterKind::Toggle { .. } => StateValue::Bool(*plain > 0.5),
        };
        (parameter.id, value)
    });
    let state = State { version: env!("CARGO_PKG_VERSION"), params: params.collect(), fields };
    serde_json::to_string(&state).unwrap_or_default()
}
