//! Controls of the drive and of the built-in flame.

/// Conversion of the input to the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DriveMode {
    /// The main input is the flame's low-frequency pressure.
    #[default]
    Pressure,
    /// The main input is the flame's velocity flux; its derivative is the pressure.
    Flux,
    /// The envelope of the sidechain (of the main input if there is no sidechain bus) modulates a band-limited rumble.
    Envelope,
    /// The same with the envelope of the main input: hosts that offer a sidechain bus with nothing connected to it are
    /// indistinguishable from a silent sidechain.
    InputEnvelope,
    /// A simulated flame; the input is ignored.
    Flame,
}

/// Controls of the built-in flame, which needs no input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlameControls {
    /// Index into [`crate::drive::SCENES`]; beyond its end, the last scene.
    pub scene: usize,
    /// Amount of fuel, to which the flux is proportional, 0-2; 1 as designed.
    pub intensity: f64,
    /// Wind, motion and turbulence in addition to the scene's own, 0-1; 1 is twice as much.
    pub wind: f64,
    /// Time in seconds within the scene's period at the start of the timeline; 0-3600.
    pub offset_s: f64,
}

impl Default for FlameControls {
    /// A campfire.
    fn default() -> Self {
        Self { scene: 5, intensity: 1.0, wind: 0.0, offset_s: 0.0 }
    }
}

/// Controls of [`crate::drive`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveControls {
    /// Conversion of the input.
    pub mode: DriveMode,
    /// Level of the drive as a factor, 0 or more; it acts before the engines.
    pub gain: f64,
    /// Exponent by which the drive's slow loudness varies more about its mean, -1 to 2; 0 changes nothing.
    pub swell: f64,
    /// Time constant in seconds over which the envelope averages, 0.0005-1; 0: it follows by attack and release instead.
    pub averaging_s: f64,
    /// Envelope attack in seconds, 0.0001-1.
    pub attack_s: f64,
    /// Envelope release in seconds, 0.001-5.
    pub release_s: f64,
    /// Envelope threshold as an amplitude, 0-1; below it the envelope is 0.
    pub threshold: f64,
    /// Corner of the high-pass in Hz; 0 switches it off.
    pub high_pass_hz: f64,
    /// Seed of the rumble.
    pub seed: u32,
    /// The flame that burns without an input.
    pub flame: FlameControls,
}

impl Default for DriveControls {
    fn default() -> Self {
        Self {
            mode: DriveMode::Pressure,
            gain: 1.0,
            swell: 0.0,
            averaging_s: 0.014,
            attack_s: 0.005,
            release_s: 0.08,
            threshold: 0.001,
            high_pass_hz: 30.0,
            seed: 42,
            flame: FlameControls::default(),
        }
    }
}
