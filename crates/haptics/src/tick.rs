//! One tick of touch: the device's place in, the proxy's place and the force out.
//!
//! Friction leads the contact model to a target beside the device; the model moves the proxy
//! there by legal moves; the smooth contact point beside the proxy, and what the surface feels
//! like there, give the spring; the coupling makes the force of it. A model with a force of
//! its own is led to the device, and asked for its force.
//!
//! Frames: `scene` [mm] at the door, `grid` inside; the scene's frame is the patient frame
//! of its scan. Lengths between points are mm along the axes of the grid. The force has scene
//! axes [N] and has not passed the safety stage yet. Closed: no allocation, lock, log or
//! panic; the work is bounded by the contact model.

mod felt;
mod touch;

use crate::contact::{Contact, ContactModel, ForceInput, Proxy};
use crate::force::{FrictionState, Holders, SurfaceBlend, Surfaces};
use crate::scene::TouchScene;
use crate::smooth::cache::SmoothCache;
use crate::smooth::{SmoothState, Smoothing};
use felt::Felt;
pub use felt::TickOutput;
use glam::DVec3;
use palpate_volume::occupancy::Occupancy;
use serde::{Deserialize, Serialize};

/// What a tick is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickInput {
    /// Device point [mm], scene.
    pub device_in_scene: DVec3,
    /// Velocity of the device [mm/s], scene axes.
    pub velocity_in_scene: DVec3,
    /// Damping beside the spring [N·s/mm].
    pub damping: f64,
    /// Where the force comes from.
    pub smoothing: Smoothing,
}

/// All that changes from tick to tick. A recording begins with it, so that whatever stands here
/// is replayed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TickState {
    /// The proxy.
    pub proxy: Proxy,
    /// Where the probe sticks.
    pub friction: FrictionState,
    /// Where the force came from.
    pub smooth: SmoothState,
    /// What the surface felt like.
    pub blend: SurfaceBlend,
    /// Where the device was, grid; none before the first tick, or where it had no place.
    pub device: Option<DVec3>,
}

impl TickState {
    /// A proxy that has touched nothing yet.
    #[must_use]
    pub fn new(proxy: Proxy) -> Self {
        Self {
            proxy,
            friction: FrictionState::default(),
            smooth: SmoothState::default(),
            blend: SurfaceBlend::default(),
            device: None,
        }
    }

    /// Forgets the contact: after a jump of the proxy, or a device without a place.
    pub fn forget_contact(&mut self) {
        *self = Self::new(self.proxy);
    }
}

/// What ticks keep beside their state, so as not to work it out again: it changes no result.
#[derive(Clone, Debug, Default)]
pub struct TickCache {
    fields: SmoothCache,
    epoch: u64,
}

impl TickCache {
    /// Tells a number that changes with every voxel, every body and what is known of occupancy fractions.
    pub fn set_epoch(&mut self, epoch: u64) {
        self.epoch = epoch;
    }

    /// Forgets all that it keeps.
    pub fn forget(&mut self) {
        self.fields.forget();
    }
}

/// Moves the proxy toward the device and gives the force of the coupling.
///
/// Input that is not finite, or so far away that no traversal gets there, is no input: the
/// proxy stays and the force is zero.
pub fn tick<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    model: &impl ContactModel,
    surfaces: &impl Surfaces,
    input: &TickInput,
    state: &mut TickState,
    cache: &mut TickCache,
) -> TickOutput {
    let grid_from_scene = scene.grid.grid_from_patient();
    let device = grid_from_scene.transform_point3(input.device_in_scene);
    let tick = Tick {
        scene,
        model,
        surfaces,
        input,
        device,
    };
    if Proxy::at(device).is_none() {
        state.forget_contact();
        return tick.output(state, &Contact::default(), &Felt::NOTHING);
    }
    let (contact, felt) = if model.has_own_force() {
        tick.touch_as_printed(state)
    } else {
        tick.touch(state, cache)
    };
    state.device = Some(device);
    tick.output(state, &contact, &felt)
}

/// What a tick works with.
struct Tick<'a, O, M, S> {
    scene: &'a TouchScene<'a, O>,
    model: &'a M,
    surfaces: &'a S,
    input: &'a TickInput,
    /// Grid.
    device: DVec3,
}

impl<O: Occupancy, M: ContactModel, S: Surfaces> Tick<'_, O, M, S> {
    /// A model with a force of its own, as it is printed.
    fn touch_as_printed(&self, state: &mut TickState) -> (Contact, Felt) {
        let spacing = self.scene.grid.spacing();
        state.forget_contact();
        let contact = self
            .model
            .advance(self.scene, self.device, &mut state.proxy);
        if !contact.touching {
            return (contact, Felt::NOTHING);
        }
        let point = state.proxy.point();
        let holders = Holders::of_contact(self.scene, point, self.device, contact.stopped_by);
        let feel = holders.mixed(self.surfaces).or_else(|| {
            // the models know no faces that hold them
            let mut holders = Holders::default();
            holders.add(contact.stopped_by?, 1.0);
            holders.mixed(self.surfaces)
        });
        let stiffness = feel.map_or(0.0, |feel| feel.stiffness);
        let own_force = self.model.own_force(&ForceInput {
            grid: self.scene.grid,
            device_in_grid: self.device,
            proxy_in_grid: point,
            contact: &contact,
            stiffness,
            friction: feel.map_or(0.0, |feel| feel.friction.slip),
        });
        let spring = (point - self.device) * spacing;
        let felt = Felt {
            spring,
            normal: spring.normalize_or_zero(),
            stiffness,
            sticks: false,
            own_force,
        };
        (contact, felt)
    }
}
