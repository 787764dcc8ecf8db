//! How much of the light passes a cell over the length of its edge: by the mean optical thickness at some of its
//! places, of what is drawn there as the ray caster draws it. Surfaces are as thick as the segments that they are drawn
//! for. Eight cells of a row at a time.

use std::ops::Range;

use glam::IVec3;
use palpate_volume::simd_dispatch;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxel_box::VoxelBox;

use crate::appearance::Blend;
#[cfg(target_arch = "x86_64")]
use crate::lanes::Avx2;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Plain, Vector, exp_of_negative};
use crate::light_volume::cells::CellGrid;
use crate::light_volume::clarity::Clarity;
use crate::light_volume::line::{Line, OnLine};
use crate::prepared::Prepared;
use crate::scene::Scene;
use crate::shading::{boundary, is_before_a_plane};
use crate::stop::Stop;
use crate::surfaces::DrawnSurface;

/// Places of a cell along each axis.
const PLACES: i32 = 3;

/// Optical thickness from which on a part of a cell lets nothing through; extinction of what is solid [1/mm].
const FULL: f32 = 9.0;

/// Length of a segment over which it lets as much light through as its surface does [mm].
const BODY: f32 = 10.0;

/// Sum of optical thickness that is none: there is a little in bricks that count as empty.
const NONE: f32 = 1e-3;

/// What all rows of cells have in common.
struct Job<'a> {
    scene: &'a Scene,
    prepared: &'a Prepared,
    grid: &'a CellGrid,
    edge_gradient: f32,
    flat_share: f32,
    surfaces: Vec<ShadingSurface<'a>>,
}

/// A surface drawn for a segment, as far as it keeps light off.
struct ShadingSurface<'a> {
    surface: DrawnSurface<'a>,
    /// In its segment [1/mm].
    extinction: f32,
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
        surfaces: shading_surfaces(scene, prepared),
    };
    clarity.change(region, |(y, z), row| {
        if stop() {
            return Err(());
        }
        row[region.min.x as usize..region.max.x as usize].fill(1.0);
        let filled = job.filled_cells((y, z), region.min.x..region.max.x);
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
    /// Cells of a row that meet a brick in which something is drawn.
    fn filled_cells(&self, (y, z): (i32, i32), cells: Range<i32>) -> Vec<i32> {
        let size = self.grid.voxels;
        let bricks = |cell: i32, voxels: f32| {
            (cell as f32 * voxels) as i32 >> 3..=((cell + 1) as f32 * voxels) as i32 >> 3
        };
        let columns = self.scene.ranges.counts.x;
        let empty = self.prepared.unlit();
        let is_filled = |x: i32| {
            bricks(z, size.z)
                .any(|z| bricks(y, size.y).any(|y| empty.distance(IVec3::new(x, y, z)) == 0))
        };
        let filled: Vec<_> = (0..columns).map(is_filled).collect();
        cells
            .filter(|&cell| bricks(cell, size.x).any(|x| filled[x.min(columns - 1) as usize]))
            .collect()
    }

    /// Some cells of a row, by rising number.
    #[inline(always)]
    fn row<L: Gather>(&self, (y, z): (i32, i32), cells: &[i32], row: &mut [f32]) {
        let (Some(first), Some(last)) = (cells.first(), cells.last()) else {
            return;
        };
        let columns = self.grid.columns_read_by(*first, *last);
        let size = self.grid.voxels;
        let mut line = Line::new(self.scene.field.dimensions().x as usize);
        let mut sums = vec![[0.0; LANES]; cells.len().div_ceil(LANES)];
        let with_gradient = self.prepared.appearance.blend != Blend::Iso;
        for i in 0..PLACES * PLACES {
            let place_y = (y as f32 + part(i % PLACES)) * size.y;
            let place_z = (z as f32 + part(i / PLACES)) * size.z;
            let place = (place_y, place_z);
            line.read(&self.scene.field, place, &columns, with_gradient);
            for (cells, sum) in cells.chunks(LANES).zip(&mut sums) {
                let mut x = [cells[0]; LANES];
                x[..cells.len()].copy_from_slice(cells);
                let x = L::Int::load(&x).to_float();
                let more = self.thickness::<L>(&line, x, place);
                *sum = (L::Float::load(sum) + more).store();
            }
        }
        for (cells, sum) in cells.chunks(LANES).zip(&sums) {
            let passing = passing::<L>(Floats::load(sum)).store();
            for (&x, share) in cells.iter().zip(passing) {
                row[x as usize] = share;
            }
        }
    }

    /// Sum of the optical thickness of cells at their places along a line. `x`: their numbers.
    #[inline(always)]
    fn thickness<L: Gather>(&self, line: &Line, x: L::Float, (y, z): (f32, f32)) -> L::Float {
        let edge = L::Float::splat(self.grid.edge);
        let mut sum = L::Float::splat(0.0);
        for i in 0..PLACES {
            let x = (x + Floats::splat(part(i))) * Floats::splat(self.grid.voxels.x);
            let grid = Vector::<L>::new(x, Floats::splat(y), Floats::splat(z));
            let thickness = self.extinction_at(line, grid) * edge;
            sum = sum + thickness.min(Floats::splat(FULL));
        }
        sum
    }

    /// Extinction of what is drawn at a place [1/mm].
    #[inline(always)]
    fn extinction_at<L: Gather>(&self, line: &Line, grid: Vector<L>) -> L::Float {
        let Self {
            scene: Scene { field, .. },
            prepared,
            ..
        } = self;
        let (zero, full) = (L::Float::splat(0.0), L::Float::splat(FULL));
        let place = line.at::<L>(grid.x);
        let value = place.value();
        let code = prepared.segments.at(field, grid, value);
        let solid = prepared.segments.are_solid::<L>(code);
        let hidden = L::Int::splat(0).greater(code);
        let kept = !is_before_a_plane(&prepared.planes, grid);
        let extinction = if prepared.appearance.blend == Blend::Iso {
            let height = value * Floats::splat(prepared.grey.0) + Floats::splat(prepared.grey.1);
            full.or_else(zero.at_most(height), zero)
        } else {
            self.extinction_of_tissue(value, place)
        };
        let surfaces = self.extinction_of_surfaces(grid, hidden);
        surfaces
            .or_else(hidden, full.or_else(solid, extinction))
            .or_else(kept, zero)
    }

    /// Of surfaces, at places of segments that are drawn as such.
    #[inline(always)]
    fn extinction_of_surfaces<L: Gather>(&self, grid: Vector<L>, hidden: L::Mask) -> L::Float {
        let mut extinction = L::Float::splat(0.0);
        if !hidden.any() {
            return extinction;
        }
        // the first one wins
        for it in self.surfaces.iter().rev() {
            let inside = it.surface.own_at(&self.scene.field, grid);
            extinction = L::Float::splat(it.extinction).or_else(inside, extinction);
        }
        extinction
    }

    #[inline(always)]
    fn extinction_of_tissue<L: Gather>(&self, value: L::Float, place: OnLine<'_, L>) -> L::Float {
        let density = self.prepared.appearance.density;
        let extinction = self.prepared.transfer.extinction_at::<L>(value) * Floats::splat(density);
        if !L::Float::splat(0.0).less(extinction).any() {
            return extinction;
        }
        let gradient = place.gradient().length();
        let (kept, _) = boundary::<L>((self.edge_gradient, self.flat_share), gradient);
        extinction * kept
    }
}

/// Surfaces that stand where the scan has their segments, and whose triangles are filled.
fn shading_surfaces<'a>(scene: &'a Scene, prepared: &'a Prepared) -> Vec<ShadingSurface<'a>> {
    let surfaces = DrawnSurface::all(scene, prepared);
    surfaces
        .into_iter()
        .filter(|it| it.surface.is_at_rest() && !it.shown.is_wireframe)
        .map(|surface| {
            let opacity = surface.shown.opacity;
            ShadingSurface {
                // light is that of voxels
                surface: DrawnSurface {
                    moving: None,
                    ..surface
                },
                extinction: if opacity > 0.99 {
                    FULL
                } else {
                    -(1.0 - opacity).ln() / BODY
                },
            }
        })
        .collect()
}

/// Where in a cell a place lies.
fn part(i: i32) -> f32 {
    (i as f32 + 0.5) / PLACES as f32
}

/// Fraction of the light that passes, from the sum of the optical thickness at all places.
#[inline(always)]
fn passing<L: Gather>(sum: L::Float) -> L::Float {
    let mean = sum * Floats::splat(1.0 / (PLACES * PLACES * PLACES) as f32);
    let passing = exp_of_negative::<L>(L::Float::splat(0.0) - mean);
    passing.or_else(L::Float::splat(NONE).less(sum), Floats::splat(1.0))
}
