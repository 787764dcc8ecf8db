//! A needle in soft tissue: the tissue is seen to go with it, and nothing else follows that.

use glam::DVec3;
use palpate_deform::material::MaterialLaw;
use palpate_deform::registry::ModelOptions;
use palpate_engine::servo::TickRecord;
use palpate_haptics::needle::events::EventKind::{Punctured, Withdrawn};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::tissue::Tissue;

use super::soft_block::{SIZE, SOFT, TOP, go as press, lattice_rig, soft_voxels};
use crate::common::{OBSTACLE, Rig, box_segment};

/// Where the hand begins and how deep it goes [mm].
const ABOVE: f64 = TOP + 4.0;
const DEEP: f64 = TOP - 12.0;

fn needle() -> ToolSettings {
    ToolSettings {
        tissues: vec![Tissue::LIVER],
        ..ToolSettings::new(ToolKind::Needle, 0.5, vec![SOFT])
    }
}

/// A needle above a block that is of liver to it, and soft to a model where one is named.
struct Hand {
    rig: Rig,
    ticks: u64,
}

impl Hand {
    fn new(model: Option<&str>) -> Self {
        let mut rig = Rig::new(SIZE, DVec3::new(20.2, 20.3, ABOVE));
        let soft = box_segment(
            SIZE,
            glam::IVec3::ZERO,
            glam::IVec3::new(40, 40, TOP as i32),
        );
        rig.simulation.add_segment(soft, OBSTACLE, true).unwrap();
        let liver = palpate_deform::material::preset("liver").unwrap();
        let law: MaterialLaw = liver.law().unwrap();
        rig.simulation.set_material(SOFT, Some(law), false).unwrap();
        rig.simulation
            .set_deformation(model, &ModelOptions::default(), false)
            .unwrap();
        rig.simulation.set_tool(Some(needle())).unwrap();
        rig.simulation.stroke(true).unwrap();
        Self { rig, ticks: 0 }
    }

    fn tick(&mut self, z: f64) -> TickRecord {
        let record = self.rig.tick_at(DVec3::new(20.2, 20.3, z));
        self.ticks += 1;
        if self.ticks.is_multiple_of(10) {
            self.rig.simulation.step();
            self.rig.deformation.step();
        }
        record
    }

    /// On a line, 20 mm/s.
    fn go(&mut self, from: f64, to: f64, mut each: impl FnMut(&Self, TickRecord)) {
        let ticks = ((to - from).abs() / 0.02).round() as u32;
        for tick in 1..=ticks {
            let share = f64::from(tick) / f64::from(ticks);
            let record = self.tick(from + share * (to - from));
            each(self, record);
        }
    }

    /// The farthest that tissue is seen to have gone down [mm].
    fn seen(&self) -> f64 {
        let shown = self.rig.simulation.displacements();
        let moved = shown.iter().flat_map(|shown| shown.moved.iter());
        moved.fold(0.0, |most, moved| f64::max(most, (-moved.z).into()))
    }

    fn events(&self, kind: palpate_haptics::needle::events::EventKind) -> usize {
        let report = self.rig.simulation.needle_report();
        report
            .events
            .iter()
            .filter(|event| event.kind == kind)
            .count()
    }
}

/// What the hand feels on the way in and out, to the bit.
fn felt(model: Option<&str>) -> (Vec<[u64; 3]>, Hand) {
    let mut hand = Hand::new(model);
    let mut all = Vec::new();
    let mut note = |_: &Hand, record: TickRecord| {
        all.push(record.force.to_array().map(f64::to_bits));
    };
    hand.go(ABOVE, DEEP, &mut note);
    hand.go(DEEP, ABOVE, &mut note);
    (all, hand)
}

#[test]
fn tissue_dimples_until_the_puncture_and_comes_back_after_it() {
    let mut hand = Hand::new(Some("lattice"));
    let (mut before, mut after) = (Vec::new(), Vec::new());
    hand.go(ABOVE, DEEP, |hand, _| {
        if hand.events(Punctured) == 0 {
            before.push(hand.seen());
        } else {
            after.push(hand.seen());
        }
    });
    // liver is pressed in by 4.7 mm at its puncture force, and by 3.4 mm where it is cut
    let most = before.iter().copied().fold(0.0, f64::max);
    assert!((4.0..=4.75).contains(&most), "{most}");
    assert!(before.windows(2).all(|pair| pair[1] >= pair[0] - 0.05));
    let cutting = *after.last().unwrap();
    assert!((2.9..=3.45).contains(&cutting), "{cutting}");
    // the answer after the puncture knows of it
    let lowest = after[..100].iter().copied().fold(most, f64::min);
    assert!(lowest < 0.5, "{lowest}");
    assert!(after[100..].iter().all(|seen| *seen <= cutting + 0.1));

    // drawn back, the shaft alone carries tissue
    hand.go(DEEP, DEEP + 6.0, |_, _| {});
    let shown = hand.rig.simulation.displacements();
    let up = shown[0].moved.iter().map(|moved| f64::from(moved.z));
    let up = up.fold(0.0, f64::max);
    assert!((0.15..=0.21).contains(&up) && hand.seen() < 0.1, "{up}");
    hand.go(DEEP + 6.0, ABOVE, |_, _| {});
    assert_eq!(hand.events(Withdrawn), 1);
    assert!(hand.rig.simulation.displacements().is_empty());
    assert_eq!(hand.rig.violations(), 0);
}

#[test]
fn what_is_felt_is_the_same_to_the_bit_without_a_model() {
    let (hard, _) = felt(None);
    for model in ["lattice", "fcc-lj"] {
        let (soft, hand) = felt(Some(model));
        assert!(soft == hard, "{model}");
        assert_eq!(hand.events(Punctured), 1);
    }
}

#[test]
fn no_voxel_and_no_step_of_undo_knows_of_it() {
    let mut hand = Hand::new(Some("lattice"));
    let edits = hand.rig.simulation.voxels().edit_number();
    let undo = hand.rig.simulation.undo_bytes();
    let voxels = soft_voxels(&hand.rig);
    let mut was_seen = false;
    let mut look = |hand: &Hand, _| {
        was_seen |= hand.seen() > 1.0;
        assert_eq!(hand.rig.simulation.voxels().edit_number(), edits);
    };
    hand.go(ABOVE, DEEP, &mut look);
    hand.go(DEEP, ABOVE, &mut look);
    assert!(was_seen);
    hand.rig.simulation.stroke(false).unwrap();
    hand.rig.simulation.step();
    assert_eq!(hand.rig.simulation.undo_bytes(), undo);
    assert_eq!(soft_voxels(&hand.rig), voxels);
    // the newest change is still the segment's
    assert!(hand.rig.simulation.undo().unwrap());
    assert!(hand.rig.simulation.voxels().segment(SegmentId(1)).is_none());
}

#[test]
fn where_nothing_is_soft_nothing_moves() {
    for hard in [true, false] {
        let mut hand = Hand::new((!hard).then_some("lattice"));
        hand.rig.simulation.set_material(SOFT, None, false).unwrap();
        hand.go(ABOVE, DEEP, |hand, _| {
            assert!(hand.rig.simulation.displacements().is_empty());
        });
    }
}

#[test]
fn a_needle_that_is_put_away_lets_tissue_go_bit_by_bit_and_a_probe_presses_again() {
    let mut hand = Hand::new(Some("lattice"));
    hand.go(ABOVE, TOP - 3.0, |_, _| {});
    let first = hand.seen();
    assert!(first > 1.5, "{first}");
    let mut last = first;
    hand.rig.simulation.stroke(false).unwrap();
    let answers = hand.rig.simulation.deformation().answers;
    let mut steps = 0;
    while hand.rig.simulation.deformation().answers == answers && steps < 40 {
        for _ in 0..10 {
            hand.tick(TOP - 3.0);
        }
        let now = hand.seen();
        // the last press may be on its way yet
        assert!(last - now < 0.7 * first, "{now} after {last}");
        assert!(now <= last + 0.2 || steps > 1, "{now} after {last}");
        (last, steps) = (now, steps + 1);
    }
    assert!((5..40).contains(&steps), "{steps}");
}

#[test]
fn of_a_model_that_was_late_nothing_is_told_while_a_needle_is_in_the_hand() {
    let mut rig = lattice_rig();
    press(&mut rig, 30.0, 19.0, 1200);
    for tick in 0..500 {
        rig.tick_at(DVec3::new(20.2, 20.3, 19.0));
        // the model does not answer any more
        if tick % 10 == 9 {
            rig.simulation.step();
        }
    }
    let before = rig.simulation.deformation();
    assert!(before.late && before.force.length() > 0.0, "{before:?}");
    rig.simulation.set_tool(Some(needle())).unwrap();
    rig.simulation.stroke(true).unwrap();
    for _ in 0..20 {
        rig.tick_at(DVec3::new(20.2, 20.3, 19.0));
        rig.simulation.step();
    }
    let now = rig.simulation.deformation();
    assert!(!now.late && now.force == DVec3::ZERO, "{now:?}");
}

#[test]
fn tissue_that_a_probe_pressed_before_comes_to_rest_as_ever() {
    let mut rig = lattice_rig();
    let all = soft_voxels(&rig);
    press(&mut rig, 30.0, 19.0, 1200);
    assert!(soft_voxels(&rig) < all);
    rig.simulation.set_tool(Some(needle())).unwrap();
    rig.simulation.stroke(true).unwrap();
    press(&mut rig, 19.0, 26.0, 600);
    assert!(rig.simulation.displacements().is_empty());
    rig.simulation.stroke(false).unwrap();
    press(&mut rig, 26.0, 30.0, 600);
    assert_eq!(soft_voxels(&rig), all);
    assert_eq!(rig.violations(), 0);
}
