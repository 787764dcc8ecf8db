//! Flat faces: terraces that end at tall edges only, as those of a box do.
//!
//! A terrace of a slope ends at a step of a voxel or two on some side, and its surface passes
//! anywhere through it. One that ends at walls and drops all around is as flat as it looks: the
//! smoothest surface would bulge there and round its edges, by up to half a voxel. A face that is
//! narrow is none of these: the risers of a slope's steps end at what looks like tall edges too.

use glam::IVec3;

use super::band::{Band, NONE};
use super::faces::{AXES, Face};
use crate::bits::Bits;
use crate::grid::is_inside;
use crate::voxel_box::VoxelBox;

/// Voxels from which on an edge is tall.
const TALL: i32 = 3;

/// Which faces of a region are those of flat terraces. What a terrace is beyond the region is not
/// known, so that it counts as a slope; beyond the border of the grid nothing is.
pub(super) fn flat_faces(bits: &Bits, region: &VoxelBox, faces: &[Face], band: &Band) -> Vec<bool> {
    let mut terraces = Terraces::of_single(faces.len());
    let numbers = numbers(faces, band);
    for (face, number) in faces.iter().zip(0..) {
        let mut goes_on = 0;
        for step in tangents(face.axis) {
            match beyond(bits, region, face, step) {
                Beyond::GoesOn => {
                    goes_on += 1;
                    let solid = band.number(face.solid + step);
                    let other = match numbers.get(solid as usize) {
                        Some(numbers) => numbers[slot(face)],
                        None => NONE,
                    };
                    if other == NONE {
                        terraces.slope(number);
                    } else {
                        terraces.join(number, other);
                    }
                }
                Beyond::Edge => {}
                Beyond::Slope => terraces.slope(number),
            }
        }
        if goes_on == tangents(face.axis).count() {
            terraces.wide(number);
        }
    }
    (0..faces.len() as u32)
        .map(|face| terraces.is_flat(face))
        .collect()
}

/// What comes after a face.
enum Beyond {
    GoesOn,
    Edge,
    Slope,
}

fn beyond(bits: &Bits, region: &VoxelBox, face: &Face, step: IVec3) -> Beyond {
    let out = face.free - face.solid;
    let [solid, free] = [face.solid + step, face.free + step];
    if !is_inside(bits.dimensions(), solid) {
        return Beyond::Edge;
    }
    if !region.contains(solid) {
        return Beyond::Slope;
    }
    let all = |from: IVec3, way: IVec3, wanted: bool| {
        (0..TALL).all(|place| bits.is_solid(from + place * way) == wanted)
    };
    match (bits.is_solid(solid), bits.is_solid(free)) {
        (true, false) => Beyond::GoesOn,
        (false, false) if all(solid, -out, false) => Beyond::Edge,
        (true, true) if all(free, out, true) => Beyond::Edge,
        _ => Beyond::Slope,
    }
}

/// The steps along a face.
fn tangents(axis: usize) -> impl Iterator<Item = IVec3> {
    let others = (0..3).filter(move |other| *other != axis);
    others.flat_map(|other| [-AXES[other], AXES[other]])
}

/// For each cell, the numbers of the faces of which it is the solid side.
fn numbers(faces: &[Face], band: &Band) -> Vec<[u32; 6]> {
    let mut numbers = vec![[NONE; 6]; band.cells.len()];
    for (face, number) in faces.iter().zip(0..) {
        numbers[band.number(face.solid) as usize][slot(face)] = number;
    }
    numbers
}

/// The place of a face among those of its solid voxel.
fn slot(face: &Face) -> usize {
    2 * face.axis + usize::from(face.free[face.axis] > face.solid[face.axis])
}

/// Sets of faces, and whether any of each is at a slope, or goes on on all sides (union-find;
/// Tarjan 1975).
struct Terraces {
    above: Vec<u32>,
    is_slope: Vec<bool>,
    is_wide: Vec<bool>,
}

impl Terraces {
    fn of_single(count: usize) -> Self {
        Self {
            above: (0..count as u32).collect(),
            is_slope: vec![false; count],
            is_wide: vec![false; count],
        }
    }

    fn top(&mut self, mut face: u32) -> u32 {
        while self.above[face as usize] != face {
            let next = self.above[face as usize];
            self.above[face as usize] = self.above[next as usize];
            face = next;
        }
        face
    }

    fn join(&mut self, first: u32, second: u32) {
        let [first, second] = [self.top(first), self.top(second)];
        self.above[second as usize] = first;
        self.is_slope[first as usize] |= self.is_slope[second as usize];
        self.is_wide[first as usize] |= self.is_wide[second as usize];
    }

    fn slope(&mut self, face: u32) {
        let top = self.top(face);
        self.is_slope[top as usize] = true;
    }

    fn wide(&mut self, face: u32) {
        let top = self.top(face);
        self.is_wide[top as usize] = true;
    }

    fn is_flat(&mut self, face: u32) -> bool {
        let top = self.top(face) as usize;
        self.is_wide[top] && !self.is_slope[top]
    }
}
