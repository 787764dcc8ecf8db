//! The border of the box: what stands for the body behind it.
//!
//! Far from a force, displacement falls with 1/r and stress with 1/r², whatever the shape of the
//! contact. So at a border node the body behind is a spring: the ratio of stress to displacement
//! of a point force in the middle of the contact. That ratio is taken from a force in an
//! unbounded body (Kelvin); under a free surface (Boussinesq) it differs by some percent.
//! Source: A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity (1927), §130.

use glam::{DMat3, DVec3};

use super::nodes::Lattice;
use super::vectors::{Field, vector_at};
use crate::material::Solid;

/// What the border of a box does where tissue goes on behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Border {
    /// Nothing: the body ends there.
    Free,
    /// It does not move.
    Held,
    /// It gives as an endless body would under a force at this place [mm, lattice's frame].
    Endless {
        /// The middle of the contact.
        load: DVec3,
    },
}

/// A spring between a border node and the body behind it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    /// The node.
    pub node: u32,
    /// Symmetric, not negative [N/mm].
    pub stiffness: DMat3,
    /// Displacement of the spring's other end [mm].
    pub led: DVec3,
}

impl Lattice {
    /// Moves the body behind the border, as a coarser model of all of it says: `displacement`
    /// [mm] is asked for places [mm] in the lattice's frame. Held border nodes go there, others
    /// are drawn there by their springs.
    pub fn lead_border(&mut self, displacement: impl Fn(DVec3) -> DVec3) {
        for index in 0..self.layout.len() {
            if self.border == Border::Held && self.cut[index] != 0 {
                let moved = displacement(self.rest_place(index));
                self.set_moved(index, moved);
            }
        }
        let mut ground = std::mem::take(&mut self.ground);
        for ground in &mut ground {
            ground.led = displacement(self.rest_place(ground.node as usize));
        }
        self.ground = ground;
    }

    /// Has the body behind the border rest where its nodes do: `lasting` [mm from where they were at
    /// first], one for each node.
    pub(super) fn rest_border_at(&mut self, plastic: &Field) {
        for ground in &mut self.ground {
            ground.led = vector_at(plastic, ground.node as usize);
        }
    }
}

/// Stress over displacement at a place on the border, with the sign of a spring [N/mm³]:
/// `from_load` [mm] leads there from the load, `outward` is the border's normal.
pub(super) fn spring_of_endless_body(solid: &Solid, from_load: DVec3, outward: DVec3) -> DMat3 {
    let (distance, nu) = (from_load.length(), solid.poisson);
    let radial = from_load / distance;
    let along = outer(radial, radial);
    let facing = radial.dot(outward);

    // stress on the border, and displacement, for each component of the force; the common
    // factor 1 / (8 π (1 - ν)) is left out of both
    let stress = ((DMat3::IDENTITY * facing + outer(radial, outward) - outer(outward, radial))
        * (1.0 - 2.0 * nu)
        + along * (3.0 * facing))
        * (1.0 / (distance * distance));
    let force_by_moved = ((DMat3::IDENTITY - along) * (1.0 / (3.0 - 4.0 * nu))
        + along * (1.0 / (4.0 - 4.0 * nu)))
        * (2.0 * solid.shear() * distance);

    // the part that is not symmetric would give or take energy on a way around
    let spring = stress * force_by_moved;
    (spring + spring.transpose()) * 0.5
}

/// The matrix a bᵀ.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
