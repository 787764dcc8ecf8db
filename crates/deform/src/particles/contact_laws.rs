//! What tools feel among particles, as the linear laws that touch follows between two answers.
//!
//! Frame: forces and places of the patient [N, mm]. Source: thesis 5.16, 5.23.

use glam::{DMat3, DVec3};
use palpate_volume::grid::Grid;
use palpate_volume::material::LocalContact;

use super::calibration::LatticeScale;
use super::tool_push::{ParticleTool, ToolForce};
use crate::model::{ToolContact, ToolState};

/// The contacts of tools, and what is known of them from the call before.
#[derive(Debug, Default)]
pub(super) struct ContactLaws {
    /// From the contact to a border that stands still [mm]; none where there is none.
    border: Option<f64>,
    /// The contacts of the last call.
    last: Vec<ToolContact>,
}

impl ContactLaws {
    /// Laws for a body whose border is fixed at this distance from the contact [mm].
    pub fn held_at(border: f64) -> Self {
        Self {
            border: Some(border),
            last: Vec::new(),
        }
    }

    /// One contact for each tool that was given, usable or not.
    pub fn of(
        &mut self,
        grid: &Grid,
        scale: &LatticeScale,
        given: &[ToolState],
        tools: &[(u32, ParticleTool)],
        felt: &[ToolForce],
    ) -> Vec<ToolContact> {
        let mut contacts = Vec::with_capacity(given.len());
        for state in given {
            let found = tools.iter().zip(felt).find(|((id, _), _)| *id == state.id);
            let contact = found.and_then(|(_, felt)| self.contact(grid, scale, state, felt));
            contacts.push(ToolContact {
                tool: state.id,
                contact,
            });
        }
        self.last = contacts.clone();
        contacts
    }

    fn contact(
        &self,
        grid: &Grid,
        scale: &LatticeScale,
        tool: &ToolState,
        felt: &ToolForce,
    ) -> Option<LocalContact> {
        if felt.touched == 0 || !felt.force.is_finite() {
            return None;
        }
        let force = grid.direction() * felt.force;
        let normal = force.normalize_or_zero();
        // the contact itself and the body behind it in series, the body as under a flat punch of
        // the area that is touched (a² a particle): 2 E r/(1 − ν²), ν of the lattice near 0.36
        let touched = f64::from(felt.touched);
        let radius = scale.equilibrium * (touched / std::f64::consts::PI).sqrt();
        let body = 2.0 * scale.mean_young_of_depth(felt.depth / touched) * radius / 0.87;
        let body = body / self.share_that_gives(radius);
        let contact = felt.contact_stiffness;
        let stiffness = if contact > 0.0 {
            contact * body / (contact + body)
        } else {
            body
        };
        let stiffness = self.measured_stiffness(scale, tool, force, stiffness);
        let along = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Some(LocalContact {
            position: tool.position,
            force,
            stiffness: -stiffness * along,
            validity: 0.5 * scale.cell,
        })
    }

    /// What a border that stands still leaves of the body's compliance under a punch of this
    /// radius [mm]. On an endless body a point force moves a place d away by (1 − ν²)F/(π E d);
    /// held there, that is missing of (1 − ν²)F/(2 E r). For dents narrower than a third of the box
    /// nothing is taken off: what is missing there is made up for by the mean over all directions,
    /// which is stiffer than the axis. Source: Johnson, *Contact Mechanics* (1985), §3.2.
    fn share_that_gives(&self, radius: f64) -> f64 {
        let left = |radius: f64, border: f64| 1.0 - 2.0 * radius / (std::f64::consts::PI * border);
        let share = |border: f64| left(radius, border) / left(border / 3.0, border);
        // an area as wide as the box is no punch any more
        self.border.map_or(1.0, share).clamp(0.25, 1.0)
    }

    /// The stiffness along the force since the last call, where the tool has moved along it; at
    /// most four times more or less than `expected`, since tissue that slips is no spring.
    fn measured_stiffness(
        &self,
        scale: &LatticeScale,
        tool: &ToolState,
        force: DVec3,
        expected: f64,
    ) -> f64 {
        let normal = force.normalize_or_zero();
        let same = |last: &&ToolContact| last.tool == tool.id;
        let Some(last) = self.last.iter().find(same).and_then(|last| last.contact) else {
            return expected;
        };
        let moved = (tool.position - last.position).dot(normal);
        if moved.abs() < 0.01 * scale.cell {
            return expected;
        }
        let measured = (last.force - force).dot(normal) / moved;
        measured.clamp(0.25 * expected, 4.0 * expected)
    }
}
