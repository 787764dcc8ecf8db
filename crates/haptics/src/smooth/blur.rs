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
use super::shares::Shares;
use super::window::{CELLS, CellCounts, CellShape, SurfaceVoxel, Window};
use glam::{DVec3, IVec3, Vec3A};
use palpate_volume::occupancy::Occupancy;

/// Nodes of one row: eight of each kernel, and four zeros that are read with the last ones.
type Row = [f32; 20];
type Nodes = [[Row; 8]; 8];

/// Where the nodes of each kernel begin in a row.
const FINE: usize = 0;
const WIDE: usize = 8;

/// A blurred window.
#[derive(Clone, Debug)]
pub struct BlurField {
    window: Window,
    any_solid: bool,
    spacing: DVec3,
    shape: CellShape,
    kernel: Kernel,
    nodes: Nodes,
}

impl BlurField {
    /// The field of nothing at all.
    pub(crate) fn empty() -> Self {
        let spacing = DVec3::ONE;
        let shape = CellShape::for_spacing(spacing);
        Self {
            window: Window::NONE,
            any_solid: false,
            spacing,
            shape,
            kernel: kernel_of(shape),
            nodes: [[[0.0; 20]; 8]; 8],
        }
    }

    /// Whether this is the field that [`Self::around`] makes for a point of the same solid.
    pub(crate) fn is_around(&self, point: DVec3, spacing: DVec3) -> bool {
        self.spacing == spacing
            && self
                .window
                .is_for(self.shape, first_cell(point, self.shape), floor(point))
    }

    /// Makes it the field around a point in a free voxel, with what is known of the shares of
    /// voxels at the surface. Where that voxel is solid, nothing
    /// can be told apart, and the field is that of nothing.
    pub(crate) fn around<K: Shares>(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        point: DVec3,
        spacing: DVec3,
        known: &K,
    ) {
        if self.spacing != spacing {
            self.spacing = spacing;
            self.shape = CellShape::for_spacing(spacing);
            self.kernel = kernel_of(self.shape);
        }
        let first = first_cell(point, self.shape);
        let unit = unit_of(self.shape);
        let mut corrections = [[[0_i32; 8]; 8]; 8];
        let correct = |at: SurfaceVoxel| {
            if let Some(share) = known.share(at.voxel, at.solid) {
                let [x, y, z] = at.cell.map(|cell| cell & 7);
                let beyond = share - f32::from(u8::from(at.solid));
                corrections[z][y][x] += (beyond * f32::from(unit)) as i32;
            }
        };
        let counts = self.window.read(
            occupancy,
            self.shape,
            first,
            floor(point),
            K::ANY.then_some(correct),
        );
        self.any_solid = counts.is_some();
        let Some(counts) = counts else { return };
        let mut shares = shares_of(&counts, unit);
        if K::ANY {
            let full = i32::from(unit) * self.shape.volume();
            let shares = shares.iter_mut().flatten().flatten();
            for (share, correction) in shares.zip(corrections.iter().flatten().flatten()) {
                *share = (i32::from(*share) + correction).clamp(0, full) as u16;
            }
        }
        let scale = 1.0 / (f32::from(unit) * self.shape.volume() as f32);
        fill_nodes(shares, scale, &mut self.nodes);
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
type CellShares = [[[u16; 8]; 8]; 8];

/// The share of one voxel in a cell: as large as it may be without overflow.
fn unit_of(shape: CellShape) -> u16 {
    (0x1_0000 / shape.volume() - 1) as u16
}

fn shares_of(counts: &CellCounts, unit: u16) -> CellShares {
    counts.map(|layer| layer.map(|row| row.to_le_bytes().map(|count| u16::from(count) * unit)))
}

/// Nodes of both kernels.
fn fill_nodes(mut shares: CellShares, scale: f32, nodes: &mut Nodes) {
    blur_by_tent(&mut shares);
    put_nodes(&shares, scale, FINE, nodes);
    blur_by_tent(&mut shares);
    blur_by_tent(&mut shares);
    put_nodes(&shares, scale, WIDE, nodes);
}

/// Writes the nodes of one kernel.
fn put_nodes(shares: &CellShares, scale: f32, kind: usize, nodes: &mut Nodes) {
    for (layer, shares) in nodes.iter_mut().zip(shares) {
        for (row, shares) in layer.iter_mut().zip(shares) {
            for (node, share) in row.iter_mut().skip(kind).zip(shares) {
                *node = f32::from(*share) * scale;
            }
        }
    }
}

/// A tent of ¼, ½, ¼ along each axis; beyond the border the outermost values go on.
fn blur_by_tent(shares: &mut CellShares) {
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
#[inline]
fn tent_of_rows(rows: &[[u16; 8]; 8]) -> [[u16; 8]; 8] {
    std::array::from_fn(|i| tent(rows[i.saturating_sub(1)], rows[i], rows[(i + 1).min(7)]))
}

/// ¼, ½, ¼ of three rows, rounded up; one instruction for each mean of eight numbers.
#[inline]
fn tent(before: [u16; 8], row: [u16; 8], after: [u16; 8]) -> [u16; 8] {
    let mean = |a: u16, b: u16| ((u32::from(a) + u32::from(b) + 1) >> 1) as u16;
    std::array::from_fn(|x| mean(mean(before[x], after[x]), row[x]))
}

/// Widths of both kernels in cells.
fn kernel_of(shape: CellShape) -> Kernel {
    let cell = shape.voxels().as_dvec3();
    let sigma = |share: f64| {
        let variance = (share - (cell * cell).recip()) / 12.0;
        variance.map(f64::sqrt).as_vec3a()
    };
    Kernel {
        fine: sigma(10.0),
        wide: sigma(22.0),
    }
}

/// Which nodes a point is between, and their weights.
struct Place {
    /// The first of three nodes along each axis.
    first: [usize; 3],
    /// Weights of the three along each axis, and their slopes.
    weights: [[[f32; 3]; 2]; 3],
}

impl Place {
    #[inline]
    fn of(point: Vec3A) -> Self {
        // NaN becomes a node, too; nothing reads outside the window
        let point = point
            .clamp(Vec3A::splat(0.5), Vec3A::splat(6.49))
            .to_array();
        let node = point.map(|point| (point + 0.5) as i32);
        Self {
            first: node.map(|node| (node - 1).clamp(0, 5) as usize),
            weights: std::array::from_fn(|axis| weights(point[axis] - node[axis] as f32)),
        }
    }
}

/// Four nodes along x side by side, of which the last has no weight.
type Four = [f32; 4];

impl BlurField {
    /// Sums over y and z: of the values, and of their changes along y and along z; `kind` is
    /// where the nodes of a kernel begin in a row.
    #[inline]
    fn sums(&self, place: &Place, kind: usize) -> [Four; 3] {
        let [x, y, z] = place.first;
        let [_, [wy, dy], [wz, dz]] = &place.weights;
        let four = |c: usize, b: usize| -> Four {
            let row = &self.nodes[z + c][y + b];
            std::array::from_fn(|a| row[kind + x + a])
        };
        let weighted = |weights: &[f32; 3], rows: [Four; 3]| -> Four {
            let [first, second, third] = rows;
            std::array::from_fn(|a| {
                weights[0] * first[a] + weights[1] * second[a] + weights[2] * third[a]
            })
        };
        let column = |b: usize| [four(0, b), four(1, b), four(2, b)];
        let columns = [column(0), column(1), column(2)];
        let values = columns.map(|column| weighted(wz, column));
        let along_z = columns.map(|column| weighted(dz, column));
        [
            weighted(wy, values),
            weighted(dy, values),
            weighted(wy, along_z),
        ]
    }

    /// What is left to do along x.
    #[inline]
    fn gradient(&self, place: &Place, [value, along_y, along_z]: &[Four; 3]) -> Vec3A {
        let [values, slopes] = &place.weights[0];
        Vec3A::new(
            dot(value, slopes),
            dot(along_y, values),
            dot(along_z, values),
        )
    }

    #[inline]
    fn level(&self, place: &Place, sums: &[Four; 3]) -> Level {
        Level {
            value: dot(&sums[0], &place.weights[0][0]),
            gradient: self.gradient(place, sums),
        }
    }
}

#[inline]
fn dot(four: &Four, weights: &[f32; 3]) -> f32 {
    four[0] * weights[0] + four[1] * weights[1] + four[2] * weights[2]
}

impl Field for BlurField {
    #[inline]
    fn sample(&self, point: Vec3A) -> FieldSample {
        if !self.any_solid {
            return FieldSample::default();
        }
        let place = Place::of(point);
        FieldSample {
            fine: self.level(&place, &self.sums(&place, FINE)),
            wide: self.level(&place, &self.sums(&place, WIDE)),
        }
    }

    #[inline]
    fn wide_gradient(&self, point: Vec3A) -> Vec3A {
        if !self.any_solid {
            return Vec3A::ZERO;
        }
        let place = Place::of(point);
        self.gradient(&place, &self.sums(&place, WIDE))
    }

    fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    fn cell(&self) -> DVec3 {
        self.shape.voxels().as_dvec3()
    }

    fn first_node(&self) -> DVec3 {
        // nodes stand in the middles of cells
        self.window.first().as_dvec3() + 0.5
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
