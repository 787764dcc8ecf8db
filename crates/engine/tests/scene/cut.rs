//! Cuts along a line that was painted on the picture.

use crate::common::*;
use glam::{DAffine3, DVec2, DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::scene::{LineCut, MOST_POINTS, Painted};
use palpate_engine::session::{Session, SessionConfig};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;

const DIMENSIONS: UVec3 = UVec3::splat(40);
const ID: SegmentId = SegmentId(1);
/// In front of the middle of the scan, 100 mm away.
const EYE: DVec3 = DVec3::new(20.0, -80.0, 20.0);

/// A line through these places of the plane y = 20, seen from before.
fn painted(places: &[[f64; 2]], closed: bool) -> Painted {
    Painted {
        eye: EYE,
        view: DVec3::Y,
        line: places
            .iter()
            .map(|[x, z]| DVec3::new(*x, 20.0, *z))
            .collect(),
        closed,
    }
}

/// Where a voxel's middle is seen, on the plane y = 20.
fn seen(voxel: IVec3) -> DVec2 {
    let away = voxel.as_dvec3() + 0.5 - EYE;
    let share = 100.0 / away.y;
    DVec2::new(EYE.x + share * away.x, EYE.z + share * away.z)
}

fn block() -> Segment {
    box_segment(DIMENSIONS, IVec3::splat(5), IVec3::splat(35))
}

fn session() -> Session {
    let mut config = SessionConfig::new(grid(DIMENSIONS), intensities(DIMENSIONS), simulated());
    config.segments = vec![(block(), OBSTACLE)];
    config.real_time = false;
    started(config)
}

/// All voxels of both parts, which share none.
fn parts(segment: &Segment, line: &Painted, pose: &DAffine3) -> (Segment, Segment) {
    let cut = LineCut::in_scan(line, pose).unwrap();
    let (larger, smaller) = cut.part(segment, &grid(DIMENSIONS));
    assert!(larger.count() >= smaller.count());
    assert_eq!(larger.count() + smaller.count(), segment.count());
    let both = |voxel: IVec3| larger.contains(voxel) && smaller.contains(voxel);
    assert_eq!(segment.part(both).count(), 0);
    (larger, smaller)
}

#[test]
fn a_straight_line_parts_along_the_rays_that_it_lies_under() {
    let line = painted(&[[14.3, 10.0], [14.3, 30.0]], false);
    let (larger, smaller) = parts(&block(), &line, &DAffine3::IDENTITY);
    for voxel in
        palpate_volume::voxel_box::VoxelBox::new(IVec3::splat(5), IVec3::splat(35)).voxels()
    {
        // above and below its ends too: it goes on straight
        let left = seen(voxel).x < 14.3;
        assert_eq!(smaller.contains(voxel), left, "{voxel}");
        assert_eq!(larger.contains(voxel), !left, "{voxel}");
    }
}

#[test]
fn a_closed_line_cuts_out_what_it_goes_around() {
    let around = [[15.0, 15.0], [25.0, 15.0], [25.0, 25.0], [15.0, 25.0]];
    let (_, smaller) = parts(&block(), &painted(&around, true), &DAffine3::IDENTITY);
    for voxel in
        palpate_volume::voxel_box::VoxelBox::new(IVec3::splat(5), IVec3::splat(35)).voxels()
    {
        let place = seen(voxel);
        let inside = (place - 20.0).abs().max_element() < 5.0;
        assert_eq!(smaller.contains(voxel), inside, "{voxel}");
    }
}

/// The straight way on the picture between two voxels crosses the line, with what it goes on by,
/// an even number of times where they are in one part, and an odd number where they are not.
#[test]
fn two_voxels_are_in_one_part_where_the_way_between_them_crosses_the_line_evenly() {
    let mut random = Random::new(9);
    for round in 0..30 {
        let count = 2 + random.below(12) as usize;
        let places: Vec<[f64; 2]> = (0..count)
            .map(|_| [random.between(2.0, 38.0), random.between(2.0, 38.0)])
            .collect();
        let closed = count > 2 && round % 3 == 0;
        let (_, smaller) = parts(&block(), &painted(&places, closed), &DAffine3::IDENTITY);

        let mut line: Vec<DVec2> = places.iter().map(|place| DVec2::from(*place)).collect();
        if closed {
            line.push(line[0]);
        } else {
            let far = |end: DVec2, before: DVec2| end + (end - before).normalize() * 1e5;
            line.insert(0, far(line[0], line[1]));
            line.push(far(line[line.len() - 1], line[line.len() - 2]));
        }
        let crossings = |from: DVec2, to: DVec2| {
            let cross = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
            let meets = |pair: &&[DVec2]| {
                let (a, b) = (pair[0], pair[1]);
                let apart = cross(from, to, a) * cross(from, to, b) < 0.0;
                apart && cross(a, b, from) * cross(a, b, to) < 0.0
            };
            line.windows(2).filter(meets).count()
        };
        for _ in 0..300 {
            let voxel = || 5;
            let mut any =
                || IVec3::from_array(std::array::from_fn(|_| voxel() + random.below(30) as i32));
            let (one, other) = (any(), any());
            let same = smaller.contains(one) == smaller.contains(other);
            let even = crossings(seen(one), seen(other)) % 2 == 0;
            assert_eq!(same, even, "{round}: {one} {other} {places:?}");
        }
    }
}

#[test]
fn a_moved_segment_is_cut_where_it_is_seen() {
    let pose =
        DAffine3::from_translation(DVec3::new(7.0, 0.0, 0.0)) * DAffine3::from_rotation_y(0.3);
    let line = painted(&[[21.0, 5.0], [23.0, 20.0], [21.5, 35.0]], false);
    let moved = parts(&block(), &line, &pose);
    // the same as if the line were moved back
    let back = pose.inverse();
    let line = Painted {
        eye: back.transform_point3(line.eye),
        view: back.transform_vector3(line.view),
        line: line
            .line
            .iter()
            .map(|point| back.transform_point3(*point))
            .collect(),
        closed: false,
    };
    let unmoved = parts(&block(), &line, &DAffine3::IDENTITY);
    assert_eq!(moved.1.mask(), unmoved.1.mask());
    assert!(moved.1.count() > 0);
}

#[test]
fn a_preview_tells_the_parts_and_a_cut_is_one_step() {
    let session = session();
    let line = painted(&[[14.3, 10.0], [14.3, 30.0]], false);
    let [larger, smaller] = session.preview_cut(ID, &line).unwrap();
    assert_eq!(session.segments().unwrap().len(), 1, "nothing is cut yet");
    let part = session.cut_along(ID, &line).unwrap();
    let volumes: Vec<f64> = session
        .segments()
        .unwrap()
        .iter()
        .map(|one| one.volume)
        .collect();
    assert_eq!(volumes, [larger, smaller]);
    assert_eq!(part, SegmentId(2));
    assert!(session.undo().unwrap());
    assert_eq!(session.segment(ID).unwrap().mask(), block().mask());
    assert!(!session.undo().unwrap());
}

#[test]
fn lines_that_are_none_or_part_nothing_are_refused() {
    let session = session();
    let refused = |line: &Painted| session.cut_along(ID, line).unwrap_err();
    for places in [&[][..], &[[1.0, 1.0]], &[[1.0, 1.0], [1.0, 1.0]]] {
        let error = refused(&painted(places, false));
        assert!(matches!(error, SessionError::PaintedLine { .. }), "{error}");
    }
    let good = painted(&[[14.3, 10.0], [14.3, 30.0]], false);
    let wrong = [
        Painted {
            eye: DVec3::NAN,
            ..good.clone()
        },
        Painted {
            view: DVec3::ZERO,
            ..good.clone()
        },
        // behind the eye
        Painted {
            view: -DVec3::Y,
            ..good.clone()
        },
        Painted {
            line: vec![DVec3::ZERO, DVec3::INFINITY],
            ..good.clone()
        },
        Painted {
            line: vec![DVec3::ONE; MOST_POINTS + 1],
            ..good.clone()
        },
    ];
    for line in &wrong {
        assert!(matches!(refused(line), SessionError::PaintedLine { .. }));
    }
    let beside = painted(&[[100.0, 0.0], [100.0, 40.0]], false);
    assert!(matches!(
        refused(&beside),
        SessionError::LineMisses { id: 1 }
    ));
    let unknown = session.cut_along(SegmentId(9), &good);
    assert!(unknown.is_err());
    assert!(!session.undo().unwrap(), "nothing was changed");
}
