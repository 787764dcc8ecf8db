//! Which segment is touched, among several in the scan and beside it.

use crate::common::*;
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_engine::touch::{MovedPart, Part, Touchable};
use palpate_haptics::scene::Solid;
use palpate_volume::edit::SegmentId;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::splat(32);

fn part(id: u8, low: i32, high: i32, moved: Option<DVec3>) -> Part {
    let voxels = VoxelBox::new(IVec3::splat(low), IVec3::splat(high));
    Part {
        id: SegmentId(id),
        bits: box_segment(DIMENSIONS, voxels.min, voxels.max)
            .occupancy()
            .clone(),
        moved: moved.map(|by| MovedPart {
            own_grid: None,
            bounds: voxels,
            pose: DAffine3::from_translation(by),
        }),
        threshold: None,
        fractions: None,
        punctured: false,
        rigid: None,
    }
}

/// The owner of the cell that holds a probe back at the end of a line, coming from outside.
fn owner_along_x(touchable: &Touchable, y: i32) -> Option<SegmentId> {
    let mut cells = (-20..52).map(|x| IVec3::new(x, y, y));
    let held_by = cells.find(|cell| touchable.world.is_solid(*cell))?;
    touchable.owner(Solid::of_world(held_by))
}

#[test]
fn of_two_segments_the_one_that_the_probe_rests_against_is_touched() {
    for radius in [0.0, 1.5, 4.0] {
        let parts = vec![part(3, 4, 10, None), part(8, 18, 26, None)];
        let touchable = Touchable::new(&grid(DIMENSIONS), parts, radius).unwrap();
        assert_eq!(owner_along_x(&touchable, 7), Some(SegmentId(3)));
        assert_eq!(owner_along_x(&touchable, 22), Some(SegmentId(8)));
    }
}

#[test]
fn all_of_the_world_belongs_to_the_only_segment_that_was_not_moved() {
    for radius in [0.0, 4.0] {
        let moved = part(8, 18, 26, Some(DVec3::X));
        let parts = vec![part(3, 4, 10, None), moved];
        let touchable = Touchable::new(&grid(DIMENSIONS), parts, radius).unwrap();
        assert_eq!(owner_along_x(&touchable, 7), Some(SegmentId(3)));
        let of_object = Solid {
            body: 1,
            voxel: IVec3::splat(20),
        };
        assert_eq!(touchable.owner(of_object), Some(SegmentId(8)));
        let of_none = Solid {
            body: 2,
            ..of_object
        };
        assert_eq!(touchable.owner(of_none), None);
    }
}

/// A part with a pose stands there at once.
#[test]
fn moved_parts_stand_where_their_pose_has_them() {
    let grid = grid(DIMENSIONS);
    let parts = vec![part(3, 4, 10, Some(DVec3::new(12.0, 0.0, -3.0)))];
    let touchable = Touchable::new(&grid, parts, 0.0).unwrap();
    let scene = touchable.scene(&grid);
    assert!(scene.solid_at(DVec3::new(21.5, 9.5, 1.5)).is_some());
    assert!(scene.solid_at(DVec3::new(9.5, 9.5, 4.5)).is_none());
}

#[test]
fn where_segments_overlap_the_last_is_touched_as_it_is_seen() {
    for radius in [0.0, 1.5] {
        let parts = vec![
            part(3, 4, 20, None),
            part(8, 4, 20, None),
            part(9, 24, 28, None),
        ];
        let touchable = Touchable::new(&grid(DIMENSIONS), parts, radius).unwrap();
        assert_eq!(owner_along_x(&touchable, 12), Some(SegmentId(8)));
    }
}
