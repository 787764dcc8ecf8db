//! All patches of a surface as one mesh.

use std::collections::HashMap;

use crate::patch::Patch;
use crate::segment_surface::SegmentSurface;

/// Joins the patches at the vertices that they share.
///
/// Only vertices equal to the bit are joined, so patches that were smoothed alone stay apart.
pub fn joined(surface: &SegmentSurface) -> Patch {
    let mut whole = Patch::default();
    let mut shared = HashMap::<[u32; 6], u32>::new();
    let mut numbers = Vec::new();
    for (_, patch) in surface.patches() {
        numbers.clear();
        let mut border = patch.border.iter().copied().peekable();
        for (vertex, (&position, &normal)) in patch.vertices.iter().zip(&patch.normals).enumerate()
        {
            let next = whole.vertices.len() as u32;
            let number = if border.next_if_eq(&(vertex as u32)).is_some() {
                *shared.entry(key(position, normal)).or_insert(next)
            } else {
                next
            };
            if number == next {
                whole.vertices.push(position);
                whole.normals.push(normal);
            }
            numbers.push(number);
        }
        let triangles = patch.triangles.iter();
        whole
            .triangles
            .extend(triangles.map(|triangle| triangle.map(|vertex| numbers[vertex as usize])));
    }
    whole
}

fn key([x, y, z]: [f32; 3], [nx, ny, nz]: [f32; 3]) -> [u32; 6] {
    [x, y, z, nx, ny, nz].map(f32::to_bits)
}
