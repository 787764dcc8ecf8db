//! A number or a vector for each node: fields, and chunks of them that one vector instruction takes.

use glam::DVec3;

use super::layout::CHUNK;

/// One number for each node of a chunk.
pub(super) type Lanes = [f64; CHUNK];

/// A vector for each node: x, y and z apart. Shape [3, nodes].
pub(super) type Field = [Vec<f64>; 3];

/// `CHUNK` numbers from a place on.
#[inline(always)]
pub(super) fn lanes(values: &[f64], start: usize) -> &Lanes {
    values[start..start + CHUNK]
        .try_into()
        .expect("a chunk has this length")
}

/// `CHUNK` numbers from a place on, to be changed.
#[inline(always)]
pub(super) fn lanes_mut(values: &mut [f64], start: usize) -> &mut Lanes {
    (&mut values[start..start + CHUNK])
        .try_into()
        .expect("a chunk has this length")
}

/// Zero for each of `length` nodes.
pub(super) fn zero_field(length: usize) -> Field {
    std::array::from_fn(|_| vec![0.0; length])
}

/// The vector of a node.
pub(super) fn vector_at(field: &Field, index: usize) -> DVec3 {
    DVec3::new(field[0][index], field[1][index], field[2][index])
}
