//! A box of nodes in a scan: where it stands, what it is made from, how it follows edits.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::grid::Grid;
use palpate_volume::material::LocalContact;

use super::bond_memory::BondMemory;
use super::border::Border;
use super::inelastic::{Inelastic, InelasticSettings};
use super::nodes::{Lattice, NodeMatter};
use super::resample::{RestVoxels, node_place};
use super::tool_contact::{LatticeTool, ToolForce};
use crate::displacement::Displacement;
use crate::material::Materials;
use crate::model::{ModelParts, ToolState};

/// Half axis of a tool, at least: a thinner one would slip between nodes [spacings].
const THINNEST: f64 = 0.5;

/// How far from the tool's place its contact holds [spacings].
const VALIDITY: f64 = 0.5;

/// Share of the box's half width over which voxels and picture fade to the unmoved body.
const FADING: f64 = 0.4;

/// A box of nodes and where it stands.
#[derive(Debug)]
pub(super) struct MovingBox {
    pub lattice: Lattice,
    pub inelastic: Inelastic,
    /// Its first node, counted from the corner of the grid.
    pub origin: IVec3,
    pub grid: Grid,
    materials: Materials,
}

impl MovingBox {
    /// A box of `nodes` along each edge from `origin` on, at rest.
    pub fn new(
        rest: &RestVoxels<'_>,
        nodes: u32,
        spacing: f64,
        inelastic: InelasticSettings,
        origin: IVec3,
    ) -> Self {
        let matter = |node| rest.matter_of_node(spacing, origin + node);
        let load = DVec3::splat(f64::from(nodes / 2) * spacing);
        let border = Border::Endless { load };
        let mut lattice = Lattice::new(UVec3::splat(nodes), spacing, border, matter);
        Self {
            inelastic: Inelastic::new(&mut lattice, inelastic),
            lattice,
            origin,
            grid: *rest.voxels.grid(),
            materials: rest.materials.clone(),
        }
    }

    /// Whether it is of this scan and these materials.
    pub fn fits(&self, rest: &RestVoxels<'_>) -> bool {
        self.grid == *rest.voxels.grid() && self.materials == *rest.materials
    }

    /// Stands elsewhere: what both places share goes on as it is, and what happened to bonds is
    /// kept in `memory` and taken from there.
    pub fn go(&mut self, rest: &RestVoxels<'_>, origin: IVec3, memory: &mut BondMemory) {
        memory.keep(&self.lattice, &self.inelastic, self.origin);
        let offset = origin - self.origin;
        let spacing = self.lattice.spacing();
        let matter = |node: IVec3| rest.matter_of_node(spacing, origin + node);
        self.origin = origin;
        self.lattice.go(offset, &matter);
        self.inelastic.go(&self.lattice, offset);
        memory.recall(&mut self.lattice, &mut self.inelastic, origin);
    }

    /// Follows what others have changed of the voxels: only what hangs on those is built anew.
    pub fn follow_edits(&mut self, rest: &RestVoxels<'_>) {
        let (origin, spacing) = (self.origin, self.lattice.spacing());
        let made_of = |node: IVec3| rest.matter_of_node(spacing, origin + node);
        let nodes = self.lattice.layout().nodes();
        let changes: Vec<_> = nodes
            .map(|(node, index)| (index, made_of(node.as_ivec3())))
            .filter(|(index, matter)| matter != self.lattice.matter(*index))
            .collect();
        if !changes.is_empty() {
            self.lattice.change(&changes, &made_of);
            self.inelastic.break_again(&mut self.lattice);
        }
    }

    /// A tool in the lattice's frame.
    pub fn tool(&self, tool: &ToolState) -> LatticeTool {
        let first = node_place(self.origin, self.lattice.spacing());
        LatticeTool {
            centre: grid_mm(&self.grid, tool.position) - first,
            half_axes: tool
                .shape
                .half_axes()
                .max(DVec3::splat(THINNEST * self.lattice.spacing())),
            orientation: self.grid.direction().transpose() * DMat3::from_quat(tool.orientation),
        }
    }

    /// What a tool feels, as a linear law: `stiffness` [N/mm] along the force, none across it.
    pub fn contact(
        &self,
        tool: &ToolState,
        felt: &ToolForce,
        stiffness: f64,
    ) -> Option<LocalContact> {
        let force = self.grid.direction() * felt.force;
        let normal = force.try_normalize()?;
        let along = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Some(LocalContact {
            position: tool.position,
            force,
            stiffness: along * -stiffness,
            validity: VALIDITY * self.lattice.spacing(),
        })
    }

    /// A place of the lattice's frame in the patient [mm].
    pub fn patient_place(&self, place: DVec3) -> DVec3 {
        let in_grid = node_place(self.origin, self.lattice.spacing()) + place;
        self.grid
            .patient_from_grid()
            .transform_point3(in_grid / self.grid.spacing())
    }

    /// Its nodes with matter.
    pub fn parts(&self) -> ModelParts {
        let lattice = &self.lattice;
        let places = lattice.matter_nodes().map(|node| {
            [lattice.rest_place(node), lattice.place(node)].map(|place| self.patient_place(place))
        });
        ModelParts {
            places: places.collect(),
            apart: lattice.spacing(),
        }
    }

    /// Whether all nodes stand somewhere.
    pub fn is_finite(&self) -> bool {
        let mut nodes = self.lattice.matter_nodes();
        nodes.all(|node| self.lattice.moved(node).is_finite())
    }

    /// How far matter has moved, less and less toward the border of the box, where the picture
    /// of the body behind it begins.
    pub fn displacement(&self) -> Displacement {
        let layout = self.lattice.layout();
        let middle = 0.5 * (layout.size().as_dvec3() - 1.0);
        let moved = |(node, index): (UVec3, usize)| {
            let out = ((node.as_dvec3() - middle) / middle).abs().max_element();
            let share = ((1.0 - out) / FADING).min(1.0);
            let is_matter = *self.lattice.matter(index) != NodeMatter::Empty;
            is_matter.then(|| self.lattice.moved(index) * (share * share * (3.0 - 2.0 * share)))
        };
        let spacing = self.lattice.spacing();
        Displacement::new(
            node_place(self.origin, spacing),
            spacing,
            layout.size(),
            layout.nodes().map(moved).collect(),
        )
    }
}

/// A point of the patient in mm along the axes of the grid, from its corner.
pub(super) fn grid_mm(grid: &Grid, point: DVec3) -> DVec3 {
    grid.grid_from_patient().transform_point3(point) * grid.spacing()
}
