//! Whether a tick kept its promises, found out the slow way and with voxels of its own.
//!
//! Frames: the world's grid; the scene [mm] where a name says so.

use glam::{DAffine3, DMat3, DVec3, IVec3};
use palpate_haptics::proxy::Proxy;
use palpate_haptics::safety::ForceLimits;
use palpate_haptics::tick::TickOutput;
use palpate_volume::voxel_box::VoxelBox;

use super::dense::{Dense, Finder};
use super::thing::Thing;

/// A promise that can be broken; numbers are those of the design, section 5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guarantee {
    /// The probe's body is in no solid voxel.
    StaysOut = 1,
    /// It goes through free voxels, from face to face.
    CrossesNoWall = 2,
    /// Bounded work; no force without contact.
    BoundedWork = 3,
    /// At rest nothing changes.
    ComesToRest = 4,
    /// What is sent is safe.
    SafeForce = 5,
    /// The force never pulls in.
    NeverPulls = 6,
    /// A change of voxels that is not held back is touched.
    ChangesArrive = 7,
}

/// A promise that was broken.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// Which.
    pub guarantee: Guarantee,
    /// How.
    pub what: String,
}

impl Violation {
    fn of_object(mut self, number: usize) -> Self {
        self.what += &format!(" in the grid of object {number}");
        self
    }
}

/// Makes an `Err` of a violation where something does not hold.
fn hold(holds: bool, guarantee: Guarantee, what: impl FnOnce() -> String) -> Result<(), Violation> {
    if holds {
        return Ok(());
    }
    let what = what();
    Err(Violation { guarantee, what })
}

/// How far beyond the ball around the device a way may lead [voxels]: the window of a slide.
const WINDOW: f64 = 8.0;
/// First the near neighbourhood is searched [voxels].
const NEAR: i32 = 4;
/// How far a change may push the probe [voxels].
const PUSH: i32 = 7;
/// Whole worlds.
const EVERYWHERE: i32 = 1000;

/// What is constant in a run.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// Voxel size [mm].
    pub spacing: DVec3,
    /// Columns are the grid's axes in the scene.
    pub direction: DMat3,
    /// Middle of voxel 0 in the scene [mm].
    pub origin: DVec3,
    /// Radius of the probe [mm].
    pub radius: f64,
    /// Most voxels of a tick.
    pub visit_bound: u32,
    /// What may be sent.
    pub limits: ForceLimits,
    /// Time between ticks [s].
    pub dt: f64,
    /// Whether the force is across the surface only.
    pub frictionless: bool,
}

impl Terms {
    /// A point of the grid in the scene [mm].
    pub fn in_scene(&self, point: DVec3) -> DVec3 {
        self.origin + self.direction * (self.spacing * (point - 0.5))
    }
}

/// The voxels, and what was sent last.
#[derive(Debug)]
pub struct Checker {
    terms: Terms,
    /// What is touched now in the world.
    pub dense: Dense,
    /// The objects.
    things: Vec<Thing>,
    /// Parts of the space that walls which stay as they are leave free.
    parts: Vec<u32>,
    finder: Finder,
    blocked: Blocked,
    sent: DVec3,
}

impl Checker {
    /// A checker of a world, of which `constant` is what no edit changes.
    pub fn new(terms: Terms, dense: Dense, constant: &Dense, things: Vec<Thing>) -> Self {
        Self {
            terms,
            things,
            parts: constant.parts(),
            blocked: Blocked::default(),
            dense,
            finder: Finder::default(),
            sent: DVec3::ZERO,
        }
    }

    /// A change of voxels that is about to be followed left the probe where it was, or pushed
    /// it along voxels that were free before.
    pub fn before_change(&mut self, from: &Proxy, to: &Proxy) -> Result<(), Violation> {
        self.push(from, to)?;
        let distance = ((to.point() - from.point()) * self.terms.spacing).length();
        self.way_past_things(from.point(), distance, [from, to])
    }

    /// A push among the world's voxels as they are.
    fn push(&mut self, from: &Proxy, to: &Proxy) -> Result<(), Violation> {
        let ends = [from.voxel(), to.voxel()];
        let Terms {
            spacing, radius, ..
        } = self.terms;
        let Self { dense, finder, .. } = self;
        let is_way = from == to
            || finder.is_way(dense, ends, PUSH, |cell| {
                is_free(dense, cell, spacing, radius)
            });
        hold(is_way, Guarantee::CrossesNoWall, || {
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
        self.blocked.known.clear();
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
        let distance = ((from.point() - device) * self.terms.spacing).length();
        self.way_past_things(device, distance, [from, to])?;
        self.work(output)?;
        self.pull(device, to, output)
    }

    /// Guarantee 1, and that the point is in the voxel that it is said to be in.
    fn where_it_is(&self, proxy: &Proxy) -> Result<(), Violation> {
        let Terms {
            spacing, radius, ..
        } = self.terms;
        let point = proxy.point();
        let voxel = point.floor().as_ivec3();
        let body_is_free = !self.dense.is_solid(voxel)
            && (radius == 0.0 || !self.dense.is_near(point, point, spacing, radius));
        hold(
            voxel == proxy.voxel() && body_is_free,
            Guarantee::StaysOut,
            || format!("the probe is at {point}, voxel {}", proxy.voxel()),
        )?;
        for (number, thing) in self.things.iter().enumerate() {
            let own = thing.to_own(point);
            let overlaps = thing.dense.is_solid(own.floor().as_ivec3())
                || radius > 0.0 && thing.dense.is_near(own, own, thing.spacing, radius);
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
        let Terms {
            spacing, radius, ..
        } = self.terms;
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
        let is_near_way = finder.is_way(dense, ends, NEAR, &mut free);
        let is_way = is_near_way
            || finder.is_way(dense, ends, EVERYWHERE, |cell| {
                distance(cell.as_dvec3() + 0.5) <= farthest && free(cell)
            });
        hold(is_way, Guarantee::CrossesNoWall, told)
    }

    /// Guarantee 2 in the grid of each object, for a way that keeps within a distance [mm] of
    /// a point of the world.
    fn way_past_things(
        &mut self,
        middle: DVec3,
        distance: f64,
        [from, to]: [&Proxy; 2],
    ) -> Result<(), Violation> {
        let reach = distance + WINDOW * self.widest();
        let radius = self.terms.radius;
        let Self { things, finder, .. } = self;
        for (number, thing) in things.iter().enumerate() {
            let ends = [from, to].map(|proxy| thing.to_own(proxy.point()));
            let middle = thing.to_own(middle);
            way_past(thing, ends, (middle, reach), (finder, radius))
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
        let old = self.things[number].clone();
        self.things[number].set_pose(rigid);
        let new = &self.things[number];
        let ends = [old.to_own(from.point()), new.to_own(to.point())];
        let reach = ((ends[1] - ends[0]) * new.spacing).length() + WINDOW * self.widest();
        let radius = self.terms.radius;
        way_past(new, ends, (ends[0], reach), (&mut self.finder, radius))
            .map_err(|violation| violation.of_object(number))?;
        if from != to {
            let moved = std::mem::replace(&mut self.things[number], Thing::nowhere());
            let distance = ((to.point() - from.point()) * self.terms.spacing).length();
            let past_others = self.way_past_things(from.point(), distance, [from, to]);
            self.things[number] = moved;
            past_others?;
            self.push(from, to)?;
        }
        self.where_it_is(to)
    }

    /// The diagonal of the widest voxel [mm].
    fn widest(&self) -> f64 {
        let things = self.things.iter().map(|thing| thing.spacing.length());
        things.fold(self.terms.spacing.length(), f64::max)
    }

    /// Guarantee 3.
    fn work(&self, output: &TickOutput) -> Result<(), Violation> {
        hold(
            output.visits <= self.terms.visit_bound,
            Guarantee::BoundedWork,
            || format!("{} voxels visited", output.visits),
        )?;
        hold(
            output.contact || output.force == DVec3::ZERO,
            Guarantee::BoundedWork,
            || format!("{} N without contact", output.force),
        )?;
        hold(!output.violation, Guarantee::StaysOut, || {
            "the model says so itself".to_owned()
        })
    }

    /// Guarantee 6.
    fn pull(&self, device: DVec3, proxy: &Proxy, output: &TickOutput) -> Result<(), Violation> {
        if !self.terms.frictionless {
            return Ok(());
        }
        let out = self.terms.in_scene(proxy.point()) - self.terms.in_scene(device);
        let along = output.force.dot(out);
        // rounding of places some 1000 mm from the origin
        hold(
            along >= -1e-9 * output.force.length(),
            Guarantee::NeverPulls,
            || format!("{} N while the probe is {out} mm away", output.force),
        )
    }

    /// Input that is none: nothing moves and nothing is felt.
    pub fn after_nonsense(
        &self,
        [from, to]: [&Proxy; 2],
        output: &TickOutput,
    ) -> Result<(), Violation> {
        hold(
            from == to && output.force == DVec3::ZERO,
            Guarantee::SafeForce,
            || format!("{} N from an input that is none", output.force),
        )
    }

    /// Guarantee 5, of what was wanted and what the safety stage made of it.
    pub fn after_safety(&mut self, wanted: DVec3, sent: DVec3) -> Result<(), Violation> {
        let Terms { limits, dt, .. } = self.terms;
        let last = std::mem::replace(&mut self.sent, sent);
        let told = || format!("wanted {wanted} N, sent {sent} N after {last} N");
        hold(
            wanted.is_finite() && sent.is_finite(),
            Guarantee::SafeForce,
            told,
        )?;
        hold(
            sent.length() <= limits.max_force,
            Guarantee::SafeForce,
            told,
        )?;
        hold(
            sent.dot(wanted) >= -1e-9 * sent.length(),
            Guarantee::SafeForce,
            told,
        )?;
        // what fell is free: any part of the last force, without what points against the wanted
        let along = last.dot(wanted);
        let kept = if along < 0.0 {
            last - wanted * (along / wanted.length_squared())
        } else {
            last
        };
        let square = kept.length_squared();
        let share = if square > 0.0 {
            (sent.dot(kept) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let grown = (sent - kept * share).length();
        // rounding
        hold(
            grown <= limits.max_growth * dt * (1.0 + 1e-9),
            Guarantee::SafeForce,
            told,
        )
    }
}

/// Guarantee 2 in the grid of one object, between two points of it, for a way that keeps within
/// `reach` [mm] of its `middle`.
fn way_past(
    thing: &Thing,
    ends: [DVec3; 2],
    (middle, reach): (DVec3, f64),
    (finder, radius): (&mut Finder, f64),
) -> Result<(), Violation> {
    let ends = ends.map(|point| point.floor().as_ivec3());
    if ends[0] == ends[1] {
        return Ok(());
    }
    let told = || format!("from {} to {}", ends[0], ends[1]);
    let [part, other] = ends.map(|voxel| thing.part(voxel));
    hold(part == other, Guarantee::CrossesNoWall, told)?;
    // near its border a way may lead around outside of it, where nobody looked
    let known = [ends[0], ends[1], middle.floor().as_ivec3()];
    if !known.iter().all(|&voxel| thing.is_inside(voxel, radius)) {
        return Ok(());
    }
    let is_way = finder.is_way(&thing.dense, ends, EVERYWHERE, |cell| {
        let way = (cell.as_dvec3() + 0.5 - middle) * thing.spacing;
        way.length() <= reach && is_free(&thing.dense, cell, thing.spacing, radius)
    });
    hold(is_way, Guarantee::CrossesNoWall, told)
}

/// Whether the middle of the probe may be anywhere in a cell.
fn is_free(dense: &Dense, cell: IVec3, spacing: DVec3, radius: f64) -> bool {
    let low = cell.as_dvec3();
    !dense.is_solid(cell) && (radius == 0.0 || !dense.is_near(low, low + 1.0, spacing, radius))
}

/// Cells that a ball may be in, as far as they were asked for.
#[derive(Debug, Default)]
struct Blocked {
    /// 0 where not asked yet, 1 free, 2 blocked.
    known: Vec<u8>,
}

impl Blocked {
    fn fit(&mut self, dense: &Dense) {
        self.known.resize(dense.bytes().len(), 0);
    }

    fn is_free(&mut self, dense: &Dense, cell: IVec3, spacing: DVec3, radius: f64) -> bool {
        if radius == 0.0 {
            return !dense.is_solid(cell);
        }
        let Some(known) = dense
            .index(cell)
            .and_then(|index| self.known.get_mut(index))
        else {
            return true;
        };
        if *known == 0 {
            *known = if is_free(dense, cell, spacing, radius) {
                1
            } else {
                2
            };
        }
        *known == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_haptics::coupling::Coupling;

    /// A wall at x = 8 and a device in it.
    fn checker() -> Checker {
        let wall = Dense::from_fn(IVec3::splat(16), |voxel| voxel.x == 8);
        let terms = Terms {
            spacing: DVec3::ONE,
            direction: DMat3::IDENTITY,
            origin: DVec3::ZERO,
            radius: 0.0,
            visit_bound: 100,
            limits: ForceLimits {
                max_force: 5.0,
                max_growth: 1000.0,
            },
            dt: 1e-3,
            frictionless: true,
        };
        Checker::new(terms, wall.clone(), &wall, Vec::new())
    }

    const DEVICE: DVec3 = DVec3::new(9.5, 4.5, 4.5);

    fn proxy(x: f64) -> Proxy {
        Proxy::at(DVec3::new(x, 4.5, 4.5)).unwrap()
    }

    fn output(force: f64) -> TickOutput {
        TickOutput {
            proxy_in_scene: DVec3::ZERO,
            contact_point_in_scene: DVec3::ZERO,
            normal: DVec3::ZERO,
            force: DVec3::X * force,
            spring: DVec3::X * force,
            coupling: Coupling::default(),
            sticks: false,
            held_by: None,
            contact: true,
            depth: 0.0,
            visits: 100,
            violation: false,
        }
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
        let pulls = output(1e-6);
        assert_eq!(broken(7.5, 7.5, pulls), Some(Guarantee::NeverPulls));
        let works = TickOutput {
            visits: 101,
            ..good
        };
        assert_eq!(broken(7.5, 7.5, works), Some(Guarantee::BoundedWork));
        let loose = TickOutput {
            contact: false,
            ..good
        };
        assert_eq!(broken(7.5, 7.5, loose), Some(Guarantee::BoundedWork));
        let admits = TickOutput {
            violation: true,
            ..good
        };
        assert_eq!(broken(7.5, 7.5, admits), Some(Guarantee::StaysOut));
    }

    #[test]
    fn each_promise_of_what_is_sent_is_asked_for() {
        // wanted and sent along x, one after the other; whether the last is safe
        let is_safe = |forces: &[(f64, f64)]| {
            let mut checker = checker();
            let mut last = Ok(());
            for &(wanted, sent) in forces {
                last = checker.after_safety(DVec3::X * wanted, DVec3::X * sent);
            }
            last.is_ok()
        };
        assert!(is_safe(&[(0.9, 0.9), (1.8, 1.8), (0.1, 0.1), (-0.9, -0.9)]));
        assert!(is_safe(&[(9.0, 1.0), (9.0, 2.0), (9.0, 3.0), (9.0, 4.0)]));
        // grows too fast, at the start and later, and around zero
        assert!(!is_safe(&[(1.1, 1.1)]));
        assert!(!is_safe(&[(0.9, 0.9), (2.0, 2.0)]));
        assert!(!is_safe(&[(0.9, 0.9), (-1.1, -1.1)]));
        // too large, against what is wanted, not a number
        let ramp = [(9.0, 1.0), (9.0, 2.0), (9.0, 3.0), (9.0, 4.0), (9.0, 4.9)];
        assert!(is_safe(&ramp));
        assert!(!is_safe(&[&ramp[..], &[(9.0, 5.1)]].concat()));
        assert!(!is_safe(&[(0.5, -0.1)]));
        assert!(!is_safe(&[(f64::NAN, 0.0)]));
        assert!(!is_safe(&[(0.0, f64::NAN)]));
    }

    #[test]
    fn a_ball_that_overlaps_and_a_push_through_a_wall_are_found() {
        let mut checker = checker();
        checker.terms.radius = 2.0;
        assert!(checker.after_changes(&proxy(5.9)).is_ok());
        assert!(checker.after_changes(&proxy(6.1)).is_err());
        checker.terms.radius = 0.0;
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
