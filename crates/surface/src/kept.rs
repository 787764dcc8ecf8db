//! A surface as one mesh for files, and what it keeps of the voxels that it was made of.

use palpate_volume::bodies::Bodies;
use palpate_volume::grid::Grid;

use crate::mesh::joined;
use crate::mesh_bodies::body_count;
use crate::patch::Patch;
use crate::segment_surface::SegmentSurface;
use crate::settings::{SettingsError, SmoothingMode, SurfaceSettings};
use crate::thin_parts::{ThinPart, keep_thin_parts, thin_parts_in_samples};
use crate::voxel_faces::voxel_faces;
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
    /// What is thin, and how much of it is kept; of steps of 2 and 4, the share of its voxels that
    /// lies in solid cells. None where the mesh is the voxels, or patches are smoothed alone.
    pub thin_parts: Vec<ThinPart>,
}

impl KeptSurface {
    /// Volume that the voxels stand for [mm³]: of what is thin by the values, where they tell.
    pub fn expected_volume(&self) -> f64 {
        let parts = self.thin_parts.iter();
        self.voxel_volume
            + parts
                .map(|part| part.expected - part.voxel_volume)
                .sum::<f64>()
    }

    /// Whether most of what is thin was measured with the threshold taken for halfway.
    pub fn is_halfway(&self) -> bool {
        let volume_of = |is_halfway: bool| -> f64 {
            let parts = self.thin_parts.iter();
            let alike = parts.filter(|part| part.is_halfway == is_halfway);
            alike.map(|part| part.expected).sum()
        };
        volume_of(true) > volume_of(false)
    }
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
    let of_voxels = Bodies::of(voxels.bits);
    let mut touching_edges = 0;
    let mut thin_parts = Vec::new();
    let mesh = if is_of_voxels(&settings) {
        let faces = voxel_faces(grid, voxels.bits);
        touching_edges = faces.touching_edges;
        faces.mesh
    } else {
        let mut mesh = joined(&extracted(grid, voxels, settings)?);
        if settings.step > 1 {
            thin_parts = thin_parts_in_samples(grid, voxels, &settings, &of_voxels);
        } else if settings.mode == SmoothingMode::Global {
            let limits = settings.limits.filter(|_| voxels.values.is_some());
            thin_parts = keep_thin_parts(&mut mesh, grid, voxels, limits, &of_voxels);
        }
        mesh
    };
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
        thin_parts,
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
