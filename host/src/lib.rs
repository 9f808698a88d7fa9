//! Headless hosts for the built bundles: CLAP through `clack-host`, VST3 through the bindings of the `vst3` crate.
//!
//! [`load`] opens a bundle and gives a [`Plugin`], the half that belongs to the main thread. Its `activate` gives a
//! [`Processor`], the half that may go to another thread and play blocks of any size while the main thread goes on
//! loading states or setting parameters. [`bounce`](bounce::bounce) plays whole signals through a plugin, latency compensated.
//!
//! The VST3 half talks to the interfaces themselves instead of going through the `vst3-host` crate, because the tests need what that
//! crate does not offer: one thread in `process` while another uses the controller, a process context that is absent, and
//! a sidechain bus that is switched off.
//!
//! Values of parameters are normalised everywhere, 0 to 1; [`Plugin::parse`] and [`Plugin::text`] translate from
//! and to what a person reads. Numeric ids come from [`numeric_id`].

mod buses;
mod clap;
mod error;
mod id;
mod plugin;
mod vst3;

pub mod bounce;
pub mod editor;
pub mod state;
pub mod validator;

pub use error::HostError;
pub use id::numeric_id;
pub use plugin::{
    Block, Configuration, Event, Format, Layout, Parameter, Plugin, Processor, Requests, Tail, Transport,
};

use std::path::Path;

/// Opens the first plugin of a bundle.
///
/// The bundle's code stays loaded until the process ends, as in most hosts: instances of the same bundle share it.
///
/// # Errors
/// [`HostError::Load`] when the bundle is missing, cannot be loaded or holds no plugin.
pub fn load(bundle: &Path, format: Format) -> Result<Box<dyn Plugin>, HostError> {
    match format {
        Format::Clap => Ok(Box::new(clap::ClapPlugin::load(bundle)?)),
        Format::Vst3 => Ok(Box::new(vst3::Vst3Plugin::load(bundle)?)),
    }
}
