//! Which of two scans is seen where both are: both, or one of them by turns, in cells or in time.
//!
//! Cells run along the first scan's axes from its corner. The page's shaders have the same
//! (`shaders/second/second_ray.glsl`).

use crate::lanes::{Floats, Gather, Masks, Vector};
use crate::march::Packet;
use crate::second::Second;

/// Which of both scans is seen, wherever the second is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Turns {
    /// Both, one through the other.
    #[default]
    Together,
    /// One or the other by turns, in cubes of this edge [mm] along the first scan's axes, from its corner; in modes with
    /// one value for each ray, in squares of the plane through the middle of the view.
    Cells(f32),
    /// The second alone.
    Second,
}

/// A side between two cells that rays come through.
pub(crate) struct Side<L: Gather> {
    /// Lengths along them a little before [mm].
    pub before: L::Float,
    /// Which rays do.
    pub is_crossed: L::Mask,
    /// Its normal, against the ray.
    pub face: Vector<L>,
}

/// Of what is counted along three axes, every other place.
#[inline(always)]
fn is_odd<L: Gather>(place: Vector<L>) -> L::Mask {
    let half = (place.x.floor() + place.y.floor() + place.z.floor()) * Floats::splat(0.5);
    L::Float::splat(0.25).less(half - half.floor())
}

impl Second {
    /// Whether places of the first scan show it, and nothing of the first.
    #[inline(always)]
    pub fn has_turn<L: Gather>(&self, grid: Vector<L>) -> L::Mask {
        match self.turns {
            Turns::Together => Masks::splat(false),
            Turns::Cells(edge) => {
                self.holds(self.place(grid)) & is_odd::<L>(self.in_cells(grid, edge))
            }
            Turns::Second => self.holds(self.place(grid)),
        }
    }

    /// Whether places of its own show it, alone or with the first.
    #[inline(always)]
    pub fn shows_own<L: Gather>(&self, place: Vector<L>) -> L::Mask {
        if self.turns == Turns::Together {
            return Masks::splat(true);
        }
        let back = &self.first_from_own;
        let [x, y, z]: [Vector<L>; 3] =
            [back.x_axis, back.y_axis, back.z_axis].map(|it| Vector::splat(it.into()));
        let grid = Vector::splat(back.translation.into())
            + x.scaled(place.x)
            + y.scaled(place.y)
            + z.scaled(place.z);
        self.has_turn(grid)
    }

    /// Whether rays show it alone, in modes with one value for each ray; `in_plane`: where they come through the plane
    /// through the middle of the view, to the right and up [mm].
    #[inline(always)]
    pub fn has_ray<L: Gather>(&self, (right, up): (L::Float, L::Float)) -> L::Mask {
        match self.turns {
            Turns::Together => Masks::splat(false),
            Turns::Cells(edge) => {
                let per_mm = L::Float::splat(1.0 / edge);
                is_odd::<L>(Vector::new(right * per_mm, up * per_mm, Floats::splat(0.0)))
            }
            Turns::Second => Masks::splat(true),
        }
    }

    /// Where rays come from another cell a little before a length, and through which side; nowhere without cells.
    #[inline(always)]
    pub fn side_before<L: Gather>(
        &self,
        packet: &Packet<L>,
        length: L::Float,
        step: f32,
    ) -> Side<L> {
        let before = length - Floats::splat(0.1 * step);
        let Turns::Cells(edge) = self.turns else {
            return Side {
                before,
                is_crossed: Masks::splat(false),
                face: packet.face,
            };
        };
        let here = self.in_cells(packet.at(length), edge);
        let there = self.in_cells(packet.at(before), edge);
        let against = |here: L::Float, there: L::Float, direction: L::Float| {
            let crossed = (here.floor() - there.floor()).abs();
            let forward = L::Float::splat(0.0).at_most(direction);
            (L::Float::splat(0.0) - crossed).or_else(forward, crossed)
        };
        let face = Vector::new(
            against(here.x, there.x, packet.direction.x),
            against(here.y, there.y, packet.direction.y),
            against(here.z, there.z, packet.direction.z),
        );
        Side {
            before,
            is_crossed: L::Float::splat(0.5).less(face.length()),
            face: face.normalized(),
        }
    }

    #[inline(always)]
    fn in_cells<L: Gather>(&self, grid: Vector<L>, edge: f32) -> Vector<L> {
        grid.times(Vector::splat(self.spacing / edge))
    }
}
