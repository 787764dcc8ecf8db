//! Which segment holds the probe back: the first solid voxel on the way from probe to device.

use palpate_volume::edit::SegmentId;
use palpate_volume::first_solid::{Outcome, first_solid_bounded};

use crate::handover::ServoStatus;
use crate::scene::Scene;

/// Voxels looked at per segment; the obstacle is next to the probe.
const MAX_VISITS: u32 = 64;

/// The touchable segment that the probe of `status` touches.
#[must_use]
pub fn touched_segment(scene: &Scene, status: &ServoStatus) -> Option<SegmentId> {
    if !status.contact {
        return None;
    }
    let grid_from_scene = scene.voxels().grid().grid_from_patient();
    let start = grid_from_scene.transform_point3(status.proxy);
    let end = grid_from_scene.transform_point3(status.device);
    scene
        .segments()
        .filter(|(_, _, properties)| properties.touchable)
        .filter_map(|(id, segment, _)| {
            match first_solid_bounded(segment, start, end, MAX_VISITS).outcome {
                Outcome::Hit(hit) => Some((hit.fraction, id)),
                _ => None,
            }
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, id)| id)
}
