//! Whether the probe kept its promises, found out the slow way and with voxels of its own.
//!
//! Frames: the world's grid; the scene [mm] where a name says so.

use glam::{DAffine3, DVec3, IVec3};
use palpate_haptics::contact::Proxy;
use palpate_haptics::tick::TickOutput;
use palpate_volume::voxel_box::VoxelBox;

use super::constants::Constants;
use super::dense::{Dense, Finder};
use super::guarantee::{Guarantee, Violation, hold};
use super::object::Object;
use super::paths::{Blocked, EVERYWHERE, WINDOW, is_free, path_past};

/// First the near neighbourhood is searched [voxels].
const NEAR: i32 = 4;
/// How far a change may push the probe [voxels].
const PUSH: i32 = 7;

/// What is solid, and where a probe may go.
#[derive(Debug)]
pub struct Checker {
    constants: Constants,
    /// What is touched now in the world.
    pub dense: Dense,
    /// The objects.
    objects: Vec<Object>,
    /// Parts of the space that walls which stay as they are leave free.
    parts: Vec<u32>,
    finder: Finder,
    blocked: Blocked,
}

impl Checker {
    /// A checker of a world, of which `constant` is what no edit changes.
    pub fn new(constants: Constants, dense: Dense, constant: &Dense, objects: Vec<Object>) -> Self {
        Self {
            constants,
            objects,
            parts: constant.parts(),
            blocked: Blocked::default(),
            dense,
            finder: Finder::default(),
        }
    }

    /// A change of voxels that is about to be followed left the probe where it was, or pushed
    /// it along voxels that were free before.
    pub fn before_change(&mut self, from: &Proxy, to: &Proxy) -> Result<(), Violation> {
        self.push(from, to)?;
        let distance = ((to.point() - from.point()) * self.constants.spacing).length();
        self.path_past_objects(from.point(), distance, [from, to])
    }

    /// A push among the world's voxels as they are.
    fn push(&mut self, from: &Proxy, to: &Proxy) -> Result<(), Violation> {
        let ends = [from.voxel(), to.voxel()];
        let Constants {
            spacing, radius, ..
        } = self.constants;
        let Self { dense, finder, .. } = self;
        let has_path = from == to
            || finder.has_path(dense, ends, PUSH, |cell| {
                is_free(dense, cell, spacing, radius)
            });
        hold(has_path, Guarantee::CrossesNoWall, || {
            format!("pushed from {} to {}", ends[0], ends[1])
        })
    }

    /// Follows voxels of a box: what is touched, and what was wanted where nothing is held.
    pub fn follow(
        &mut self,
        changed: &VoxelBox,
        touched: impl Fn(IVec3) -> bool,
        wanted: Option<&Dense>,
    ) -> Result<(), Violation> {
        self.blocked.forget();
        for voxel in changed.voxels() {
            let solid = touched(voxel);
            self.dense.set(voxel, solid);
            let arrived = wanted.is_none_or(|wanted| wanted.is_solid(voxel) == solid);
            hold(arrived, Guarantee::ChangesArrive, || format!("{voxel}"))?;
        }
        Ok(())
    }

    /// After all changes before a tick.
    pub fn after_changes(&self, proxy: &Proxy) -> Result<(), Violation> {
        self.where_it_is(proxy)
    }

    /// After a tick that led the proxy toward the device [grid].
    pub fn after_tick(
        &mut self,
        device: DVec3,
        [from, to]: [&Proxy; 2],
        output: &TickOutput,
    ) -> Result<(), Violation> {
        self.where_it_is(to)?;
        self.way(device, from, to)?;
        let distance = ((from.point() - device) * self.constants.spacing).length();
        self.path_past_objects(device, distance, [from, to])?;
        self.work(output)
    }

    /// Guarantee 1, and that the point is in the voxel that it is said to be in.
    fn where_it_is(&self, proxy: &Proxy) -> Result<(), Violation> {
        let Constants {
            spacing, radius, ..
        } = self.constants;
        let point = proxy.point();
        let voxel = point.floor().as_ivec3();
        let body_is_free = !self.dense.is_solid(voxel)
            && (radius == 0.0 || !self.dense.is_near(point, point, spacing, radius));
        hold(
            voxel == proxy.voxel() && body_is_free,
            Guarantee::StaysOut,
            || format!("the probe is at {point}, voxel {}", proxy.voxel()),
        )?;
        for (number, object) in self.objects.iter().enumerate() {
            let own = object.to_own(point);
            let overlaps = object.dense.is_solid(own.floor().as_ivec3())
                || radius > 0.0 && object.dense.is_near(own, own, object.spacing, radius);
            hold(!overlaps, Guarantee::StaysOut, || {
                format!("the probe is at {point}, in object {number} at {own}")
            })?;
        }
        Ok(())
    }

    /// Guarantee 2: no wall that stands for good was crossed, and a way through free voxels
    /// leads there, nowhere farther from the device than a tick's own moves can be.
    fn way(&mut self, device: DVec3, from: &Proxy, to: &Proxy) -> Result<(), Violation> {
        let ends = [from.voxel(), to.voxel()];
        if ends[0] == ends[1] {
            return Ok(());
        }
        let told = || format!("from {} to {}", ends[0], ends[1]);
        let part = |voxel: IVec3| self.dense.index(voxel).map(|index| self.parts[index]);
        hold(
            part(ends[0]) == part(ends[1]),
            Guarantee::CrossesNoWall,
            told,
        )?;
        let Constants {
            spacing, radius, ..
        } = self.constants;
        let distance = |point: DVec3| ((point - device) * spacing).length();
        let farthest = distance(from.point()) + WINDOW * self.widest();
        let Self {
            dense,
            finder,
            blocked,
            ..
        } = self;
        blocked.fit(dense);
        let mut free = |cell| blocked.is_free(dense, cell, spacing, radius);
        let has_near_path = finder.has_path(dense, ends, NEAR, &mut free);
        let has_path = has_near_path
            || finder.has_path(dense, ends, EVERYWHERE, |cell| {
                distance(cell.as_dvec3() + 0.5) <= farthest && free(cell)
            });
        hold(has_path, Guarantee::CrossesNoWall, told)
    }

    /// Guarantee 2 in the grid of each object, for a way that keeps within a distance [mm] of
    /// a point of the world.
    fn path_past_objects(
        &mut self,
        middle: DVec3,
        distance: f64,
        [from, to]: [&Proxy; 2],
    ) -> Result<(), Violation> {
        let reach = distance + WINDOW * self.widest();
        let radius = self.constants.radius;
        let Self {
            objects, finder, ..
        } = self;
        for (number, object) in objects.iter().enumerate() {
            let ends = [from, to].map(|proxy| object.to_own(proxy.point()));
            let middle = object.to_own(middle);
            path_past(object, ends, (middle, reach), (finder, radius))
                .map_err(|violation| violation.of_object(number))?;
        }
        Ok(())
    }

    /// An object moved by one step, as a rigid motion tells, and may have pushed the probe.
    pub fn after_pose(
        &mut self,
        number: usize,
        rigid: &DAffine3,
        [from, to]: [&Proxy; 2],
    ) -> Result<(), Violation> {
        // past all that stands still, and past the object that moved
        let old = self.objects[number].clone();
        self.objects[number].set_pose(rigid);
        let new = &self.objects[number];
        let ends = [old.to_own(from.point()), new.to_own(to.point())];
        let reach = ((ends[1] - ends[0]) * new.spacing).length() + WINDOW * self.widest();
        let radius = self.constants.radius;
        path_past(new, ends, (ends[0], reach), (&mut self.finder, radius))
            .map_err(|violation| violation.of_object(number))?;
        if from != to {
            let moved = std::mem::replace(&mut self.objects[number], Object::nowhere());
            let distance = ((to.point() - from.point()) * self.constants.spacing).length();
            let past_others = self.path_past_objects(from.point(), distance, [from, to]);
            self.objects[number] = moved;
            past_others?;
            self.push(from, to)?;
        }
        self.where_it_is(to)
    }

    /// The diagonal of the widest voxel [mm].
    fn widest(&self) -> f64 {
        let objects = self.objects.iter().map(|object| object.spacing.length());
        objects.fold(self.constants.spacing.length(), f64::max)
    }

    /// Guarantee 3.
    fn work(&self, output: &TickOutput) -> Result<(), Violation> {
        hold(
            output.visits <= self.constants.visit_bound,
            Guarantee::BoundedWork,
            || format!("{} voxels visited", output.visits),
        )?;
        hold(!output.violation, Guarantee::StaysOut, || {
            "the model says so itself".to_owned()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{DEVICE, constants, output, proxy};
    use super::*;

    fn checker() -> Checker {
        let wall = Dense::from_fn(IVec3::splat(16), |voxel| voxel.x == 8);
        Checker::new(constants(), wall.clone(), &wall, Vec::new())
    }

    /// What a tick breaks that leads the proxy from one x to another.
    fn broken(from: f64, to: f64, output: TickOutput) -> Option<Guarantee> {
        let ends = [&proxy(from), &proxy(to)];
        let found = checker().after_tick(DEVICE, ends, &output);
        found.err().map(|violation| violation.guarantee)
    }

    #[test]
    fn each_promise_of_a_tick_is_asked_for() {
        let good = output(-1.0);
        assert_eq!(broken(6.5, 7.5, good), None);
        assert_eq!(broken(7.5, 8.5, good), Some(Guarantee::StaysOut));
        assert_eq!(broken(7.5, 9.5, good), Some(Guarantee::CrossesNoWall));
        assert_eq!(broken(7.5, 17.5, good), Some(Guarantee::CrossesNoWall));
        let works = TickOutput {
            visits: 101,
            ..good
        };
        assert_eq!(broken(7.5, 7.5, works), Some(Guarantee::BoundedWork));
        let admits = TickOutput {
            violation: true,
            ..good
        };
        assert_eq!(broken(7.5, 7.5, admits), Some(Guarantee::StaysOut));
    }

    #[test]
    fn a_ball_that_overlaps_and_a_push_through_a_wall_are_found() {
        let mut checker = checker();
        checker.constants.radius = 2.0;
        assert!(checker.after_changes(&proxy(5.9)).is_ok());
        assert!(checker.after_changes(&proxy(6.1)).is_err());
        checker.constants.radius = 0.0;
        assert!(checker.before_change(&proxy(7.5), &proxy(5.5)).is_ok());
        assert!(checker.before_change(&proxy(7.5), &proxy(9.5)).is_err());
    }

    #[test]
    fn a_change_that_does_not_arrive_is_found() {
        let mut checker = checker();
        let hole = VoxelBox::of_voxel(IVec3::new(8, 4, 4));
        let mut wanted = checker.dense.clone();
        wanted.set(hole.min, false);
        assert!(checker.follow(&hole, |_| true, None).is_ok());
        assert!(checker.follow(&hole, |_| true, Some(&wanted)).is_err());
        assert!(checker.follow(&hole, |_| false, Some(&wanted)).is_ok());
        assert!(!checker.dense.is_solid(hole.min));
    }
}
