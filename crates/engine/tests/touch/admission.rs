//! Changes of what is solid while the probe is there: it stays free, whatever happens.

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::notice::NoticeLevel;
use palpate_engine::scene::Properties;
use palpate_engine::touch::union_of;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::splat(48);

fn rig_with_probe_at(point: DVec3) -> Rig {
    let mut rig = Rig::new(DIMENSIONS, point);
    rig.tick_at(point);
    rig
}

fn add(rig: &mut Rig, segment: Segment) -> SegmentId {
    rig.simulation.add_segment(segment, OBSTACLE, true).unwrap()
}

/// A pass of the simulation; gives the number of pending changes.
fn pending(rig: &mut Rig) -> usize {
    rig.simulation.step();
    rig.status.read().pending
}

fn block(low: i32, high: i32) -> Segment {
    box_segment(DIMENSIONS, IVec3::splat(low), IVec3::splat(high))
}

#[test]
fn a_segment_elsewhere_is_admitted_at_once() {
    let probe = DVec3::splat(5.5);
    let mut rig = rig_with_probe_at(probe);
    add(&mut rig, block(10, 30));
    assert_eq!(pending(&mut rig), 1);
    assert_eq!(rig.tick_at(probe).proxy, probe);
    assert_eq!(pending(&mut rig), 0);
}

#[test]
fn a_thin_segment_over_the_probe_pushes_it_out() {
    let probe = DVec3::new(20.5, 12.4, 20.5);
    let mut rig = rig_with_probe_at(probe);
    add(&mut rig, block(10, 30));
    let record = rig.tick_at(probe);
    assert_eq!(pending(&mut rig), 0);
    // pushed through the nearest face, y = 10, and felt from there
    assert!(record.contact);
    assert!((record.proxy.y - 10.0).abs() < 1e-6, "{}", record.proxy);
    // the force comes by a tenth of a voxel per tick, up to the smooth surface of a flat face
    assert!(record.depth <= 0.1 + 1e-9, "{}", record.depth);
    let record = (0..40).map(|_| rig.tick_at(probe)).last().unwrap();
    assert!((record.depth - 2.4).abs() < 1e-6, "{}", record.depth);
    assert_eq!(rig.violations(), 0);
}

/// A lowered threshold fills all around the probe: nothing may change until it is out.
#[test]
fn a_segment_that_buries_the_probe_waits_until_it_has_left() {
    let middle = DVec3::splat(24.5);
    let mut rig = rig_with_probe_at(middle);
    let id = add(&mut rig, block(4, 44));
    for _ in 0..20 {
        let record = rig.tick_at(middle);
        assert!(!record.contact);
        assert_eq!(record.proxy, middle);
    }
    assert_eq!(pending(&mut rig), 1);
    let state = rig.simulation.segments()[0];
    assert!(state.pending && state.id == id);
    assert_eq!(rig.notices.try_recv().unwrap().level, NoticeLevel::Warning);

    // it moves freely through what is to be solid, and once it is out the change comes in
    for tick in 0..30 {
        rig.tick_at(middle - DVec3::X * f64::from(tick));
    }
    assert_eq!(pending(&mut rig), 0);
    assert!(rig.notices.try_recv().is_err(), "it was told once");
    let outside = rig.tick_at(middle);
    assert!(outside.contact && outside.proxy.x < 4.0, "{outside:?}");
    assert_eq!(rig.violations(), 0);
}

#[test]
fn undo_cancels_a_change_that_waits() {
    let middle = DVec3::splat(24.5);
    let mut rig = rig_with_probe_at(middle);
    add(&mut rig, block(4, 44));
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 1);
    assert!(rig.simulation.undo().unwrap());
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 0);
    // the block never comes
    for tick in 0..30 {
        let record = rig.tick_at(middle - DVec3::X * f64::from(tick));
        assert!(!record.contact);
    }
}

#[test]
fn a_newer_bulk_change_takes_the_place_of_one_that_waits() {
    let middle = DVec3::splat(24.5);
    let mut rig = rig_with_probe_at(middle);
    let id = add(&mut rig, block(4, 44));
    rig.tick_at(middle);
    rig.simulation
        .replace_segment(id, block(30, 44), None)
        .unwrap();
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 0);
    let record = rig.tick_at(DVec3::splat(37.0));
    assert!(
        record.contact && record.proxy.min_element() < 30.0,
        "{record:?}"
    );
}

/// Small edits go brick by brick. The box around the probe waits; a tunnel to the probe does
/// not, and a later edit of the same voxels is what counts.
#[test]
fn an_edit_that_buries_the_probe_waits_and_a_later_edit_of_its_voxels_cancels_it() {
    let middle = DVec3::splat(20.5);
    let mut rig = rig_with_probe_at(middle);
    let id = add(&mut rig, Segment::empty(DIMENSIONS));
    rig.tick_at(middle);
    let around = VoxelBox::new(IVec3::splat(12), IVec3::splat(29));
    rig.simulation.fill_box(id, &around, true).unwrap();
    rig.tick_at(middle);
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 1);
    assert_eq!(rig.notices.try_recv().unwrap().level, NoticeLevel::Warning);

    // all of it waits, and an edit elsewhere does not wait for it
    let elsewhere = VoxelBox::new(IVec3::splat(34), IVec3::splat(40));
    rig.simulation.fill_box(id, &elsewhere, true).unwrap();
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 1);
    assert!(rig.servo.solid().is_solid(IVec3::splat(36)));
    assert!(!rig.servo.solid().is_solid(IVec3::splat(14)));

    // made free again around the probe, the rest comes in
    let own = VoxelBox::new(IVec3::splat(16), IVec3::splat(24));
    rig.simulation.fill_box(id, &own, false).unwrap();
    rig.tick_at(middle);
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 0);
    assert!(rig.servo.solid().is_solid(IVec3::splat(14)));
    assert!(!rig.servo.solid().is_solid(IVec3::splat(20)));
    assert_eq!(rig.violations(), 0);
}

/// More edits wait than the servo keeps: a root brings them all in the end.
#[test]
fn any_number_of_edits_can_wait() {
    const EDITS: i32 = 14;
    let middle = DVec3::splat(24.5);
    let mut rig = rig_with_probe_at(middle);
    let ids: Vec<_> = (0..EDITS)
        .map(|_| add(&mut rig, Segment::empty(DIMENSIONS)))
        .collect();
    for _ in 0..EDITS {
        rig.tick_at(middle);
    }
    // each buries the probe and reaches a layer higher than the one before; those that are one
    // too many reach into bricks that none before them has
    let low = IVec3::splat(8);
    let high = |layer: i32| IVec3::new(41, 41, 32 + layer);
    for (layer, id) in (1..).zip(ids) {
        let region = VoxelBox::new(low, high(layer));
        rig.simulation.fill_box(id, &region, true).unwrap();
        rig.tick_at(middle);
        assert!(pending(&mut rig) > 0);
    }
    let wanted = box_segment(DIMENSIONS, low, high(EDITS));
    for _ in 0..20 {
        rig.tick_at(DVec3::splat(2.5));
        rig.simulation.step();
    }
    assert_eq!(pending(&mut rig), 0);
    assert!(rig.servo.solid().difference(wanted.occupancy()).is_empty());
    assert_eq!(rig.violations(), 0);
}

/// However many edits wait, a tick tries one of them; all of them come soon all the same.
#[test]
fn edits_that_waited_come_one_per_tick() {
    const EDITS: i32 = 8;
    let middle = DVec3::splat(24.5);
    let mut rig = rig_with_probe_at(middle);
    let ids: Vec<_> = (0..EDITS)
        .map(|_| add(&mut rig, Segment::empty(DIMENSIONS)))
        .collect();
    for _ in 0..EDITS {
        rig.tick_at(middle);
    }
    // each buries the probe by itself, and reaches a voxel further than the one before
    for (layer, id) in (0..).zip(ids) {
        let region = VoxelBox::new(IVec3::splat(8), IVec3::new(41, 41, 33 + layer));
        rig.simulation.fill_box(id, &region, true).unwrap();
        rig.tick_at(middle);
    }
    assert_eq!(pending(&mut rig), EDITS as usize);

    // the probe is out at the end of this tick
    let outside = DVec3::splat(-20.0);
    rig.tick_at(outside);
    for tick in 1..=EDITS as usize {
        assert_eq!(rig.tick_at(outside).proxy, outside);
        assert_eq!(pending(&mut rig), EDITS as usize - tick);
    }
    assert!(rig.servo.solid().is_solid(IVec3::new(24, 24, 39)));
    assert_eq!(rig.violations(), 0);
}

/// A bulk change waits; an edit elsewhere does not, and is not undone when the bulk comes in.
#[test]
fn a_bulk_change_that_waited_keeps_the_edits_that_came_after_it() {
    let middle = DVec3::splat(24.5);
    let mut rig = rig_with_probe_at(middle);
    let id = add(&mut rig, block(4, 44));
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 1);
    let hole = VoxelBox::new(IVec3::splat(34), IVec3::splat(38));
    let bump = VoxelBox::new(IVec3::splat(45), IVec3::splat(47));
    rig.simulation.fill_box(id, &hole, false).unwrap();
    rig.tick_at(middle);
    rig.simulation.fill_box(id, &bump, true).unwrap();
    rig.tick_at(middle);
    assert!(rig.servo.solid().is_solid(IVec3::splat(45)));
    assert!(!rig.servo.solid().is_solid(IVec3::splat(20)));

    rig.tick_at(DVec3::splat(2.5));
    rig.tick_at(DVec3::splat(2.5));
    assert_eq!(pending(&mut rig), 0);
    let wanted = rig.simulation.voxels().segment(id).unwrap();
    assert!(rig.servo.solid().difference(wanted.occupancy()).is_empty());
}

/// The probe's brick and the ones around it come in one edit: it is pushed across them.
#[test]
fn an_edit_of_several_bricks_pushes_the_probe_across_all_of_them() {
    let probe = DVec3::new(20.5, 20.5, 16.2);
    let mut rig = rig_with_probe_at(probe);
    let id = add(&mut rig, Segment::empty(DIMENSIONS));
    rig.tick_at(probe);
    let slab = VoxelBox::new(IVec3::new(2, 2, 12), IVec3::new(46, 46, 22));
    rig.simulation.fill_box(id, &slab, true).unwrap();
    let record = rig.tick_at(probe);
    assert_eq!(pending(&mut rig), 0);
    assert!((record.proxy.z - 12.0).abs() < 1e-6, "{}", record.proxy);
    assert!(record.contact);
}

#[test]
fn a_segment_that_is_no_obstacle_changes_no_touch() {
    let middle = DVec3::splat(24.5);
    let mut rig = rig_with_probe_at(middle);
    let properties = Properties {
        touchable: false,
        ..OBSTACLE
    };
    let id = rig
        .simulation
        .add_segment(block(4, 44), properties, true)
        .unwrap();
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 0);
    assert!(!rig.tick_at(DVec3::splat(12.0)).contact);

    // made an obstacle around the probe, it waits; made none again, nothing waits
    rig.simulation.set_touchable(id, true).unwrap();
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 1);
    rig.simulation.set_touchable(id, false).unwrap();
    rig.tick_at(middle);
    assert_eq!(pending(&mut rig), 0);
}

/// Touch is the union: where two segments overlap, taking one away leaves the other.
#[test]
fn overlapping_segments_are_each_an_obstacle() {
    let probe = DVec3::splat(2.5);
    let mut rig = rig_with_probe_at(probe);
    let first = add(&mut rig, block(10, 20));
    let second = add(&mut rig, block(15, 30));
    rig.tick_at(probe);
    rig.tick_at(probe);
    let at = |rig: &mut Rig, x: f64| {
        rig.tick_at(DVec3::new(2.5, 17.5, 17.5));
        rig.tick_at(DVec3::new(x, 17.5, 17.5)).proxy.x
    };
    assert!((at(&mut rig, 18.0) - 10.0).abs() < 1e-6);
    rig.simulation.remove_segment(first).unwrap();
    rig.tick_at(probe);
    assert!((at(&mut rig, 18.0) - 15.0).abs() < 1e-6);

    // an edit of one brick of one segment keeps the bits of the other there
    rig.simulation.undo().unwrap();
    let shared = VoxelBox::new(IVec3::splat(16), IVec3::splat(19));
    rig.simulation.fill_box(second, &shared, false).unwrap();
    for _ in 0..3 {
        rig.tick_at(probe);
    }
    assert!((at(&mut rig, 18.0) - 10.0).abs() < 1e-6);
}

/// Random edits, thresholds, undo and redo under a hand that moves up to 20 voxels a tick: the
/// probe is never in a solid voxel, and in the end touch is the true union again.
#[test]
fn under_random_changes_the_probe_is_never_in_a_solid_voxel() {
    let mut random = Random::new(11);
    let mut rig = rig_with_probe_at(DVec3::splat(-5.0));
    // undo must not take the segments themselves away
    let ids = [(1, 3), (2, 9)].map(|(seed, one_in)| {
        let segment = sponge(DIMENSIONS, seed, one_in);
        rig.simulation
            .add_segment(segment, OBSTACLE, false)
            .unwrap()
    });
    let (mut contacts, mut held, mut device) = (0_u32, 0_u32, DVec3::splat(-5.0));
    for tick in 0..150_000_u64 {
        if tick % 7 == 0 {
            random_change(&mut rig, &ids, &mut random);
        }
        if tick % 10 == 0 {
            held += u32::from(pending(&mut rig) > 0);
        }
        let reach = if random.below(10) == 0 { 20.0 } else { 0.4 };
        device += random.point(-reach, reach);
        device = device.clamp(DVec3::splat(-4.0), DVec3::splat(52.0));
        contacts += u32::from(rig.tick_at(device).contact);
    }
    assert_eq!(rig.violations(), 0);
    // the test means something: the probe touched, and changes had to wait
    assert!(contacts > 10_000, "{contacts}");
    assert!(held > 1_000, "{held}");

    // away from everything, all that waits comes in
    let outside = DVec3::splat(-30.0);
    for _ in 0..200 {
        rig.tick_at(outside);
        rig.simulation.step();
    }
    assert_eq!(pending(&mut rig), 0);
    let obstacles = rig
        .simulation
        .segments()
        .into_iter()
        .filter(|segment| segment.touchable);
    let voxels = rig.simulation.voxels();
    let bits = obstacles.map(|segment| voxels.segment(segment.id).unwrap().occupancy());
    let union = union_of(DIMENSIONS, &bits.collect::<Vec<_>>());
    assert!(rig.servo.solid().difference(&union).is_empty());
}

fn random_change(rig: &mut Rig, ids: &[SegmentId; 2], random: &mut Random) {
    let id = ids[random.below(2) as usize];
    let simulation = &mut rig.simulation;
    match random.below(20) {
        0 => {
            let one_in = 2 + random.below(12);
            let other = sponge(DIMENSIONS, random.below(1000), one_in);
            simulation.replace_segment(id, other, None).unwrap();
        }
        1 => simulation.set_touchable(id, random.below(3) > 0).unwrap(),
        2..=5 => _ = simulation.undo().unwrap(),
        6..=7 => _ = simulation.redo().unwrap(),
        _ => {
            let region = random.voxel_box(DIMENSIONS, 24);
            let solid = random.below(2) == 0;
            simulation.fill_box(id, &region, solid).unwrap();
        }
    }
}
