//! Friction: a Coulomb cone on the proxy, with a static and a kinetic coefficient.
//!
//! The contact model is led not to the device itself but to a *target*: the device moved along
//! the surface toward the *anchor*, the place where the probe sticks. Inside the static cone
//! the target stays under the anchor, so that the probe does not slide; outside, the target
//! lies on the rim of the kinetic cone, and the anchor follows there. The spring between
//! device and proxy then has the friction in it, and the proxy moves by legal moves only.
//!
//! Everything changes by the way that the hand moves, never in time: a hand at rest keeps its
//! target to the bit, and a step of the hand changes the target by little more than itself.
//! The fall from the static to the kinetic coefficient is spread over one slip length, too.
//!
//! Energy: at a fixed device the target only ever moves toward the device, so friction takes
//! energy from the spring and never adds to it; without a drop of the cone the work of each
//! tick is at most what the spring gives back (`docs/decisions/force.md` has the proof).
//!
//! Frame: any with axes in mm that does not move with the probe; the tick uses the grid's
//! axes. The offset, depth and slip length are mm, coefficients have no unit.
//! Source: Harwin & Melder, "Improved haptic rendering for multi-finger manipulation using
//! friction cone based god-objects", EuroHaptics 2002, here with the normal of the contact
//! model instead of a mesh's.

use glam::{DAffine3, DVec3};
use serde::{Deserialize, Serialize};

/// The coefficients of a dry contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Where a probe that sticks begins to slip.
    pub stick: f64,
    /// What is left of it while it slips.
    pub slip: f64,
}

/// Largest coefficient that is accepted; rubber on dry concrete has 1.
pub const MAX_FRICTION: f64 = 2.0;

/// Why a pair of coefficients is no friction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FrictionError {
    /// The static coefficient is none.
    #[error("static friction is {0}; allowed: finite, 0 to {MAX_FRICTION}")]
    Static(f64),
    /// The kinetic coefficient is none.
    #[error("kinetic friction is {kinetic}; allowed: finite, 0 to the static one, {fixed}")]
    Kinetic {
        /// The coefficient given.
        kinetic: f64,
        /// The static one beside it.
        fixed: f64,
    },
}

/// What the last tick knew of the contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Held {
    /// Device [mm].
    device: DVec3,
    /// Vector from the device to the target [mm], along the surface.
    offset: DVec3,
    /// Out of the surface, as friction takes it.
    normal: DVec3,
    /// Out of the surface, as the contact model found it last.
    measured: DVec3,
    /// Distance from the target to the contact point [mm].
    depth: f64,
    /// Between the kinetic and the static coefficient.
    coefficient: f64,
    slipping: bool,
}

/// Where the probe sticks; nothing without contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionState {
    held: Option<Held>,
}

impl Friction {
    /// No friction at all.
    pub const NONE: Self = Self {
        stick: 0.0,
        slip: 0.0,
    };

    /// Checks both coefficients, for values that a person gave.
    ///
    /// # Errors
    /// [`FrictionError`] names the one that is not allowed.
    pub fn check(&self) -> Result<(), FrictionError> {
        if !(0.0..=MAX_FRICTION).contains(&self.stick) {
            return Err(FrictionError::Static(self.stick));
        }
        if !(0.0..=self.stick).contains(&self.slip) {
            return Err(FrictionError::Kinetic {
                kinetic: self.slip,
                fixed: self.stick,
            });
        }
        Ok(())
    }

    /// Where the contact model is to go for a device point [mm]. `slip_length` [mm], > 0, is
    /// the way over which coefficients and normals change; the smallest spacing suits.
    ///
    /// Without contact, and for a point that is none, it is the device itself.
    #[inline]
    pub fn target(&self, device: DVec3, slip_length: f64, state: &mut FrictionState) -> DVec3 {
        let Some(held) = &mut state.held else {
            return device;
        };
        let moved = device - held.device;
        let way = moved.length();
        if !way.is_finite() {
            state.held = None;
            return device;
        }
        // a hand at rest keeps its target to the bit
        if way > 0.0 {
            self.follow(held, moved, way, (way / slip_length).min(1.0));
            held.device = device;
        }
        device + held.offset
    }

    /// Follows a move of the hand by `way`, which is this `share` of the slip length.
    #[inline]
    fn follow(&self, held: &mut Held, moved: DVec3, way: f64, share: f64) {
        // the surface as the hand finds it, before the contact model has looked
        held.normal = turned(held.normal, held.measured, share);
        let depth = (held.depth - moved.dot(held.normal)).max(0.0);
        held.depth = depth;

        // sticking: the target stays, so the offset takes what the hand moved along the surface
        let before = held.offset.length();
        let stuck = (held.offset - moved).reject_from_normalized(held.normal);
        let length = stuck.length();
        held.slipping = length > held.coefficient * depth;

        // slipping: to the rim of the cone, which narrows as it slips; a rim that narrows for
        // any other reason (a voxel edited, a coefficient set) is followed by way as well
        held.coefficient = self.coefficient(held, share);
        let narrowed = before - (1.0 + self.stick) * way;
        let rim = (held.coefficient * depth).max(narrowed);
        held.offset = if length > rim {
            stuck * (rim / length)
        } else {
            stuck
        };
    }

    /// The coefficient after a share of the slip length: on its way to the kinetic one while
    /// the probe slips, to the static one while it sticks; one that belongs to neither, since
    /// others were set, comes there by way as well.
    fn coefficient(&self, held: &Held, share: f64) -> f64 {
        let goal = if held.slipping { self.slip } else { self.stick };
        let between = (self.slip..=self.stick).contains(&held.coefficient);
        let range = if between {
            self.stick - self.slip
        } else {
            MAX_FRICTION
        };
        let step = range * share;
        held.coefficient + (goal - held.coefficient).max(-step).min(step)
    }
}

impl FrictionState {
    /// Takes what the contact model found for a target: the contact point [mm], or none
    /// without contact, where the anchor is forgotten.
    #[inline]
    pub fn remember(&mut self, friction: &Friction, target: DVec3, contact: Option<DVec3>) {
        let Some(point) = contact else {
            self.held = None;
            return;
        };
        let outward = point - target;
        let depth = outward.length();
        let normal = outward / depth;
        match &mut self.held {
            // a contact without depth has no direction; the last one stays
            Some(held) if !normal.is_finite() => held.depth = 0.0,
            Some(held) => (held.depth, held.measured) = (depth, normal),
            None if !normal.is_finite() => {}
            None => {
                self.held = Some(Held {
                    device: target,
                    offset: DVec3::ZERO,
                    normal,
                    measured: normal,
                    depth,
                    coefficient: friction.stick,
                    slipping: false,
                });
            }
        }
    }

    /// Moves the anchor with the body that is touched, by a rigid motion of the frame [mm]: a
    /// hand that sticks is taken along.
    pub fn carry(&mut self, after_from_before: &DAffine3) {
        if let Some(held) = &mut self.held {
            held.device = after_from_before.transform_point3(held.device);
            held.offset = after_from_before.transform_vector3(held.offset);
            held.normal = after_from_before.transform_vector3(held.normal);
            held.measured = after_from_before.transform_vector3(held.measured);
        }
    }

    /// Forgets the contact: after a jump of the probe.
    pub fn forget(&mut self) {
        self.held = None;
    }

    /// Vector from the device to the target [mm]; zero without contact or friction.
    #[must_use]
    pub fn offset(&self) -> DVec3 {
        self.held.map_or(DVec3::ZERO, |held| held.offset)
    }

    /// Whether it holds the probe away from the device, as long as it lets go of it too.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.held.is_some_and(|held| held.offset != DVec3::ZERO)
    }

    /// Whether the probe slips over the surface.
    #[must_use]
    pub fn is_slipping(&self) -> bool {
        self.held.is_some_and(|held| held.slipping)
    }
}

/// A direction on the way from one to another; the old one where they are opposed.
fn turned(from: DVec3, to: DVec3, share: f64) -> DVec3 {
    from.lerp(to, share).try_normalize().unwrap_or(from)
}
