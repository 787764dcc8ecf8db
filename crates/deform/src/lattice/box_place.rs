//! Where the lattice's box stands, and how large it is: around what the first tool presses.
//!
//! The box is a cube. Where the tool presses so deep that the face of the tissue would leave the cube, the box
//! goes on to that face: dragged along and stretched there, tissue holds the tool as well, and a border in its
//! place would hold the tissue as if nothing had moved it.

use glam::{DVec3, IVec3, UVec3};

use super::lattice_model::{AT_REST, LatticeModel};
use super::moving_box::{MovingBox, grid_mm};
use super::nodes::NodeMaterial;
use super::relax::Relaxer;
use super::resample::{RestVoxels, node_near};
use crate::model::{Budget, ModelInput, ModelReport, ToolState};

/// How far the middle of the box may be from where it is to be before the box follows, in parts of its edge.
const LEASH: f64 = 0.1;
/// How far from the tool's middle toward the tissue the middle of the box is to be, in parts of the tool's
/// smallest half axis, and at most, in parts of half the box: with the tool's middle in its own, a part of
/// it would be empty, and the load that its border stands for outside of the tissue.
const AHEAD: f64 = 0.85;
const FARTHEST_AHEAD: f64 = 0.4;
/// Nodes along each edge at least: fewer hold no contact.
const FEWEST: u32 = 5;
/// How far beyond its cube the box goes on at most to the face of the tissue, beside what it needs, and by how
/// many nodes at once, so that it seldom changes [nodes].
const MOST_ON: i32 = 24;
const BESIDE: i32 = 2;
const BY: i32 = 4;

/// Where a box stands, and its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoxPlace {
    /// First node, counted from the corner of the grid.
    pub origin: IVec3,
    /// Nodes along each axis.
    pub size: UVec3,
    /// Which of its nodes is in the middle of its cube.
    pub middle: IVec3,
}

impl BoxPlace {
    /// A cube of so many nodes along each edge around a node.
    pub fn cube(middle: IVec3, edge: u32) -> Self {
        let half = IVec3::splat(edge as i32 / 2);
        Self {
            origin: middle - half,
            size: UVec3::splat(edge),
            middle: half,
        }
    }

    /// The same with so many nodes more at one face, whose outward normal is along an axis.
    fn going_on(mut self, outward: IVec3, nodes: i32) -> Self {
        let more = outward.abs() * nodes;
        self.size += more.as_uvec3();
        if outward.min_element() < 0 {
            self.origin -= more;
            self.middle += more;
        }
        self
    }
}

impl LatticeModel {
    /// Follows the voxels, the materials and the first tool; how often it has asked what a place is
    /// made of.
    pub(super) fn follow(&mut self, input: &ModelInput<'_>, tools: &[&ToolState]) -> u64 {
        let asked = self.follow_edits(input);
        let known = self.matter.take();
        let known = known.filter(|matter| matter.fits(&self.rest_voxels(input, 0)));
        let Some(tool) = tools.first() else {
            self.matter = known;
            return asked;
        };
        let edge = self.edge_within(&input.budget);
        let rest = self.rest_voxels(input, asked);
        let is_new = known.is_none();
        let mut matter = known.unwrap_or_else(|| self.new_box(&rest, edge, tool));
        let place = self.place_for(tool, &matter, edge, is_new, &rest);
        let mut asked = rest.asked.get();
        if place != matter.place() {
            self.leave(&matter, place.origin, input, tools);
            self.damage.keep(&matter);
            let rest = self.rest_voxels(input, asked);
            let is_pressed = self.pressed.is_some();
            let keeps_shape = place.size == matter.size();
            match keeps_shape {
                true => matter.go(&rest, place.origin, &self.damage, is_pressed),
                false => matter = matter.reshaped(&rest, &place, &self.damage, is_pressed),
            }
            asked = rest.asked.get();
            if !keeps_shape {
                // their scratch is of the size of the box
                self.relaxer = Relaxer::default();
                self.unloaded = Relaxer::default();
            }
        }
        self.matter = Some(matter);
        asked
    }

    /// Nodes along each edge of the box. Where tissue yields these are always the same: dents stay, and must
    /// not be of another size where a computer has less time.
    fn edge_within(&self, budget: &Budget) -> u32 {
        let own = self.settings.nodes;
        let yields = self.settings.inelastic.yield_strain.is_some();
        let most = budget.edge.filter(|_| !yields).unwrap_or(own);
        // odd, as its own
        ((most.max(FEWEST) - 1) | 1).min(own)
    }

    /// A box around a tool, at rest but for what broke and yielded there before.
    fn new_box(&self, rest: &RestVoxels<'_>, edge: u32, tool: &ToolState) -> MovingBox {
        let grid = rest.voxels.grid();
        let spacing = self.settings.spacing.unwrap_or(grid.smallest_spacing());
        let place = BoxPlace::cube(node_near(grid_mm(grid, tool.position), spacing), edge);
        let mut matter = MovingBox::new(rest, &place, spacing, self.settings.inelastic);
        self.damage.recall(&mut matter, |_| true);
        matter
    }

    /// Where a tool is to have its box: where it is, as long as it is of this edge and the tool is near its
    /// middle.
    fn place_for(
        &self,
        tool: &ToolState,
        matter: &MovingBox,
        edge: u32,
        is_new: bool,
        rest: &RestVoxels<'_>,
    ) -> BoxPlace {
        let now = matter.place();
        let [wanted, middle] = [self.middle_for(tool, matter, edge), now.origin + now.middle];
        // a box that gets smaller stays around its middle
        let leash = LEASH * f64::from(edge.max(matter.edge()));
        let leash = if is_new { 0.0 } else { leash };
        let is_near = f64::from((wanted - middle).abs().max_element()) <= leash;
        if is_near && matter.edge() == edge {
            return now;
        }
        let cube = BoxPlace::cube(if is_near { middle } else { wanted }, edge);
        match self.way_to_the_face(&cube, matter.lattice.spacing(), rest) {
            Some((outward, nodes)) => cube.going_on(outward, nodes),
            None => cube,
        }
    }

    /// The node in the middle of the cube that a tool is to have, counted from the corner of the grid. It is where
    /// the tool presses, or will, so that the box is full of what it presses.
    fn middle_for(&self, tool: &ToolState, matter: &MovingBox, edge: u32) -> IVec3 {
        let place = grid_mm(&matter.grid, tool.position);
        let toward_tissue = self
            .pressed
            .or_else(|| (matter.middle_of_tissue()? - place).try_normalize());
        let spacing = matter.lattice.spacing();
        let most = FARTHEST_AHEAD * 0.5 * spacing * f64::from(edge - 1);
        let ahead = (AHEAD * tool.shape.half_axes().min_element()).min(most);
        let middle = place + toward_tissue.unwrap_or_default() * ahead;
        node_near(middle, spacing)
    }

    /// Where to and by how many nodes a box goes on beyond its cube to hold the face of the tissue from which the
    /// tool came; none where the cube holds it, or it is too far. Tissue that yields is known for cubes alone.
    fn way_to_the_face(
        &self,
        cube: &BoxPlace,
        spacing: f64,
        rest: &RestVoxels<'_>,
    ) -> Option<(IVec3, i32)> {
        let is_cube = self.settings.inelastic.yield_strain.is_some();
        let pressed = self.pressed.filter(|_| !is_cube)?;
        let axis = (0..3).max_by(|a, b| pressed[*a].abs().total_cmp(&pressed[*b].abs()))?;
        let outward = -IVec3::AXES[axis] * pressed[axis].signum() as i32;
        let middle = cube.origin + cube.middle;
        let is_air = |nodes: &i32| {
            rest.matter_of_node(spacing, middle + outward * *nodes) == NodeMaterial::Empty
        };
        let end = cube.middle.x;
        let face = (end..=end + MOST_ON).find(is_air)?;
        let missing = face - end;
        (missing > 0).then(|| (outward, (missing + BESIDE + BY - 1) / BY * BY))
    }

    /// Notes where the first tool presses; where tissue is not at rest yet, that is as it was.
    pub(super) fn note_pressed(&mut self, report: &ModelReport) {
        let felt = self.relaxer.felt().first().map(|felt| -felt.force);
        let pressed = felt.and_then(DVec3::try_normalize);
        if pressed.is_none() || report.residual <= AT_REST * self.settings.tolerance {
            self.pressed = pressed;
        }
    }
}
