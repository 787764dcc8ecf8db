//! Bodies, random bits, and what is told of a mesh.

use std::collections::{HashMap, HashSet};

use glam::{DMat3, DQuat, DVec3, IVec3, UVec3};
use palpate_surface::mesh::joined;
use palpate_surface::{Patch, SegmentSurface, SurfaceSettings, VoxelSource};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

/// Cubes of 1 mm.
pub fn cubes(dimensions: UVec3) -> Grid {
    Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).expect("a grid")
}

/// A turned grid of thick slices, far from zero.
pub fn turned_slices(dimensions: UVec3) -> Grid {
    let direction = DMat3::from_quat(DQuat::from_rotation_x(0.4) * DQuat::from_rotation_z(1.1));
    let spacing = DVec3::new(0.7, 0.8, 2.5);
    Grid::new(
        dimensions,
        spacing,
        DVec3::new(-310.0, 95.0, 1200.0),
        direction,
    )
    .expect("a grid")
}

pub fn settings(smoothing: u8) -> SurfaceSettings {
    SurfaceSettings {
        smoothing,
        ..SurfaceSettings::default()
    }
}

pub fn bits_where(dimensions: UVec3, solid: impl Fn(IVec3) -> bool + Sync) -> Bits {
    Segment::from_fn(dimensions, solid).occupancy().clone()
}

/// Every voxel solid with this chance, by a hash of its place.
pub fn noise(dimensions: UVec3, seed: u64, share: f64) -> Bits {
    bits_where(dimensions, |voxel| {
        let [x, y, z] = voxel.to_array().map(|n| n as u64);
        let place = seed ^ x << 40 ^ y << 20 ^ z;
        let mut hash = place.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        hash = (hash ^ hash >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((hash ^ hash >> 29) >> 11) as f64 / (1u64 << 53) as f64 <= share
    })
}

/// Voxels whose middle lies in a ball.
pub fn ball(dimensions: UVec3, centre: DVec3, radius: f64) -> Bits {
    bits_where(dimensions, |voxel| {
        (voxel.as_dvec3() + 0.5).distance_squared(centre) <= radius * radius
    })
}

/// The whole surface.
pub fn surface(grid: &Grid, bits: &Bits, settings: SurfaceSettings) -> SegmentSurface {
    let mut surface = SegmentSurface::new(grid, settings).expect("settings");
    surface.update(&VoxelSource::of_bits(bits), &grid.bounds());
    surface
}

/// The whole surface as one mesh.
pub fn mesh(grid: &Grid, bits: &Bits, settings: SurfaceSettings) -> Patch {
    joined(&surface(grid, bits, settings))
}

/// Fails where a mesh is open or has an edge of more than two triangles.
pub fn assert_closed(mesh: &Patch) {
    let mut edges = HashSet::new();
    for &[a, b, c] in &mesh.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            assert_ne!(edge.0, edge.1, "a triangle with a corner twice");
            assert!(edges.insert(edge), "edge {edge:?} twice in one direction");
        }
    }
    for &(a, b) in &edges {
        assert!(
            edges.contains(&(b, a)),
            "edge {a} {b} has one triangle only"
        );
    }
}

/// Vertices - edges + triangles: 2 for each ball, 0 for a ring.
pub fn euler_characteristic(mesh: &Patch) -> i64 {
    let edges = 3 * mesh.triangles.len() as i64 / 2;
    mesh.vertices.len() as i64 - edges + mesh.triangles.len() as i64
}

/// The voxels of a ball of `radius` around a voxel, cut at the border.
pub fn around(voxel: IVec3, radius: i32, dimensions: UVec3) -> VoxelBox {
    VoxelBox::of_voxel(voxel)
        .dilate(radius)
        .intersect(&VoxelBox::of_dimensions(dimensions))
}

/// Vertices by position, to the bit; how many patches have each.
pub fn vertices_of_patches(surface: &SegmentSurface) -> HashMap<[u32; 3], Vec<[u32; 3]>> {
    let mut found = HashMap::<_, Vec<_>>::new();
    for (_, patch) in surface.patches() {
        for (position, normal) in patch.vertices.iter().zip(&patch.normals) {
            let [position, normal] = [position, normal].map(|v| v.map(f32::to_bits));
            found.entry(position).or_default().push(normal);
        }
    }
    found
}
