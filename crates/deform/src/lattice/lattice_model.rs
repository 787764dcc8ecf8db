//! The bonded lattice as a model: a box of nodes that follows the first tool.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::grid::Grid;
use palpate_volume::material::LocalContact;

use super::border::Border;
use super::inelastic::{Breaking, Inelastic, InelasticSettings};
use super::moduli::POISSON_RANGE;
use super::nodes::{Lattice, NodeMatter};
use super::relax::{RelaxSettings, Relaxer};
use super::resample::{matter_of_node, node_near, node_place};
use super::tool_contact::{LatticeTool, ToolForce};
use crate::displacement::Displacement;
use crate::material::Materials;
use crate::model::{DeformationModel, ModelAnswer, ModelEvent, ModelInput, ToolContact, ToolState};
use crate::rest_matter::Ledger;

/// How far the tool may be from the middle of the box before the box follows [nodes].
const LEASH: i32 = 2;
/// Relaxations in one call at most, where bonds break.
const ROUNDS: u32 = 4;
/// How far from the tool's place its contact holds [spacings].
const VALIDITY: f64 = 0.5;
/// Share of the box's half width over which voxels and picture fade to the unmoved body.
const FADING: f64 = 0.4;
/// Displacement that is seen [spacings].
const SEEN: f64 = 0.01;

/// How the lattice works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeSettings {
    /// Nodes along each edge of the box, odd, 5 to 101.
    pub nodes: u32,
    /// Between nodes [mm]; none for the smallest side of a voxel.
    pub spacing: Option<f64>,
    /// Unbalanced force at rest, as a share of the tools' force.
    pub tolerance: f64,
    /// What does not come back.
    pub inelastic: InelasticSettings,
}

impl Default for LatticeSettings {
    fn default() -> Self {
        Self {
            nodes: 21,
            spacing: None,
            tolerance: 1e-3,
            inelastic: InelasticSettings::default(),
        }
    }
}

/// The bonded lattice as a model.
#[derive(Debug, Default)]
pub struct LatticeModel {
    settings: LatticeSettings,
    matter: Option<MovingBox>,
    relaxer: Relaxer,
    bonds_broken: u64,
    work_broken: f64,
    told_poisson: bool,
    ledger: Ledger,
}

/// A box of nodes and where it stands.
#[derive(Debug)]
struct MovingBox {
    lattice: Lattice,
    inelastic: Inelastic,
    /// Its first node, counted from the corner of the grid.
    origin: IVec3,
    /// What it was made from.
    edit_number: u64,
    grid: Grid,
    materials: Materials,
}

impl LatticeModel {
    /// With settings of its own.
    ///
    /// # Panics
    /// Where the box has no middle node or an absurd size, or the spacing is no length.
    #[must_use]
    pub fn new(settings: LatticeSettings) -> Self {
        let nodes = settings.nodes;
        assert!(
            nodes % 2 == 1 && (5..=101).contains(&nodes),
            "a box of {nodes} nodes"
        );
        let spacing = settings.spacing.unwrap_or(1.0);
        assert!(spacing > 0.0 && spacing.is_finite(), "spacing {spacing} mm");
        Self {
            settings,
            ..Self::default()
        }
    }

    /// The box as it stands; none before the first tool.
    #[must_use]
    pub fn lattice(&self) -> Option<&Lattice> {
        self.matter.as_ref().map(|matter| &matter.lattice)
    }

    /// Moves or makes the box anew where the tool, the voxels or the materials ask for it.
    fn follow(&mut self, input: &ModelInput<'_>, tool: &ToolState) {
        let grid = input.voxels.grid();
        let spacing = self.settings.spacing.unwrap_or(grid.smallest_spacing());
        let middle = node_near(grid_mm(grid, tool.position), spacing);
        let half = self.settings.nodes as i32 / 2;
        let stays = self.matter.as_ref().is_some_and(|matter| {
            let away = (middle - half - matter.origin).abs().max_element();
            away <= LEASH
                && matter.edit_number == input.voxels.edit_number()
                && matter.materials == *input.materials
                && matter.grid == *grid
        });
        if stays {
            return;
        }
        let mut next = MovingBox::new(input, &self.settings, spacing, middle - half);
        if let Some(old) = self.matter.take().filter(|old| old.grid == *grid) {
            let offset = next.origin - old.origin;
            next.inelastic
                .adopt(&mut next.lattice, &old.inelastic, &old.lattice, offset);
        }
        self.matter = Some(next);
    }

    /// Relaxes, breaks, and relaxes again, within the budget.
    fn relax(&mut self, input: &ModelInput<'_>, tools: &[LatticeTool], answer: &mut ModelAnswer) {
        let Some(matter) = &mut self.matter else {
            return;
        };
        matter.inelastic.fade(&mut matter.lattice, input.dt);
        for _ in 0..ROUNDS {
            let left = input.budget.iterations - answer.report.iterations;
            if left == 0 {
                return;
            }
            let settings = RelaxSettings {
                tolerance: self.settings.tolerance,
                iterations: left,
                reference: 0.0,
            };
            let is_late = || input.budget.is_late();
            let report = self
                .relaxer
                .relax(&mut matter.lattice, tools, &settings, &is_late);
            answer.report.iterations += report.iterations;
            answer.report.residual = report.residual;
            // what is not at rest yet may swing too far, and must not break for that
            let at_rest = report.residual <= 10.0 * self.settings.tolerance;
            let breaking = match at_rest {
                true => matter.inelastic.break_and_yield(&mut matter.lattice),
                false => Breaking::default(),
            };
            if breaking.count == 0 {
                return;
            }
            self.bonds_broken += u64::from(breaking.count);
            self.work_broken += breaking.work;
            answer.events.push(ModelEvent::BondsBroken {
                count: breaking.count,
                work: breaking.work,
                place: matter.patient_place(breaking.place),
            });
        }
    }

    /// Says once where Poisson's ratio is not the one that was asked for.
    fn tell_poisson(&mut self, answer: &mut ModelAnswer) {
        let Some(matter) = self.matter.as_ref().filter(|_| !self.told_poisson) else {
            return;
        };
        let [low, high] = POISSON_RANGE;
        let lattice = &matter.lattice;
        let asked = lattice
            .matter_nodes()
            .filter_map(|node| lattice.matter(node).solid());
        let outside = asked
            .map(|solid| solid.poisson)
            .find(|poisson| !(low..=high).contains(poisson));
        if let Some(asked) = outside {
            let used = asked.clamp(low, high);
            answer
                .events
                .push(ModelEvent::PoissonClamped { asked, used });
            self.told_poisson = true;
        }
    }
}

impl DeformationModel for LatticeModel {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let mut answer = ModelAnswer::default();
        let usable: Vec<&ToolState> = input.tools.iter().filter(|t| t.is_usable()).collect();
        if let Some(first) = usable.first() {
            self.follow(input, first);
            self.tell_poisson(&mut answer);
        }
        if let Some(matter) = &self.matter {
            let tools: Vec<_> = usable.iter().map(|tool| matter.tool(tool)).collect();
            self.relax(input, &tools, &mut answer);
        }
        if self
            .matter
            .as_ref()
            .is_some_and(|matter| !matter.is_finite())
        {
            self.reset();
            answer.events.push(ModelEvent::Reset);
        }
        answer.report.bonds_broken = self.bonds_broken;
        answer.report.work_broken = self.work_broken;
        let felt = if answer.report.iterations > 0 {
            self.relaxer.felt()
        } else {
            &[]
        };
        let mut felt = felt.iter();
        for tool in input.tools {
            let felt = tool.is_usable().then(|| felt.next()).flatten();
            let contact = self.matter.as_ref().zip(felt);
            answer.contacts.push(ToolContact {
                tool: tool.id,
                contact: contact.and_then(|(matter, felt)| matter.contact(tool, felt)),
            });
        }
        if let Some(matter) = &self.matter {
            answer.report.nodes = matter.lattice.matter_nodes().count() as u32;
            let least = SEEN * matter.lattice.spacing();
            answer.displacement = matter
                .displacement()
                .told(&matter.grid, &self.ledger, least);
        }
        answer
    }

    fn reset(&mut self) {
        self.matter = None;
    }
}

impl MovingBox {
    fn new(
        input: &ModelInput<'_>,
        settings: &LatticeSettings,
        spacing: f64,
        origin: IVec3,
    ) -> Self {
        let middle = DVec3::splat(f64::from(settings.nodes / 2) * spacing);
        let border = Border::Endless { load: middle };
        let size = UVec3::splat(settings.nodes);
        let mut lattice = Lattice::new(size, spacing, border, |node| {
            matter_of_node(input.voxels, input.materials, spacing, origin + node)
        });
        Self {
            inelastic: Inelastic::new(&mut lattice, settings.inelastic),
            lattice,
            origin,
            edit_number: input.voxels.edit_number(),
            grid: *input.voxels.grid(),
            materials: input.materials.clone(),
        }
    }

    /// A tool in the lattice's frame.
    fn tool(&self, tool: &ToolState) -> LatticeTool {
        let first = node_place(self.origin, self.lattice.spacing());
        LatticeTool {
            centre: grid_mm(&self.grid, tool.position) - first,
            half_axes: tool.shape.half_axes(),
            orientation: self.grid.direction().transpose() * DMat3::from_quat(tool.orientation),
        }
    }

    /// A place of the lattice's frame in the patient [mm].
    fn patient_place(&self, place: DVec3) -> DVec3 {
        let in_grid = node_place(self.origin, self.lattice.spacing()) + place;
        self.grid
            .patient_from_grid()
            .transform_point3(in_grid / self.grid.spacing())
    }

    fn is_finite(&self) -> bool {
        let mut nodes = self.lattice.matter_nodes();
        nodes.all(|node| self.lattice.moved(node).is_finite())
    }

    /// What a tool feels, as a linear law: along the force, it changes by 2 E* a for each mm, a
    /// being the radius of the contact's area and E* = E / (1 - ν²); that holds for every round
    /// punch without friction.
    ///
    /// Source: Pharr, Oliver & Brotzen, J. Mater. Res. 7 (1992).
    fn contact(&self, tool: &ToolState, felt: &ToolForce) -> Option<LocalContact> {
        let size = felt.force.length();
        if felt.nodes == 0 || !size.is_finite() || size == 0.0 {
            return None;
        }
        let spacing = self.lattice.spacing();
        let layout = self.lattice.layout();
        let touched = layout.index_of((felt.place / spacing).round().as_ivec3());
        let solid = touched.and_then(|index| self.lattice.matter(index).solid());
        let modulus = solid.map_or(0.0, |s| s.young / (1.0 - s.poisson * s.poisson));
        let radius = (f64::from(felt.nodes) * spacing * spacing / std::f64::consts::PI).sqrt();
        let force = self.grid.direction() * felt.force;
        let normal = force / size;
        let along = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Some(LocalContact {
            position: tool.position,
            force,
            stiffness: along * (-2.0 * modulus * radius),
            validity: VALIDITY * spacing,
        })
    }

    /// How far matter has moved, less and less toward the border of the box, where the picture
    /// of the body behind it begins.
    fn displacement(&self) -> Displacement {
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
fn grid_mm(grid: &Grid, point: DVec3) -> DVec3 {
    grid.grid_from_patient().transform_point3(point) * grid.spacing()
}
