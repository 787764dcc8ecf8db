//! Whatever is changed, by whatever door, the probe stays out of all that is solid, crosses no wall,
//! and is never pulled: random voxels, switches, moves, radii, undo and redo under a random hand.
//!
//! Who checks has voxels of his own and asks each of them. Frame: scene; its voxels are cubes of 1 mm.

use crate::brute_force::{Parts, leaves_free, overlaps};
use crate::common::*;
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_bench::stress::dense::{Dense, Finder};
use palpate_engine::scene::Properties;
use palpate_engine::servo::TickRecord;
use palpate_engine::touch::Settings;
use palpate_haptics::smooth::Smoothing;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const EDGE: i32 = 24;
const BOX: IVec3 = IVec3::splat(EDGE);
const DIMENSIONS: UVec3 = UVec3::splat(EDGE as u32);
const MIDDLE: DVec3 = DVec3::splat(EDGE as f64 / 2.0);
/// Places of the segments: two of noise that are edited, and a shell that is moved.
const EDITED: u64 = 2;
const SHELL: usize = 2;
const TICKS: u64 = 4_000;
/// Voxels that a tick may ask for, whatever there is: the whole box and half of it again is more than
/// any tick of these needs, and far less than a search without end.
const MOST_VISITS: u32 = 20_000;

/// What the doors were told of one segment, as far as undo takes it back.
#[derive(Clone, PartialEq)]
struct Observation {
    solid: Dense,
    pose: Option<DAffine3>,
}

/// A room with a thin wall through it, which stay as they are, and what is changed in there.
struct World {
    rig: Rig,
    room: Dense,
    rooms: Parts,
    inside_shell: Parts,
    ids: Vec<SegmentId>,
    told: Vec<Observation>,
    touchable: [bool; 3],
    done: Vec<Vec<Observation>>,
    undone: Vec<Vec<Observation>>,
}

/// What is touched between two ticks, and where the probe is.
struct Moment {
    proxy: DVec3,
    command: u64,
    /// Whether touch does not follow all that it was told.
    waits: bool,
    /// All but the shell.
    solid: Dense,
    radius: f64,
    /// Where the shell stands, if it is touched.
    shell: Option<DAffine3>,
}

/// How often what the test is about has happened.
#[derive(Debug, Default)]
struct Seen {
    contacts: u32,
    held: u32,
    pushed: u32,
    grown_in_contact: u32,
    carried: u32,
}

#[test]
fn whatever_is_changed_by_whatever_door_every_guarantee_holds() {
    let mut visited = Seen::default();
    for seed in 0..8 {
        run(seed, &mut visited);
    }
    // the test means something
    assert!(visited.contacts > 10_000, "{visited:?}");
    assert!(visited.held > 500 && visited.pushed > 100, "{visited:?}");
    assert!(
        visited.grown_in_contact > 50 && visited.carried > 20,
        "{visited:?}"
    );
}

#[test]
fn the_slow_way_sees_balls_in_voxels_and_what_walls_part() {
    let wall = |hole: bool| {
        Dense::from_fn(IVec3::splat(8), |voxel| {
            voxel.x == 4 && !(hole && voxel.y == 7)
        })
    };
    let [closed, open] = [false, true].map(wall);
    let before = DVec3::new(3.0, 2.5, 2.5);
    assert!(!overlaps(&closed, before, 1.0) && overlaps(&closed, before, 1.01));
    assert!(overlaps(&closed, DVec3::new(4.5, 2.5, 2.5), 0.0));
    let cell = IVec3::new(2, 2, 2);
    assert!(leaves_free(&closed, cell, 1.0) && !leaves_free(&closed, cell, 1.01));

    let ends = [cell, IVec3::new(6, 2, 2)];
    let has_path = |volume: &Dense, radius| {
        Finder::default().has_path(volume, ends, 8, |cell| leaves_free(volume, cell, radius))
    };
    assert!(has_path(&open, 0.0) && !has_path(&open, 0.5) && !has_path(&closed, 0.0));

    // beside the wall one can go around it
    let closed_box = Dense::from_fn(IVec3::splat(8), |voxel| {
        voxel.min_element() == 0 || voxel.max_element() == 7
    });
    let side = |volume: &Dense, x| Parts::beside(volume).of(DVec3::new(x, 2.5, 2.5));
    assert_eq!(side(&closed, 2.5), side(&closed, 6.5));
    assert_ne!(side(&closed_box, 2.5), side(&closed_box, -2.5));
}

fn run(seed: u128, visited: &mut Seen) {
    let mut random = Random::new(seed);
    let mut world = World::new(&mut random);
    let mut device = MIDDLE;
    let first = world.rig.tick_at(device);
    let mut before = world.moment(&first, None);
    for tick in 0..TICKS {
        if tick % 7 == 0 {
            world.change_something(&mut random);
        }
        let reach = if random.below(10) == 0 { 20.0 } else { 0.4 };
        device += random.point(-reach, reach);
        device = device.clamp(DVec3::splat(-4.0), DVec3::splat(f64::from(EDGE) + 4.0));
        let record = world.rig.tick_at(device);
        let after = world.moment(&record, Some(&before));
        let place = format!("seed {seed}, tick {tick}");
        world.check(&[&before, &after], &record, &place);
        world.note(&[&before, &after], &record, visited);
        before = after;
    }
    world.comes_to_rest(device, seed);
    world.follows_all_in_the_end(device);
}

impl World {
    fn new(random: &mut Random) -> Self {
        let normal = random.point(-1.0, 1.0).normalize();
        let mut rig = Rig::new(DIMENSIONS, MIDDLE + 4.0 * normal);
        let room = room(normal);
        let shell = shell();
        let noise = |random: &mut Random| {
            let share = random.between(0.02, 0.3);
            Dense::from_fn(BOX, |_| random.share() < share)
        };
        let told = |solid, pose| Observation { solid, pose };
        // a body of its own from the start: one that was moved once stays that
        let place = Some(DAffine3::IDENTITY);
        let inside_shell = Parts::beside(&shell);
        let told = vec![
            told(noise(random), None),
            told(noise(random), None),
            told(shell, place),
        ];
        let mut add = |solid: &Dense, pose| {
            let segment = Segment::from_fn(DIMENSIONS, |voxel| solid.is_solid(voxel));
            let properties = Properties { pose, ..OBSTACLE };
            let id = rig.simulation.add_segment(segment, properties, false);
            rig.ticks(ARRIVED, MIDDLE + 4.0 * normal);
            id.unwrap()
        };
        add(&room, None);
        let ids = told
            .iter()
            .map(|told| add(&told.solid, told.pose))
            .collect();
        Self {
            rig,
            rooms: Parts::beside(&room),
            room,
            inside_shell,
            ids,
            told,
            touchable: [true; 3],
            done: Vec::new(),
            undone: Vec::new(),
        }
    }

    fn change_something(&mut self, random: &mut Random) {
        let edited = random.below(EDITED) as usize;
        let is_solid = random.below(2) == 0;
        match random.below(16) {
            0..=4 => self.fill(edited, random.voxel_box(DIMENSIONS, 8), is_solid),
            5..=6 => self.fill(edited, random.voxel_box(DIMENSIONS, 1), is_solid),
            7..=8 => self.switch(random.below(EDITED + 1) as usize, is_solid),
            9..=10 => self.move_shell(random),
            11..=12 => self.undo(),
            13 => self.redo(),
            _ => self.set_probe(random),
        }
    }

    fn fill(&mut self, place: usize, region: VoxelBox, solid: bool) {
        let id = self.ids[place];
        self.rig.simulation.fill_box(id, &region, solid).unwrap();
        self.report(|told| {
            for voxel in region.voxels() {
                told[place].solid.set(voxel, solid);
            }
        });
    }

    /// No step of undo.
    fn switch(&mut self, place: usize, on: bool) {
        let id = self.ids[place];
        self.rig.simulation.set_touchable(id, on).unwrap();
        self.touchable[place] = on;
    }

    fn move_shell(&mut self, random: &mut Random) {
        let turn = DMat3::from_axis_angle(
            random.point(-1.0, 1.0).normalize(),
            random.between(0.0, 2.0),
        );
        let pose =
            DAffine3::from_mat3_translation(turn, MIDDLE - turn * MIDDLE + random.point(-7.0, 7.0));
        let id = self.ids[SHELL];
        self.rig.simulation.move_segment(id, pose).unwrap();
        self.report(|told| told[SHELL].pose = Some(pose));
    }

    fn undo(&mut self) {
        let last = self.done.pop();
        assert_eq!(self.rig.simulation.undo().unwrap(), last.is_some());
        if let Some(last) = last {
            self.undone.push(std::mem::replace(&mut self.told, last));
        }
    }

    fn redo(&mut self) {
        let next = self.undone.pop();
        assert_eq!(self.rig.simulation.redo().unwrap(), next.is_some());
        if let Some(next) = next {
            self.done.push(std::mem::replace(&mut self.told, next));
        }
    }

    /// Another radius and another feel, without friction: a force that drags may pull.
    fn set_probe(&mut self, random: &mut Random) {
        let is_ball = random.below(3) > 0;
        let probe_radius = if is_ball {
            random.between(0.1, 3.0)
        } else {
            0.0
        };
        let settings = Settings {
            probe_radius,
            stiffness: random.between(0.1, 0.9),
            damping: random.between(0.0, 0.01),
            smoothing: Smoothing::ALL[random.below(3) as usize],
            ..Settings::default()
        };
        self.rig.simulation.set_settings(settings).unwrap();
    }

    /// Notes a change as a step of undo, where it is one.
    fn report(&mut self, change: impl FnOnce(&mut [Observation])) {
        let before = self.told.clone();
        change(&mut self.told);
        if before != self.told {
            self.done.push(before);
            self.undone.clear();
        }
    }

    /// A pass of the simulation after a tick, and what is touched by then: what was touched before it,
    /// where no change was told and none waited.
    fn moment(&mut self, record: &TickRecord, before: Option<&Moment>) -> Moment {
        self.rig.simulation.step();
        let status = *self.rig.status.read();
        let as_before = before.filter(|last| !last.waits && last.command == record.command);
        let solid = as_before.map_or_else(|| self.touched(), |last| last.solid.clone());
        let waits = status.pending > 0;
        if !waits && as_before.is_none() {
            assert!(
                solid == self.wanted(),
                "touch is not what the doors were told"
            );
        }
        let shell = self.rig.simulation.segments()[1 + SHELL];
        // one that stops on its way waits as well, and is touched where it stands
        let was_touched = before.is_some_and(|last| last.shell.is_some());
        let is_touched = shell.touchable && (was_touched || !shell.pending);
        let mut poses = status.poses.iter().flatten();
        let pose = poses.find(|(id, _)| *id == shell.id.0);
        Moment {
            proxy: record.proxy,
            command: record.command,
            waits,
            solid,
            radius: status.probe_radius,
            shell: pose.filter(|_| is_touched).map(|(_, pose)| *pose),
        }
    }

    fn touched(&self) -> Dense {
        let bits = self.rig.servo.solid();
        Dense::from_fn(BOX, |voxel| bits.is_solid(voxel))
    }

    /// What is to be solid where nothing waits: the room, and all that is touchable and was not moved.
    fn wanted(&self) -> Dense {
        let stands = |(told, on): &(&Observation, bool)| *on && told.pose.is_none();
        let standing: Vec<_> = self
            .told
            .iter()
            .zip(self.touchable)
            .filter(stands)
            .collect();
        Dense::from_fn(BOX, |voxel| {
            self.room.is_solid(voxel) || standing.iter().any(|(told, _)| told.solid.is_solid(voxel))
        })
    }

    fn check(&self, [before, after]: &[&Moment; 2], record: &TickRecord, place: &str) {
        let ball = (after.proxy, after.radius);
        assert!(
            !overlaps(&after.solid, ball.0, ball.1),
            "{place}: in the world, {ball:?}"
        );
        if let Some(pose) = after.shell {
            let own = pose.inverse().transform_point3(ball.0);
            let solid = &self.told[SHELL].solid;
            assert!(
                !overlaps(solid, own, ball.1),
                "{place}: in the shell, {ball:?}"
            );
        }

        let rooms = [before, after].map(|moment| self.rooms.of(moment.proxy));
        assert_eq!(rooms[0], rooms[1], "{place}: through the wall");
        assert!(
            has_path(before, after),
            "{place}: no way from {} to {}",
            before.proxy,
            after.proxy
        );
        if let (Some(old), Some(new)) = (before.shell, after.shell) {
            let side = |pose: DAffine3, proxy| {
                self.inside_shell.of(pose.inverse().transform_point3(proxy))
            };
            let sides = [side(old, before.proxy), side(new, after.proxy)];
            assert_eq!(sides[0], sides[1], "{place}: through the shell");
        }

        let force = record.force;
        // rounding of a spring of 0.9 N/mm whose ends are some 30 mm from the origin
        let pull = force.dot(record.device - record.proxy);
        assert!(
            force.is_finite() && pull <= 1e-12,
            "{place}: pulled, {record:?}"
        );
        assert!(
            record.contact || force == DVec3::ZERO,
            "{place}: {record:?}"
        );
        assert_eq!(self.rig.violations(), 0, "{place}: touch says so itself");
        assert!(
            record.visits <= MOST_VISITS,
            "{place}: {} visits",
            record.visits
        );
    }

    fn note(&mut self, [before, after]: &[&Moment; 2], record: &TickRecord, visited: &mut Seen) {
        let touched = self.rig.status.read().touched;
        visited.contacts += u32::from(record.contact);
        visited.held += u32::from(after.waits);
        visited.pushed += u32::from(overlaps(&after.solid, before.proxy, after.radius));
        visited.grown_in_contact += u32::from(record.contact && after.radius > before.radius);
        visited.carried += u32::from(before.shell != after.shell && touched == self.ids[SHELL].0);
    }

    /// With hand, scene and simulation at rest.
    fn comes_to_rest(&mut self, device: DVec3, seed: u128) {
        let rest = self.rig.ticks(400, device);
        for _ in 0..50 {
            let record = self.rig.ticks(1, device);
            let same = (record.proxy, record.force) == (rest.proxy, rest.force);
            assert!(same, "seed {seed}: {rest:?}, {record:?}");
        }
    }

    /// With all switched off that surrounds a probe that is a point, nothing is left that waits.
    fn follows_all_in_the_end(&mut self, device: DVec3) {
        self.rig
            .simulation
            .set_settings(Settings::default())
            .unwrap();
        for place in 0..self.ids.len() {
            self.switch(place, false);
        }
        let last = self.rig.ticks(ARRIVED, device);
        let last = self.moment(&last, None);
        assert!(!last.waits && last.radius == 0.0 && last.solid == self.room);
    }
}

/// Whether cells that the ball may be in, before the tick or after it, lead from where the probe was
/// to where it is: what changes in the tick pushes it through what was free.
fn has_path(before: &Moment, after: &Moment) -> bool {
    let ends = [before, after].map(|moment| moment.proxy.floor().as_ivec3());
    let radius = before.radius.min(after.radius);
    ends[0] == ends[1]
        || Finder::default().has_path(&before.solid, ends, EDGE, |cell| {
            leaves_free(&before.solid, cell, radius) || leaves_free(&after.solid, cell, radius)
        })
}

/// A closed border, and through the middle the thinnest wall that no way through faces crosses.
fn room(normal: DVec3) -> Dense {
    let half = normal.abs().max_element() / 2.0;
    Dense::from_fn(BOX, |voxel| {
        let is_border = [voxel.min_element(), EDGE - 1 - voxel.max_element()].contains(&0);
        let offset = normal.dot(voxel.as_dvec3() + 0.5 - MIDDLE);
        is_border || -half <= offset && offset < half
    })
}

/// A hollow ball, as thin as voxels allow.
fn shell() -> Dense {
    let inside = |voxel: IVec3| (voxel.as_dvec3() + 0.5).distance(MIDDLE) < 4.5;
    Dense::from_fn(BOX, |voxel| {
        let faces = IVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        inside(voxel) && faces.into_iter().any(|face| !inside(voxel + face))
    })
}
