//! What a caller wants of the generator beside the building.

/// What to do about member ends that the library has no entry for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Derive {
    /// Stop with an error that names them.
    Never,
    /// Scale the curves of similar columns, or take those of the section where none is similar. A floor stays in one piece where there are none for a line at which it may fold.
    Similar,
    /// Compute the curves for this model, do not store them.
    #[default]
    Run,
    /// Compute the curves and add them to the library.
    Keep,
}

/// The level of detail. Rules see it as the feature `wish.accuracy`; what they make of it is theirs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Accuracy {
    /// The fewest bodies.
    Fast,
    /// What the rules think necessary.
    #[default]
    Balanced,
    /// More than that, where it may matter.
    Fine,
}

impl Accuracy {
    /// All, coarsest first.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Balanced, Self::Fine];

    /// Its name, as rules write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::Fine => "fine",
        }
    }
}

/// All wishes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wishes {
    /// About missing curves.
    pub derive: Derive,
    /// About detail.
    pub accuracy: Accuracy,
}

impl From<Derive> for Wishes {
    fn from(derive: Derive) -> Self {
        Self { derive, accuracy: Accuracy::default() }
    }
}
