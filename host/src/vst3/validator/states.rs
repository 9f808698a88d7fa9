//! Checks of a VST3 bundle's saved states.

use std::path::Path;

use ::vst3::Steinberg::Vst::IEditControllerTrait;
use ::vst3::Steinberg::kResultOk;

use super::Raw;
use crate::Format;
use crate::numeric_id;
use crate::state::State;
use crate::validator::ensure;

/// Number of positions in a parameter's range that are tried.
const PLACES: usize = 16;
/// Assumed number of steps of a continuous parameter: those of a range of 0-10 with two decimal places.
const CONTINUOUS_STEPS: f64 = 1000.0;

pub(super) fn value_is_saved_at_once(bundle: &Path) -> Result<(), String> {
    let mut raw = Raw::load(bundle)?;
    raw.start(48_000.0)?;
    for (id, normalised, saved) in
        [("output_level", 0.25, "-48.0"), ("bypass", 1.0, "true"), ("levels", 1.0, "8"), ("drive_mode", 0.0, "0")]
    {
        let number = numeric_id(id);
        // SAFETY: a live controller.
        let (result, read) = unsafe { (set(&raw, number, normalised), raw.controller.getParamNormalized(number)) };
        ensure(result == kResultOk && (read - normalised).abs() < 1e-6, || {
            format!("{id} was set to {normalised} and is read as {read}")
        })?;
        let state = State::from_bytes(Format::Vst3, &raw.save()?).map_err(|error| error.to_string())?;
        let found = format!("{:?}", state.params.get(id));
        ensure(found.contains(saved), || format!("{id} was set to {normalised} and is saved as {found}"))?;
    }
    Ok(())
}

/// # Safety
/// A live instance.
unsafe fn set(raw: &Raw, id: u32, normalised: f64) -> i32 {
    // SAFETY: guaranteed by the caller.
    unsafe { raw.controller.setParamNormalized(id, normalised) }
}

pub(super) fn bytes_stay(bundle: &Path) -> Result<(), String> {
    let (raw, other) = (Raw::load(bundle)?, Raw::load(bundle)?);
    for round in 0..8 {
        for (index, info) in raw.parameters().iter().enumerate() {
            let normalised = (0.137 * (index + 1) as f64 + 0.31 * f64::from(round)).fract();
            // SAFETY: a live instance.
            unsafe { set(&raw, info.id, normalised) };
        }
        let saved = raw.save()?;
        other.load_state(&saved)?;
        ensure(other.save()? == saved, || format!("in round {round} the bytes differ"))?;
    }
    Ok(())
}

/// Values midway between two steps, and near it, saved while they wait for the next block and once the engines have
/// them: a host that renders a saved state must get the sound that was heard.
pub(super) fn saved_as_it_arrives(bundle: &Path) -> Result<(), String> {
    let mut raw = Raw::load(bundle)?;
    for place in 0..PLACES {
        for beside in [-1e-8, 0.0, 1e-8] {
            raw.start(48_000.0)?;
            for info in raw.parameters() {
                let steps = if info.stepCount > 0 { f64::from(info.stepCount) } else { CONTINUOUS_STEPS };
                let middle = ((steps * place as f64 / PLACES as f64).floor() + 0.5) / steps;
                // SAFETY: a live instance.
                unsafe { set(&raw, info.id, f64::from((middle + beside) as f32)) };
            }
            let waiting = raw.save()?;
            raw.stop();
            let arrived = raw.save()?;
            ensure(waiting == arrived, || {
                let (before, after) = (String::from_utf8_lossy(&waiting), String::from_utf8_lossy(&arrived));
                format!("{before} was saved before the values arrived, {after} after")
            })?;
        }
    }
    Ok(())
}
