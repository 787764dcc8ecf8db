//! Particles with their tools: forces, motion to rest, and what the tools feel.
//!
//! What local and global models share. Time is scaled: every particle's mass is 72 D/a², so that
//! all swing alike and soft tissue beside bone comes to rest as fast as one tissue alone.
//! Frame: mm along the axes of the grid. Source: thesis 5.16–5.17, 5.20, 5.23.

use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;

use super::calibration::{Calibration, LatticeScale};
use super::contact_laws::ContactLaws;
use super::local_model::{LocalLaw, Motion};
use super::space::Space;
use super::state::{Particles, Site};
use super::system::{MARGIN, ParticleSystem};
use super::tool_push::{ParticleTool, ToolForce, ToolLaw};
use super::walls::keep_inside;
use crate::material::{Solid, Treatment};
use crate::model::{Budget, ModelEvent, ModelParts, ModelReport, ToolContact, ToolState};
use crate::particles::integrator::{Fire, VelocityVerlet};

/// Angular frequency of a particle on one link: masses are 72 D/a², so time has the unit T₀/2π.
const LINK_FREQUENCY: f64 = 1.0;
/// Stiffness of a lattice's fastest swing over that of a link (FCC, four shells).
const LATTICE_STIFFNESS: f64 = 12.2;
/// Unbalanced force, as a share of the contact force, at which particles are at rest.
const REST: f64 = 1e-4;
/// Smallest contact force that residuals are measured by, as a share of D/a.
const SMALLEST_FORCE: f64 = 1e-3;

/// Result of a relaxation.
#[derive(Debug)]
pub(super) struct Relaxed {
    pub felt: Vec<ToolForce>,
    pub report: ModelReport,
}

/// Into which cells particles may go; none where there are no walls.
pub(super) type Open<'a> = Option<&'a dyn Fn(IVec3) -> bool>;

#[derive(Debug)]
pub(super) struct ParticleBody<L> {
    pub grid: Grid,
    pub scale: LatticeScale,
    pub system: ParticleSystem<L>,
    motion: Motion,
    /// Springs to the initial positions, as a share of a link's stiffness.
    binding: f64,
    /// Length of the slowest swing [mm].
    length: f64,
    tool_law: ToolLaw,
    contact_laws: ContactLaws,
    before: Vec<DVec3>,
    /// Stiffest contact with a tool at the last evaluation, over that of a link.
    stiffest: f64,
    /// That tissue was asked for with another Poisson's ratio than the lattice has.
    other_poisson: Option<ModelEvent>,
}

impl<L: LocalLaw> ParticleBody<L> {
    pub fn new(grid: &Grid, scale: LatticeScale, capacity: usize, motion: Motion) -> Self {
        let a = scale.equilibrium;
        let particles = Particles::with_capacity(capacity);
        let (law, reach) = (L::on(&scale), L::reach(&scale));
        Self {
            grid: *grid,
            system: ParticleSystem::new(particles, law, reach, MARGIN * a, Space::Open),
            motion,
            binding: 0.0,
            length: 10.0 * a,
            tool_law: ToolLaw::new(a),
            contact_laws: ContactLaws::default(),
            scale,
            before: Vec::with_capacity(capacity),
            stiffest: 0.0,
            other_poisson: None,
        }
    }

    /// Binds particles to their initial positions, and says how long the slowest swing is [mm].
    pub fn bound(mut self, binding: f64, length: f64) -> Self {
        (self.binding, self.length) = (binding, length);
        self
    }

    /// Has particles be at home, and at rest, where they stand: what force is left there is taken off
    /// from now on, or those that have not come to rest would creep without being touched.
    pub fn settle(&mut self) {
        self.system.evaluate();
        let particles = &mut self.system.particles;
        for (site, home) in particles.sites.iter().zip(&mut particles.homes) {
            *home = site.position();
        }
        particles.left.clone_from(&particles.forces);
        particles.velocities.fill(DVec3::ZERO);
    }

    /// Where each particle is at rest and where it stands, in the patient.
    pub fn parts(&self) -> ModelParts {
        let spacing = self.grid.spacing();
        let patient = |place: DVec3| {
            let patient_from_grid = self.grid.patient_from_grid();
            patient_from_grid.transform_point3(place / spacing)
        };
        let places = self.places();
        ModelParts {
            places: places
                .map(|(place, moved)| [place - moved, place].map(patient))
                .collect(),
            apart: self.scale.equilibrium,
        }
    }

    /// Says how far from the contact the border stands still [mm].
    pub fn held_at(mut self, border: f64) -> Self {
        self.contact_laws = ContactLaws::held_at(border);
        self
    }

    pub fn places(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let Particles { sites, homes, .. } = &self.system.particles;
        sites
            .iter()
            .zip(homes)
            .map(|(site, &home)| (site.position(), site.position() - home))
    }

    /// Whether all particles are where tissue can be: no farther from home than this [mm].
    pub fn is_sound(&self, farthest: f64) -> bool {
        let Particles {
            sites,
            velocities,
            homes,
            ..
        } = &self.system.particles;
        let near = |(site, home): (&Site, &DVec3)| {
            site.position().distance_squared(*home) <= farthest.powi(2)
        };
        sites.iter().zip(homes).all(near) && velocities.iter().all(|v| v.is_finite())
    }

    /// The mass that lets every particle swing alike: 72 D/a².
    pub fn inertia(&self, depth: f64) -> f64 {
        72.0 * depth / self.scale.equilibrium.powi(2)
    }

    /// The depth of particles of this tissue [N·mm]. Where it gives way, its Poisson's ratio is noted.
    pub fn depth(&mut self, solid: &Solid, treatment: Treatment, by: Calibration) -> f64 {
        let asked = solid.poisson;
        if let (Some(used), Treatment::Deformable) = (self.scale.other_poisson(asked), treatment) {
            let event = ModelEvent::PoissonClamped { asked, used };
            self.other_poisson.get_or_insert(event);
        }
        self.scale.depth(solid, by)
    }

    /// What was asked for first that the lattice cannot do, where none was `reported` yet.
    pub fn report_poisson(&self, reported: &mut bool) -> Option<ModelEvent> {
        let event = self.other_poisson.filter(|_| !*reported);
        *reported |= event.is_some();
        event
    }

    /// Moves particles until they rest or the budget is spent.
    pub fn relax(
        &mut self,
        tools: &[(u32, ParticleTool)],
        budget: &Budget,
        open: Open<'_>,
    ) -> Relaxed {
        let mut felt = self.forces(tools);
        let mut report = ModelReport {
            residual: self.residual(&felt),
            nodes: self.system.particles.len() as u32,
            ..ModelReport::default()
        };
        let mut fire = Fire::new(self.scale.equilibrium);
        if self.motion == Motion::Rest {
            self.system.particles.velocities.fill(DVec3::ZERO);
        }
        while report.iterations < budget.iterations && !budget.is_late() {
            if report.residual < REST && self.is_slow() {
                break;
            }
            felt = self.step(&mut fire, tools, open);
            report.residual = self.residual(&felt);
            report.iterations += 1;
        }
        Relaxed { felt, report }
    }

    /// One step of the chosen motion.
    fn step(
        &mut self,
        fire: &mut Fire,
        tools: &[(u32, ParticleTool)],
        open: Open<'_>,
    ) -> Vec<ToolForce> {
        if open.is_some() {
            self.before.clear();
            self.before.extend(
                self.system
                    .particles
                    .sites
                    .iter()
                    .map(|site| site.position()),
            );
        }
        let felt = match self.motion {
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
        if let Some(open) = open {
            let particles = &mut self.system.particles;
            keep_inside(particles, &self.before, self.scale.cell, open);
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
        let critical = std::f64::consts::PI * self.scale.equilibrium / self.length;
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
        if self.binding > 0.0 {
            let Particles {
                sites,
                forces,
                homes,
                masses,
                left,
                ..
            } = particles;
            let homes = homes.iter().zip(left);
            for (((site, force), (home, left)), stiffness) in
                sites.iter().zip(forces).zip(homes).zip(masses)
            {
                *force -= *left + self.binding * *stiffness * (site.position() - *home);
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

    /// One contact for each tool that was given, usable or not.
    pub fn contacts(
        &mut self,
        given: &[ToolState],
        tools: &[(u32, ParticleTool)],
        felt: &[ToolForce],
    ) -> Vec<ToolContact> {
        self.contact_laws
            .of(&self.grid, &self.scale, given, tools, felt)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, UVec3};

    use super::super::calibration::LatticeKind;
    use super::super::lattices::FCC_BASIS;
    use super::super::pair_laws::FadedLaw;
    use super::super::state::Origin;
    use super::*;

    const STRAIN: f64 = 1e-3;

    /// Young's modulus [D/a³] of n³ cells between frictionless plates, sides free, every particle
    /// bound to where it rests.
    fn bound_block_modulus(cells: u32, binding: f64) -> f64 {
        let grid = Grid::new(
            UVec3::splat(cells),
            DVec3::ONE,
            DVec3::ZERO,
            DMat3::IDENTITY,
        );
        let scale = LatticeScale::new(LatticeKind::Fcc, 1.0);
        let (a, side) = (scale.equilibrium, f64::from(cells));
        let count = 4 * cells.pow(3) as usize;
        let grid = grid.expect("a grid of cubes");
        let mut body = ParticleBody::<FadedLaw>::new(&grid, scale, count, Motion::Rest);
        let inertia = body.inertia(1.0);
        for cell in grid.bounds().voxels() {
            for place in FCC_BASIS {
                let home = cell.as_dvec3() + place;
                let particles = &mut body.system.particles;
                particles.take(home, 1.0, inertia, Origin::default());
                if home.z < 0.3 || home.z > side - 0.3 {
                    particles.free.pop();
                    particles.free.push(DVec3::new(1.0, 1.0, 0.0));
                }
            }
        }
        let budget = Budget::iterations(4000);
        body.relax(&[], &budget, None);
        body.settle();
        body = body.bound(binding, side);
        let particles = &mut body.system.particles;
        for (site, home) in particles.sites.iter_mut().zip(&particles.homes) {
            site.z -= STRAIN * (home.z - 0.25);
        }
        body.relax(&[], &budget, None);
        let Particles { forces, homes, .. } = &body.system.particles;
        let plate = |(force, home): (&DVec3, &DVec3)| {
            if home.z > side - 0.3 { force.z } else { 0.0 }
        };
        let force: f64 = forces.iter().zip(homes).map(plate).sum();
        force / (side.powi(2) * STRAIN) * a.powi(3)
    }

    /// `global-lj` is the lattice of `fcc-lj` on springs. They add in proportion to their
    /// stiffness: without their part, which two of them tell, and without that of the surfaces,
    /// which falls with 1/n, compression gives back the modulus that was asked for.
    #[test]
    fn virtual_compression_on_springs_recovers_youngs_modulus() {
        let [small, large] = [6, 12].map(|cells| {
            let [soft, stiff] = [0.001, 0.002].map(|binding| bound_block_modulus(cells, binding));
            (2.0 * soft - stiff, (stiff - soft) / 0.001)
        });
        let young = 2.0 * large.0 - small.0;
        let scale = LatticeScale::new(LatticeKind::Fcc, 1.0);
        let asked = scale.young_of_depth(1.0) * scale.equilibrium.powi(3);
        println!(
            "global-lj: E = {:.1} (6³ cells), {:.1} (12³), extrapolated {young:.1}, asked {asked:.1} \
             D/a³; the springs add {:.0} and {:.0} D/a³ times their share",
            small.0, large.0, small.1, large.1
        );
        assert!((young / asked - 1.0).abs() < 0.02, "{young} {asked}");
        // by the square of the size, and more or less as a bar on springs has it
        assert!(
            (large.1 / small.1 / 4.0 - 1.0).abs() < 0.1,
            "{small:?} {large:?}"
        );
        assert!(
            (large.1 / added_by_springs(12) - 1.0).abs() < 0.1,
            "{large:?}"
        );
    }

    /// What springs of a link's stiffness add to the modulus of n³ cells pressed evenly [D/a³]: the
    /// particles go by the strain times their height, and to the sides by ν of that.
    fn added_by_springs(cells: u32) -> f64 {
        let scale = LatticeScale::new(LatticeKind::Fcc, 1.0);
        let side = f64::from(cells);
        let squares = side.powi(2) / 3.0 + (0.358 * side).powi(2) / 6.0;
        72.0 * scale.equilibrium / scale.volume() * squares
    }
}
