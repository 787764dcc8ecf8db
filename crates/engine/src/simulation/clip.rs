//! What is cut away from touch. No voxel changes by it, and no undo takes it back.

use palpate_volume::clip::Clip;

use super::Simulation;
use crate::scene::TouchChange;

impl Simulation {
    /// What is cut away from touch.
    #[must_use]
    pub fn clip(&self) -> &Clip {
        self.scene.clip()
    }

    /// Cuts the scene for touch: what lies before a plane is no obstacle, gives way to nothing and is
    /// changed by no tool. A stroke that is on ends. Where material that comes back would bury the
    /// probe, it waits as any other change does.
    pub fn set_clip(&mut self, clip: Clip) {
        if clip == *self.scene.clip() {
            return;
        }
        self.end_stroke();
        let changed = self.scene.set_clip(clip);
        self.deformation
            .change_segments()
            .set_clip(self.scene.clip(), self.scene.voxels().grid());
        if !changed.is_empty() {
            let change = TouchChange::All(changed);
            self.touch.send_change(&self.scene, &change, Vec::new());
        }
        self.publish();
    }
}
