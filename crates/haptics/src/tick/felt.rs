//! What a tick feels, and what it gives of it.
//!
//! Frames: felt along the axes of the grid in mm; given in the scene.

use super::{Tick, TickState};
use crate::contact::Contact;
use crate::force::Coupling;
use crate::scene::Solid;
use glam::DVec3;

/// What a tick gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickOutput {
    /// The proxy [mm], scene.
    pub proxy_in_scene: DVec3,
    /// Where the force comes from [mm], scene; the proxy without contact.
    pub contact_point_in_scene: DVec3,
    /// Out of the surface there, of length 1, scene axes; zero without contact.
    pub normal: DVec3,
    /// Force on the device [N], scene axes, before the safety stage; zero without contact.
    pub force: DVec3,
    /// The spring that the force comes from: from the device to the contact point [mm], scene
    /// axes; zero without contact, and where a model has a force of its own.
    pub spring: DVec3,
    /// What that spring is made of here.
    pub coupling: Coupling,
    /// Whether the contact point stays where it is along the surface.
    pub sticks: bool,
    /// The solid voxel that holds the proxy back, if one does.
    pub held_by: Option<Solid>,
    /// Whether something holds the proxy back, or pushes the device.
    pub contact: bool,
    /// Way from contact point to device [mm] in a contact, else 0.
    pub depth: f64,
    /// Voxels read.
    pub visits: u32,
    /// The proxy was found in a solid voxel: guarantee 1 is broken.
    pub violation: bool,
}

impl TickOutput {
    /// Force that presses on the surface [N]: without friction, which is along it, and without damping.
    #[must_use]
    pub fn pressing_force(&self) -> f64 {
        let held = if self.spring == DVec3::ZERO {
            self.force
        } else {
            self.spring * self.coupling.stiffness
        };
        held.dot(self.normal).max(0.0)
    }
}

/// What is felt, along the axes of the grid in mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Felt {
    /// Vector from the device to the contact point.
    pub(super) spring: DVec3,
    /// Out of the surface, of length 1.
    pub(super) normal: DVec3,
    pub(super) stiffness: f64,
    pub(super) sticks: bool,
    /// Force of a model that has one of its own [N].
    pub(super) own_force: Option<DVec3>,
}

impl Felt {
    pub(super) const NOTHING: Self = Self {
        spring: DVec3::ZERO,
        normal: DVec3::ZERO,
        stiffness: 0.0,
        sticks: false,
        own_force: None,
    };
}

impl<O, M, S> Tick<'_, O, M, S> {
    /// The answer of the tick in the scene; from differences, so that rounding stays relative to
    /// them.
    #[inline]
    pub(super) fn output(&self, state: &TickState, contact: &Contact, felt: &Felt) -> TickOutput {
        let grid = self.scene.grid;
        let to_scene = |vector: DVec3| grid.direction() * vector;
        let coupling = Coupling {
            stiffness: felt.stiffness,
            damping: self.input.damping,
        };
        let spring = to_scene(felt.spring);
        let proxy_in_scene = grid
            .patient_from_grid()
            .transform_point3(state.proxy.point());
        let touches = contact.touching || felt.spring != DVec3::ZERO;
        let force = match felt.own_force {
            Some(force) => to_scene(force),
            None => coupling.force(spring, finite(self.input.velocity_in_scene)),
        };
        TickOutput {
            proxy_in_scene,
            contact_point_in_scene: if felt.spring == DVec3::ZERO {
                proxy_in_scene
            } else {
                self.input.device_in_scene + spring
            },
            normal: to_scene(felt.normal),
            force: finite(force),
            spring: if felt.own_force.is_some() {
                DVec3::ZERO
            } else {
                spring
            },
            coupling,
            sticks: felt.sticks,
            held_by: contact.stopped_by,
            contact: touches,
            depth: spring.length(),
            visits: contact.visits,
            violation: contact.violation,
        }
    }
}

/// Zero for a vector that is not finite.
fn finite(vector: DVec3) -> DVec3 {
    if vector.is_finite() {
        vector
    } else {
        DVec3::ZERO
    }
}
