#![doc = include_str!("../README.md")]

mod buses;
mod clap;
mod error;
mod id;
mod lock;
mod plugin;
mod vst3;

pub mod bounce;
pub mod editor;
pub mod state;
pub mod validator;

pub use error::HostError;
pub use id::numeric_id;
pub use plugin::{
    Block, BusLayout, Configuration, ControllerMessage, Event, Format, MENU, Parameter, Plugin, Processor, Requests,
    SUBMENU, Tail, Transport,
};

use std::path::Path;

/// Opens the first plug-in of a bundle.
///
/// The bundle's code stays loaded until the process ends, as in most hosts: instances of the same bundle share it.
///
/// # Errors
/// [`HostError::Load`] if the bundle is missing, cannot be loaded or contains no plug-in.
pub fn load(bundle: &Path, format: Format) -> Result<Box<dyn Plugin>, HostError> {
    match format {
        Format::Clap => Ok(Box::new(clap::ClapPlugin::load(bundle)?)),
        Format::Vst3 => Ok(Box::new(vst3::Vst3Plugin::load(bundle)?)),
    }
}
