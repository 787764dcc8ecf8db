//! Where the surface of a coarse body runs against rigid voxels.
//!
//! Frame: mm along the axes of the grid, from its corner.

use glam::{DVec3, IVec3};

use super::nodes::{Lattice, NodeMaterial};
use super::whole_lattice::around;
use super::whole_sites::{MatterAt, Site, tissue_in};

/// How far from a node what is rigid is looked for [spacings].
const LOOKED_FOR: i32 = 3;
/// Least part of a way that is along a normal.
const FACING: f64 = 0.2;

/// A node that does not go on along a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    pub node: usize,
    /// Into what is rigid.
    pub normal: DVec3,
    /// Displacement along the normal at which they touch [mm].
    pub gap: f64,
}

/// A node with rigid voxels near it, and the places of its tissue.
#[derive(Debug)]
pub(super) struct Facing {
    pub node: usize,
    tissue: Vec<DVec3>,
}

impl Facing {
    /// Of all nodes at the surface of a body whose first node is `first`.
    pub fn all(body: &Lattice, first: IVec3, matter: MatterAt<'_>) -> Vec<Self> {
        let (layout, spacing) = (*body.layout(), body.spacing());
        let low = IVec3::splat(-LOOKED_FOR);
        let size = layout.size().as_ivec3() + 2 * LOOKED_FOR;
        let index = |node: IVec3| {
            let IVec3 { x, y, z } = node - low;
            ((z * size.y + y) * size.x + x) as usize
        };
        let mut rigid = vec![false; size.element_product() as usize];
        for z in 0..size.z {
            for y in 0..size.y {
                for x in 0..size.x {
                    let node = low + IVec3::new(x, y, z);
                    rigid[index(node)] = Site::of(first + node, spacing, matter).has_rigid;
                }
            }
        }
        let mut facing = Vec::new();
        for node in body.matter_nodes() {
            let place = layout.node_at(node).unwrap_or_default().as_ivec3();
            let reach = (2 * LOOKED_FOR + 1).pow(3);
            let mut near = (0..reach).map(|n| {
                let side = 2 * LOOKED_FOR + 1;
                place + IVec3::new(n % side, n / side % side, n / side / side) - LOOKED_FOR
            });
            if around(place).all(|node| body.has_matter(node))
                || !near.any(|node| rigid[index(node)])
            {
                continue;
            }
            facing.push(Self {
                node,
                tissue: tissue_in(first + place, spacing, matter).collect(),
            });
        }
        facing
    }

    /// Where its tissue, moved so far [mm], has come into something rigid.
    pub fn meets(
        &self,
        moved: DVec3,
        step: f64,
        spacing: f64,
        matter: MatterAt<'_>,
    ) -> Option<Contact> {
        let way = moved.length();
        if !(way.is_finite() && way > 0.1 * step) {
            return None;
        }
        let steps = (2.0 * way / step).ceil().min(1000.0);
        let is_rigid = |place: DVec3| matches!(matter(place), NodeMaterial::Rigid(_));
        let first = |place: &DVec3| {
            let mut shares = (1..=steps as u32).map(|n| f64::from(n) / steps);
            shares
                .find(|share| is_rigid(*place + moved * *share))
                .map(|share| (share, *place))
        };
        let met = self.tissue.iter().filter_map(first);
        let (share, place) = met.min_by(|one, other| one.0.total_cmp(&other.0))?;
        let free = (share - 1.0 / steps).max(0.0);
        let entry = place + moved * share;
        // toward where most of it is
        let sides = around(IVec3::ZERO).map(|side| side.as_dvec3() * (0.25 * spacing));
        let normal: DVec3 = sides.filter(|side| is_rigid(entry + *side)).sum();
        let along = moved / way;
        let normal = normal
            .try_normalize()
            .filter(|normal| normal.dot(along) > FACING);
        let normal = normal.unwrap_or(along);
        Some(Contact {
            node: self.node,
            normal,
            gap: normal.dot(moved) * free,
        })
    }
}
