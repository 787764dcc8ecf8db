//! What the adder fills, and where it waits for the probe's body.

use crate::support::{centre, distance_to_way, free_move, oblique_grid, scan, straight_grid};
use glam::{DVec3, UVec3};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::tool::{Tool, ToolInput};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::voxels::Voxels;

fn adder(grid: &Grid, radius: f64) -> Box<dyn Tool> {
    let settings = ToolSettings::new(ToolKind::Adder, radius, vec![SegmentId(1), SegmentId(2)]);
    settings.build(grid).expect("a tool")
}

fn nothing(_: glam::IVec3) -> bool {
    false
}

fn pass(tool: &mut dyn Tool, voxels: &mut Voxels, input: &ToolInput) {
    if let Some(edit) = tool.advance(voxels, input).expect("they exist") {
        voxels.apply(edit).expect("it fits");
    }
}

/// Distance of the nearest solid voxel's box from a point [mm], in a straight grid.
fn nearest_solid(voxels: &Voxels, point: DVec3) -> f64 {
    let grid = voxels.grid();
    let half = grid.spacing() / 2.0;
    let segment = voxels.segment(SegmentId(1)).expect("it exists");
    grid.bounds()
        .voxels()
        .filter(|&voxel| segment.contains(voxel))
        .map(|voxel| {
            ((centre(grid, voxel) - point).abs() - half)
                .max(DVec3::ZERO)
                .length()
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn no_voxel_is_filled_that_the_body_touches_or_would_touch_after_a_move_like_the_last() {
    let grid = straight_grid(UVec3::splat(48), 0.5);
    for (body_radius, speed) in [(0.0, 0.1), (0.0, 1.5), (2.0, 0.3), (4.0, 1.0)] {
        let mut voxels = scan(grid, |_| 0, &[&nothing, &nothing]);
        let mut tool = adder(&grid, 3.0);
        let mut from = DVec3::new(4.0, 12.0, 12.0);
        while from.x < 20.0 {
            let to = from + DVec3::new(speed, 0.1, -0.05);
            let input = ToolInput {
                body_radius: Some(body_radius),
                ..free_move(from, to)
            };
            pass(tool.as_mut(), &mut voxels, &input);
            for next in [to, to + (to - from)] {
                let gap = nearest_solid(&voxels, next);
                assert!(gap > body_radius, "{gap} mm to a body of {body_radius} mm");
            }
            from = to;
        }
        assert!(voxels.segment(SegmentId(2)).expect("it exists").count() > 0);
    }
}

#[test]
fn matter_grows_behind_the_probe_until_the_whole_sweep_is_filled() {
    let grid = oblique_grid(UVec3::new(70, 60, 40));
    let mut voxels = scan(grid, |_| 0, &[&nothing, &nothing]);
    let radius = 2.0;
    let mut tool = adder(&grid, radius);
    let at = |x: f64| {
        let in_grid = DVec3::new(x, 25.0, 18.0);
        grid.patient_from_grid().transform_point3(in_grid)
    };
    // 0.7 mm a voxel: drawn from 10 to 30, then away without the button: far enough to be gone
    let ways: Vec<f64> = (0..=100).map(|step| 10.0 + 0.2 * f64::from(step)).collect();
    for way in ways.windows(2) {
        let input = ToolInput {
            body_radius: Some(1.0),
            ..free_move(at(way[0]), at(way[1]))
        };
        pass(tool.as_mut(), &mut voxels, &input);
    }
    let segment = voxels.segment(SegmentId(1)).expect("it exists");
    // clearance: body, two diagonals of 2.75 mm, one move
    let clear = 1.0 + 2.0 * grid.spacing().length() + 0.2;
    let (mut filled, mut left) = (0, 0);
    for voxel in grid.bounds().voxels() {
        let centre = centre(&grid, voxel);
        let swept = distance_to_way(at(10.0), at(30.0), centre) < radius;
        if swept && centre.distance(at(30.0)) > clear {
            assert!(segment.contains(voxel), "{voxel} was left out");
            filled += 1;
        } else if segment.contains(voxel) {
            left += 1;
        }
    }
    assert!(filled > 50, "{filled}");
    assert_eq!(
        left, 0,
        "filled where nothing was swept or where the body is"
    );
    let volume = filled as f64 * grid.voxel_volume();
    // a sum of products beside a product
    assert!((tool.report().volume - volume).abs() < 1e-6 * volume);
}

#[test]
fn what_the_body_stands_in_at_release_stays_free() {
    let grid = straight_grid(UVec3::splat(40), 0.5);
    let mut voxels = scan(grid, |_| 0, &[&nothing, &nothing]);
    let mut tool = adder(&grid, 1.0);
    let here = DVec3::splat(10.0);
    pass(tool.as_mut(), &mut voxels, &free_move(here, here));
    assert_eq!(voxels.segment(SegmentId(1)).expect("it exists").count(), 0);
    tool.release();

    let away = DVec3::splat(16.0);
    pass(tool.as_mut(), &mut voxels, &free_move(away, away));
    assert_eq!(voxels.segment(SegmentId(1)).expect("it exists").count(), 0);
}

#[test]
fn a_segment_that_is_no_obstacle_is_filled_at_once() {
    let grid = straight_grid(UVec3::splat(40), 0.5);
    let mut voxels = scan(grid, |_| 0, &[&nothing, &nothing]);
    let mut tool = adder(&grid, 1.0);
    let here = DVec3::splat(10.0);
    let input = ToolInput {
        body_radius: None,
        ..free_move(here, here)
    };
    pass(tool.as_mut(), &mut voxels, &input);
    let near = |voxel: &glam::IVec3| centre(&grid, *voxel).distance(here) <= 1.0;
    let expected = grid.bounds().voxels().filter(near).count() as u64;
    for id in [1, 2].map(SegmentId) {
        assert_eq!(voxels.segment(id).expect("it exists").count(), expected);
    }
}
