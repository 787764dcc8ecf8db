//! A drill in a block and a ball on soft tissue, driven without a device.

use crate::common::*;
use crate::length::by_length;
use glam::{DVec3, IVec3, UVec3};
use palpate_deform::material::preset;
use palpate_engine::scenario::drilling::{DrillDrive, DrillRun, drive_drill};
use palpate_engine::scenario::drive::{Drive, Phase, Sample};
use palpate_engine::scenario::palpation::{Press, PressedLayer, press};
use palpate_engine::scenario::rearranging::{RearrangingDrive, drive_rearranging, thesis_bone};
use palpate_tools::drill::DrillSettings;
use palpate_tools::specific_energy::SpecificEnergy;
use palpate_volume::voxel_box::VoxelBox;

const SIZE: UVec3 = UVec3::splat(32);
/// Upper face of what is touched [mm].
const TOP: f64 = 20.0;
/// Of the burr [mm].
const BURR: f64 = 2.0;
/// Speed of the drive [mm/s].
const FEED: f64 = 0.25;
/// Work per volume [N/mm²].
const ENERGY: f64 = 1000.0;

fn from_above(depth: f64, speed: f64) -> Drive {
    Drive {
        speed,
        force_limit: 10.0,
        rest_secs: 0.2,
        stiffness: 4.0,
        ..Drive::between(
            DVec3::new(16.2, 16.3, TOP + 4.0),
            DVec3::new(16.2, 16.3, TOP - depth),
        )
    }
}

fn drilled(thick: i32, depth: f64) -> DrillRun {
    let bone = box_segment(
        SIZE,
        IVec3::new(0, 0, TOP as i32 - thick),
        IVec3::new(32, 32, TOP as i32),
    );
    let given = DrillDrive {
        drive: from_above(depth, FEED),
        radius: BURR,
        drill: DrillSettings {
            specific_energy: SpecificEnergy::Everywhere(ENERGY),
            ..DrillSettings::default()
        },
    };
    drive_drill(&grid(SIZE), intensities(SIZE), bone, &given).unwrap()
}

#[test]
fn a_drill_sinks_in_with_the_force_that_its_feed_needs() {
    let run = drilled(20, 6.0);
    assert_eq!(run.violations, 0);
    assert!(run.events[0].is_contact && run.volume.is_sorted());
    let is_steady = |sample: &Sample| sample.phase == Phase::In && sample.travel > 6.0;
    let first = run.samples.iter().position(is_steady).unwrap();
    let last = run.samples.iter().rposition(is_steady).unwrap();
    let steady = &run.samples[first..last];
    let mean = steady.iter().map(|sample| sample.force).sum::<f64>() / steady.len() as f64;

    // what the work of the force along the burr's surface takes away
    let DrillSettings {
        surface_speed,
        cutting_ratio,
        ..
    } = DrillSettings::default();
    let per_newton = cutting_ratio * surface_speed / ENERGY;
    let seconds = steady.len() as f64 * 1e-3;
    let gone = run.volume[last] - run.volume[first];
    // a voxel more or less at either end, and the force across the way, which counts too
    assert!(
        (gone - mean * per_newton * seconds).abs() < 2.0 + 0.05 * gone,
        "{gone} mm³ by {mean} N in {seconds} s"
    );
    // the hole is as wide as the burr, which is held off by up to a voxel's diagonal
    let force_of = |radius: f64| std::f64::consts::PI * radius * radius * FEED / per_newton;
    let widest = force_of(BURR + 3.0_f64.sqrt());
    assert!(
        mean > 0.9 * force_of(BURR) && mean < 1.1 * widest,
        "{mean} N"
    );
}

#[test]
fn a_drill_that_comes_through_is_free() {
    let run = drilled(4, 10.0);
    let kinds: Vec<bool> = run.events.iter().map(|event| event.is_contact).collect();
    assert_eq!(kinds[..2], [true, false]);
    assert!(run.events[1].travel > run.events[0].travel + 3.0);
    let last = run.samples.iter().rfind(|sample| sample.phase == Phase::In);
    assert_eq!(last.unwrap().force, 0.0);
}

/// Presses a ball of two voxels 2 mm into fat over bone that begins so deep.
fn pressed(bone_top: i32) -> Press {
    let fat = preset("fat").unwrap().law().unwrap();
    let box_to = |top| box_segment(SIZE, IVec3::ZERO, IVec3::new(32, 32, top));
    let layers = [
        PressedLayer {
            segment: box_to(TOP as i32),
            law: Some(fat),
        },
        PressedLayer {
            segment: box_to(bone_top),
            law: None,
        },
    ];
    let drive = from_above(4.0, 20.0);
    press(
        &grid(SIZE),
        intensities(SIZE),
        &layers,
        ("lattice", 2.0),
        (&drive, 4.0),
    )
    .unwrap()
}

#[test]
fn soft_matter_over_bone_is_stiffer_the_nearer_that_is() {
    let [deep, near] = [4, 15].map(pressed);
    let most = |press: &Press| {
        let forces = press.samples.iter().map(|sample| sample.force);
        forces.fold(0.0, f64::max)
    };
    assert_eq!(deep.violations + near.violations, 0);
    assert!(deep.answers > 5);
    // both go as deep, or nearly, and fat alone gives more
    assert!(
        most(&near) > 1.2 * most(&deep),
        "{} {}",
        most(&near),
        most(&deep)
    );
    assert!(most(&deep) > 0.0);
}

#[test]
fn what_is_no_drive_is_refused() {
    let bone = box_segment(SIZE, IVec3::ZERO, IVec3::new(32, 32, 20));
    let good = DrillDrive {
        drive: from_above(4.0, 1.0),
        radius: BURR,
        drill: DrillSettings::default(),
    };
    let still = Drive {
        speed: 0.0,
        ..good.drive
    };
    let huge = DrillDrive {
        radius: 30.0,
        ..good
    };
    for bad in [
        DrillDrive {
            drive: still,
            ..good
        },
        huge,
    ] {
        assert!(drive_drill(&grid(SIZE), intensities(SIZE), bone.clone(), &bad).is_err());
    }
    let unknown = ("jelly", 2.0);
    let refused = press(
        &grid(SIZE),
        intensities(SIZE),
        &[],
        unknown,
        (&good.drive, 4.0),
    );
    assert!(refused.unwrap_err().to_string().contains("lattice"));
}

/// Soft tissue of a thickness [mm] over bone, pressed until the drive is 4 mm in the bone.
fn pressed_into(model: &str, material: &str, thick: i32, radius: f64, overlap: bool) -> Press {
    let law = preset(material).unwrap().law().unwrap();
    let bone_top = TOP as i32 - thick;
    let soft_from = if overlap { 0 } else { bone_top };
    let block = |from, to| {
        box_segment(
            SIZE,
            IVec3::new(0, 0, from),
            IVec3::new(SIZE.x as i32, SIZE.y as i32, to),
        )
    };
    let layers = [
        PressedLayer {
            segment: block(soft_from, TOP as i32),
            law: Some(law),
        },
        PressedLayer {
            segment: block(0, bone_top),
            law: None,
        },
    ];
    let drive = Drive {
        stiffness: 1.0,
        ..from_above(f64::from(thick) + 4.0 - radius, 20.0)
    };
    press(
        &grid(SIZE),
        intensities(SIZE),
        &layers,
        (model, radius),
        (&drive, 100.0),
    )
    .unwrap()
}

/// How much less than the spring over its way in bone a press was ever felt with [N].
fn shortfall(run: &Press, bone_top: f64, radius: f64) -> f64 {
    let missing = run.samples.iter().map(|sample| {
        let depth = bone_top + radius - (TOP + 4.0 - sample.travel);
        if depth > 0.0 {
            depth - sample.force
        } else {
            0.0
        }
    });
    missing.fold(0.0, f64::max)
}

#[test]
#[ignore = "takes long: make test-long"]
fn bone_under_thin_soft_matter_pushes_back_whatever_a_model_says() {
    // each as a layer over the bone, and as a segment that holds the bone's voxels too
    let thin = [(1, 2.0), (2, 0.0), (2, 2.0), (3, 1.0)];
    let by_lattice = thin.map(|(thick, radius)| ("lattice", thick, radius));
    let by_others = ["fcc-lj", "cuboid-lj", "global-lj"].map(|model| (model, 2, 2.0));
    let by_lattice = by_lattice.into_iter().take(by_length(2, 4));
    for (model, thick, radius) in by_lattice.chain(by_others) {
        for overlap in [false, true] {
            let run = pressed_into(model, "muscle", thick, radius, overlap);
            let missing = shortfall(&run, TOP - f64::from(thick), radius);
            // what smoothing rounds, of some 4 N
            assert!(
                missing < 0.15,
                "{missing} N missing: {model}, {thick} mm, radius {radius}, {overlap}"
            );
            assert_eq!(run.violations, 0);
        }
    }
}

#[test]
#[ignore = "takes long: make test-long"]
fn bone_of_particles_is_pushed_aside_and_none_of_it_is_lost() {
    let block = box_segment(SIZE, IVec3::ZERO, IVec3::new(32, 32, TOP as i32));
    let given = RearrangingDrive {
        drive: Drive {
            rest_secs: 0.1,
            ..from_above(5.0 - BURR, 3.0)
        },
        radius: BURR,
        law: thesis_bone(20_000.0, false).unwrap(),
    };
    let run = drive_rearranging(&grid(SIZE), intensities(SIZE), block.clone(), &given).unwrap();
    assert_eq!(run.violations, 0);
    // a hole under the ball, and what was in it around it, higher than any bone before
    let hole = IVec3::new(16, 16, TOP as i32 - 1);
    assert!(!run.bone.contains(hole) && !run.bone.contains(hole - IVec3::Z));
    let bounds = VoxelBox::of_dimensions(SIZE);
    let rim = bounds
        .voxels()
        .filter(|voxel| run.bone.contains(*voxel) && voxel.z >= TOP as i32);
    let rim: Vec<IVec3> = rim.collect();
    let far = |voxel: &IVec3| (voxel.truncate() - 16).abs().max_element() > 8;
    assert!(rim.len() > 10 && !rim.iter().any(far), "{rim:?}");
    assert_eq!(run.bone.count(), block.count());
    // while it is pressed some is squeezed; afterwards all of it stands somewhere
    let squeezed = run
        .volume
        .iter()
        .zip(&run.piled)
        .map(|(gone, come)| gone - come);
    assert!(squeezed.fold(0.0, f64::max) < 30.0);
    assert_eq!(run.volume.last(), run.piled.last());
    // as in figure 5.27 the force rises and then changes by little, by rows that slip
    let [answers, slips] = run.answers;
    assert!(slips > 10 && slips < answers, "{slips} of {answers}");
    let going_in = run
        .samples
        .iter()
        .filter(|sample| sample.phase == Phase::In);
    let late: Vec<f64> = going_in
        .filter(|s| s.travel > 4.0)
        .map(|s| s.force)
        .collect();
    let (least, most) = (
        late.iter().copied().fold(f64::MAX, f64::min),
        late.iter().copied().fold(0.0, f64::max),
    );
    assert!(
        least > 0.3 * most && most < given.drive.force_limit,
        "{least} to {most} N"
    );
    // it comes out without a force, and the tool is where the drive is
    let last = run.samples.last().unwrap();
    assert!(last.force == 0.0 && last.tip.abs() < 1e-9, "{last:?}");
}
