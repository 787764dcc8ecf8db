//! Regions of deformable segments: which of them are rigid, and how touch follows these.

use palpate_deform::material::{Region, Treatment};
use palpate_volume::edit::SegmentId;
use palpate_volume::voxels::VoxelsError;

use super::Simulation;
use crate::deformable::{Regions, SharedChange, changed_bricks, rigid_mask};
use crate::error::SessionError;
use crate::scene::{Step, TouchChange};

impl Simulation {
    /// Tells how regions of a segment with a material take part: of several that hold a voxel the
    /// last counts, and what is in none is deformable. This changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where there is no such segment, or none that a region is shared with.
    pub fn set_regions(
        &mut self,
        id: SegmentId,
        regions: Vec<(Region, Treatment)>,
    ) -> Result<(), SessionError> {
        let shared = regions.iter().filter_map(|(region, _)| match region {
            Region::Shared(other) => Some(*other),
            Region::Whole | Region::Within(_) | Region::CutAway(_) => None,
        });
        for id in shared.chain([id]) {
            if self.voxels().segment(id).is_none() {
                return Err(VoxelsError::UnknownSegment(id.0).into());
            }
        }
        self.deformation.change_segments().set_regions(id, regions);
        self.follow_regions(&[id]);
        self.segments_version += 1;
        self.publish();
        Ok(())
    }

    /// Has touch follow what is rigid of these segments.
    fn follow_regions(&mut self, ids: &[SegmentId]) {
        for id in ids {
            let regions = self.deformation.matter().regions(*id);
            let rigid = rigid_mask(self.voxels(), regions);
            if self.scene.set_rigid(*id, rigid) {
                self.send_change(&TouchChange::All(vec![*id]));
            }
        }
    }

    /// The same after a change of voxels or segments, with which shared regions go.
    pub(super) fn follow_shared_regions(&mut self) {
        let updates = std::mem::take(&mut self.shared_changes);
        let (mut anew, mut parts) = (Vec::new(), Vec::new());
        for (id, regions) in self.deformation.matter().with_regions() {
            match (self.scene.rigid(id), updates.within(regions)) {
                // one that was removed and came back is known no more
                (None, _) | (_, SharedChange::All) => anew.push(id),
                (Some(mask), SharedChange::Bricks(bricks)) => {
                    parts.push((id, changed_bricks(mask, self.voxels(), regions, &bricks)));
                }
            }
        }
        self.follow_regions(&anew);
        parts.retain(|(_, swaps)| !swaps.is_empty());
        for (id, swaps) in parts {
            self.scene.change_rigid(id, swaps);
            self.send_change(&TouchChange::All(vec![id]));
        }
    }

    /// Takes note of a step that was performed, told by its inverse: regions may be shared with
    /// what it changed.
    pub(super) fn note_shared(&mut self, inverse: &Step) {
        let matter = self.deformation.matter();
        self.shared_changes.note(inverse, |id| matter.is_shared(id));
    }

    /// How regions of a segment take part.
    #[must_use]
    pub fn regions(&self, id: SegmentId) -> &Regions {
        self.deformation.matter().regions(id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    use crate::deformable::{Deformation, SharedRegionChanges};
    use crate::picture::{PictureEnds, SimulationStatus};
    use crate::scene::{MaskFractions, Properties, Scene};
    use crate::servo::Channels;
    use crate::simulation::SimulationParts;
    use crate::touch::Settings;
    use glam::{DMat3, DVec3, IVec3, UVec3};
    use oorandom::Rand64;
    use palpate_deform::material::preset;
    use palpate_deform::registry::ModelOptions;
    use palpate_device::DeviceLimits;
    use palpate_volume::grid::Grid;
    use palpate_volume::intensities::Intensities;
    use palpate_volume::segment::Segment;
    use palpate_volume::voxel_box::VoxelBox;
    use palpate_volume::voxels::Voxels;

    const SKIN_ID: SegmentId = SegmentId(1);
    const SOFT_ID: SegmentId = SegmentId(2);
    const BONE_ID: SegmentId = SegmentId(3);
    const DIMENSIONS: UVec3 = UVec3::new(40, 40, 36);
    const LIMITS: DeviceLimits = DeviceLimits {
        max_force: 10.0,
        max_continuous_force: 10.0,
        max_stiffness: 1.0,
        damping: 0.0,
        workspace_radius: 1000.0,
    };

    /// Skin on soft tissue on bone, whose top has bumps; bone reaches the top along one side.
    fn segment_at(voxel: IVec3) -> Option<SegmentId> {
        let place = voxel.as_dvec3() + 0.5;
        let waves = 0.35 * place;
        match place.z {
            z if z < 12.0 + waves.x.sin() + waves.y.sin() || (place.x < 14.0 && z < 26.0) => {
                Some(BONE_ID)
            }
            z if z < 24.0 => Some(SOFT_ID),
            z if z < 26.0 => Some(SKIN_ID),
            _ => None,
        }
    }

    /// Soft tissue that is rigid where bone is, and in a corner, but not where skin is.
    fn simulation() -> Simulation {
        let voxels = VoxelBox::of_dimensions(DIMENSIONS).voxels();
        let values = voxels.map(|voxel| segment_at(voxel).map_or(0, |id| 100 * id.0 as i16));
        let scan = Intensities::new(DIMENSIONS, values.collect::<Vec<_>>(), 1.0, 0.0).unwrap();
        let grid = Grid::new(DIMENSIONS, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).unwrap();
        let scene = Scene::new(Voxels::new(grid, scan).unwrap());
        let (status, _) = triple_buffer::triple_buffer(&SimulationStatus::default());
        let mut simulation = Simulation::new(
            SimulationParts {
                scene,
                deformation: Deformation::new(true).0,
                fractions: MaskFractions::new().0,
            },
            Settings::default(),
            LIMITS,
            Channels::new(DVec3::new(20.0, 20.0, 30.0)).simulation,
            PictureEnds {
                status,
                notices: mpsc::channel().0,
                updates: mpsc::channel().0,
            },
        );
        for id in [SKIN_ID, SOFT_ID, BONE_ID] {
            let segment = Segment::from_fn(DIMENSIONS, |voxel| segment_at(voxel) == Some(id));
            let properties = Properties::of_threshold(true, None);
            simulation.add_segment(segment, properties, false).unwrap();
        }
        for (id, name) in [(SKIN_ID, "skin"), (SOFT_ID, "liver")] {
            let law = preset(name).and_then(|preset| preset.law()).unwrap();
            simulation.set_material(id, Some(law), false).unwrap();
        }
        simulation
            .set_deformation(Some("lattice"), &ModelOptions::default(), false)
            .unwrap();
        let corner = VoxelBox::new(IVec3::ZERO, IVec3::new(13, 11, 7));
        let regions = vec![
            (Region::Shared(BONE_ID), Treatment::Rigid),
            (Region::Within(corner), Treatment::Rigid),
            (Region::Shared(SKIN_ID), Treatment::Deformable),
        ];
        simulation.set_regions(SOFT_ID, regions).unwrap();
        simulation
    }

    /// A voxel anywhere in a grid.
    fn somewhere(random: &mut Rand64, dimensions: UVec3) -> IVec3 {
        dimensions
            .map(|count| random.rand_range(0..u64::from(count)) as u32)
            .as_ivec3()
    }

    /// The mask that is kept is the one that is worked out as a whole.
    fn check(simulation: &Simulation) -> u32 {
        let whole = rigid_mask(simulation.voxels(), simulation.regions(SOFT_ID)).unwrap();
        let kept = simulation.scene.rigid(SOFT_ID).unwrap();
        assert!(kept.difference(&whole).is_empty());
        let bricks = whole.bricks().entries().iter().flatten();
        bricks.map(|brick| brick.count()).sum()
    }

    fn paint(simulation: &mut Simulation, id: SegmentId, region: &VoxelBox, solid: bool) {
        let voxels = simulation.voxels();
        let edit = voxels.label_edit(id, region, |_, _| solid).unwrap();
        simulation.change(Step::of_edit(edit)).unwrap();
    }

    #[test]
    fn a_mask_that_follows_edits_is_the_one_worked_out_anew() {
        let mut simulation = simulation();
        let first = check(&simulation);
        let mut random = Rand64::new(5);
        let (mut counts, mut way_back) = (vec![first], 0);
        for number in 0..60 {
            let low = somewhere(&mut random, DIMENSIONS);
            let region = VoxelBox::new(low, low + 1 + number % 9);
            let id = [BONE_ID, SKIN_ID, SOFT_ID][number as usize % 3];
            let region = region.intersect(&simulation.voxels().grid().bounds());
            paint(&mut simulation, id, &region, number % 4 < 2);
            counts.push(check(&simulation));
            if number % 5 == 4 {
                assert!(simulation.undo().unwrap());
                check(&simulation);
                way_back += 1;
            }
        }
        counts.dedup();
        assert!(counts.len() > 12 && way_back == 12, "{counts:?}");
        while simulation.undo().unwrap() {
            check(&simulation);
        }
        assert_eq!(check(&simulation), first);
        // whole segments go, and come back
        simulation.remove_segment(BONE_ID).unwrap();
        assert!(check(&simulation) < first / 2);
        simulation.undo().unwrap();
        assert_eq!(check(&simulation), first);
        let none = Segment::from_fn(simulation.voxels().grid().dimensions(), |_| false);
        simulation.replace_segment(BONE_ID, none, None).unwrap();
        assert!(check(&simulation) < first / 2);
    }

    #[test]
    fn an_edit_of_a_shared_segment_asks_for_its_own_bricks_only() {
        let mut simulation = simulation();
        let voxel = VoxelBox::of_voxel(IVec3::new(20, 20, 20));
        let bricks = |simulation: &Simulation, id| {
            let edit = simulation.voxels().label_edit(id, &voxel, |_, was| !was);
            let mut updates = SharedRegionChanges::default();
            updates.note(&Step::of_edit(edit.unwrap()), |id| {
                simulation.deformation.matter().is_shared(id)
            });
            match updates.within(simulation.regions(SOFT_ID)) {
                SharedChange::Bricks(bricks) => bricks.len(),
                SharedChange::All => panic!("of one voxel"),
            }
        };
        assert_eq!(bricks(&simulation, BONE_ID), 1);
        assert_eq!(bricks(&simulation, SOFT_ID), 0);
        // nothing is left of what was looked at
        paint(&mut simulation, BONE_ID, &voxel, true);
        assert_eq!(simulation.shared_changes, SharedRegionChanges::default());
    }
}
