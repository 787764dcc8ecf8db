//! A surface as it is drawn in one picture: how it looks, where it stands, and which voxels are its segment's.

use glam::{Affine3A, DAffine3, DMat3, Mat3, Vec3};
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;

use crate::appearance::ShownSurface;
use crate::field::Field;
use crate::lanes::{Floats, Gather, LANES, Masks, Plain, Vector};
use crate::prepared::Prepared;
use crate::scene::Scene;
use crate::segments::code_of_number;
use crate::surfaces::{Moving, SegmentSurface};

/// A surface, for one picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnSurface<'a> {
    pub shown: ShownSurface,
    pub surface: &'a SegmentSurface,
    /// What displaces it.
    pub moving: Option<Moving<'a>>,
    /// Of its segment; see [`crate::segments::Segments`].
    pub code: i32,
    pub own: Own<'a>,
    /// Normals where it stands, and where the scan has the segment; along the grid's axes.
    pub posed: Mat3,
    pub at_rest: Mat3,
    /// From a place of the scan's grid to where the scan has what stands there, and back.
    pub rest_from_posed: Affine3A,
    pub posed_from_rest: Affine3A,
}

/// What tells which places belong to the segment, where the scan has it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Own<'a> {
    /// Its voxels stand on a grid of their own.
    Nothing,
    /// Limits of a threshold [stored values].
    Values(f32, f32),
    Voxels(&'a Bits),
}

impl<'a> DrawnSurface<'a> {
    /// All surfaces of a scene that an appearance shows.
    pub fn all(scene: &'a Scene, prepared: &'a Prepared) -> Vec<Self> {
        let shown = prepared.appearance.surfaces.iter();
        shown
            .filter_map(|&shown| {
                let surface = scene.surfaces.iter().find(|it| it.id == shown.id)?;
                Some(Self::new(scene, prepared, shown, surface))
            })
            .collect()
    }

    fn new(
        scene: &'a Scene,
        prepared: &'a Prepared,
        shown: ShownSurface,
        surface: &'a SegmentSurface,
    ) -> Self {
        let grid = scene.grid();
        let turned: DMat3 = grid.direction().transpose();
        let posed_from_rest = in_grid(grid, surface.pose);
        Self {
            own: own_of(scene, prepared, shown.id),
            moving: Moving::of(scene, surface),
            code: code_of_number(shown.id),
            posed: (turned * surface.pose.matrix3).as_mat3(),
            at_rest: turned.as_mat3(),
            rest_from_posed: affine(posed_from_rest.inverse()),
            posed_from_rest: affine(posed_from_rest),
            shown,
            surface,
        }
    }

    /// Whether a place where the surface stands belongs to its segment.
    pub fn holds(&self, field: &Field, posed: Vec3) -> bool {
        let place = self.rest_from_posed.transform_point3(posed);
        self.own_at::<Plain>(field, Vector::splat(place)).bits() & 1 == 1
    }

    /// Whether the tissue that stands at places where the scan has the segment belongs to it.
    #[inline(always)]
    pub fn own_at<L: Gather>(&self, field: &Field, grid: Vector<L>) -> L::Mask {
        let grid = match &self.moving {
            None => grid,
            Some(moving) => moving.at_rest(grid),
        };
        match self.own {
            Own::Nothing => L::Mask::splat(false),
            Own::Voxels(bits) => L::Mask::from_bits(solid_lanes::<L>(bits, grid)),
            Own::Values(low, high) => {
                let value = field.value_at(grid);
                L::Float::splat(low).at_most(value) & value.at_most(Floats::splat(high))
            }
        }
    }
}

#[inline(never)]
fn solid_lanes<L: Gather>(bits: &Bits, grid: Vector<L>) -> u8 {
    let (x, y, z) = (grid.x.store(), grid.y.store(), grid.z.store());
    (0..LANES)
        .filter(|&lane| bits.is_solid(Vec3::new(x[lane], y[lane], z[lane]).floor().as_ivec3()))
        .fold(0, |lanes, lane| lanes | 1 << lane)
}

fn own_of<'a>(scene: &'a Scene, prepared: &'a Prepared, id: u8) -> Own<'a> {
    if let Some((low, high)) = prepared.segments.limits_of(id) {
        return Own::Values(low, high);
    }
    match scene.voxels().segment(SegmentId(id)) {
        Some(segment) if segment.own_grid().is_none() => Own::Voxels(segment.occupancy()),
        _ => Own::Nothing,
    }
}

/// A motion of the patient as one of places in the grid.
fn in_grid(grid: &Grid, pose: DAffine3) -> DAffine3 {
    grid.grid_from_patient() * pose * grid.patient_from_grid()
}

fn affine(from: DAffine3) -> Affine3A {
    Affine3A::from_mat3_translation(from.matrix3.as_mat3(), from.translation.as_vec3())
}
