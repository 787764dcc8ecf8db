//! A needle whose direction is set: the line that it goes in on, and pushes that are too far off it.

use glam::{DMat3, DVec3, UVec3};
use palpate_haptics::needle::approach::{Approach, unit};
use palpate_haptics::needle::events::EventKind::{Punctured, Stopped, Withdrawn};
use palpate_haptics::needle::tissues::{Layered, NeedleScan, Tissues, World};
use palpate_haptics::needle::track::Line;
use palpate_volume::grid::Grid;
use palpate_volume::tissue::Tissue;

use crate::needle::{AT, BONE, Bench, Body, COUPLING, FAT, Felt, LIVER, SKIN};

/// A fiftieth of a voxel of 1 mm, by which the tool may go over in a tick besides the hand's way.
const STEP: f64 = 0.02;

fn aimed(direction: DVec3) -> Bench {
    let mut bench = Bench::new();
    bench.needle.aim(Some(direction));
    bench.last = AT;
    bench
}

/// No force grows by more than the coupling over the hand's way and what the law lets go over.
fn assert_no_jump(way: &[Felt], speed: f64) {
    for two in way.windows(2) {
        let grown = two[1].force.length() - two[0].force.length();
        let most = COUPLING.stiffness * (speed * 1e-3 + STEP) + 1e-9;
        assert!(grown <= most, "{grown} {:?}", two[1]);
    }
}

#[test]
fn the_needle_goes_in_along_the_direction_that_is_set_through_the_touched_point() {
    let direction = DVec3::new(0.5, -0.2, 1.0).normalize();
    let mut bench = aimed(direction * 7.0);
    let way = bench.go(AT.with_z(18.0), 10.0);
    let line = bench.needle.insertion().expect("it is in").line;
    assert!((line.direction - direction).length() < 1e-12, "{line:?}");
    // the skin was touched straight below
    assert!((line.entry - AT.with_z(10.0)).length() < 1e-9, "{line:?}");
    assert_no_jump(&way, 10.0);

    // what is punctured at the force along the needle: more of the push is needed
    let events = bench.needle.events().since(0);
    let skin = events.into_iter().next().expect("a puncture");
    assert!(
        (skin.force - Tissue::SKIN.puncture).abs() < 0.02,
        "{skin:?}"
    );
    let most = way
        .iter()
        .map(|felt| felt.force.length())
        .fold(0.0, f64::max);
    assert!(
        (most - Tissue::SKIN.puncture / direction.z).abs() < 0.02,
        "{most}"
    );

    // layers are as long as they are along the line, down to the bone and out again
    let down = bench.go(line.at(70.0), 20.0);
    let out = bench.go(line.at(-5.0), 20.0);
    assert_no_jump(&down, 20.0);
    assert_no_jump(&out, 20.0);
    assert_eq!(
        bench.events(),
        [
            (Punctured, SKIN),
            (Punctured, FAT),
            (Punctured, LIVER),
            (Stopped, BONE),
            (Withdrawn, 0)
        ]
    );
    let wall = 50.0 / direction.z;
    for felt in &down {
        assert!(felt.tip.is_none_or(|tip| tip <= wall), "{felt:?} {wall}");
    }
}

#[test]
fn a_push_beyond_the_sticking_angle_off_the_direction_only_presses() {
    // 63.4 degrees are the cone of friction 2
    for (degrees, goes_in) in [
        (62.5_f64, true),
        (64.0, false),
        (90.0, false),
        (180.0, false),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut bench = aimed(DVec3::new(sin, 0.0, cos));
        let way = bench.go(AT.with_z(45.0), 10.0);
        assert_eq!(!bench.needle.punctured().is_empty(), goes_in, "{degrees}");
        assert_no_jump(&way, 10.0);
        for felt in &way {
            assert!(felt.force.is_finite() && felt.force.length() <= 35.0);
        }
    }
}

#[test]
fn a_direction_that_is_set_while_the_needle_presses_lets_the_force_fall_and_nothing_jump() {
    let mut bench = aimed(DVec3::X);
    let pressed = bench.go(AT.with_z(25.0), 20.0);
    assert!(bench.needle.insertion().is_none());
    let before = pressed.last().expect("ticks").force.length();
    assert!(before > 2.0 * Tissue::SKIN.puncture, "{before}");
    bench.needle.aim(Some(DVec3::new(0.4, 0.0, 1.0)));
    let mut way = vec![*pressed.last().expect("ticks")];
    way.extend((0..500).map(|_| bench.tick(bench.last)));
    assert!(bench.needle.insertion().is_some());
    assert_no_jump(&way, 0.0);
    assert!(way.last().expect("ticks").force.length() < before);
}

#[test]
fn a_needle_that_is_in_stays_on_its_line_when_another_direction_is_set() {
    let mut bench = aimed(DVec3::Z);
    bench.go(AT.with_z(30.0), 10.0);
    let before = bench.needle.insertion().expect("it is in").line;
    bench.needle.aim(Some(DVec3::X));
    bench.go(AT.with_z(40.0), 10.0);
    assert_eq!(bench.needle.insertion().expect("it is in").line, before);
    bench.go(AT, 20.0);
    assert!(bench.needle.insertion().is_none());
    // the next one is along the new one: too far off this push
    bench.go(AT.with_z(30.0), 10.0);
    assert!(bench.needle.insertion().is_none());
    bench.needle.aim(None);
    bench.tick(bench.last);
    let line = bench.needle.insertion().expect("it is in").line;
    assert!((line.direction - DVec3::Z).length() < 1e-12);
}

#[test]
fn what_is_no_direction_is_none() {
    for nonsense in [
        DVec3::ZERO,
        DVec3::NAN,
        DVec3::INFINITY,
        DVec3::X * f64::MAX,
    ] {
        assert_eq!(unit(nonsense), None);
    }
    assert_eq!(unit(DVec3::Z * 1e-3), Some(DVec3::Z));
}

#[test]
fn a_direction_that_leads_out_of_what_is_touched_is_no_way_in() {
    let tissues = Tissues::of([(SKIN, Tissue::SKIN)]);
    let map = Body {
        open: false,
        edit: None,
    };
    let grid = Grid::new(
        UVec3::splat(80),
        DVec3::ONE,
        DVec3::splat(0.5),
        DMat3::IDENTITY,
    );
    let grid = grid.expect("a grid");
    let world = World {
        scan: NeedleScan {
            grid: &grid,
            map: &map,
        },
        tissues: &tissues,
    };
    // pushed nearly along the surface, within the cone around either direction
    let push = Line {
        entry: AT.with_z(10.0),
        direction: DVec3::new(1.0, 0.0, 0.3).normalize(),
    };
    let way_in = |direction: DVec3| {
        let approach = Approach {
            push,
            set: unit(direction),
        };
        assert!(approach.share() > 0.8);
        approach.way_in((0, Layered::of(0)), 1.0, &world).is_some()
    };
    assert!(way_in(DVec3::new(1.0, 0.0, 0.2)));
    assert!(!way_in(DVec3::new(1.0, 0.0, -0.2)));
}
