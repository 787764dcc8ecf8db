//! The walk against brute force: every voxel box is cut with the move on its own.

use crate::support::Random;
use glam::{DVec3, IVec3};
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::walk::{COORDINATE_LIMIT, Walk};

/// Rounding of fractions and of cutting a box; moves here are at most some 20 voxels long.
const ROUNDING: f64 = 1e-12;

struct Visit {
    voxel: IVec3,
    fraction: f64,
    exit_fraction: f64,
}

fn visits(start: DVec3, end: DVec3) -> Vec<Visit> {
    let mut walk = Walk::new(start, end).expect("a finite move");
    let mut visits = Vec::new();
    loop {
        visits.push(Visit {
            voxel: walk.voxel(),
            fraction: walk.fraction(),
            exit_fraction: walk.exit_fraction(),
        });
        if !walk.advance() {
            return visits;
        }
    }
}

fn chain(start: DVec3, end: DVec3) -> Vec<IVec3> {
    visits(start, end).iter().map(|visit| visit.voxel).collect()
}

/// Share of the move inside a closed voxel box, from plane to plane of each axis.
fn inside(voxel: IVec3, start: DVec3, end: DVec3) -> (f64, f64) {
    let (low, high) = (voxel.as_dvec3(), voxel.as_dvec3() + 1.0);
    let (mut enter, mut exit) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let delta = end[axis] - start[axis];
        if delta == 0.0 {
            if start[axis] < low[axis] || start[axis] > high[axis] {
                return (1.0, 0.0);
            }
            continue;
        }
        let planes = [low[axis], high[axis]].map(|plane| (plane - start[axis]) / delta);
        enter = enter.max(planes[0].min(planes[1]));
        exit = exit.min(planes[0].max(planes[1]));
    }
    (enter, exit)
}

/// Random moves, and moves between points on planes, edges and corners.
fn moves() -> impl Iterator<Item = (DVec3, DVec3)> {
    let mut random = Random::new(1);
    (0..20_000).map(move |number| match number % 3 {
        0 => (random.point(-6.0, 6.0), random.point(-6.0, 6.0)),
        1 => (random.lattice_point(-4, 4), random.lattice_point(-4, 4)),
        _ => {
            let start = random.lattice_point(-4, 4);
            (start, start + random.point(-1.0, 1.0))
        }
    })
}

#[test]
fn a_walk_starts_and_ends_in_the_voxels_of_its_points() {
    for (start, end) in moves() {
        let chain = chain(start, end);
        assert_eq!(chain[0], start.floor().as_ivec3(), "{start} {end}");
        assert_eq!(
            chain[chain.len() - 1],
            end.floor().as_ivec3(),
            "{start} {end}"
        );
    }
}

/// With as few steps as lie between the ends, it never turns back either.
#[test]
fn a_walk_goes_from_face_to_face_without_detour() {
    for (start, end) in moves() {
        let chain = chain(start, end);
        for pair in chain.windows(2) {
            assert_eq!((pair[1] - pair[0]).abs().element_sum(), 1, "{start} {end}");
        }
        let apart = (chain[chain.len() - 1] - chain[0]).abs().element_sum();
        assert_eq!(chain.len() as i32, apart + 1, "{start} {end}");
    }
}

#[test]
fn a_walk_visits_every_voxel_that_the_move_cuts_and_no_other() {
    for (start, end) in moves() {
        let chain = chain(start, end);
        let around = VoxelBox::of_voxel(start.floor().as_ivec3())
            .union(&VoxelBox::of_voxel(end.floor().as_ivec3()))
            .dilate(1);
        for voxel in around.voxels() {
            let (enter, exit) = inside(voxel, start, end);
            let visited = chain.contains(&voxel);
            if exit - enter > ROUNDING {
                // a move within a plane belongs to the voxels above it
                let middle = start.lerp(end, (enter + exit) / 2.0);
                let on_plane = (middle - middle.round())
                    .abs()
                    .cmplt(DVec3::splat(ROUNDING));
                let owner = DVec3::select(on_plane, middle.round(), middle.floor());
                if owner.as_ivec3() == voxel {
                    assert!(visited, "{voxel} missed by {start} {end}");
                }
            }
            if visited {
                assert!(exit - enter > -ROUNDING, "{voxel} not on {start} {end}");
            }
        }
    }
}

#[test]
fn fractions_are_those_of_the_planes_and_never_fall() {
    for (start, end) in moves() {
        let mut before = 0.0;
        for visit in visits(start, end) {
            let (enter, exit) = inside(visit.voxel, start, end);
            let case = format!("{start} {end} {}", visit.voxel);
            assert!((0.0..=1.0).contains(&visit.fraction), "{case}");
            assert!(visit.fraction >= before, "{case}");
            assert!((visit.fraction - enter).abs() <= ROUNDING, "{case}");
            assert!((visit.exit_fraction - exit).abs() <= ROUNDING, "{case}");
            before = visit.fraction;
        }
    }
}

#[test]
fn the_face_looks_back_to_the_voxel_before() {
    for (start, end) in moves() {
        let mut walk = Walk::new(start, end).expect("a finite move");
        let mut before = walk.voxel();
        while walk.advance() {
            assert_eq!(walk.voxel() + walk.face().normal(), before);
            before = walk.voxel();
        }
    }
}

#[test]
fn a_point_on_a_plane_belongs_to_the_voxel_above() {
    let at = |x: f64| DVec3::new(x, 0.5, 0.5);
    let along_x = |start: f64, end: f64| {
        let visits = visits(at(start), at(end));
        visits
            .iter()
            .map(|visit| (visit.voxel.x, visit.fraction))
            .collect::<Vec<_>>()
    };
    // down from a plane: the voxel above is left at once
    assert_eq!(along_x(3.0, 2.5), [(3, 0.0), (2, 0.0)]);
    // down onto a plane: stays above
    assert_eq!(along_x(3.5, 3.0), [(3, 0.0)]);
    // up onto a plane: enters at the very end
    assert_eq!(along_x(2.5, 3.0), [(2, 0.0), (3, 1.0)]);
    // up from a plane
    assert_eq!(along_x(3.0, 3.5), [(3, 0.0)]);
    // the same below zero
    assert_eq!(along_x(-2.0, -2.5), [(-2, 0.0), (-3, 0.0)]);
    assert_eq!(along_x(-2.5, -2.0), [(-3, 0.0), (-2, 1.0)]);
}

#[test]
fn through_a_corner_x_is_stepped_before_y_before_z() {
    let up = chain(DVec3::splat(0.5), DVec3::splat(1.5));
    let expected = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]];
    assert_eq!(up, expected.map(IVec3::from_array));

    let down = chain(DVec3::splat(1.5), DVec3::splat(0.5));
    let expected = [[1, 1, 1], [0, 1, 1], [0, 0, 1], [0, 0, 0]];
    assert_eq!(down, expected.map(IVec3::from_array));
}

#[test]
fn no_move_is_one_voxel() {
    for point in [DVec3::ZERO, DVec3::splat(-0.0), DVec3::new(3.0, -2.5, 1e6)] {
        assert_eq!(chain(point, point), [point.floor().as_ivec3()]);
    }
}

/// A plane met at once by the shortest move there is: 0 times infinity must not come up.
#[test]
fn the_shortest_moves_cross_a_plane() {
    for length in [5e-324, 1e-320, 1e-308, 1e-300, 1e-20] {
        let visits = visits(DVec3::ZERO, DVec3::new(-length, 0.0, 0.0));
        let seen = visits.iter().map(|visit| (visit.voxel.x, visit.fraction));
        assert_eq!(seen.collect::<Vec<_>>(), [(0, 0.0), (-1, 0.0)], "{length}");
    }
}

/// Minus zero is a plane like any other, although its sign says otherwise.
#[test]
fn minus_zero_is_zero() {
    for (start, end) in [(-0.0, -1.5), (-0.0, 1.5), (0.5, -0.0), (-0.5, -0.0)] {
        let at = |x: f64| DVec3::new(x, 0.25, 0.25);
        let seen = |start: f64, end: f64| {
            let visits = visits(at(start), at(end));
            let seen = visits.iter().map(|visit| (visit.voxel, visit.fraction));
            seen.collect::<Vec<_>>()
        };
        assert_eq!(seen(start, end), seen(start + 0.0, end + 0.0));
    }
}

/// Eighths and whole numbers add without rounding, so nothing may differ.
#[test]
fn a_move_by_whole_voxels_moves_the_chain() {
    let mut random = Random::new(3);
    for _ in 0..2_000 {
        let (start, end) = (random.lattice_point(-9, 9), random.lattice_point(-9, 9));
        let by = random.voxel(-1_000_000, 1_000_000);
        let far = chain(start + by.as_dvec3(), end + by.as_dvec3());
        let near = chain(start, end).into_iter().map(|voxel| voxel + by);
        assert_eq!(far, near.collect::<Vec<_>>(), "{start} {end} {by}");
    }
}

#[test]
fn a_long_move_arrives() {
    let (start, end) = (
        DVec3::new(-5_000.3, 0.7, 12.9),
        DVec3::new(7_000.1, 4_000.2, -9_000.5),
    );
    let chain = chain(start, end);
    assert_eq!(chain.len(), 1 + 12_001 + 4_000 + 9_013);
    assert_eq!(chain.last(), Some(&end.floor().as_ivec3()));
}

#[test]
fn only_finite_points_within_the_limit_are_walked() {
    let refused = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e300,
        -1.01 * COORDINATE_LIMIT,
    ];
    for bad in refused {
        for axis in 0..3 {
            let mut point = DVec3::ONE;
            point[axis] = bad;
            assert!(Walk::new(point, DVec3::ONE).is_none(), "{point}");
            assert!(Walk::new(DVec3::ONE, point).is_none(), "{point}");
        }
    }
    let corner = DVec3::splat(COORDINATE_LIMIT);
    let walk = Walk::new(corner, -corner).expect("the limit itself is allowed");
    assert_eq!(walk.steps_left(), 3 * 2 * COORDINATE_LIMIT as u32);
}
