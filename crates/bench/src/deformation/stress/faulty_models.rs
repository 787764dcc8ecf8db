//! Models that lie: what is hard pushes back all the same, and where it does not, the watch tells.

use palpate_deform::material::{Region, Treatment, preset};
use palpate_deform::model::DeformationModel;

use super::*;
use air::Air;

#[path = "../../../../engine/tests/common/air.rs"]
mod air;

/// So many ticks: a press into the bone under soft tissue is among them.
const TICKS: u64 = 12_000;

/// Work in a world with that model, whose bone has a material, with regions, or none and is hard.
fn worked(bone: Option<&str>, regions: Vec<(Region, Treatment)>) -> (u64, Result<(), Violation>) {
    let mut random = Random::of_stream(7, 0);
    let world = World::new(0, &mut random);
    let mut rig = world.rig("lattice", &ModelOptions::default()).unwrap();
    let model: Box<dyn DeformationModel> = Box::new(Air);
    rig.simulation.set_deformation_model(Some(("air", model)));
    let law = bone.map(|name| preset(name).and_then(|preset| preset.law()).unwrap());
    rig.simulation.set_material(BONE_ID, law, false).unwrap();
    rig.simulation.set_regions(BONE_ID, regions).unwrap();
    let mut run = Run::new(&world, rig, random);
    let ends = run.work(TICKS);
    (run.monitor.in_bone, ends)
}

#[test]
fn bone_pushes_back_whatever_a_model_says() {
    let (in_bone, ends) = worked(None, Vec::new());
    assert_eq!(ends, Ok(()));
    assert!(in_bone > 100, "{in_bone} ticks in bone");
}

#[test]
fn what_a_region_makes_rigid_pushes_back_too() {
    let all = vec![(Region::Shared(BONE_ID), Treatment::Rigid)];
    let (in_bone, ends) = worked(Some("liver"), all);
    assert_eq!(ends, Ok(()));
    assert!(in_bone > 100, "{in_bone} ticks in bone");
}

/// The fault that is planted: the session takes the bone for soft tissue, the watch does not.
#[test]
fn bone_that_does_not_push_back_is_found() {
    let violation = worked(Some("liver"), Vec::new()).1.unwrap_err();
    assert_eq!(violation.guarantee, Guarantee::HardHolds);
    assert!(violation.what.contains("in bone"), "{violation:?}");
}
