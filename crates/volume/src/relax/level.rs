//! One level: cells of some voxels around the surface, and the field on them.

use glam::{IVec3, UVec3, Vec3};

use super::band::Band;
use super::faces::{AXES, Face, faces_in};
use super::flats::flat_faces;
use super::solve::System;
use super::terms::Terms;
use super::{MARGIN, cell_of};
use crate::bits::Bits;
use crate::occupancy_fractions::OccupancyFractions;
use crate::voxel_box::VoxelBox;

/// Terms are taken anew so often, with iterations in between.
const ROUNDS: usize = 3;
const ITERATIONS: usize = 15;
const MOST_ITERATIONS: usize = 200;
/// How far inside a cell is at least of which all voxels are solid, in its shortest side.
const FULL: f32 = 0.3;

/// A field around a box.
#[derive(Debug)]
pub(super) struct Level {
    /// Voxels of a cell.
    pub(super) factor: UVec3,
    /// Sides of a voxel and of a cell [mm].
    pub(super) spacing: Vec3,
    pub(super) side: Vec3,
    pub(super) faces: Vec<Face>,
    /// For the finest level, whether each face belongs to a flat terrace.
    pub(super) flat: Vec<bool>,
    pub(super) band: Band,
    /// [mm], positive inside.
    pub(super) field: Vec<f32>,
    /// Cells whose fractions are known already, with them.
    pub(super) held: Vec<(usize, f32)>,
}

impl Level {
    /// The cells around the surface near a box of voxels; none where there is no surface.
    pub(super) fn around(
        bits: &Bits,
        spacing: Vec3,
        core: &VoxelBox,
        factor: UVec3,
    ) -> Option<Self> {
        let grid = VoxelBox::of_dimensions(bits.dimensions());
        let [low, high] = [cell_of(core.min, factor), cell_of(core.max - 1, factor) + 1];
        let last = cell_of(grid.max - 1, factor) + 1;
        let region = VoxelBox::new(low - MARGIN, high + MARGIN);
        let region = region.intersect(&VoxelBox::new(IVec3::ZERO, last));
        let size = factor.as_ivec3();
        let voxels = VoxelBox::new(region.min * size, region.max * size).intersect(&grid);
        let faces = faces_in(bits, &voxels);
        if faces.is_empty() {
            return None;
        }
        let cells = faces.iter().flat_map(|face| [face.solid, face.free]);
        let band = Band::around(region, cells.map(|voxel| cell_of(voxel, factor)));
        let flat = match factor {
            UVec3::ONE => flat_faces(bits, &voxels, &faces, &band),
            _ => Vec::new(),
        };
        Some(Self {
            factor,
            spacing,
            side: spacing * factor.as_vec3(),
            faces,
            flat,
            field: vec![0.0; band.cells.len()],
            band,
            held: Vec::new(),
        })
    }

    /// Begins with what a coarser level has found, as far as it agrees with the voxels.
    pub(super) fn start(&mut self, bits: &Bits, coarser: Option<&Self>) {
        let mixed = self.mixed_cells();
        let last = bits.dimensions().as_ivec3() - 1;
        let [short, long] = [self.side.min_element(), self.side.max_element()];
        let full = if self.is_finest() { 0.0 } else { FULL * short };
        for (number, &cell) in self.band.cells.iter().enumerate() {
            let voxel = (cell * self.factor.as_ivec3()).min(last);
            let solid = bits.is_solid(voxel);
            let own = match (mixed[number], solid) {
                (true, _) => 0.0,
                (false, true) => 0.5 * short,
                (false, false) => -0.5 * short,
            };
            let found = coarser.and_then(|coarser| coarser.at((cell.as_vec3() + 0.5) * self.side));
            let value = found.unwrap_or(own);
            self.field[number] = match (mixed[number], solid) {
                (true, _) => value.clamp(-long, long),
                (false, true) => value.max(full),
                (false, false) => value.min(-full),
            };
        }
    }

    /// Holds the field where fractions are known already, outside a box.
    pub(super) fn hold(&mut self, core: &VoxelBox, known: &OccupancyFractions) {
        let outside = |(number, cell): (usize, &IVec3)| {
            let fraction = known.any_fraction(*cell)?;
            (!core.contains(*cell)).then_some((number, fraction))
        };
        self.held = self
            .band
            .cells
            .iter()
            .enumerate()
            .filter_map(outside)
            .collect();
    }

    /// Bends the field straight.
    pub(super) fn solve(&mut self, bits: &Bits, is_coarsest: bool) {
        // coarse levels have few cells, and what is far apart to bring together
        let doubled = self.factor.max_element().ilog2();
        let iterations = (ITERATIONS << doubled).min(MOST_ITERATIONS);
        for round in 0..ROUNDS {
            let terms = Terms::of(self, !is_coarsest || round > 0);
            let (mut weights, mut targets) = terms.data(self);
            if self.is_finest() && round > 0 {
                terms.keep_sides(self, bits, &mut weights, &mut targets);
            }
            let system = System {
                neighbours: &self.band.neighbours,
                stiffness: &terms.stiffness,
                weights: &weights,
                targets: &targets,
            };
            system.improve(&mut self.field, iterations);
        }
    }

    /// The fraction of a voxel of the finest level, if it is at the surface.
    ///
    /// Along the axis on which the field changes most, the solid one of two voxels counts half of
    /// the way to the surface more than one half, the free one half of the rest; so a column
    /// counts as much as is solid of it.
    pub(super) fn fraction(&self, bits: &Bits, voxel: IVec3) -> Option<f32> {
        let solid = bits.is_solid(voxel);
        let number = self.band.number(voxel);
        let side = if solid { 1.0 } else { -1.0 };
        let here = side * self.field.get(number as usize)?;
        let mut is_surface = false;
        let mut most = f32::NEG_INFINITY;
        let mut ways = 2.0;
        for (axis, pair) in AXES.into_iter().zip(self.pairs(number)) {
            let mut change = 0.0_f32;
            let mut way = 0.0;
            for (step, beside) in [-axis, axis].into_iter().zip(pair) {
                let Some(beside) = beside.map(|value| side * value) else {
                    way += 1.0;
                    continue;
                };
                change = change.max((beside - here).abs());
                let is_other = bits.is_solid(voxel + step) != solid;
                is_surface |= is_other;
                way += if is_other {
                    way_to_zero(here, beside)
                } else {
                    1.0
                };
            }
            if change > most {
                (most, ways) = (change, way);
            }
        }
        let own = (0.5 * ways).max(0.5);
        is_surface.then_some(if solid { own } else { 1.0 - own })
    }

    // --- the field ---------------------------------------------------------------------------

    fn is_finest(&self) -> bool {
        self.factor == UVec3::ONE
    }

    /// The field before and after a cell along each axis.
    fn pairs(&self, number: u32) -> [[Option<f32>; 2]; 3] {
        let beside = self.band.neighbours[number as usize];
        let value = |number: u32| self.field.get(number as usize).copied();
        std::array::from_fn(|axis| [value(beside[2 * axis]), value(beside[2 * axis + 1])])
    }

    /// Cells that have solid and free voxels side by side.
    fn mixed_cells(&self) -> Vec<bool> {
        let mut mixed = vec![false; self.band.cells.len()];
        for face in &self.faces {
            let cell = cell_of(face.solid, self.factor);
            if cell == cell_of(face.free, self.factor) {
                mixed[self.band.number(cell) as usize] = true;
            }
        }
        mixed
    }

    /// The field at a point of the grid [mm from its corner], straight between the middles of cells.
    fn at(&self, point: Vec3) -> Option<f32> {
        let place = point / self.side - 0.5;
        let first = place.floor();
        let part = place - first;
        let mut sum = 0.0;
        let mut total = 0.0;
        for corner in corners() {
            let number = self.band.number(first.as_ivec3() + corner);
            if let Some(value) = self.field.get(number as usize) {
                let weight = weight_of(corner, part);
                sum += weight * value;
                total += weight;
            }
        }
        (total > 0.0).then(|| sum / total)
    }
}

/// The eight corners of a cell.
pub(super) fn corners() -> impl Iterator<Item = IVec3> {
    (0..8).map(|corner| IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2))
}

/// What one of them counts for a point a part of the way from the first to the last.
pub(super) fn weight_of(corner: IVec3, part: Vec3) -> f32 {
    Vec3::select(corner.cmpeq(IVec3::ONE), part, 1.0 - part).element_product()
}

/// The way from the middle of a voxel to zero, of that to the next, on the other side.
fn way_to_zero(here: f32, beside: f32) -> f32 {
    let fall = here - beside;
    if fall > 0.0 {
        (here / fall).clamp(0.0, 1.0)
    } else {
        0.5
    }
}
