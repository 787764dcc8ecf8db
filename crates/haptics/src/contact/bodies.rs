//! The bodies that a tick can reach, and straight moves among all of them at once.
//!
//! A leg is a straight move whose ends are points of the world's grid, as they are stored. It
//! is walked exactly in the world and in each object's own grid, between the very points that
//! [`ObjectPose::to_object`](crate::scene::ObjectPose::to_object) gives for its ends. Legs that
//! follow one another therefore join, in each grid, to one chain of voxels from face to face.
//!
//! Frame: the world's grid; normals are unit vectors along its axes, in mm.

use crate::scene::{MAX_OBJECTS, Solid, TouchScene};
use glam::{DAffine3, DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::first_solid::{Face, Outcome, first_solid_bounded};
use palpate_volume::occupancy::Occupancy;

/// How many voxels may still be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Visits {
    left: u32,
    used: u32,
}

impl Visits {
    pub(crate) fn new(most: u32) -> Self {
        Self {
            left: most,
            used: 0,
        }
    }

    pub(crate) fn left(&self) -> u32 {
        self.left
    }

    pub(crate) fn used(&self) -> u32 {
        self.used
    }

    /// Takes some, or none where fewer are left.
    pub(crate) fn take(&mut self, count: u32) -> bool {
        let enough = count <= self.left;
        if enough {
            self.left -= count;
            self.used += count;
        }
        enough
    }
}

/// Where a leg first meets a solid voxel of any body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LegHit {
    /// Share of the leg that is free.
    pub fraction: f64,
    pub solid: Solid,
    /// Out of the face that is met, a unit vector along the world's axes [mm].
    pub normal: DVec3,
}

/// What is in the way of a straight move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Leg {
    /// No body is met: every voxel of the leg is free in all of them.
    Free,
    Hit(LegHit),
    /// Not known: the leg starts in a solid voxel, is too long to be walked, or no visits are left.
    Unknown,
}

/// The world and the objects near a move.
#[derive(Debug)]
pub(crate) struct Bodies<'a, O> {
    pub(crate) scene: TouchScene<'a, O>,
    /// Bit i is set where object i is near.
    near: u32,
}

impl<'a, O> Bodies<'a, O> {
    /// The bodies that come within `margin` [mm] of the box around two points.
    pub(crate) fn near_box(scene: &TouchScene<'a, O>, low: DVec3, high: DVec3) -> Self {
        let objects = scene.objects.iter().take(MAX_OBJECTS).enumerate();
        let near = objects.fold(0, |near, (place, object)| {
            let (object_low, object_high) = object.box_in_world();
            // written so that a box that is none, NaN included, counts as near
            let apart = high.cmplt(object_low).any() || low.cmpgt(object_high).any();
            near | u32::from(!apart) << place
        });
        Self {
            scene: *scene,
            near,
        }
    }

    /// The bodies that a proxy can meet in one tick on its way from `from` to `device`: it
    /// never leaves the ball around the device on whose rim it starts by more than the
    /// window of a slide.
    pub(crate) fn near_tick(scene: &TouchScene<'a, O>, from: DVec3, device: DVec3) -> Self {
        let spacing = scene.grid.spacing();
        let widest = scene
            .objects
            .iter()
            .take(MAX_OBJECTS)
            .fold(spacing, |widest, object| widest.max(object.spacing()));
        let distance = ((from - device) * spacing).length();
        let reach = DVec3::splat(distance + WINDOW_REACH * widest.length());
        Self::near_box(scene, device * spacing - reach, device * spacing + reach)
    }

    /// These bodies without one object.
    pub(crate) fn without(self, index: usize) -> Self {
        let mark = u32::try_from(index)
            .ok()
            .and_then(|index| 1_u32.checked_shl(index));
        Self {
            near: self.near & !mark.unwrap_or(0),
            ..self
        }
    }

    pub(crate) fn is_world_only(&self) -> bool {
        self.near == 0
    }

    /// Numbers of the bodies that are near: the world, then objects.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = u8> + Clone + use<O> {
        let near = self.near;
        let is_near = move |place: &u8| near >> place & 1 == 1;
        std::iter::once(0).chain(
            (0..MAX_OBJECTS as u8)
                .filter(is_near)
                .map(|place| place + 1),
        )
    }

    /// Sides of the body's voxels [mm].
    pub(crate) fn spacing(&self, body: u8) -> DVec3 {
        self.object(body)
            .map_or(self.scene.grid.spacing(), |object| object.spacing())
    }

    /// The smallest side of a voxel of the bodies that are near [mm].
    pub(crate) fn smallest_spacing(&self) -> f64 {
        let sides = self.numbers().map(|body| self.spacing(body).min_element());
        sides.fold(f64::INFINITY, f64::min)
    }

    /// A point in the grid of a body.
    #[inline]
    pub(crate) fn to_body(&self, body: u8, point: DVec3) -> DVec3 {
        self.object(body)
            .map_or(point, |object| object.pose().to_object(point))
    }

    /// Takes points of the world's grid to that of a body.
    pub(crate) fn body_from_world(&self, body: u8) -> DAffine3 {
        self.object(body).map_or(DAffine3::IDENTITY, |object| {
            *object.pose().object_from_world()
        })
    }

    /// Takes points of the grid of a body to the world's.
    pub(crate) fn world_from_body(&self, body: u8) -> DAffine3 {
        self.object(body).map_or(DAffine3::IDENTITY, |object| {
            *object.pose().world_from_object()
        })
    }

    /// Unit vectors along a body's axes [mm, along the world's axes].
    pub(crate) fn axes(&self, body: u8) -> [DVec3; 3] {
        let map = self.world_from_body(body).matrix3;
        let spacing = self.scene.grid.spacing();
        [map.x_axis, map.y_axis, map.z_axis].map(|axis| (axis * spacing).normalize_or_zero())
    }

    /// Way between two points of the world's grid, squared [mm²].
    #[inline]
    pub(crate) fn squared_distance(&self, a: DVec3, b: DVec3) -> f64 {
        ((a - b) * self.scene.grid.spacing()).length_squared()
    }

    fn object(&self, body: u8) -> Option<&'a crate::scene::Object<O>> {
        self.scene.objects.get(usize::from(body).wrapping_sub(1))
    }

    /// Outward normal of a voxel's face [mm, along the world's axes].
    fn normal(&self, body: u8, face: Face) -> DVec3 {
        let outward = face.normal().as_dvec3();
        self.object(body)
            .map_or(outward, |object| object.pose().normal_in_world(outward))
    }

    /// Whether a body can have solid voxels in a parallelepiped of its grid, given by two
    /// opposite corners and the directions of its edges.
    pub(crate) fn may_hold(&self, body: u8, first: DVec3, last: DVec3, edges: [DVec3; 3]) -> bool {
        let Some(object) = self.object(body) else {
            return true;
        };
        // each edge as it goes down and up along each axis
        let way = last - first;
        let reach = edges
            .iter()
            .map(|edge| edge.abs())
            .fold(DVec3::ZERO, |sum, edge| sum + edge)
            * EDGE_STEPS;
        let middle = first + way * 0.5;
        let [low, high] = [middle - reach * 0.5 - 1.0, middle + reach * 0.5 + 1.0];
        let bounds = object.bounds();
        !(high.cmplt(bounds.min.as_dvec3()).any() || low.cmpgt(bounds.max.as_dvec3()).any())
    }

    /// Whether an object's box is apart from that of a leg.
    fn is_apart(&self, body: u8, from: DVec3, to: DVec3) -> bool {
        let Some(object) = self.object(body) else {
            return false;
        };
        let spacing = self.scene.grid.spacing();
        let (low, high) = object.box_in_world();
        let [first, last] = [from.min(to) * spacing, from.max(to) * spacing];
        last.cmplt(low).any() || first.cmpgt(high).any()
    }
}

/// Steps along the edge of a window of 8 nodes.
const EDGE_STEPS: f64 = 7.0;

/// Half of a window of 8 voxels toward each side, and then some [voxels of the widest body].
const WINDOW_REACH: f64 = 8.0;

impl<O: Occupancy> Bodies<'_, O> {
    pub(crate) fn is_solid(&self, body: u8, voxel: IVec3) -> bool {
        match self.object(body) {
            Some(object) => object.occupancy().is_solid(voxel),
            None => self.scene.occupancy.is_solid(voxel),
        }
    }

    /// 8×8×8 voxels of a body.
    pub(crate) fn block(&self, body: u8, min: IVec3) -> BitBrick {
        match self.object(body) {
            Some(object) => object.occupancy().block(min),
            None => self.scene.occupancy.block(min),
        }
    }

    /// The first body in which a point is in a solid voxel, by the definition of `scene.rs`.
    pub(crate) fn solid_at(&self, point: DVec3) -> Option<Solid> {
        self.numbers().find_map(|body| {
            let voxel = self.to_body(body, point).floor().as_ivec3();
            self.is_solid(body, voxel).then_some(Solid { body, voxel })
        })
    }

    /// Walks a straight move in every body that is near; the first hit of all counts.
    pub(crate) fn walk(&self, from: DVec3, to: DVec3, visits: &mut Visits) -> Leg {
        let mut first: Option<LegHit> = None;
        for body in self.numbers() {
            if self.is_apart(body, from, to) {
                continue;
            }
            if visits.left == 0 {
                return Leg::Unknown;
            }
            let [start, end] = [from, to].map(|point| self.to_body(body, point));
            let traversal = match self.object(body) {
                Some(object) => first_solid_bounded(object.occupancy(), start, end, visits.left),
                None => first_solid_bounded(self.scene.occupancy, start, end, visits.left),
            };
            visits.take(traversal.visits);
            match traversal.outcome {
                Outcome::Free => {}
                Outcome::Hit(hit) if hit.starts_inside() => return Leg::Unknown,
                Outcome::Hit(hit) => {
                    if first.is_none_or(|first| hit.fraction < first.fraction) {
                        first = Some(LegHit {
                            fraction: hit.fraction,
                            solid: Solid {
                                body,
                                voxel: hit.voxel,
                            },
                            normal: self.normal(body, hit.face),
                        });
                    }
                }
                Outcome::OutOfVisits { .. } | Outcome::NotTraversable => return Leg::Unknown,
            }
        }
        first.map_or(Leg::Free, Leg::Hit)
    }

    /// Whether a straight move is free in every body.
    pub(crate) fn is_free(&self, from: DVec3, to: DVec3, visits: &mut Visits) -> bool {
        self.walk(from, to, visits) == Leg::Free
    }

    /// The point toward `to` as far as a walk of `most_visits` gets in each body.
    pub(crate) fn shortened(&self, from: DVec3, to: DVec3, most_visits: u32) -> DVec3 {
        let steps = |body: u8| {
            let way = self.to_body(body, to) - self.to_body(body, from);
            way.abs().element_sum()
        };
        let longest = self.numbers().map(steps).fold(0.0, f64::max);
        // a way of s voxels along the axes passes at most s + 4 voxels
        let share = (f64::from(most_visits) - 4.0).max(0.0) / longest;
        if share < 1.0 {
            from + (to - from) * share
        } else {
            to
        }
    }
}
