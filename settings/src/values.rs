//! A set of values for all parameters, and its conversion for the engines.

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::controls::{
    CompandingControls, Controls, CrackleControls, DriveControls, DriveMode, DynamicRange, ExtendControls,
    FlameControls, Flow, Fuel, FuelControls, MixControls, Quality, RecordingControls, TextureControls, ToneControls,
    VortexControls,
};
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::vortex::factory::OUTPUT_PER_PA;

use crate::table::OF_SESSION;
use crate::{COUNT, Error, Id, PARAMETERS, index_of, macros};

/// Plain values of all parameters, each in its range and on its grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values {
    plain: [f64; COUNT],
}

impl Default for Values {
    /// The values of a fresh instance.
    fn default() -> Self {
        Self { plain: std::array::from_fn(|index| PARAMETERS[index].default_value()) }
    }
}

impl Values {
    /// The plain value of one parameter.
    pub fn get(&self, id: Id) -> f64 {
        self.plain[id as usize]
    }

    /// All plain values, in the order of [`PARAMETERS`].
    pub fn as_slice(&self) -> &[f64] {
        &self.plain
    }

    /// Sets one parameter to the nearest allowed value; `index` is its index in [`PARAMETERS`], and is ignored beyond
    /// the end.
    pub fn set_nearest(&mut self, index: usize, plain: f64) {
        if let (Some(value), Some(parameter)) = (self.plain.get_mut(index), PARAMETERS.get(index)) {
            *value = parameter.snap(plain);
        }
    }

    /// Sets one parameter by its index in [`PARAMETERS`]; fails without a change if the value is out of range.
    ///
    /// # Panics
    /// If `index` is not below [`COUNT`].
    pub fn set(&mut self, index: usize, plain: f64) -> Result<(), Error> {
        self.plain[index] = PARAMETERS[index].check(plain)?;
        Ok(())
    }

    /// These values as loaded from a preset: those that belong to a session's recordings are kept from `present`.
    pub fn chosen_over(&self, present: &Self) -> Self {
        let mut chosen = *self;
        OF_SESSION.iter().for_each(|id| chosen.plain[*id as usize] = present.plain[*id as usize]);
        chosen
    }

    /// Sets one parameter by its id from text, with or without unit.
    pub fn set_text(&mut self, id: &str, text: &str) -> Result<(), Error> {
        let index = index_of(id)?;
        self.plain[index] = PARAMETERS[index].parse(text)?;
        Ok(())
    }

    /// Sets all parameters for which Chadwick & James 2011 state a value to that value; the others (levels, widths,
    /// seed, envelope) stay.
    pub fn reset_to_paper(&mut self) {
        for (value, parameter) in self.plain.iter_mut().zip(PARAMETERS) {
            if let Some(paper) = parameter.paper {
                *value = paper;
            }
        }
    }

    /// The engines' controls, moved by [`crate::macros`].
    pub fn controls(&self) -> Controls {
        let mut controls = self.controls_without_macros();
        macros::apply(self, &mut controls);
        controls
    }

    fn controls_without_macros(&self) -> Controls {
        Controls {
            drive: self.drive(),
            extend: self.extend(),
            texture: self.texture(),
            vortex: self.vortex(),
            crackle: self.crackle(),
            fuel: self.fuel_layer(),
            mix: self.mix(),
        }
    }

    fn is_on(&self, id: Id) -> bool {
        self.get(id) > 0.5
    }

    fn drive(&self) -> DriveControls {
        DriveControls {
            mode: match self.get(Id::DriveMode) as usize {
                0 => DriveMode::Pressure,
                1 => DriveMode::Flux,
                2 => DriveMode::Envelope,
                3 => DriveMode::InputEnvelope,
                _ => DriveMode::Flame,
            },
            gain: self.factor(Id::DriveGain),
            swell: 0.0,
            averaging_s: self.get(Id::Averaging) / 1000.0,
            attack_s: self.get(Id::Attack) / 1000.0,
            release_s: self.get(Id::Release) / 1000.0,
            threshold: self.factor(Id::Threshold),
            high_pass_hz: self.get(Id::HighPass),
            seed: self.seed(Id::ExtensionSeed),
            flame: FlameControls {
                scene: self.get(Id::FlameScene) as usize,
                intensity: self.get(Id::FlameIntensity),
                wind: self.get(Id::FlameWind),
                offset_s: self.get(Id::FlameOffset),
            },
        }
    }

    fn extend(&self) -> ExtendControls {
        ExtendControls {
            alpha: self.get(Id::Alpha),
            cutoff_hz: self.get(Id::Cutoff),
            blend_width_hz: self.get(Id::BlendWidth),
            noise_amount: self.get(Id::NoiseAmount),
            seed: self.seed(Id::ExtensionSeed),
            width: self.get(Id::ExtensionWidth),
        }
    }

    fn texture(&self) -> TextureControls {
        TextureControls {
            recordings: RecordingControls {
                slot: self.get(Id::RecordingSlot) as usize,
                second: self.get(Id::RecordingSecond) as usize,
                blend: self.get(Id::RecordingBlend) / 100.0,
            },
            scaling_alpha: self.get(Id::ScalingAlpha),
            scaling_auto: self.is_on(Id::ScalingAuto),
            dynamic_range: match self.get(Id::DynamicRange) as usize {
                0 => DynamicRange::Off,
                1 => DynamicRange::Learned,
                _ => DynamicRange::Running,
            },
            gate: if self.is_on(Id::Gate) { self.factor(Id::GateThreshold) } else { 0.0 },
            quality: match self.get(Id::Quality) as usize {
                0 => Quality::Bounded { candidates: 256 },
                1 => Quality::Bounded { candidates: 1024 },
                2 => Quality::Bounded { candidates: 4096 },
                _ => Quality::Exact,
            },
            seed: self.seed(Id::Take),
            variety: if self.get(Id::Take) == 0.0 { 0.0 } else { self.get(Id::TakeAmount) / 100.0 },
            companding: CompandingControls {
                dynamics: self.get(Id::Dynamics),
                drive_match: self.factor(Id::DriveMatch),
                low_end_hz: self.get(Id::LowEnd),
                spectrum_match: self.get(Id::SpectrumMatch),
            },
        }
    }

    fn crackle(&self) -> CrackleControls {
        CrackleControls {
            fuel: self.fuel(),
            density: self.get(Id::CrackleDensity),
            sharpness: self.get(Id::CrackleSharpness),
            spread: self.get(Id::CrackleSpread),
            follow: self.get(Id::CrackleFollow),
            seed: self.seed(Id::CrackleSeed),
            ..CrackleControls::default()
        }
    }

    fn fuel_layer(&self) -> FuelControls {
        FuelControls {
            fuel: self.fuel(),
            hiss_tone: self.get(Id::HissTone),
            hiss_flutter: self.get(Id::HissFlutter),
            body_tone: self.get(Id::BodyTone),
            body_flutter: self.get(Id::BodyFlutter),
            follow: self.get(Id::FuelFollow),
            seed: self.get(Id::CrackleSeed) as u32,
        }
    }

    fn mix(&self) -> MixControls {
        MixControls {
            low: self.factor(Id::LowLevel),
            extension: self.factor(Id::ExtensionLevel),
            texture: self.factor(Id::TextureLevel),
            vortex: self.factor(Id::VortexLevel),
            crackle: self.factor(Id::CrackleLevel),
            hiss: self.factor(Id::HissLevel),
            body: self.factor(Id::BodyLevel),
            width: self.get(Id::TextureWidth),
            tone: ToneControls::default(),
            output: self.factor(Id::OutputLevel),
            loudness_lufs: {
                let plain = self.get(Id::Loudness);
                (!Id::Loudness.parameter().is_off(plain)).then_some(plain)
            },
            ceiling: self.is_on(Id::Ceiling),
            bypass: self.is_on(Id::Bypass),
        }
    }

    fn fuel(&self) -> Fuel {
        Fuel::from_index(self.get(Id::Fuel) as usize)
    }

    fn vortex(&self) -> VortexControls {
        let texture = (self.get(Id::VortexTexture) as usize).min(OUTPUT_PER_PA.len() - 1);
        VortexControls {
            texture,
            flow: match self.get(Id::VortexFlow) as usize {
                0 => Flow::Envelope,
                1 => Flow::Field,
                _ => Flow::Live,
            },
            attack_s: self.get(Id::Attack) / 1000.0,
            release_s: self.get(Id::Release) / 1000.0,
            threshold: self.factor(Id::Threshold),
            speed_m_s: self.get(Id::VortexSpeed),
            field_speed: self.get(Id::VortexSpeed) / Id::VortexSpeed.parameter().default_value(),
            curve: self.get(Id::VortexCurve),
            range: self.get(Id::VortexRange),
            variation: self.get(Id::VortexVariation),
            count: self.get(Id::VortexSources) as usize,
            seed: self.seed(Id::VortexSeed),
            distance_m: self.get(Id::VortexDistance),
            spread_m: self.get(Id::VortexSpread),
            azimuth_deg: self.get(Id::VortexAzimuth),
            elevation_deg: self.get(Id::VortexElevation),
            exponent: self.get(Id::VortexFalloff),
            level: OUTPUT_PER_PA[texture],
            max_pressure_pa: maths::pow(10.0, self.get(Id::VortexLimit) / 20.0) / OUTPUT_PER_PA[texture],
            ..VortexControls::default()
        }
    }

    /// True if vortex sound of the flow `live` is audible.
    pub fn is_live(&self) -> bool {
        self.get(Id::VortexFlow) as usize == 2 && self.controls().mix.vortex != 0.0
    }

    /// The settings that decide sizes and latency.
    pub fn structure(&self) -> EngineConfig {
        EngineConfig {
            levels: self.get(Id::Levels) as usize,
            window: self.get(Id::Window) as usize,
            feature: self.get(Id::Feature) as usize,
            falloff: self.get(Id::Falloff),
            half_width: self.get(Id::HalfWidth) as usize,
            fit_width_hz: self.get(Id::FitWidth),
            dynamics: if self.get(Id::DynamicsMode) < 0.5 { MatchingMode::Paper } else { MatchingMode::Companded },
        }
    }

    /// A seed: unchanged for take 0, modified for other takes.
    fn seed(&self, id: Id) -> u32 {
        let (seed, take) = (self.get(id) as u32, self.get(Id::Take) as u32);
        // An odd factor gives every take a different number; the noise itself spreads its bits.
        seed.wrapping_add(take.wrapping_mul(0x9E37_79B1))
    }

    /// A level in dB as a factor: exactly 1 at 0 dB, exactly 0 if it is off.
    fn factor(&self, id: Id) -> f64 {
        let plain = self.get(id);
        if id.parameter().is_off(plain) { 0.0 } else { maths::pow(10.0, plain / 20.0) }
    }
}
