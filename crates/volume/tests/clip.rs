//! What a clip leaves of voxels, against every voxel asked by its centre in the scene.

use std::sync::Arc;

use crate::support::{DIMENSIONS, Random};
use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3, UVec3};
use palpate_volume::bits::Bits;
use palpate_volume::clip::{Clip, ClipError, MAX_CLIP_PLANES, Plane};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

fn rotation(random: &mut Random) -> DQuat {
    DQuat::from_scaled_axis(random.point(-2.0, 2.0))
}

/// An oblique scan of voxels that are no cubes.
fn grid_of(dimensions: UVec3, random: &mut Random) -> Grid {
    let direction = DMat3::from_quat(rotation(random));
    let origin = random.point(-50.0, 50.0);
    Grid::new(dimensions, DVec3::new(0.7, 0.9, 2.5), origin, direction).expect("a grid")
}

/// A plane through a point of a grid that stands at a pose.
fn plane_in(grid: &Grid, pose: DAffine3, random: &mut Random) -> Plane {
    let place = grid.dimensions().as_dvec3() * random.point(0.0, 1.0);
    let point = (pose * grid.patient_from_grid()).transform_point3(place);
    let normal = rotation(random) * DVec3::X;
    Plane {
        normal,
        offset: normal.dot(point),
    }
}

fn is_cut(planes: &[Plane], point: DVec3) -> bool {
    planes
        .iter()
        .any(|plane| plane.normal.dot(point) > plane.offset)
}

#[test]
fn what_is_left_is_every_voxel_whose_centre_lies_behind_all_planes_wherever_a_grid_stands() {
    let mut random = Random::new(31);
    let (mut cut, mut left) = (0, 0);
    for round in 0..120 {
        let dimensions = DIMENSIONS[round % DIMENSIONS.len()];
        let grid = grid_of(dimensions, &mut random);
        let pose = match round % 3 {
            0 => DAffine3::IDENTITY,
            _ => DAffine3::from_rotation_translation(
                rotation(&mut random),
                random.point(-20.0, 20.0),
            ),
        };
        let planes: Vec<_> = (0..random.integer(0, 4))
            .map(|_| plane_in(&grid, pose, &mut random))
            .collect();
        let mask = Clip::new(planes.clone()).unwrap().mask(&grid, pose);
        let segment = Segment::from_mask(dimensions, &random.mask(dimensions)).unwrap();
        let bits = mask.left_of_bits(segment.occupancy());
        let scene_from_grid = pose * grid.patient_from_grid();
        for voxel in VoxelBox::of_dimensions(dimensions).voxels() {
            let centre = scene_from_grid.transform_point3(voxel.as_dvec3() + 0.5);
            let is_left = segment.contains(voxel) && !is_cut(&planes, centre);
            assert_eq!(bits.is_solid(voxel), is_left, "{voxel} in round {round}");
            left += u32::from(is_left);
            cut += u32::from(segment.contains(voxel) && !is_left);
        }
    }
    assert!(cut > 40_000 && left > 40_000, "{cut} {left}");
}

/// Faces of a clip box stand between voxels or through their middles, where rounding could decide.
#[test]
fn planes_along_the_grid_cut_bricks_as_they_cut_voxels() {
    let dimensions = UVec3::new(25, 17, 33);
    let grid = Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).unwrap();
    let full = Segment::from_fn(dimensions, |_| true);
    for half_voxels in 0..40 {
        for (axis, sign) in [DVec3::X, DVec3::Y, DVec3::Z]
            .into_iter()
            .flat_map(|axis| [(axis, 1.0), (axis, -1.0)])
        {
            let plane = Plane {
                normal: sign * axis,
                offset: sign * 0.5 * f64::from(half_voxels),
            };
            let mask = Clip::new(vec![plane])
                .unwrap()
                .mask(&grid, DAffine3::IDENTITY);
            let left = mask.left_of_bits(full.occupancy());
            for voxel in grid.bounds().voxels() {
                assert_eq!(left.is_solid(voxel), !mask.cuts(voxel), "{voxel} {plane:?}");
            }
        }
    }
}

#[test]
fn bricks_that_no_plane_meets_are_shared_and_edits_are_followed_in_theirs_alone() {
    let dimensions = UVec3::splat(40);
    let grid = Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).unwrap();
    let odd = |voxel: IVec3| voxel.element_sum() % 2 != 0;
    let before = Segment::from_fn(dimensions, odd);
    let plane = Plane {
        normal: DVec3::X,
        offset: 20.0,
    };
    let mask = Clip::new(vec![plane])
        .unwrap()
        .mask(&grid, DAffine3::IDENTITY);
    let mut left = mask.left_of_bits(before.occupancy());
    let shared = |left: &Bits| {
        let pairs = left
            .bricks()
            .entries()
            .iter()
            .zip(before.occupancy().bricks().entries());
        let same = pairs.filter(|(a, b)| matches!((a, b), (Some(a), Some(b)) if Arc::ptr_eq(a, b)));
        same.count()
    };
    // two of five layers of bricks lie behind the plane, which voxel 20 has its centre in
    assert_eq!(shared(&left), 2 * 25);

    let edited = Segment::from_fn(dimensions, |voxel| odd(voxel) || voxel.y < 8);
    let row: Vec<u32> = (0..5).collect();
    mask.follow(&mut left, edited.occupancy(), &row);
    for voxel in grid.bounds().voxels() {
        let source = if voxel.y < 8 && voxel.z < 8 {
            &edited
        } else {
            &before
        };
        let is_left = source.contains(voxel) && voxel.x <= 20;
        assert_eq!(left.is_solid(voxel), is_left, "{voxel}");
    }
}

#[test]
fn planes_that_are_no_clip_are_refused() {
    let plane = |normal, offset| Plane { normal, offset };
    let many = vec![plane(DVec3::X, 0.0); MAX_CLIP_PLANES + 1];
    assert_eq!(
        Clip::new(many),
        Err(ClipError::TooMany(MAX_CLIP_PLANES + 1))
    );
    for wrong in [
        plane(DVec3::ZERO, 0.0),
        plane(2.0 * DVec3::X, 0.0),
        plane(DVec3::NAN, 0.0),
        plane(DVec3::X, f64::INFINITY),
    ] {
        assert!(Clip::new(vec![wrong]).is_err(), "{wrong:?}");
    }
    assert!(Clip::new(Vec::new()).unwrap().is_empty());
}
