//! A tool among particles: a rigid ball or ellipsoid that pushes them away and never pulls.
//!
//! The repulsive part of Lennard-Jones (WCA) over the distance to the tool's surface, with the
//! tissue of each particle: a particle whose centre is half a link from the surface just
//! touches. For the ellipsoid the distance is that of its level, scaled by the smallest half
//! axis: exact for a ball, and a function of place alone, so that the force is conservative.
//! Source: thesis 5.16, and 5.20 for the limit.

use glam::{DMat3, DVec3};

use palpate_volume::grid::Grid;

use super::calibration::FORCE_LIMIT;
use super::state::Particles;
use crate::model::ToolState;
use crate::potential::{LennardJones, Limited, PairLaw, Repulsive};

/// A tool in the frame of the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleTool {
    /// Centre of the tool [mm].
    pub centre: DVec3,
    /// Half axes [mm], along its own axes.
    pub half_axes: DVec3,
    /// Takes its own axes to those of the particles.
    pub orientation: DMat3,
}

impl ParticleTool {
    /// A tool as it stands in a grid: mm along its axes, from its corner.
    pub fn of(tool: &ToolState, grid: &Grid) -> Self {
        Self {
            centre: grid.grid_from_patient().transform_point3(tool.position) * grid.spacing(),
            half_axes: tool.shape.half_axes(),
            orientation: grid.direction().transpose() * DMat3::from_quat(tool.orientation),
        }
    }
}

impl ParticleTool {
    /// Makes it at least as thick as that in every direction [half axis, mm].
    pub fn widen(&mut self, least: f64) {
        self.half_axes = self.half_axes.max(DVec3::splat(least));
    }

    /// All tools that are bodies at a place, with the numbers by which their contacts are told.
    pub fn usable(tools: &[ToolState], grid: &Grid) -> Vec<(u32, Self)> {
        let usable = tools.iter().filter(|tool| tool.is_usable());
        usable.map(|tool| (tool.id, Self::of(tool, grid))).collect()
    }
}

/// What a tool feels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolForce {
    /// Force on it [N].
    pub force: DVec3,
    /// Particles that it touches.
    pub touched: u32,
    /// How fast the push grows along its force, all particles standing still [N/mm].
    pub contact_stiffness: f64,
    /// Stiffest of these contacts over 72 D/a² of its particle: by it, steps are chosen.
    pub stiffest: f64,
    /// Σ D over the touched particles [N·mm].
    pub depth: f64,
}

/// The law between a tool and particles with equilibrium distance a.
#[derive(Clone, Copy, Debug)]
pub struct ToolLaw {
    equilibrium: f64,
    unit: Repulsive<Limited<LennardJones>>,
}

impl ToolLaw {
    /// # Panics
    /// Where a is no length.
    pub fn new(equilibrium: f64) -> Self {
        let law = LennardJones::new(equilibrium, 1.0).expect("a is a length");
        let limit = FORCE_LIMIT / equilibrium;
        let limited = Limited::new(law, limit).expect("the limit is above f*");
        Self {
            equilibrium,
            unit: Repulsive(limited),
        }
    }

    /// Adds the tool's push to the forces on all free particles, and tells what it feels.
    pub fn push(&self, tool: &ParticleTool, particles: &mut Particles) -> ToolForce {
        let own_from_here = tool.orientation.transpose();
        let half_axes = tool.half_axes + 0.5 * self.equilibrium;
        let scale = half_axes.min_element();
        let reach = half_axes.max_element().powi(2);
        let mut felt = ToolForce::default();
        let Particles { sites, forces, .. } = particles;
        for (site, force) in sites.iter().zip(forces) {
            let offset = site.position() - tool.centre;
            let squared = offset.length_squared();
            if squared.is_nan() || squared >= reach {
                continue;
            }
            let scaled = own_from_here * offset / half_axes;
            let level = scaled.length();
            if !(level < 1.0 && level > 1e-9) {
                continue;
            }
            let distance = self.equilibrium + (level - 1.0) * scale;
            let depth = site.softness.recip();
            let size = depth * self.unit.force(distance.max(0.0));
            let direction = tool.orientation * (scale / level * (scaled / half_axes));
            *force += size * direction;
            felt.force -= size * direction;
            felt.touched += 1;
            felt.depth += depth;
            let h = 1e-4 * self.equilibrium;
            let softer = self.unit.force((distance + h).max(0.0));
            let stiffness = (size - depth * softer) / h;
            felt.contact_stiffness += stiffness;
            let of_link = 72.0 * depth / self.equilibrium.powi(2);
            felt.stiffest = felt.stiffest.max(stiffness / of_link);
        }
        felt
    }
}
