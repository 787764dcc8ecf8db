//! What a ray of the scene meets first of what can be touched: by the true voxels as far as they are
//! not cut away, of segments that were moved where they stand by now. Soft tissue counts as it is at
//! rest.
//!
//! Frame: scene [mm].

use glam::DVec3;
use palpate_volume::first_solid::first_solid;
use palpate_volume::voxel_box::VoxelBox;

use super::Simulation;
use crate::simulation::led_hand::Rays;

impl Rays for Simulation {
    fn first(&self, from: DVec3, to: DVec3) -> Option<DVec3> {
        let scan = self.voxels().grid();
        let hits = self.scene.obstacles().filter_map(|(id, segment, _)| {
            let pose = self.current_pose(id).unwrap_or_default();
            let grid_from_scene = segment.grid(scan).grid_from_patient() * pose.inverse();
            let [start, end] = [from, to].map(|point| grid_from_scene.transform_point3(point));
            let (enters, leaves) = span_in(segment.bounding_box()?, start, end)?;
            let [near, far] = [enters, leaves].map(|share| start.lerp(end, share));
            let hit = first_solid(self.scene.touched(id, segment), near, far)?;
            Some(enters + (leaves - enters) * hit.fraction)
        });
        let nearest = hits.fold(f64::INFINITY, f64::min);
        nearest.is_finite().then(|| from.lerp(to, nearest))
    }
}

/// From which share of a way to which it is in a box; none where it is beside it.
fn span_in(bounds: VoxelBox, start: DVec3, end: DVec3) -> Option<(f64, f64)> {
    let way = end - start;
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        // a voxel of room: rounding must not cut the first one off
        let low = f64::from(bounds.min[axis]) - 1.0 - start[axis];
        let high = f64::from(bounds.max[axis]) + 1.0 - start[axis];
        if way[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let [first, last] = [low / way[axis], high / way[axis]];
        enters = enters.max(first.min(last));
        leaves = leaves.min(first.max(last));
    }
    (enters <= leaves).then_some((enters, leaves))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::IVec3;

    #[test]
    fn a_way_is_in_a_box_from_face_to_face() {
        let bounds = VoxelBox::new(IVec3::splat(1), IVec3::splat(9));
        let (start, end) = (DVec3::new(-10.0, 5.0, 5.0), DVec3::new(10.0, 5.0, 5.0));
        assert_eq!(span_in(bounds, start, end), Some((0.5, 1.0)));
        assert_eq!(
            span_in(bounds, start + 20.0 * DVec3::Y, end + 20.0 * DVec3::Y),
            None
        );
        assert_eq!(span_in(bounds, start, start + DVec3::X), None);
    }
}
