//! Particles sorted into cells, so that neighbours are found in the 125 around one's own.
//!
//! Dense cells by counting sort: the region is bounded, so no hash is needed (thesis 5.22
//! hashes |x||y||z| with three bits of sign; its two shift operators are interchanged in the
//! text). Where particles are scattered so far that there would be more than four cells for
//! each of them, the cells grow.

use std::ops::{Range, RangeInclusive};

use glam::{DVec3, IVec3};

use super::lanes::LANES;
use super::space::Space;
use super::state::Site;

/// Neighbours lie at most so many cells away: cells of half the reach leave less than half of the
/// candidates that cells of the whole reach do.
const SPREAD: i32 = 2;

/// The cells of one moment. Cell (i, j, k) has the number i + nx (j + ny k).
#[derive(Clone, Debug, Default)]
pub(crate) struct Cells {
    origin: DVec3,
    side: DVec3,
    counts: IVec3,
    periodic: bool,
    /// First place of each cell in the sorted arrays, and the end.
    starts: Vec<u32>,
    /// Particles by cell, and within a cell by index; eight zeros behind.
    pub(crate) order: Vec<u32>,
    /// Their coordinates, in that order, shape [3][n + 8].
    pub(crate) sorted: [Vec<f64>; 3],
    cell_of: Vec<u32>,
}

impl Cells {
    /// Sorts particles into cells, so that all within `reach` lie at most [`SPREAD`] cells away.
    pub(crate) fn sort(&mut self, sites: &[Site], reach: f64, space: Space) {
        self.lay(sites, reach, space);
        let cells = self.counts.as_i64vec3().element_product() as usize;

        self.cell_of.clear();
        self.starts.clear();
        self.starts.resize(cells + 1, 0);
        for site in sites {
            let cell = self.number(self.cell_at(site.position()));
            self.cell_of.push(cell as u32);
            self.starts[cell + 1] += 1;
        }
        for cell in 0..cells {
            self.starts[cell + 1] += self.starts[cell];
        }

        self.order.clear();
        self.order.resize(sites.len() + LANES, 0);
        let mut next = self.starts.clone();
        for (index, &cell) in self.cell_of.iter().enumerate() {
            self.order[next[cell as usize] as usize] = index as u32;
            next[cell as usize] += 1;
        }
        let at = |axis: usize, index: u32| sites[index as usize].position()[axis];
        for (axis, sorted) in self.sorted.iter_mut().enumerate() {
            sorted.clear();
            sorted.extend(
                self.order[..sites.len()]
                    .iter()
                    .map(|&index| at(axis, index)),
            );
            // eight more than there are, so that eight can always be read at once
            sorted.extend([f64::INFINITY; LANES]);
        }
    }

    /// Chooses origin, side and number of cells.
    fn lay(&mut self, sites: &[Site], reach: f64, space: Space) {
        let all = |f: fn(DVec3, DVec3) -> DVec3, from| {
            sites
                .iter()
                .map(Site::position)
                .filter(|p| p.is_finite())
                .fold(from, f)
        };
        let (origin, size) = match space {
            Space::Periodic(sides) => (DVec3::ZERO, sides),
            Space::Open => {
                let (low, high) = (
                    all(DVec3::min, DVec3::INFINITY),
                    all(DVec3::max, DVec3::NEG_INFINITY),
                );
                let found = low.cmple(high).all();
                (
                    if found { low } else { DVec3::ZERO },
                    if found { high - low } else { DVec3::ZERO },
                )
            }
        };
        let allowed = (4 * sites.len() + 64) as f64;
        let mut least = reach / f64::from(SPREAD);
        let mut counts = (size / least).floor().max(DVec3::ONE);
        while counts.element_product() > allowed {
            least *= 1.5;
            counts = (size / least).floor().max(DVec3::ONE);
        }
        self.periodic = matches!(space, Space::Periodic(_));
        self.counts = counts.as_ivec3();
        self.origin = origin;
        // a side a little over, so that the last particle lies in the last cell
        self.side = (size / counts).max(DVec3::splat(least));
    }

    /// The cell of a place; outside, the nearest one.
    pub(crate) fn cell_at(&self, position: DVec3) -> IVec3 {
        let mut cell = (position - self.origin) / self.side;
        if self.periodic {
            let counts = self.counts.as_dvec3();
            cell -= counts * (cell / counts).floor();
        }
        cell.floor().as_ivec3().clamp(IVec3::ZERO, self.counts - 1)
    }

    fn number(&self, cell: IVec3) -> usize {
        (cell.x + self.counts.x * (cell.y + self.counts.y * cell.z)) as usize
    }

    /// Ranges of the sorted arrays that hold all particles of a cell and those around it:
    /// cells side by side along x lie side by side in memory.
    pub(crate) fn rows_around(&self, cell: IVec3, rows: &mut Vec<Range<usize>>) {
        rows.clear();
        let x = self.axis(cell, 0);
        let (first, last, count) = (*x.start(), *x.end(), self.counts.x);
        for k in self.axis(cell, 2) {
            for j in self.axis(cell, 1) {
                let (j, k) = (self.wrap(j, 1), self.wrap(k, 2));
                if first < 0 {
                    rows.push(self.row(first + count, count - 1, j, k));
                }
                rows.push(self.row(first.max(0), last.min(count - 1), j, k));
                if last >= count {
                    rows.push(self.row(0, last - count, j, k));
                }
            }
        }
    }

    /// Particles of the cells `from` to `to` along x.
    fn row(&self, from: i32, to: i32, j: i32, k: i32) -> Range<usize> {
        let number = |i| self.number(IVec3::new(i, j, k));
        self.starts[number(from)] as usize..self.starts[number(to) + 1] as usize
    }

    /// Cells to visit along an axis: those beside it, or all where they would meet themselves.
    fn axis(&self, cell: IVec3, axis: usize) -> RangeInclusive<i32> {
        let count = self.counts[axis];
        if count < 2 * SPREAD + 1 {
            0..=count - 1
        } else if self.periodic {
            cell[axis] - SPREAD..=cell[axis] + SPREAD
        } else {
            (cell[axis] - SPREAD).max(0)..=(cell[axis] + SPREAD).min(count - 1)
        }
    }

    fn wrap(&self, index: i32, axis: usize) -> i32 {
        index.rem_euclid(self.counts[axis])
    }
}
