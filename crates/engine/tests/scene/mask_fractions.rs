//! Occupancy fractions of masks come in the background, and the servo has none that its voxels have
//! outlived.

use crate::common::*;
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::new(40, 36, 32);
const START: DVec3 = DVec3::new(20.0, 18.0, 31.0);

/// All below a slope of some 5°.
fn slope() -> Segment {
    Segment::from_fn(DIMENSIONS, |voxel| {
        let middle = voxel.as_dvec3() + 0.5;
        middle.z < 14.0 + 0.09 * middle.x + 0.02 * middle.y
    })
}

fn rig_on(segments: &[Segment]) -> (Rig, Vec<SegmentId>) {
    let mut rig = Rig::new(DIMENSIONS, START);
    rig.simulation.switch_mask_fractions(true);
    let add = |segment: &Segment| {
        let added = rig.simulation.add_segment(segment.clone(), OBSTACLE, false);
        added.unwrap()
    };
    let ids = segments.iter().map(add).collect();
    (rig, ids)
}

/// A pass of each loop, and ticks in which the servo follows.
fn pass(rig: &mut Rig) {
    rig.simulation.step();
    rig.fractions.step();
    for _ in 0..4 {
        rig.tick_at(START);
    }
}

/// Passes until nothing is left to be worked out or told.
fn settle(rig: &mut Rig) {
    for _ in 0..100 {
        pass(rig);
        if rig.simulation.unknown_fractions() == 0 {
            return pass(rig);
        }
    }
    panic!("regions are left after 100 passes");
}

fn is_surface(rig: &Rig, voxel: IVec3) -> bool {
    let whole = VoxelBox::of_dimensions(DIMENSIONS);
    let solid = |voxel: IVec3| rig.servo.solid().is_solid(voxel);
    [IVec3::X, IVec3::Y, IVec3::Z]
        .into_iter()
        .flat_map(|axis| [voxel - axis, voxel + axis])
        .any(|beside| whole.contains(beside) && solid(beside) != solid(voxel))
}

/// Counts the voxels whose fraction is known; each must be at the surface of what the servo has.
fn known(rig: &Rig) -> usize {
    let whole = VoxelBox::of_dimensions(DIMENSIONS);
    let known = whole
        .voxels()
        .filter(|&voxel| rig.servo.share(voxel).is_some());
    known
        .inspect(|&voxel| assert!(is_surface(rig, voxel), "{voxel} is not at the surface"))
        .count()
}

fn at_the_surface(rig: &Rig) -> usize {
    let whole = VoxelBox::of_dimensions(DIMENSIONS);
    whole
        .voxels()
        .filter(|&voxel| is_surface(rig, voxel))
        .count()
}

#[test]
fn shares_of_a_mask_come_and_an_edit_takes_those_of_its_voxels_away_at_once() {
    let before = slope();
    let (mut rig, ids) = rig_on(std::slice::from_ref(&before));
    rig.tick_at(START);
    rig.tick_at(START);
    assert_eq!(known(&rig), 0, "nothing was worked out yet");
    settle(&mut rig);
    let all = known(&rig);
    assert_eq!(all, at_the_surface(&rig));
    // where the slope is, and not where bits say
    let column = |rig: &Rig, x: i32| {
        let fractions = (0..32).map(|z| {
            let voxel = IVec3::new(x, 18, z);
            let bit = f32::from(u8::from(rig.servo.solid().is_solid(voxel)));
            rig.servo.share(voxel).unwrap_or(bit)
        });
        fractions.sum::<f32>()
    };
    for x in 8..32 {
        let height = 14.0 + 0.09 * (x as f32 + 0.5) + 0.02 * 18.5;
        let error = column(&rig, x) - height;
        assert!(error.abs() < 0.15, "column {x}: {error} voxels off");
    }

    let hole = VoxelBox::new(IVec3::new(18, 16, 12), IVec3::new(23, 21, 20));
    rig.simulation.fill_box(ids[0], &hole, false).unwrap();
    rig.tick_at(START);
    // in the tick that has the hole
    assert!(!rig.servo.solid().is_solid(IVec3::new(20, 18, 13)));
    for changed in hole.voxels().filter(|&voxel| before.contains(voxel)) {
        let mut near = VoxelBox::of_voxel(changed).dilate(1).voxels();
        assert!(
            near.all(|voxel| rig.servo.share(voxel).is_none()),
            "near {changed}"
        );
    }
    assert!(known(&rig) > all / 2, "far away all is known still");
    settle(&mut rig);
    assert_eq!(known(&rig), at_the_surface(&rig));

    // undone, it is as it was, to a part of a voxel
    rig.simulation.undo().unwrap();
    settle(&mut rig);
    assert_eq!(known(&rig), all);
}

#[test]
fn no_share_outlives_its_voxels_whatever_is_edited_meanwhile() {
    let other = Segment::from_fn(DIMENSIONS, |voxel| {
        (voxel - IVec3::new(30, 18, 18)).length_squared() < 40
    });
    let (mut rig, ids) = rig_on(&[slope(), other]);
    let mut random = Random::new(20);
    let mut seen = 0;
    for _ in 0..40 {
        let id = ids[random.below(2) as usize];
        match random.below(12) {
            0 => _ = rig.simulation.undo().unwrap(),
            1 => rig
                .simulation
                .set_touchable(id, random.below(2) == 0)
                .unwrap(),
            2 => {
                let by = DAffine3::from_translation(random.point(-2.0, 2.0));
                rig.simulation.move_segment(ids[1], by).unwrap();
            }
            3 => rig
                .simulation
                .replace_segment(ids[0], slope(), None)
                .unwrap(),
            _ => {
                let region = random.voxel_box(DIMENSIONS, 8);
                let solid = random.below(2) == 0;
                rig.simulation.fill_box(id, &region, solid).unwrap();
            }
        }
        for _ in 0..random.below(3) {
            pass(&mut rig);
        }
        rig.tick_at(START);
        seen += known(&rig);
    }
    assert!(seen > 0, "no share was ever known");
    settle(&mut rig);
    known(&rig);
}
