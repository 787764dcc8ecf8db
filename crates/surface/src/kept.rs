//! A surface as one mesh for files, and what it keeps of the voxels that it was made of.

use palpate_volume::bodies::Bodies;
use palpate_volume::grid::Grid;

use crate::mesh::joined;
use crate::mesh_bodies::body_count;
use crate::patch::Patch;
use crate::segment_surface::SegmentSurface;
use crate::settings::{SettingsError, SmoothingMode, SurfaceSettings};
use crate::voxel_faces::{VoxelFaces, voxel_faces};
use crate::voxel_source::VoxelSource;

/// The whole surface of a segment, and what it keeps.
#[derive(Clone, Debug)]
pub struct KeptSurface {
    /// All of it.
    pub mesh: Patch,
    /// Volume of the voxels [mm³].
    pub voxel_volume: f64,
    /// Bodies of the voxels: those that share faces or edges are one.
    pub voxel_bodies: usize,
    /// Bodies of the mesh.
    pub bodies: usize,
    /// Edges along which voxels touch that share no face, where the mesh is the voxels as they
    /// are: four triangles meet there in space.
    pub touching_edges: usize,
}

/// Makes the whole surface of a segment: of degree 0 from bits, the faces of its voxels.
///
/// # Errors
/// Where the settings make no surface.
///
/// # Panics
/// Where the voxels are those of another grid.
pub fn kept_surface(
    grid: &Grid,
    voxels: &VoxelSource<'_>,
    settings: SurfaceSettings,
) -> Result<KeptSurface, SettingsError> {
    settings.check()?;
    let VoxelFaces {
        mesh,
        touching_edges,
    } = if is_of_voxels(&settings) {
        voxel_faces(grid, voxels.bits)
    } else {
        VoxelFaces {
            mesh: joined(&extracted(grid, voxels, settings)?),
            touching_edges: 0,
        }
    };
    let of_voxels = Bodies::of(voxels.bits);
    let bodies = if settings.mode == SmoothingMode::Local {
        // patches that do not meet have the bodies of the same surface where they do
        let mode = SmoothingMode::Global;
        let whole = extracted(grid, voxels, SurfaceSettings { mode, ..settings })?;
        body_count(&joined(&whole))
    } else {
        body_count(&mesh)
    };
    Ok(KeptSurface {
        voxel_volume: of_voxels.voxel_count() as f64 * grid.spacing().element_product(),
        voxel_bodies: of_voxels.count(),
        bodies,
        mesh,
        touching_edges,
    })
}

/// Whether a surface is the faces of voxels.
fn is_of_voxels(settings: &SurfaceSettings) -> bool {
    settings.step == 1 && settings.smoothing == 0 && settings.limits.is_none()
}

fn extracted(
    grid: &Grid,
    voxels: &VoxelSource<'_>,
    settings: SurfaceSettings,
) -> Result<SegmentSurface, SettingsError> {
    let mut surface = SegmentSurface::new(grid, settings)?;
    surface.update(voxels, &grid.bounds());
    Ok(surface)
}
