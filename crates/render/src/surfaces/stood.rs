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
        let mut positions = triangles.positions().to_vec();
        let mut normals = triangles.normals().to_vec();
        let mut any = false;
        for (positions, normals) in positions.chunks_mut(LANES).zip(normals.chunks_mut(LANES)) {
            any |= self.stand(positions, normals);
        }
        any.then_some((positions, normals))
    }

    /// Moves at most eight corners; returns whether any moved.
    fn stand(&self, positions: &mut [[f32; 3]], normals: &mut [[f32; 3]]) -> bool {
        let to_axes = self.axes.transpose();
        let rest = lanes(positions, |at| self.first + self.turn * at);
        let normal = lanes(normals, |at| to_axes * at);
        let Some((place, normal)) = self.displaced.stood_at(rest, normal, self.spacing) else {
            return false;
        };
        let moved = (place - rest).times(Vector::splat(self.spacing));
        for (lane, (position, to)) in positions.iter_mut().zip(apart(moved)).enumerate() {
            let moved = self.axes * to;
            *position = (Vec3::from(*position) + moved).into();
            normals[lane] = (self.axes * apart(normal)[lane]).into();
        }
        true
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
