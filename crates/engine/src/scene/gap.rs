//! The gap between two segments: how far the surface of one is from the other, and by how much
//! they overlap.
//!
//! Distances go from the vertices of one surface, made as surfaces are drawn where nobody chooses
//! otherwise, to the triangles of
//! the other that meet at its nearest vertex; vertices inside of the other's voxels have none.
//! The minimum looks at every vertex, the mean, weighted by area, at [`MOST_FOR_MEAN`] of them.
//! Surfaces stand within half a voxel of what they are the surface of, and vertices are a voxel
//! apart: a minimum is right to half a voxel, on smooth bodies to a third (`tests/gap.rs`).
//! Overlap counts voxels of the one whose middle is inside of the other.
//!
//! Frame: each segment's own, where the scan has it; mm.

use std::sync::Arc;

use glam::{DAffine3, DVec3, IVec3};
use palpate_surface::{Patch, SegmentSurface, mesh::joined};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

use crate::scene::point_tree::PointTree;

/// Vertices that the mean is taken of; of a larger surface every so many-th.
pub const MOST_FOR_MEAN: usize = 20_000;

/// How two segments stand to one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// From the nearest point of the one to the other [mm]; 0 where they overlap.
    pub minimum: f64,
    /// Over the surface of the one, to the other [mm].
    pub mean: f64,
    /// Of the voxels that both have [mm³].
    pub overlap: f64,
}

/// A segment made ready to be measured from and to.
#[derive(Debug)]
pub struct GapBody {
    grid: Grid,
    bits: Bits,
    bounds: VoxelBox,
    vertices: Vec<DVec3>,
    /// A third of the triangles around each vertex [mm²].
    areas: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    /// Where the triangles of each vertex begin in `around`, and where the last one's end.
    starts: Vec<u32>,
    around: Vec<u32>,
    tree: PointTree,
}

impl GapBody {
    /// Of a segment with its surface; takes about a microsecond for each triangle.
    #[must_use]
    pub fn new(segment: &Segment, surface: &SegmentSurface, grid: &Grid) -> Self {
        let bits = segment.occupancy().clone();
        let (origin, mesh) = (surface.origin(), joined(surface));
        let Patch { triangles, .. } = &mesh;
        let vertices: Vec<DVec3> = mesh
            .vertices
            .iter()
            .map(|&vertex| origin + as_point(vertex))
            .collect();
        let mut areas = vec![0.0; vertices.len()];
        for triangle in triangles {
            let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
            let third = (b - a).cross(c - a).length() / 6.0;
            for vertex in triangle {
                areas[*vertex as usize] += third;
            }
        }
        let (starts, around) = triangles_around(vertices.len(), triangles);
        Self {
            grid: *grid,
            bits,
            bounds: segment.bounding_box().unwrap_or(VoxelBox::EMPTY),
            tree: PointTree::new(vertices.iter().copied()),
            areas,
            triangles: mesh.triangles,
            vertices,
            starts,
            around,
        }
    }

    /// Whether there is nothing to measure.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// The gap from this one to another; `to_other` takes the one's frame to the other's, a rigid
    /// motion. None where one of them is empty.
    #[must_use]
    pub fn gap_to(&self, other: &Arc<Self>, to_other: &DAffine3) -> Option<Gap> {
        if self.is_empty() || other.is_empty() {
            return None;
        }
        let overlap = self.voxels_in(other, to_other) as f64 * self.grid.voxel_volume();
        let mean = self.mean_to(other, to_other);
        let minimum = if overlap > 0.0 {
            0.0
        } else {
            self.minimum_to(other, to_other)
        };
        Some(Gap {
            minimum,
            mean,
            overlap,
        })
    }

    fn mean_to(&self, other: &Self, to_other: &DAffine3) -> f64 {
        let stride = self.vertices.len().div_ceil(MOST_FOR_MEAN).max(1);
        let weighted: Vec<(f64, f64)> = (0..self.vertices.len())
            .into_par_iter()
            .step_by(stride)
            .map(|vertex| {
                let point = to_other.transform_point3(self.vertices[vertex]);
                let distance = other.distance(point, f64::INFINITY).unwrap_or(0.0);
                (self.areas[vertex] * distance, self.areas[vertex])
            })
            .collect();
        // in their order, so that the same pose gives the same mean
        let (distances, areas) = weighted
            .into_iter()
            .fold((0.0, 0.0), |sum, next| (sum.0 + next.0, sum.1 + next.1));
        distances / areas
    }

    fn minimum_to(&self, other: &Self, to_other: &DAffine3) -> f64 {
        const PIECE: usize = 4096;
        let pieces: Vec<f64> = self
            .vertices
            .par_chunks(PIECE)
            .map(|vertices| {
                vertices.iter().fold(f64::INFINITY, |least, &vertex| {
                    let point = to_other.transform_point3(vertex);
                    // a vertex is at most a voxel's diagonal farther than the triangle beside it
                    let limit = least + other.grid.spacing().length();
                    other.distance(point, limit).unwrap_or(least).min(least)
                })
            })
            .collect();
        pieces.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// How far a point is from the surface; 0 inside of it, none where no vertex is within a limit.
    fn distance(&self, point: DVec3, limit: f64) -> Option<f64> {
        let voxel = self
            .grid
            .grid_from_patient()
            .transform_point3(point)
            .floor();
        if self.bits.is_solid(voxel.as_ivec3()) {
            return Some(0.0);
        }
        let (nearest, squared) = self.tree.nearest(point, limit * limit)?;
        let [start, end] = [nearest, nearest + 1].map(|place| self.starts[place as usize] as usize);
        let triangles = self.around[start..end].iter().map(|&triangle| {
            let corners = self.triangles[triangle as usize];
            corners.map(|vertex| self.vertices[vertex as usize])
        });
        let least = triangles
            .map(|corners| nearest_of_triangle(corners, point).distance_squared(point))
            .fold(squared, f64::min);
        Some(least.sqrt())
    }

    /// Voxels whose middle is inside of another one.
    fn voxels_in(&self, other: &Self, to_other: &DAffine3) -> u64 {
        let other_from_grid =
            other.grid.grid_from_patient() * *to_other * self.grid.patient_from_grid();
        let inverse = other_from_grid.inverse();
        // only bricks near the other one's box are read
        let near = other.bounds.dilate(1);
        let corners = [near.min.as_dvec3(), near.max.as_dvec3()];
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for place in 0..8 {
            let along = |axis: usize| corners[place >> axis & 1][axis];
            let corner = inverse.transform_point3(DVec3::new(along(0), along(1), along(2)));
            (low, high) = (low.min(corner), high.max(corner));
        }
        let region = VoxelBox::new(low.floor().as_ivec3(), high.ceil().as_ivec3());
        let region = region.intersect(&self.bounds);
        let bricks = self.bits.bricks();
        let places: Vec<u32> = (0..)
            .zip(bricks.entries())
            .filter(|(_, brick)| brick.is_some())
            .map(|(index, _)| index)
            .collect();
        places
            .into_par_iter()
            .map(|index| {
                let inside = |voxel: &IVec3| {
                    let middle = other_from_grid.transform_point3(voxel.as_dvec3() + 0.5);
                    self.bits.is_solid(*voxel) && other.bits.is_solid(middle.floor().as_ivec3())
                };
                let voxels = bricks.box_of(index).intersect(&region);
                voxels.voxels().filter(inside).count() as u64
            })
            .sum()
    }
}

fn as_point([x, y, z]: [f32; 3]) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
}

/// For each vertex, its triangles, one vertex after the other, and where each begins.
fn triangles_around(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; vertex_count + 1];
    for vertex in triangles.iter().flatten() {
        starts[*vertex as usize + 1] += 1;
    }
    for place in 1..starts.len() {
        starts[place] += starts[place - 1];
    }
    let mut ends = starts.clone();
    let mut around = vec![0; 3 * triangles.len()];
    for (number, triangle) in (0..).zip(triangles) {
        for vertex in triangle {
            let end = &mut ends[*vertex as usize];
            around[*end as usize] = number;
            *end += 1;
        }
    }
    (starts, around)
}

/// The point of a triangle that is nearest to another one.
///
/// Source: Ericson, "Real-Time Collision Detection" (2005), section 5.1.5.
fn nearest_of_triangle([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6));
    }
    let share = 1.0 / (va + vb + vc);
    a + ab * (vb * share) + ac * (vc * share)
}
