//! Where between two samples the surface passes, and which way it looks there.
//!
//! Every vertex stays on its edge between a solid and a free sample, whatever the smoothing: so
//! the surface never leaves the bits by more than half a cell, never cuts itself and keeps its
//! topology; only how far along the edge is a tissue of degree.

use glam::{DVec3, IVec3};

use crate::frame::Frame;
use crate::samples::Samples;

/// A vertex on the edge from one sample to the next along an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// Share of the edge from its first sample on, within 0..1.
    pub(crate) share: f64,
    /// Unit normal toward free space, LPS.
    pub(crate) normal: [f32; 3],
}

/// A way to place vertices.
pub(crate) trait Placement {
    /// Places the vertex between `sample` and the next one along `axis`.
    fn place(&self, samples: &Samples, axis: usize, sample: IVec3) -> Placed;
}

/// The bits as they are: vertices in the middle, normals by the bits around.
#[derive(Clone, Debug)]
pub(crate) struct Midpoints {
    /// Normals of each axis by the twelve bits around an edge.
    normals: [Vec<[f32; 3]>; 3],
}

/// Ways to set the bits around an edge: four along it, four pairs beside it.
const PATTERNS: usize = 1 << 12;

impl Midpoints {
    pub(crate) fn new(frame: &Frame) -> Self {
        let normals = std::array::from_fn(|axis| {
            (0..PATTERNS)
                .map(|bits| normal_of(frame, axis, bits))
                .collect()
        });
        Self { normals }
    }
}

impl Placement for Midpoints {
    #[inline]
    fn place(&self, samples: &Samples, axis: usize, sample: IVec3) -> Placed {
        let bits = bits_around(samples, axis, sample);
        Placed {
            share: 0.5,
            normal: self.normals[axis][bits],
        }
    }
}

/// Mean of the central differences at both ends of an edge, as a normal.
fn normal_of(frame: &Frame, axis: usize, bits: usize) -> [f32; 3] {
    let bit = |place: usize| f64::from((bits >> place & 1) as u8);
    let mut gradient = DVec3::ZERO;
    gradient[axis] = bit(2) - bit(0) + bit(3) - bit(1);
    if gradient[axis] == 0.0 {
        // a lone voxel and a lone gap: the edge itself still says where free space is
        gradient[axis] = bit(2) - bit(1);
    }
    for (beside, first) in other_axes(axis).into_iter().zip([4, 8]) {
        gradient[beside] = bit(first + 2) + bit(first + 3) - bit(first) - bit(first + 1);
    }
    // an edge without a crossing has no normal, and is never asked for
    frame.normal(gradient).unwrap_or_default()
}

/// Bits 0..4: along the edge from one before it; then pairs below and above it on each other
/// axis.
#[inline]
fn bits_around(samples: &Samples, axis: usize, sample: IVec3) -> usize {
    let IVec3 { x, y, z } = sample;
    let shift = x - samples.origin().x;
    let row = |dy: i32, dz: i32| samples.row(y + dy, z + dz);
    let bit = |word: u64, at: i32| (word >> (shift + at) & 1) as usize;
    let pair = |first: u64, second: u64, at: i32| bit(first, at) | bit(second, at) << 1;
    if axis == 0 {
        let four = (row(0, 0) >> (shift - 1) & 15) as usize;
        let two = |word: u64| (word >> shift & 3) as usize;
        let (y, z) = (
            two(row(-1, 0)) | two(row(1, 0)) << 2,
            two(row(0, -1)) | two(row(0, 1)) << 2,
        );
        return four | y << 4 | z << 8;
    }
    let (here, next) = if axis == 1 {
        (row(0, 0), row(1, 0))
    } else {
        (row(0, 0), row(0, 1))
    };
    let (before, after, below, above) = if axis == 1 {
        let below = pair(row(0, -1), row(1, -1), 0);
        let above = pair(row(0, 1), row(1, 1), 0);
        (row(-1, 0), row(2, 0), below, above)
    } else {
        let below = pair(row(-1, 0), row(-1, 1), 0);
        let above = pair(row(1, 0), row(1, 1), 0);
        (row(0, -1), row(0, 2), below, above)
    };
    let four = pair(before, here, 0) | pair(next, after, 0) << 2;
    let x = pair(here, next, -1) | pair(here, next, 1) << 2;
    four | x << 4 | (below | above << 2) << 8
}

fn other_axes(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}
