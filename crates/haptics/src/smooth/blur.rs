//! Blurred occupancy around the proxy: value and gradient at any point.
//!
//! Solid voxels are counted in cells (`window.rs`); a tent over three cells along each axis
//! makes the nodes of the narrow kernel, the same tent once more those of the wide one; a
//! quadratic B-spline through the nodes gives a field with a continuous gradient. Both tents
//! vanish where the lattice of cells would alias, so that the field hardly knows where cells
//! begin. With cells of m voxels, σ² = (10 m² − 1)/12 and (16 m² − 1)/12 voxels²: for m = 2
//! that is σ 1.80 and 2.29 voxels.
//!
//! Beyond the window the outermost cells go on; that is felt only where the wide kernel is
//! used more than a cell away from the proxy.
//!
//! Frame: grid. Memory: `[z][y]`, then along x eight narrow nodes and eight wide ones.
//! Source: Unser, "Splines: a perfect fit for signal and image processing", IEEE Signal
//! Processing Magazine 16 (1999).

use super::field::{Field, FieldSample, Kernel, Level};
use super::window::{CELLS, CellCounts, CellShape, Window};
use glam::{DVec3, IVec3, Vec3};
use palpate_volume::occupancy::Occupancy;

/// Nodes of one row: eight of each kernel, and four zeros that are read with the last ones.
type Row = [f32; 20];
type Nodes = [[Row; 8]; 8];

/// A blurred window.
#[derive(Clone, Debug)]
pub struct BlurField {
    window: Window,
    any_solid: bool,
    cell: DVec3,
    /// Cells per voxel, and the first node in cells.
    scale: DVec3,
    first: DVec3,
    nodes: Nodes,
}

impl BlurField {
    /// The field of nothing at all.
    pub(crate) fn empty() -> Self {
        Self {
            window: Window::NONE,
            any_solid: false,
            cell: DVec3::ONE,
            scale: DVec3::ONE,
            first: DVec3::ZERO,
            nodes: [[[0.0; 20]; 8]; 8],
        }
    }

    /// Whether this is the field that [`Self::around`] makes for a point of the same solid.
    pub(crate) fn is_around(&self, point: DVec3, spacing: DVec3) -> bool {
        let shape = CellShape::for_spacing(spacing);
        self.window
            .is_for(shape, first_cell(point, shape), voxel_of(point))
    }

    /// Makes it the field around a point in a free voxel. Where that voxel is solid, nothing
    /// can be told apart, and the field is that of nothing.
    pub(crate) fn around(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        point: DVec3,
        spacing: DVec3,
    ) {
        let shape = CellShape::for_spacing(spacing);
        let first = first_cell(point, shape);
        let counts = self.window.read(occupancy, shape, first, voxel_of(point));
        self.cell = shape.voxels().as_dvec3();
        self.scale = self.cell.recip();
        // nodes stand in the middles of cells
        self.first = first.as_dvec3() + 0.5;
        self.any_solid = counts.is_some();
        if let Some(counts) = counts {
            fill_nodes(&counts, shape, &mut self.nodes);
        }
    }

    /// Whether there is any surface in it.
    pub(crate) fn any_solid(&self) -> bool {
        self.any_solid
    }
}

/// The first cell of the window whose node 3 or 4 is the next to a point, by its number.
fn first_cell(point: DVec3, shape: CellShape) -> IVec3 {
    (point / shape.voxels().as_dvec3() - 0.5).floor().as_ivec3() - (CELLS / 2 - 1)
}

fn voxel_of(point: DVec3) -> IVec3 {
    point.floor().as_ivec3()
}

/// Nodes of both kernels.
fn fill_nodes(counts: &CellCounts, shape: CellShape, nodes: &mut Nodes) {
    let scale = 1.0 / shape.volume() as f32;
    let mut cells = [[[0.0; 8]; 8]; 8];
    for (layer, counts) in cells.iter_mut().zip(counts) {
        for (row, counts) in layer.iter_mut().zip(counts) {
            *row = counts.to_le_bytes().map(|count| f32::from(count) * scale);
        }
    }
    let fine = tents(&cells);
    let wide = tents(&fine);
    for z in 0..8 {
        for y in 0..8 {
            let row = &mut nodes[z][y];
            row[..8].copy_from_slice(&fine[z][y]);
            row[8..16].copy_from_slice(&wide[z][y]);
        }
    }
}

/// A tent of ¼, ½, ¼ along each axis; beyond the border the outermost values go on.
fn tents(values: &[[[f32; 8]; 8]; 8]) -> [[[f32; 8]; 8]; 8] {
    let tent = |a: &[f32; 8], b: &[f32; 8], c: &[f32; 8]| -> [f32; 8] {
        std::array::from_fn(|x| 0.5 * b[x] + 0.25 * (a[x] + c[x]))
    };
    let mut along_z = [[[0.0; 8]; 8]; 8];
    for z in 0..8_usize {
        let (below, above) = (z.saturating_sub(1), (z + 1).min(7));
        for y in 0..8 {
            along_z[z][y] = tent(&values[below][y], &values[z][y], &values[above][y]);
        }
    }
    let mut result = [[[0.0; 8]; 8]; 8];
    for z in 0..8 {
        for y in 0..8_usize {
            let (below, above) = (y.saturating_sub(1), (y + 1).min(7));
            let row = tent(&along_z[z][below], &along_z[z][y], &along_z[z][above]);
            let [first, .., last] = row;
            let mut padded = [first; 10];
            padded[1..9].copy_from_slice(&row);
            padded[9] = last;
            result[z][y] =
                std::array::from_fn(|x| 0.5 * padded[x + 1] + 0.25 * (padded[x] + padded[x + 2]));
        }
    }
    result
}

impl Field for BlurField {
    #[inline]
    fn sample(&self, point: DVec3) -> FieldSample {
        if !self.any_solid {
            return FieldSample::default();
        }
        // the next node, and where the point is from it; NaN becomes a node, never a place
        // outside the window
        let place = (point * self.scale - self.first)
            .clamp(DVec3::splat(0.5), DVec3::splat(6.49))
            .as_vec3();
        let node = [place.x, place.y, place.z].map(|place| (place + 0.5) as i32);
        let near = Vec3::from_array(node.map(|node| node as f32));
        let [wx, wy, wz] = (place - near).to_array().map(weights);
        let [x, y, z] = node.map(|node| (node - 1).clamp(0, 5) as usize);

        // along y and z, side by side for four nodes along x, of which the last has no weight
        let mut fine = [[0.0_f32; 4]; 3];
        let mut wide = [[0.0_f32; 4]; 3];
        for c in 0..3 {
            for b in 0..3 {
                let row = &self.nodes[z + c][y + b];
                let weight = [
                    wy[0][b] * wz[0][c],
                    wy[1][b] * wz[0][c],
                    wy[0][b] * wz[1][c],
                ];
                let four = |from: usize| -> [f32; 4] { std::array::from_fn(|a| row[from + a]) };
                let [near, far] = [four(x), four(x + 8)];
                for (kind, weight) in weight.into_iter().enumerate() {
                    for a in 0..4 {
                        fine[kind][a] += weight * near[a];
                        wide[kind][a] += weight * far[a];
                    }
                }
            }
        }
        FieldSample {
            fine: self.level(&fine, &wx),
            wide: self.level(&wide, &wx),
        }
    }

    fn kernel(&self) -> Kernel {
        let sigma = |tenths: f64| {
            let variance = (tenths * self.cell * self.cell - 1.0) / 12.0;
            variance.map(f64::sqrt)
        };
        Kernel {
            cell: self.cell,
            fine: sigma(10.0),
            wide: sigma(16.0),
        }
    }
}

impl BlurField {
    /// What is left to do along x: value, and change along y and z, weighted; change along x.
    #[inline]
    fn level(&self, sums: &[[f32; 4]; 3], [values, slopes]: &[[f32; 3]; 2]) -> Level {
        let dot = |sum: &[f32; 4], weights: &[f32; 3]| {
            sum[0] * weights[0] + sum[1] * weights[1] + sum[2] * weights[2]
        };
        let [value, along_y, along_z] = sums;
        let gradient = Vec3::new(
            dot(value, slopes),
            dot(along_y, values),
            dot(along_z, values),
        );
        Level {
            value: f64::from(dot(value, values)),
            gradient: gradient.as_dvec3() * self.scale,
        }
    }
}

/// Weights of three nodes for a place of −½..=½ from the middle one, and their slopes.
#[inline]
fn weights(place: f32) -> [[f32; 3]; 2] {
    let (low, high) = (0.5 - place, 0.5 + place);
    [
        [0.5 * low * low, 0.75 - place * place, 0.5 * high * high],
        [-low, -2.0 * place, high],
    ]
}
