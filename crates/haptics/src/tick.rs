//! One tick of touch: the device's place in, the proxy's place and the force out.
//!
//! Frames: `scene` [mm] at the door, `grid` inside; the scene's frame is the patient frame
//! of its scan. The force has scene axes [N] and has not passed the safety stage yet.
//! Closed: no allocation, lock, log or panic; the work is bounded by the contact model.

use crate::contact::ContactModel;
use crate::coupling::Coupling;
use crate::proxy::Proxy;
use crate::scene::TouchScene;
use glam::DVec3;
use palpate_volume::occupancy::Occupancy;
use serde::{Deserialize, Serialize};

/// What a tick is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickInput {
    /// Device point [mm], scene.
    pub device_in_scene: DVec3,
    /// Its velocity [mm/s], scene axes.
    pub velocity_in_scene: DVec3,
    /// The spring between device and proxy.
    pub coupling: Coupling,
}

/// All that changes from tick to tick. A recording begins with it, so that whatever stands here
/// is replayed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TickState {
    /// The proxy.
    pub proxy: Proxy,
}

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
    /// Whether a solid voxel holds the proxy back.
    pub contact: bool,
    /// Way from proxy to device [mm] in a contact, else 0.
    pub depth: f64,
    /// Voxels read.
    pub visits: u32,
    /// The proxy was found in a solid voxel: guarantee 1 is broken.
    pub violation: bool,
}

/// Moves the proxy toward the device and gives the force of the coupling.
///
/// Input that is not finite, or so far away that no traversal gets there, is no input: the
/// proxy stays and the force is zero.
pub fn tick<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    model: &impl ContactModel,
    input: &TickInput,
    state: &mut TickState,
) -> TickOutput {
    let grid = scene.grid;
    let scene_from_grid = grid.patient_from_grid();

    // toward the device, in the grid
    let device = grid
        .grid_from_patient()
        .transform_point3(input.device_in_scene);
    let contact = model.advance(scene, device, &mut state.proxy);

    // the spring, in the scene; from the difference, so that rounding stays relative to it
    let proxy_from_device = if contact.touching {
        scene_from_grid.transform_vector3(state.proxy.point() - device)
    } else {
        DVec3::ZERO
    };
    let proxy_in_scene = scene_from_grid.transform_point3(state.proxy.point());
    TickOutput {
        proxy_in_scene,
        contact_point_in_scene: proxy_in_scene,
        normal: proxy_from_device.normalize_or_zero(),
        force: finite(
            input
                .coupling
                .force(proxy_from_device, finite(input.velocity_in_scene)),
        ),
        spring: proxy_from_device,
        coupling: input.coupling,
        sticks: false,
        contact: contact.touching,
        depth: proxy_from_device.length(),
        visits: contact.visits,
        violation: contact.violation,
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
