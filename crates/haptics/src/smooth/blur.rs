//! Blurred occupancy around the proxy: value and gradient at any point.
//!
//! Solid voxels are counted in cells (`window.rs`); a tent over three cells along each axis
//! makes the nodes of the narrow kernel, the same tent twice more those of the wide one; a
//! quadratic B-spline through the nodes gives a field with a continuous gradient. Tents
//! vanish where the lattice of cells would alias, so that the field hardly knows where cells
//! begin. With cells of m voxels, σ² = (10 m² − 1)/12 and (22 m² − 1)/12 voxels²: for m = 2
//! that is σ 1.80 and 2.69 voxels.
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
            .is_for(shape, first_cell(point, shape), floor(point))
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
        let counts = self.window.read(occupancy, shape, first, floor(point));
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
    // cells are numbered from the middle of a cell to the middle of the next
    let halves = floor(point * 2.0) - shape.voxels();
    shape.cell_of_half(halves) - (CELLS / 2 - 1)
}

/// The whole numbers below those of a point; quicker than what the processors of all targets
/// have an instruction for.
fn floor(point: DVec3) -> IVec3 {
    let toward_zero = point.as_ivec3();
    let above = toward_zero.as_dvec3().cmpgt(point);
    toward_zero
        - IVec3::select(
            glam::BVec3::new(above.x, above.y, above.z),
            IVec3::ONE,
            IVec3::ZERO,
        )
}

/// Shares of solid voxels, 0 to almost 2¹⁶: eight along x side by side in one register.
type Shares = [[[u16; 8]; 8]; 8];

/// Nodes of both kernels.
fn fill_nodes(counts: &CellCounts, shape: CellShape, nodes: &mut Nodes) {
    // as large as a full cell may become without overflow
    let unit = (0x1_0000 / shape.volume() - 1) as u16;
    let scale = 1.0 / (f32::from(unit) * shape.volume() as f32);
    let mut shares = [[[0; 8]; 8]; 8];
    for (layer, counts) in shares.iter_mut().zip(counts) {
        for (row, counts) in layer.iter_mut().zip(counts) {
            *row = counts.to_le_bytes().map(|count| u16::from(count) * unit);
        }
    }
    blur_by_tent(&mut shares);
    let fine = shares;
    blur_by_tent(&mut shares);
    blur_by_tent(&mut shares);
    for z in 0..8 {
        for y in 0..8 {
            let row = &mut nodes[z][y];
            for x in 0..8 {
                row[x] = f32::from(fine[z][y][x]) * scale;
                row[x + 8] = f32::from(shares[z][y][x]) * scale;
            }
        }
    }
}

/// A tent of ¼, ½, ¼ along each axis; beyond the border the outermost values go on.
fn blur_by_tent(shares: &mut Shares) {
    for layer in shares.iter_mut() {
        for row in layer.iter_mut() {
            let [first, .., last] = *row;
            let left = std::array::from_fn(|x| if x > 0 { row[x - 1] } else { first });
            let right = std::array::from_fn(|x| if x < 7 { row[x + 1] } else { last });
            *row = tent(left, *row, right);
        }
        *layer = tent_of_rows(layer);
    }
    for y in 0..8 {
        let column = tent_of_rows(&std::array::from_fn(|z| shares[z][y]));
        for (layer, row) in shares.iter_mut().zip(column) {
            layer[y] = row;
        }
    }
}

/// The same across eight rows.
fn tent_of_rows(rows: &[[u16; 8]; 8]) -> [[u16; 8]; 8] {
    std::array::from_fn(|i| tent(rows[i.saturating_sub(1)], rows[i], rows[(i + 1).min(7)]))
}

/// ¼, ½, ¼ of three rows, rounded up; one instruction for each mean of eight numbers.
#[inline]
fn tent(before: [u16; 8], row: [u16; 8], after: [u16; 8]) -> [u16; 8] {
    let mean = |a: u16, b: u16| ((u32::from(a) + u32::from(b) + 1) >> 1) as u16;
    std::array::from_fn(|x| mean(mean(before[x], after[x]), row[x]))
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
            wide: sigma(22.0),
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
