//! The drill's accounts of work, the shape of its hole, and what it leaves alone.

use crate::support::{
    Dense, Random, centre, everywhere, free_move, oblique_grid, scan, straight_grid,
};
use glam::{DVec3, IVec3, UVec3};
use palpate_tools::drill::{DrillSettings, MAX_VOXELS_PER_PASS};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::specific_energy::{CORTICAL, SpecificEnergy};
use palpate_tools::stroke::Stroke;
use palpate_tools::tool::{Tool, ToolError, ToolInput, ToolReport};
use palpate_volume::edit::{EditKind, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxels::Voxels;

const BONE: i16 = 1500;
const AIR: i16 = -1000;

fn drill_with(grid: &Grid, radius: f64, drill: DrillSettings) -> Box<dyn Tool> {
    let settings = ToolSettings {
        drill,
        ..ToolSettings::new(ToolKind::Drill, radius, vec![SegmentId(1)])
    };
    settings.build(grid).expect("a tool")
}

fn drill(grid: &Grid, radius: f64) -> Box<dyn Tool> {
    drill_with(grid, radius, DrillSettings::default())
}

/// A probe with a body that presses along -z, and stands wherever its body is still free.
struct Press {
    at: DVec3,
    body: f64,
    force: f64,
}

impl Press {
    /// Goes on as far as the body is free: from its centre to the boxes of solid voxels.
    fn follow(&mut self, voxels: &Voxels) {
        let grid = voxels.grid();
        let segment = voxels.segment(SegmentId(1)).expect("it exists");
        let free = |at: DVec3| {
            let reach = self.body / grid.smallest_spacing() + 2.0;
            let middle = grid.grid_from_patient().transform_point3(at).floor();
            let low = (middle - reach).as_ivec3();
            let high = (middle + reach + 1.0).as_ivec3();
            let near = palpate_volume::voxel_box::VoxelBox::new(low, high);
            near.voxels().all(|voxel| {
                let outside = (centre(grid, voxel) - at).abs() - grid.spacing() / 2.0;
                let distance = outside.max(DVec3::ZERO).length();
                !segment.contains(voxel) || distance > self.body
            })
        };
        for _ in 0..40 {
            let next = self.at - DVec3::Z * 0.02;
            if !free(next) {
                break;
            }
            self.at = next;
        }
    }

    fn pass(&mut self, tool: &mut dyn Tool, voxels: &mut Voxels, dt: f64) -> bool {
        let from = self.at;
        self.follow(voxels);
        let input = ToolInput {
            body_radius: Some(self.body),
            force: self.force,
            contact_normal: DVec3::Z,
            dt,
            ..free_move(from, self.at)
        };
        let edit = tool.advance(voxels, &input).expect("it exists");
        if let Some(edit) = edit {
            assert_eq!(edit.kind, EditKind::Voxel);
            voxels.apply(edit).expect("it fits");
            return true;
        }
        false
    }
}

/// Half a block of bone below z = 14 mm, drilled from above for so long.
fn drilled(body: f64, force: f64, seconds: f64, settings: DrillSettings) -> (Voxels, ToolReport) {
    let grid = straight_grid(UVec3::splat(40), 0.5);
    let bone = |voxel: IVec3| voxel.z < 28;
    let stored = |voxel| if bone(voxel) { BONE } else { AIR };
    let mut voxels = scan(grid, stored, &[&bone]);
    let mut tool = drill_with(&grid, 2.0, settings);
    let mut press = Press {
        at: DVec3::new(10.1, 9.9, 14.0 + body + 0.01),
        body,
        force,
    };
    for _ in 0..(seconds * 100.0) as usize {
        press.pass(tool.as_mut(), &mut voxels, 0.01);
    }
    (voxels, tool.report())
}

#[test]
fn energy_spent_per_volume_is_the_stated_one() {
    let per_volume = SpecificEnergy::OfBone.at(f64::from(BONE));
    for (body, force) in [(0.0, 2.0), (2.0, 5.0), (2.0, 20.0)] {
        let (voxels, report) = drilled(body, force, 6.0, DrillSettings::default());
        let holes = voxels.segment(SegmentId(1)).expect("it exists").count();
        let volume = (40 * 40 * 28 - holes) as f64 * 0.125;
        assert!((report.volume - volume).abs() < 1e-9, "{report:?}");
        assert!(volume > 2.0, "{report:?}");
        // the issue asks for 10 %; what is carried on is less than one voxel
        let stated = per_volume * volume;
        assert!(
            report.energy >= stated - 1e-6 && report.energy < 1.1 * stated,
            "{report:?}"
        );
        assert!(
            report.energy - stated <= per_volume * 0.125 + 1e-6,
            "{report:?}"
        );
        // all the power went into bone: 0.3 of the force times 4 m/s, for the time in contact
        let power = 0.3 * force * 4000.0;
        assert!(
            (report.energy / report.time - power).abs() < 1e-6 * power,
            "{report:?}"
        );
        assert!((report.load - power).abs() < 1e-6 * power, "{report:?}");
    }
}

#[test]
fn half_the_force_removes_at_half_the_rate_and_so_does_half_the_speed() {
    let (_, whole) = drilled(2.0, 10.0, 6.0, DrillSettings::default());
    let (_, half) = drilled(2.0, 5.0, 6.0, DrillSettings::default());
    let slow = DrillSettings {
        surface_speed: 2000.0,
        ..DrillSettings::default()
    };
    let (_, slow) = drilled(2.0, 10.0, 6.0, slow);
    for other in [half, slow] {
        let ratio = whole.volume / other.volume;
        // a voxel more or less of some 240
        assert!((ratio - 2.0).abs() < 0.02, "{ratio}");
    }
}

#[test]
fn the_length_of_a_pass_does_not_change_what_a_second_removes() {
    let volume = |dt: f64| {
        let grid = straight_grid(UVec3::splat(40), 0.5);
        let mut voxels = scan(grid, |_| BONE, &[&|voxel: IVec3| voxel.z < 28]);
        let mut tool = drill(&grid, 2.0);
        let mut press = Press {
            at: DVec3::new(10.0, 10.0, 16.01),
            body: 2.0,
            force: 5.0,
        };
        for _ in 0..(3.0 / dt).round() as usize {
            press.pass(tool.as_mut(), &mut voxels, dt);
        }
        tool.report().volume
    };
    let [coarse, fine] = [0.03, 0.002].map(volume);
    // a voxel of the 15 mm³
    assert!((coarse - fine).abs() <= 0.126, "{coarse} {fine}");
}

#[test]
fn a_bodys_and_a_points_hole_are_as_round_and_as_wide_as_the_burr() {
    for body in [0.0, 2.0] {
        let (voxels, report) = drilled(body, 20.0, 7.0, DrillSettings::default());
        let segment = voxels.segment(SegmentId(1)).expect("it exists");
        // well below the mouth and above the bottom
        let bottom = (0..28)
            .find(|&z| !segment.contains(IVec3::new(20, 19, z)))
            .expect("a hole");
        assert!(bottom < 16, "{bottom} {report:?}");
        for z in bottom + 5..26 {
            let hole: Vec<DVec3> = (0..40 * 40)
                .map(|i| IVec3::new(i % 40, i / 40, z))
                .filter(|&voxel| !segment.contains(voxel))
                .map(|voxel| centre(voxels.grid(), voxel).with_z(0.0))
                .collect();
            let area = hole.len() as f64 * 0.25;
            let radius = (area / std::f64::consts::PI).sqrt();
            // whatever the burr of 2 mm touches goes, half a voxel's diagonal of .35 mm beyond
            // it in the mean, and another .35 mm where the body stops before a voxel
            assert!(
                (2.0..=2.7).contains(&radius),
                "body {body}, z {z}: {radius}"
            );

            let mean = hole.iter().sum::<DVec3>() / hole.len() as f64;
            // the axis within a voxel
            assert!(
                mean.distance(DVec3::new(10.1, 9.9, 0.0)) < 0.5,
                "z {z}: {mean}"
            );
            let farthest = hole.iter().map(|at| at.distance(mean)).fold(0.0, f64::max);
            // no voxel sticks out by more than its diagonal
            assert!(farthest < radius + 0.71, "z {z}: {farthest} {radius}");
        }
    }
}

#[test]
fn denser_bone_takes_more_work_in_proportion() {
    let soft = SpecificEnergy::OfBone.at(300.0);
    let hard = SpecificEnergy::OfBone.at(1200.0);
    let density = |value: f64| 131.0 + 1.067 * value;
    assert!((hard / soft - density(1200.0) / density(300.0)).abs() < 1e-12);
    // cortical bone of 1900 kg/m³ reads some 1660 HU
    assert!((SpecificEnergy::OfBone.at(1658.0) / CORTICAL - 1.0).abs() < 1e-3);
    for value in [-3000.0, -1000.0, 0.0, 30000.0] {
        assert!(SpecificEnergy::OfBone.at(value) > 0.0);
    }
}

#[test]
fn removed_voxels_are_air_in_no_segment_and_all_else_is_untouched() {
    let mut random = Random::new(3);
    let grid = oblique_grid(UVec3::new(40, 37, 21));
    let other = |voxel: IVec3| (voxel.x + voxel.z) % 2 == 0;
    let cut = |voxel: IVec3| voxel.y < 30;
    for _ in 0..20 {
        let mut voxels = scan(grid, |voxel| 700 + voxel.x as i16, &[&cut, &other]);
        let before = Dense::of(&voxels);
        let mut tool = drill(&grid, 3.0);
        let (at, mut stroke) = (random.point(&grid, 0.0), Stroke::default());
        let mut removed = 0;
        for _ in 0..30 {
            let input = ToolInput {
                force: 80.0,
                contact_normal: DVec3::new(0.3, 1.0, -0.2),
                dt: 0.1,
                ..free_move(at, at)
            };
            if let Some(edit) = tool.advance(&voxels, &input).expect("it exists") {
                stroke.add(voxels.apply(edit).expect("it fits"));
            }
        }

        let after = Dense::of(&voxels);
        for place in 0..before.stored.len() {
            let [was, is] = [&before, &after].map(|dense| dense.masks[&SegmentId(1)][place]);
            let [was_other, is_other] =
                [&before, &after].map(|dense| dense.masks[&SegmentId(2)][place]);
            if was != is {
                removed += 1;
                assert_eq!((is, is_other, after.stored[place]), (0, 0, AIR));
            } else {
                assert_eq!(
                    (is_other, after.stored[place]),
                    (was_other, before.stored[place])
                );
            }
        }
        assert_eq!(tool.report().voxels, removed);

        let redo = voxels.apply(stroke.into_inverse()).expect("it fits");
        assert_eq!(Dense::of(&voxels), before);
        voxels.apply(redo).expect("it fits");
        assert_eq!(Dense::of(&voxels), after);
    }
}

#[test]
fn a_spared_segment_keeps_its_voxels() {
    let grid = straight_grid(UVec3::splat(20), 0.5);
    let voxels = scan(grid, |_| BONE, &[&everywhere, &everywhere, &everywhere]);
    let settings = ToolSettings {
        spared: SegmentSet::EMPTY.with(SegmentId(3)),
        ..ToolSettings::new(ToolKind::Drill, 2.0, vec![SegmentId(1)])
    };
    let mut tool = settings.build(&grid).expect("a tool");
    let at = DVec3::splat(5.0);
    let input = ToolInput {
        force: 50.0,
        contact_normal: DVec3::Z,
        dt: 0.1,
        ..free_move(at, at)
    };
    let edit = tool.advance(&voxels, &input).expect("it exists");
    let changed: Vec<_> = edit
        .expect("bone")
        .segments
        .iter()
        .map(|(id, _)| *id)
        .collect();
    assert_eq!(changed, [1, 2].map(SegmentId));
}

#[test]
fn without_force_contact_or_time_nothing_goes() {
    let grid = straight_grid(UVec3::splat(20), 0.5);
    let voxels = scan(grid, |_| BONE, &[&everywhere]);
    let mut tool = drill(&grid, 2.0);
    let at = DVec3::splat(5.0);
    let good = ToolInput {
        force: 50.0,
        contact_normal: DVec3::Z,
        dt: 0.1,
        ..free_move(at, at)
    };
    let nothing = [0.0, -1.0, f64::NAN, f64::NEG_INFINITY];
    let mut inputs: Vec<_> = nothing
        .iter()
        .flat_map(|&bad| {
            [
                ToolInput { force: bad, ..good },
                ToolInput { dt: bad, ..good },
            ]
        })
        .collect();
    for normal in [DVec3::ZERO, DVec3::NAN, DVec3::splat(f64::INFINITY)] {
        inputs.push(ToolInput {
            contact_normal: normal,
            ..good
        });
    }
    inputs.push(ToolInput {
        to: DVec3::NAN,
        ..good
    });
    for input in inputs {
        let edit = tool.advance(&voxels, &input).expect("it exists");
        assert!(edit.is_none(), "{input:?}");
    }
    assert_eq!(tool.report(), ToolReport::default());
}

#[test]
fn absurd_force_speed_and_time_take_a_bounded_number_of_voxels() {
    let grid = straight_grid(UVec3::splat(60), 0.25);
    let mut voxels = scan(grid, |_| BONE, &[&everywhere]);
    let settings = DrillSettings {
        surface_speed: 1e5,
        cutting_ratio: 10.0,
        specific_energy: SpecificEnergy::Everywhere(1e-3),
        ..DrillSettings::default()
    };
    let mut tool = drill_with(&grid, 4.0, settings);
    let input = ToolInput {
        force: f64::INFINITY,
        contact_normal: DVec3::Z,
        dt: 1e300,
        ..free_move(DVec3::ZERO, DVec3::splat(7.0))
    };
    let before = tool.report();
    let edit = tool
        .advance(&voxels, &input)
        .expect("it exists")
        .expect("matter");
    voxels.apply(edit).expect("it fits");
    let report = tool.report();
    assert_eq!(report.voxels - before.voxels, MAX_VOXELS_PER_PASS as u64);
    // what was not needed was not work: at most the next voxel is paid for already
    let stated = 1e-3 * report.volume;
    assert!(
        report.energy <= stated + 1e-3 * grid.voxel_volume() + 1e-9,
        "{report:?}"
    );
}

#[test]
fn numbers_that_describe_no_drill_are_refused() {
    let grid = straight_grid(UVec3::splat(20), 0.5);
    let ok = DrillSettings::default();
    let bad = [
        DrillSettings {
            surface_speed: 0.0,
            ..ok
        },
        DrillSettings {
            surface_speed: f64::NAN,
            ..ok
        },
        DrillSettings {
            cutting_ratio: -0.1,
            ..ok
        },
        DrillSettings {
            air: f64::NAN,
            ..ok
        },
        DrillSettings {
            specific_energy: SpecificEnergy::Everywhere(0.0),
            ..ok
        },
    ];
    for drill in bad {
        let settings = ToolSettings {
            drill,
            ..ToolSettings::new(ToolKind::Drill, 2.0, vec![SegmentId(1)])
        };
        let error = settings.build(&grid).map(|_| ());
        assert!(matches!(error, Err(ToolError::Drill { .. })), "{drill:?}");
    }
}
