//! The drill: a burr that takes tissue away by the work that it does.
//!
//! Power on tissue is P = μ F v, with the force F that presses the burr, the speed v of its
//! surface and the ratio μ of the cutting force along the surface to F. Volume goes at P / u,
//! u the work per volume of the tissue (`specific_energy.rs`). That is Preston's law, removal
//! in proportion to pressure and speed ("The theory and design of plate glass polishing
//! machines", J. Soc. Glass Technol. 11 (1927)), with the constant μ / u. So half the force
//! takes twice the time for the same hole. Work that does not suffice for the next voxel is
//! carried on to the next pass.
//!
//! **Which voxels.** The burr touches tissue where the probe's body does: both have the same
//! outermost point against the contact's normal. From there it reaches one voxel's diagonal
//! further, since touch holds the body off by up to that. What is nearest to the burr's way
//! goes first, from box to point, so that the hole is as round as the burr.
//!
//! **What is cut** are voxels of the chosen segments; all segments lose them but those that
//! stand elsewhere in the scene, and the scan reads air there. Voxels of none of them stay: the probe passes them without force.
//!
//! A voxel edit. Frame: patient (LPS mm); work in N·mm.

use glam::{DVec3, IVec3};
use palpate_volume::clip::ClipMask;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::specific_energy::SpecificEnergy;
use crate::sweep::{Sweep, centre_of, nearest_on_way};
use crate::tool::{MAX_PASS, Tool, ToolError, ToolInput, ToolReport};

/// Radius of a burr, at most [smallest voxel sides]: that of the largest ball for touch.
pub const MAX_BURR_IN_VOXELS: f64 = 16.0;
/// Voxels that one pass takes away at most.
pub const MAX_VOXELS_PER_PASS: usize = 4096;
/// Force that counts, at most [N].
pub const MAX_FORCE: f64 = 100.0;
/// Way of the burr in one pass that counts, at most [its radii]: the end of it.
const MAX_WAY_IN_RADII: f64 = 4.0;

/// Settings of a drill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrillSettings {
    /// Speed of the burr's surface [mm/s].
    pub surface_speed: f64,
    /// Cutting force along the surface by the force that presses.
    pub cutting_ratio: f64,
    /// Work per volume.
    pub specific_energy: SpecificEnergy,
    /// What the scan reads where tissue went, in its own unit.
    pub air: f64,
}

impl Default for DrillSettings {
    /// For CT: a burr of 4 mm at 19 000 turns/min, and a cutting ratio chosen so that
    /// pressing with 5 N takes some 5 mm³ of bone a second.
    fn default() -> Self {
        Self {
            surface_speed: 4000.0,
            cutting_ratio: 0.3,
            specific_energy: SpecificEnergy::OfBone,
            air: -1000.0,
        }
    }
}

impl DrillSettings {
    /// Refuses numbers that describe no drill.
    pub(crate) fn check(&self) -> Result<(), ToolError> {
        let above_zero = |what, given: f64, limit: f64, allowed| {
            let fits = given > 0.0 && given <= limit;
            fits.then_some(()).ok_or(ToolError::Drill {
                what,
                given,
                allowed,
            })
        };
        above_zero(
            "surface speed [mm/s]",
            self.surface_speed,
            1e5,
            "above 0 to 100000",
        )?;
        above_zero("cutting ratio", self.cutting_ratio, 10.0, "above 0 to 10")?;
        if let SpecificEnergy::Everywhere(energy) = self.specific_energy {
            above_zero(
                "energy per volume [N/mm²]",
                energy,
                1e6,
                "above 0 to 1000000",
            )?;
        }
        let is_value = self.air.is_finite();
        is_value.then_some(()).ok_or(ToolError::Drill {
            what: "air",
            given: self.air,
            allowed: "finite",
        })
    }
}

/// A voxel that the burr reaches, and what it takes to remove it.
#[derive(Clone, Copy, Debug)]
struct Reached {
    voxel: IVec3,
    /// Distance from the burr's path to the voxel's box [mm].
    distance: f64,
    /// [N·mm].
    cost: f64,
}

/// The way of the burr's centre in one pass: from and to [mm].
type BurrWay = [DVec3; 2];

/// A burr and the work that it has not used up.
#[derive(Clone, Debug)]
pub struct Drill {
    radius: f64,
    segments: Vec<SegmentId>,
    settings: DrillSettings,
    spared: SegmentSet,
    locked: SegmentSet,
    cut_away: ClipMask,
    carried: f64,
    report: ToolReport,
}

impl Drill {
    pub(crate) fn new(
        radius: f64,
        segments: Vec<SegmentId>,
        settings: DrillSettings,
        [spared, locked]: [SegmentSet; 2],
        cut_away: ClipMask,
    ) -> Self {
        Self {
            radius,
            segments,
            settings,
            spared,
            locked,
            cut_away,
            carried: 0.0,
            report: ToolReport::default(),
        }
    }

    /// Work of a pass [N·mm] and where the burr went; none without contact, force or time.
    fn work(&self, input: &ToolInput) -> Option<(f64, BurrWay)> {
        let (from, to) = input.way()?;
        let normal = input.contact_normal.try_normalize()?;
        // written so that NaN does no work
        if !(input.force > 0.0 && input.dt > 0.0) {
            return None;
        }
        let power =
            self.settings.cutting_ratio * input.force.min(MAX_FORCE) * self.settings.surface_speed;

        let body = input.body_radius.unwrap_or_default().max(0.0);
        let tip_to_tip = normal * (self.radius - body);
        let back = (from - to).clamp_length_max(MAX_WAY_IN_RADII * self.radius);
        let centre = to + tip_to_tip;
        let work = power * input.dt.min(MAX_PASS);
        Some((work, [centre + back, centre]))
    }

    /// Voxels of the cut segments that the burr reaches, that no locked one has and that are not cut
    /// away, the nearest first.
    fn reached(&self, voxels: &Voxels, segments: &[&Segment], way: &BurrWay) -> Vec<Reached> {
        let grid = voxels.grid();
        let reach = self.radius + grid.spacing().length();
        let [from, to] = *way;
        // a voxel's box is at most half a diagonal nearer than its centre
        let around = reach + grid.spacing().length() / 2.0;
        let sweep = Sweep::new(grid, from, to, around);
        let is_locked = |(id, segment): &(SegmentId, &Segment)| {
            self.locked.contains(*id) && segment.own_grid().is_none()
        };
        let locked: Vec<_> = voxels.segments().filter(is_locked).collect();
        let can_cut = |voxel| {
            segments.iter().any(|segment| segment.contains(voxel))
                && !locked.iter().any(|(_, segment)| segment.contains(voxel))
                && !self.cut_away.cuts(voxel)
        };
        let mut found = Vec::new();
        for voxel in sweep.boxes().iter().flat_map(|region| region.voxels()) {
            let distance = distance_to_box(grid, from, to, voxel);
            if distance <= reach && can_cut(voxel) {
                let value = voxels.value(voxel).unwrap_or_default();
                let per_volume = self.settings.specific_energy.at(value);
                let cost = per_volume * grid.voxel_volume();
                found.push(Reached {
                    voxel,
                    distance,
                    cost,
                });
            }
        }
        nearest_first(found)
    }

    /// Spends the work of a pass; gives the voxels that it suffices for, the first ones.
    fn spend<'a>(&mut self, work: f64, reached: &'a [Reached]) -> &'a [Reached] {
        let mut budget = self.carried + work;
        let mut count = 0;
        for voxel in reached.iter().take(MAX_VOXELS_PER_PASS) {
            if voxel.cost > budget {
                break;
            }
            budget -= voxel.cost;
            count += 1;
        }
        let (removed, left) = reached.split_at(count);
        let next = left.first().map_or(0.0, |voxel| voxel.cost);
        // a burr that finds no more tissue in its reach runs free: the rest is no work
        let carried = budget.min(self.carried.max(next));
        let spent: f64 = removed.iter().map(|voxel| voxel.cost).sum();
        let done = spent + carried - self.carried;
        self.carried = carried;
        self.report.energy += done;
        self.report.load = done;
        removed
    }

    /// Takes voxels out of all segments that are not spared, and leaves air.
    fn removal(&self, voxels: &Voxels, removed: &[Reached]) -> Edit {
        let scan = voxels.intensities();
        // out of range, the nearest stored value: `as` saturates
        let stored = ((self.settings.air - scan.intercept()) / scan.slope()).round() as i16;
        let mut places: Vec<_> = removed.iter().map(|reached| key(reached.voxel)).collect();
        places.sort_unstable();
        let region = removed.iter().fold(VoxelBox::EMPTY, |region, reached| {
            region.union(&VoxelBox::of_voxel(reached.voxel))
        });
        voxels.voxel_edit(&region, |voxel, was| {
            if places.binary_search(&key(voxel)).is_err() {
                return was;
            }
            VoxelState {
                stored,
                segments: was.segments.intersect(&self.spared),
            }
        })
    }
}

impl Tool for Drill {
    fn advance(&mut self, voxels: &Voxels, input: &ToolInput) -> Result<Option<Edit>, VoxelsError> {
        self.report.load = 0.0;
        let find = |id: &SegmentId| voxels.segment(*id).ok_or(VoxelsError::UnknownSegment(id.0));
        let segments = self
            .segments
            .iter()
            .map(find)
            .collect::<Result<Vec<_>, _>>()?
            .into_iter()
            // the scan's tissue is none of what has a grid of its own
            .filter(|segment| segment.own_grid().is_none())
            .collect::<Vec<_>>();
        let Some((work, way)) = self.work(input) else {
            return Ok(None);
        };
        let reached = self.reached(voxels, &segments, &way);
        if reached.is_empty() {
            return Ok(None);
        }

        let removed = self.spend(work, &reached);
        let dt = input.dt.min(MAX_PASS);
        self.report.load /= dt;
        self.report.time += dt;
        self.report.voxels += removed.len() as u64;
        self.report.volume += removed.len() as f64 * voxels.grid().voxel_volume();
        if removed.is_empty() {
            return Ok(None);
        }
        Ok(Some(self.removal(voxels, removed)))
    }

    fn report(&self) -> ToolReport {
        self.report
    }
}

/// From a way to the box of a voxel [mm]: from the point of the way that is nearest to the
/// voxel's centre, so exact where the way is short beside the burr.
fn distance_to_box(grid: &Grid, from: DVec3, to: DVec3, voxel: IVec3) -> f64 {
    let centre = centre_of(&grid.patient_from_grid(), voxel);
    let nearest = grid
        .grid_from_patient()
        .transform_point3(nearest_on_way(from, to, centre));
    let outside = (nearest - voxel.as_dvec3() - 0.5).abs() - 0.5;
    (outside.max(DVec3::ZERO) * grid.spacing()).length()
}

/// Each voxel once, with its least distance; of equally near ones, in a fixed order.
fn nearest_first(mut reached: Vec<Reached>) -> Vec<Reached> {
    reached.sort_unstable_by(|a, b| {
        let by_distance = a.distance.total_cmp(&b.distance);
        key(a.voxel).cmp(&key(b.voxel)).then(by_distance)
    });
    reached.dedup_by_key(|reached| key(reached.voxel));
    reached.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    reached
}

fn key(voxel: IVec3) -> [i32; 3] {
    [voxel.z, voxel.y, voxel.x]
}
