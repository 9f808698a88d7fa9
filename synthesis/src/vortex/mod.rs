//! Vortex sound: the whoosh of turbulent flow (Dobashi, Yamamoto & Nishita 2004).
//!
//! p(t) = sum over sources of Q(u_i, t - r_i/c0) / r_i^n (eq. 5): every source reads the texture Q of what a small
//! turbulent region radiates, by its flow speed u_i and as late as its distance r_i tells. All that moves, moves
//! linearly from hop to hop on the host's timeline.
//!
//! | module | does |
//! |---|---|
//! | [`texture`] | what a region radiates, by flow speed |
//! | [`bank`] | a texture made ready for an output rate |
//! | `level` | the rows and the level of a speed |
//! | [`field`] | places and speeds that a simulation told; `field_file`: as bytes |
//! | [`live`] | a flow that is simulated while it sounds |
//! | `renderer` | hops on the host's timeline |
//! | `hop`, `render_hop` | what a hop is decided to be, and how it is summed |
//! | `acoustics` | constants of sound in air |
//! | `source` | what a seed decides of a source |
//! | `motion` | which of these two tells the sources |
//! | `moving` | controls without jumps |
//! | `read` | the inner loop |
//! | `raise` | from the rate that sources are summed at to the output's |
//! | [`layout`] | receivers and channels |
//! | `seen` | where sources stand, to be drawn |
//! | `microphone` | the largest pressure |
//! | [`factory`] | the textures that come with the engines |

mod acoustics;
pub mod bank;
pub mod factory;
pub mod field;
mod field_file;
mod hop;
pub mod layout;
mod level;
pub mod live;
mod microphone;
mod motion;
mod moving;
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
pub use live::{Asked, Simulator};
pub use renderer::{MOST_SOURCES, Vortex};
pub use seen::SeenSource;
pub use texture::VortexTexture;
