//! The state of a local model: its box, its particles and what it has written.

use glam::{DMat3, DVec3, IVec3, UVec3, Vec3};
use palpate_volume::edit::Edit;
use palpate_volume::grid::Grid;
use palpate_volume::material::LocalContact;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use super::calibration::{LatticeKind, LatticeScale};
use super::lattices::FCC_BASIS;
use super::local_model::{LocalLaw, LocalSettings, Motion};
use super::rest_matter::{Ledger, solid_of};
use super::space::Space;
use super::state::{Origin, Particles};
use super::system::{MARGIN, ParticleSystem};
use super::tool_push::{ParticleTool, ToolForce, ToolLaw};
use super::walls::keep_inside;
use super::write_back::WriteBack;
use crate::integrator::{Fire, VelocityVerlet};
use crate::material::Treatment;
use crate::model::{Budget, DisplacementField, ModelInput, ModelReport, ToolContact, ToolState};

/// Angular frequency of a particle on one link: masses are 72 D/a², so time has the unit T₀/2π.
const LINK_FREQUENCY: f64 = 1.0;
/// Stiffness of a lattice's fastest swing over that of a link (FCC, four shells).
const LATTICE_STIFFNESS: f64 = 12.2;
/// Unbalanced force, as a share of the contact force, at which particles are at rest.
const REST: f64 = 1e-4;
/// Smallest contact force that residuals are measured by, as a share of D/a.
const SMALLEST_FORCE: f64 = 1e-3;

/// How a relaxation ended.
#[derive(Debug)]
pub(super) struct Relaxed {
    pub felt: Vec<ToolForce>,
    pub report: ModelReport,
}

#[derive(Debug)]
pub(super) struct LocalState<L> {
    settings: LocalSettings,
    grid: Grid,
    scale: LatticeScale,
    system: ParticleSystem<L>,
    tool_law: ToolLaw,
    centre: Option<IVec3>,
    ledger: Ledger,
    seen_edit: Option<u64>,
    /// Which particles may move at all, before layers freeze some.
    free: Vec<DVec3>,
    before: Vec<DVec3>,
    /// The contacts of the last call.
    last: Vec<ToolContact>,
    /// Stiffest contact with a tool at the last evaluation, over that of a link.
    stiffest: f64,
    /// Cells with matter at rest, for walls; x fastest within the box.
    filled: Vec<bool>,
}

impl<L: LocalLaw> LocalState<L> {
    pub fn new(settings: &LocalSettings, grid: &Grid) -> Self {
        let scale = LatticeScale::new(L::KIND, grid.smallest_spacing());
        let cells = settings.box_cells.pow(3) as usize;
        let each = match L::KIND {
            LatticeKind::Fcc => 4,
            LatticeKind::Cuboid => 1,
        };
        let a = scale.equilibrium;
        let particles = Particles::with_capacity(each * cells);
        Self {
            settings: *settings,
            grid: *grid,
            system: ParticleSystem::new(
                particles,
                L::on(&scale),
                L::reach(&scale),
                MARGIN * a,
                Space::Open,
            ),
            tool_law: ToolLaw::new(a),
            scale,
            centre: None,
            ledger: Ledger::default(),
            seen_edit: None,
            free: Vec::with_capacity(each * cells),
            before: Vec::with_capacity(each * cells),
            last: Vec::new(),
            stiffest: 0.0,
            filled: vec![false; cells],
        }
    }

    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    pub fn particle_count(&self) -> usize {
        self.system.particles.len()
    }

    pub fn places(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let Particles { sites, homes, .. } = &self.system.particles;
        sites
            .iter()
            .zip(homes)
            .map(|(site, &home)| (site.position(), site.position() - home))
    }

    /// Whether all particles are where matter can be: no farther from home than the box is wide.
    pub fn is_sound(&self) -> bool {
        let Particles {
            sites,
            velocities,
            homes,
            ..
        } = &self.system.particles;
        let widest = (f64::from(self.settings.box_cells) * self.scale.cell).powi(2);
        let near = |(site, home): (&super::state::Site, &DVec3)| {
            site.position().distance_squared(*home) <= widest
        };
        sites.iter().zip(homes).all(near) && velocities.iter().all(|v| v.is_finite())
    }

    /// Gives all particles back; what was written is given back by the next edit.
    pub fn forget(&mut self) {
        self.system.particles.clear();
        self.free.clear();
        self.centre = None;
        self.seen_edit = None;
    }

    fn cell_of(&self, place: DVec3) -> IVec3 {
        (place / self.scale.cell).floor().as_ivec3()
    }

    /// First cell of the box.
    fn corner(&self) -> Option<IVec3> {
        self.centre
            .map(|centre| centre - self.settings.box_cells / 2)
    }

    fn place_in_box(&self, cell: IVec3) -> Option<usize> {
        let (offset, size) = (cell - self.corner()?, self.settings.box_cells);
        let inside = offset.cmpge(IVec3::ZERO).all() && offset.cmplt(IVec3::splat(size)).all();
        inside.then(|| (offset.x + size * (offset.y + size * offset.z)) as usize)
    }

    fn box_cells(&self) -> Vec<IVec3> {
        let Some(corner) = self.corner() else {
            return Vec::new();
        };
        VoxelBox::new(corner, corner + self.settings.box_cells)
            .voxels()
            .collect()
    }

    /// Follows what others have changed: matter that was taken away takes its particles along.
    pub fn follow_edits(&mut self, input: &ModelInput<'_>) {
        let number = input.voxels.edit_number();
        if self.seen_edit == Some(number) {
            return;
        }
        self.seen_edit = Some(number);
        let spacing = self.grid.spacing();
        let voxels = input.voxels;
        let mut overruled = Vec::new();
        for key in self.ledger.0.keys().copied().collect::<Vec<_>>() {
            self.ledger.rest(voxels, IVec3::from_array(key));
            if !self.ledger.0.contains_key(&key) {
                overruled.push(IVec3::from_array(key));
            }
        }
        let ledger = &mut self.ledger;
        let mut gone: Vec<bool> = Vec::with_capacity(self.system.particles.len());
        for (index, origin) in self.system.particles.origins.iter().enumerate() {
            let here = (self.system.particles.sites[index].position() / spacing)
                .floor()
                .as_ivec3();
            let rest = ledger.rest(voxels, origin.voxel);
            let same = rest.is_some_and(|rest| rest.segments == origin.matter.segments);
            gone.push(!same || overruled.contains(&here));
        }
        self.system.particles.give_back(|_, index| gone[index]);
        self.fill_box(input);
    }

    /// Puts the box around a place: gives particles back and takes new ones from the pool.
    pub fn move_box(&mut self, input: &ModelInput<'_>, place: DVec3) {
        let centre = self.cell_of(place);
        if self.centre == Some(centre) {
            return;
        }
        self.centre = Some(centre);
        self.fill_box(input);
    }

    /// Particles for all cells of the box whose matter takes part, and none elsewhere.
    fn fill_box(&mut self, input: &ModelInput<'_>) {
        let corner = self.corner();
        let (size, cell) = (self.settings.box_cells, self.scale.cell);
        self.system.particles.give_back(|particles, index| {
            corner.is_none_or(|corner| {
                let offset = (particles.homes[index] / cell).floor().as_ivec3() - corner;
                offset.cmplt(IVec3::ZERO).any() || offset.cmpge(IVec3::splat(size)).any()
            })
        });
        let mut present = vec![false; self.filled.len()];
        for home in &self.system.particles.homes {
            if let Some(place) = self.place_in_box(self.cell_of(*home)) {
                present[place] = true;
            }
        }
        for (place, cell) in self.box_cells().into_iter().enumerate() {
            self.filled[place] = present[place] || self.fill_cell(input, cell);
        }
        self.free.clear();
        for index in 0..self.system.particles.len() {
            let free = self.mobility(index, input);
            self.free.push(free);
        }
        self.system.particles.free.clone_from(&self.free);
    }

    /// Fills one cell; false where there is nothing that takes part.
    fn fill_cell(&mut self, input: &ModelInput<'_>, cell: IVec3) -> bool {
        let side = self.scale.cell;
        let middle = side * (cell.as_dvec3() + 0.5);
        let Some(voxel) = self.grid.voxel_at(middle / self.grid.spacing()) else {
            return false;
        };
        let Some(matter) = self.ledger.rest(input.voxels, voxel) else {
            return false;
        };
        let Some((solid, _)) = solid_of(input.voxels, input.materials, voxel, &matter) else {
            return false;
        };
        let depth = self.scale.depth(&solid, self.settings.calibration);
        let mass = self.inertia(depth);
        let origin = Origin { voxel, matter };
        let places: &[DVec3] = match L::KIND {
            LatticeKind::Fcc => &FCC_BASIS,
            LatticeKind::Cuboid => &[DVec3::splat(0.5)],
        };
        for place in places {
            let home = side * (cell.as_dvec3() + *place);
            self.system.particles.take(home, depth, mass, origin);
        }
        true
    }

    /// The mass that lets every particle swing alike: 72 D/a².
    fn inertia(&self, depth: f64) -> f64 {
        72.0 * depth / self.scale.equilibrium.powi(2)
    }

    /// Whether a particle may move. One that stands still stands at home.
    fn mobility(&mut self, index: usize, input: &ModelInput<'_>) -> DVec3 {
        let particles = &mut self.system.particles;
        let (home, origin) = (particles.homes[index], particles.origins[index]);
        let solid = solid_of(input.voxels, input.materials, origin.voxel, &origin.matter);
        let rigid = solid.is_none_or(|(_, treatment)| treatment == Treatment::Rigid);
        let border = self.settings.border_cells;
        let inner = self.settings.box_cells - 2 * border;
        let at_border = self.centre.is_none_or(|centre| {
            let first = centre - self.settings.box_cells / 2 + border;
            let offset = (home / self.scale.cell).floor().as_ivec3() - first;
            offset.cmplt(IVec3::ZERO).any() || offset.cmpge(IVec3::splat(inner)).any()
        });
        if !(rigid || at_border) {
            return DVec3::ONE;
        }
        particles.sites[index].set_position(home);
        particles.velocities[index] = DVec3::ZERO;
        DVec3::ZERO
    }

    /// Moves particles until they rest or the budget is spent.
    pub fn relax(&mut self, tools: &[(u32, ParticleTool)], budget: &Budget) -> Relaxed {
        let mut felt = self.forces(tools);
        let mut done = 0;
        let mut residual = self.residual(&felt);
        'layers: for layer in 1..=self.settings.layers {
            self.freeze_outside(layer);
            let mut fire = Fire::new(self.scale.equilibrium);
            if self.settings.motion == Motion::Rest {
                self.system.particles.velocities.fill(DVec3::ZERO);
            }
            for _ in 0..budget.iterations / self.settings.layers {
                if residual < REST && self.is_slow() {
                    break;
                }
                if budget.is_late() {
                    break 'layers;
                }
                felt = self.step(&mut fire, tools);
                residual = self.residual(&felt);
                done += 1;
            }
        }
        self.freeze_outside(self.settings.layers);
        let report = ModelReport {
            iterations: done,
            residual,
            nodes: self.system.particles.len() as u32,
            ..ModelReport::default()
        };
        Relaxed { felt, report }
    }

    /// One step of the chosen motion.
    fn step(&mut self, fire: &mut Fire, tools: &[(u32, ParticleTool)]) -> Vec<ToolForce> {
        if self.settings.walls {
            self.before.clear();
            self.before.extend(
                self.system
                    .particles
                    .sites
                    .iter()
                    .map(|site| site.position()),
            );
        }
        let felt = match self.settings.motion {
            Motion::ScaledTime {
                step_share,
                friction,
            } => {
                let friction = friction.unwrap_or_else(|| self.default_friction());
                let verlet = VelocityVerlet {
                    step: self.stable_step(step_share),
                    friction: 2.0 * LINK_FREQUENCY * friction,
                };
                verlet.before_forces(&mut self.system.particles);
                let felt = self.forces(tools);
                verlet.after_forces(&mut self.system.particles);
                felt
            }
            Motion::Rest => {
                let inertia = std::mem::take(&mut self.system.particles.masses);
                fire.step(&mut self.system.particles, &inertia);
                self.system.particles.masses = inertia;
                self.forces(tools)
            }
        };
        if self.settings.walls {
            let before = std::mem::take(&mut self.before);
            let mut particles = std::mem::take(&mut self.system.particles);
            keep_inside(&mut particles, &before, self.scale.cell, |cell| {
                self.place_in_box(cell)
                    .is_some_and(|place| self.filled[place])
            });
            self.system.particles = particles;
            self.before = before;
        }
        felt
    }

    /// Δt: as chosen, or less where a tool squeezes particles. Between tool and neighbours a
    /// particle feels the tool's stiffness twice, beside the 12.2 C of its lattice; a quarter of
    /// the square of what is stable then.
    fn stable_step(&self, share: f64) -> f64 {
        let stiffness = LATTICE_STIFFNESS + 2.0 * self.stiffest;
        (share * std::f64::consts::TAU / LINK_FREQUENCY).min(stiffness.sqrt().recip())
    }

    /// B/B₀: critical for the slowest swing of the box, B ≈ 2 m ω₁ with ω₁ ≈ π c/L; half of B₀
    /// where the law gains energy by itself.
    fn default_friction(&self) -> f64 {
        let inner = self.settings.box_cells - 2 * self.settings.border_cells;
        let length = f64::from(inner) * self.scale.cell;
        let critical = std::f64::consts::PI * self.scale.equilibrium / length;
        if L::CONSERVATIVE {
            critical
        } else {
            critical.max(0.5)
        }
    }

    /// All forces at the present places, and what the tools feel.
    fn forces(&mut self, tools: &[(u32, ParticleTool)]) -> Vec<ToolForce> {
        self.system.evaluate();
        let particles = &mut self.system.particles;
        if self.settings.binding > 0.0 {
            let Particles {
                sites,
                forces,
                homes,
                masses,
                ..
            } = particles;
            for (((site, force), home), stiffness) in
                sites.iter().zip(forces).zip(homes).zip(masses)
            {
                *force -= self.settings.binding * *stiffness * (site.position() - *home);
            }
        }
        let push = |(_, tool): &(u32, ParticleTool)| self.tool_law.push(tool, particles);
        let felt: Vec<_> = tools.iter().map(push).collect();
        self.stiffest = felt.iter().map(|felt| felt.stiffest).fold(0.0, f64::max);
        felt
    }

    /// Largest unbalanced force, as a share of the contact force.
    fn residual(&self, felt: &[ToolForce]) -> f64 {
        let Particles {
            forces,
            free,
            sites,
            ..
        } = &self.system.particles;
        let unbalanced = |(force, free): (&DVec3, &DVec3)| (*force * *free).length_squared();
        let largest = forces
            .iter()
            .zip(free)
            .map(unbalanced)
            .fold(0.0, f64::max)
            .sqrt();
        let contact: f64 = felt.iter().map(|felt| felt.force.length()).sum();
        let softest = sites.iter().map(|site| site.softness).fold(0.0, f64::max);
        let least = SMALLEST_FORCE / (softest * self.scale.equilibrium);
        if least.is_finite() {
            largest / contact.max(least)
        } else {
            0.0
        }
    }

    /// Whether no particle moves by more than a thousandth of a link in T₀.
    fn is_slow(&self) -> bool {
        let limit = (1e-4 * self.scale.equilibrium).powi(2);
        self.system
            .particles
            .velocities
            .iter()
            .all(|v| v.length_squared() <= limit)
    }

    /// Freezes all particles farther from the box's middle than the layer reaches.
    fn freeze_outside(&mut self, layer: u32) {
        let share = f64::from(layer) / f64::from(self.settings.layers);
        let (Some(centre), true) = (self.centre, self.settings.layers > 1) else {
            return;
        };
        let reach = 0.5 * share * f64::from(self.settings.box_cells) * self.scale.cell;
        let middle = self.scale.cell * (centre.as_dvec3() + 0.5);
        let Particles { free, homes, .. } = &mut self.system.particles;
        for ((free, home), may) in free.iter_mut().zip(homes).zip(&self.free) {
            let near = (*home - middle).abs().max_element() <= reach;
            *free = if near { *may } else { DVec3::ZERO };
        }
    }

    /// One contact for each tool that was given, usable or not.
    pub fn contacts(
        &mut self,
        given: &[ToolState],
        tools: &[(u32, ParticleTool)],
        felt: &[ToolForce],
    ) -> Vec<ToolContact> {
        let mut contacts = Vec::with_capacity(given.len());
        for state in given {
            let found = tools.iter().zip(felt).find(|((id, _), _)| *id == state.id);
            let contact = found.and_then(|(_, felt)| self.contact(state, felt));
            contacts.push(ToolContact {
                tool: state.id,
                contact,
            });
        }
        self.last = contacts.clone();
        contacts
    }

    fn contact(&self, tool: &ToolState, felt: &ToolForce) -> Option<LocalContact> {
        if felt.touched == 0 || !felt.force.is_finite() {
            return None;
        }
        let force = self.grid.direction() * felt.force;
        let normal = force.normalize_or_zero();
        // the contact itself and the body behind it in series, the body as under a flat punch of
        // the area that is touched (a² a particle): 2 E r/(1 − ν²), ν of the lattice near 0.36
        let touched = f64::from(felt.touched);
        let radius = self.scale.equilibrium * (touched / std::f64::consts::PI).sqrt();
        let body = 2.0 * self.scale.mean_young_of_depth(felt.depth / touched) * radius / 0.87;
        let contact = felt.contact_stiffness;
        let stiffness = if contact > 0.0 {
            contact * body / (contact + body)
        } else {
            body
        };
        let stiffness = self.measured_stiffness(tool, force, stiffness);
        let along = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Some(LocalContact {
            position: tool.position,
            force,
            stiffness: -stiffness * along,
            validity: 0.5 * self.scale.cell,
        })
    }

    /// The stiffness along the force since the last call, where the tool has moved along it; at
    /// most four times more or less than `expected`, since matter that slips is no spring.
    fn measured_stiffness(&self, tool: &ToolState, force: DVec3, expected: f64) -> f64 {
        let normal = force.normalize_or_zero();
        let same = |last: &&ToolContact| last.tool == tool.id;
        let Some(last) = self.last.iter().find(same).and_then(|last| last.contact) else {
            return expected;
        };
        let moved = (tool.position - last.position).dot(normal);
        if moved.abs() < 0.01 * self.scale.cell {
            return expected;
        }
        let measured = (last.force - force).dot(normal) / moved;
        measured.clamp(0.25 * expected, 4.0 * expected)
    }

    /// The edit that shows where matter is now.
    pub fn write_back(&mut self, voxels: &Voxels) -> Option<Edit> {
        let side = self.scale.cell / self.grid.spacing();
        let region = self.corner().map_or(VoxelBox::EMPTY, |corner| {
            let end = corner + self.settings.box_cells;
            let (low, high) = (corner.as_dvec3() * side, end.as_dvec3() * side);
            VoxelBox::new(low.floor().as_ivec3(), high.ceil().as_ivec3())
        });
        let region = region.intersect(&self.grid.bounds());
        let intensities = voxels.intensities();
        let air = (self.settings.air - intensities.intercept()) / intensities.slope();
        let rule = WriteBack {
            capacity: self.grid.voxel_volume() / self.scale.volume(),
            air: air.round() as i16,
        };
        rule.edit(voxels, &self.system.particles, &region, &mut self.ledger)
    }

    /// The mean displacement of each cell's particles; none where nothing has moved.
    pub fn displacement(&self) -> Option<DisplacementField> {
        let corner = self.corner()?;
        let mut sums = vec![(DVec3::ZERO, 0_u32); self.filled.len()];
        let mut farthest = 0.0_f64;
        let Particles { sites, homes, .. } = &self.system.particles;
        for (site, home) in sites.iter().zip(homes) {
            let moved = site.position() - *home;
            farthest = farthest.max(moved.length_squared());
            if let Some(place) = self.place_in_box(self.cell_of(*home)) {
                sums[place].0 += moved;
                sums[place].1 += 1;
            }
        }
        // a thousandth of a voxel is not seen
        if farthest.sqrt() < 1e-3 * self.scale.cell {
            return None;
        }
        let axes = self.grid.direction();
        let mean = |&(sum, count): &(DVec3, u32)| -> Vec3 {
            (axes * sum / f64::from(count.max(1))).as_vec3()
        };
        let first = self.scale.cell * (corner.as_dvec3() + 0.5) / self.grid.spacing();
        Some(DisplacementField {
            origin: self.grid.patient_from_grid().transform_point3(first),
            axes,
            spacing: self.scale.cell,
            size: UVec3::splat(self.settings.box_cells as u32),
            moved: sums.iter().map(mean).collect(),
        })
    }
}
