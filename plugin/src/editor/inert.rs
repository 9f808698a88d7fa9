//! Parameters without effect at present, and the reasons: the window dims them and says so.

use pyrophone_settings::{COUNT, Group, Id, PARAMETERS, Parameter, Values};
use pyrophone_synthesis::Controls;
use pyrophone_synthesis::controls::{DriveMode, DynamicRange, Flow, Fuel, SLOTS};
use pyrophone_synthesis::structure::MatchingMode;

/// State that decides this, besides the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Circumstances {
    /// True if a recording is loaded in the active slot.
    pub has_recording: bool,
    /// True for each slot with a recording.
    pub loaded: [bool; SLOTS],
}

const EXTENSION_OFF: &str = "Extension level is off";
const TEXTURE_OFF: &str = "Texture level is off";
const NO_RECORDING: &str = "There is no recording";
const PAPER: &str = "Dynamics mode is paper";
const NOTHING_CRACKLES: &str = "There is no recording, and no fuel";
const HISS_OFF: &str = "Hiss level is off";
const BODY_OFF: &str = "Body level is off";
const CRACKLE_OFF: &str = "Crackle level is off";
const NOTHING_FOLLOWS: &str = "Nothing follows an envelope: neither Drive nor vortex sound is set to one";
const VORTEX_OFF: &str = "Vortex level is off";

/// Reason why each parameter of the table has no effect; none where it has one.
pub type Reasons = [Option<&'static str>; COUNT];

/// The reasons for these values.
pub fn reasons(values: &Values, circumstances: Circumstances) -> Reasons {
    let situation = Situation {
        controls: values.controls(),
        is_companded: values.structure().dynamics == MatchingMode::Companded,
        has_recording: circumstances.has_recording,
        loaded: circumstances.loaded,
        values,
    };
    std::array::from_fn(|index| situation.reason(&PARAMETERS[index]))
}

struct Situation<'a> {
    controls: Controls,
    is_companded: bool,
    has_recording: bool,
    loaded: [bool; SLOTS],
    values: &'a Values,
}

impl Situation<'_> {
    fn reason(&self, parameter: &Parameter) -> Option<&'static str> {
        match parameter.group {
            Group::Extension => self.extension(parameter.id),
            Group::Texture => self.texture(parameter.id),
            Group::Crackle => self.crackle(),
            Group::Fuel => self.fuel(parameter.id),
            Group::Vortex => self.vortex(parameter.id),
            Group::Flame => self.flame(),
            Group::Drive => self.drive(parameter.id),
            Group::Levels => self.levels(parameter.id),
            Group::Character => self.character(parameter.id),
            Group::Structure => None,
        }
    }

    /// True if extension is heard in place of texture.
    fn is_substituted(&self) -> bool {
        self.is_companded && !self.has_recording && !self.has_fuel() && self.controls.mix.texture != 0.0
    }

    fn extension(&self, id: &str) -> Option<&'static str> {
        let mix = &self.controls.mix;
        let shapes_low = matches!(id, "cutoff" | "blend_width") && mix.low != 0.0;
        // The rumble of envelope drives has the same seed.
        let seeds_rumble = id == "extension_seed"
            && matches!(self.controls.drive.mode, DriveMode::Envelope | DriveMode::InputEnvelope);
        let is_heard = mix.extension != 0.0 || self.is_substituted() || shapes_low || seeds_rumble;
        (!is_heard).then_some(EXTENSION_OFF)
    }

    fn texture(&self, id: &str) -> Option<&'static str> {
        let texture = &self.controls.texture;
        match id {
            "recording_slot" | "recording_second" => None,
            "recording_blend" => self.blend(),
            _ if self.controls.mix.texture == 0.0 => Some(TEXTURE_OFF),
            _ if !self.has_recording => Some(NO_RECORDING),
            "dynamics" | "drive_match" | "low_end" | "spectrum_match" if !self.is_companded => Some(PAPER),
            "scaling_alpha" | "scaling_auto" if texture.dynamic_range == DynamicRange::Off => {
                Some("Dynamic range is off")
            }
            "scaling_auto" if texture.scaling_alpha == 0.0 => Some("Scaling alpha is 0"),
            "gate_threshold" if texture.gate == 0.0 => Some("Gate is off"),
            _ => None,
        }
    }

    fn blend(&self) -> Option<&'static str> {
        let recordings = &self.controls.texture.recordings;
        match recordings.second {
            second if second == recordings.slot => Some("The second recording is the first"),
            second if !self.loaded.get(second).is_some_and(|loaded| *loaded) => Some("There is no second recording"),
            _ => None,
        }
    }

    fn crackle(&self) -> Option<&'static str> {
        if !self.is_companded {
            Some(PAPER)
        } else if !self.has_recording && !self.has_fuel() {
            Some(NOTHING_CRACKLES)
        } else {
            (self.controls.mix.crackle == 0.0).then_some(CRACKLE_OFF)
        }
    }

    fn has_fuel(&self) -> bool {
        self.controls.fuel.fuel != Fuel::Off
    }

    fn fuel(&self, id: &str) -> Option<&'static str> {
        let mix = &self.controls.mix;
        match id {
            _ if !self.is_companded => Some(PAPER),
            "hiss_tone" | "hiss_flutter" if mix.hiss == 0.0 => Some(HISS_OFF),
            "body_tone" | "body_flutter" if mix.body == 0.0 => Some(BODY_OFF),
            "fuel_follow" if mix.hiss == 0.0 && mix.body == 0.0 => Some("Hiss and body are off"),
            _ => None,
        }
    }

    fn vortex(&self, id: &str) -> Option<&'static str> {
        match id {
            _ if self.controls.mix.vortex == 0.0 => Some(VORTEX_OFF),
            "vortex_curve" if self.controls.vortex.flow == Flow::Field => Some("Flow is field"),
            _ => None,
        }
    }

    fn flame(&self) -> Option<&'static str> {
        (self.controls.drive.mode != DriveMode::Flame).then_some("Drive is not flame")
    }

    fn drive(&self, id: &str) -> Option<&'static str> {
        let drive = &self.controls.drive;
        let drive_follows = matches!(drive.mode, DriveMode::Envelope | DriveMode::InputEnvelope);
        let vortex_follows = self.controls.mix.vortex != 0.0 && self.controls.vortex.flow != Flow::Field;
        match id {
            "attack" | "release" | "threshold" if !drive_follows && !vortex_follows => Some(NOTHING_FOLLOWS),
            "attack" | "release" if drive.averaging_s > 0.0 && !vortex_follows => Some("Averaging is on"),
            "averaging" if !drive_follows => Some("Drive is not an envelope"),
            _ => None,
        }
    }

    fn levels(&self, id: &str) -> Option<&'static str> {
        match id {
            "crackle_level" if !self.is_companded => Some(PAPER),
            "hiss_level" | "body_level" if !self.is_companded => Some(PAPER),
            "crackle_level" if !self.has_recording && !self.has_fuel() => Some(NOTHING_CRACKLES),
            "texture_level" if !self.is_companded && !self.has_recording => Some(NO_RECORDING),
            "loudness" if !self.is_companded => Some(PAPER),
            "loudness" if !self.has_recording => Some(NO_RECORDING),
            _ => None,
        }
    }

    fn character(&self, id: &str) -> Option<&'static str> {
        match id {
            "macro_crackle" | "macro_sharpness" => self.crackle(),
            "macro_tightness" => self.texture("").filter(|_| self.crackle().is_some()),
            "take_amount" if self.values.get(Id::Take) == 0.0 => Some("Take 0 uses the seeds as set"),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pyrophone_settings::index_of;

    fn why(id: &str, changes: &[(&str, &str)], has_recording: bool) -> Option<&'static str> {
        let mut values = Values::default();
        changes.iter().for_each(|(id, text)| values.set_text(id, text).expect("known"));
        why_with(id, &values, [has_recording, false, false, true])
    }

    fn why_with(id: &str, values: &Values, loaded: [bool; SLOTS]) -> Option<&'static str> {
        reasons(values, Circumstances { has_recording: loaded[0], loaded })[index_of(id).expect("known")]
    }

    #[test]
    fn a_blend_needs_a_second_recording() {
        assert_eq!(why("recording_blend", &[], true), Some("There is no second recording"));
        assert_eq!(
            why("recording_blend", &[("recording_second", "1")], true),
            Some("The second recording is the first")
        );
        assert_eq!(why("recording_blend", &[("recording_second", "4")], true), None);
        assert_eq!(why("recording_slot", &[], false), None, "an empty slot can be left");
    }

    #[test]
    fn inert_parameters_state_the_reason() {
        assert_eq!(why("alpha", &[], true), Some(EXTENSION_OFF));
        assert_eq!(why("alpha", &[], false), None, "extension stands in for texture");
        assert_eq!(why("alpha", &[("extension_level", "-20")], true), None);
        assert_eq!(why("cutoff", &[("low_level", "0")], true), None, "it bounds the low layer");
        assert_eq!(why("dynamics", &[], false), Some(NO_RECORDING));
        assert_eq!(why("dynamics", &[("dynamics_mode", "paper")], true), Some(PAPER));
        assert_eq!(why("dynamics", &[("texture_level", "off")], true), Some(TEXTURE_OFF));
        assert_eq!(why("crackle_density", &[("crackle_level", "off")], true), Some(CRACKLE_OFF));
        let wood = ("fuel", "dry wood");
        assert_eq!(why("crackle_density", &[], false), Some(NOTHING_CRACKLES));
        assert_eq!(why("crackle_density", &[wood], false), None);
        assert_eq!(why("alpha", &[wood], false), Some(EXTENSION_OFF), "the fuel sounds instead");
        assert_eq!(why("hiss_tone", &[wood], false), Some(HISS_OFF));
        assert_eq!(why("hiss_tone", &[("hiss_level", "-6")], false), None);
        assert_eq!(why("vortex_speed", &[], true), Some(VORTEX_OFF));
        assert_eq!(why("vortex_speed", &[("macro_whoosh", "50")], true), None, "the macro lets it be heard");
        assert_eq!(why("flame_wind", &[], true), Some("Drive is not flame"));
        let follows = |averaging| [("drive_mode", "envelope"), ("vortex_level", "off"), ("averaging", averaging)];
        assert_eq!(why("attack", &follows("off"), true), None);
        assert_eq!(why("averaging", &follows("off"), true), None);
        assert!(why("attack", &follows("4"), true).is_some());
        assert!(why("averaging", &[], true).is_some());
        assert!(why("attack", &[], true).is_some());
        assert!(why("take_amount", &[], true).is_some());
        assert_eq!(why("macro_size", &[], false), None);
        assert_eq!(why("output_level", &[], false), None);
    }
}
