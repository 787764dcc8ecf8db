//! The contact models by the names that users know.

use glam::DVec3;
use palpate_haptics::contact::{Contact, ContactModel, ForceInput};
use palpate_haptics::exact::Exact;
use palpate_haptics::proxy::Proxy;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::thesis_improved::ThesisImproved;
use palpate_haptics::thesis_original::ThesisOriginal;
use palpate_volume::occupancy::Occupancy;
use serde::{Deserialize, Serialize};

/// A contact model by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

impl ContactModel for Model {
    fn advance<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        match self {
            Self::Exact => Exact::default().advance(scene, device_in_grid, proxy),
            Self::ThesisOriginal => ThesisOriginal::default().advance(scene, device_in_grid, proxy),
            Self::ThesisImproved => ThesisImproved::default().advance(scene, device_in_grid, proxy),
        }
    }

    fn visit_bound(&self) -> u32 {
        match self {
            Self::Exact => Exact::default().visit_bound(),
            Self::ThesisOriginal => ThesisOriginal::default().visit_bound(),
            Self::ThesisImproved => ThesisImproved::default().visit_bound(),
        }
    }

    fn has_own_force(&self) -> bool {
        *self != Self::Exact
    }

    fn own_force(&self, input: &ForceInput<'_>) -> Option<DVec3> {
        match self {
            Self::Exact => Exact::default().own_force(input),
            Self::ThesisOriginal => ThesisOriginal::default().own_force(input),
            Self::ThesisImproved => ThesisImproved::default().own_force(input),
        }
    }
}
