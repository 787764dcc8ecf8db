//! The triangles of each of the 256 ways in which the corners of a cell can be solid.
//!
//! Made by rule, not copied: on each face of a cell, every run of free corners is cut off by one
//! segment, whichever cell looks at the face. So the solid corners of an ambiguous face belong
//! together, as they do for touch, where no way leads between two voxels that share an edge; and
//! two cells always agree on their common face, so that a surface has no cracks.
//! The segments of the six faces close to loops, and loops are cut into triangles with no
//! diagonal on a face of the cell, where the neighbour could draw it too.
//!
//! Corner i stands at (i & 1, i >> 1 & 1, i >> 2). Edge 4·axis + k leads along `axis`; k counts
//! its place along the two other axes. Triangles turn counter-clockwise seen from free space.
//! Source: Lorensen & Cline, "Marching cubes", SIGGRAPH (1987); Bloomenthal, "Polygonization of
//! implicit surfaces", Computer Aided Geometric Design 5 (1988), for loops from faces.

use std::sync::LazyLock;

/// Edges of a cell.
pub const EDGES: usize = 12;

/// What a cell contributes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CellCase {
    /// Triangles by the edges on which their corners stand.
    pub triangles: Vec<[u8; 3]>,
}

static TABLE: LazyLock<[CellCase; 256]> =
    LazyLock::new(|| std::array::from_fn(|solid| case_of(solid as u8)));

/// All cases; bit i of the index says that corner i is solid.
pub fn cell_table() -> &'static [CellCase; 256] {
    &TABLE
}

/// Axis of an edge and its first corner, as (x, y, z) of 0 or 1.
pub fn edge_start(edge: usize) -> (usize, [usize; 3]) {
    let (axis, place) = (edge / 4, edge % 4);
    let [first, second] = other_axes(axis);
    let mut corner = [0; 3];
    corner[first] = place & 1;
    corner[second] = place >> 1;
    (axis, corner)
}

/// The other two axes, in rising order.
fn other_axes(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

fn case_of(solid: u8) -> CellCase {
    let next = segments(solid);
    let mut seen = [false; EDGES];
    let mut triangles = Vec::new();
    for first in 0..EDGES {
        let mut round = Vec::new();
        let mut edge = first;
        while let Some(after) = next[edge].filter(|_| !seen[edge]) {
            seen[edge] = true;
            round.push(edge);
            edge = after;
        }
        triangles.extend(triangles_of(&round));
    }
    CellCase { triangles }
}

/// For each edge that the surface crosses, the edge to which a face leads from there.
fn segments(solid: u8) -> [Option<usize>; EDGES] {
    let mut next = [None; EDGES];
    for axis in 0..3 {
        for side in 0..2 {
            let corners = corners_around(axis, side);
            let is_solid = |i: usize| solid >> corners[i % 4] & 1 != 0;
            for start in 0..4 {
                // a run of free corners begins behind a solid one
                if !is_solid(start) || is_solid(start + 1) {
                    continue;
                }
                let enter = edge_between(corners[start], corners[(start + 1) % 4]);
                let last = (start + 1..)
                    .find(|&i| is_solid(i + 1))
                    .expect("start is solid");
                let leave = edge_between(corners[last % 4], corners[(last + 1) % 4]);
                next[leave] = Some(enter);
            }
        }
    }
    next
}

/// Corners of a face, counter-clockwise seen from outside the cell.
fn corners_around(axis: usize, side: usize) -> [usize; 4] {
    let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |u: usize, v: usize| side << axis | u << first | v << second;
    let up = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    let [a, b, c, d] = up;
    if side == 1 { up } else { [a, d, c, b] }
}

fn edge_between(a: usize, b: usize) -> usize {
    let axis = (a ^ b).trailing_zeros() as usize;
    let low = a & b;
    let [first, second] = other_axes(axis);
    4 * axis + (low >> first & 1) + 2 * (low >> second & 1)
}

/// Cuts a loop into triangles: no diagonal on a face of the cell, then the shortest diagonals.
fn triangles_of(round: &[usize]) -> Vec<[u8; 3]> {
    let mut triangles = Vec::new();
    if round.len() >= 3 {
        cut(round, 0, round.len() - 1, &mut triangles);
    }
    triangles
}

/// Cuts the part of a loop from `first` to `last`; returns the cost of its diagonals.
fn cut(round: &[usize], first: usize, last: usize, triangles: &mut Vec<[u8; 3]>) -> u32 {
    let mut best: Option<(u32, Vec<[u8; 3]>)> = None;
    for middle in first + 1..last {
        let mut parts = vec![[first, middle, last].map(|i| round[i] as u8)];
        let mut cost = 0;
        for (from, to) in [(first, middle), (middle, last)] {
            if to - from > 1 {
                cost += diagonal_cost(round[from], round[to]) + cut(round, from, to, &mut parts);
            }
        }
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, parts));
        }
    }
    best.map_or(0, |(cost, parts)| {
        triangles.extend(parts);
        cost
    })
}

/// Square of the length in half edges; far more where both ends lie on one face.
fn diagonal_cost(a: usize, b: usize) -> u32 {
    const ON_A_FACE: u32 = 1000;
    let [a, b] = [a, b].map(middle_of);
    let on_a_face = (0..3).any(|axis| a[axis] == b[axis] && a[axis] != 1);
    let square: u32 = (0..3).map(|axis| a[axis].abs_diff(b[axis]).pow(2)).sum();
    square + if on_a_face { ON_A_FACE } else { 0 }
}

/// Middle of an edge, in half edges.
pub fn middle_of(edge: usize) -> [u32; 3] {
    let (axis, corner) = edge_start(edge);
    let mut middle = corner.map(|place| 2 * place as u32);
    middle[axis] = 1;
    middle
}
