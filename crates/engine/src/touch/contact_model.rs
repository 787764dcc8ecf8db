//! The contact models by the names that users know.

use glam::DVec3;
use palpate_haptics::contact::{Contact, ContactModel, Exact, ExactLimits, ForceInput, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::thesis::{ThesisImproved, ThesisOriginal};
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

/// A contact model with the work that `exact` may do in a tick, which depends on the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitedModel {
    /// Which model.
    pub model: Model,
    /// Of `exact`; the thesis' models have their own.
    pub limits: ExactLimits,
}

impl LimitedModel {
    fn exact(&self) -> Exact {
        Exact {
            limits: self.limits,
        }
    }
}

impl ContactModel for LimitedModel {
    fn advance<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        let contact = match self.model {
            Model::Exact => self.exact().advance(scene, device_in_grid, proxy),
            Model::ThesisOriginal => {
                ThesisOriginal::default().advance(scene, device_in_grid, proxy)
            }
            Model::ThesisImproved => {
                ThesisImproved::default().advance(scene, device_in_grid, proxy)
            }
        };
        #[cfg(feature = "planted-fault")]
        crate::touch::planted_fault::let_walls_give_way(scene, device_in_grid, proxy, &contact);
        contact
    }

    fn visit_bound(&self) -> u32 {
        match self.model {
            Model::Exact => self.exact().visit_bound(),
            Model::ThesisOriginal => ThesisOriginal::default().visit_bound(),
            Model::ThesisImproved => ThesisImproved::default().visit_bound(),
        }
    }

    fn has_own_force(&self) -> bool {
        self.model != Model::Exact
    }

    fn own_force(&self, input: &ForceInput<'_>) -> Option<DVec3> {
        match self.model {
            Model::Exact => self.exact().own_force(input),
            Model::ThesisOriginal => ThesisOriginal::default().own_force(input),
            Model::ThesisImproved => ThesisImproved::default().own_force(input),
        }
    }
}
