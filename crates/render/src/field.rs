//! The scan as a continuous field: trilinear between the centres of voxels, constant beyond the outermost.
//!
//! Positions are those of the grid, values stored ones. Where an edit has put other values over the scan's,
//! they are read voxel by voxel; everywhere else eight rays at once.

use std::ops::Range;
use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};
use palpate_volume::brick_grid::BRICK;
use palpate_volume::grid::voxel_index;
use palpate_volume::intensities::Intensities;
use palpate_volume::overlay::Overlay;

use crate::bricks::brick_index;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Vector};

/// A scan with what edits put over it.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    dimensions: UVec3,
    /// Stored values, x fastest; of a scan of one column with that column twice.
    values: Arc<[i16]>,
    /// From a voxel to the next along each axis, 0 where there is none.
    strides: [i32; 3],
    spacing: Vec3,
    slope: f32,
    scan: Intensities,
    overlay: Option<Edited>,
}

/// Values that edits put over the scan's, and where reading meets them.
#[derive(Clone, Debug)]
struct Edited {
    overlay: Overlay,
    /// 1 for each brick in which, or beside which, there are such values; three bytes of padding.
    bricks: Vec<u8>,
    counts: IVec3,
}

impl Field {
    /// A scan of voxels of this size [mm].
    pub fn new(scan: &Intensities, overlay: &Overlay, spacing: Vec3) -> Self {
        let dimensions = scan.dimensions();
        let columns = dimensions.x.max(2) as i32;
        let stride = |size: u32, stride: i32| if size > 1 { stride } else { 0 };
        Self {
            dimensions,
            values: if dimensions.x > 1 {
                Arc::clone(scan.values())
            } else {
                scan.values().iter().flat_map(|&value| [value; 2]).collect()
            },
            strides: [
                stride(dimensions.x, 1),
                stride(dimensions.y, columns),
                stride(dimensions.z, columns * dimensions.y as i32),
            ],
            spacing,
            slope: scan.slope() as f32,
            scan: scan.clone(),
            overlay: Edited::of(overlay),
        }
    }

    pub fn dimensions(&self) -> UVec3 {
        self.dimensions
    }

    pub fn spacing(&self) -> Vec3 {
        self.spacing
    }

    /// Stored value at a place.
    #[inline(always)]
    pub fn value_at<L: Gather>(&self, grid: Vector<L>) -> L::Float {
        let taps = Taps::<L>::at(self, grid);
        let value = taps.trilinear(self);
        match &self.overlay {
            None => value,
            Some(edited) => {
                let near = edited.are_near::<L>(grid);
                if near.any() {
                    self.with_edits::<L>(edited, grid, value, near.bits())
                } else {
                    value
                }
            }
        }
    }

    /// Gradient of the value in the scan's unit [per mm] along the grid's axes: central differences over a voxel
    /// to each side.
    #[inline(always)]
    pub fn gradient_at<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        let taps = Taps::<L>::at(self, grid);
        let is_near = |edited: &Edited| edited.are_near::<L>(grid).any();
        let difference =
            if taps.are_inside(self).all() && !self.overlay.as_ref().is_some_and(is_near) {
                taps.differences(self)
            } else {
                self.differences_one_by_one::<L>(grid)
            };
        difference.times(Vector::splat(self.gradient_scale()))
    }

    #[inline(always)]
    fn differences_one_by_one<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        let (x, y, z) = (
            Vector::splat(Vec3::X),
            Vector::splat(Vec3::Y),
            Vector::splat(Vec3::Z),
        );
        Vector::new(
            self.value_at(grid + x) - self.value_at(grid - x),
            self.value_at(grid + y) - self.value_at(grid - y),
            self.value_at(grid + z) - self.value_at(grid - z),
        )
    }

    /// `values`, but in lanes that are near edits the true ones.
    #[inline(never)]
    fn with_edits<L: Gather>(
        &self,
        edited: &Edited,
        grid: Vector<L>,
        values: L::Float,
        near: u8,
    ) -> L::Float {
        let (x, y, z) = (grid.x.store(), grid.y.store(), grid.z.store());
        let mut values = values.store();
        for i in (0..LANES).filter(|lane| near >> lane & 1 == 1) {
            values[i] = self.edited_value(edited, Vec3::new(x[i], y[i], z[i]));
        }
        Floats::load(&values)
    }

    fn edited_value(&self, edited: &Edited, place: Vec3) -> f32 {
        let last = self.dimensions.as_ivec3() - 1;
        let place = (place - 0.5).clamp(Vec3::ZERO, last.as_vec3());
        let first = place.as_ivec3();
        let share = place - first.as_vec3();
        let stored = |x, y, z| {
            let voxel = (first + IVec3::new(x, y, z)).min(last);
            let stored = edited.overlay.stored(&self.scan, voxel);
            f32::from(stored.unwrap_or_default())
        };
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let row = |y, z| mix(stored(0, y, z), stored(1, y, z), share.x);
        let plane = |z| mix(row(0, z), row(1, z), share.y);
        mix(plane(0), plane(1), share.z)
    }

    /// Stored values of some columns of a row within the grid, edits included; `memory` is as long as a row.
    pub fn row<'a>(
        &'a self,
        y: i32,
        z: i32,
        columns: &Range<usize>,
        memory: &'a mut [i16],
    ) -> &'a [i16] {
        let start = voxel_index(self.dimensions, IVec3::new(0, y, z));
        let own = &self.scan.values()[start + columns.start..start + columns.end];
        let Some(edited) = &self.overlay else {
            return own;
        };
        let bricks = edited.bricks_of_row(y, z);
        let read = columns.start / BRICK as usize..columns.end.div_ceil(BRICK as usize);
        if bricks[read.clone()].iter().all(|&is_near| is_near == 0) {
            return own;
        }
        let memory = &mut memory[..own.len()];
        memory.copy_from_slice(own);
        for brick in read.filter(|&brick| bricks[brick] != 0) {
            let first = (brick * BRICK as usize).max(columns.start);
            let end = ((brick + 1) * BRICK as usize).min(columns.end);
            for x in first..end {
                memory[x - columns.start] = self.stored(IVec3::new(x as i32, y, z));
            }
        }
        memory
    }

    /// From differences over two voxels along each axis to a gradient in the scan's unit [per mm].
    pub fn gradient_scale(&self) -> Vec3 {
        self.slope / (2.0 * self.spacing)
    }

    /// Stored value of a voxel, edits included; the nearest one outside the grid.
    pub fn stored(&self, voxel: IVec3) -> i16 {
        let voxel = voxel.clamp(IVec3::ZERO, self.dimensions.as_ivec3() - 1);
        match &self.overlay {
            Some(edited) => edited.overlay.stored(&self.scan, voxel).unwrap_or_default(),
            None => self.scan.values()[voxel_index(self.dimensions, voxel)],
        }
    }
}

impl Edited {
    /// None where no brick has been edited.
    fn of(overlay: &Overlay) -> Option<Self> {
        let bricks = overlay.bricks();
        if bricks.is_empty() {
            return None;
        }
        let counts = bricks.size().as_ivec3();
        let mut near = vec![0; bricks.len() + 3];
        for (index, _) in (0..)
            .zip(bricks.entries())
            .filter(|(_, brick)| brick.is_some())
        {
            let brick = bricks.box_of(index).min / BRICK;
            let (low, high) = ((brick - 1).max(IVec3::ZERO), (brick + 1).min(counts - 1));
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    let row = counts.x * (y + counts.y * z);
                    near[(row + low.x) as usize..=(row + high.x) as usize].fill(1);
                }
            }
        }
        Some(Self {
            overlay: overlay.clone(),
            bricks: near,
            counts,
        })
    }

    /// Whether there are such values in, or beside, each brick of a row.
    fn bricks_of_row(&self, y: i32, z: i32) -> &[u8] {
        let first = self.counts.x * ((y >> 3_i32) + self.counts.y * (z >> 3_i32));
        &self.bricks[first as usize..(first + self.counts.x) as usize]
    }

    /// Whether there are such values in, or beside, the bricks of places.
    #[inline(always)]
    fn are_near<L: Gather>(&self, grid: Vector<L>) -> L::Mask {
        // SAFETY: the bricks lie within the grid, and there are three bytes more in memory
        let near = unsafe { L::bytes(&self.bricks, brick_index::<L>(grid, self.counts)) };
        near.greater(Ints::splat(0))
    }
}

/// The voxels between whose centres a place lies.
#[derive(Clone, Copy)]
struct Taps<L: Gather> {
    /// Places in memory of the first, and fractions of the way to the next along each axis.
    first: [i32; LANES],
    share: Vector<L>,
    /// Coordinates of the first.
    corner: [L::Int; 3],
}

impl<L: Gather> Taps<L> {
    #[inline(always)]
    fn at(field: &Field, grid: Vector<L>) -> Self {
        let half = L::Float::splat(0.5);
        let (x, x_share) = Self::along_axis(grid.x - half, field.dimensions.x);
        let (y, y_share) = Self::along_axis(grid.y - half, field.dimensions.y);
        let (z, z_share) = Self::along_axis(grid.z - half, field.dimensions.z);
        let [_, row, plane] = field.strides;
        let first = x + y * Ints::splat(row) + z * Ints::splat(plane);
        Self {
            first: first.store(),
            share: Vector::new(x_share, y_share, z_share),
            corner: [x, y, z],
        }
    }

    /// The first of two voxels and the fraction of the way to the second; what is no number is the first.
    #[inline(always)]
    fn along_axis(place: L::Float, size: u32) -> (L::Int, L::Float) {
        let inside = place
            .max(Floats::splat(0.0))
            .min(Floats::splat((size - 1) as f32));
        let first = inside
            .truncated()
            .min(Ints::splat(size as i32 - 2))
            .max(Ints::splat(0));
        (first, inside - first.to_float())
    }

    /// Whether there is one more voxel around all of these, and the place is not beyond the outermost centres.
    #[inline(always)]
    fn are_inside(self, field: &Field) -> L::Mask {
        let size = field.dimensions.as_ivec3();
        let mut inside = L::Mask::splat(true);
        for (corner, size) in self.corner.into_iter().zip(size.to_array()) {
            inside =
                inside & corner.greater(Ints::splat(0)) & L::Int::splat(size - 2).greater(corner);
        }
        inside
    }

    /// Two neighbouring values along x, mixed; `offset` voxels from the first in memory.
    #[inline(always)]
    fn row(self, field: &Field, offset: i32) -> L::Float {
        // SAFETY: callers stay among the voxels around a corner that lies within the grid, which has at
        // least two columns in memory
        let pair = unsafe { L::pairs(&field.values, &self.first, offset) };
        let [low, high] = both::<L>(pair);
        mixed::<L>(low, high, self.share.x)
    }

    /// The same of a row with one more voxel to each side, and the difference of what it is one voxel after and before.
    #[inline(always)]
    fn row_and_step(self, field: &Field, offset: i32) -> (L::Float, L::Float) {
        // SAFETY: as in `row`; the corner is inside, so that there are these voxels too
        let [before, after] = unsafe { L::fours(&field.values, &self.first, offset - 1) };
        let ([a, b], [c, d]) = (both::<L>(before), both::<L>(after));
        let step = mixed::<L>(c, d, self.share.x) - mixed::<L>(a, b, self.share.x);
        (mixed::<L>(b, c, self.share.x), step)
    }

    #[inline(always)]
    fn trilinear(self, field: &Field) -> L::Float {
        let [_, y, z] = field.strides;
        let near = mixed::<L>(self.row(field, 0), self.row(field, y), self.share.y);
        let far = mixed::<L>(self.row(field, z), self.row(field, z + y), self.share.y);
        mixed::<L>(near, far, self.share.z)
    }

    /// Differences of trilinear values one voxel before and one after, along each axis; the corners must be inside.
    #[inline(always)]
    fn differences(self, field: &Field) -> Vector<L> {
        let [_, y, z] = field.strides;
        let Vector {
            y: y_share,
            z: z_share,
            ..
        } = self.share;
        let (r00, x00) = self.row_and_step(field, 0);
        let (r10, x10) = self.row_and_step(field, y);
        let (r01, x01) = self.row_and_step(field, z);
        let (r11, x11) = self.row_and_step(field, z + y);
        let along_x = mixed::<L>(
            mixed::<L>(x00, x10, y_share),
            mixed::<L>(x01, x11, y_share),
            z_share,
        );
        let along_y = mixed::<L>(
            mixed::<L>(r10, self.row(field, y + y), y_share)
                - mixed::<L>(self.row(field, -y), r00, y_share),
            mixed::<L>(r11, self.row(field, z + y + y), y_share)
                - mixed::<L>(self.row(field, z - y), r01, y_share),
            z_share,
        );
        let along_z = mixed::<L>(
            mixed::<L>(r01, self.row(field, z + z), z_share)
                - mixed::<L>(self.row(field, -z), r00, z_share),
            mixed::<L>(r11, self.row(field, z + z + y), z_share)
                - mixed::<L>(self.row(field, y - z), r10, z_share),
            y_share,
        );
        Vector::new(along_x, along_y, along_z)
    }
}

/// Two neighbouring values that were read together.
#[inline(always)]
pub(crate) fn both<L: Gather>(pair: L::Int) -> [L::Float; 2] {
    [
        pair.shifted_left::<16>().shifted_right::<16>().to_float(),
        pair.shifted_right::<16>().to_float(),
    ]
}

#[inline(always)]
fn mixed<L: Gather>(a: L::Float, b: L::Float, share: L::Float) -> L::Float {
    a + (b - a) * share
}
