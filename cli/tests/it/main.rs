//! The integration tests of this crate in one program, so that it is linked once.

#[path = "../common/mod.rs"]
mod common;

mod documents;
mod farm;
mod flux;
mod goldens;
mod help;
mod levels;
mod lists;
mod odd_inputs;
mod per_cluster;
mod pipes;
mod probe;
mod refusals;
mod renders;
mod signals;
mod simulate;
mod summary;
mod vortex_texture;
