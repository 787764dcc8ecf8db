//! Objects that move: one step of a pose past the probe, and motions cut into such steps.
//!
//! While an object takes a step, the probe moves in that object's own grid: along the chord
//! from where it is by the old pose to where it is by the new one. The chord is walked exactly.
//! Where a solid voxel would sweep over the probe, the probe is pushed out of its face or carried
//! along, by the least that frees it, along the faces of other bodies where they are in the
//! way; the way in all other bodies is walked as well. Where there is no such way the probe is pinched, and the
//! step is refused: a pinched probe stops the moving object.
//!
//! Frames: the world's grid and the object's; a scene in mm. Closed, like a tick.

use crate::contact::Proxy;
use crate::contact::bodies::{Bodies, Leg, Visits};
use crate::contact::descent::Faces;
use crate::scene::{Object, ObjectPose, PoseError, TouchScene, check_rigid, corners};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use palpate_volume::first_solid::{Outcome, first_solid_bounded};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;
use serde::{Deserialize, Serialize};

/// Most voxels that one step of a pose reads.
pub const POSE_STEP_VISITS: u32 = 16_384;
/// Voxels of the chord in the object; longer steps are held.
const CHORD_VISITS: u32 = 4096;
/// How far before a face of the object the probe is carried [voxels of the object]: above the
/// rounding of the maps, below anything that can be felt.
const SKIN: f64 = 1e-6;
/// Tries of one way of carrying: straight, along a face, along a crease, and further.
const TURNS: u32 = 6;
/// A probe that slides along other bodies is pushed this many times as far as the object moves
/// at most: wedges narrower than some 15° pinch it.
const MOST_SLIDE: f64 = 4.0;

/// What became of one step of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseStep {
    /// Admitted: the object passes the probe, which stays.
    Free,
    /// Admitted: the object takes the probe along.
    Pushed,
    /// Refused: the probe is pinched. Nothing was moved.
    Held,
}

/// Asks whether object `index` of a scene may take the step from its pose to `new`, and moves
/// the probe where it is pushed. The scene has the old pose; whoever owns the object sets the
/// new one unless the step is [`PoseStep::Held`].
pub fn step_pose<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    index: usize,
    new: &ObjectPose,
    proxy: &mut Proxy,
) -> PoseStep {
    let Some(object) = scene.objects.get(index) else {
        return PoseStep::Held;
    };
    let step = Step {
        object,
        new,
        from: proxy.point(),
        chord_start: object.pose().to_object(proxy.point()),
    };
    let mut visits = Visits::new(POSE_STEP_VISITS);
    let Some(first_hit) = step.hit(proxy.point(), &mut visits) else {
        return PoseStep::Free;
    };

    // the others stand still: the way is walked in all of them
    let spacing = scene.grid.spacing();
    let reach = MOST_SLIDE * step.length(spacing) + spacing.max_element();
    let at = proxy.point() * spacing;
    let others = Bodies::near_box(scene, at - reach, at + reach).without(index);

    // aside, out of the face that pushes; else along with it, as little as frees it; else with
    // half of the chord, and as if glued
    let SweptBy::Face { fraction, normal } = first_hit else {
        return PoseStep::Held;
    };
    let chord = new.to_object(step.from) - step.chord_start;
    let carried =
        |stop: DVec3| (new.world_from_object().transform_point3(stop) - step.from) * spacing;
    let least = carried(step.chord_start + chord * fraction + normal * SKIN);
    let ways = [
        least.project_onto_normalized(new.normal_in_world(normal)),
        least,
        carried(step.chord_start + chord * (0.5 * fraction)),
        carried(step.chord_start),
    ];
    for way in ways {
        if let Some(point) = step.carry(&others, way, &mut visits)
            && let Some(carried) = Proxy::at(point)
        {
            *proxy = carried;
            return PoseStep::Pushed;
        }
    }
    PoseStep::Held
}

/// One step of one object.
struct Step<'a, O> {
    object: &'a Object<O>,
    new: &'a ObjectPose,
    /// The probe before the step, in the world and by the old pose in the object.
    from: DVec3,
    chord_start: DVec3,
}

/// How a step sweeps over the probe.
#[derive(Clone, Copy, Debug)]
enum SweptBy {
    /// By a face with this outward normal, in the object's grid, at this share of the chord.
    Face { fraction: f64, normal: DVec3 },
    /// The sweep starts in a solid voxel, or the chord is too long to be walked.
    Unknown,
}

impl<O: Occupancy> Step<'_, O> {
    /// What sweeps over a probe that goes to `end` meanwhile; none where nothing does.
    fn hit(&self, end: DVec3, visits: &mut Visits) -> Option<SweptBy> {
        let end = self.new.to_object(end);
        let bounds = self.object.bounds();
        let [low, high] = [self.chord_start.min(end), self.chord_start.max(end)];
        let apart = bounds.is_empty()
            || high.cmplt(bounds.min.as_dvec3()).any()
            || low.cmpge(bounds.max.as_dvec3()).any();
        if apart {
            return None;
        }
        if !visits.take(1) {
            return Some(SweptBy::Unknown);
        }
        let most = CHORD_VISITS.min(visits.left());
        let traversal = first_solid_bounded(self.object.occupancy(), self.chord_start, end, most);
        visits.take(traversal.visits.min(visits.left()));
        match traversal.outcome {
            Outcome::Free => None,
            Outcome::Hit(hit) if !hit.starts_inside() => Some(SweptBy::Face {
                fraction: hit.fraction,
                normal: hit.face.normal().as_dvec3(),
            }),
            _ => Some(SweptBy::Unknown),
        }
    }

    /// Takes the probe a way [mm], along the faces of other bodies where they stand in it, then
    /// as much further as the object still needs.
    fn carry(&self, others: &Bodies<'_, O>, wanted: DVec3, visits: &mut Visits) -> Option<DVec3> {
        let spacing = others.scene.grid.spacing();
        let mut faces = Faces::default();
        let mut way = wanted;
        for _ in 0..TURNS {
            let point = self.from + way / spacing;
            match others.walk(self.from, point, visits) {
                Leg::Free if self.hit(point, visits).is_none() => return Some(point),
                // slid along something, but not yet far enough
                Leg::Free => way *= 1.5,
                Leg::Unknown => return None,
                Leg::Hit(hit) => {
                    if !faces.add(hit.normal) {
                        return None;
                    }
                    // as far along the wanted way as before
                    let along = faces.allowed(wanted);
                    way = along * (wanted.length_squared() / along.length_squared()) * 1.001;
                }
            }
            // written so that NaN, from a way that is none, is refused
            let is_near = way.length() <= MOST_SLIDE * wanted.length();
            if !is_near {
                return None;
            }
        }
        None
    }

    /// An upper bound of how far the step moves a probe that sticks to the object [mm].
    fn length(&self, spacing: DVec3) -> f64 {
        let carried = self
            .new
            .world_from_object()
            .transform_point3(self.chord_start);
        let stuck = (carried - self.from) * spacing;
        let chord = self.new.to_object(self.from) - self.chord_start;
        stuck.length() + (chord * self.object.spacing()).length()
    }
}

/// A way of an object from one pose to another, tick by tick: its middle goes straight, and it
/// turns about its middle at a steady rate.
///
/// No tick turns it so far that a solid point leaves the chord of its way by more than half of
/// the smallest side of the object's voxels; where the ticks asked for are too few there are
/// more. The last pose is the target to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseMotion {
    target: DAffine3,
    /// The middle of the object in its own scene, and in the scene at both ends [mm].
    middle: DVec3,
    from_middle: DVec3,
    to_middle: DVec3,
    from_rotation: DQuat,
    to_rotation: DQuat,
    ticks: u32,
    done: u32,
}

/// Longest motion [ticks]: a minute at 1 kHz, and what is longer is cut to it.
const MAX_TICKS: u32 = 60_000;

impl PoseMotion {
    /// The way from one pose to another of an object whose solid voxels are within `bounds` of
    /// its grid, in at least `ticks` steps. Poses take its own scene to the world's [mm].
    ///
    /// # Errors
    /// Where one of the poses is no rigid motion.
    pub fn new(
        grid: &Grid,
        bounds: VoxelBox,
        from: DAffine3,
        target: DAffine3,
        ticks: u32,
    ) -> Result<Self, PoseError> {
        check_rigid(&from)?;
        check_rigid(&target)?;
        let in_scene =
            corners(bounds).map(|corner| grid.patient_from_grid().transform_point3(corner));
        let middle = in_scene.into_iter().sum::<DVec3>() / 8.0;
        let radius = in_scene
            .into_iter()
            .map(|corner| corner.distance(middle))
            .fold(0.0, f64::max);
        let [from_rotation, to_rotation] = [from, target].map(|pose| rotation_of(&pose));
        let angle = from_rotation.angle_between(to_rotation);
        let least = (angle / largest_turn(radius, grid.smallest_spacing())).ceil() as u32;
        Ok(Self {
            target,
            middle,
            from_middle: from.transform_point3(middle),
            to_middle: target.transform_point3(middle),
            from_rotation,
            to_rotation,
            ticks: ticks.max(least).clamp(1, MAX_TICKS),
            done: 0,
        })
    }

    /// Steps in all.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Whether the target is reached.
    pub fn is_done(&self) -> bool {
        self.done >= self.ticks
    }

    /// The pose after the next step; the target where there is none.
    pub fn next_pose(&self) -> DAffine3 {
        let next = self.done.saturating_add(1);
        if next >= self.ticks {
            return self.target;
        }
        let share = f64::from(next) / f64::from(self.ticks);
        let rotation = self
            .from_rotation
            .slerp(self.to_rotation, share)
            .normalize();
        let middle = self.from_middle.lerp(self.to_middle, share);
        let axes = DMat3::from_quat(rotation);
        DAffine3::from_mat3_translation(axes, middle - axes * self.middle)
    }

    /// Takes the next step, once it was admitted.
    pub fn advance(&mut self) {
        self.done = self.done.saturating_add(1).min(self.ticks);
    }
}

fn rotation_of(pose: &DAffine3) -> DQuat {
    DQuat::from_mat3(&pose.matrix3).normalize()
}

/// The largest turn whose arc of a radius stays within half of `spacing` of its chord.
fn largest_turn(radius: f64, spacing: f64) -> f64 {
    // the rise of an arc over its chord is r (1 - cos(turn / 2))
    let cosine = 1.0 - 0.5 * spacing / radius.max(spacing);
    2.0 * cosine.clamp(0.0, 1.0).acos()
}
