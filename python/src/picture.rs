//! What changed in the picture, as the dictionaries that the package reads.
//!
//! The keys are the fields of `protocol.Changed`; a change may come in several of them.

use palpate_engine::packed_patch::PackedPatch;
use palpate_engine::surfaces::{PictureChange, SurfaceChange, VoxelChange};
use palpate_surface::PatchId;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::triple;
use crate::frame::dictionary;

type Place = (i64, i64, i64);

/// A change as one dictionary for each box of voxels, the surfaces with the last.
pub fn change_dicts<'py>(
    py: Python<'py>,
    change: &PictureChange,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let surfaces = change.surfaces.iter();
    let mut surfaces: Vec<_> = surfaces
        .map(|(id, surface)| surface_dict(py, *id, surface))
        .collect::<PyResult<_>>()?;
    let mut dicts = Vec::with_capacity(change.voxels.len().max(1));
    for (place, voxels) in change.voxels.iter().enumerate() {
        let is_last = place + 1 == change.voxels.len();
        let with = if is_last {
            std::mem::take(&mut surfaces)
        } else {
            Vec::new()
        };
        dicts.push(changed_dict(py, change.edit, Some(voxels), with)?);
    }
    if change.voxels.is_empty() {
        dicts.push(changed_dict(py, change.edit, None, surfaces)?);
    }
    Ok(dicts)
}

fn changed_dict<'py>(
    py: Python<'py>,
    edit: u64,
    voxels: Option<&VoxelChange>,
    surfaces: Vec<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyDict>> {
    let region = voxels.map_or(VoxelBox::EMPTY, |voxels| voxels.region);
    let stored = voxels.and_then(|voxels| voxels.stored.as_ref());
    let labels = voxels.and_then(|voxels| voxels.labels.as_ref());
    let little_endian = |stored: &Vec<i16>| -> Vec<u8> {
        stored
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    };
    dictionary!(py,
        "edit": edit,
        "low": (region.min.x, region.min.y, region.min.z),
        "high": (region.max.x, region.max.y, region.max.z),
        "stored": stored.map(|stored| PyBytes::new(py, &little_endian(stored))),
        "labels": labels.map(|labels| PyBytes::new(py, labels)),
        "surfaces": surfaces,
    )
}

fn surface_dict<'py>(
    py: Python<'py>,
    id: SegmentId,
    change: &SurfaceChange,
) -> PyResult<Bound<'py, PyDict>> {
    let patches = change.patches.iter();
    let patches: Vec<_> = patches
        .map(|(id, patch)| patch_dict(py, *id, patch))
        .collect::<PyResult<_>>()?;
    dictionary!(py,
        "id": id.0,
        "whole": change.whole,
        "dropped": change.dropped.iter().map(|id| place_of(*id)).collect::<Vec<_>>(),
        "patches": patches,
    )
}

fn patch_dict<'py>(
    py: Python<'py>,
    id: PatchId,
    patch: &PackedPatch,
) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "index": place_of(id),
        "origin": triple(patch.origin),
        "size": triple(patch.size),
        "vertices": PyBytes::new(py, &patch.vertices),
        "normals": PyBytes::new(py, &patch.normals),
        "triangles": PyBytes::new(py, &patch.triangles),
    )
}

/// A block and the nine patches that it may hold, as one place.
fn place_of(id: PatchId) -> Place {
    let [x, y, z] = id.block.map(i64::from);
    (9 * x + i64::from(id.part), y, z)
}
