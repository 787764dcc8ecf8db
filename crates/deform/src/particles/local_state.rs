//! The state of a local model: its box, its particles and what it has written.

use std::time::Instant;

use glam::{DVec3, IVec3, UVec3};
use palpate_volume::edit::Edit;
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use super::body::{ParticleBody, Relaxed};
use super::calibration::{LatticeKind, LatticeScale};
use super::lattices::FCC_BASIS;
use super::local_model::{LocalLaw, LocalSettings};
use super::slips::Slips;
use super::state::{Origin, Particles};
use super::tool_push::ParticleTool;
use super::write_back::WriteBack;
use crate::at_rest::AtRest;
use crate::displacement::Displacement;
use crate::material::Treatment;
use crate::model::{Budget, DisplacementField, ModelEvent, ModelInput};
use crate::voxel_ledger::{Ledger, solid_of};

/// Displacement that is seen [cells].
const VISIBLE: f64 = 0.03;
/// Largest half axis of a tool around which tissue is looked for [cells].
const LARGEST_TOOL: f64 = 12.0;

#[derive(Debug)]
pub(super) struct LocalState<L> {
    settings: LocalSettings,
    pub body: ParticleBody<L>,
    pub centre: Option<IVec3>,
    /// Where the tool's centre was when the box was put there.
    tool_cell: Option<IVec3>,
    ledger: Ledger,
    seen_edit: Option<u64>,
    /// Which particles may move at all, before layers freeze some.
    free: Vec<DVec3>,
    /// Cells with tissue at rest, for walls; x fastest within the box.
    filled: Vec<bool>,
    slips: Slips,
}

impl<L: LocalLaw> LocalState<L> {
    pub fn new(settings: &LocalSettings, grid: &Grid) -> Self {
        let scale = LatticeScale::new(L::KIND, grid.smallest_spacing());
        let cells = settings.box_cells.pow(3) as usize;
        let each = match L::KIND {
            LatticeKind::Fcc => 4,
            LatticeKind::Cuboid => 1,
        };
        let inner = settings.box_cells - 2 * settings.border_cells;
        let body = ParticleBody::new(grid, scale, each * cells, settings.motion)
            .bound(settings.binding, f64::from(inner) * scale.cell)
            .held_at(0.5 * f64::from(inner) * scale.cell);
        Self {
            settings: *settings,
            body,
            centre: None,
            tool_cell: None,
            ledger: Ledger::default(),
            seen_edit: None,
            free: Vec::with_capacity(each * cells),
            filled: vec![false; cells],
            slips: Slips::default(),
        }
    }

    /// What moved voxels are without a tool.
    pub fn at_rest(&self) -> AtRest {
        self.ledger.at_rest()
    }

    /// Whether particles stay where a tool has pushed them.
    pub fn rearranges(&self) -> bool {
        self.settings.rearranges
    }

    /// Notes that all voxels that were changed stay as they are without a tool.
    pub fn note_all_stays(&mut self) {
        self.ledger.note_plastic(&self.ledger.bounds());
    }

    /// All voxels count as they are from now on.
    pub fn settle_all(&mut self) {
        self.ledger.settle();
    }

    /// Voxels that stay without a tool count as they are from now on.
    pub fn settle_plastic(&mut self) {
        self.ledger.settle_plastic();
    }

    /// Voxels that stay displaced without a tool.
    pub fn plastic_voxels(&self) -> u32 {
        self.ledger.plastic_len() as u32
    }

    /// Cells along an edge of the box whose particles may move.
    pub fn inner_cells(&self) -> i32 {
        self.settings.box_cells - 2 * self.settings.border_cells
    }

    /// Voxels that are not as at rest.
    pub fn moved_voxels(&self) -> u32 {
        self.ledger.len() as u32
    }

    /// Whether all particles are where tissue can be: no farther from home than the box is wide.
    pub fn is_sound(&self) -> bool {
        self.body
            .is_sound(f64::from(self.settings.box_cells) * self.body.scale.cell)
    }

    /// Gives all particles back; what was written is given back by the next edit.
    pub fn forget(&mut self) {
        self.body.system.particles.clear();
        self.slips = Slips::default();
        self.free.clear();
        self.centre = None;
        self.tool_cell = None;
        self.seen_edit = None;
    }

    fn cell_of(&self, place: DVec3) -> IVec3 {
        (place / self.body.scale.cell).floor().as_ivec3()
    }

    /// First cell of the box.
    fn corner(&self) -> Option<IVec3> {
        self.centre
            .map(|centre| centre - self.settings.box_cells / 2)
    }

    fn place_in_box(&self, cell: IVec3) -> Option<usize> {
        place_in_box(self.centre, self.settings.box_cells, cell)
    }

    fn box_cells(&self) -> Vec<IVec3> {
        let Some(corner) = self.corner() else {
            return Vec::new();
        };
        VoxelBox::new(corner, corner + self.settings.box_cells)
            .voxels()
            .collect()
    }

    /// Follows what others have changed: tissue that was taken away takes its particles along.
    pub fn follow_edits(&mut self, input: &ModelInput<'_>) {
        let number = input.voxels.edit_number();
        if self.seen_edit == Some(number) {
            return;
        }
        self.seen_edit = Some(number);
        let spacing = self.body.grid.spacing();
        let voxels = input.voxels;
        let overruled = self.ledger.take_overruled(voxels);
        let overruled: Vec<_> = overruled.iter().map(|(voxel, ..)| *voxel).collect();
        let ledger = &self.ledger;
        let mut gone: Vec<bool> = Vec::with_capacity(self.body.system.particles.len());
        // particles of one voxel lie side by side, and are asked for once
        let mut asked: Option<(IVec3, bool)> = None;
        for (index, origin) in self.body.system.particles.origins.iter().enumerate() {
            let same = match asked {
                Some((voxel, same)) if voxel == origin.voxel => same,
                _ => ledger
                    .rest(voxels, origin.voxel)
                    .is_some_and(|rest| rest.segments == origin.matter.segments),
            };
            asked = Some((origin.voxel, same));
            let place = self.body.system.particles.sites[index].position();
            let here = (place / spacing).floor().as_ivec3();
            gone.push(!same || overruled.contains(&here));
        }
        self.body.system.particles.give_back(|_, index| gone[index]);
        self.fill_box(input);
    }

    /// Puts the box around what a tool touches: gives particles back and takes new ones from
    /// the pool.
    pub fn move_box(&mut self, input: &ModelInput<'_>, tool: &ParticleTool) {
        let cell = self.cell_of(tool.centre);
        if self.tool_cell == Some(cell) {
            return;
        }
        self.tool_cell = Some(cell);
        let toward = self.toward_matter(input, tool);
        let centre = self.cell_of(tool.centre + toward.unwrap_or_default());
        if self.settings.rearranges && (toward.is_none() || !self.leaves(centre)) {
            return;
        }
        if self.centre != Some(centre) {
            self.centre = Some(centre);
            self.fill_box(input);
        }
    }

    /// From the tool's centre to the place on it where tissue is; none where none is near. The thesis puts the box around
    /// the tool's centre (5.10), where half of it is air and a large tool reaches its border.
    ///
    /// For a ball on a plane the middle of the tissue within R of its centre lies 3/8 R away, and
    /// the place on its surface r; in the midst of tissue both are zero.
    fn toward_matter(&self, input: &ModelInput<'_>, tool: &ParticleTool) -> Option<DVec3> {
        let (grid, cell) = (self.body.grid, self.body.scale.cell);
        let radius = tool.half_axes.max_element().min(LARGEST_TOOL * cell);
        let reach = radius + 2.0 * cell;
        let side = (reach / cell).ceil() as i32;
        let middle = self.cell_of(tool.centre);
        let (mut sum, mut count) = (DVec3::ZERO, 0_u32);
        for near in VoxelBox::new(middle - side, middle + side + 1).voxels() {
            let offset = cell * (near.as_dvec3() + 0.5) - tool.centre;
            let voxel = grid.voxel_at((tool.centre + offset) / grid.spacing());
            let Some(voxel) = voxel.filter(|_| offset.length() <= reach) else {
                continue;
            };
            let rest = self.ledger.rest(input.voxels, voxel);
            if rest
                .and_then(|rest| solid_of(input.voxels, input.materials, voxel, &rest))
                .is_some()
            {
                sum += offset;
                count += 1;
            }
        }
        let toward = sum / f64::from(count.max(1)) * (8.0 / 3.0 * radius / reach);
        (count > 0).then(|| toward.clamp_length_max(radius))
    }

    /// Particles for all cells of the box whose tissue takes part, and none elsewhere.
    fn fill_box(&mut self, input: &ModelInput<'_>) {
        let corner = self.corner();
        let (size, cell) = (self.settings.box_cells, self.body.scale.cell);
        self.body.system.particles.give_back(|particles, index| {
            corner.is_none_or(|corner| {
                let offset = (particles.homes[index] / cell).floor().as_ivec3() - corner;
                offset.cmplt(IVec3::ZERO).any() || offset.cmpge(IVec3::splat(size)).any()
            })
        });
        let mut present = vec![false; self.filled.len()];
        for home in &self.body.system.particles.homes {
            if let Some(place) = self.place_in_box(self.cell_of(*home)) {
                present[place] = true;
            }
        }
        for (place, cell) in self.box_cells().into_iter().enumerate() {
            self.filled[place] = present[place] || self.fill_cell(input, cell);
        }
        self.free.clear();
        for index in 0..self.body.system.particles.len() {
            let free = self.mobility(index, input);
            self.free.push(free);
        }
        self.body.system.particles.free.clone_from(&self.free);
    }

    /// Fills one cell; false where there is nothing that takes part.
    fn fill_cell(&mut self, input: &ModelInput<'_>, cell: IVec3) -> bool {
        let side = self.body.scale.cell;
        let middle = side * (cell.as_dvec3() + 0.5);
        let Some(voxel) = self.body.grid.voxel_at(middle / self.body.grid.spacing()) else {
            return false;
        };
        let Some(matter) = self.ledger.rest(input.voxels, voxel) else {
            return false;
        };
        let Some((solid, treatment)) = solid_of(input.voxels, input.materials, voxel, &matter)
        else {
            return false;
        };
        let calibration = self.settings.calibration;
        let depth = self.body.depth(&solid, treatment, calibration);
        let mass = self.body.inertia(depth);
        let origin = Origin { voxel, matter };
        let places: &[DVec3] = match L::KIND {
            LatticeKind::Fcc => &FCC_BASIS,
            LatticeKind::Cuboid => &[DVec3::splat(0.5)],
        };
        for place in places {
            let home = side * (cell.as_dvec3() + *place);
            self.body.system.particles.take(home, depth, mass, origin);
        }
        true
    }

    /// Whether a particle may move. One that stands still stands at home.
    fn mobility(&mut self, index: usize, input: &ModelInput<'_>) -> DVec3 {
        let (border, inner) = (self.settings.border_cells, self.inner_cells());
        let particles = &mut self.body.system.particles;
        let (home, origin) = (particles.homes[index], particles.origins[index]);
        let solid = solid_of(input.voxels, input.materials, origin.voxel, &origin.matter);
        let rigid = solid.is_none_or(|(_, treatment)| treatment == Treatment::Rigid);
        let at_border = self.centre.is_none_or(|centre| {
            let first = centre - self.settings.box_cells / 2 + border;
            let offset = (home / self.body.scale.cell).floor().as_ivec3() - first;
            offset.cmplt(IVec3::ZERO).any() || offset.cmpge(IVec3::splat(inner)).any()
        });
        if !(rigid || at_border) {
            return DVec3::ONE;
        }
        particles.sites[index].set_position(home);
        particles.velocities[index] = DVec3::ZERO;
        DVec3::ZERO
    }

    /// Moves particles until they rest or the budget is spent, layer by layer.
    pub fn relax(&mut self, tools: &[(u32, ParticleTool)], budget: &Budget) -> Relaxed {
        let began = Instant::now();
        let layers = self.settings.layers;
        let part = budget.iterations / layers;
        let mut done = 0;
        for layer in 1..layers {
            self.freeze_outside(layer);
            let share = f64::from(layer) / f64::from(layers);
            let part = Budget {
                iterations: part,
                ..budget.until(began, share)
            };
            done += self.relax_now(tools, &part).report.iterations;
        }
        self.freeze_outside(layers);
        let rest = Budget {
            iterations: budget.iterations - part * (layers - 1),
            ..*budget
        };
        let mut relaxed = self.relax_now(tools, &rest);
        relaxed.report.iterations += done;
        relaxed
    }

    fn relax_now(&mut self, tools: &[(u32, ParticleTool)], budget: &Budget) -> Relaxed {
        if !self.settings.walls {
            return self.body.relax(tools, budget, None);
        }
        let Self {
            settings,
            body,
            centre,
            filled,
            ..
        } = self;
        let open = |cell: IVec3| {
            place_in_box(*centre, settings.box_cells, cell).is_some_and(|place| filled[place])
        };
        body.relax(tools, budget, Some(&open))
    }

    /// Freezes all particles farther from the box's middle than the layer reaches.
    fn freeze_outside(&mut self, layer: u32) {
        let share = f64::from(layer) / f64::from(self.settings.layers);
        let (Some(centre), true) = (self.centre, self.settings.layers > 1) else {
            return;
        };
        let reach = 0.5 * share * f64::from(self.settings.box_cells) * self.body.scale.cell;
        let middle = self.body.scale.cell * (centre.as_dvec3() + 0.5);
        let Particles { free, homes, .. } = &mut self.body.system.particles;
        for ((free, home), may) in free.iter_mut().zip(homes).zip(&self.free) {
            let near = (*home - middle).abs().max_element() <= reach;
            *free = if near { *may } else { DVec3::ZERO };
        }
    }

    /// Links that parted since the last call.
    pub fn slipped(&mut self) -> Option<ModelEvent> {
        let (scale, grid) = (self.body.scale, self.body.grid);
        let system = &self.body.system;
        let found = self
            .slips
            .look(&system.particles, system.list(), scale.nearest());
        found.map(|(count, middle)| ModelEvent::Slipped {
            count,
            place: grid
                .patient_from_grid()
                .transform_point3(middle / grid.spacing()),
        })
    }

    /// The edit that shows where tissue is now.
    pub fn write_back(&mut self, voxels: &Voxels) -> Option<Edit> {
        let side = self.body.scale.cell / self.body.grid.spacing();
        let region = self.corner().map_or(VoxelBox::EMPTY, |corner| {
            let end = corner + self.settings.box_cells;
            let (low, high) = (corner.as_dvec3() * side, end.as_dvec3() * side);
            VoxelBox::new(low.floor().as_ivec3(), high.ceil().as_ivec3())
        });
        let region = region.intersect(&self.body.grid.bounds());
        let intensities = voxels.intensities();
        let air = (self.settings.air - intensities.intercept()) / intensities.slope();
        let rule = WriteBack {
            capacity: self.body.grid.voxel_volume() / self.body.scale.volume(),
            air: air.round() as i16,
        };
        let particles = &self.body.system.particles;
        let by = match self.settings.rearranges {
            true => WriteBack::edit_rearranged,
            false => WriteBack::edit,
        };
        by(&rule, voxels, particles, &region, &mut self.ledger)
    }

    /// The mean displacement of each cell's particles, less what the voxels show of it; none
    /// where that is nothing.
    pub fn displacement(&self, voxels: &Voxels) -> Option<DisplacementField> {
        let corner = self.corner()?;
        let mut sums = vec![(DVec3::ZERO, 0_u32); self.filled.len()];
        let Particles { sites, homes, .. } = &self.body.system.particles;
        for (site, home) in sites.iter().zip(homes) {
            if let Some(place) = self.place_in_box(self.cell_of(*home)) {
                sums[place].0 += site.position() - *home;
                sums[place].1 += 1;
            }
        }
        let cell = self.body.scale.cell;
        let mean = |(sum, count): (DVec3, u32)| (count > 0).then(|| sum / f64::from(count));
        let field = Displacement::new(
            cell * (corner.as_dvec3() + 0.5),
            cell,
            UVec3::splat(self.settings.box_cells as u32),
            sums.into_iter().map(mean).collect(),
        );
        // free surfaces of a crystal draw in by themselves, by less than is seen
        field.residual(voxels, &self.ledger, VISIBLE * cell)
    }
}

/// Place of a cell in a box around a centre, x fastest.
fn place_in_box(centre: Option<IVec3>, size: i32, cell: IVec3) -> Option<usize> {
    let offset = cell - (centre? - size / 2);
    let inside = offset.cmpge(IVec3::ZERO).all() && offset.cmplt(IVec3::splat(size)).all();
    inside.then(|| (offset.x + size * (offset.y + size * offset.z)) as usize)
}
