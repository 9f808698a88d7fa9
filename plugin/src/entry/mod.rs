//! The library's entry points for hosts, and guards around the framework's own objects.
//!
//! nice-plug 0.4.2 creates the objects; each is wrapped in one of ours, which forwards calls and fixes the framework's
//! gaps: null channel pointers, values set between two blocks, latency reported at the wrong moment, run-loop handlers
//! that are never unregistered, and missing extensions.
//!
//! | module | content |
//! |---|---|
//! | [`instance`] | shared parts of the effect inside a guard |
//! | [`buses`] | channel pointers that are never null |
//! | [`state`] | saved bytes that do not change by loading and saving |
//! | [`indication`] | state of a parameter as reported by the host: mapped, automated |
//! | `clap` | the CLAP entry: plug-in, extensions, preset discovery |
//! | `vst3` | the VST3 factory: component, controller, view |

pub mod buses;
pub mod indication;
pub mod instance;
pub mod state;

mod clap;
mod vst3;
