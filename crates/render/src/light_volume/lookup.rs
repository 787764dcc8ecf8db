//! How the light that reaches a place is looked up: trilinear between the middles of cells.

use glam::{IVec3, Vec3};

use crate::lanes::{Floats, Gather, Ints, Vector};
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
        let (x0, x1, x) = between::<L>(place.x, counts.x);
        let (y0, y1, y) = between::<L>(place.y, counts.y);
        let (z0, z1, z) = between::<L>(place.z, counts.z);
        let rows = Ints::splat(counts.x);
        let layers = L::Int::splat(counts.x * counts.y);
        let (y0, y1) = (y0 * rows, y1 * rows);
        let (z0, z1) = (z0 * layers, z1 * layers);
        let near = mix::<L>(
            self.row::<L>(x0, x1, x, y0 + z0),
            self.row::<L>(x0, x1, x, y1 + z0),
            y,
        );
        let far = mix::<L>(
            self.row::<L>(x0, x1, x, y0 + z1),
            self.row::<L>(x0, x1, x, y1 + z1),
            y,
        );
        mix::<L>(near, far, z)
    }

    #[inline(always)]
    fn row<L: Gather>(
        &self,
        x0: L::Int,
        x1: L::Int,
        share: L::Float,
        row: L::Int,
    ) -> [L::Float; 2] {
        mix::<L>(self.cell::<L>(x0 + row), self.cell::<L>(x1 + row), share)
    }

    #[inline(always)]
    fn cell<L: Gather>(&self, index: L::Int) -> [L::Float; 2] {
        // SAFETY: each coordinate was clamped to the cells, which have two numbers each
        let both = unsafe { L::pairs(&self.cells, index + index) };
        let unit = L::Float::splat(1.0 / WHOLE);
        [
            both.shifted_left::<16>().shifted_right::<16>().to_float() * unit,
            both.shifted_right::<16>().to_float() * unit,
        ]
    }
}

/// The two cells between whose middles a place lies, and the fraction of the way.
#[inline(always)]
fn between<L: Gather>(place: L::Float, count: i32) -> (L::Int, L::Int, L::Float) {
    let inside = (place - Floats::splat(0.5))
        .max(Floats::splat(0.0))
        .min(Floats::splat((count - 1) as f32));
    let first = inside.truncated();
    let second = (first + Ints::splat(1)).min(Ints::splat(count - 1));
    (first, second, inside - first.to_float())
}

#[inline(always)]
fn mix<L: Gather>(a: [L::Float; 2], b: [L::Float; 2], share: L::Float) -> [L::Float; 2] {
    [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]
}
