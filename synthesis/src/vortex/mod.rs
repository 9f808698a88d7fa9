//! Vortex sound: the whoosh of turbulent flow (Dobashi, Yamamoto & Nishita 2004).

pub mod texture;

pub use texture::VortexTexture;
