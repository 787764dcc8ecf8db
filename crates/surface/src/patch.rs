//! A part of a surface: triangles with shared vertices.

use glam::{DVec3, Vec3};

/// A part of a surface, or all of it.
///
/// Positions are mm along the patient's axes (LPS) from the origin of the surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Patch {
    /// Positions [mm], shape [vertex_count, 3].
    pub vertices: Vec<[f32; 3]>,
    /// Unit normals toward free space, shape [vertex_count, 3].
    pub normals: Vec<[f32; 3]>,
    /// Vertices of each triangle, counter-clockwise seen from free space.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices, by rising number, that neighbouring patches may have too.
    pub border: Vec<u32>,
}

/// A box in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest coordinates.
    pub min: Vec3,
    /// Highest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box that holds both.
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

impl Patch {
    /// Whether it has no triangles.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The smallest box that holds all vertices; none where there are none.
    pub fn bounds(&self) -> Option<Bounds> {
        let points = self.vertices.iter().map(|&vertex| Vec3::from(vertex));
        points
            .map(|point| Bounds {
                min: point,
                max: point,
            })
            .reduce(Bounds::union)
    }

    /// Area of all triangles [mm²].
    pub fn area(&self) -> f64 {
        self.corners()
            .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
            .sum()
    }

    /// What the triangles add to the volume that a closed surface encloses [mm³].
    pub fn volume(&self) -> f64 {
        self.corners()
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum()
    }

    fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.triangles.iter().map(|triangle| {
            triangle.map(|vertex| Vec3::from(self.vertices[vertex as usize]).as_dvec3())
        })
    }
}
