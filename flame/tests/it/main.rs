//! The integration tests of this crate in one program, so that it is linked once.

#[path = "../common/mod.rs"]
mod common;
#[path = "../import_common/mod.rs"]
mod import_common;
#[path = "../vortex_common/mod.rs"]
mod vortex_common;

mod clusters;
mod front;
mod import_arrays;
mod import_cache;
mod import_front;
mod import_hostile;
mod import_vdb;
mod pressure;
mod reference_flame;
mod scenes;
mod solver;
mod upsample;
mod vortex_presets;
mod vortex_texture;
