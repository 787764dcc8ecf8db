//! Segments with a grid of their own, such as a thin plate beside a scan of thick slices: touched,
//! moved, cut, erased and recorded in that grid.

use crate::common::*;
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::replay::{Recording, ReplayEnd, Tape, TapeColumns, TapeError, replay};
use palpate_engine::scene::SurfaceOptions;
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_engine::touch::Settings;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxels::VoxelsError;

const DIMENSIONS: UVec3 = UVec3::splat(40);
/// Voxels of the plate [mm], and how many it is thick: 1.5 mm.
const FINE: f64 = 0.25;
const THICK: i32 = 6;
/// Where the plate begins along z [mm].
const BOTTOM: f64 = 20.3;
/// What the probe keeps from a face, and rounding [mm].
const BEFORE_FACE: f64 = 1e-4;

/// A plate of 10 × 10 × 1.5 mm in voxels of a quarter of a millimetre, from (15, 15, `BOTTOM`).
fn plate() -> Segment {
    let dimensions = UVec3::new(44, 44, 10);
    // two free voxels around it
    let corner = DVec3::new(15.0, 15.0, BOTTOM) - 2.0 * FINE;
    let spacing = DVec3::splat(FINE);
    let grid = Grid::new(dimensions, spacing, corner + 0.5 * FINE, DMat3::IDENTITY).unwrap();
    let size = IVec3::new(42, 42, 2 + THICK);
    box_segment(dimensions, IVec3::splat(2), size).on_grid(grid)
}

/// Slices of 2 mm, as scans of heads have them.
fn thick_slices() -> Grid {
    let spacing = DVec3::new(1.0, 1.0, 2.0);
    Grid::new(DIMENSIONS, spacing, 0.5 * spacing, DMat3::IDENTITY).unwrap()
}

/// A session of thick slices with a plate, whose device presses on it from above, goes around it,
/// and presses from below.
fn pressed() -> Session {
    let config = SessionConfig {
        segments: vec![(plate(), OBSTACLE)],
        reference: Reference::Scene,
        start: Some(DVec3::new(20.0, 20.0, 30.0)),
        real_time: false,
        ..SessionConfig::new(
            thick_slices(),
            intensities(DIMENSIONS),
            scripted(&[
                [0.0, 20.0, 20.0, 30.0],
                [0.5, 20.0, 20.0, 18.0],
                [1.0, 20.0, 20.0, 18.0],
                [1.2, 20.0, 20.0, 30.0],
                [1.5, 4.0, 20.0, 30.0],
                [1.8, 4.0, 20.0, 10.0],
                [2.1, 20.0, 20.0, 10.0],
                [2.5, 20.0, 20.0, 24.0],
                [3.0, 20.0, 20.0, 24.0],
            ]),
        )
    };
    started(config)
}

#[test]
fn a_plate_thinner_than_a_slice_is_as_thick_as_it_is() {
    let session = pressed();
    session.start_recording().unwrap();
    session.run(1.0).unwrap();
    let above = session.frame().proxy.z;
    session.run(2.0).unwrap();
    let below = session.frame().proxy.z;
    assert!((above - (BOTTOM + 1.5)).abs() < BEFORE_FACE, "{above}");
    assert!((below - BOTTOM).abs() < BEFORE_FACE, "{below}");
    assert!((above - below - 1.5).abs() < 2.0 * BEFORE_FACE);
    assert_eq!(session.frame().touched, 1);

    // the recording knows its grid, in a file too
    let (recording, tape) = session.finish_recording().unwrap();
    let tape = tape.unwrap();
    let read = Tape::try_from(&TapeColumns::from(&tape)).unwrap();
    for tape in [&tape, &read] {
        let replayed = replay(&recording, tape).unwrap();
        assert_eq!(replayed.end, ReplayEnd::Whole);
        assert!(replayed.is_equal(), "{:?}", replayed.first_difference);
    }
}

#[test]
fn a_file_whose_bricks_lie_beyond_the_grid_of_their_segment_is_refused() {
    let session = pressed();
    session.start_recording().unwrap();
    session.run(0.2).unwrap();
    let (_, tape) = session.finish_recording().unwrap();
    let mut columns = TapeColumns::from(&tape.unwrap());
    // a brick of the scan that the plate's grid of 6 × 6 × 2 bricks does not have
    *columns.solid.index.last_mut().unwrap() = 100;
    let error = Tape::try_from(&columns).unwrap_err();
    assert_eq!(error, TapeError::Bricks);
}

#[test]
fn state_volume_and_gap_are_those_of_its_own_voxels() {
    let mut config = SessionConfig::new(thick_slices(), intensities(DIMENSIONS), simulated());
    let wall = Segment::from_fn(DIMENSIONS, |voxel| voxel.z < 5);
    config.segments = vec![(wall, OBSTACLE), (plate(), OBSTACLE)];
    config.real_time = false;
    let session = started(config);
    let state = session.segments().unwrap()[1];
    assert!((state.volume - 150.0).abs() < 1e-9, "{}", state.volume);
    assert_eq!(state.own_grid.unwrap().spacing(), DVec3::splat(FINE));
    assert_eq!(state.pose, Some(DAffine3::IDENTITY));
    // the wall ends at 10 mm; each surface is right to half of its own voxel, and edges of the
    // plate are rounded
    let gap = session.gap(SegmentId(2), SegmentId(1)).unwrap();
    assert!((gap.minimum - (BOTTOM - 10.0)).abs() < 0.5, "{gap:?}");
    assert!(
        gap.mean > gap.minimum && gap.mean < gap.minimum + 1.5,
        "{gap:?}"
    );
    assert_eq!(gap.overlap, 0.0);
    // put 1 mm deep into the wall
    let down = DAffine3::from_translation(DVec3::Z * (9.0 - BOTTOM));
    session.move_segment(SegmentId(2), down).unwrap();
    session.run(0.2).unwrap();
    let gap = session.gap(SegmentId(2), SegmentId(1)).unwrap();
    assert!((gap.overlap - 100.0).abs() < 1e-9, "{gap:?}");
}

#[test]
fn its_surface_is_made_of_its_own_voxels() {
    let mut config = SessionConfig::new(thick_slices(), intensities(DIMENSIONS), simulated());
    config.segments = vec![(plate(), OBSTACLE)];
    config.real_time = false;
    let session = started(config);
    let id = SegmentId(1);
    let settings = SurfaceOptions::default();
    session.show_surface(id, Some(settings)).unwrap();
    session.run(0.1).unwrap();
    let low_and_high = |session: &Session| {
        let whole = session.whole_surfaces();
        let heights = whole.surfaces[&id].patches.iter().flat_map(|(_, patch)| {
            let of_vertex = |bytes: &[u8]| {
                let share = f64::from(u16::from_le_bytes([bytes[4], bytes[5]])) / 65535.0;
                patch.origin.z + share * patch.size.z
            };
            patch
                .vertices
                .chunks_exact(6)
                .map(of_vertex)
                .collect::<Vec<_>>()
        });
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
            (low.min(z), high.max(z))
        })
    };
    let (low, high) = low_and_high(&session);
    // right to half a voxel
    assert!((low - BOTTOM).abs() <= 0.5 * FINE, "{low}");
    assert!((high - BOTTOM - 1.5).abs() <= 0.5 * FINE, "{high}");

    // removed and brought back, it follows its own grid still
    session.remove_segment(id).unwrap();
    session.run(0.1).unwrap();
    assert!(session.whole_surfaces().surfaces.is_empty());
    session.undo().unwrap();
    session.run(0.1).unwrap();
    assert_eq!(low_and_high(&session), (low, high));
}

/// A rig with the plate and a block of the scan beneath it.
fn rig() -> (Rig, SegmentId, SegmentId) {
    let mut rig = Rig::new(DIMENSIONS, DVec3::new(20.0, 20.0, 30.0));
    let block = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(40, 40, 10));
    let block = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    let plate = rig.simulation.add_segment(plate(), OBSTACLE, true).unwrap();
    (rig, block, plate)
}

fn ticks(rig: &mut Rig, count: u32, device: DVec3) -> DVec3 {
    let mut recording = Recording::default();
    for tick in 0..count {
        recording.push(&rig.tick_at(device), 0);
        if tick % 10 == 0 {
            rig.simulation.step();
        }
        assert_eq!(rig.violations(), 0);
    }
    rig.simulation.step();
    *recording.proxy.last().unwrap()
}

#[test]
fn it_is_moved_turned_and_grabbed_in_its_own_grid() {
    let (mut rig, _, plate) = rig();
    let above = DVec3::new(20.0, 20.0, 30.0);
    ticks(&mut rig, 60, above);
    let moved = DAffine3::from_translation(DVec3::Z * 3.0);
    rig.simulation.move_segment(plate, moved).unwrap();
    ticks(&mut rig, 60, above);
    let rests = ticks(&mut rig, 200, DVec3::new(20.0, 20.0, 22.0));
    assert!((rests.z - (BOTTOM + 4.5)).abs() < BEFORE_FACE, "{rests}");

    // turned by 90° about its middle it is thin along x
    ticks(&mut rig, 60, above);
    let middle = DVec3::new(20.0, 20.0, BOTTOM + 0.75);
    let turned = DAffine3::from_translation(middle)
        * DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2)
        * DAffine3::from_translation(-middle);
    rig.simulation.move_segment(plate, turned).unwrap();
    ticks(&mut rig, 200, DVec3::new(30.0, 20.0, 30.0));
    ticks(&mut rig, 200, DVec3::new(30.0, 20.0, BOTTOM));
    let rests = ticks(&mut rig, 200, DVec3::new(18.0, 20.0, BOTTOM));
    assert!((rests.x - 20.75).abs() < BEFORE_FACE, "{rests}");

    // in the hand it stops at the block, to a quarter of a millimetre
    rig.simulation
        .move_segment(plate, DAffine3::IDENTITY)
        .unwrap();
    ticks(&mut rig, 200, above);
    rig.simulation.grab(Some(plate), true).unwrap();
    ticks(&mut rig, 60, above);
    for step in 0..60 {
        ticks(&mut rig, 10, above - DVec3::Z * 0.25 * f64::from(step));
    }
    ticks(&mut rig, 60, above - DVec3::Z * 15.0);
    let pose = rig.simulation.segments()[1].pose.unwrap();
    let over = BOTTOM + pose.translation.z - 10.0;
    // half a voxel: middles of voxels are looked up
    assert!((-0.5 * FINE..=FINE).contains(&over), "{over}");
}

#[test]
fn both_parts_of_a_cut_keep_its_grid() {
    let mut config = SessionConfig::new(thick_slices(), intensities(DIMENSIONS), simulated());
    config.segments = vec![(plate(), OBSTACLE)];
    config.real_time = false;
    let session = started(config);
    let point = DVec3::new(17.5, 20.0, BOTTOM);
    let part = session.cut(SegmentId(1), point, DVec3::X).unwrap();
    let states = session.segments().unwrap();
    let volumes: Vec<f64> = states.iter().map(|state| state.volume).collect();
    assert_eq!(volumes, [2.5 * 10.0 * 1.5, 7.5 * 10.0 * 1.5]);
    assert_eq!(states[1].own_grid, states[0].own_grid);
    assert_eq!(part, SegmentId(2));
}

fn tool(kind: ToolKind, segments: &[SegmentId]) -> ToolSettings {
    ToolSettings::new(kind, 1.0, segments.to_vec())
}

#[test]
fn the_eraser_works_in_its_grid_and_the_drill_leaves_it() {
    let (mut rig, block, plate) = rig();
    let point = DVec3::new(20.0, 20.0, BOTTOM + 1.5);
    let before = rig.simulation.voxels().segment(plate).unwrap().count();
    rig.simulation
        .set_tool(Some(tool(ToolKind::Eraser, &[plate, block])))
        .unwrap();
    rig.simulation.stroke(true).unwrap();
    ticks(&mut rig, 100, DVec3::new(20.0, 20.0, 30.0));
    ticks(&mut rig, 200, point);
    rig.simulation.stroke(false).unwrap();
    let told = |notice: palpate_engine::notice::Notice| notice.text.contains("on another grid");
    assert!(rig.notices.try_iter().any(told));
    let erased = before - rig.simulation.voxels().segment(plate).unwrap().count();
    let report = rig.simulation.tool_report();
    assert_eq!(report.voxels, erased);
    assert!((report.volume - erased as f64 * FINE.powi(3)).abs() < 1e-9);
    // at least half a ball of 1 mm
    assert!(report.volume > 1.9, "{report:?}");
    let block_voxels = rig.simulation.voxels().segment(block).unwrap().count();
    assert_eq!(block_voxels, 40 * 40 * 10);
    assert!(rig.simulation.undo().unwrap());
    let undone = rig.simulation.voxels().segment(plate).unwrap().count();
    assert_eq!(undone, before);

    rig.simulation
        .set_tool(Some(tool(ToolKind::Drill, &[plate])))
        .unwrap();
    let refused = rig.simulation.stroke(true);
    assert!(matches!(refused, Err(SessionError::NothingToDrill)));
}

#[test]
fn a_probe_too_large_for_its_voxels_is_refused_also_while_undo_could_bring_it_back() {
    let (mut rig, _, plate) = rig();
    let wanted = Settings {
        // the scan's voxels allow 16 mm, those of the plate 4 mm
        probe_radius: 5.0,
        ..Settings::default()
    };
    let refused = rig.simulation.set_settings(wanted);
    assert!(matches!(refused, Err(SessionError::Ball(_))));
    rig.simulation.remove_segment(plate).unwrap();
    let refused = rig.simulation.set_settings(wanted);
    assert!(matches!(refused, Err(SessionError::Ball(_))));

    let mut other = Rig::new(DIMENSIONS, DVec3::new(20.0, 20.0, 30.0));
    other.simulation.set_settings(wanted).unwrap();
    let refused = other.simulation.add_segment(self::plate(), OBSTACLE, true);
    assert!(matches!(refused, Err(SessionError::Ball(_))));
}

#[test]
fn voxels_of_two_grids_are_not_mixed() {
    let (mut rig, block, plate) = rig();
    let of_scan = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::splat(4));
    let refused = rig.simulation.replace_segment(plate, of_scan, None);
    assert!(matches!(refused, Err(SessionError::OtherGrid(id)) if id == plate.0));
    let voxels = rig.simulation.voxels();
    let region = palpate_volume::voxel_box::VoxelBox::new(IVec3::ZERO, IVec3::splat(9));
    let refused = voxels.label_edit_of(&[block, plate], &[region], |_, _, _| true);
    assert_eq!(
        refused.unwrap_err(),
        VoxelsError::DifferentGrids(block.0, plate.0)
    );
    // matter of the scan is none of the plate's
    let edit = voxels.voxel_edit(&region, |_, mut was| {
        was.segments = SegmentSet::EMPTY;
        was
    });
    assert!(edit.segments.iter().all(|(id, _)| *id == block));
    assert!(
        voxels
            .labels_in(&region, &[plate])
            .iter()
            .all(|label| *label == 0)
    );
}
