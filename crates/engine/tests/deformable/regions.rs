//! Regions of a segment that are rigid, or are as if they were not there.

use glam::IVec3;
use palpate_deform::material::{Region, Treatment};
use palpate_engine::scene::Properties;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

use super::soft_block::{SIZE, SOFT, go, lattice_rig};
use crate::common::air::Air;
use crate::common::box_segment;

const STONE: SegmentId = SegmentId(2);

/// What a region makes rigid stops the probe also where no answer comes any more, and goes with the
/// segment that it is shared with.
#[test]
fn a_rigid_region_is_hard_whatever_the_model_says() {
    let deepest = |shared: bool, removed: bool| {
        let mut rig = lattice_rig();
        let stone = box_segment(SIZE, IVec3::ZERO, IVec3::new(40, 40, 17));
        rig.simulation
            .add_segment(stone, Properties::default(), true)
            .unwrap();
        let region = if shared {
            Region::Shared(STONE)
        } else {
            Region::Within(VoxelBox::new(IVec3::ZERO, IVec3::new(40, 40, 17)))
        };
        let regions = vec![(region, Treatment::Rigid)];
        rig.simulation.set_regions(SOFT, regions).unwrap();
        if removed {
            let none = Segment::from_fn(SIZE, |_| false);
            rig.simulation.replace_segment(STONE, none, None).unwrap();
        }
        rig.simulation
            .set_deformation_model(Some(("air", Box::new(Air))));
        let rest = go(&mut rig, 30.0, 15.0, 3000);
        assert_eq!(rig.violations(), 0);
        rest.force.z
    };
    // 2 mm above the stone the ball touches it: the spring is as long as it is led deeper
    for (shared, removed) in [(false, false), (true, false)] {
        let force = deepest(shared, removed);
        assert!(force > 1.0, "{force} N, {shared}");
    }
    assert_eq!(deepest(true, true), 0.0);
}

#[test]
fn regions_of_a_segment_can_be_rigid_or_as_if_they_were_not_there() {
    let force = |treatment| {
        let mut rig = lattice_rig();
        let region = Region::Within(VoxelBox::new(IVec3::ZERO, IVec3::new(40, 40, 18)));
        rig.simulation
            .set_regions(SOFT, vec![(region.clone(), treatment)])
            .unwrap();
        assert_eq!(rig.simulation.regions(SOFT), [(region, treatment)]);
        go(&mut rig, 30.0, 21.0, 1000);
        go(&mut rig, 21.0, 21.0, 300);
        rig.simulation.deformation().force.z
    };
    let [soft, rigid, empty] =
        [Treatment::Deformable, Treatment::Rigid, Treatment::Empty].map(force);
    // two layers over what is rigid, as a whole body, and as a skin over nothing
    assert!(
        rigid > 1.3 * soft && soft > 1.3 * empty && empty > 0.0,
        "{rigid} {soft} {empty}"
    );
    let mut rig = lattice_rig();
    let nobody = SegmentId(9);
    assert!(rig.simulation.set_regions(nobody, Vec::new()).is_err());
    let shared = vec![(Region::Shared(nobody), Treatment::Rigid)];
    assert!(rig.simulation.set_regions(SOFT, shared).is_err());
}
