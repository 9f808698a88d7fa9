#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod automation;
pub mod controller_file;
pub mod error;
mod factory_fire;
mod group;
mod id;
pub mod library;
pub mod macros;
mod names;
pub mod parameter;
pub mod preset;
mod preset_recording;
pub mod recent;
pub mod session;
pub mod table;
mod user_file;
pub mod values;
pub mod vst3_preset;
pub mod window_scale;

pub use automation::Automation;
pub use controller_file::ControllerFile;
pub use error::Error;
pub use factory_fire::{FACTORY_FIRES, FactoryFire};
pub use group::Group;
pub use id::Id;
pub use library::Library;
pub use parameter::{Parameter, ParameterKind};
pub use preset::Preset;
pub use preset_recording::PresetRecording;
pub use recent::Recent;
pub use session::Session;
pub use table::{COUNT, PARAMETERS, host_order, index_of};
pub use values::Values;
pub use window_scale::ScaleFile;
