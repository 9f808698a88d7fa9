//! The host's scale of values and the framework's.

use clap_sys::id::clap_id;
use pyrophone_settings::{PARAMETERS, ParameterKind};

use crate::entry::instance::index_of_numeric;

/// The offset from the framework's to the host's value of a parameter; none where they are the same; real-time safe.
pub fn shift(id: clap_id) -> Option<f64> {
    let parameter = &PARAMETERS[index_of_numeric(id)?];
    match parameter.kind {
        ParameterKind::Int { low, .. } if low != 0 && !parameter.automatable => Some(f64::from(low)),
        _ => None,
    }
}
