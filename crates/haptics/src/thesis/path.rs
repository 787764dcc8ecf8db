//! What the listings of both thesis models share: the way p2 goes in one haptic frame.
//!
//! p1 is the proxy before the frame, p2 the proxy that is moved, d2 the device, w the way
//! gone. Everything is measured in voxels, as printed, also where voxels are not cubes.
//!
//! The listings have no bound of their own: rounding moves p2 a little, round after round.
//! Here a round that moves it by less than 1e-9 has not moved it, and in any case a frame
//! ends after 2 w_max + 4 rounds of the outer loop or 2 w_max + 2 slides, which is as many
//! as w_max has room for (a slide goes half a voxel at least); w_max ends at 64.
//! Moves end where only the end point was tested, so p2 can be in a solid voxel; then
//! [`Contact::violation`] is set, frame by frame.
//!
//! Frame: grid. Source: R. Vlasov, thesis (2016), 4.2, 4.3, 4.8.

use crate::contact::{Contact, Proxy, SlidePath};
use crate::scene::{Solid, TouchScene};
use crate::thesis::border_voxels::BORDER_VISITS;
use crate::thesis::ray_samples::{ENTRY_VISITS, sample_ray};
use crate::thesis::voxelised_scene::VoxelisedScene;
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;

/// A model as its listing is printed: it knows the voxels of one grid.
pub(crate) trait Listing {
    /// One haptic frame.
    fn run<O: Occupancy>(&self, occupancy: &O, device_in_grid: DVec3, proxy: &mut Proxy)
    -> Contact;

    /// One haptic frame in a scene, whose objects count where they cover the middle of a voxel
    /// of the world.
    fn run_in_scene<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        if scene.objects.is_empty() {
            return self.run(scene.occupancy, device_in_grid, proxy);
        }
        let voxels = VoxelisedScene(*scene);
        let contact = voxels.owned(self.run(&voxels, device_in_grid, proxy));
        Contact {
            violation: scene.solid_at(proxy.point()).is_some(),
            ..contact
        }
    }
}

/// Longest w_max that is used [voxels].
const MOST_PATH: f64 = 64.0;
/// Less than this is rounding, where p2 is compared with what it was [voxels].
const SAME_PLACE: f64 = 1e-9;
/// Smallest ε that is used [voxels]: less would be rounding.
const LEAST_GAP: f64 = 1e-6;

/// The two numbers of the thesis models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThesisLimits {
    /// w_max, the longest way of the proxy in a frame [voxels]; 0 to 64, others are cut.
    pub max_path: f64,
    /// ε, how far before the collision point the proxy stops [voxels]; 1e-6 to 1.
    pub gap: f64,
}

impl Default for ThesisLimits {
    fn default() -> Self {
        // as in the runs of the thesis' errata; the thesis gives neither number
        Self {
            max_path: 5.0,
            gap: 0.1,
        }
    }
}

impl ThesisLimits {
    fn within_bounds(self) -> Self {
        // `max` takes the bound for NaN, which `clamp` would keep
        Self {
            max_path: self.max_path.max(0.0).clamp(0.0, MOST_PATH),
            gap: self.gap.max(LEAST_GAP).clamp(LEAST_GAP, 1.0),
        }
    }

    fn max_rounds(self) -> u32 {
        2 * self.max_path.ceil() as u32 + 4
    }

    fn max_slides(self) -> u32 {
        2 * self.max_path.ceil() as u32 + 2
    }

    /// Most voxels that a frame reads.
    pub(crate) fn visit_bound(self) -> u32 {
        let limits = self.within_bounds();
        // samples as far as the last whose collision could still be reached
        let ray = limits.max_path.ceil() as u32 + 3 + ENTRY_VISITS;
        // the voxel ahead, a search and the end, of which each round ends on one in vain
        let slide = BORDER_VISITS + 2;
        limits.max_rounds() * (ray + slide) + limits.max_slides() * slide + 1
    }
}

/// The way of p2 in one frame.
pub(crate) struct ThesisPath<'a, O: ?Sized> {
    occupancy: &'a O,
    limits: ThesisLimits,
    /// d2.
    device: DVec3,
    /// p2, and what it was when the round began.
    point: DVec3,
    last: Option<DVec3>,
    /// p1.
    start: DVec3,
    /// w, N_bv, w_bv and v_bv.
    path: SlidePath,
    rounds: u32,
    contact: Contact,
}

impl<'a, O: Occupancy + ?Sized> ThesisPath<'a, O> {
    /// Starts a path at p1; none where the device point is not finite or too far away.
    pub fn start(
        occupancy: &'a O,
        limits: ThesisLimits,
        device: DVec3,
        proxy: &Proxy,
    ) -> Option<Self> {
        Proxy::at(device).map(|_| Self {
            occupancy,
            limits: limits.within_bounds(),
            device,
            point: proxy.point(),
            last: None,
            start: proxy.point(),
            path: SlidePath::default(),
            rounds: 0,
            contact: Contact::default(),
        })
    }

    /// p2.
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// The voxel of p2.
    pub fn voxel(&self) -> IVec3 {
        self.point.floor().as_ivec3()
    }

    /// Begins a round of the outer loop; false where it ends: p2 has arrived, the way is
    /// used up, or the round before changed nothing.
    pub fn begin_round(&mut self) -> bool {
        let stayed = |last: DVec3| last.distance(self.point) <= SAME_PLACE;
        let goes_on = self.has_way() && !self.last.is_some_and(stayed);
        self.last = Some(self.point);
        self.rounds += 1;
        goes_on && self.rounds <= self.limits.max_rounds()
    }

    /// Whether p2 has not arrived and has way left.
    pub fn has_way(&self) -> bool {
        self.point != self.device && self.path.length < self.limits.max_path
    }

    /// Whether a slide may follow.
    pub fn may_slide(&self) -> bool {
        self.has_way() && self.contact.slides < self.limits.max_slides()
    }

    /// Moves p2 straight toward d2, as far as the collision test says; true if it collides.
    pub fn move_straight(&mut self) -> bool {
        let left = self.limits.max_path - self.path.length;
        let way = self.device - self.point;
        let distance = way.length();
        let direction = way.try_normalize().unwrap_or(DVec3::ZERO);
        // a collision farther than one sample beyond the way left changes nothing
        let reach = left + 1.0 + self.limits.gap;
        let (hit, visits) = sample_ray(self.occupancy, self.point, direction, distance, reach);
        self.contact.visits += visits;

        let Some(hit) = hit else {
            self.contact.touching = false;
            self.contact.stopped_by = None;
            if distance <= left {
                self.path.length += distance;
                self.point = self.device;
            } else {
                self.go(direction, left);
            }
            return false;
        };
        // not back behind the last sample: nobody knows what is there
        let before = (hit.distance - self.limits.gap).max(hit.last_free);
        self.go(direction, before.min(left));
        self.contact.touching = before <= left;
        self.contact.stopped_by = self.contact.touching.then_some(Solid::of_world(hit.voxel));
        true
    }

    /// Whether p2 would be free one voxel length on toward d2; one sample, as printed.
    pub fn is_free_ahead(&mut self) -> bool {
        let way = self.device - self.point;
        let ahead = self.point + way.clamp_length_max(1.0);
        self.contact.visits += 1;
        !self.occupancy.is_solid(ahead.floor().as_ivec3())
    }

    /// Counts the search for border voxels.
    pub fn count_search(&mut self) {
        self.contact.visits += BORDER_VISITS;
    }

    /// Moves p2 toward the middle of a voxel, as far as the way left goes; false where it
    /// would end in a solid voxel, and stays. Only the end is tested, as printed.
    pub fn slide_to(&mut self, voxel: IVec3) -> bool {
        let way = middle(voxel) - self.point;
        let moved = way.clamp_length_max(self.limits.max_path - self.path.length);
        let end = self.point + moved;
        self.contact.visits += 1;
        if self.occupancy.is_solid(end.floor().as_ivec3()) {
            return false;
        }
        self.point = end;
        // every slide goes to a border voxel: what the forces call the way through them
        self.path.length += moved.length();
        self.path.border_length += moved.length();
        self.path.border_sum += moved;
        self.path.border_voxels += 1;
        self.contact.slides += 1;
        true
    }

    /// Puts the proxy where p2 is.
    pub fn finish(mut self, proxy: &mut Proxy) -> Contact {
        *proxy = Proxy::at(self.point).unwrap_or(*proxy);
        self.contact.visits += 1;
        self.contact.violation = self.occupancy.is_solid(proxy.voxel());
        if self.point == self.device {
            self.contact.touching = false;
            self.contact.stopped_by = None;
        }
        self.path.moved = proxy.point() - self.start;
        self.contact.path = Some(self.path);
        self.contact
    }

    fn go(&mut self, direction: DVec3, distance: f64) {
        self.point += direction * distance;
        self.path.length += distance;
    }
}

/// The middle of a voxel: what the listings call the voxel where they measure to it.
pub(crate) fn middle(voxel: IVec3) -> DVec3 {
    voxel.as_dvec3() + 0.5
}
