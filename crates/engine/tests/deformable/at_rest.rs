//! What is pressed is not changed: files, journal and undo hold tissue as it is at rest.

use crate::place::Place;
use glam::{DVec3, IVec3};
use palpate_deform::registry::ModelOptions;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::journal::ScanHash;
use palpate_tools::specific_energy::SpecificEnergy;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use super::soft_block::{SIZE, SOFT, go, lattice_rig, soft_voxels};
use crate::common::{OBSTACLE, Rig, box_segment};

const HASH: ScanHash = ScanHash([7; 32]);

/// Presses the block by 3 mm, and stays there.
fn press(rig: &mut Rig) {
    go(rig, 30.0, 20.0, 1200);
    go(rig, 20.0, 20.0, 200);
}

/// Lets go of it until nothing moves any more.
fn release(rig: &mut Rig) {
    go(rig, 20.0, 30.0, 600);
    go(rig, 30.0, 30.0, 300);
    assert_eq!(rig.simulation.deformation().report.moved_voxels, 0);
}

/// Bits of the block, and the stored values beside them.
fn state(voxels: &Voxels) -> (Vec<u8>, Vec<i16>) {
    let mask = voxels.segment(SOFT).unwrap().mask();
    (mask, voxels.stored_in(&voxels.grid().bounds()))
}

fn recovered(place: &Place) -> Rig {
    let mut rig = Rig::new(SIZE, DVec3::new(20.0, 20.0, 30.0));
    rig.simulation.recover_journal(&place.0, HASH).unwrap();
    rig
}

#[test]
fn what_is_saved_while_it_is_pressed_comes_back_unpressed() {
    let mut rig = lattice_rig();
    let at_rest = state(rig.simulation.voxels());
    let (journal, file) = (Place::new("pressed-journal"), Place::new("pressed-file"));
    rig.simulation.begin_journal(&journal.0, HASH).unwrap();
    press(&mut rig);
    assert_ne!(state(rig.simulation.voxels()), at_rest);
    rig.simulation.keep_state(&file.0, HASH).unwrap();
    // a crash in the middle
    drop(rig);
    for place in [journal, file] {
        let rig = recovered(&place);
        assert!(state(rig.simulation.voxels()) == at_rest);
    }
}

#[test]
fn after_release_undo_brings_no_dent_back_whatever_was_done_in_between() {
    let mut rig = lattice_rig();
    let at_rest = state(rig.simulation.voxels());
    press(&mut rig);
    let other = box_segment(SIZE, IVec3::ZERO, IVec3::splat(4));
    let added = rig.simulation.add_segment(other, OBSTACLE, true).unwrap();
    go(&mut rig, 20.0, 20.0, 100);
    release(&mut rig);
    assert!(state(rig.simulation.voxels()) == at_rest);
    // the newest step is the segment, with no dent before or after it
    assert!(rig.simulation.undo().unwrap());
    assert!(rig.simulation.voxels().segment(added).is_none());
    assert!(state(rig.simulation.voxels()) == at_rest);
    assert!(rig.simulation.redo().unwrap());
    assert!(rig.simulation.voxels().segment(added).is_some());
    assert!(state(rig.simulation.voxels()) == at_rest);
}

#[test]
fn undo_and_redo_of_a_change_while_tissue_is_pressed_change_nothing_else() {
    let mut rig = lattice_rig();
    let region = VoxelBox::new(IVec3::new(0, 0, 0), IVec3::new(4, 4, 4));
    rig.simulation.fill_box(SOFT, &region, false).unwrap();
    let cut = state(rig.simulation.voxels());
    press(&mut rig);
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(soft_voxels(&rig), 40 * 40 * 20);
    assert!(rig.simulation.redo().unwrap());
    assert!(state(rig.simulation.voxels()) == cut);
    // it is pressed anew where the tool still is
    go(&mut rig, 20.0, 20.0, 200);
    assert!(rig.simulation.deformation().report.moved_voxels > 0);
    release(&mut rig);
    assert!(state(rig.simulation.voxels()) == cut);
}

#[test]
fn of_a_stroke_on_pressed_tissue_only_the_cut_stays_and_is_one_step() {
    let mut rig = lattice_rig();
    let at_rest = state(rig.simulation.voxels());
    let journal = Place::new("pressed-stroke");
    rig.simulation.begin_journal(&journal.0, HASH).unwrap();
    press(&mut rig);
    let mut drill = ToolSettings::new(ToolKind::Drill, 3.0, vec![SOFT]);
    // some voxels for each newton in each pass
    drill.drill.specific_energy = SpecificEnergy::Everywhere(1.0);
    rig.simulation.set_tool(Some(drill)).unwrap();
    rig.simulation.stroke(true).unwrap();
    for _ in 0..30 {
        rig.pass(DVec3::new(20.2, 20.3, 20.0), 1.0);
        rig.deformation.step();
    }
    assert!(rig.simulation.tool_report().voxels > 0);
    rig.simulation.stroke(false).unwrap();
    go(&mut rig, 19.0, 19.0, 100);
    go(&mut rig, 19.0, 30.0, 600);
    go(&mut rig, 30.0, 30.0, 300);
    let cut = state(rig.simulation.voxels());
    assert!(cut != at_rest);
    // gone is what the drill took, and nothing comes from elsewhere
    let gained = |(now, before): (&u8, &u8)| now > before;
    assert!(!cut.0.iter().zip(&at_rest.0).any(gained));
    assert!(rig.simulation.undo().unwrap());
    assert!(state(rig.simulation.voxels()) == at_rest);
    assert!(rig.simulation.redo().unwrap());
    assert!(state(rig.simulation.voxels()) == cut);
    assert!(rig.simulation.undo().unwrap());
    drop(rig);
    let mut rig = recovered(&journal);
    assert!(state(rig.simulation.voxels()) == at_rest);
    assert!(rig.simulation.redo().unwrap());
    assert!(state(rig.simulation.voxels()) == cut);
}

#[test]
fn what_has_yielded_stays_in_files_and_is_one_step_of_undo() {
    let mut rig = lattice_rig();
    let yields = ModelOptions {
        yield_strain: Some(0.05),
        ..ModelOptions::default()
    };
    rig.simulation
        .set_deformation(Some("lattice"), &yields, false)
        .unwrap();
    let at_rest = state(rig.simulation.voxels());
    let (journal, file) = (Place::new("yielded-journal"), Place::new("yielded-file"));
    rig.simulation.begin_journal(&journal.0, HASH).unwrap();
    press(&mut rig);
    go(&mut rig, 20.0, 30.0, 600);
    go(&mut rig, 30.0, 30.0, 500);
    let report = rig.simulation.deformation().report;
    assert!(
        report.plastic_voxels > 0 && !report.comes_back(),
        "{report:?}"
    );
    let yielded = state(rig.simulation.voxels());
    assert!(yielded != at_rest);
    rig.simulation.keep_state(&file.0, HASH).unwrap();
    assert!(rig.simulation.undo().unwrap());
    assert!(state(rig.simulation.voxels()) == at_rest);
    assert!(rig.simulation.redo().unwrap());
    drop(rig);
    for place in [journal, file] {
        let rig = recovered(&place);
        assert!(state(rig.simulation.voxels()) == yielded);
    }
}

/// Particles of the thesis that stay where a ball has pushed them (5.28.3).
#[test]
fn what_was_rearranged_stays_in_files_and_is_one_step_of_undo() {
    let mut rig = lattice_rig();
    let rearranges = ModelOptions {
        edge: Some(17),
        rearranges: true,
        ..ModelOptions::default()
    };
    rig.simulation
        .set_deformation(Some("fcc-lj"), &rearranges, false)
        .unwrap();
    let at_rest = state(rig.simulation.voxels());
    let all = soft_voxels(&rig);
    let (journal, file) = (
        Place::new("rearranged-journal"),
        Place::new("rearranged-file"),
    );
    rig.simulation.begin_journal(&journal.0, HASH).unwrap();
    press(&mut rig);
    go(&mut rig, 20.0, 30.0, 600);
    go(&mut rig, 30.0, 30.0, 500);
    let report = rig.simulation.deformation().report;
    assert!(
        report.plastic_voxels > 0 && !report.comes_back(),
        "{report:?}"
    );
    let rearranged = state(rig.simulation.voxels());
    assert!(rearranged != at_rest);
    assert_eq!(soft_voxels(&rig), all);
    rig.simulation.keep_state(&file.0, HASH).unwrap();
    assert!(rig.simulation.undo().unwrap());
    assert!(state(rig.simulation.voxels()) == at_rest);
    assert!(rig.simulation.redo().unwrap());
    drop(rig);
    for place in [journal, file] {
        let rig = recovered(&place);
        assert!(state(rig.simulation.voxels()) == rearranged);
    }
}
