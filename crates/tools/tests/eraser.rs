//! What the eraser frees, and that it can be taken back.

use crate::support::{
    Dense, Random, centre, distance_to_way, everywhere, free_move, oblique_grid, scan,
    straight_grid,
};
use glam::{DVec3, IVec3, UVec3};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::stroke::Stroke;
use palpate_tools::tool::{MAX_WAY, Tool, ToolError};
use palpate_volume::edit::{EditKind, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::voxels::VoxelsError;

const DIMENSIONS: UVec3 = UVec3::new(40, 37, 21);

fn eraser(grid: &Grid, radius: f64, segments: &[u8]) -> Box<dyn Tool> {
    let settings = ToolSettings::new(
        ToolKind::Eraser,
        radius,
        segments.iter().copied().map(SegmentId).collect(),
    );
    settings.build(grid).expect("a tool")
}

#[test]
fn a_sweep_frees_just_the_voxels_whose_centre_is_within_the_radius_of_its_way() {
    let mut random = Random::new(1);
    let grid = oblique_grid(DIMENSIONS);
    for _ in 0..60 {
        let mut voxels = scan(grid, |_| 100, &[&everywhere, &everywhere, &everywhere]);
        let before = Dense::of(&voxels);
        let [from, to] = [(); 2].map(|()| random.point(&grid, 6.0));
        let radius = random.number(0.3, 7.0);
        let mut tool = eraser(&grid, radius, &[1, 3]);

        let edit = tool
            .advance(&voxels, &free_move(from, to))
            .expect("they exist");
        let mut changed = 0;
        if let Some(edit) = edit {
            assert_eq!((edit.kind, edit.intensities.len()), (EditKind::Label, 0));
            voxels.apply(edit).expect("it fits");
        }

        let after = Dense::of(&voxels);
        for (place, voxel) in grid.bounds().voxels().enumerate() {
            let distance = distance_to_way(from, to, centre(&grid, voxel));
            // what is the radius away but for rounding is within
            if (distance - radius).abs() < 1e-6 * radius {
                continue;
            }
            let freed = distance < radius;
            changed += u64::from(freed);
            for id in [1, 3] {
                let solid = after.masks[&SegmentId(id)][place] != 0;
                assert_eq!(solid, !freed, "{voxel} {distance} {radius}");
            }
        }
        assert_eq!(after.masks[&SegmentId(2)], before.masks[&SegmentId(2)]);
        assert_eq!(after.stored, before.stored);
        assert_eq!(tool.report().voxels, changed);
    }
}

#[test]
fn a_ball_of_whole_voxels_reaches_as_far_to_all_sides() {
    for side in [0.2, 0.3, 0.35, 0.4, 0.6, 0.7, 0.8, 1.1] {
        let grid = straight_grid(UVec3::splat(11), side);
        for steps in 1..=4 {
            let mut voxels = scan(grid, |_| 0, &[&everywhere]);
            let middle = IVec3::splat(5);
            let point = centre(&grid, middle);
            let edit = eraser(&grid, f64::from(steps) * side, &[1])
                .advance(&voxels, &free_move(point, point))
                .expect("it exists");
            voxels.apply(edit.expect("in it")).expect("it fits");
            let after = voxels.segment(SegmentId(1)).expect("it exists");
            for voxel in grid.bounds().voxels() {
                let freed = (voxel - middle).length_squared() <= steps * steps;
                assert_eq!(after.contains(voxel), !freed, "{voxel} {side} {steps}");
            }
        }
    }
}

#[test]
fn however_fast_the_hand_no_gap_is_left_on_its_way() {
    let grid = oblique_grid(UVec3::new(90, 90, 40));
    for steps in [1, 2, 7, 100] {
        let mut voxels = scan(grid, |_| 0, &[&everywhere]);
        let mut tool = eraser(&grid, 1.5, &[1]);
        let ends = [DVec3::new(3.0, 80.0, 2.0), DVec3::new(85.0, 4.0, 38.0)];
        let [start, end] = ends.map(|end| grid.patient_from_grid().transform_point3(end));
        for step in 0..steps {
            let [from, to] =
                [step, step + 1].map(|step| start.lerp(end, f64::from(step) / f64::from(steps)));
            let edit = tool
                .advance(&voxels, &free_move(from, to))
                .expect("it exists");
            voxels.apply(edit.expect("on its way")).expect("it fits");
        }
        let segment = voxels.segment(SegmentId(1)).expect("it exists");
        // the ball holds at least one centre: its radius is above half a voxel's diagonal
        for sample in 0..5000 {
            let point = start.lerp(end, f64::from(sample) / 4999.0);
            let in_grid = grid.grid_from_patient().transform_point3(point);
            let voxel = grid.voxel_at(in_grid).expect("inside");
            assert!(!segment.contains(voxel), "{steps} steps: {voxel}");
        }
    }
}

#[test]
fn a_stroke_undone_leaves_the_same_bits_and_redone_too() {
    let mut random = Random::new(5);
    let grid = oblique_grid(DIMENSIONS);
    let mut voxels = scan(
        grid,
        |voxel| (voxel.x * voxel.y) as i16,
        &[&|voxel| (voxel.x + voxel.y) % 3 != 0, &everywhere],
    );
    let before = Dense::of(&voxels);
    let mut tool = eraser(&grid, 4.0, &[1, 2]);
    let (mut stroke, mut single) = (Stroke::default(), 0);
    let mut last = random.point(&grid, 0.0);
    for _ in 0..50 {
        let next = random.point(&grid, 0.0);
        if let Some(edit) = tool
            .advance(&voxels, &free_move(last, next))
            .expect("they exist")
        {
            let inverse = voxels.apply(edit).expect("it fits");
            single += inverse
                .segments
                .iter()
                .map(|(_, swaps)| swaps.len())
                .sum::<usize>();
            stroke.add(inverse);
        }
        last = next;
    }
    let after = Dense::of(&voxels);
    assert_ne!(after, before);

    let inverse = stroke.into_inverse();
    let kept: usize = inverse.segments.iter().map(|(_, swaps)| swaps.len()).sum();
    assert!(2 * kept < single, "{kept} of {single} bricks kept");
    let redo = voxels.apply(inverse).expect("it fits");
    assert_eq!(Dense::of(&voxels), before);
    voxels.apply(redo).expect("it fits");
    assert_eq!(Dense::of(&voxels), after);
}

#[test]
fn numbers_that_are_no_place_change_nothing_and_a_jump_only_its_end() {
    let grid = oblique_grid(DIMENSIONS);
    let voxels = scan(grid, |_| 0, &[&everywhere]);
    let inside = grid
        .patient_from_grid()
        .transform_point3(DVec3::splat(10.0));
    let mut tool = eraser(&grid, 2.0, &[1]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (from, to) in [(DVec3::splat(bad), inside), (inside, inside.with_y(bad))] {
            let edit = tool
                .advance(&voxels, &free_move(from, to))
                .expect("it exists");
            assert!(edit.is_none());
        }
    }
    let far = DVec3::splat(1e300);
    assert!(
        tool.advance(&voxels, &free_move(far, far))
            .expect("it exists")
            .is_none()
    );

    let beyond = inside + DVec3::X * (MAX_WAY + 1.0);
    let jump = tool
        .advance(&voxels, &free_move(beyond, inside))
        .expect("it exists");
    let there = tool
        .advance(&voxels, &free_move(inside, inside))
        .expect("it exists");
    let dirty = |edit: Option<palpate_volume::edit::Edit>| edit.expect("inside").dirty;
    assert_eq!(dirty(jump), dirty(there));
}

#[test]
fn a_moved_input_is_the_same_stroke_in_the_other_frame() {
    let [from, to] = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 9.0)];
    let mut input = free_move(from, to);
    input.contact_normal = DVec3::Z;
    let there = input.moved(&crate::support::rigid());
    let back = there.moved(&crate::support::rigid().inverse());
    // rounding of two rigid motions
    assert!(back.from.abs_diff_eq(from, 1e-12) && back.to.abs_diff_eq(to, 1e-12));
    assert!(back.contact_normal.abs_diff_eq(DVec3::Z, 1e-12));
    assert!((there.from.distance(there.to) - from.distance(to)).abs() < 1e-12);
}

#[test]
fn wrong_settings_say_what_is_allowed() {
    let grid = oblique_grid(DIMENSIONS);
    let settings = |radius: f64, segments: Vec<SegmentId>| {
        ToolSettings::new(ToolKind::Eraser, radius, segments)
    };
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 32.0 * 0.7 + 0.1] {
        let error = settings(radius, vec![SegmentId(1)])
            .build(&grid)
            .map(|_| ());
        assert!(matches!(error, Err(ToolError::Radius { .. })), "{radius}");
    }
    let error = settings(1.0, Vec::new()).build(&grid).map(|_| ());
    assert_eq!(error, Err(ToolError::NoSegment));

    let voxels = scan(grid, |_| 0, &[&everywhere]);
    let mut tool = settings(1.0, vec![SegmentId(9)])
        .build(&grid)
        .expect("a tool");
    let inside = grid
        .patient_from_grid()
        .transform_point3(DVec3::splat(10.0));
    let error = tool
        .advance(&voxels, &free_move(inside, inside))
        .map(|_| ());
    assert_eq!(error, Err(VoxelsError::UnknownSegment(9)));
    assert_eq!(ToolKind::from_name("eraser"), Ok(ToolKind::Eraser));
    assert!(ToolKind::from_name("hammer").is_err());
}
