//! Everything that may change during playback.
//!
//! A control acts on the sound it arrived with: windows use the value at their centre, levels are delayed by the
//! latency.

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

/// Controls of [`crate::extend`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtendControls {
    /// Power-law exponent: the noise's power falls as frequency^(-alpha); 0-6.
    pub alpha: f64,
    /// Frequency in Hz where the drive ends and the noise begins, 40-1000: centre of the blend and of the fit, and
    /// corner of the envelope's low-pass.
    pub cutoff_hz: f64,
    /// Width of the blend in Hz, 2-400.
    pub blend_width_hz: f64,
    /// Factor on the fitted noise, 0-4.
    pub noise_amount: f64,
    /// Seed of the noise.
    pub seed: u32,
    /// 0 = the same noise in all channels, 1 = independent noise in each.
    pub width: f64,
}

impl Default for ExtendControls {
    /// The paper's values (§4), full width.
    fn default() -> Self {
        Self { alpha: 2.5, cutoff_hz: 180.0, blend_width_hz: 30.0, noise_amount: 1.0, seed: 42, width: 1.0 }
    }
}

/// Source of the distribution of the drive's amplitudes (§5.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DynamicRange {
    /// No mapping.
    Off,
    /// From a distribution learned beforehand; no mapping until there is one.
    Learned,
    /// Estimated while it plays.
    #[default]
    Running,
}

/// Number of candidates that one search may examine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// At most this many candidates per window.
    Bounded {
        /// Candidates compared per search, at least 1.
        candidates: u32,
    },
    /// As many as needed to be certain.
    Exact,
}

impl Default for Quality {
    fn default() -> Self {
        Self::Bounded { candidates: 1024 }
    }
}

/// Number of recordings that are kept ready side by side.
pub const SLOTS: usize = 4;

/// The recordings that texture and crackle are made from. A slot beyond the last is the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingControls {
    /// Slot of the recording.
    pub slot: usize,
    /// Slot of a second one; without a recording in it, or equal to the first, there is none.
    pub second: usize,
    /// Share of the second one, 0-1.
    pub blend: f64,
}

impl Default for RecordingControls {
    fn default() -> Self {
        Self { slot: 0, second: 1, blend: 0.0 }
    }
}

impl RecordingControls {
    /// Slot of the recording, within range.
    pub fn first(&self) -> usize {
        self.slot.min(SLOTS - 1)
    }

    /// Slot and share of the second recording, if it has a share; `is_there` returns whether a slot's recording is
    /// loaded.
    pub(crate) fn other(&self, is_there: impl Fn(usize) -> bool) -> Option<(usize, f64)> {
        let (slot, share) = (self.second.min(SLOTS - 1), crate::error::within(self.blend, 0.0, 1.0));
        (share > 0.0 && slot != self.first() && is_there(slot)).then_some((slot, share))
    }
}

/// Controls of [`crate::texture`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureControls {
    /// The recordings that it is made from.
    pub recordings: RecordingControls,
    /// Degree to which the recording's amplitudes are mapped onto the drive's, 0-1 (1: the paper).
    pub scaling_alpha: f64,
    /// True if that is lowered while single tones stand out ([`crate::texture::buzz`]).
    pub scaling_auto: bool,
    /// Source of the drive's amplitude distribution.
    pub dynamic_range: DynamicRange,
    /// Amplitude of the pyramid's top level below which, once it lasts longer than the look-ahead, nothing is
    /// synthesized; 0 = no gate.
    pub gate: f64,
    /// Bound on each search.
    pub quality: Quality,
    /// Seed of the noise that [`variety`](Self::variety) adds.
    pub seed: u32,
    /// Degree to which searches are perturbed, 0-1, so that another seed finds other windows of the same kind: noise
    /// added to the feature, relative to its own root mean square. 0 finds the nearest, as in the paper.
    pub variety: f64,
    /// Controls of companding; without effect in the paper's mode.
    pub companding: CompandingControls,
}

impl Default for TextureControls {
    fn default() -> Self {
        Self {
            recordings: RecordingControls::default(),
            scaling_alpha: 1.0,
            scaling_auto: false,
            dynamic_range: DynamicRange::Running,
            gate: 1e-4,
            quality: Quality::default(),
            seed: 0,
            variety: 0.0,
            companding: CompandingControls::default(),
        }
    }
}

/// Controls of [`crate::companding`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompandingControls {
    /// Origin of the audible loudness dynamics, 0-1: 0 = the recording's own, 1 = the drive's only.
    pub dynamics: f64,
    /// Factor on the drive's level in matching, around its automatic value; 0.01-100.
    pub drive_match: f64,
    /// Frequency in Hz below which the drive itself is heard instead of texture, 20-400; 0 = off.
    pub low_end_hz: f64,
    /// Amount of the equaliser towards the recording's spectrum, 0-1.
    pub spectrum_match: f64,
}

impl Default for CompandingControls {
    fn default() -> Self {
        Self { dynamics: 0.77, drive_match: 1.0, low_end_hz: 150.0, spectrum_match: 0.75 }
    }
}

/// Source of the flow speeds of vortex sound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Flow {
    /// The drive's envelope, for all of them.
    #[default]
    Envelope,
    /// A speed field, for each of them; nothing sounds without one.
    Field,
    /// A flow simulated during playback, into which the drive's envelope blows; silent without a simulator.
    Live,
}

/// Controls of [`crate::vortex`]. Values out of range are clamped; NaN counts as the lowest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VortexControls {
    /// Index into [`crate::vortex::TEXTURES`] of the sources' sound; beyond its end, the last. [`crate::chain::Chain`]
    /// applies it; the renderer plays the bank that it has.
    pub texture: usize,
    /// Source of the flow speeds.
    pub flow: Flow,
    /// Envelope attack in seconds, 0.0001-1.
    pub attack_s: f64,
    /// Envelope release in seconds, 0.001-5.
    pub release_s: f64,
    /// Envelope threshold as an amplitude, 0-1; below it the envelope is 0.
    pub threshold: f64,
    /// Flow speed in m/s of an envelope of 1, 0-100.
    pub speed_m_s: f64,
    /// Exponent from envelope to speed, 0.1-4: below 1, soft passages flow faster.
    pub curve: f64,
    /// Share by which the sources' speeds may deviate from that, 0-1.
    pub variation: f64,
    /// Factor on a field's speeds, 0-10.
    pub field_speed: f64,
    /// Seconds by which a field is ahead of the timeline, -3600 to 3600.
    pub field_offset_s: f64,
    /// Number of sources, up to the renderer's capacity; a field has its own. They add by power: twice as many are 3 dB
    /// louder.
    pub count: usize,
    /// Seed of the sources' positions, directions and times.
    pub seed: u32,
    /// Distance in m from the listener to the middle of the sources, or to a field's origin; 0-1000.
    pub distance_m: f64,
    /// Radius in m of the ball that the sources are spread in, 0-100; ignored with a field.
    pub spread_m: f64,
    /// Azimuth of the centre in degrees, positive to the right; any.
    pub azimuth_deg: f64,
    /// Elevation of the middle in degrees, -90 to 90.
    pub elevation_deg: f64,
    /// Exponent n of the fall with distance, 1-3 (1: physics, 3: as printed in the paper).
    pub exponent: f64,
    /// Share of the level's range over speed that is kept, in decibels per decibel, 0-1.
    pub range: f64,
    /// Speed in m/s whose level the range does not change, 0.1-100.
    pub reference_m_s: f64,
    /// Output per Pa, 0-1,000,000.
    pub level: f64,
    /// Largest sound pressure in Pa that a receiver accepts, 0.000001-1,000,000,000.
    pub max_pressure_pa: f64,
}

impl Default for VortexControls {
    fn default() -> Self {
        Self {
            texture: 0,
            flow: Flow::Envelope,
            attack_s: 0.005,
            release_s: 0.08,
            threshold: 0.001,
            speed_m_s: 16.0,
            curve: 0.4,
            variation: 0.25,
            field_speed: 1.0,
            field_offset_s: 0.0,
            count: 64,
            seed: 42,
            distance_m: 3.0,
            spread_m: 1.0,
            azimuth_deg: 0.0,
            elevation_deg: 0.0,
            exponent: 1.0,
            range: 0.5,
            reference_m_s: 8.0,
            level: 1.0,
            max_pressure_pa: 1e9,
        }
    }
}

/// Fuel whose crackle, hiss and body are made without a recording ([`crate::fuel`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fuel {
    /// None: nothing crackles but a recording.
    #[default]
    Off,
    /// Seasoned wood.
    DryWood,
    /// Green or damp wood.
    WetWood,
    /// Dry grass and leaves.
    Grass,
    /// Paper and cardboard.
    Paper,
    /// Coal and embers.
    Coal,
}

impl Fuel {
    /// Names in the order of [`ALL`](Self::ALL), to which new ones may only be appended.
    pub const NAMES: &'static [&'static str] = &["off", "dry wood", "wet wood", "grass", "paper", "coal"];
    /// All fuels, in the order of their declaration.
    pub const ALL: [Self; 6] = [Self::Off, Self::DryWood, Self::WetWood, Self::Grass, Self::Paper, Self::Coal];

    /// The fuel at an index of [`NAMES`](Self::NAMES); `Off` beyond its end.
    pub fn from_index(place: usize) -> Self {
        Self::ALL.get(place).copied().unwrap_or_default()
    }

    /// Index among the fuels that burn; none for `Off`.
    pub fn place(self) -> Option<usize> {
        (self as usize).checked_sub(1)
    }
}

/// Controls of the noise of [`crate::fuel`]. Values out of range are clamped; NaN counts as the lowest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FuelControls {
    /// Fuel that decides tone and level.
    pub fuel: Fuel,
    /// Tone of the hiss around the fuel's own: -1 = an octave lower, 1 = an octave higher.
    pub hiss_tone: f64,
    /// Unevenness of the hiss, 0-1: 0 = steady, 1 = in spurts.
    pub hiss_flutter: f64,
    /// Tone of the body around the fuel's own: -1 = an octave lower, 1 = an octave higher.
    pub body_tone: f64,
    /// Unevenness of the body, 0-1: 0 = steady, 1 = flapping.
    pub body_flutter: f64,
    /// Degree to which both follow the drive's loudness: 0 = not at all, 1 = as in a fire, 2 = twice as far in dB.
    pub follow: f64,
    /// Noise seed.
    pub seed: u32,
}

impl Default for FuelControls {
    fn default() -> Self {
        Self {
            fuel: Fuel::Off,
            hiss_tone: 0.0,
            hiss_flutter: 0.5,
            body_tone: 0.0,
            body_flutter: 0.5,
            follow: 1.0,
            seed: 42,
        }
    }
}

/// Controls of [`crate::crackle`]. Values out of range are clamped; NaN counts as the lowest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrackleControls {
    /// Slot of the recording that crackles.
    pub slot: usize,
    /// Fuel that crackles if no recording does.
    pub fuel: Fuel,
    /// Crackles relative to the recording's, 0-4.
    pub density: f64,
    /// -1 = dull, 0 = as recorded, 1 = bright and short.
    pub sharpness: f64,
    /// Exponent of the distance of the crackles' levels from their median: 0 = all alike, 1 = as recorded, 2 = twice as
    /// far in dB.
    pub spread: f64,
    /// Degree to which density and level follow the drive's loudness: 0 = not at all, 1 = as in a fire, 2 = twice as
    /// far in dB.
    pub follow: f64,
    /// Seed of their order and variation.
    pub seed: u32,
    /// Highest peak of a crackle, as an amplitude: louder ones are turned down as wholes. [`crate::chain::Chain`] lowers it so
    /// that none reaches the ceiling.
    pub highest_peak: f64,
}

impl Default for CrackleControls {
    fn default() -> Self {
        Self {
            slot: 0,
            fuel: Fuel::Off,
            density: 1.0,
            sharpness: 0.0,
            spread: 1.0,
            follow: 1.0,
            seed: 42,
            highest_peak: f64::INFINITY,
        }
    }
}

/// Tone of the whole effect: factors of 0 or more, each 1 if it changes nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToneControls {
    /// Factor below 700 Hz.
    pub low: f64,
    /// Factor above 700 Hz.
    pub high: f64,
    /// Factor above 2.5 kHz.
    pub air: f64,
    /// Factor above 6 kHz.
    pub hiss: f64,
}

impl Default for ToneControls {
    fn default() -> Self {
        Self { low: 1.0, high: 1.0, air: 1.0, hiss: 1.0 }
    }
}

/// Controls of [`crate::mix`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MixControls {
    /// Gain factor of the drive's own low part.
    pub low: f64,
    /// Factor on the extension's noise.
    pub extension: f64,
    /// Factor on the texture.
    pub texture: f64,
    /// Factor on vortex sound.
    pub vortex: f64,
    /// Factor on crackle.
    pub crackle: f64,
    /// Factor on a fuel's hiss.
    pub hiss: f64,
    /// Factor on a fuel's body.
    pub body: f64,
    /// Stereo width of texture, crackle, hiss and body: 0 = mono, 1 = as recorded.
    pub width: f64,
    /// Tone of the sum.
    pub tone: ToneControls,
    /// Factor on the sum.
    pub output: f64,
    /// Loudness in LUFS to which the recording is adjusted in texture and crackle, and a fuel in crackle, hiss and
    /// body, in the companded mode; none changes neither.
    pub loudness_lufs: Option<f64>,
    /// True if levels above -1 dBFS are soft-clipped so that nothing exceeds full scale.
    pub ceiling: bool,
    /// The input, delayed by the latency, instead of the effect.
    pub bypass: bool,
}

impl Default for MixControls {
    fn default() -> Self {
        Self {
            low: 1.0,
            extension: 1.0,
            texture: 1.0,
            vortex: 0.0,
            crackle: 1.0,
            hiss: 0.0,
            body: 0.0,
            width: 1.0,
            tone: ToneControls::default(),
            output: 1.0,
            loudness_lufs: None,
            ceiling: false,
            bypass: false,
        }
    }
}
