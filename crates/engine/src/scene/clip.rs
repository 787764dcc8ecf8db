//! What a clip leaves of obstacles for touch. The true voxels know nothing of it.
//!
//! It is worked out where voxels change and no earlier: anew where a segment, its place or the clip
//! changes, in single bricks where an edit does. A moved segment is cut where it is to stand.

use palpate_volume::bits::Bits;
use palpate_volume::clip::{Clip, ClipMask};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;

use super::{Scene, TouchChange};

impl Scene {
    /// What is cut away from touch.
    #[must_use]
    pub fn clip(&self) -> &Clip {
        &self.clip
    }

    /// What is cut away of a segment's grid, where the segment is to stand.
    fn cut_away(&self, id: SegmentId) -> ClipMask {
        let pose = self.properties_of(id).pose.unwrap_or_default();
        self.clip.mask(self.voxels.grid_of(id), pose)
    }

    /// Cuts obstacles by another clip; gives those of which it leaves something else.
    pub fn set_clip(&mut self, clip: Clip) -> Vec<SegmentId> {
        self.clip = clip;
        let mut obstacles: Vec<_> = self.obstacles().map(|(id, _, _)| id).collect();
        obstacles.retain(|id| self.cut_again(*id));
        obstacles
    }

    /// The voxels of an obstacle that touch meets.
    #[must_use]
    pub fn touched<'a>(&'a self, id: SegmentId, segment: &'a Segment) -> &'a Bits {
        self.left.get(&id).unwrap_or(segment.occupancy())
    }

    /// Has what is left of obstacles follow a change of the scene; gives the one of which a move
    /// leaves something else.
    pub fn follow_clip(&mut self, change: &TouchChange) -> Option<SegmentId> {
        match change {
            TouchChange::Nothing => None,
            TouchChange::Bricks(bricks, ids) => {
                ids.iter().for_each(|id| self.cut_bricks(*id, bricks));
                None
            }
            TouchChange::All(ids) => {
                ids.iter().for_each(|id| self.cut_anew(*id));
                None
            }
            TouchChange::Pose(id, _) => self.cut_again(*id).then_some(*id),
            TouchChange::FirstPose(id, _) => {
                self.cut_anew(*id);
                None
            }
        }
    }

    /// Cuts an obstacle whose voxels are the same; whether something else is left of it.
    fn cut_again(&mut self, id: SegmentId) -> bool {
        let before = self.left.remove(&id);
        self.cut_anew(id);
        let Some(segment) = self.voxels.segment(id) else {
            return false;
        };
        let before = before.as_ref().unwrap_or(segment.occupancy());
        !before.difference(self.touched(id, segment)).is_empty()
    }

    fn cut_anew(&mut self, id: SegmentId) {
        self.left.remove(&id);
        let segment = self.voxels.segment(id).filter(|_| self.is_obstacle(id));
        let Some(segment) = segment.filter(|_| !self.clip.is_empty()) else {
            return;
        };
        let left = self.cut_away(id).left_of_bits(segment.occupancy());
        if !left.difference(segment.occupancy()).is_empty() {
            self.left.insert(id, left);
        }
    }

    fn cut_bricks(&mut self, id: SegmentId, bricks: &[u32]) {
        let mask = self.cut_away(id);
        let Some(segment) = self.voxels.segment(id).filter(|_| !self.clip.is_empty()) else {
            return;
        };
        let whole = segment.occupancy();
        // a segment that was not cut may have grown
        let left = self.left.entry(id).or_insert_with(|| whole.clone());
        mask.follow(left, whole, bricks);
    }
}
