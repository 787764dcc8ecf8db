//! Voxels of a mesh: solid, or its surface as a shell.
//!
//! Solid: on the line through the middles of the voxels of a column, every triangle that the
//! line passes counts +1 or -1 by its side from there on; a voxel is solid where the sum is not
//! zero. So parts that overlap are joined, and a mesh that is turned inside out is as solid. An
//! edge that two triangles share is given to one of them by an order of its ends, so that a line
//! through an edge or a corner counts a closed mesh as any other line does.
//! Shell: every voxel whose box a triangle meets, by the separating axis theorem.
//!
//! Frame: grid. Sources: Jacobson, Kavan & Sorkine-Hornung, "Robust inside-outside segmentation
//! using generalized winding numbers", SIGGRAPH (2013), for winding instead of parity;
//! Akenine-Möller, "Fast 3D triangle-box overlap testing", J. Graphics Tools 6 (2001).

use glam::{DVec2, DVec3, IVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::voxel_box::VoxelBox;
use thiserror::Error;

/// A mesh that makes no voxels.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum MeshError {
    /// A triangle of a vertex that is not there.
    #[error("triangle {triangle} has vertex {vertex}; allowed: 0 to {last}")]
    Vertex {
        /// Which triangle.
        triangle: usize,
        /// Vertex that the triangle names.
        vertex: u32,
        /// The last vertex that there is.
        last: usize,
    },
    /// Not a place.
    #[error("vertex {vertex} at {point} given; allowed: finite, at most {FARTHEST} voxels away")]
    Point {
        /// Which vertex.
        vertex: usize,
        /// Place of the vertex [grid].
        point: DVec3,
    },
}

/// Farthest coordinate of a vertex [voxels].
const FARTHEST: f64 = 1e6;

/// What of a mesh is made voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// All voxels that the mesh encloses.
    Solid,
    /// Only what its triangles meet.
    Shell,
}

/// Makes voxels of a mesh that is given in the grid frame; what lies beyond the grid is cut.
///
/// # Errors
/// Where the mesh names vertices that it lacks, or has some that are nowhere.
pub fn voxelise(
    dimensions: UVec3,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    filling: Filling,
) -> Result<Bits, MeshError> {
    check(vertices, triangles)?;
    let corners = triangles
        .iter()
        .map(|triangle| triangle.map(|vertex| vertices[vertex as usize]));
    let mask = match filling {
        Filling::Solid => solid(dimensions, corners),
        Filling::Shell => shell(dimensions, corners),
    };
    Ok(mask.bits())
}

fn check(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    for (vertex, &point) in vertices.iter().enumerate() {
        // written so that NaN is refused
        if !point.abs().cmple(DVec3::splat(FARTHEST)).all() {
            return Err(MeshError::Point { vertex, point });
        }
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
            let last = vertices.len().saturating_sub(1);
            return Err(MeshError::Vertex {
                triangle,
                vertex,
                last,
            });
        }
    }
    Ok(())
}

/// One number per voxel, x fastest.
struct Counts {
    dimensions: UVec3,
    /// What each voxel adds to the sum along its column.
    steps: Vec<i16>,
}

impl Counts {
    fn zero(dimensions: UVec3) -> Self {
        let [x, y, z] = dimensions.to_array().map(|n| n as usize);
        Self {
            dimensions,
            steps: vec![0; x * y * z],
        }
    }

    fn at(&mut self, voxel: IVec3) -> &mut i16 {
        let [nx, ny] = [self.dimensions.x as usize, self.dimensions.y as usize];
        &mut self.steps[(voxel.z as usize * ny + voxel.y as usize) * nx + voxel.x as usize]
    }

    /// Turns steps along z into sums.
    fn summed(mut self) -> Self {
        let layer = self.dimensions.x as usize * self.dimensions.y as usize;
        for place in layer..self.steps.len() {
            self.steps[place] = self.steps[place].wrapping_add(self.steps[place - layer]);
        }
        self
    }

    fn bits(&self) -> Bits {
        let [nx, ny] = [self.dimensions.x as usize, self.dimensions.y as usize];
        Bits::from_bricks(self.dimensions, |voxels| {
            BitBrick::from_fn(voxels.size(), |offset| {
                let [x, y, z] = (voxels.min + offset).to_array().map(|n| n as usize);
                self.steps[(z * ny + y) * nx + x] != 0
            })
        })
    }
}

fn solid(dimensions: UVec3, triangles: impl Iterator<Item = [DVec3; 3]>) -> Counts {
    let mut counts = Counts::zero(dimensions);
    let columns = VoxelBox::of_dimensions(dimensions.with_z(1));
    for corners in triangles {
        let flat = corners.map(|corner| corner.truncate());
        let (low, high) = (
            flat[0].min(flat[1]).min(flat[2]),
            flat[0].max(flat[1]).max(flat[2]),
        );
        // middles of voxels lie at halves
        let first = (low - 0.5).ceil().as_ivec2().extend(0);
        let last = (high - 0.5).floor().as_ivec2().extend(0);
        for column in VoxelBox::new(first, last + 1).intersect(&columns).voxels() {
            let middle = column.truncate().as_dvec2() + 0.5;
            let Some(side) = passes(flat, middle) else {
                continue;
            };
            let from = (height(corners, middle) - 0.5).ceil().max(0.0);
            if from < f64::from(dimensions.z) {
                let step = counts.at(column.with_z(from as i32));
                *step = step.wrapping_add(side);
            }
        }
    }
    counts.summed()
}

/// Whether the line through a point passes a triangle seen along z: 1 where it turns
/// counter-clockwise, -1 where clockwise.
fn passes(corners: [DVec2; 3], point: DVec2) -> Option<i16> {
    let [a, b, c] = corners;
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| left_of(from, to, point));
    if sides.iter().all(|left| *left) {
        Some(1)
    } else if sides.iter().all(|left| !left) {
        Some(-1)
    } else {
        None
    }
}

/// Whether a point is left of an edge; the opposite for the edge the other way round, also for
/// a point on it.
fn left_of(from: DVec2, to: DVec2, point: DVec2) -> bool {
    let is_ordered = (from.x, from.y) < (to.x, to.y);
    let (first, second) = if is_ordered { (from, to) } else { (to, from) };
    // a point on the line counts as on its left, seen from the lower end
    ((second - first).perp_dot(point - first) >= 0.0) == is_ordered
}

/// Height of the plane of a triangle above a point within it.
fn height(corners: [DVec3; 3], point: DVec2) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let away = point - a.truncate();
    let height = a.z - (normal.x * away.x + normal.y * away.y) / normal.z;
    let [low, high] = [a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)];
    // a triangle on edge has no plane to speak of
    if height.is_nan() {
        low
    } else {
        height.clamp(low, high)
    }
}

fn shell(dimensions: UVec3, triangles: impl Iterator<Item = [DVec3; 3]>) -> Counts {
    let mut counts = Counts::zero(dimensions);
    let grid = VoxelBox::of_dimensions(dimensions);
    for corners in triangles {
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c).floor(), a.max(b).max(c).floor());
        let near = VoxelBox::new(low.as_ivec3(), high.as_ivec3() + 1).intersect(&grid);
        for voxel in near.voxels() {
            let middle = voxel.as_dvec3() + 0.5;
            if meets_box(corners.map(|corner| corner - middle)) {
                *counts.at(voxel) = 1;
            }
        }
    }
    counts
}

/// Whether a triangle meets the cube of edge 1 around zero.
fn meets_box(corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners;
    let edges = [b - a, c - b, a - c];
    let mut axes = vec![edges[0].cross(edges[1])];
    for unit in [DVec3::X, DVec3::Y, DVec3::Z] {
        axes.push(unit);
        axes.extend(edges.map(|edge| unit.cross(edge)));
    }
    axes.into_iter().all(|axis| {
        let reach = axis.abs().element_sum() / 2.0;
        let along = corners.map(|corner| corner.dot(axis));
        let low = along[0].min(along[1]).min(along[2]);
        let high = along[0].max(along[1]).max(along[2]);
        low <= reach && high >= -reach
    })
}
