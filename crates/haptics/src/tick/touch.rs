//! The steps of a tick with the coupling's force: to where friction holds the probe, to the smooth
//! point beside the proxy, to what the surface feels like there.
//!
//! Frames: points with `_in_grid` in voxels of the world's grid, all others in mm along its axes.

use super::felt::Felt;
use super::{Tick, TickCache, TickState};
use crate::contact::{Contact, ContactModel};
use crate::force::{Feel, Friction, Holders, Surfaces};
use crate::scene::{Solid, TouchScene};
use crate::smooth::cache::{NearFields, Source};
use crate::smooth::{SmoothContact, SmoothInput, SmoothState, Smoother, Smoothing};
use glam::DVec3;
use palpate_volume::first_solid::{Outcome, first_solid_bounded};
use palpate_volume::occupancy::Occupancy;

/// Where the proxy came to when it was led to a target.
struct Reached {
    /// Where it was led to [mm].
    target: DVec3,
    target_in_grid: DVec3,
    /// What it met.
    contact: Contact,
    /// The smooth point beside it.
    smooth: SmoothContact,
}

impl Reached {
    /// Whether the probe is under the smooth surface.
    fn is_under(&self) -> bool {
        self.smooth.offset != DVec3::ZERO
    }

    /// Whether neither the hard proxy nor the smooth surface is in the way.
    fn is_free(&self) -> bool {
        !self.contact.touching && !self.is_under()
    }
}

impl<O: Occupancy, M: ContactModel, S: Surfaces> Tick<'_, O, M, S> {
    /// Moves the proxy and finds what is felt.
    pub(super) fn touch(&self, state: &mut TickState, cache: &mut TickCache) -> (Contact, Felt) {
        let was = state.blend.feel();
        let moved = self.moved_since(state);
        let reached = self.reach(was, moved, state, cache);
        if reached.contact.violation {
            state.forget_contact();
            return (reached.contact, Felt::NOTHING);
        }
        let wanted = self.wanted_feel(&reached, was, state);
        (reached.contact, self.felt(&reached, wanted, moved, state))
    }

    /// The device [mm].
    fn device_mm(&self) -> DVec3 {
        self.device * self.scene.grid.spacing()
    }

    /// How far the device moved since the last tick [mm]; infinite where it had no place.
    fn moved_since(&self, state: &TickState) -> f64 {
        state.device.map_or(f64::INFINITY, |last| {
            ((self.device - last) * self.scene.grid.spacing()).length()
        })
    }

    /// Leads the proxy to where friction holds it, or past that to the device where neither the
    /// proxy nor the surface is in the way there. The latter only with a move of the hand: a
    /// contact that fades while it rests must not let the probe jump.
    #[inline]
    fn reach(
        &self,
        was: Option<Feel>,
        moved: f64,
        state: &mut TickState,
        cache: &mut TickCache,
    ) -> Reached {
        let device = self.device_mm();
        let slip_length = self.scene.grid.smallest_spacing();
        let friction = was.map_or(Friction::NONE, |feel| feel.friction);
        let target = friction.target(device, slip_length, &mut state.friction);
        let smooth_before = state.smooth;
        let mut reached = self.advance(target, state, cache);
        if reached.is_free() && target != device && moved > 0.0 {
            state.friction.forget();
            state.smooth = smooth_before;
            let visits = reached.contact.visits;
            reached = self.advance(device, state, cache);
            reached.contact.visits += visits;
        }
        reached
    }

    /// Leads the proxy to a target [mm], and finds the smooth point beside it.
    #[inline]
    fn advance(&self, target: DVec3, state: &mut TickState, cache: &mut TickCache) -> Reached {
        let target_in_grid = if target == self.device_mm() {
            self.device
        } else {
            target / self.scene.grid.spacing()
        };
        let contact = self
            .model
            .advance(self.scene, target_in_grid, &mut state.proxy);
        let smooth = self.smooth_contact(target_in_grid, &contact, state, cache);
        Reached {
            target,
            target_in_grid,
            contact,
            smooth,
        }
    }

    /// The smooth point beside the proxy; the proxy itself where stairs are felt.
    #[inline]
    fn smooth_contact(
        &self,
        target_in_grid: DVec3,
        contact: &Contact,
        state: &mut TickState,
        cache: &mut TickCache,
    ) -> SmoothContact {
        let smoother = if self.input.smoothing == Smoothing::Off {
            &STAIRS
        } else {
            &SMOOTH
        };
        let fields = if smoother.enabled {
            let source = Source {
                epoch: cache.epoch,
                fractions: self.input.smoothing == Smoothing::Intensities,
            };
            cache
                .fields
                .near(self.scene, source, &state.proxy, target_in_grid)
        } else {
            NearFields::none()
        };
        let asked = SmoothInput {
            proxy: &state.proxy,
            device_in_grid: target_in_grid,
            contact,
        };
        smoother.contact_point(&fields, self.scene.grid, &asked, &mut state.smooth)
    }

    /// What the contact is to feel like: what is touched now, else what was; none without contact.
    #[inline]
    fn wanted_feel(&self, reached: &Reached, was: Option<Feel>, state: &TickState) -> Option<Feel> {
        let wanted = self.feel_of(reached, state).or(was);
        wanted.filter(|_| !reached.is_free())
    }

    /// What holds the proxy back, or where nothing does yet, what is under the smooth surface.
    #[inline]
    fn feel_of(&self, reached: &Reached, state: &TickState) -> Option<Feel> {
        let point = state.proxy.point();
        let contact = &reached.contact;
        if contact.touching {
            let target = reached.target_in_grid;
            let holders = Holders::of_contact(self.scene, point, target, contact.stopped_by);
            return holders.mixed(self.surfaces);
        }
        if !reached.is_under() {
            return None;
        }
        let normal = reached.smooth.normal / self.scene.grid.spacing();
        let below = point - normal.normalize_or_zero() * BELOW;
        let mut holders = Holders::default();
        holders.add(solid_between(self.scene, point, below)?, 1.0);
        holders.mixed(self.surfaces)
    }

    /// The spring to the smooth point, with what the surface feels like there.
    ///
    /// A surface of which nothing is known yet is not felt, and later begins from nothing: else all
    /// that was pressed in by then would be felt at once.
    #[inline]
    fn felt(
        &self,
        reached: &Reached,
        wanted: Option<Feel>,
        moved: f64,
        state: &mut TickState,
    ) -> Felt {
        let touches = reached.is_under() && wanted.is_some();
        if reached.is_under() && !touches {
            state.smooth = SmoothState::default();
        }
        let h = self.scene.grid.smallest_spacing();
        let feel = state
            .blend
            .follow(wanted, moved, reached.smooth.depth_mm, h);
        let friction = feel.map_or(Friction::NONE, |feel| feel.friction);
        let point = touches.then_some(reached.target + reached.smooth.offset);
        if touches || moved > 0.0 {
            state.friction.remember(&friction, reached.target, point);
        }
        let device = self.device_mm();
        Felt {
            spring: point.map_or(DVec3::ZERO, |point| point - device),
            normal: point.map_or(DVec3::ZERO, |_| reached.smooth.normal),
            stiffness: feel.map_or(0.0, |feel| feel.stiffness),
            sticks: touches && friction.stick > 0.0 && !state.friction.is_slipping(),
            own_force: None,
        }
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
