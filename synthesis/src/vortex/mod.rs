//! Vortex sound: the whoosh of turbulent flow (Dobashi, Yamamoto & Nishita 2004).
//!
//! p(t) = sum over sources of Q(u_i, t - r_i/c0) / r_i^n (eq. 5). Every source reads the texture Q, the sound of a
//! small turbulent region, according to its flow speed u_i and with the delay of its distance r_i. Everything that
//! moves is linear from hop to hop on the host's timeline.
//!
//! | module | content |
//! |---|---|
//! | [`texture`] | the sound of a region, by flow speed |
//! | [`bank`] | a texture prepared for an output rate |
//! | `level` | rows and level of a speed |
//! | [`field`] | positions and speeds from a simulation; `field_file`: as bytes |
//! | [`live`] | a flow simulated during playback |
//! | `renderer` | hops on the host's timeline |
//! | `hop`, `render_hop` | decisions about a hop, and its summation |
//! | `follower` | the drive's envelope, which sets speeds |
//! | `acoustics` | constants of sound in air |
//! | `source` | properties of a source, drawn from a seed |
//! | `motion` | the origin of the sources' motion |
//! | `moving` | controls without jumps |
//! | `read` | the inner loop |
//! | `upsampler` | conversion from the sources' rate to the output's |
//! | [`layout`] | receivers and channels |
//! | `seen` | positions of sources, for display |
//! | `output`, `declick` | from a hop's pressures to its output; what remains after an exchange |
//! | `microphone` | the largest pressure |
//! | [`factory`] | the built-in textures |

mod acoustics;
pub mod bank;
mod declick;
pub mod factory;
pub mod field;
mod field_file;
mod follower;
mod hop;
pub mod layout;
mod level;
pub mod live;
mod microphone;
mod motion;
mod moving;
mod output;
mod read;
mod render_hop;
mod renderer;
mod seen;
mod source;
pub mod texture;
mod upsampler;

pub use acoustics::{NEAR_M, SPEED_OF_SOUND_M_S};
pub use bank::Bank;
pub use factory::TEXTURES;
pub use field::{End, SpeedField};
pub use layout::SpeakerLayout;
pub use live::{Simulator, StepRequest};
pub use renderer::{MOST_SOURCES, Vortex};
pub use seen::SeenSource;
pub use texture::VortexTexture;
