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

use crate::contact::{Contact, ContactModel, ForceInput, Proxy};
use crate::force::{Feel, Friction, FrictionState, Holders, SurfaceBlend, Surfaces};
use crate::scene::{Solid, TouchScene};
use crate::smooth::cache::{NearFields, SmoothCache, Source};
use crate::smooth::{SmoothInput, SmoothState, Smoother, Smoothing};
use felt::Felt;
pub use felt::TickOutput;
use glam::DVec3;
use palpate_volume::first_solid::{Outcome, first_solid_bounded};
use palpate_volume::occupancy::Occupancy;
use serde::{Deserialize, Serialize};

/// What a tick is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickInput {
    /// Device point [mm], scene.
    pub device_in_scene: DVec3,
    /// Its velocity [mm/s], scene axes.
    pub velocity_in_scene: DVec3,
    /// Of the damper beside the spring [N·s/mm].
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
    /// Tells a number that changes with every voxel, every body and what is known of shares.
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
    fn touch(&self, state: &mut TickState, cache: &mut TickCache) -> (Contact, Felt) {
        let spacing = self.scene.grid.spacing();
        let h = self.scene.grid.smallest_spacing();
        let device = self.device * spacing;

        // to where friction holds the probe
        let was = state.blend.feel();
        let friction = was.map_or(Friction::NONE, |feel| feel.friction);
        let mut target = friction.target(device, h, &mut state.friction);
        let advance = |to: DVec3, proxy: &mut Proxy| {
            let to = if to == device {
                self.device
            } else {
                to / spacing
            };
            (self.model.advance(self.scene, to, proxy), to)
        };
        let (mut contact, mut to) = advance(target, &mut state.proxy);

        // the smooth point beside it
        let smoother = if self.input.smoothing == Smoothing::Off {
            &STAIRS
        } else {
            &SMOOTH
        };
        let source = Source {
            epoch: cache.epoch,
            shares: self.input.smoothing == Smoothing::Intensities,
        };
        let mut smoothed = |contact: &Contact, to: DVec3, state: &mut TickState| {
            let fields = if smoother.enabled {
                cache.fields.near(self.scene, source, &state.proxy, to)
            } else {
                NearFields::none()
            };
            let asked = SmoothInput {
                proxy: &state.proxy,
                device_in_grid: to,
                contact,
            };
            smoother.contact_point(&fields, self.scene.grid, &asked, &mut state.smooth)
        };
        let smooth_before = state.smooth;
        let mut smooth = smoothed(&contact, to, state);

        // past where friction holds it, where neither is in the way there. Only with a move of
        // the hand: a contact that fades while it rests must not let the probe jump
        let way = state.device.map_or(f64::INFINITY, |last| {
            ((self.device - last) * spacing).length()
        });
        let is_lost = !contact.touching && smooth.offset == DVec3::ZERO;
        if is_lost && target != device && way > 0.0 {
            state.friction.forget();
            state.smooth = smooth_before;
            target = device;
            let visits = contact.visits;
            (contact, to) = advance(target, &mut state.proxy);
            contact.visits += visits;
            smooth = smoothed(&contact, to, state);
        }
        if contact.violation {
            state.forget_contact();
            return (contact, Felt::NOTHING);
        }
        let is_under = smooth.offset != DVec3::ZERO;

        // what the surface feels like there
        let wanted = self
            .feel(state, &contact, to, smooth.normal, is_under)
            .or(was);
        let wanted = wanted.filter(|_| contact.touching || is_under);
        // a surface of which nothing is known yet is not felt, and later begins from nothing:
        // else all that was pressed in by then would be felt at once
        let touches = is_under && wanted.is_some();
        if is_under && !touches {
            state.smooth = SmoothState::default();
        }
        let feel = state.blend.follow(wanted, way, smooth.depth_mm, h);
        let friction = feel.map_or(Friction::NONE, |feel| feel.friction);
        let point = touches.then_some(target + smooth.offset);
        if touches || way > 0.0 {
            state.friction.remember(&friction, target, point);
        }

        let felt = Felt {
            spring: point.map_or(DVec3::ZERO, |point| point - device),
            normal: point.map_or(DVec3::ZERO, |_| smooth.normal),
            stiffness: feel.map_or(0.0, |feel| feel.stiffness),
            sticks: touches && friction.stick > 0.0 && !state.friction.is_slipping(),
            own_force: None,
        };
        (contact, felt)
    }

    /// What holds the proxy back, or where nothing does yet, what is under the smooth surface.
    fn feel(
        &self,
        state: &TickState,
        contact: &Contact,
        to: DVec3,
        normal: DVec3,
        touches: bool,
    ) -> Option<Feel> {
        let point = state.proxy.point();
        if contact.touching {
            let holders = Holders::of_contact(self.scene, point, to, contact.stopped_by);
            return holders.mixed(self.surfaces);
        }
        if !touches {
            return None;
        }
        let below = point - (normal / self.scene.grid.spacing()).normalize_or_zero() * BELOW;
        let mut holders = Holders::default();
        holders.add(solid_between(self.scene, point, below)?, 1.0);
        holders.mixed(self.surfaces)
    }

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

/// With and without the smooth contact point.
static SMOOTH: Smoother = Smoother::DEFAULT;
static STAIRS: Smoother = Smoother {
    enabled: false,
    ..Smoother::DEFAULT
};

/// How far below the proxy what is under the smooth surface can be [voxels], which is as far as
/// the blur reaches.
const BELOW: f64 = 3.0;
/// Voxels on that way, of any body.
const BELOW_VISITS: u32 = 16;

/// The first solid voxel between two points of the world's grid: of the world, then of objects.
fn solid_between<O: Occupancy>(scene: &TouchScene<'_, O>, from: DVec3, to: DVec3) -> Option<Solid> {
    let hit = |occupancy: &O, from: DVec3, to: DVec3| match first_solid_bounded(
        occupancy,
        from,
        to,
        BELOW_VISITS,
    )
    .outcome
    {
        Outcome::Hit(hit) => Some(hit.voxel),
        _ => None,
    };
    if let Some(voxel) = hit(scene.occupancy, from, to) {
        return Some(Solid::of_world(voxel));
    }
    (1..).zip(scene.objects).find_map(|(body, object)| {
        let [from, to] = [from, to].map(|point| object.pose().to_object(point));
        let voxel = hit(object.occupancy(), from, to)?;
        Some(Solid { body, voxel })
    })
}
