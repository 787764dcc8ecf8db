//! A procedural human trunk: the scan that Palpate brings along, and ground truth for tests.
//!
//! From the neck to the hips, made of overlapping shapes. Each voxel has the label of the
//! tissue at its centre; its intensity is that of the tissue, blended over about one voxel
//! at surfaces (partial volume), plus noise that depends on seed and voxel only.
//!
//! Frame: patient, LPS [mm], the middle of the volume at 0; grid axes along x, y, z.
//! Sizes and levels of the organs are usual ones of a slim adult; the anatomy is simplified
//! and made for touch, teaching and tests, not for any diagnosis.

mod chest;
mod hips;
mod noise;
mod organs;
mod part;
mod shapes;
mod skin;
mod spine;
mod tissue;

use glam::{DMat3, DVec3, UVec3, Vec3};
use rayon::prelude::*;

pub use tissue::{NAMES, Tissue};

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::grid::{Grid, GridError};
use crate::intensities::Intensities;
use crate::voxel_box::VoxelBox;
use noise::noise;
use part::{Part, all_parts, list_visible, paint};

/// What the volume covers along x, y and z [mm], whatever its dimensions.
pub const FIELD_OF_VIEW: DVec3 = DVec3::new(400.0, 280.0, 540.0);

/// Standard deviation of the noise [HU]; it never exceeds 3.5 times as much.
pub const NOISE: f32 = 10.0;

/// Edge of the blocks of voxels for which the parts are chosen together [voxels].
const BLOCK: u32 = 4;

/// A scan of the trunk with the truth about it.
#[derive(Clone, Debug)]
pub struct Phantom {
    /// Where the voxels stand.
    pub grid: Grid,
    /// Values [HU]; slope 1, intercept 0.
    pub intensities: Intensities,
    /// Label of each voxel, x fastest.
    pub labels: Vec<u8>,
    /// Name of each label.
    pub names: &'static [(&'static str, u8)],
}

/// Makes a trunk of any dimensions; the spacing follows from [`FIELD_OF_VIEW`].
///
/// The same dimensions and seed give the same volume on any number of threads.
///
/// # Errors
/// Where no grid has these dimensions.
pub fn phantom(dimensions: UVec3, seed: u64) -> Result<Phantom, GridError> {
    let grid = trunk_grid(dimensions)?;
    let (values, labels) = Painter::new(&grid, seed).paint_all();
    let intensities = Intensities::new(dimensions, values, 1.0, 0.0)
        .expect("one value per voxel of a grid that was accepted");
    Ok(Phantom {
        grid,
        intensities,
        labels,
        names: NAMES,
    })
}

/// The bones alone, by their labels: also of dimensions whose values would take gigabytes.
///
/// # Errors
/// Where no grid has these dimensions.
pub fn bones(dimensions: UVec3) -> Result<(Grid, Bits), GridError> {
    let grid = trunk_grid(dimensions)?;
    let painter = Painter::new(&grid, 0);
    let bits = Bits::from_bricks(dimensions, |brick| painter.bones_in(brick));
    Ok((grid, bits))
}

/// Where a phantom of these dimensions stands.
fn trunk_grid(dimensions: UVec3) -> Result<Grid, GridError> {
    let spacing = FIELD_OF_VIEW / dimensions.max(UVec3::ONE).as_dvec3();
    let origin = (spacing - FIELD_OF_VIEW) / 2.0;
    Grid::new(dimensions, spacing, origin, DMat3::IDENTITY)
}

/// Turns the parts into voxels.
struct Painter {
    parts: Vec<Part>,
    dimensions: UVec3,
    spacing: Vec3,
    seed: u64,
}

impl Painter {
    fn new(grid: &Grid, seed: u64) -> Self {
        Self {
            parts: all_parts(),
            dimensions: grid.dimensions(),
            spacing: grid.spacing().as_vec3(),
            seed,
        }
    }

    /// Values [HU] and labels of all voxels, layers of blocks in parallel.
    fn paint_all(&self) -> (Vec<i16>, Vec<u8>) {
        let slice = self.dimensions.x as usize * self.dimensions.y as usize;
        let layer = slice * BLOCK as usize;
        let count = slice * self.dimensions.z as usize;
        let (mut values, mut labels) = (vec![0; count], vec![0; count]);
        values
            .par_chunks_mut(layer)
            .zip(labels.par_chunks_mut(layer))
            .enumerate()
            .for_each(|(i, (values, labels))| {
                self.paint_layer(i as u32 * BLOCK, values, labels);
            });
        (values, labels)
    }

    /// Paints the slices from `bottom` on, as many as are given.
    fn paint_layer(&self, bottom: u32, values: &mut [i16], labels: &mut [u8]) {
        let start = self.index(UVec3::new(0, 0, bottom));
        let mut visible = Vec::new();
        for first in self.blocks(bottom) {
            let end = (first + BLOCK).min(self.dimensions);
            let corners = [first, end - 1].map(|voxel| self.centre(voxel));
            list_visible(&self.parts, corners, self.blur(), &mut visible);
            for voxel in voxels_between(first, end) {
                let (mean, tissue) = paint(&visible, self.centre(voxel), self.blur());
                let index = self.index(voxel);
                let value = mean + NOISE * noise(self.seed, index as u64);
                values[index - start] = value.round() as i16;
                labels[index - start] = tissue as u8;
            }
        }
    }

    /// Which voxels of a brick are bone; those beyond the border are not.
    fn bones_in(&self, brick: VoxelBox) -> BitBrick {
        let [first, end] = [brick.min, brick.max].map(|corner| corner.as_uvec3());
        let corners = [first, end - 1].map(|voxel| self.centre(voxel));
        let mut visible = Vec::new();
        list_visible(&self.parts, corners, self.blur(), &mut visible);
        if visible.is_empty() {
            return BitBrick::EMPTY;
        }
        BitBrick::from_fn(end - first, |offset| {
            let voxel = first + offset.as_uvec3();
            let (_, tissue) = paint(&visible, self.centre(voxel), self.blur());
            tissue.is_bone()
        })
    }

    /// First voxels of the blocks of a layer.
    fn blocks(&self, bottom: u32) -> impl Iterator<Item = UVec3> {
        let UVec3 { x, y, .. } = self.dimensions;
        let step = BLOCK as usize;
        (0..y)
            .step_by(step)
            .flat_map(move |y| (0..x).step_by(step).map(move |x| UVec3::new(x, y, bottom)))
    }

    fn index(&self, voxel: UVec3) -> usize {
        let [width, height] = [self.dimensions.x as usize, self.dimensions.y as usize];
        voxel.x as usize + width * (voxel.y as usize + height * voxel.z as usize)
    }

    /// Centre of a voxel [patient].
    fn centre(&self, voxel: UVec3) -> Vec3 {
        (voxel.as_vec3() + 0.5) * self.spacing - FIELD_OF_VIEW.as_vec3() / 2.0
    }

    /// Distance [mm] from a surface over which tissues blend, on each side.
    fn blur(&self) -> f32 {
        0.8 * self.spacing.element_sum() / 3.0
    }
}

/// Voxels from `first` to before `end`, x fastest.
fn voxels_between(first: UVec3, end: UVec3) -> impl Iterator<Item = UVec3> {
    (first.z..end.z).flat_map(move |z| {
        (first.y..end.y).flat_map(move |y| (first.x..end.x).map(move |x| UVec3::new(x, y, z)))
    })
}
