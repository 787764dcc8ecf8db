//! Blurred occupancy: value and gradient at any point near the proxy.
//!
//! Cells of some voxels are counted, pairs of neighbouring cells are averaged along each
//! axis, and a quadratic B-spline through those nodes gives a field with a continuous
//! gradient. With cells of m voxels the kernel has σ² = m²(1/12 + 1/4 + 1/4) voxels².
//!
//! Frame: grid. Source: Unser, "Splines: a perfect fit for signal and image processing",
//! IEEE Signal Processing Magazine 16 (1999).

use super::field::{Field, FieldSample};
use super::window::{CELLS, CellCounts, CellShape, cell_counts};
use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

/// Node values of one window; `[z][y][x]`, node k between the cells k − 1 and k.
type Nodes = [[[f32; 8]; 8]; 8];

/// The node that is nearest to the proxy.
const MIDDLE: i32 = CELLS / 2;

/// A blurred window.
#[derive(Clone, Debug)]
pub struct BlurField {
    shape: CellShape,
    /// First cell, in cells of the grid.
    first: IVec3,
    epoch: u64,
    valid: bool,
    any_solid: bool,
    voxels: DVec3,
    nodes: Nodes,
}

impl Default for BlurField {
    fn default() -> Self {
        Self {
            shape: CellShape { log: [1; 3] },
            first: IVec3::ZERO,
            epoch: 0,
            valid: false,
            any_solid: false,
            voxels: DVec3::splat(2.0),
            nodes: [[[0.0; 8]; 8]; 8],
        }
    }
}

/// Cells for a grid: as near to cubes as powers of two get them, two voxels along its
/// finest axis, or as long as a voxel along its coarsest where that is more.
pub(crate) fn cell_shape(spacing: DVec3) -> CellShape {
    let length = spacing.max_element().max(2.0 * spacing.min_element());
    let log = |h: f64| (length / h).log2().round().clamp(0.0, 2.0) as u32;
    CellShape {
        log: spacing.to_array().map(log),
    }
}

impl BlurField {
    /// The field around a free voxel.
    pub fn prepare(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        grid: &Grid,
        epoch: u64,
        point: DVec3,
    ) {
        let shape = cell_shape(grid.spacing());
        let voxels = shape.voxels();
        let from = point.floor().as_ivec3();
        let first = (point / voxels.as_dvec3()).round().as_ivec3() - MIDDLE;
        if self.valid && self.epoch == epoch && self.first == first && self.shape == shape {
            return;
        }
        let counts = cell_counts(occupancy, shape, first * voxels, from);
        *self = Self {
            shape,
            first,
            epoch,
            valid: true,
            any_solid: counts.is_some(),
            voxels: voxels.as_dvec3(),
            nodes: self.nodes,
        };
        if let Some(counts) = counts {
            self.nodes = nodes(&counts, shape.volume());
        }
    }
}

/// Tents over 3×3×3 cells.
fn nodes(counts: &CellCounts, volume: i32) -> Nodes {
    let scale = 1.0 / (64 * volume) as f32;
    const LOW: u64 = 0x00ff_00ff_00ff_00ff;
    let mut nodes = [[[0.0; 8]; 8]; 8];
    // even and odd cells along x apart, 16 bits each
    let row = |z: usize, y: usize| {
        let c = counts[z][y];
        let (left, right) = (c << 8, c >> 8);
        let even = (left & LOW) + 2 * (c & LOW) + (right & LOW);
        let odd = (left >> 8 & LOW) + 2 * (c >> 8 & LOW) + (right >> 8 & LOW);
        [even, odd]
    };
    let rows: [[[u64; 2]; 8]; 8] = std::array::from_fn(|z| std::array::from_fn(|y| row(z, y)));
    for z in 1..7 {
        let flat: [[u64; 2]; 8] = std::array::from_fn(|y| {
            std::array::from_fn(|i| rows[z - 1][y][i] + 2 * rows[z][y][i] + rows[z + 1][y][i])
        });
        for y in 1..7 {
            let sum: [u64; 2] =
                std::array::from_fn(|i| flat[y - 1][i] + 2 * flat[y][i] + flat[y + 1][i]);
            nodes[z][y] =
                std::array::from_fn(|x| (sum[x & 1] >> (16 * (x >> 1)) & 0xffff) as f32 * scale);
        }
    }
    nodes
}

impl Field for BlurField {
    fn cell(&self) -> DVec3 {
        self.voxels
    }

    fn sigma(&self) -> DVec3 {
        (self.voxels * self.voxels * (10.0 / 12.0) - 1.0 / 12.0).map(f64::sqrt)
    }

    fn sample(&self, point: DVec3) -> FieldSample {
        if !self.any_solid {
            return FieldSample::default();
        }
        let t = point / self.voxels - self.first.as_dvec3() - 0.5;
        let t = t.clamp(DVec3::splat(1.5), DVec3::splat(5.499));
        let node = (t + 0.5).floor();
        let [i, j, k] = node.as_ivec3().to_array().map(|i| (i - 1) as usize & 7);
        let [[wx, dx], [wy, dy], [wz, dz]] = (t - node).as_vec3().to_array().map(weights);

        // rows of four along x, the fourth for nothing
        let mut value = [0.0_f32; 4];
        let mut along_y = [0.0_f32; 4];
        let mut along_z = [0.0_f32; 4];
        let i = i.min(4);
        for (b, layer) in self.nodes.iter().skip(k).take(3).enumerate() {
            for (a, row) in layer.iter().skip(j).take(3).enumerate() {
                let Some(row) = row.get(i..i + 4) else {
                    continue;
                };
                let (v, y, z) = (wy[a] * wz[b], dy[a] * wz[b], wy[a] * dz[b]);
                for x in 0..4 {
                    value[x] += v * row[x];
                    along_y[x] += y * row[x];
                    along_z[x] += z * row[x];
                }
            }
        }
        let dot =
            |row: [f32; 4], w: [f32; 3]| f64::from(row[0] * w[0] + row[1] * w[1] + row[2] * w[2]);
        let gradient = DVec3::new(dot(value, dx), dot(along_y, wx), dot(along_z, wx));
        FieldSample {
            value: dot(value, wx),
            gradient: gradient / self.voxels,
        }
    }
}

/// Weights of the quadratic B-spline at −1, 0, 1 for a place of −½..½ from the middle, and
/// their derivatives.
fn weights(t: f32) -> [[f32; 3]; 2] {
    let (low, high) = (0.5 - t, 0.5 + t);
    [
        [0.5 * low * low, 0.75 - t * t, 0.5 * high * high],
        [-low, -2.0 * t, high],
    ]
}
