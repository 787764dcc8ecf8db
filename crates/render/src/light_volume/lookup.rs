//! How the light that reaches a place is looked up: trilinear between the middles of cells.

use glam::{IVec3, Vec3};

use crate::field::both;
use crate::lanes::{Floats, Gather, Ints, LANES, Vector};
use crate::light_volume::{LightVolume, WHOLE};
use crate::lighting::Reaching;

/// A place is looked up so far before its surface [cells], so that it does not shade itself.
pub(super) const LEAD: f32 = 1.5;

/// How the light of a volume is looked up.
#[derive(Clone, Copy)]
pub(crate) struct LightLookup<'a> {
    volume: Option<&'a LightVolume>,
    /// Cells for each voxel along each axis.
    scale: Vec3,
    /// From a surface to where its light is looked up [voxels along each axis for a unit vector].
    lead: Vec3,
    occlusion: f32,
    shadow: f32,
}

impl<'a> LightLookup<'a> {
    pub fn new(
        volume: Option<&'a LightVolume>,
        dimensions: Vec3,
        spacing: Vec3,
        (occlusion, shadow): (f32, f32),
    ) -> Self {
        let volume = volume.filter(|_| occlusion > 0.0 || shadow > 0.0);
        let (counts, edge) = volume.map_or((IVec3::ONE, 0.0), |it| (it.grid.counts, it.grid.edge));
        Self {
            volume,
            scale: counts.as_vec3() / dimensions,
            lead: LEAD * edge / spacing,
            occlusion,
            shadow,
        }
    }

    /// What reaches a surface; `away`: from it, along the grid's axes, at most 1 long.
    #[inline(always)]
    pub fn at<L: Gather>(&self, grid: Vector<L>, away: Vector<L>) -> Reaching<L> {
        let one = L::Float::splat(1.0);
        let Some(volume) = self.volume else {
            return Reaching {
                sky: one,
                lamp: one,
            };
        };
        let place = (grid + away.times(Vector::splat(self.lead))).times(Vector::splat(self.scale));
        let [sky, lamp] = volume.mixed::<L>(place);
        Reaching {
            sky: one + (sky - one) * Floats::splat(self.occlusion),
            lamp: one + (lamp - one) * Floats::splat(self.shadow),
        }
    }
}

impl LightVolume {
    /// Trilinear between the middles of cells; `place` in cells.
    #[inline(always)]
    fn mixed<L: Gather>(&self, place: Vector<L>) -> [L::Float; 2] {
        let counts = self.grid.counts;
        let (x, x_share) = between::<L>(place.x, counts.x);
        let (y, y_share) = between::<L>(place.y, counts.y);
        let (z, z_share) = between::<L>(place.z, counts.z);
        let first = x + (y + z * Ints::splat(counts.y)) * Ints::splat(counts.x);
        let first = (first + first).store();
        let row = if counts.y > 1 { 2 * counts.x } else { 0 };
        let layer = if counts.z > 1 {
            2 * counts.x * counts.y
        } else {
            0
        };
        let near = mix::<L>(
            self.row::<L>(&first, 0, x_share),
            self.row::<L>(&first, row, x_share),
            y_share,
        );
        let far = mix::<L>(
            self.row::<L>(&first, layer, x_share),
            self.row::<L>(&first, layer + row, x_share),
            y_share,
        );
        mix::<L>(near, far, z_share)
    }

    /// Mixed between a cell and the next of its row; `first` is the cell's place in memory.
    #[inline(always)]
    fn row<L: Gather>(&self, first: &[i32; LANES], offset: i32, share: L::Float) -> [L::Float; 2] {
        // SAFETY: the first of two cells was clamped to those before the last along each axis, where there are
        // two; behind the last there is one more in memory
        let [first, second] = unsafe { L::fours(&self.cells, first, offset) };
        let unit = L::Float::splat(1.0 / WHOLE);
        let ([a_sky, a_lamp], [b_sky, b_lamp]) = (both::<L>(first), both::<L>(second));
        mix::<L>(
            [a_sky * unit, a_lamp * unit],
            [b_sky * unit, b_lamp * unit],
            share,
        )
    }
}

/// The first of the two cells between whose middles a place lies, and the fraction of the way to the second.
#[inline(always)]
fn between<L: Gather>(place: L::Float, count: i32) -> (L::Int, L::Float) {
    let inside = (place - Floats::splat(0.5))
        .max(Floats::splat(0.0))
        .min(Floats::splat((count - 1) as f32));
    let first = inside.truncated().min(Ints::splat((count - 2).max(0)));
    (first, inside - first.to_float())
}

#[inline(always)]
fn mix<L: Gather>(a: [L::Float; 2], b: [L::Float; 2], share: L::Float) -> [L::Float; 2] {
    [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]
}
