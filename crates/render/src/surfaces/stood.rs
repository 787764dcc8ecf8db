//! Corners of a surface where the tissue of its segment stands: displaced as the voxels around them are.

use glam::{Mat3, Vec3};
use palpate_volume::grid::Grid;

use crate::displaced::Displaced;
use crate::lanes::{Floats, Gather, LANES, Plain, Vector};
use crate::scene::Scene;
use crate::surfaces::{SegmentSurface, Triangles};

/// What moves the corners of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving<'a> {
    displaced: &'a Displaced,
    spacing: Vec3,
    /// From positions of the surface to places of the grid.
    turn: Mat3,
    first: Vec3,
    /// The grid's axes in the patient.
    axes: Mat3,
}

/// Positions and normals of corners, as [`Triangles`] has them.
pub(super) type Corners = (Vec<[f32; 3]>, Vec<[f32; 3]>);

impl<'a> Moving<'a> {
    /// Of a surface that stands where the scan has its segment; none of another one, whose tissue no model displaces.
    pub fn of(scene: &'a Scene, surface: &SegmentSurface) -> Option<Self> {
        let displaced = scene.displaced.as_ref()?;
        let grid: &Grid = scene.grid();
        let to_grid = grid.grid_from_patient();
        surface.is_at_rest().then(|| Self {
            displaced,
            spacing: grid.spacing().as_vec3(),
            turn: to_grid.matrix3.as_mat3(),
            first: to_grid.transform_point3(surface.origin).as_vec3(),
            axes: grid.direction().as_mat3(),
        })
    }

    /// Where places are at rest that tissue stands at.
    pub fn at_rest<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        self.displaced.at_rest(grid)
    }

    /// Corners where they stand; none where all do so where they are at rest.
    pub(super) fn corners(&self, triangles: &dyn Triangles) -> Option<Corners> {
        let (positions, normals) = (triangles.positions(), triangles.normals());
        // most patches are far from what is displaced, and stay shared
        let mut stood: Option<Corners> = None;
        let eights = positions.chunks(LANES).zip(normals.chunks(LANES));
        for (number, (at, normal)) in eights.enumerate() {
            if let Some((moved, turned)) = self.stand(at, normal) {
                let (positions, normals) =
                    stood.get_or_insert_with(|| (positions.to_vec(), normals.to_vec()));
                for lane in 0..at.len() {
                    let corner = number * LANES + lane;
                    positions[corner] = (Vec3::from(at[lane]) + moved[lane]).into();
                    normals[corner] = turned[lane].into();
                }
            }
        }
        stood
    }

    /// How far at most eight corners move, and their normals then; none where none moves.
    fn stand(
        &self,
        positions: &[[f32; 3]],
        normals: &[[f32; 3]],
    ) -> Option<([Vec3; LANES], [Vec3; LANES])> {
        let to_axes = self.axes.transpose();
        let rest = lanes(positions, |at| self.first + self.turn * at);
        let normal = lanes(normals, |at| to_axes * at);
        let (place, normal) = self.displaced.stood_at(rest, normal, self.spacing)?;
        let moved = (place - rest).times(Vector::splat(self.spacing));
        let in_patient = |vectors| apart(vectors).map(|it| self.axes * it);
        Some((in_patient(moved), in_patient(normal)))
    }
}

fn lanes(vectors: &[[f32; 3]], of: impl Fn(Vec3) -> Vec3) -> Vector<Plain> {
    let mut all = [[0.0; LANES]; 3];
    for (lane, vector) in vectors.iter().enumerate() {
        let [x, y, z] = of(Vec3::from(*vector)).to_array();
        (all[0][lane], all[1][lane], all[2][lane]) = (x, y, z);
    }
    let [x, y, z] = &all;
    Vector::new(Floats::load(x), Floats::load(y), Floats::load(z))
}

fn apart(vectors: Vector<Plain>) -> [Vec3; LANES] {
    let (x, y, z) = (vectors.x.store(), vectors.y.store(), vectors.z.store());
    std::array::from_fn(|lane| Vec3::new(x[lane], y[lane], z[lane]))
}
