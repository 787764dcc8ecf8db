//! The coarse lattice of a segment: its nodes, and the springs that hold it where it rests.
//!
//! Frame: mm along the axes of the grid, from its corner; a lattice's own nodes count from its first.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::grid::Grid;

use super::border::{Border, Ground};
use super::coarse::Coarse;
use super::nodes::{Lattice, NodeMaterial};
use super::whole_sites::{MatterAt, Site, touched_area};

/// Fat around a segment that nothing else holds: modulus of the preset [N/mm²] over a thickness [mm],
/// which is assumed.
const BED: f64 = 2e-3 / 20.0;

/// Tissue by coarse nodes, tied to what is rigid.
pub(super) fn coarse_lattice(
    first: IVec3,
    size: UVec3,
    spacing: f64,
    grid: &Grid,
    matter: MatterAt<'_>,
) -> Lattice {
    let made_of = |node: IVec3| {
        let solid = Site::of(first + node, spacing, matter).solid;
        solid.map_or(NodeMaterial::Empty, NodeMaterial::Deformable)
    };
    let load = (size.as_dvec3() - 1.0) * (0.5 * spacing);
    let mut lattice = Lattice::new(size, spacing, Border::Endless { load }, made_of);
    let rigid: Vec<bool> = (0..lattice.layout().len())
        .map(|index| lattice.layout().node_at(index))
        .map(|node| node.is_some_and(|n| Site::of(first + n.as_ivec3(), spacing, matter).has_rigid))
        .collect();
    let has_node = |node: IVec3| lattice.has_matter(node - first);
    let mut ties = Vec::new();
    for index in lattice.matter_nodes() {
        let (Some(node), Some(solid)) = (
            lattice.layout().node_at(index),
            lattice.matter(index).solid(),
        ) else {
            continue;
        };
        let node = node.as_ivec3();
        let is_near = around(node).any(|node| {
            lattice
                .layout()
                .index_of(node)
                .is_some_and(|index| rigid[index])
        });
        if !is_near {
            continue;
        }
        let area = touched_area(
            (first + node, spacing),
            grid.smallest_spacing(),
            &has_node,
            matter,
        );
        if area > 0.0 {
            ties.push(spring(index, 2.0 * solid.young * area / spacing));
        }
    }
    lattice.ground.extend(ties);
    lattice
}

/// Ties the whole surface to fat around it.
pub(super) fn lay_in_fat(body: &mut Lattice) {
    let layout = *body.layout();
    let mut springs = Vec::new();
    for index in body.matter_nodes() {
        let node = layout.node_at(index).unwrap_or_default().as_ivec3();
        let beside = IVec3::AXES
            .into_iter()
            .flat_map(|axis| [node + axis, node - axis]);
        let faces = beside.filter(|node| !body.has_matter(*node)).count();
        if faces > 0 {
            springs.push(spring(index, BED * faces as f64 * body.spacing().powi(2)));
        }
    }
    body.ground.extend(springs);
}

/// A spring to where a node rests, the same along all axes [N/mm].
fn spring(node: usize, stiffness: f64) -> Ground {
    Ground {
        node: node as u32,
        stiffness: DMat3::IDENTITY * stiffness,
        led: DVec3::ZERO,
    }
}

/// Works out what follows from the springs of a lattice.
pub(super) fn settle(lattice: &mut Lattice) {
    lattice.settle_structure();
    let load = (lattice.layout().size().as_dvec3() - 1.0) * (0.5 * lattice.spacing());
    lattice.coarse = Some(Coarse::new(lattice, load));
}

/// A node and its 26 neighbours.
pub(super) fn around(node: IVec3) -> impl Iterator<Item = IVec3> {
    (0..27).map(move |n| node + IVec3::new(n % 3, n / 3 % 3, n / 9) - 1)
}
