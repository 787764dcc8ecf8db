//! Nodes from voxels: the lattice has its own spacing, the same along all axes.
//!
//! Nodes stand in the middles of cubes of the spacing, counted from the corner of the grid,
//! wherever the box is; so a box that moves by whole nodes finds the same nodes again. A node
//! belongs to what the voxel around it belongs to at rest; its intensity is trilinear between
//! the middles of the voxels around it, those of other tissue left out.

use std::cell::Cell;

use glam::{DVec3, IVec3};
use palpate_volume::edit::SegmentId;
use palpate_volume::voxels::Voxels;

use super::nodes::NodeMaterial;
use crate::material::{Materials, Region, SegmentMaterial, Treatment};
use crate::voxel_ledger::Ledger;

/// The tissue of a scan at rest.
pub(super) struct RestVoxels<'a> {
    pub voxels: &'a Voxels,
    pub materials: &'a Materials,
    /// What of it the voxels do not show as it is at rest.
    pub ledger: &'a Ledger,
    /// Number of questions asked.
    pub asked: Cell<u64>,
}

impl RestVoxels<'_> {
    /// What a node is made of, counted from the corner of the grid.
    pub fn matter_of_node(&self, spacing: f64, node: IVec3) -> NodeMaterial {
        self.matter_at(node_place(node, spacing))
    }

    /// What stands at a place at rest, mm along the axes of the grid from its corner.
    pub fn matter_at(&self, place: DVec3) -> NodeMaterial {
        self.asked.set(self.asked.get() + 1);
        let point = place / self.voxels.grid().spacing();
        let Some(voxel) = self.voxels.grid().voxel_at(point) else {
            return NodeMaterial::Empty;
        };
        let Some(matter) = self.material_of(voxel) else {
            return NodeMaterial::Empty;
        };
        let value = match matter.law.needs_hounsfield() {
            true => self.value_at(point, matter),
            false => 0.0,
        };
        let solid = matter.law.at(value);
        match self.treatment(matter, voxel) {
            Treatment::Deformable => NodeMaterial::Deformable(solid),
            Treatment::Rigid => NodeMaterial::Rigid(solid),
            Treatment::Empty => NodeMaterial::Empty,
        }
    }

    /// The segment whose tissue is at a place at rest, mm along the axes of the grid from its corner.
    pub fn segment_at(&self, place: DVec3) -> Option<SegmentId> {
        let grid = self.voxels.grid();
        let voxel = grid.voxel_at(place / grid.spacing())?;
        self.material_of(voxel).map(|matter| matter.segment)
    }

    /// What a voxel is made of; where segments overlap, the last counts.
    fn material_of(&self, voxel: IVec3) -> Option<&SegmentMaterial> {
        let mut segments = self.materials.segments.iter().rev();
        segments.find(|matter| self.belongs(voxel, matter))
    }

    fn belongs(&self, voxel: IVec3, matter: &SegmentMaterial) -> bool {
        match self.ledger.changed(voxel) {
            Some(changed) => changed.rest.segments.contains(matter.segment),
            None => {
                let segment = self.voxels.segment(matter.segment);
                segment.is_some_and(|segment| segment.contains(voxel))
            }
        }
    }

    /// The intensity of some tissue at a point [voxels], which lies in a voxel of it.
    fn value_at(&self, point: DVec3, matter: &SegmentMaterial) -> f64 {
        let low = (point - 0.5).floor();
        let share = point - 0.5 - low;
        let (mut sum, mut weight) = (0.0, 0.0);
        for corner in 0..8 {
            let step = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let voxel = low.as_ivec3() + step;
            if !self.belongs(voxel, matter) {
                continue;
            }
            let along = DVec3::select(step.cmpeq(IVec3::ONE), share, 1.0 - share);
            let Some(value) = self.value(voxel) else {
                continue;
            };
            sum += along.element_product() * value;
            weight += along.element_product();
        }
        sum / weight
    }

    /// The intensity of a voxel at rest.
    fn value(&self, voxel: IVec3) -> Option<f64> {
        match self.ledger.changed(voxel) {
            Some(changed) => Some(self.voxels.intensities().physical(changed.rest.stored)),
            None => self.voxels.value(voxel),
        }
    }

    /// How a voxel of a segment takes part.
    fn treatment(&self, matter: &SegmentMaterial, voxel: IVec3) -> Treatment {
        let holds = |region: &Region| match region {
            Region::Whole => true,
            Region::Within(box_of_voxels) => box_of_voxels.contains(voxel),
            Region::Shared(id) => match self.ledger.changed(voxel) {
                Some(changed) => changed.rest.segments.contains(*id),
                None => {
                    let other = self.voxels.segment(*id);
                    other.is_some_and(|other| other.contains(voxel))
                }
            },
            Region::CutAway(mask) => mask.cuts(voxel),
        };
        let mut last_first = matter.regions.iter().rev();
        let found = last_first.find(|(region, _)| holds(region));
        found.map_or(Treatment::default(), |(_, treatment)| *treatment)
    }
}

/// Where a node rests, mm along the axes of the grid from its corner.
pub(super) fn node_place(node: IVec3, spacing: f64) -> DVec3 {
    (node.as_dvec3() + 0.5) * spacing
}

/// The node whose cube holds a point, mm along the axes of the grid from its corner.
pub(super) fn node_near(point: DVec3, spacing: f64) -> IVec3 {
    (point / spacing).floor().as_ivec3()
}
