//! The voxels as they are: the faces between solid and free voxels.
//!
//! The mesh has the volume of the voxels, and each of its edges two triangles. Where voxels touch
//! along an edge alone, they are one body, as for touch: the four faces there are joined by pairs
//! around the free voxels, each pair at a vertex of its own in the middle of the edge. Where they
//! touch at a corner alone, each body has its own vertex there.
//!
//! Frame: grid; the corner (x, y, z) is where the voxel of that number begins.

use std::sync::LazyLock;

use glam::{DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::grid::Grid;

use crate::frame::Frame;
use crate::patch::Patch;
use crate::quick_map::QuickMap;

/// Names of sheets of a surface around a corner: by solid and by free octants.
const SHEETS: u64 = 64;

/// For each way in which the eight voxels around a corner are solid: the first of those that each
/// hangs together with there.
static CONNECTED: LazyLock<[[u8; 8]; 256]> = LazyLock::new(|| {
    std::array::from_fn(|solid| {
        let mut first: [u8; 8] = std::array::from_fn(|octant| octant as u8);
        // so often that the smallest number reaches all
        for _ in 0..8 {
            for a in 0..8usize {
                for b in 0..8usize {
                    let is_solid = solid >> a & 1 != 0;
                    // solid voxels through faces and edges, free ones through faces
                    let reach = if is_solid { 2 } else { 1 };
                    let same = (solid >> b & 1 != 0) == is_solid;
                    if same && (a ^ b).count_ones() <= reach {
                        first[a] = first[a].min(first[b]);
                    }
                }
            }
        }
        first
    })
});

/// The faces of a segment's voxels.
#[derive(Clone, Debug)]
pub struct VoxelFaces {
    /// All faces as one mesh.
    pub mesh: Patch,
    /// Edges along which voxels touch that share no face: there, four triangles meet in space.
    pub touching_edges: usize,
}

/// Makes the faces between the solid and the free voxels of a grid.
pub fn voxel_faces(grid: &Grid, bits: &Bits) -> VoxelFaces {
    let frame = Frame::new(grid);
    let mut faces = Faces {
        bits,
        frame: &frame,
        mesh: Patch::default(),
        normals: Vec::new(),
        corners: QuickMap::default(),
        middles: QuickMap::default(),
    };
    for index in 0..bits.bricks().len() as u32 {
        let Some(brick) = bits.bricks().get(index) else {
            continue;
        };
        let corner = bits.bricks().box_of(index).min;
        if is_inner(bits, corner) {
            continue;
        }
        for place in 0..512 {
            let local = IVec3::new(place & 7, place >> 3 & 7, place >> 6);
            if brick.contains(local) {
                faces.add_voxel(corner + local);
            }
        }
    }
    faces.finished()
}

/// Whether a brick and those beside it are full: it has no faces.
fn is_inner(bits: &Bits, corner: IVec3) -> bool {
    let size = bits.bricks().size().as_ivec3() * BRICK;
    let is_full = |corner: IVec3| {
        corner.cmpge(IVec3::ZERO).all()
            && corner.cmplt(size).all()
            && bits.bricks().at(corner) == Some(&BitBrick::FULL)
    };
    let steps = [IVec3::X, IVec3::Y, IVec3::Z];
    is_full(corner)
        && steps
            .iter()
            .all(|&step| is_full(corner + BRICK * step) && is_full(corner - BRICK * step))
}

struct Faces<'a> {
    bits: &'a Bits,
    frame: &'a Frame,
    mesh: Patch,
    /// Sums of the normals of faces around each vertex, along the axes of the grid.
    normals: Vec<DVec3>,
    /// Vertex of each sheet at a corner.
    corners: QuickMap<u64, u32>,
    /// Vertex of each free voxel at an edge along which voxels touch.
    middles: QuickMap<(u64, IVec3), u32>,
}

impl Faces<'_> {
    fn add_voxel(&mut self, voxel: IVec3) {
        for axis in 0..3 {
            for side in [-1, 1] {
                let mut outward = IVec3::ZERO;
                outward[axis] = side;
                if !self.bits.is_solid(voxel + outward) {
                    self.add_face(voxel, axis, outward);
                }
            }
        }
    }

    /// A face as two triangles, or as a fan around its middle where an edge has one more vertex.
    fn add_face(&mut self, voxel: IVec3, axis: usize, outward: IVec3) {
        let free = voxel + outward;
        let mut along = [IVec3::ZERO; 2];
        along[0][(axis + 1) % 3] = 1;
        along[1][(axis + 2) % 3] = 1;
        if outward[axis] < 0 {
            along.swap(0, 1);
        }
        let [u, v] = along;
        let first = voxel + outward.max(IVec3::ZERO);
        // counter-clockwise from outside; beside each corner the way out over the edge after it
        let ring = [
            (first, -v),
            (first + u, u),
            (first + u + v, v),
            (first + v, -u),
        ];
        let mut outline = Vec::with_capacity(8);
        for (place, &(corner, beside)) in ring.iter().enumerate() {
            outline.push(self.corner(corner, voxel, free));
            let touches = self.bits.is_solid(free + beside) && !self.bits.is_solid(voxel + beside);
            if touches {
                outline.push(self.middle(corner, ring[(place + 1) % 4].0, free));
            }
        }
        for &vertex in &outline {
            self.normals[vertex as usize] += outward.as_dvec3();
        }
        if let &[a, b, c, d] = outline.as_slice() {
            self.mesh.triangles.extend([[a, b, c], [a, c, d]]);
            return;
        }
        let middle = self.add_vertex(first.as_dvec3() + (u + v).as_dvec3() / 2.0);
        self.normals[middle as usize] = outward.as_dvec3();
        for (place, &vertex) in outline.iter().enumerate() {
            let next = outline[(place + 1) % outline.len()];
            self.mesh.triangles.push([vertex, next, middle]);
        }
    }

    /// The vertex at a corner of the face between two voxels.
    fn corner(&mut self, corner: IVec3, solid: IVec3, free: IVec3) -> u32 {
        let around: [IVec3; 8] = std::array::from_fn(|octant| {
            let [x, y, z] = [0, 1, 2].map(|axis| (octant >> axis & 1) as i32 - 1);
            corner + IVec3::new(x, y, z)
        });
        let pattern = (0..8).fold(0, |all, octant| {
            all | usize::from(self.bits.is_solid(around[octant])) << octant
        });
        let octant_of = |voxel: IVec3| {
            let [x, y, z] = (voxel - corner + 1).to_array();
            (x | y << 1 | z << 2) as usize
        };
        let [solid, free] = [solid, free].map(|voxel| CONNECTED[pattern][octant_of(voxel)]);
        let sheet = u64::from(solid) + 8 * u64::from(free);
        let key = self.number(corner) * SHEETS + sheet;
        if let Some(&vertex) = self.corners.get(&key) {
            return vertex;
        }
        let vertex = self.add_vertex(corner.as_dvec3());
        self.corners.insert(key, vertex);
        vertex
    }

    /// The vertex in the middle of an edge, on the side of a free voxel.
    fn middle(&mut self, from: IVec3, to: IVec3, free: IVec3) -> u32 {
        let axis = (to - from)
            .abs()
            .to_array()
            .iter()
            .position(|&way| way == 1);
        let axis = axis.expect("corners of an edge differ") as u64;
        let key = (self.number(from.min(to)) * 3 + axis, free);
        if let Some(&vertex) = self.middles.get(&key) {
            return vertex;
        }
        let vertex = self.add_vertex((from + to).as_dvec3() / 2.0);
        self.middles.insert(key, vertex);
        vertex
    }

    fn number(&self, corner: IVec3) -> u64 {
        let corners = (self.bits.dimensions() + 1).as_u64vec3();
        let [x, y, z] = corner.to_array().map(|place| place as u64);
        (z * corners.y + y) * corners.x + x
    }

    fn add_vertex(&mut self, point: DVec3) -> u32 {
        self.mesh.vertices.push(self.frame.position(point));
        self.normals.push(DVec3::ZERO);
        (self.normals.len() - 1) as u32
    }

    fn finished(mut self) -> VoxelFaces {
        let upward = [0.0, 0.0, 1.0];
        let normals = self.normals.iter();
        // the frame looks against a gradient; faces that look all ways leave none
        self.mesh.normals = normals
            .map(|&outward| self.frame.normal(-outward).unwrap_or(upward))
            .collect();
        if self.frame.mirrored {
            for triangle in &mut self.mesh.triangles {
                triangle.swap(1, 2);
            }
        }
        VoxelFaces {
            mesh: self.mesh,
            touching_edges: self.middles.len() / 2,
        }
    }
}
