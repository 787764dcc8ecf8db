//! What changed in the picture, as the dictionaries that the package reads.
//!
//! The keys are the fields of `protocol.Changed`.

use std::time::{SystemTime, UNIX_EPOCH};

use palpate_engine::deformable::Displacements;
use palpate_engine::picture::{PackedPatch, PictureChange, SurfaceChange, VoxelChange};
use palpate_surface::PatchId;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::triple;
use crate::frame::dictionary;

type Place = (i64, i64, i64);

/// A change of voxels and surfaces.
pub fn change_dict<'py>(py: Python<'py>, change: &PictureChange) -> PyResult<Bound<'py, PyDict>> {
    let voxels = change.voxels.iter();
    let voxels: Vec<_> = voxels
        .map(|voxels| voxels_dict(py, voxels))
        .collect::<PyResult<_>>()?;
    let surfaces = change.surfaces.iter();
    let surfaces: Vec<_> = surfaces
        .map(|(id, surface)| surface_dict(py, *id, surface))
        .collect::<PyResult<_>>()?;
    let displaced = change.displacements.as_ref().map(|boxes| {
        let boxes = boxes.iter().map(|nodes| displaced_dict(py, nodes));
        boxes.collect::<PyResult<Vec<_>>>()
    });
    dictionary!(py,
        "edit": change.edit,
        "applied": change.applied.map(seconds_since_1970),
        "voxels": voxels,
        "surfaces": surfaces,
        "displaced": displaced.transpose()?,
    )
}

fn displaced_dict<'py>(py: Python<'py>, now: &Displacements) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "origin": triple(now.origin),
        "step": triple(now.step),
        "size": now.size.to_array(),
        "moved": PyBytes::new(py, &now.packed()),
    )
}

fn seconds_since_1970(moment: SystemTime) -> f64 {
    let since = moment.duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

pub fn voxels_dict<'py>(py: Python<'py>, voxels: &VoxelChange) -> PyResult<Bound<'py, PyDict>> {
    let VoxelBox { min, max } = voxels.region;
    let little_endian = |stored: &Vec<i16>| -> Vec<u8> {
        stored
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    };
    dictionary!(py,
        "low": (min.x, min.y, min.z),
        "high": (max.x, max.y, max.z),
        "stored": voxels.stored.as_ref().map(|stored| PyBytes::new(py, &little_endian(stored))),
        "labels": voxels.labels.as_ref().map(|labels| PyBytes::new(py, labels)),
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
