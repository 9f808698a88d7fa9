//! State of parameters as reported by the host: mapped to a controller, automated.

use std::sync::atomic::{AtomicU32, Ordering};

use pyrophone_settings::PARAMETERS;

/// Bit that is set where a controller is mapped.
const MAPPED: u32 = 1 << 31;
/// Bits of the automation's state.
const AUTOMATION: u32 = 0xff;

/// Automation state of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Automation {
    /// Not at all.
    None,
    /// There is automation, and it does not play.
    Present,
    /// The automation plays.
    Playing,
    /// The automation is being recorded.
    Recording,
    /// The user overrides the automation.
    Overriding,
}

impl Automation {
    const ALL: [Self; 5] = [Self::None, Self::Present, Self::Playing, Self::Recording, Self::Overriding];

    /// The state with this number in CLAP's `param-indication`.
    pub fn from_clap(state: u32) -> Self {
        Self::ALL.get(state as usize).copied().unwrap_or(Self::None)
    }
}

/// One word for each parameter, written by the host's main thread, read by the window's.
#[derive(Debug)]
pub struct Indications(Vec<AtomicU32>);

impl Default for Indications {
    fn default() -> Self {
        Self(PARAMETERS.iter().map(|_| AtomicU32::new(0)).collect())
    }
}

impl Indications {
    /// Sets whether a controller is mapped to the parameter at `index` of the table.
    pub fn set_mapped(&self, index: usize, mapped: bool) {
        if mapped {
            self.0[index].fetch_or(MAPPED, Ordering::Relaxed);
        } else {
            self.0[index].fetch_and(!MAPPED, Ordering::Relaxed);
        }
    }

    /// Sets the automation state of the parameter at `index` of the table.
    pub fn set_automation(&self, index: usize, automation: Automation) {
        let mapped = self.0[index].load(Ordering::Relaxed) & MAPPED;
        self.0[index].store(mapped | automation as u32, Ordering::Relaxed);
    }

    /// True if a controller is mapped to the parameter.
    pub fn is_mapped(&self, index: usize) -> bool {
        self.0[index].load(Ordering::Relaxed) & MAPPED != 0
    }

    /// The automation state of the parameter.
    pub fn automation(&self, index: usize) -> Automation {
        Automation::from_clap(self.0[index].load(Ordering::Relaxed) & AUTOMATION)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mapping_and_automation_are_independent() {
        let indications = Indications::default();
        indications.set_mapped(3, true);
        indications.set_automation(3, Automation::Playing);
        assert!(indications.is_mapped(3) && indications.automation(3) == Automation::Playing);
        indications.set_mapped(3, false);
        assert!(!indications.is_mapped(3) && indications.automation(3) == Automation::Playing);
        assert_eq!(indications.automation(4), Automation::None);
        assert_eq!(Automation::from_clap(99), Automation::None, "states to come are none");
    }
}
