//! Where particles stand at rest: the FCC lattice and the lattice of cubes.

use glam::{DVec3, IVec3};

/// The four places of a cubic FCC cell, in units of its side. The thesis puts them on the
/// cell's corner and faces, where any small move changes the voxel that owns the particle;
/// shifted by a quarter they lie inside (errata 5.9, 5.25).
pub const FCC_BASIS: [DVec3; 4] = [
    DVec3::new(0.25, 0.25, 0.25),
    DVec3::new(0.75, 0.75, 0.25),
    DVec3::new(0.75, 0.25, 0.75),
    DVec3::new(0.25, 0.75, 0.75),
];

/// χ of the FCC lattice with Lennard-Jones cut at 2.1 a (four shells): nearest neighbours of
/// the lattice without pressure stand χ a apart (thesis 5.39, constant from its source).
pub const FCC_CHI: f64 = 0.978_41;

/// FCC lattice of `cells` cubic cells with nearest neighbours `spacing` apart, the first
/// cell's corner at the origin; x fastest, four particles a cell.
pub fn fcc(cells: IVec3, spacing: f64) -> Vec<DVec3> {
    let side = spacing * std::f64::consts::SQRT_2;
    let each = |cell: DVec3| FCC_BASIS.map(|place| side * (cell + place));
    cells_of(cells).flat_map(each).collect()
}

/// One particle in the middle of each of `cells` cubes; x fastest.
pub fn cubes(cells: IVec3, side: f64) -> Vec<DVec3> {
    cells_of(cells).map(|cell| side * (cell + 0.5)).collect()
}

fn cells_of(cells: IVec3) -> impl Iterator<Item = DVec3> {
    (0..cells.z).flat_map(move |z| {
        (0..cells.y).flat_map(move |y| (0..cells.x).map(move |x| IVec3::new(x, y, z).as_dvec3()))
    })
}
