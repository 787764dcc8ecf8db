//! Where the lattice's box stands, and how large it is: around what the first tool presses.

use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;

use super::lattice_model::{AT_REST, LatticeModel};
use super::moving_box::{MovingBox, grid_mm};
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
        if let Some(other) = known.as_ref().filter(|matter| matter.edge() != edge) {
            self.damage.keep(other);
            // their scratch is of the size of the box
            self.relaxer = Relaxer::default();
            self.unloaded = Relaxer::default();
        }
        let rest = self.rest_voxels(input, asked);
        let leash = known.as_ref().map_or(0.0, |_| LEASH * f64::from(edge));
        let mut matter = match known {
            None => self.new_box(&rest, edge, tool),
            Some(other) if other.edge() != edge => other.resized(&rest, edge, &self.damage),
            Some(known) => known,
        };
        let mut asked = rest.asked.get();
        let origin = self.origin_for(tool, &matter, input.voxels.grid());
        if f64::from((origin - matter.origin).abs().max_element()) > leash {
            self.leave(&mut matter, origin, input, tools);
            self.damage.keep(&matter);
            let rest = self.rest_voxels(input, asked);
            matter.go(&rest, origin, &self.damage, self.pressed.is_some());
            asked = rest.asked.get();
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

    /// A box at rest around a tool.
    fn new_box(&self, rest: &RestVoxels<'_>, edge: u32, tool: &ToolState) -> MovingBox {
        let grid = rest.voxels.grid();
        let spacing = self.settings.spacing.unwrap_or(grid.smallest_spacing());
        let origin = node_near(grid_mm(grid, tool.position), spacing) - edge as i32 / 2;
        MovingBox::new(rest, edge, spacing, self.settings.inelastic, origin)
    }

    /// The first node of the box that a tool is to have, counted from the corner of the grid. The middle of
    /// the box stands where the tool presses, or will, so that the box is full of what it presses.
    fn origin_for(&self, tool: &ToolState, matter: &MovingBox, grid: &Grid) -> IVec3 {
        let place = grid_mm(grid, tool.position);
        let toward_tissue = self
            .pressed
            .or_else(|| (matter.middle_of_tissue()? - place).try_normalize());
        let most = FARTHEST_AHEAD * matter.half_width();
        let ahead = (AHEAD * tool.shape.half_axes().min_element()).min(most);
        let middle = place + toward_tissue.unwrap_or_default() * ahead;
        node_near(middle, matter.lattice.spacing()) - matter.edge() as i32 / 2
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
