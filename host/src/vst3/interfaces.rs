//! Host side of VST3: interfaces that a plug-in may call.

mod changes;
mod handler;
mod out;
mod stream;

pub(super) use changes::{OutputChanges, ParameterChanges};
pub(super) use handler::{Handler, HostApplication};
pub(super) use stream::MemoryStream;
