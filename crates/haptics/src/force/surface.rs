//! What a surface feels like: stiffness and friction of each segment, mixed where several hold
//! the probe back, blended where the probe comes from one to another.
//!
//! **Mixed**: faces of solid voxels hold the probe back, each along its own normal. Springs of
//! stiffness k along normals n give, for a force along f, the stiffness Σ k (n·f)²: so the
//! weights are squared direction cosines of the force. Friction is mixed the same way.
//!
//! **Blended**: by the way that the hand moves, never in time. A full change takes one voxel
//! length h, or three depths where that is more, so that the force never changes faster than
//! by a third of what pressing in does; a hand at rest has a force that is constant to the bit.
//! A probe that comes from a soft segment to a hard one, both pressed equally deep, gets a
//! stiffer spring that nobody has stretched: the passivity controller of the device thread
//! takes that energy back. Only where a person sets the surface itself anew does the blend also
//! go on in time, a full change in a quarter of a second at 1 kHz: who moves a slider with one
//! hand keeps the other at rest.
//!
//! Units: N/mm, mm; coefficients have none. Frame: that of the body a voxel belongs to.

use crate::force::coupling::MAX_STIFFNESS;
use crate::force::friction::{Friction, FrictionError};
use crate::scene::{MAX_OBJECTS, Solid, TouchScene};
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::walk::voxel_of;
use serde::{Deserialize, Serialize};

/// What a segment feels like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Spring between device and probe [N/mm].
    pub stiffness: f64,
    /// Coulomb coefficient where the probe sticks.
    pub friction_static: f64,
    /// Coulomb coefficient where it slips.
    pub friction_kinetic: f64,
}

/// Why a surface is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// The spring is not a spring.
    #[error("stiffness is {0} N/mm; allowed: finite, 0 to {MAX_STIFFNESS}")]
    Stiffness(f64),
    /// The friction is none.
    #[error(transparent)]
    Friction(#[from] FrictionError),
}

impl Surface {
    /// Checks all figures, for values that a person gave.
    ///
    /// # Errors
    /// [`SurfaceError`] names the first that is not allowed.
    pub fn check(&self) -> Result<(), SurfaceError> {
        if !(0.0..=MAX_STIFFNESS).contains(&self.stiffness) {
            return Err(SurfaceError::Stiffness(self.stiffness));
        }
        self.friction().check()?;
        Ok(())
    }

    /// Friction of the surface.
    #[must_use]
    pub fn friction(&self) -> Friction {
        Friction {
            stick: self.friction_static,
            slip: self.friction_kinetic,
        }
    }
}

/// Which surface a solid voxel has; neither allocates nor panics.
pub trait Surfaces {
    /// The surface of this voxel.
    fn surface_of(&self, solid: Solid) -> Surface;
}

/// The same surface everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniform(pub Surface);

impl Uniform {
    /// A surface without friction; stiffness in N/mm.
    #[must_use]
    pub fn smooth(stiffness: f64) -> Self {
        Self(Surface {
            stiffness,
            friction_static: 0.0,
            friction_kinetic: 0.0,
        })
    }
}

impl Surfaces for Uniform {
    fn surface_of(&self, _solid: Solid) -> Surface {
        self.0
    }
}

/// Solids that can hold a probe back at once, at most: as many as there are directions.
pub const MAX_HOLDERS: usize = 3;

/// How near a face of its voxel the probe must stand to be held by it [voxels]; it stands 1e-8
/// away, and turned grids round.
const AT_FACE: f64 = 1e-6;

/// Which solids hold the probe back, each with its share of the force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Holders {
    solids: [(Solid, f64); MAX_HOLDERS],
}

impl Holders {
    /// Adds a solid with a weight; the weightiest stay. A weight that is none adds nothing.
    pub fn add(&mut self, solid: Solid, weight: f64) {
        // none is none, so that they can be compared plainly
        let [first, rest @ ..] = &mut self.solids;
        let lightest = rest.iter_mut().fold(first, |lightest, solid| {
            if solid.1 < lightest.1 {
                solid
            } else {
                lightest
            }
        });
        if weight > lightest.1 {
            *lightest = (solid, weight.min(1.0));
        }
    }

    /// What holds back a probe at `point_in_grid` that is led to `target_in_grid`, both of the
    /// world's grid: faces of the world and of objects, and for what they leave of the force the
    /// voxel that stopped the probe.
    #[must_use]
    pub fn of_contact<O: Occupancy>(
        scene: &TouchScene<'_, O>,
        point_in_grid: DVec3,
        target_in_grid: DVec3,
        stopped_by: Option<Solid>,
    ) -> Self {
        let pull = (target_in_grid - point_in_grid) * scene.grid.spacing();
        let mut holders = Self::default();
        holders.add_faces(0, scene.occupancy, point_in_grid, pull);
        for (body, object) in (1..).zip(scene.objects.iter().take(MAX_OBJECTS)) {
            let to_own = |point| object.pose().to_object(point);
            let [point, target] = [point_in_grid, target_in_grid].map(to_own);
            let pull = (target - point) * object.spacing();
            holders.add_faces(body, object.occupancy(), point, pull);
        }
        let by_faces: f64 = holders.solids.iter().map(|(_, weight)| weight).sum();
        if let Some(solid) = stopped_by
            && (solid.body > 0 || by_faces == 0.0)
        {
            holders.add(solid, (1.0 - by_faces).max(0.0));
        }
        holders
    }

    /// Adds the voxels of a body on whose faces the probe stands. `pull` is the direction from
    /// the probe to where it is led, along the axes of the body's grid, in mm.
    pub fn add_faces(
        &mut self,
        body: u8,
        occupancy: &(impl Occupancy + ?Sized),
        point_in_grid: DVec3,
        pull: DVec3,
    ) {
        let voxel = voxel_of(point_in_grid);
        let within = (point_in_grid - voxel.as_dvec3()).to_array();
        let square = pull.length_squared();
        let axes = [IVec3::X, IVec3::Y, IVec3::Z];
        for ((axis, within), pull) in axes.into_iter().zip(within).zip(pull.to_array()) {
            let (to_face, step) = match pull > 0.0 {
                true => (1.0 - within, axis),
                false => (within, -axis),
            };
            // also false where something is not finite, or beyond all voxels
            let at_face = (0.0..=AT_FACE).contains(&to_face) && pull != 0.0;
            let beyond = voxel.saturating_add(step);
            if at_face && occupancy.is_solid(beyond) {
                let solid = Solid {
                    body,
                    voxel: beyond,
                };
                self.add(solid, pull * pull / square);
            }
        }
    }

    /// Whether nothing holds the probe back.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.solids().next().is_none()
    }

    /// The solids and their weights.
    pub fn solids(&self) -> impl Iterator<Item = (Solid, f64)> {
        self.solids.into_iter().filter(|(_, weight)| *weight > 0.0)
    }

    /// What they feel like together; none where there is nothing.
    #[must_use]
    pub fn mixed(&self, surfaces: &(impl Surfaces + ?Sized)) -> Option<Feel> {
        let total: f64 = self.solids.iter().map(|(_, weight)| weight).sum();
        if total == 0.0 {
            return None;
        }
        let nothing = Feel {
            stiffness: 0.0,
            friction: Friction::NONE,
        };
        Some(self.solids().fold(nothing, |sum, (solid, weight)| {
            let surface = surfaces.surface_of(solid);
            let share = weight / total;
            Feel {
                stiffness: sum.stiffness + share * surface.stiffness,
                friction: Friction {
                    stick: sum.friction.stick + share * surface.friction_static,
                    slip: sum.friction.slip + share * surface.friction_kinetic,
                },
            }
        }))
    }
}

/// What a contact feels like at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feel {
    /// Spring between device and probe [N/mm].
    pub stiffness: f64,
    /// Friction of the surface.
    pub friction: Friction,
}

/// What the contact feels like now, on its way to what holds the probe back now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfaceBlend {
    stiffness: Blend,
    stick: Blend,
    slip: Blend,
    touching: bool,
    /// What surfaces feel like was set anew, and this contact has not come there yet.
    #[serde(rename = "told")]
    settings_changed: bool,
}

/// Share of a full change in a tick after the surface was set anew.
const NEW_SETTINGS_SHARE: f64 = 1.0 / 256.0;

impl SurfaceBlend {
    /// A person has set anew what surfaces feel like: also a hand at rest is to feel it.
    pub fn note_new_settings(&mut self) {
        self.settings_changed = self.touching;
    }

    /// Goes on to what is touched now, by the way [mm] that the hand moved since the last tick;
    /// none without contact, which is forgotten: a new contact begins as it is, without depth.
    ///
    /// `depth` [mm] is that of the contact, `h` [mm] the smallest spacing, > 0.
    #[inline]
    pub fn follow(&mut self, wanted: Option<Feel>, way: f64, depth: f64, h: f64) -> Option<Feel> {
        let Some(wanted) = wanted else {
            *self = Self::default();
            return None;
        };
        // a new contact begins as it is; `max` keeps a way that is none from counting
        let share = if self.touching {
            let in_time = if self.settings_changed {
                NEW_SETTINGS_SHARE
            } else {
                0.0
            };
            (way / h.max(3.0 * depth)).max(in_time)
        } else {
            f64::INFINITY
        };
        self.stiffness.follow(wanted.stiffness, share);
        self.stick.follow(wanted.friction.stick, share);
        self.slip.follow(wanted.friction.slip, share);
        self.touching = true;
        let there = [
            (self.stiffness, wanted.stiffness),
            (self.stick, wanted.friction.stick),
            (self.slip, wanted.friction.slip),
        ];
        self.settings_changed &= there.iter().any(|(blend, wanted)| blend.now != *wanted);
        self.feel()
    }

    /// What the contact felt like in the last tick; none without contact.
    #[must_use]
    pub fn feel(&self) -> Option<Feel> {
        self.touching.then_some(Feel {
            stiffness: self.stiffness.now,
            friction: Friction {
                // each goes its own way, so that they could cross
                stick: self.stick.now.max(self.slip.now),
                slip: self.slip.now,
            },
        })
    }
}

/// One figure on its way to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Blend {
    now: f64,
    /// The largest figure on the way so far: a full change is from nothing to it.
    largest: f64,
}

impl Blend {
    /// Moves toward `wanted` by a fraction of a full change; an infinite one jumps to it.
    fn follow(&mut self, wanted: f64, share: f64) {
        if share == f64::INFINITY || self.now == wanted {
            (self.now, self.largest) = (wanted, wanted);
            return;
        }
        self.largest = self.largest.max(wanted);
        let step = self.largest * share;
        self.now += (wanted - self.now).max(-step).min(step);
    }
}
