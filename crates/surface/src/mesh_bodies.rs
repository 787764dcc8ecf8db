//! Bodies of a mesh: parts that hang together, and what each of them encloses.
//!
//! A shell that turns inward is a cavity of the body around it, no body.

use glam::{DVec3, Vec3};
use palpate_volume::bodies::Union;

use crate::cell_volume::below;
use crate::patch::Patch;

/// Volume [mm³] that each shell of a closed mesh encloses, less than zero for cavities.
pub fn shell_volumes(mesh: &Patch) -> Vec<f64> {
    let mut united = Union::of(mesh.vertices.len());
    for &[a, b, c] in &mesh.triangles {
        united.unite(a, b);
        united.unite(a, c);
    }
    let (shells, count) = united.numbered();
    let mut volumes = vec![0.0; count];
    // counted from a corner of their own, so that small shells far from zero are exact
    let mut origins = vec![None; count];
    for triangle in &mesh.triangles {
        let shell = shells[triangle[0] as usize] as usize;
        let corners = triangle.map(|vertex| Vec3::from(mesh.vertices[vertex as usize]).as_dvec3());
        let origin: DVec3 = *origins[shell].get_or_insert(corners[0]);
        volumes[shell] += below(corners, origin);
    }
    volumes
}

/// How many bodies a closed mesh has.
pub fn body_count(mesh: &Patch) -> usize {
    let volumes = shell_volumes(mesh).into_iter();
    volumes.filter(|volume| *volume > 0.0).count()
}
