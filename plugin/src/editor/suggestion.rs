//! One-click remedies for faults of the output.

use pyrophone_settings::table::DYNAMICS_MODES;
use pyrophone_settings::{Id, Values};

use pyrophone_analysis::fidelity::Diagnosis;

/// Value of Scaling alpha after one click: the one used by the paper's authors where matching buzzes.
const CALM_SCALING: f64 = 0.5;
/// Steps of Dynamics, and of Drive match in dB, for one click.
const DYNAMICS_STEP: f64 = 0.25;
const MATCH_STEP_DB: f64 = 3.0;

/// A change of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Suggestion {
    /// The parameter.
    pub id: Id,
    /// Its new value.
    pub plain: f64,
    /// Label of the button.
    pub words: String,
}

impl Suggestion {
    /// The change that is likely to help, if one remains.
    pub fn of(fault: Diagnosis, values: &Values) -> Option<Self> {
        let companded = DYNAMICS_MODES.iter().position(|mode| *mode == "companded").unwrap_or(0) as f64;
        // Controls of the texture are of no use without it.
        let is_textured = !Id::TextureLevel.parameter().is_off(values.get(Id::TextureLevel));
        let is_companded = is_textured && values.get(Id::DynamicsMode) == companded;
        let scaling = values.get(Id::ScalingAlpha);
        let is_auto = values.get(Id::ScalingAuto) > 0.5;
        let (id, plain) = match fault {
            Diagnosis::Buzzes | Diagnosis::MayBuzz if !is_textured => return None,
            Diagnosis::Buzzes | Diagnosis::MayBuzz if scaling > 0.0 && !is_companded && !is_auto => {
                (Id::ScalingAuto, 1.0)
            }
            Diagnosis::Buzzes if scaling > CALM_SCALING => (Id::ScalingAlpha, CALM_SCALING),
            Diagnosis::MayBuzz if scaling > CALM_SCALING && !is_auto => (Id::ScalingAlpha, CALM_SCALING),
            Diagnosis::Buzzes if scaling > 0.0 => (Id::ScalingAlpha, 0.0),
            Diagnosis::Buzzes if !is_companded => (Id::DynamicsMode, companded),
            Diagnosis::Wanders if is_companded => (Id::Dynamics, values.get(Id::Dynamics) + DYNAMICS_STEP),
            Diagnosis::Sudden if is_companded => (Id::DriveMatch, values.get(Id::DriveMatch) - MATCH_STEP_DB),
            Diagnosis::Dull if is_companded => (Id::DriveMatch, values.get(Id::DriveMatch) + MATCH_STEP_DB),
            _ => return None,
        };
        let parameter = id.parameter();
        let mut next = *values;
        next.set_nearest(id as usize, plain);
        let plain = next.get(id);
        let is_change = plain != values.get(id);
        is_change.then(|| Self { id, plain, words: format!("{} to {}", parameter.name, parameter.to_text(plain)) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clicks until there is nothing left to click.
    fn clicks(fault: Diagnosis, mut values: Values) -> Vec<(Id, f64)> {
        let mut done = vec![];
        while let Some(remedy) = Suggestion::of(fault, &values) {
            values.set(remedy.id as usize, remedy.plain).expect("in range");
            assert!(remedy.words.contains(remedy.id.parameter().name), "{}", remedy.words);
            done.push((remedy.id, remedy.plain));
            assert!(done.len() < 30, "{fault:?} never ends");
        }
        done
    }

    #[test]
    fn suggestions_stay_within_range_and_run_out() {
        let mut paper = Values::default();
        paper.set_text("dynamics_mode", "paper").expect("known");
        paper.set_text("scaling_alpha", "1").expect("known");
        let buzzing = clicks(Diagnosis::Buzzes, paper);
        let by_hand = [(Id::ScalingAlpha, 0.5), (Id::ScalingAlpha, 0.0)];
        assert_eq!(buzzing[0], (Id::ScalingAuto, 1.0));
        assert_eq!(buzzing[1..3], by_hand);
        assert_eq!(buzzing.len(), 4);
        assert_eq!(buzzing[3].0, Id::DynamicsMode);
        let mut companded = Values::default();
        companded.set_text("scaling_alpha", "1").expect("known");
        assert_eq!(clicks(Diagnosis::Buzzes, companded), by_hand);
        assert_eq!(clicks(Diagnosis::MayBuzz, paper), [(Id::ScalingAuto, 1.0)]);
        assert_eq!(clicks(Diagnosis::MayBuzz, companded), [(Id::ScalingAlpha, 0.5)]);
        for fault in [Diagnosis::Wanders, Diagnosis::Sudden, Diagnosis::Dull] {
            assert_eq!(clicks(fault, paper), [], "there is nothing to turn in the paper's mode");
            assert!(!clicks(fault, Values::default()).is_empty(), "{fault:?}");
        }
        assert_eq!(clicks(Diagnosis::Wanders, Values::default()).last(), Some(&(Id::Dynamics, 1.0)));
        for mut values in [paper, companded] {
            values.set_text("texture_level", "off").expect("known");
            for fault in [Diagnosis::Buzzes, Diagnosis::MayBuzz, Diagnosis::Wanders, Diagnosis::Sudden, Diagnosis::Dull]
            {
                assert_eq!(clicks(fault, values), [], "{fault:?} is not the texture's");
            }
        }
    }
}
