//! Tissue as it is seen around a needle: a box of nodes of its own that the needle leads.
//!
//! It is for the eye alone: the needle's law gives the force, no voxel follows, nothing yields or
//! breaks, and no model that is pressed knows of it. So the field holds all of the displacement.

use std::cell::Cell;

use palpate_volume::voxels::Voxels;

use super::box_place::BoxPlace;
use super::damage::Damage;
use super::driven::Driven;
use super::inelastic::InelasticSettings;
use super::moving_box::{MovingBox, grid_mm};
use super::needle_drag::NeedleDrag;
use super::relax::{RelaxReport, RelaxSettings, Relaxer};
use super::resample::{RestVoxels, node_near};
use crate::material::Materials;
use crate::model::{Budget, DisplacementField};
use crate::voxel_ledger::Ledger;
use crate::work_time::WorkTime;

/// Nodes along each edge of the box.
const NODES: u32 = 21;
/// Between nodes [mm]: of the size of what a needle presses in, however fine the voxels are.
const SPACING: f64 = 2.0;
/// How far the tip may be from the middle of the box before the box follows [nodes].
const LEASH: i32 = 2;
/// Share of a displacement that is left after an answer where the needle lets go of it.
const LEFT: f64 = 0.5;
/// Displacement that is seen [mm].
const VISIBLE: f64 = 0.02;
/// Stiffness of the bed around all nodes over that of their bonds: what lies about a body holds it, where
/// no segment tells, and displacements fade before the box ends.
const BED: f64 = 0.1;
/// Unbalanced force at which nodes count as at rest, as a share of that which a bond gives where it is
/// as much longer as the needle leads: some hundred bonds give together.
const TOLERANCE: f64 = 0.3;
/// Share of the time after which nodes are as far at rest as they come.
const RELAXED: f64 = 0.8;

/// What tissue around a needle is told.
#[derive(Clone, Copy, Debug)]
pub struct NeedleInput<'a> {
    /// The true voxels.
    pub voxels: &'a Voxels,
    /// What they are made of.
    pub materials: &'a Materials,
    /// What the needle does; none where it does nothing any more.
    pub drag: Option<NeedleDrag>,
    /// Limit on the work of this call.
    pub budget: Budget,
}

/// The tissue around a needle. Its state is its own; the same calls give the same fields.
#[derive(Debug, Default)]
pub struct NeedleTissue {
    matter: Option<MovingBox>,
    relaxer: Relaxer,
    /// The edit of the voxels that it was built from.
    edit: u64,
    /// What is shown of the needle by now.
    now: Option<NeedleDrag>,
    /// How the last relaxation went.
    report: RelaxReport,
}

impl NeedleTissue {
    /// How far tissue stands from the voxels that show it; none where it stands there.
    pub fn advance(&mut self, input: &NeedleInput<'_>) -> Option<DisplacementField> {
        let time = WorkTime::begin(&input.budget);
        self.now = self.eased(input.drag.and_then(NeedleDrag::checked));
        let Some(drag) = self.now else {
            self.matter = None;
            return None;
        };
        let mut matter = self.followed(input, &drag);
        self.relax(&mut matter, &drag, input, &time);
        if !matter.is_finite() {
            return None;
        }
        let field = matter.displacement();
        let field = field.whole(&matter.grid, VISIBLE, drag.farthest());
        self.matter = Some(matter);
        field
    }

    /// How the last relaxation went.
    #[must_use]
    pub fn report(&self) -> RelaxReport {
        self.report
    }

    /// What is to be shown: what presses at once, and what lets go bit by bit.
    fn eased(&self, wanted: Option<NeedleDrag>) -> Option<NeedleDrag> {
        let Some(last) = self.now else {
            return wanted;
        };
        let Some(wanted) = wanted else {
            let less = NeedleDrag {
                pressed: last.pressed * LEFT,
                carried: last.carried * LEFT,
                ..last
            };
            return (less.farthest() > VISIBLE).then_some(less);
        };
        let goes_on = last.tip().distance(wanted.tip()) < SPACING;
        let left = (last.pressed - wanted.pressed).max(0.0) * LEFT;
        Some(NeedleDrag {
            pressed: wanted.pressed + if goes_on { left } else { 0.0 },
            ..wanted
        })
    }

    /// The box around the tip, of the voxels and materials as they are now.
    fn followed(&mut self, input: &NeedleInput<'_>, drag: &NeedleDrag) -> MovingBox {
        let grid = input.voxels.grid();
        let ledger = Ledger::default();
        let rest = RestVoxels {
            voxels: input.voxels,
            materials: input.materials,
            ledger: &ledger,
            asked: Cell::new(0),
        };
        let place = BoxPlace::cube(node_near(grid_mm(grid, drag.tip()), SPACING), NODES);
        let edit = std::mem::replace(&mut self.edit, input.voxels.edit_number());
        let known = self.matter.take().filter(|matter| matter.fits(&rest));
        let Some(mut matter) = known else {
            return MovingBox::new(&rest, &place, SPACING, InelasticSettings::default());
        };
        if edit != self.edit {
            matter.follow_edits(&rest);
        }
        if (place.origin - matter.origin).abs().max_element() > LEASH {
            matter.go(&rest, place.origin, &Damage::default(), false);
        }
        matter
    }

    fn relax(
        &mut self,
        matter: &mut MovingBox,
        drag: &NeedleDrag,
        input: &NeedleInput<'_>,
        time: &WorkTime,
    ) {
        let own = NeedleDrag {
            entry: grid_mm(&matter.grid, drag.entry) - matter.corner(),
            direction: matter.grid.direction().transpose() * drag.direction,
            ..*drag
        };
        let lattice = &mut matter.lattice;
        self.relaxer.driven = Driven {
            nodes: own.driven(lattice),
            bed: BED,
        };
        let settings = RelaxSettings {
            tolerance: TOLERANCE,
            iterations: input.budget.iterations,
            reference: lattice.softest_bond() * drag.farthest(),
        };
        let is_late = || time.is_over(RELAXED);
        self.report = self.relaxer.relax(lattice, &[], &settings, &is_late);
    }
}
