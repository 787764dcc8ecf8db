//! Tissue that has yielded stays as it was pressed: what the box leaves behind, and where nodes would
//! stay if all tools left.
//!
//! Under the tool voxels show where nodes stand. Toward the border of the box they show where nodes
//! will stay without the tool, which is relaxed for beside the rest: so a box that goes on leaves
//! behind what lasts, and nothing of what comes back. Voxels that show what lasts are no
//! more touched until a tool presses their tissue again, or somebody cuts it.

use glam::IVec3;

use super::lattice_model::{AT_REST, LatticeModel};
use super::moving_box::MovingBox;
use super::relax::RelaxSettings;
use crate::model::{ModelInput, ModelReport, ToolState};

/// So many iterations in parts of all are on top, where tissue yields, for how it is without tools.
const UNLOADING_SHARE: u32 = 4;

impl LatticeModel {
    /// Before a box goes to `origin`: what it leaves of tissue that has yielded stays as it will be
    /// without a tool, and does not come back.
    pub(super) fn leave(
        &mut self,
        matter: &MovingBox,
        origin: IVec3,
        input: &ModelInput<'_>,
        tools: &[&ToolState],
    ) {
        if self.settled || !matter.has_yielded() {
            return;
        }
        let field = matter.plastic_displacement();
        let [before, after] = [matter.origin, origin].map(|origin| matter.region_from(origin));
        let left = |voxel: IVec3| before.contains(voxel) && !after.contains(voxel);
        let mut wanted = self.rule(input, tools).left_behind(&field);
        wanted.retain(|key, _| left(IVec3::from_array(*key)));
        self.ledger.note_left(input.voxels, left, &wanted);
        self.left_behind.extend(wanted);
    }

    /// Follows where tissue that has yielded would stay if all tools left.
    pub(super) fn follow_plastic(
        &mut self,
        input: &ModelInput<'_>,
        is_late: &dyn Fn() -> bool,
        report: &ModelReport,
    ) {
        let is_unloaded = self.is_unloaded(report);
        let Some(matter) = self.matter.as_mut().filter(|matter| matter.has_yielded()) else {
            return;
        };
        if self.settled {
            return;
        }
        if is_unloaded {
            matter.note_unloaded();
        } else {
            let settings = RelaxSettings {
                tolerance: self.settings.tolerance,
                iterations: input.budget.iterations / UNLOADING_SHARE,
                reference: matter.small_force(),
            };
            matter.find_unloaded(&mut self.unloaded, &settings, is_late);
        }
    }

    /// Whether tissue that has yielded is at rest without a tool.
    pub(super) fn is_unloaded(&self, report: &ModelReport) -> bool {
        let is_free = self.relaxer.felt().iter().all(|felt| felt.nodes == 0);
        let at_rest = report.residual <= AT_REST * self.settings.tolerance;
        let matter = self.matter.as_ref();
        is_free && at_rest && !self.yields && matter.is_some_and(MovingBox::has_yielded)
    }
}
