//! How much of the light passes a cell over the length of its edge: by the mean optical thickness at some of its
//! places, of what is drawn there as the ray caster draws it. Eight cells of a row at a time.

use glam::{IVec3, Vec3};
use palpate_volume::simd_dispatch;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxel_box::VoxelBox;

use crate::appearance::Blend;
#[cfg(target_arch = "x86_64")]
use crate::lanes::Avx2;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Plain, Vector, exp_of_negative};
use crate::light_volume::Stop;
use crate::light_volume::cells::CellGrid;
use crate::light_volume::clarity::Clarity;
use crate::prepared::Prepared;
use crate::scene::Scene;
use crate::shading::{boundary, is_before_a_plane};

/// Places of a cell along each axis.
const PLACES: i32 = 3;

/// Optical thickness from which on a part of a cell lets nothing through; extinction of what is solid [1/mm].
const FULL: f32 = 9.0;

/// Sum of optical thickness that is none: there is a little in bricks that count as empty.
const NONE: f32 = 1e-3;

/// What all rows of cells have in common.
struct Job<'a> {
    scene: &'a Scene,
    prepared: &'a Prepared,
    grid: &'a CellGrid,
    edge_gradient: f32,
    flat_share: f32,
}

/// Looks at the cells of a box.
pub(super) fn look_at(
    clarity: &mut Clarity,
    grid: &CellGrid,
    (scene, prepared): (&Scene, &Prepared),
    region: &VoxelBox,
    (level, stop): (SimdLevel, Stop<'_>),
) -> Option<()> {
    let job = Job {
        scene,
        prepared,
        grid,
        edge_gradient: prepared.appearance.edge_gradient as f32,
        flat_share: 1.0 - prepared.appearance.lighting.edges,
    };
    clarity.change(region, |(y, z), row| {
        if stop() {
            return Err(());
        }
        row[region.min.x as usize..region.max.x as usize].fill(1.0);
        let filled: Vec<_> = (region.min.x..region.max.x)
            .filter(|&x| job.is_filled(IVec3::new(x, y, z)))
            .collect();
        look_at_row(&job, (y, z), &filled, row, level);
        Ok(())
    })
}

#[cfg(target_arch = "x86_64")]
simd_dispatch! {
    fn look_at_row(
        job: &Job<'_>,
        at: (i32, i32),
        cells: &[i32],
        row: &mut [f32],
        level: SimdLevel,
    ) = [avx2 => row_avx2] row_plain, at level
}

#[cfg(not(target_arch = "x86_64"))]
fn look_at_row(job: &Job<'_>, at: (i32, i32), cells: &[i32], row: &mut [f32], level: SimdLevel) {
    row_plain(job, at, cells, row, level);
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn row_avx2(job: &Job<'_>, at: (i32, i32), cells: &[i32], row: &mut [f32], _: SimdLevel) {
    job.row::<Avx2>(at, cells, row);
}

fn row_plain(job: &Job<'_>, at: (i32, i32), cells: &[i32], row: &mut [f32], _: SimdLevel) {
    job.row::<Plain>(at, cells, row);
}

impl Job<'_> {
    /// Whether a cell meets a brick in which something is drawn.
    fn is_filled(&self, cell: IVec3) -> bool {
        let size = self.grid.voxels;
        let low = (cell.as_vec3() * size).as_ivec3() >> 3_i32;
        let high = ((cell + 1).as_vec3() * size).as_ivec3() >> 3_i32;
        (low.z..=high.z).any(|z| {
            (low.y..=high.y).any(|y| {
                (low.x..=high.x).any(|x| self.prepared.empty.distance(IVec3::new(x, y, z)) == 0)
            })
        })
    }

    /// Some cells of a row.
    #[inline(always)]
    fn row<L: Gather>(&self, (y, z): (i32, i32), cells: &[i32], row: &mut [f32]) {
        for cells in cells.chunks(LANES) {
            let mut x = [cells[0]; LANES];
            x[..cells.len()].copy_from_slice(cells);
            let column = L::Int::load(&x).to_float();
            let corner = Vector::<L>::new(column, Floats::splat(y as f32), Floats::splat(z as f32));
            let shares = self.passing(corner).store();
            for (&x, share) in cells.iter().zip(shares) {
                row[x as usize] = share;
            }
        }
    }

    /// Fractions of the light that pass cells with these corners [cells].
    #[inline(always)]
    fn passing<L: Gather>(&self, corner: Vector<L>) -> L::Float {
        let size = Vector::<L>::splat(self.grid.voxels);
        let edge = L::Float::splat(self.grid.edge);
        let zero = L::Float::splat(0.0);
        let mut sum = zero;
        for i in 0..PLACES * PLACES * PLACES {
            let part = IVec3::new(i % PLACES, i / PLACES % PLACES, i / (PLACES * PLACES));
            let part: Vec3 = (part.as_vec3() + 0.5) / PLACES as f32;
            let place = (corner + Vector::splat(part)).times(size);
            let thickness = self.extinction_at(place) * edge;
            sum = sum + thickness.min(Floats::splat(FULL));
        }
        let mean = sum * Floats::splat(1.0 / (PLACES * PLACES * PLACES) as f32);
        let passing = exp_of_negative::<L>(zero - mean);
        passing.or_else(L::Float::splat(NONE).less(sum), Floats::splat(1.0))
    }

    /// Extinction of what is drawn at a place [1/mm].
    #[inline(always)]
    fn extinction_at<L: Gather>(&self, grid: Vector<L>) -> L::Float {
        let Self {
            scene: Scene { field, .. },
            prepared,
            ..
        } = self;
        let (zero, full) = (L::Float::splat(0.0), L::Float::splat(FULL));
        let value = field.value_at(grid);
        let code = prepared.segments.at(field, grid, value);
        let solid = prepared.segments.are_solid::<L>(code);
        let hidden = L::Int::splat(0).greater(code);
        let seen = !(hidden | is_before_a_plane(&prepared.planes, grid));
        let extinction = if prepared.appearance.blend == Blend::Iso {
            let height = value * Floats::splat(prepared.grey.0) + Floats::splat(prepared.grey.1);
            full.or_else(zero.at_most(height), zero)
        } else {
            self.extinction_of_tissue(grid, value, seen & !solid)
        };
        full.or_else(solid, extinction).or_else(seen, zero)
    }

    #[inline(always)]
    fn extinction_of_tissue<L: Gather>(
        &self,
        grid: Vector<L>,
        value: L::Float,
        asked: L::Mask,
    ) -> L::Float {
        let extinction = self.prepared.transfer.extinction_at::<L>(value)
            * Floats::splat(self.prepared.appearance.density);
        if !(asked & L::Float::splat(0.0).less(extinction)).any() {
            return extinction;
        }
        let gradient = self.scene.field.gradient_at(grid).length();
        let (kept, _) = boundary::<L>((self.edge_gradient, self.flat_share), gradient);
        extinction * kept
    }
}
