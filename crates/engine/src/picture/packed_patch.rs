//! A patch of a surface as the page draws it: 10 bytes a vertex.
//!
//! Positions are rounded to a lattice that all patches of a surface share, so that vertices that
//! are the same in two patches stay the same: no seam opens. Frame: patient, LPS mm.

use glam::{DVec3, Vec3};
use palpate_surface::patch::{Bounds, Patch};

/// Steps of the lattice along the edge of a patch's box.
const STEPS: f64 = 65535.0;

/// A patch that takes little room.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedPatch {
    /// The box's lower corner [mm].
    pub origin: DVec3,
    /// The box's edges [mm]: position = origin + number / 65535 · size.
    pub size: DVec3,
    /// Three little-endian u16 a vertex.
    pub vertices: Vec<u8>,
    /// Three i8 and an empty one a vertex; unit vector = number / 127.
    pub normals: Vec<u8>,
    /// Three little-endian vertex numbers a triangle, u16, or u32 beyond 65536 vertices.
    pub triangles: Vec<u8>,
}

/// The points to which the vertices of a surface are rounded.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// Where the surface counts from [patient mm].
    origin: DVec3,
    /// Between two points along each axis [mm].
    pitch: f64,
}

impl Lattice {
    /// A lattice for patches no longer than `longest` along any axis [mm], of a surface that
    /// counts from `origin`.
    #[must_use]
    pub fn new(origin: DVec3, longest: f64) -> Self {
        // two steps are lost to rounding at both ends
        let pitch = longest / (STEPS - 2.0);
        Self { origin, pitch }
    }

    /// Rounds a patch to the lattice; none where it is longer than the lattice is made for.
    #[must_use]
    pub fn pack(&self, patch: &Patch) -> Option<PackedPatch> {
        let Bounds { min, max } = patch.bounds()?;
        let first = (min.as_dvec3() / self.pitch).floor();
        let last = (max.as_dvec3() / self.pitch).ceil();
        if (last - first).max_element() > STEPS {
            return None;
        }
        let number =
            |value: f32, first: f64| ((f64::from(value) / self.pitch).round() - first) as u16;
        let place = |vertex: &[f32; 3]| {
            let [x, y, z] = *vertex;
            [number(x, first.x), number(y, first.y), number(z, first.z)]
        };
        Some(PackedPatch {
            origin: self.origin + first * self.pitch,
            size: DVec3::splat(STEPS * self.pitch),
            vertices: little_endian(patch.vertices.iter().flat_map(place)),
            normals: patch.normals.iter().flat_map(packed_normal).collect(),
            triangles: packed_triangles(patch),
        })
    }
}

fn little_endian(numbers: impl Iterator<Item = u16>) -> Vec<u8> {
    numbers.flat_map(u16::to_le_bytes).collect()
}

fn packed_normal(normal: &[f32; 3]) -> [u8; 4] {
    let Vec3 { x, y, z } = (Vec3::from(*normal) * 127.0).round();
    [x as i8 as u8, y as i8 as u8, z as i8 as u8, 0]
}

fn packed_triangles(patch: &Patch) -> Vec<u8> {
    let numbers = patch.triangles.iter().flatten();
    if patch.vertices.len() <= 1 << 16 {
        little_endian(numbers.map(|&number| number as u16))
    } else {
        numbers.flat_map(|number| number.to_le_bytes()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch(vertices: &[[f32; 3]]) -> Patch {
        Patch {
            vertices: vertices.to_vec(),
            normals: vec![[0.0, 0.0, -1.0]; vertices.len()],
            triangles: vec![[0, 1, 2]],
            border: Vec::new(),
        }
    }

    fn positions(packed: &PackedPatch) -> Vec<DVec3> {
        let numbers: Vec<f64> = packed
            .vertices
            .chunks(2)
            .map(|pair| f64::from(u16::from_le_bytes([pair[0], pair[1]])))
            .collect();
        numbers
            .chunks(3)
            .map(|xyz| packed.origin + DVec3::new(xyz[0], xyz[1], xyz[2]) / STEPS * packed.size)
            .collect()
    }

    #[test]
    fn vertices_come_back_within_half_a_step_and_neighbours_share_them() {
        let lattice = Lattice::new(DVec3::new(-100.0, 50.0, 7.0), 40.0);
        let shared = [[10.01_f32, 3.33, -8.0], [10.02, 4.44, -7.5]];
        let left = patch(&[shared[0], shared[1], [-20.0, 3.0, 1.0]]);
        let right = patch(&[shared[0], shared[1], [29.0, 3.0, -30.0]]);
        let [left, right] = [left, right].map(|patch| lattice.pack(&patch).unwrap());
        for (place, vertex) in positions(&left).iter().zip(shared) {
            let exact = DVec3::new(-100.0, 50.0, 7.0) + Vec3::from(vertex).as_dvec3();
            // half a step of 40 mm / 65533 along three axes
            assert!(place.distance(exact) < 0.9 * 40.0 / 65533.0);
        }
        for (a, b) in positions(&left).iter().zip(positions(&right)).take(2) {
            // the same point of the lattice, but for the rounding of f64
            assert!(a.distance(b) < 1e-12 * 100.0, "{a} {b}");
        }
        assert_eq!(left.normals[..4], [0, 0, (-127_i8) as u8, 0]);
        assert_eq!(left.triangles, [0, 0, 1, 0, 2, 0]);
    }

    #[test]
    fn a_patch_longer_than_the_lattice_is_for_is_refused() {
        let lattice = Lattice::new(DVec3::ZERO, 40.0);
        let long = patch(&[[0.0; 3], [41.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert!(lattice.pack(&long).is_none());
    }
}
