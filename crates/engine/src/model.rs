//! The contact models by the names that users know.

/// A contact model by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// The one that touch uses.
    #[default]
    Exact,
    /// Thesis 4.3 as printed.
    ThesisOriginal,
    /// Thesis 4.8 as printed: what others are compared with.
    ThesisImproved,
}

impl Model {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Exact, Self::ThesisOriginal, Self::ThesisImproved];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::ThesisOriginal => "thesis-original",
            Self::ThesisImproved => "thesis-improved",
        }
    }

    /// The model of this name, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }
}
