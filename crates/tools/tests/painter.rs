//! What the painter paints, and that what is solid stays so.

use crate::support::{
    Dense, Random, centre, distance_to_way, free_move, oblique_grid, scan, straight_grid,
};
use glam::{DVec3, IVec3, UVec3};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::painter::PaintSettings;
use palpate_tools::stroke::Stroke;
use palpate_tools::tool::{Tool, ToolError, ToolInput};
use palpate_volume::edit::{EditKind, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::voxels::Voxels;

const PAINTED: SegmentId = SegmentId(1);
const FIRST: SegmentId = SegmentId(2);
const SECOND: SegmentId = SegmentId(3);

fn settings(radius: f64, paint: PaintSettings) -> ToolSettings {
    ToolSettings {
        paint,
        ..ToolSettings::new(ToolKind::Painter, radius, vec![PAINTED, FIRST, SECOND])
    }
}

fn painter(grid: &Grid, radius: f64, paint: PaintSettings) -> Box<dyn Tool> {
    settings(radius, paint).build(grid).expect("a tool")
}

fn touching(from: DVec3, to: DVec3, normal: DVec3) -> ToolInput {
    ToolInput {
        contact_normal: normal,
        ..free_move(from, to)
    }
}

fn nothing(_: IVec3) -> bool {
    false
}

/// Applies what a pass changes; whether it changed anything.
fn pass(tool: &mut dyn Tool, voxels: &mut Voxels, input: &ToolInput) -> bool {
    let Some(edit) = tool.advance(voxels, input).expect("they exist") else {
        return false;
    };
    assert_eq!((edit.kind, edit.intensities.len()), (EditKind::Label, 0));
    voxels.apply(edit).expect("it fits");
    true
}

fn has(voxels: &Voxels, id: SegmentId, voxel: IVec3) -> bool {
    voxels.segment(id).expect("it exists").contains(voxel)
}

#[test]
fn solid_voxels_of_a_ball_change_hands_and_no_other() {
    let grid = oblique_grid(UVec3::new(40, 37, 21));
    let mut random = Random::new(5);
    for overlaps in [false, true] {
        for _ in 0..20 {
            let sparse = |voxel: IVec3| (voxel.x * 7 + voxel.y * 5 + voxel.z * 3) % 4 != 0;
            let half = |voxel: IVec3| voxel.x % 3 == 0;
            let mut voxels = scan(grid, |_| 100, &[&nothing, &sparse, &half]);
            let before = Dense::of(&voxels);
            let from = random.point(&grid, 2.0);
            let radius = random.number(1.0, 6.0);
            // less than what counts of a way
            let to = from + DVec3::new(1.0, 0.4, -0.8);
            let normal = DVec3::new(0.3, -1.0, 0.2);
            let paint = PaintSettings {
                depth: None,
                overlaps,
            };
            let mut tool = painter(&grid, radius, paint);
            pass(tool.as_mut(), &mut voxels, &touching(from, from, normal));
            pass(tool.as_mut(), &mut voxels, &touching(from, to, normal));

            let after = Dense::of(&voxels);
            assert_eq!(after.stored, before.stored);
            let mut painted = 0;
            for (place, voxel) in grid.bounds().voxels().enumerate() {
                let distance = distance_to_way(from, to, centre(&grid, voxel));
                if (distance - radius).abs() < 1e-9 {
                    continue;
                }
                let [was, is] = [&before, &after]
                    .map(|dense| [FIRST, SECOND].map(|id| dense.masks[&id][place] != 0));
                let reached = distance < radius && was.contains(&true);
                painted += u64::from(reached);
                assert_eq!(after.masks[&PAINTED][place] != 0, reached, "{voxel}");
                let left = if reached && !overlaps {
                    [false; 2]
                } else {
                    was
                };
                assert_eq!(is, left, "{voxel}");
            }
            assert_eq!(tool.report().voxels, painted);
        }
    }
}

#[test]
fn a_layer_ends_at_its_depth_below_what_the_probe_can_reach() {
    let grid = oblique_grid(UVec3::new(60, 50, 30));
    let middle = grid
        .patient_from_grid()
        .transform_point3(DVec3::new(30.0, 25.0, 15.0));
    // a ball with a cave that no way leads into
    let shell = |voxel: IVec3| {
        let distance = centre(&grid, voxel).distance(middle);
        distance < 14.0 && distance > 6.0
    };
    for (radius, depth) in [(5.0, 0.9), (7.0, 2.0), (12.0, 5.6)] {
        let mut voxels = scan(grid, |_| 0, &[&nothing, &shell, &nothing]);
        let out = DVec3::new(0.6, 0.3, 0.74).normalize();
        // of the first free voxels on the way out
        let on_way = |step: u32| middle + out * (13.0 + 0.1 * f64::from(step));
        let voxel_at = |point| {
            grid.grid_from_patient()
                .transform_point3(point)
                .floor()
                .as_ivec3()
        };
        let probe = (0..60).map(on_way).find(|point| !shell(voxel_at(*point)));
        let probe = probe.expect("it is free out there");
        let paint = PaintSettings {
            depth: Some(depth),
            overlaps: false,
        };
        let mut tool = painter(&grid, radius, paint);
        assert!(pass(
            tool.as_mut(),
            &mut voxels,
            &touching(probe, probe, out)
        ));

        let outside = |voxel: &IVec3| centre(&grid, *voxel).distance(middle) >= 14.0;
        let free: Vec<_> = grid.bounds().voxels().filter(outside).collect();
        let to_box = |a: IVec3, b: IVec3| {
            let apart = ((a - b).abs().as_dvec3() - 0.5).max(DVec3::ZERO);
            (apart * grid.spacing()).length()
        };
        let mut painted = 0;
        for voxel in grid.bounds().voxels().filter(|voxel| shell(*voxel)) {
            let near = centre(&grid, voxel).distance(probe) <= radius;
            let deep = || {
                free.iter()
                    .map(|other| to_box(voxel, *other))
                    .fold(99.0, f64::min)
            };
            let expected = near && deep() <= depth;
            assert_eq!(has(&voxels, PAINTED, voxel), expected, "{voxel}");
            assert_eq!(has(&voxels, FIRST, voxel), !expected, "{voxel}");
            painted += u32::from(expected);
        }
        assert!(painted > 10, "{painted}");
    }
}

#[test]
fn a_layer_of_whole_voxels_has_as_many_under_a_face() {
    let slab = |voxel: IVec3| voxel.z < 20;
    for side in [0.2, 0.3, 0.35, 0.4, 0.6, 0.7, 0.8, 1.1] {
        let grid = straight_grid(UVec3::new(12, 12, 28), side);
        let probe = centre(&grid, IVec3::new(6, 6, 20));
        for layers in 1..=5 {
            let mut voxels = scan(grid, |_| 0, &[&nothing, &slab, &nothing]);
            // from the face of the first to the middle of the last, as it is typed
            let depth = (f64::from(layers) - 0.5) * side;
            let paint = PaintSettings {
                depth: Some((1e3 * depth).round() / 1e3),
                overlaps: false,
            };
            let mut tool = painter(&grid, 5.5 * side, paint);
            let input = touching(probe, probe, DVec3::Z);
            assert!(pass(tool.as_mut(), &mut voxels, &input));
            let column = (0..28).filter(|z| has(&voxels, PAINTED, IVec3::new(6, 6, *z)));
            let expected: Vec<_> = (20 - layers..20).collect();
            assert_eq!(column.collect::<Vec<_>>(), expected, "{side}");
        }
    }
}

#[test]
fn the_far_side_of_a_wall_is_no_part_of_the_layer() {
    let grid = straight_grid(UVec3::splat(40), 0.5);
    let wall = |voxel: IVec3| (10..14).contains(&voxel.z);
    let mut voxels = scan(grid, |_| 0, &[&nothing, &wall, &nothing]);
    let paint = PaintSettings {
        depth: Some(0.8),
        overlaps: false,
    };
    let mut tool = painter(&grid, 4.0, paint);
    let probe = DVec3::new(10.0, 10.0, 4.999);
    pass(
        tool.as_mut(),
        &mut voxels,
        &touching(probe, probe, -DVec3::Z),
    );
    // centres 0.25, 0.75, 1.25 and 1.75 mm deep from here; from the other side the other way round
    let painted = [10, 11, 12, 13].map(|z| has(&voxels, PAINTED, IVec3::new(20, 20, z)));
    assert_eq!(painted, [true, true, false, false]);
}

#[test]
fn the_body_of_a_large_probe_paints_where_it_touches() {
    let grid = straight_grid(UVec3::splat(40), 0.5);
    let wall = |voxel: IVec3| voxel.z < 20;
    let mut voxels = scan(grid, |_| 0, &[&nothing, &wall, &nothing]);
    let mut tool = painter(&grid, 1.0, PaintSettings::default());
    let input = ToolInput {
        body_radius: Some(3.0),
        ..touching(DVec3::splat(13.0), DVec3::splat(13.0), DVec3::Z)
    };
    assert!(pass(tool.as_mut(), &mut voxels, &input));
    assert!(has(&voxels, PAINTED, IVec3::new(25, 25, 19)));
    assert!(!has(&voxels, PAINTED, IVec3::new(25, 25, 17)));
}

#[test]
fn it_paints_only_while_it_touches_and_not_on_its_way_there() {
    let grid = straight_grid(UVec3::splat(40), 0.5);
    let wall = |voxel: IVec3| voxel.z < 20;
    let mut voxels = scan(grid, |_| 0, &[&nothing, &wall, &nothing]);
    let mut tool = painter(&grid, 1.0, PaintSettings::default());
    let [start, far] = [4.0, 16.0].map(|x| DVec3::new(x, 10.0, 10.01));
    assert!(!pass(tool.as_mut(), &mut voxels, &free_move(start, start)));
    // low over the wall, then down on it
    assert!(pass(
        tool.as_mut(),
        &mut voxels,
        &touching(start, far, DVec3::Z)
    ));
    let painted = |x: f64| has(&voxels, PAINTED, IVec3::new((2.0 * x) as i32, 20, 19));
    assert!(painted(16.0) && !painted(10.0) && !painted(4.0));
    tool.release();
    assert!(!pass(tool.as_mut(), &mut voxels, &free_move(far, far)));
    let nan = touching(DVec3::NAN, DVec3::NAN, DVec3::Z);
    assert!(!pass(tool.as_mut(), &mut voxels, &nan));
}

#[test]
fn a_stroke_is_taken_back_to_the_bit() {
    let grid = oblique_grid(UVec3::new(40, 37, 21));
    let mut random = Random::new(8);
    let half = |voxel: IVec3| voxel.y > 15;
    let mut voxels = scan(grid, |_| 0, &[&nothing, &half, &half]);
    let before = Dense::of(&voxels);
    let mut stroke = Stroke::default();
    let mut tool = painter(&grid, 4.0, PaintSettings::default());
    for _ in 0..30 {
        let at = random.point(&grid, 0.0);
        if let Some(edit) = tool
            .advance(&voxels, &touching(at, at, DVec3::Z))
            .expect("they exist")
        {
            stroke.add(voxels.apply(edit).expect("it fits"));
        }
    }
    assert_ne!(Dense::of(&voxels), before);
    voxels.apply(stroke.into_inverse()).expect("it fits");
    assert_eq!(Dense::of(&voxels), before);
}

#[test]
fn a_painter_needs_something_to_paint_and_a_depth_that_fits() {
    let grid = straight_grid(UVec3::splat(40), 0.5);
    for segments in [vec![PAINTED], vec![PAINTED, PAINTED]] {
        let alone = ToolSettings::new(ToolKind::Painter, 1.0, segments);
        let error = alone.build(&grid).map(drop);
        assert!(
            matches!(error, Err(ToolError::NothingToPaint(_))),
            "{error:?}"
        );
    }
    for depth in [0.0, -1.0, f64::NAN, 4.1] {
        let paint = PaintSettings {
            depth: Some(depth),
            overlaps: false,
        };
        let error = settings(1.0, paint).build(&grid).map(drop);
        assert!(
            matches!(error, Err(ToolError::Depth { allowed: 4.0, .. })),
            "{error:?}"
        );
    }
}
