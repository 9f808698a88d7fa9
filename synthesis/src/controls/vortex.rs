//! Controls of vortex sound.

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
