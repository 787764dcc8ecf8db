//! A body as voxels: solid where its middle is inside, or as a scanner sees it, by the fraction of
//! each voxel that is inside, from which a threshold at one half makes what is solid.
//!
//! Frame: grid of the case.

use glam::{DVec3, IVec3, UVec3};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

use super::body::Body;

/// The value of a voxel that is all inside: the highest.
pub const FULL: f64 = 1000.0;
/// Values from here on are solid.
pub const THRESHOLD: f64 = 0.5 * FULL;
/// Points along the shortest edge of a voxel by which its fraction is counted; along the others as
/// near to each other. So a fraction is wrong by a twelfth of that edge at most.
const SUBSAMPLES: f64 = 6.0;

/// A body as voxels.
#[derive(Clone, Debug)]
pub struct Solid {
    /// What is solid.
    pub bits: Bits,
    /// The same without what a shell leaves out.
    pub filled: Bits,
    /// The values that a threshold made it from, if one did.
    pub values: Option<Intensities>,
}

impl Solid {
    /// The voxels whose middle is inside.
    #[must_use]
    pub fn of_middles(body: &Body, grid: &Grid) -> Self {
        let [filled, bits] = voxels(body, grid, |voxel| body.holds_middle(grid, voxel));
        Self {
            bits,
            filled,
            values: None,
        }
    }

    /// Partial volumes, and the voxels of which half or more is inside.
    #[must_use]
    pub fn of_fractions(body: &Body, grid: &Grid) -> Self {
        let fractions = fractions(body, grid);
        let size = grid.dimensions();
        let share = |voxel: IVec3| {
            let inside = voxel.clamp(IVec3::ZERO, size.as_ivec3() - 1).as_uvec3();
            fractions[((inside.z * size.y + inside.y) * size.x + inside.x) as usize]
        };
        let [filled, bits] = voxels(body, grid, |voxel| f64::from(share(voxel)) >= THRESHOLD);
        // inside a shell there is nothing again
        let values = each_voxel(size).map(|voxel| {
            let is_left_out = filled.is_solid(voxel) && !bits.is_solid(voxel);
            if is_left_out { 0 } else { share(voxel) }
        });
        let values = Intensities::new(size, values.collect::<Vec<_>>(), 1.0, 0.0);
        Self {
            bits,
            filled,
            values: Some(values.expect("one value per voxel")),
        }
    }
}

/// The voxels inside, and of these, where the body is a shell, those that few steps through faces
/// lead out of, so that no way through faces crosses it.
fn voxels(body: &Body, grid: &Grid, is_inside: impl Fn(IVec3) -> bool + Sync) -> [Bits; 2] {
    let inside = Segment::from_fn(grid.dimensions(), &is_inside);
    let Some(layers) = body.shell else {
        return [(); 2].map(|()| inside.occupancy().clone());
    };
    let leads_out = |voxel: IVec3| {
        let near = -layers..=layers;
        let steps = |x: i32, y: i32, z: i32| x.abs() + y.abs() + z.abs();
        near.clone().any(|z| {
            near.clone().any(|y| {
                near.clone()
                    .any(|x| steps(x, y, z) <= layers && !is_inside(voxel + IVec3::new(x, y, z)))
            })
        })
    };
    let shell = Segment::from_fn(grid.dimensions(), |voxel| {
        inside.contains(voxel) && leads_out(voxel)
    });
    [inside, shell].map(|segment| segment.occupancy().clone())
}

/// The value of each voxel by the fraction that is inside, x fastest.
fn fractions(body: &Body, grid: &Grid) -> Vec<i16> {
    let scene_from_grid = grid.patient_from_grid();
    let half_diagonal = 0.5 * grid.spacing().length();
    let per_edge = (SUBSAMPLES * grid.spacing() / grid.smallest_spacing()).ceil();
    let points: Vec<DVec3> = each_voxel(per_edge.as_uvec3())
        .map(|point| (point.as_dvec3() + 0.5) / per_edge)
        .collect();
    each_voxel(grid.dimensions())
        .map(|voxel| {
            let corner = voxel.as_dvec3();
            let distance = body.distance(scene_from_grid.transform_point3(corner + 0.5));
            if distance.abs() > half_diagonal {
                return if distance < 0.0 { FULL as i16 } else { 0 };
            }
            let is_inside =
                |point: &&DVec3| body.contains(scene_from_grid.transform_point3(corner + **point));
            let count = points.iter().filter(is_inside).count();
            (FULL * count as f64 / points.len() as f64).round() as i16
        })
        .collect()
}

fn each_voxel(size: UVec3) -> impl Iterator<Item = IVec3> {
    let size = size.as_ivec3();
    (0..size.z).flat_map(move |z| {
        (0..size.y).flat_map(move |y| (0..size.x).map(move |x| IVec3::new(x, y, z)))
    })
}
