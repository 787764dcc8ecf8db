//! Friction sticks, slips and never drives.

use crate::support::{Body, Random, grid, noise};
use glam::{DAffine3, DQuat, DVec3, IVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::force::{Friction, FrictionError, FrictionState, MAX_FRICTION};
use palpate_haptics::scene::TouchScene;
use palpate_volume::occupancy::Occupancy;

/// Stiffness of the spring [N/mm].
const K: f64 = 1.0;
/// Way over which coefficients change [mm]: one voxel.
const H: f64 = 1.0;

const DRY: Friction = Friction {
    stick: 0.5,
    slip: 0.3,
};

/// A surface that a target is led to: the contact point, or none without contact.
trait Touched {
    fn contact(&mut self, target: DVec3) -> Option<DVec3>;
}

/// The half space z < 0.
struct Floor;
impl Touched for Floor {
    fn contact(&mut self, target: DVec3) -> Option<DVec3> {
        (target.z < 0.0).then(|| target.with_z(0.0))
    }
}

/// A ball of radius 20 mm around zero.
struct Ball;
impl Touched for Ball {
    fn contact(&mut self, target: DVec3) -> Option<DVec3> {
        (target.length() < 20.0).then(|| target.normalize() * 20.0)
    }
}

/// Voxels of 1 mm under the model `exact`.
struct Voxels<'a, O> {
    solid: &'a O,
    proxy: Proxy,
}
impl<O: Occupancy> Touched for Voxels<'_, O> {
    fn contact(&mut self, target: DVec3) -> Option<DVec3> {
        let grid = grid(UVec3::splat(64), DVec3::ONE);
        let contact = Exact::default().advance(
            &TouchScene::of_world(self.solid, &grid),
            target,
            &mut self.proxy,
        );
        assert!(!self.solid.is_solid(self.proxy.voxel()));
        contact.touching.then(|| self.proxy.point())
    }
}

/// A hand that rubs a surface.
struct Rub<S> {
    surface: S,
    friction: Friction,
    state: FrictionState,
    device: DVec3,
    force: DVec3,
    target: DVec3,
}

impl<S: Touched> Rub<S> {
    fn new(surface: S, friction: Friction, device: DVec3) -> Self {
        let mut rub = Self {
            surface,
            friction,
            state: FrictionState::default(),
            device,
            force: DVec3::ZERO,
            target: device,
        };
        rub.to(device);
        rub
    }

    /// Moves the hand; gives the work done on it [N·mm], by the rule that is exact for springs.
    fn to(&mut self, device: DVec3) -> f64 {
        self.target = self.friction.target(device, H, &mut self.state);
        let mut contact = self.surface.contact(self.target);
        if contact.is_none() && self.target != device {
            contact = self.surface.contact(device);
        }
        self.state.remember(&self.friction, self.target, contact);
        let force = contact.map_or(DVec3::ZERO, |point| (point - device) * K);
        let work = 0.5 * (force + self.force).dot(device - self.device);
        self.force = force;
        self.device = device;
        work
    }

    /// In a straight line, 0.01 mm per tick.
    fn line_to(&mut self, end: DVec3) -> f64 {
        let start = self.device;
        let steps = (start.distance(end) / 0.01).ceil().max(1.0) as usize;
        (1..=steps)
            .map(|step| self.to(start.lerp(end, step as f64 / steps as f64)))
            .sum()
    }
}

#[test]
fn inside_the_static_cone_the_probe_does_not_move_at_all() {
    let mut rub = Rub::new(Floor, DRY, DVec3::new(0.0, 0.0, 1.0));
    rub.line_to(DVec3::new(0.0, 0.0, -2.0));
    // the rim lies at 0.5 · 2 mm
    for (x, y) in [(0.9, 0.0), (0.0, -0.99), (-0.6, 0.7), (0.0, 0.0)] {
        rub.line_to(DVec3::new(x, y, -2.0));
        // rounding of some hundred steps
        assert!(rub.target.truncate().length() < 1e-13, "{}", rub.target);
        let spring = DVec3::new(-x, -y, 2.0);
        assert!((rub.force - spring).length() < 1e-13);
        assert!(!rub.state.is_slipping());
    }
}

#[test]
fn outside_it_the_probe_follows_at_the_rim_of_the_kinetic_cone() {
    let mut rub = Rub::new(Floor, DRY, DVec3::new(0.0, 0.0, 1.0));
    rub.line_to(DVec3::new(0.0, 0.0, -2.0));
    rub.line_to(DVec3::new(10.0, 0.0, -2.0));
    assert!(rub.state.is_slipping());
    // the normal force is 2 N
    assert!((rub.force - DVec3::new(-0.6, 0.0, 2.0)).length() < 1e-12);
    // a hand that turns around is held by the static cone before the probe turns too
    rub.line_to(DVec3::new(9.0, 0.0, -2.0));
    assert!(!rub.state.is_slipping());
    // it stood 0.6 mm behind, and is 0.4 mm ahead after 1 mm
    assert!((rub.force.x - 0.4).abs() < 1e-12, "{}", rub.force);
    rub.line_to(DVec3::new(0.0, 0.0, -2.0));
    assert!((rub.force - DVec3::new(0.6, 0.0, 2.0)).length() < 1e-12);
}

#[test]
fn the_fall_from_static_to_kinetic_is_spread_over_the_way_of_the_hand() {
    let mut rub = Rub::new(Floor, DRY, DVec3::new(0.0, 0.0, 1.0));
    rub.line_to(DVec3::new(0.0, 0.0, -2.0));
    let mut largest = 0.0_f64;
    let mut steepest = 0.0_f64;
    for step in 1..=300 {
        let before = rub.force;
        rub.to(DVec3::new(0.01 * f64::from(step), 0.0, -2.0));
        largest = largest.max(-rub.force.x);
        steepest = steepest.max((rub.force - before).length());
    }
    // the rim of the static cone is reached to within a step, the kinetic one is kept
    assert!((0.98..=1.0 + 1e-12).contains(&largest), "{largest}");
    assert!((rub.force.x + 0.6).abs() < 1e-12);
    // no tick changes the force by more than its way of 0.01 mm does
    assert!(steepest <= 0.01 * K + 1e-12, "{steepest}");
}

#[test]
fn without_contact_the_anchor_is_forgotten() {
    let mut rub = Rub::new(Floor, DRY, DVec3::new(0.0, 0.0, 1.0));
    rub.line_to(DVec3::new(0.0, 0.0, -2.0));
    rub.line_to(DVec3::new(0.9, 0.0, -2.0));
    rub.line_to(DVec3::new(0.9, 0.0, 0.5));
    assert_eq!(
        (rub.force, rub.state),
        (DVec3::ZERO, FrictionState::default())
    );
    // it sticks where it touches anew, not where it stuck before
    rub.line_to(DVec3::new(0.9, 0.0, -1.0));
    assert!((rub.force - DVec3::Z).length() < 1e-13);
}

#[test]
fn with_no_friction_the_target_is_the_device() {
    let mut rub = Rub::new(Floor, Friction::NONE, DVec3::new(0.0, 0.0, 1.0));
    let mut random = Random::new(5);
    for _ in 0..10_000 {
        rub.to(random.point(-3.0, 3.0));
        assert_eq!(rub.target, rub.device);
    }
}

/// A closed path of the hand: a sum of waves that comes back to where it began.
fn closed_path(random: &mut Random, middle: DVec3, reach: f64, steps: usize) -> Vec<DVec3> {
    let waves: Vec<(f64, DVec3, f64)> = (1..=6)
        .map(|wave| {
            let turns = f64::from(wave);
            let phase = random.between(0.0, std::f64::consts::TAU);
            (turns, random.direction() * reach / turns, phase)
        })
        .collect();
    (0..=steps)
        .map(|step| {
            let angle = std::f64::consts::TAU * step as f64 / steps as f64;
            let wave =
                |(turns, size, phase): &(f64, DVec3, f64)| *size * (turns * angle + phase).sin();
            middle + waves.iter().map(wave).sum::<DVec3>()
        })
        .collect()
}

/// The work on the hand over a closed path that begins and ends outside [N·mm], and the work
/// that went either way.
fn work_of<S: Touched>(
    surface: S,
    friction: Friction,
    path: &[DVec3],
    outside: DVec3,
) -> (f64, f64) {
    let mut rub = Rub::new(surface, friction, outside);
    let mut done = 0.0;
    let mut both_ways = 0.0;
    for point in path.iter().chain([&outside]) {
        let work = if point.distance(rub.device) > 0.5 {
            rub.line_to(*point)
        } else {
            rub.to(*point)
        };
        done += work;
        both_ways += work.abs();
    }
    (done, both_ways)
}

#[test]
fn no_closed_path_over_a_floor_gives_the_hand_energy() {
    let mut random = Random::new(11);
    let mut lost = 0.0;
    for _ in 0..300 {
        let stick = random.between(0.0, MAX_FRICTION);
        let friction = Friction {
            stick,
            slip: random.between(0.0, stick),
        };
        let middle = DVec3::new(0.0, 0.0, random.between(-3.0, 0.5));
        let path = closed_path(&mut random, middle, 3.0, 2000);
        let (done, both_ways) = work_of(Floor, friction, &path, DVec3::new(0.0, 0.0, 9.0));
        // rounding, and the steps in which the surface is crossed, where the rule for the work
        // sees half of ½ k Δ²
        assert!(
            done <= 1e-4 * both_ways,
            "{friction:?}: {done} of {both_ways}"
        );
        lost -= done;
    }
    assert!(lost > 300.0, "friction must take energy: {lost}");
}

#[test]
fn no_closed_path_over_a_ball_gives_the_hand_energy() {
    let mut random = Random::new(12);
    let mut lost = 0.0;
    for _ in 0..300 {
        let stick = random.between(0.1, 1.0);
        let friction = Friction {
            stick,
            slip: random.between(0.0, stick),
        };
        let middle = random.direction() * random.between(16.0, 20.0);
        let path = closed_path(&mut random, middle, 3.0, 2000);
        let outside = middle.normalize() * 30.0;
        let (done, both_ways) = work_of(Ball, friction, &path, outside);
        // the normal is that of the tick before, 0.3° back; the rest as on the floor
        assert!(
            done <= 1e-3 * both_ways,
            "{friction:?}: {done} of {both_ways}"
        );
        lost -= done;
    }
    assert!(lost > 300.0, "friction must take energy: {lost}");
}

#[test]
fn over_a_voxel_ball_friction_gives_no_energy_and_the_probe_stays_outside() {
    let middle = DVec3::splat(32.0);
    let solid = Body(|v: IVec3| (v.as_dvec3() + 0.5).distance(DVec3::splat(32.0)) < 20.0);
    let mut random = Random::new(13);
    for _ in 0..20 {
        let side = random.direction();
        let path = closed_path(&mut random, middle + side * 18.0, 3.0, 4000);
        let outside = middle + side * 30.0;
        let surface = Voxels {
            solid: &solid,
            proxy: Proxy::at(outside).expect("a point"),
        };
        let (done, both_ways) = work_of(surface, DRY, &path, outside);
        // stairs drop the hard proxy by up to a voxel, which the rule for the work cuts in half
        assert!(done <= 0.01 * both_ways, "{done} of {both_ways}");
    }
}

/// Guarantee 4 with friction, and that a hand at rest changes nothing at all.
#[test]
fn a_hand_at_rest_has_a_force_that_is_constant_to_the_bit() {
    let solid = noise(64, 0.3, 4);
    let mut random = Random::new(14);
    let start = DVec3::splat(-2.0);
    let surface = Voxels {
        solid: &solid,
        proxy: Proxy::at(start).expect("a point"),
    };
    let mut rub = Rub::new(surface, DRY, start);
    for _ in 0..200 {
        let goal = random.point(-2.0, 20.0);
        for step in 1..=20 {
            rub.to(rub.device.lerp(goal, f64::from(step) / 20.0));
        }
        // the stated number of ticks, see tests/exact.rs
        let device = rub.device;
        for _ in 0..16 {
            rub.to(device);
        }
        let rested = rub.force.to_array().map(f64::to_bits);
        for _ in 0..50 {
            rub.to(device);
            assert_eq!(rub.force.to_array().map(f64::to_bits), rested);
        }
    }
}

/// The target moves no further than the hand, and by what the rim of the cone moves with it.
#[test]
fn a_step_of_the_hand_changes_the_target_by_little_more_than_itself() {
    let mut random = Random::new(15);
    for friction in [
        DRY,
        Friction {
            stick: 1.0,
            slip: 0.2,
        },
    ] {
        let mut rub = Rub::new(Floor, friction, DVec3::new(0.0, 0.0, 1.0));
        let mut device = DVec3::new(0.0, 0.0, -2.0);
        for _ in 0..100_000 {
            let before = rub.state.offset();
            let step = random.direction() * 0.2 * random.between(0.0, 1.0).powi(3);
            let next = device + step;
            if next.length() < 6.0 {
                device = next;
            }
            let way = rub.device.distance(device);
            rub.to(device);
            if rub.force.z > 0.0 && before != DVec3::ZERO {
                let change = rub.state.offset().distance(before);
                // along the surface by the hand's way, toward it by the slope of the cone, and
                // by the fall from static to kinetic over a voxel at this depth
                let fall = (friction.stick - friction.slip) * rub.force.z;
                let bound = way * (1.0 + friction.stick + fall / H);
                assert!(change <= bound + 1e-12, "{change} {bound}");
            }
        }
    }
}

#[test]
fn the_part_along_the_normal_never_pulls_into_the_body() {
    let mut random = Random::new(16);
    let mut rub = Rub::new(
        Ball,
        Friction {
            stick: 1.0,
            slip: 0.6,
        },
        DVec3::X * 25.0,
    );
    let mut contacts = 0;
    for _ in 0..200_000 {
        let wanted = random.direction() * random.between(15.0, 22.0);
        let step = (wanted - rub.device).clamp_length_max(0.3);
        rub.to(rub.device + step);
        if rub.force != DVec3::ZERO {
            contacts += 1;
            let normal = rub.target.normalize();
            assert!(rub.force.dot(normal) >= 0.0, "{} {normal}", rub.force);
        }
    }
    assert!(contacts > 50_000, "{contacts}");
}

#[test]
fn a_coefficient_that_is_set_lower_lets_go_by_way_not_at_once() {
    let mut rub = Rub::new(Floor, DRY, DVec3::new(0.0, 0.0, 1.0));
    rub.line_to(DVec3::new(0.0, 0.0, -2.0));
    rub.line_to(DVec3::new(0.9, 0.0, -2.0));
    rub.friction = Friction::NONE;
    let device = rub.device;
    rub.to(device);
    assert!((rub.force.x + 0.9).abs() < 1e-12, "at rest nothing changes");
    rub.to(device + DVec3::Y * 0.1);
    assert!((-0.9..=-0.79).contains(&rub.force.x), "{}", rub.force);
    rub.line_to(device + DVec3::Y * 2.0);
    assert!(rub.force.x.abs() < 1e-12, "{}", rub.force);
}

#[test]
fn a_body_that_moves_takes_a_sticking_hand_along() {
    let mut rub = Rub::new(Floor, DRY, DVec3::new(0.0, 0.0, 1.0));
    rub.line_to(DVec3::new(0.0, 0.0, -2.0));
    let device = rub.device;
    // the floor is pulled from under a hand at rest, by half a millimetre in ten ticks
    for _ in 0..10 {
        let moved = DAffine3::from_translation(DVec3::X * 0.05);
        rub.state.carry(&moved);
        rub.to(device);
    }
    assert!((rub.force - DVec3::new(0.5, 0.0, 2.0)).length() < 1e-12);
    // and a turn about the contact changes nothing but directions
    let turn = DAffine3::from_quat(DQuat::from_rotation_z(1.0));
    rub.state.carry(&turn);
    assert!((rub.state.offset().length() - 0.5).abs() < 1e-12);
}

#[test]
fn points_that_are_none_are_passed_on_and_forget_the_anchor() {
    for bad in [f64::NAN, f64::INFINITY] {
        let mut rub = Rub::new(Floor, DRY, DVec3::new(0.0, 0.0, 1.0));
        rub.line_to(DVec3::new(0.0, 0.0, -2.0));
        let target = DRY.target(DVec3::new(0.0, bad, 0.0), H, &mut rub.state);
        assert!(!target.is_finite());
        assert_eq!(rub.state, FrictionState::default());
    }
}

#[test]
fn coefficients_that_are_none_are_refused_by_name() {
    assert_eq!(DRY.check(), Ok(()));
    assert_eq!(Friction::NONE.check(), Ok(()));
    for bad in [f64::NAN, -0.1, 2.1, f64::INFINITY] {
        let friction = Friction {
            stick: bad,
            slip: 0.0,
        };
        assert!(matches!(friction.check(), Err(FrictionError::Static(_))));
    }
    for bad in [f64::NAN, -0.1, 0.6] {
        let error = Friction { slip: bad, ..DRY }.check().expect_err("refused");
        assert!(error.to_string().contains("kinetic"), "{error}");
    }
}
