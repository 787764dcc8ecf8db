//! Marching cubes on rows of bits.
//!
//! Where the surface crosses an edge is an exclusive or of rows, so only crossings are visited.
//! The vertices of a layer of samples are made before the cells below it, and the cells find
//! them by their edge: two layers of numbers are all that is kept.
//! Source: thesis 5.2.2; Schroeder, Maynard & Geveci, "Flying edges", LDAV (2015), for making
//! vertices by edge. The rows of bits, and no second pass, are ours.

use std::sync::LazyLock;

use glam::{DVec3, IVec3};
use palpate_volume::voxel_box::VoxelBox;

use crate::cell_table::{EDGES, cell_table, edge_start};
use crate::frame::Frame;
use crate::patch::Patch;
use crate::place::Placement;
use crate::samples::Samples;
use crate::settings::PATCH_CELLS;

/// Samples along the edge of the largest patch.
const WIDTH: usize = PATCH_CELLS as usize + 2;

/// Edges of one axis in a layer of samples.
const AREA: usize = WIDTH * WIDTH;

/// All triangles one behind the other: three edges each.
struct FlatTable {
    /// Where each case begins in `edges`; one more at the end.
    starts: [u16; 257],
    edges: Vec<[u8; 3]>,
}

static FLAT: LazyLock<FlatTable> = LazyLock::new(|| {
    let mut flat = FlatTable {
        starts: [0; 257],
        edges: Vec::new(),
    };
    for (case, cell) in cell_table().iter().enumerate() {
        flat.edges.extend(&cell.triangles);
        flat.starts[case + 1] = flat.edges.len() as u16;
    }
    flat
});

/// What a thread keeps between patches.
#[derive(Debug)]
pub(crate) struct MarchScratch {
    /// Vertex of each crossed edge: by parity of the layer, axis, y and x.
    vertices: Vec<u32>,
    patch: Patch,
}

impl Default for MarchScratch {
    fn default() -> Self {
        Self {
            vertices: vec![0; 2 * 3 * AREA],
            patch: Patch::default(),
        }
    }
}

/// Where vertices stand.
pub(crate) struct Placing<'a, P> {
    /// From samples to mm.
    pub frame: &'a Frame,
    /// Voxels along each side of a sample.
    pub step: f64,
    /// Where on its edge each vertex is.
    pub placement: &'a P,
}

/// Makes the surface between the samples of a box.
pub(crate) fn march(
    samples: &Samples,
    own: VoxelBox,
    placing: Placing<'_, impl Placement>,
    scratch: &mut MarchScratch,
) -> Patch {
    let Placing {
        frame,
        step,
        placement,
    } = placing;
    let MarchScratch { vertices, patch } = scratch;
    patch.vertices.clear();
    patch.normals.clear();
    patch.triangles.clear();
    patch.border.clear();
    let mut march = March {
        samples,
        own,
        frame,
        step,
        placement,
        vertices,
        patch,
        offsets: offsets(),
    };
    for z in own.min.z..own.max.z {
        march.make_vertices(z);
        if z > own.min.z {
            march.make_triangles(z - 1);
        }
    }
    if frame.mirrored {
        for triangle in &mut patch.triangles {
            triangle.swap(1, 2);
        }
    }
    // exactly as large as needed; the scratch keeps its room
    patch.clone()
}

struct March<'a, P> {
    samples: &'a Samples,
    own: VoxelBox,
    frame: &'a Frame,
    step: f64,
    placement: &'a P,
    vertices: &'a mut [u32],
    patch: &'a mut Patch,
    offsets: [[usize; EDGES]; 2],
}

impl<P: Placement> March<'_, P> {
    /// Vertices on the edges that begin at the samples of a layer.
    fn make_vertices(&mut self, z: i32) {
        let (own, samples) = (self.own, self.samples);
        let [first, last] = [own.min.x, own.max.x - 1].map(|x| x - samples.origin().x);
        let all = mask(first, last);
        let ends = 1u64 << first | 1 << last;
        let at_z = z == own.min.z || z == own.max.z - 1;
        for y in own.min.y..own.max.y {
            let row = samples.row(y, z);
            let at_y = y == own.min.y || y == own.max.y - 1;
            let border = |whole: bool, ends: u64| if whole { !0 } else { ends };

            let crossed = (row ^ row >> 1) & mask(first, last - 1);
            self.make_row(0, IVec3::new(0, y, z), crossed, border(at_y || at_z, 0));
            if y + 1 < own.max.y {
                let crossed = (row ^ samples.row(y + 1, z)) & all;
                self.make_row(1, IVec3::new(0, y, z), crossed, border(at_z, ends));
            }
            if z + 1 < own.max.z {
                let crossed = (row ^ samples.row(y, z + 1)) & all;
                self.make_row(2, IVec3::new(0, y, z), crossed, border(at_y, ends));
            }
        }
    }

    /// Vertices on the crossed edges of one axis along a row.
    #[inline]
    fn make_row(&mut self, axis: usize, row: IVec3, crossed: u64, border: u64) {
        let origin = self.samples.origin().x;
        let base = self.place_of(axis, row.with_x(self.own.min.x));
        let first = self.own.min.x - origin;
        for bit in bits_of(crossed) {
            let sample = row.with_x(origin + bit);
            let placed = self.placement.place(self.samples, axis, sample);
            let mut point = sample.as_dvec3() + DVec3::splat(0.5);
            point[axis] += placed.share;

            let vertex = self.patch.vertices.len() as u32;
            self.vertices[base + (bit - first) as usize] = vertex;
            self.patch
                .vertices
                .push(self.frame.position(point * self.step));
            self.patch.normals.push(placed.normal);
            if border >> bit & 1 != 0 {
                self.patch.border.push(vertex);
            }
        }
    }

    /// Triangles of the cells between a layer of samples and the next.
    fn make_triangles(&mut self, z: i32) {
        let (own, samples, table) = (self.own, self.samples, &*FLAT);
        let first = own.min.x - samples.origin().x;
        let cells = mask(first, own.max.x - 2 - samples.origin().x);
        let offsets = &self.offsets[(z & 1) as usize];
        for y in own.min.y..own.max.y - 1 {
            let rows = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dy, dz)| samples.row(y + dy, z + dz));
            let any = rows.iter().fold(0, |all, row| all | row);
            let every = rows.iter().fold(!0, |all, row| all & row);
            let crossed = (any | any >> 1) & !(every & every >> 1) & cells;

            let line = (y - own.min.y) as usize * WIDTH;
            for bit in bits_of(crossed) {
                let pair = |row: u64| (row >> bit & 3) as usize;
                let case =
                    pair(rows[0]) | pair(rows[1]) << 2 | pair(rows[2]) << 4 | pair(rows[3]) << 6;
                let base = line + (bit - first) as usize;
                let [start, end] = [case, case + 1].map(|case| table.starts[case] as usize);
                for edges in &table.edges[start..end] {
                    let corners = edges.map(|edge| self.vertices[base + offsets[edge as usize]]);
                    self.patch.triangles.push(corners);
                }
            }
        }
    }

    /// Place of an edge's vertex number.
    fn place_of(&self, axis: usize, sample: IVec3) -> usize {
        let layer = (sample.z & 1) as usize * 3 + axis;
        let local = sample - self.own.min;
        layer * AREA + local.y as usize * WIDTH + local.x as usize
    }
}

/// Where a cell finds the vertex of each of its edges, by the parity of its layer.
fn offsets() -> [[usize; EDGES]; 2] {
    std::array::from_fn(|parity| {
        std::array::from_fn(|edge| {
            let (axis, [x, y, z]) = edge_start(edge);
            ((parity ^ z) * 3 + axis) * AREA + y * WIDTH + x
        })
    })
}

/// Bits from `first` to `last`, both included; none where there are none.
fn mask(first: i32, last: i32) -> u64 {
    if last < first {
        return 0;
    }
    (u64::MAX >> (63 - (last - first))) << first
}

/// Numbers of the set bits, rising.
fn bits_of(mut word: u64) -> impl Iterator<Item = i32> {
    std::iter::from_fn(move || {
        let bit = word.trailing_zeros() as i32;
        (word != 0).then(|| {
            word &= word - 1;
            bit
        })
    })
}
