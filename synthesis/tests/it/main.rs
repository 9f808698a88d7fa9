//! The integration tests of this crate in one program, so that it is linked once.

#[path = "../common/brute.rs"]
mod brute;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/effect.rs"]
mod effect;
#[path = "../common/extend.rs"]
mod extend;
#[path = "../common/queries.rs"]
mod queries;
#[path = "../common/rendering.rs"]
mod rendering;
#[path = "../common/signals.rs"]
mod signals;

mod chain;
mod companded;
mod crackle;
mod drive_modes;
mod extend_golden;
mod extend_reference;
mod extend_stream;
mod fuel;
mod recordings;
mod stereo;
mod texture_brute;
mod texture_buzz;
mod texture_golden;
mod texture_quiet;
mod texture_stream;
mod vortex;
mod vortex_live;
