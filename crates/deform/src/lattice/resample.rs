//! Nodes from voxels: the lattice has its own spacing, the same along all axes.
//!
//! Nodes stand in the middles of cubes of the spacing, counted from the corner of the grid,
//! wherever the box is; so a box that moves by whole nodes finds the same nodes again. A node is made of what
//! the voxel around it is made of.

use glam::{DVec3, IVec3};
use palpate_volume::voxels::Voxels;

use super::nodes::NodeMatter;
use crate::material::{Materials, Part, SegmentMatter, Treatment};

/// What the node `node` is made of, counted from the corner of the grid.
pub(super) fn matter_of_node(
    voxels: &Voxels,
    materials: &Materials,
    spacing: f64,
    node: IVec3,
) -> NodeMatter {
    let grid = voxels.grid();
    let point = node_place(node, spacing) / grid.spacing();
    let Some(voxel) = grid.voxel_at(point) else {
        return NodeMatter::Empty;
    };
    let holds = |matter: &&SegmentMatter| {
        let segment = voxels.segment(matter.segment);
        segment.is_some_and(|segment| segment.contains(voxel))
    };
    // where segments overlap, the last counts
    let Some(matter) = materials.segments.iter().rev().find(holds) else {
        return NodeMatter::Empty;
    };
    let solid = matter.law.at(voxels.value(voxel).unwrap_or(f64::NAN));
    match treatment(voxels, matter, voxel) {
        Treatment::Deformable => NodeMatter::Deformable(solid),
        Treatment::Rigid => NodeMatter::Rigid(solid),
        Treatment::Empty => NodeMatter::Empty,
    }
}

/// How the part of a segment that a voxel belongs to takes part.
fn treatment(voxels: &Voxels, matter: &SegmentMatter, voxel: IVec3) -> Treatment {
    let holds = |part: &Part| match part {
        Part::Whole => true,
        Part::Within(region) => region.contains(voxel),
        Part::Shared(id) => voxels
            .segment(*id)
            .is_some_and(|other| other.contains(voxel)),
    };
    let treatments = matter.treatments.iter().rev();
    let found = treatments.into_iter().find(|(part, _)| holds(part));
    found.map_or(Treatment::default(), |(_, treatment)| *treatment)
}

/// Where a node rests, mm along the axes of the grid from its corner.
pub(super) fn node_place(node: IVec3, spacing: f64) -> DVec3 {
    (node.as_dvec3() + 0.5) * spacing
}

/// The node whose cube holds a point, mm along the axes of the grid from its corner.
pub(super) fn node_near(point: DVec3, spacing: f64) -> IVec3 {
    (point / spacing).floor().as_ivec3()
}
