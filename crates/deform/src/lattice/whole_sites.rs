//! What the nodes of a coarse lattice hold: tissue by how much of it is there, and what holds it.
//!
//! A coarse node stands for a cube of its spacing. It is asked at 2³ places of it: the modulus is that
//! of tissue as far as there is any (fictitious domain: Parvizian, Düster & Rank, Computational
//! Mechanics 41, 2007). What is rigid is no node: tissue that touches it is tied to it by a spring for
//! the half cube between, E / (h / 2) for the area of touch.
//!
//! Frame: mm along the axes of the grid, from its corner.

use glam::{DVec3, IVec3};

use super::nodes::NodeMaterial;
use super::resample::{node_near, node_place};
use crate::material::Solid;

/// Parts of a cube along each axis where only its content is asked for, and where touch is.
const PARTS: i32 = 2;
const TOUCHED_PARTS: i32 = 4;

/// What is at a place at rest.
pub(super) type MatterAt<'a> = &'a dyn Fn(DVec3) -> NodeMaterial;

/// The content of a cube.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Site {
    /// Tissue that gives, its modulus by how much of the cube it fills.
    pub solid: Option<Solid>,
    /// Whether anything in it is rigid.
    pub has_rigid: bool,
}

impl Site {
    /// Of a node of a lattice of this spacing, counted from the corner of the grid.
    pub fn of(node: IVec3, spacing: f64, matter: MatterAt<'_>) -> Self {
        let mut site = Self::default();
        let mut young = 0.0;
        for place in parts(node, spacing, PARTS) {
            match matter(place) {
                NodeMaterial::Empty => {}
                NodeMaterial::Rigid(_) => site.has_rigid = true,
                NodeMaterial::Deformable(solid) => {
                    young += solid.young;
                    site.solid = Some(solid);
                }
            }
        }
        let young = young / f64::from(PARTS.pow(3));
        // far from the tool strains are small
        site.solid = site.solid.map(|solid| Solid {
            young,
            stiffening: 0.0,
            ..solid
        });
        site
    }
}

/// Places of tissue in a cube, by which its contacts are found.
pub(super) fn tissue_in(
    node: IVec3,
    spacing: f64,
    matter: MatterAt<'_>,
) -> impl Iterator<Item = DVec3> {
    parts(node, spacing, PARTS)
        .filter(move |place| matches!(matter(*place), NodeMaterial::Deformable(_)))
}

/// Area over which the tissue of a cube touches what is rigid [mm²]; `step` [mm] is the smallest side
/// of a voxel. Tissue beyond the cube counts with it where it is too little for a node of its own.
pub(super) fn touched_area(
    (node, spacing): (IVec3, f64),
    step: f64,
    has_node: &dyn Fn(IVec3) -> bool,
    matter: MatterAt<'_>,
) -> f64 {
    let part = spacing / f64::from(TOUCHED_PARTS);
    let steps = (0.5 * spacing / step).ceil().max(2.0);
    let touches = |place: DVec3, along: DVec3| {
        for n in 1..=steps as u32 {
            let way = 0.5 * spacing * f64::from(n) / steps;
            let there = place + along * way;
            let cube = node_near(there, spacing);
            let is_far = cube == node && way > part + 1e-9;
            if is_far || (cube != node && has_node(cube)) {
                return false;
            }
            match matter(there) {
                NodeMaterial::Deformable(_) => {}
                NodeMaterial::Rigid(_) => return true,
                NodeMaterial::Empty => return false,
            }
        }
        false
    };
    let mut faces = 0;
    for place in parts(node, spacing, TOUCHED_PARTS) {
        if matches!(matter(place), NodeMaterial::Deformable(_)) {
            let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
            faces += axes.filter(|axis| touches(place, *axis)).count();
        }
    }
    faces as f64 * part * part
}

/// The middles of the parts of a cube.
fn parts(node: IVec3, spacing: f64, count: i32) -> impl Iterator<Item = DVec3> {
    let part = spacing / f64::from(count);
    (0..count.pow(3)).map(move |n| {
        let step = IVec3::new(n % count, n / count % count, n / count / count);
        node_place(node * count + step, part)
    })
}
