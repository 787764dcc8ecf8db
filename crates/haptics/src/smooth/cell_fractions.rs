//! What the fractions of voxels at the surface change in cells, kept while it stays what it is.
//!
//! Windows overlap, and one that the proxy enters has few cells that the last one had not. What a
//! cell counts beyond its bits follows from which of its voxels are at the surface, on which side
//! of it, and from the values there. So it is kept with those voxels, and what comes out is the
//! same, to the bit, with an empty cache.
//!
//! Frame: grid; cells by their number.

use super::binomial_filter::{Changes, unit_of};
use super::cache::Source;
use super::cell_shape::{CELLS, CellShape};
use super::surface_rows::{CellsOfRow, SurfaceRow, find_surface};
use super::window::Window;
use glam::IVec3;
use palpate_volume::occupancy::Occupancy;

/// What is kept of a row of cells along x.
#[derive(Clone, Copy, Debug)]
struct KeptRow {
    /// The number of its first cell.
    first: IVec3,
    /// Voxels at the surface.
    surface: SurfaceRow,
    /// What cells count beyond their bits.
    changes: Changes,
}

impl KeptRow {
    /// No surface, so that nothing counts.
    const NONE: Self = Self {
        first: IVec3::ZERO,
        surface: SurfaceRow::NONE,
        changes: Changes::NONE,
    };

    /// Makes it what is kept of the row with another first cell.
    #[inline]
    fn move_to(&mut self, first: IVec3, shape: CellShape) {
        let is_same_row = (self.first.y, self.first.z) == (first.y, first.z);
        let cells = match is_same_row {
            true => first.x - self.first.x,
            false => CELLS,
        };
        *self = Self {
            first,
            surface: self.surface.moved(shape, cells),
            changes: self.changes.moved(cells),
        };
    }
}

/// What cells of one body count beyond their bits.
#[derive(Clone, Debug)]
pub(super) struct CellFractions {
    /// What all was made from; none where nothing is to be used.
    source: Option<Source>,
    shape: CellShape,
    /// The last of those rows whose y and z end on the same three bits, so that all of a window
    /// have places of their own.
    rows: [KeptRow; 64],
}

impl CellFractions {
    /// Nothing is kept yet.
    pub(super) const EMPTY: Self = Self {
        source: None,
        shape: CellShape::ONE,
        rows: [KeptRow::NONE; 64],
    };

    /// Has all made anew.
    pub(super) fn forget(&mut self) {
        self.source = None;
    }

    /// Keeps what was made from the same, and nothing else.
    pub(super) fn keep(&mut self, source: Source, shape: CellShape) {
        if (self.source, self.shape) != (Some(source), shape) {
            (self.source, self.shape) = (Some(source), shape);
            self.rows = [KeptRow::NONE; 64];
        }
    }

    /// Tells what the cells of a window count beyond their bits, by rows of cells at its surface,
    /// y before z, eight of each; one voxel counts [`unit_of`].
    #[inline(always)]
    pub(super) fn look_at(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        window: &Window,
        mut tell: impl FnMut(usize, Changes),
    ) {
        let shape = self.shape;
        let mut asked = Asked::nothing(occupancy);
        let mut surfaces = [SurfaceRow::NONE; 64];
        let rows = find_surface(window, &mut surfaces);
        let first_of = |row: usize| window.first() + IVec3::new(0, row as i32 & 7, row as i32 >> 3);
        for row in ones(rows) {
            let (first, surface) = (first_of(row), surfaces[row]);
            let kept = &mut self.rows[place_of(first)];
            if kept.first != first {
                kept.move_to(first, shape);
            }
            if kept.surface == surface {
                continue;
            }
            let cells = surface.differing(kept.surface, shape);
            kept.surface = surface;
            asked.add(row, shape, first, surface, cells);
        }
        asked.ask();

        let unit = f32::from(unit_of(shape.volume()));
        for row in ones(rows) {
            let first = first_of(row);
            let changes = &mut self.rows[place_of(first)].changes;
            // also of cells without voxels, which may have had some
            for cell in asked.cells[row].places(shape) {
                changes.set(cell, rounded(asked.sums[row][cell as usize & 7] * unit));
            }
            tell(row, *changes);
        }
    }
}

/// The place of a row among those that are kept.
#[inline]
fn place_of(first: IVec3) -> usize {
    let [y, z] = [first.y, first.z].map(|number| (number & (CELLS - 1)) as usize);
    (8 * z + y) & 63
}

/// The places of set bits.
fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (word != 0).then(|| word.trailing_zeros() as usize & 63)?;
        word &= word - 1;
        Some(place)
    })
}

/// Voxels that are asked for at once.
const AT_ONCE: usize = 32;

/// Cells of a window whose voxels at the surface are asked for their fractions.
struct Asked<'a, O: ?Sized> {
    occupancy: &'a O,
    /// Cells of each row of the window that are asked for.
    cells: [CellsOfRow; 64],
    /// Sum of the voxels' changes in each cell [voxels], beyond their bits.
    sums: [[f32; 8]; 64],
    /// Voxels that are to be asked for next.
    voxels: [(IVec3, bool); AT_ONCE],
    /// Their rows and cells.
    places: [[u8; 2]; AT_ONCE],
    count: usize,
}

impl<'a, O: Occupancy + ?Sized> Asked<'a, O> {
    fn nothing(occupancy: &'a O) -> Self {
        Self {
            occupancy,
            cells: [CellsOfRow::NONE; 64],
            sums: [[0.0; 8]; 64],
            voxels: [(IVec3::ZERO, false); AT_ONCE],
            places: [[0; 2]; AT_ONCE],
            count: 0,
        }
    }

    /// Asks for the voxels of some cells of a row.
    #[inline]
    fn add(
        &mut self,
        row: usize,
        shape: CellShape,
        first: IVec3,
        surface: SurfaceRow,
        cells: CellsOfRow,
    ) {
        self.cells[row & 63] = cells;
        surface.visit(shape, first, cells, |cell, voxel, solid| {
            let next = self.count & (AT_ONCE - 1);
            self.voxels[next] = (voxel, solid);
            self.places[next] = [row as u8, cell as u8];
            self.count += 1;
            if self.count == AT_ONCE {
                self.ask();
            }
        });
    }

    #[inline(never)]
    fn ask(&mut self) {
        let count = self.count.min(AT_ONCE);
        let mut changes = [0.0_f32; AT_ONCE];
        let asked = &self.voxels[..count];
        self.occupancy
            .fraction_changes(asked, &mut changes[..count]);
        for ([row, cell], change) in self.places[..count].iter().zip(changes) {
            self.sums[usize::from(row & 63)][usize::from(cell & 7)] += change;
        }
        self.count = 0;
    }
}

/// The whole number next to a small one, of two the even one, without a call.
#[inline]
fn rounded(number: f32) -> i32 {
    // the last bits of a number of this size are ones
    const ROUNDING: f32 = 1.5 * (1 << 23) as f32;
    (number + ROUNDING).to_bits() as i32 - ROUNDING.to_bits() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const AXES: [IVec3; 3] = [IVec3::X, IVec3::Y, IVec3::Z];

    /// Voxels and fractions as good as random, a function of the place.
    struct Speckled {
        salt: i32,
        density: u32,
    }

    impl Speckled {
        fn random(&self, voxel: IVec3, salt: i32) -> u32 {
            let voxel = voxel.wrapping_mul(IVec3::new(73_856_093, 19_349_663, 83_492_791));
            let mut bits = (voxel.x ^ voxel.y ^ voxel.z) as u32;
            bits ^= (salt + 7 * self.salt) as u32;
            for _ in 0..3 {
                bits = (bits ^ bits >> 15).wrapping_mul(0x2c1b_3c6d);
            }
            (bits ^ bits >> 16) % 100
        }
    }

    impl Occupancy for Speckled {
        fn is_solid(&self, voxel: IVec3) -> bool {
            self.random(voxel, 1) < self.density
        }

        fn occupancy_fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
            let fraction = self.random(voxel, 2) as f32 / 200.0;
            let known = self.random(voxel, 3) < 90;
            known.then_some(if solid { 1.0 - fraction } else { fraction })
        }
    }

    /// The same, voxel by voxel.
    fn plainly(occupancy: &Speckled, window: &Window, shape: CellShape, cell: IVec3) -> i32 {
        let size = shape.voxels();
        let mut change = 0.0_f32;
        for z in 0..size.z {
            for y in 0..size.y {
                for x in 0..size.x {
                    let voxel = cell * size + IVec3::new(x, y, z);
                    let reached = window.is_reached(voxel);
                    let beside = AXES.map(|axis| [voxel - axis, voxel + axis]);
                    let at_surface = beside
                        .iter()
                        .flatten()
                        .any(|beside| window.is_reached(*beside) != reached);
                    let solid = occupancy.is_solid(voxel);
                    if at_surface && (reached || solid) {
                        let fraction = occupancy.occupancy_fraction(voxel, solid);
                        change +=
                            fraction.map_or(0.0, |fraction| fraction - f32::from(u8::from(solid)));
                    }
                }
            }
        }
        (change * f32::from(unit_of(shape.volume()))).round_ties_even() as i32
    }

    #[test]
    fn what_is_kept_from_window_to_window_is_what_single_voxels_give() {
        let mut random = oorandom::Rand64::new(41);
        let spacings = [
            DVec3::ONE,
            DVec3::new(0.7, 0.7, 2.5),
            DVec3::new(1.0, 1.0, 2.0),
            DVec3::new(3.0, 0.8, 0.8),
            DVec3::new(1.0, 4.0, 1.5),
        ];
        for spacing in spacings {
            let shape = CellShape::for_spacing(spacing);
            let mut known = CellFractions::EMPTY;
            let mut first = IVec3::new(-3, 5, -2);
            let mut counted = 0;
            for step in 0..300_u64 {
                // another body now and then, under another epoch
                let body = step / 60;
                let occupancy = Speckled {
                    salt: body as i32,
                    density: 20 + 10 * body as u32,
                };
                let (epoch, fractions) = (body, true);
                known.keep(Source { epoch, fractions }, shape);
                let axis = AXES[random.rand_range(0..3) as usize];
                // mostly to the next window, sometimes far away
                let way = match random.rand_range(0..20) {
                    0 => 9,
                    _ => 1,
                };
                first += axis * if random.rand_float() < 0.5 { way } else { -way };
                let seed = (first + 4) * shape.voxels();
                let mut window = Window::NONE;
                if !window.read(&occupancy, shape, first, seed) {
                    continue;
                }
                let mut told = [Changes::NONE; 64];
                known.look_at(&occupancy, &window, |row, changes| told[row] = changes);
                for place in 0..512 {
                    let cell = IVec3::new(place % 8, place / 8 % 8, place / 64);
                    if cell.min_element() == 0 || cell.max_element() == 7 {
                        continue;
                    }
                    let plain = plainly(&occupancy, &window, shape, first + cell);
                    let change = told[place as usize / 8].get(cell.x as u32);
                    assert_eq!(change, plain, "step {step}, cell {cell}, {spacing} mm");
                    counted += i32::from(plain != 0);
                }
            }
            assert!(counted > 1000, "{counted} cells at {spacing} mm");
        }
    }
}
