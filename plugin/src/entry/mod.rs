//! The entry points that hosts find in the library, and guards around the framework's own objects.
//!
//! nice-plug 0.4.2 makes the objects; each is wrapped in one of ours, which passes calls on and mends what the
//! framework leaves open: null channel pointers, values set between two blocks, latency announced at the wrong
//! moment, run-loop handlers that are never signed off, and extensions that it does not have.
//!
//! | module | is |
//! |---|---|
//! | [`instance`] | what a guard knows of the effect inside it |
//! | [`buses`] | channel pointers that are always there |
//! | [`state`] | saved bytes that do not change by loading and saving |
//! | [`indication`] | what the host says about a parameter: mapped, automated |
//! | `clap` | the CLAP entry: plug-in, extensions, preset discovery |
//! | `vst3` | the VST3 factory: component, controller, view |

pub mod buses;
pub mod indication;
pub mod instance;
pub mod state;

mod clap;
mod vst3;
