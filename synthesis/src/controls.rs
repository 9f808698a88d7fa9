//! Everything that may change during playback.
//!
//! A control acts on the sound it arrived with: windows use the value at their centre, levels are delayed by the
//! latency.

mod crackle;
mod drive;
mod extend;
mod fuel;
mod mix;
mod recordings;
mod texture;
mod vortex;

pub use crackle::CrackleControls;
pub use drive::{DriveControls, DriveMode, FlameControls};
pub use extend::ExtendControls;
pub use fuel::{Fuel, FuelControls};
pub use mix::{MixControls, ToneControls};
pub use recordings::{RecordingControls, SLOTS};
pub use texture::{CompandingControls, DynamicRange, Quality, TextureControls};
pub use vortex::{Flow, VortexControls};

/// All controls of the effect.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Controls {
    /// Controls of the driving signal.
    pub drive: DriveControls,
    /// Spectral bandwidth extension.
    pub extend: ExtendControls,
    /// Texture synthesis.
    pub texture: TextureControls,
    /// Vortex sound.
    pub vortex: VortexControls,
    /// Crackle.
    pub crackle: CrackleControls,
    /// Hiss and body of a fuel.
    pub fuel: FuelControls,
    /// Levels of the layers.
    pub mix: MixControls,
}
