//! Groups of parameters.

/// Heading under which parameters are displayed, in the order in which hosts show them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "each is described by its file of rows")]
pub enum Group {
    Character,
    Levels,
    Drive,
    Flame,
    Texture,
    Crackle,
    Fuel,
    Extension,
    Vortex,
    Structure,
}

impl Group {
    /// The heading.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Character => "Character",
            Self::Levels => "Levels",
            Self::Drive => "Drive",
            Self::Flame => "Flame",
            Self::Texture => "Texture",
            Self::Crackle => "Crackle",
            Self::Fuel => "Fuel",
            Self::Extension => "Extension",
            Self::Vortex => "Vortex",
            Self::Structure => "Structure",
        }
    }
}
