//! Bodies of a segment: solid voxels that hang together through faces and edges.
//!
//! Voxels that share an edge are one body, those that share but a corner are two, as for touch and
//! for surfaces. Rows along x are parted into runs, and runs that touch are united.
//! Source: He, Chao & Suzuki, "A run-based two-scan labeling algorithm", IEEE Trans. Image
//! Processing (2008), here in three dimensions.

use glam::IVec3;

use crate::bits::Bits;
use crate::brick_grid::BRICK;

/// Solid voxels of a row from `first` up to, without, `end`.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: i32,
    end: i32,
}

/// Which body each solid voxel belongs to.
#[derive(Clone, Debug)]
pub struct Bodies {
    /// Rows along y, so that row (y, z) is number z · `rows_along_y` + y.
    rows_along_y: i32,
    /// Where the runs of each row begin; one more at the end.
    starts: Vec<u32>,
    runs: Vec<Run>,
    /// Body of each run.
    bodies: Vec<u32>,
    voxel_counts: Vec<u64>,
}

impl Bodies {
    /// Finds the bodies of bits.
    pub fn of(bits: &Bits) -> Self {
        let size = bits.dimensions().as_ivec3();
        let (starts, runs) = runs_of(bits);
        let mut united = Union::of(runs.len());
        let row = |y: i32, z: i32| {
            let row = (z * size.y + y) as usize;
            starts[row] as usize..starts[row + 1] as usize
        };
        for z in 0..size.z {
            for y in 0..size.y {
                // rows before this one: through faces and edges, or through an edge alone
                for (dy, dz, reach) in [(-1, 0, 1), (0, -1, 1), (-1, -1, 0), (1, -1, 0)] {
                    if (0..size.y).contains(&(y + dy)) && z + dz >= 0 {
                        unite(&runs, row(y, z), row(y + dy, z + dz), reach, &mut united);
                    }
                }
            }
        }
        let (bodies, count) = united.numbered();
        let mut voxel_counts = vec![0; count];
        for (run, &body) in runs.iter().zip(&bodies) {
            voxel_counts[body as usize] += (run.end - run.first) as u64;
        }
        Self {
            rows_along_y: size.y,
            starts,
            runs,
            bodies,
            voxel_counts,
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.voxel_counts.len()
    }

    /// Voxels of all bodies.
    pub fn voxel_count(&self) -> u64 {
        self.voxel_counts.iter().sum()
    }

    /// The body of a voxel of the grid; none of a free one.
    pub fn at(&self, voxel: IVec3) -> Option<u32> {
        let row = (voxel.z * self.rows_along_y + voxel.y) as usize;
        let [start, end] = [row, row + 1].map(|row| self.starts[row] as usize);
        let after = self.runs[start..end].partition_point(|run| run.first <= voxel.x);
        let run = start + after.checked_sub(1)?;
        (voxel.x < self.runs[run].end).then(|| self.bodies[run])
    }
}

/// The runs of all rows, and where those of each row begin.
fn runs_of(bits: &Bits) -> (Vec<u32>, Vec<Run>) {
    let size = bits.dimensions().as_ivec3();
    let (mut starts, mut runs) = (vec![0], Vec::<Run>::new());
    for z in 0..size.z {
        for y in 0..size.y {
            let own = runs.len();
            for x in (0..size.x).step_by(BRICK as usize) {
                let Some(brick) = bits.bricks().at(IVec3::new(x, y, z)) else {
                    continue;
                };
                let row = brick.0[(z & 7) as usize] >> (8 * (y & 7)) & 0xff;
                for bit in (0..BRICK).filter(|bit| row >> bit & 1 != 0) {
                    match runs[own..].last_mut() {
                        Some(run) if run.end == x + bit => run.end += 1,
                        _ => runs.push(Run {
                            first: x + bit,
                            end: x + bit + 1,
                        }),
                    }
                }
            }
            starts.push(runs.len() as u32);
        }
    }
    (starts, runs)
}

/// Unites the runs of two rows that overlap, or come so near along x.
fn unite(
    runs: &[Run],
    row: std::ops::Range<usize>,
    other: std::ops::Range<usize>,
    reach: i32,
    united: &mut Union,
) {
    let (mut a, mut b) = (row.start, other.start);
    while a < row.end && b < other.end {
        if runs[a].first < runs[b].end + reach && runs[b].first < runs[a].end + reach {
            united.unite(a as u32, b as u32);
        }
        if runs[a].end < runs[b].end {
            a += 1;
        } else {
            b += 1;
        }
    }
}

/// Sets of numbers that grow together. Source: Tarjan (1975), with halved paths.
#[derive(Clone, Debug)]
pub struct Union {
    parents: Vec<u32>,
}

impl Union {
    /// Each of so many numbers is a set of its own.
    pub fn of(count: usize) -> Self {
        Self {
            parents: (0..count as u32).collect(),
        }
    }

    /// The number that stands for the set of a number: the smallest in it.
    pub fn root(&mut self, number: u32) -> u32 {
        let mut at = number;
        while self.parents[at as usize] != at {
            let parent = self.parents[at as usize];
            self.parents[at as usize] = self.parents[parent as usize];
            at = self.parents[at as usize];
        }
        at
    }

    /// Makes the sets of two numbers one.
    pub fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// For each number that of its set, counted from 0, and how many sets there are.
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut sets = vec![0; self.parents.len()];
        let mut count = 0;
        for number in 0..sets.len() {
            let root = self.root(number as u32) as usize;
            // the smallest of a set comes first
            sets[number] = if root == number {
                count += 1;
                count - 1
            } else {
                sets[root]
            };
        }
        (sets, count as usize)
    }
}
