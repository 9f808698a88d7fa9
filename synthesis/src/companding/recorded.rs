//! The recording behind a slot's texture.

use super::profile::Profile;

/// The recording behind a slot's texture.
#[derive(Debug, Clone, Copy)]
pub struct Recorded<'a> {
    /// The recording's profile; none if the slot is empty.
    pub profile: Option<&'a Profile>,
    /// Factor for its texture, relative to the others.
    pub gain: f64,
}

impl Recorded<'_> {
    /// True if it has a noise floor above its band limit.
    pub fn has_floor(&self) -> bool {
        self.profile.is_some_and(|profile| profile.floor > 0.0)
    }
}

impl Default for Recorded<'_> {
    fn default() -> Self {
        Self { profile: None, gain: 1.0 }
    }
}
