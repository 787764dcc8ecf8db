//! How much of a cell between eight samples a surface encloses.
//!
//! By the divergence theorem: the triangles in the cell, and the solid parts of its faces. Those
//! through its first corner add nothing when lengths are counted from there.

use glam::{DVec3, IVec3};

/// What a triangle adds to the volume enclosed, counted from `origin`; turned outward.
pub(crate) fn below([a, b, c]: [DVec3; 3], origin: DVec3) -> f64 {
    (a - origin).dot((b - origin).cross(c - origin)) / 6.0
}

/// What the three faces of a cell add that do not touch its first corner.
///
/// `share` tells where from the first to the second of two samples one apart along an axis the
/// surface passes.
pub(crate) fn faces(
    cell: IVec3,
    is_solid: impl Fn(IVec3) -> bool,
    share: impl Fn(IVec3, usize) -> f64,
) -> f64 {
    let mut areas = 0.0;
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let unit = |axis: usize| IVec3::AXES[axis];
        let corner = cell + unit(axis);
        // around the face: each corner, then the edge to the next one
        let ring = [
            (corner, u, false),
            (corner + unit(u), v, false),
            (corner + unit(u) + unit(v), u, true),
            (corner + unit(v), v, true),
        ];
        let flat = |sample: IVec3| (sample - corner).as_dvec3();
        let mut outline = Vec::with_capacity(8);
        for (sample, along, backward) in ring {
            let first = if backward {
                sample - unit(along)
            } else {
                sample
            };
            let second = first + unit(along);
            if is_solid(sample) {
                outline.push(flat(sample));
            }
            if is_solid(first) != is_solid(second) {
                outline.push(flat(first) + share(first, along) * unit(along).as_dvec3());
            }
        }
        let twice: f64 = (0..outline.len())
            .map(|place| {
                let (a, b): (DVec3, DVec3) = (outline[place], outline[(place + 1) % outline.len()]);
                a[u] * b[v] - a[v] * b[u]
            })
            .sum();
        areas += twice / 2.0;
    }
    areas / 3.0
}
