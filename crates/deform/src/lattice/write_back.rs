//! Voxels that follow the nodes: a voxel becomes what its middle was at rest, solid or not, with
//! that intensity.
//!
//! A voxel goes on showing what it shows until its middle is farther than a voxel's half and a
//! margin from there, so that nothing flickers. What the tool's body is in shows no matter.
//! Source: thesis 5.25, whose threshold is not given; errata, section 4 (hysteresis).

use glam::{DVec3, IVec3};
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;

use crate::displacement::Displacement;
use crate::material::Treatment;
use crate::model::{ModelInput, ToolState};
use crate::voxel_ledger::{Ledger, Wanted, solid_of};

/// How far beyond a voxel its tissue may come from, and still be shown [voxels].
const MARGIN: f64 = 0.15;
/// Displacement below which no voxel changes [voxels].
const SMALL: f64 = 0.25;

/// Voxels and what is known of them.
pub(super) struct WriteBack<'a> {
    pub input: &'a ModelInput<'a>,
    pub ledger: &'a Ledger,
    /// Bodies that tissue makes room for.
    pub tools: &'a [&'a ToolState],
    /// Stored value where tissue left.
    pub air: i16,
}

impl WriteBack<'_> {
    /// What the voxels around the nodes are to be, and those changed elsewhere; and how many were
    /// looked at.
    pub fn wanted(&self, field: Option<&Displacement>) -> (Wanted, u64) {
        let voxels = self.input.voxels;
        let mut region = VoxelBox::EMPTY;
        let mut wanted = Wanted::new();
        let mut looked_at = VoxelBox::EMPTY;
        if let Some(field) = field {
            region = field.region(voxels.grid());
            looked_at = self.moving(field).intersect(&region);
            wanted = self.followed(field, looked_at);
        }
        self.ledger.give_back_outside(voxels, &region, &mut wanted);
        (wanted, looked_at.voxel_count())
    }

    /// What the voxels are to be that a box with this field of lasting displacements is about to
    /// leave, and those around which it stays.
    pub fn left_behind(&self, field: &Displacement) -> Wanted {
        let region = field.region(self.input.voxels.grid());
        self.followed(field, self.moving(field).intersect(&region))
    }

    fn followed(&self, field: &Displacement, region: VoxelBox) -> Wanted {
        let follow = |voxel: IVec3| Some((voxel.to_array(), self.follow(field, voxel)?));
        region.voxels().filter_map(follow).collect()
    }

    /// A box around all voxels that may become others: where nodes have moved enough, where tools
    /// are, and what was changed.
    fn moving(&self, field: &Displacement) -> VoxelBox {
        let grid = self.input.voxels.grid();
        let spacing = grid.spacing();
        let around =
            |low: DVec3, high: DVec3| VoxelBox::new(low.floor().as_ivec3(), high.ceil().as_ivec3());
        let mut all = self.ledger.bounds();
        if let Some([low, high]) = field.moving(SMALL * spacing) {
            all = all.union(&around(low / spacing, high / spacing));
        }
        for tool in self.tools {
            let centre = grid.grid_from_patient().transform_point3(tool.position);
            let reach = tool.shape.half_axes().max_element() / spacing;
            all = all.union(&around(centre - reach, centre + reach));
        }
        all
    }

    /// What a voxel is to be; none where it stays as it is.
    fn follow(&self, field: &Displacement, voxel: IVec3) -> Option<(VoxelState, Option<DVec3>)> {
        let spacing = self.input.voxels.grid().spacing();
        let place = (voxel.as_dvec3() + 0.5) * spacing;
        let changed = self.ledger.changed(voxel);
        let in_tool = self.is_in_tool(voxel);
        let moved = field.at(place) / spacing;
        if changed.is_none() && !in_tool && moved.abs().max_element() < SMALL {
            return None;
        }
        let rest = self.ledger.rest(self.input.voxels, voxel)?;
        let gives = self.gives(voxel, &rest);
        // tissue that takes no part, or stays where it is, is never overwritten
        if !gives && !rest.segments.is_empty() {
            return Some((rest, Some(DVec3::ZERO)));
        }
        let follows = self.moved_matter(field.rest_of(place)? / spacing, voxel, &rest, gives)?;
        // what is clear stays as it is until tissue comes
        let is_clear = changed.is_some_and(|c| c.shown.is_none() && c.written.segments.is_empty());
        (follows.1.is_some() || !is_clear).then_some(follows)
    }

    /// What a voxel is whose middle was at `came_from` [voxels] at rest.
    fn moved_matter(
        &self,
        came_from: DVec3,
        voxel: IVec3,
        rest: &VoxelState,
        gives: bool,
    ) -> Option<(VoxelState, Option<DVec3>)> {
        let rest = *rest;
        let in_tool = self.is_in_tool(voxel);
        let from = self.source_of(came_from, voxel)?;
        let source = self.ledger.rest(self.input.voxels, from)?;
        let is_empty = source.segments.is_empty();
        if in_tool {
            return Some(match (gives, is_empty) {
                (true, true) => (source, None),
                (true, false) => (self.nothing(), None),
                (false, _) => (rest, None),
            });
        }
        if self.gives(from, &source) {
            return Some((source, Some((voxel - from).as_dvec3())));
        }
        // what comes does not give: only the empty space beside tissue follows it
        Some(match gives && is_empty {
            true => (source, None),
            false => (rest, Some(DVec3::ZERO)),
        })
    }

    /// The voxel from which the tissue has come that stands in this one and was at `rest`
    /// [voxels]: that which is shown, as long as it is not clearly another. None where a voxel
    /// that was cleared is to stay so.
    fn source_of(&self, rest: DVec3, voxel: IVec3) -> Option<IVec3> {
        let away = |from: IVec3| (rest - (from.as_dvec3() + 0.5)).abs().max_element();
        let nearest = rest.floor().as_ivec3();
        let Some(changed) = self.ledger.changed(voxel) else {
            return Some(if away(voxel) <= 0.5 + MARGIN {
                voxel
            } else {
                nearest
            });
        };
        match changed.shown {
            Some(come) => {
                let shown = voxel - come.round().as_ivec3();
                Some(if away(shown) <= 0.5 + MARGIN {
                    shown
                } else {
                    nearest
                })
            }
            None => (nearest != voxel || away(voxel) <= 0.5 - MARGIN).then_some(nearest),
        }
    }

    /// Whether tissue at rest in a voxel gives way.
    fn gives(&self, voxel: IVec3, matter: &VoxelState) -> bool {
        let solid = solid_of(self.input.voxels, self.input.materials, voxel, matter);
        solid.is_some_and(|(_, treatment)| treatment == Treatment::Deformable)
    }

    /// Whether the middle of a voxel is in the body of a tool, by more than the margin.
    fn is_in_tool(&self, voxel: IVec3) -> bool {
        let grid = self.input.voxels.grid();
        self.tools.iter().any(|tool| {
            let centre = grid.grid_from_patient().transform_point3(tool.position);
            let apart = (voxel.as_dvec3() + 0.5 - centre) * grid.spacing();
            let body = tool.shape.half_axes() - MARGIN * grid.smallest_spacing();
            let own = tool.orientation.inverse() * (grid.direction() * apart);
            body.cmpgt(DVec3::ZERO).all() && (own / body).length_squared() < 1.0
        })
    }

    fn nothing(&self) -> VoxelState {
        VoxelState {
            stored: self.air,
            segments: SegmentSet::EMPTY,
        }
    }
}
