//! The smooth contact point beside the hard proxy: where the force comes from.
//!
//! The hard proxy stands on the stairs of voxels; a force from there would turn with every
//! step. The smooth point lies on the surface of the blurred voxels (`blur.rs`), or on that
//! of the intensities that a threshold made them from, near the proxy and on its side; the
//! force pulls the device there. Where the blur tells nothing (a rod or a gap of one or two
//! voxels), the point goes over into the proxy.
//!
//! Contact: the force begins where the device comes under the smooth surface, whether or not
//! the hard proxy is held there yet, and grows from zero with the depth below it.
//!
//! No step: whatever happens to the proxy, the way from device to contact point changes in a
//! tick by no more than the hand's own move and a tenth of the smallest spacing. So a contact
//! that is lost at once, as over an edge, fades within some ticks.
//!
//! Frames: points in the world's grid; vectors in mm along its axes. Closed, like a tick.
//! Source: `docs/decisions/smooth-force.md` has the measurements.

mod ahead;
mod aim;
mod binomial_filter;
pub mod blur;
pub mod cache;
mod cell_fractions;
mod cell_shape;
mod descent;
pub mod field;
mod fraction_lanes;
mod half_spaces;
pub mod occupancy_fractions;
mod rows;
mod spline;
mod surface_rows;
mod window;

use crate::contact::{Contact, Proxy};
use cache::NearFields;
use descent::{Query, descend};
use field::Field;
use glam::DVec3;
use palpate_volume::grid::Grid;
use palpate_volume::walk::COORDINATE_LIMIT;
use serde::{Deserialize, Serialize};

/// Where the force comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Smoothing {
    /// The hard proxy: the stairs of voxels are felt.
    Off,
    /// The smooth surface of the voxels, whatever made them.
    Bits,
    /// The same at its place between the voxels: from the values where a threshold made them, of a
    /// mask from the way of its surface.
    #[default]
    Intensities,
}

impl Smoothing {
    /// All kinds of smoothing.
    pub const ALL: [Self; 3] = [Self::Off, Self::Bits, Self::Intensities];

    /// Its name in settings.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Bits => "bits",
            Self::Intensities => "intensities",
        }
    }

    /// The one of this name, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|smoothing| smoothing.name() == name)
    }
}

/// How the smooth contact point is found. A cell is two voxels long on cubes, and about as
/// long as the thickest side of a voxel where slices are thick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoother {
    /// Without it the contact point is the hard proxy: stairs can be felt.
    pub enabled: bool,
    /// Most steps.
    pub max_steps: u32,
    /// The longest step [cells].
    pub longest_step: f32,
    /// A step shorter than this is the last [cells].
    pub tolerance: f32,
    /// A ball's contact that is wrong by less is good [cells].
    pub turned: f32,
    /// Farthest from the proxy [cells].
    pub reach: f32,
    /// The proxy is held up so much farther behind where voxels are no cubes, as a point and as a
    /// ball: in parts of what their longest edge is longer than their shortest.
    pub reach_by_thickness: [f32; 2],
    /// The proxy's distance from the smooth surface [cells]: up to where that is believed, and
    /// from where on not at all.
    pub trusted: [f32; 2],
    /// How far apart the surfaces of both kernels may be [cells] for the wide one to count.
    pub agreed_depth: [f32; 2],
    /// Difference of their normals (chord length) at which the weight begins to fall, and at which
    /// it is zero.
    pub agreed_turn: [f32; 2],
    /// Curvature is measured between normals so far to each side [cells].
    pub baseline: f32,
    /// The pull of the wide kernel [cells]: up to where it may be that of stairs, and from where
    /// on it is that of a bent surface and is undone.
    pub curved: [f32; 2],
    /// It is undone up to this [cells].
    pub largest_correction: f32,
    /// Change of the way from device to contact point in a tick, beyond that of the hand
    /// [smallest spacings].
    pub largest_change: f64,
}

impl Smoother {
    /// The tuned values that ticks use.
    pub const DEFAULT: Self = Self {
        enabled: true,
        max_steps: 6,
        longest_step: 0.75,
        tolerance: 3e-3,
        turned: 0.05,
        // the proxy is up to three voxels behind (docs/decisions/sliding.md)
        reach: 1.5,
        reach_by_thickness: [0.4, 2.0],
        // on a plane the proxy is at most half a voxel's diagonal below the surface
        trusted: [0.75, 1.25],
        agreed_depth: [0.25, 0.45],
        agreed_turn: [0.2, 0.4],
        baseline: 1.5,
        curved: [0.05, 0.12],
        largest_correction: 0.5,
        largest_change: 0.1,
    };
}

impl Default for Smoother {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What changes from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SmoothState {
    last: Option<Last>,
}

/// The last tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Last {
    /// Grid.
    device: DVec3,
    /// Vector from the device to the contact point [mm].
    offset: DVec3,
    /// The stairs are felt in full: what they do is no longer limited.
    stairs: bool,
}

/// Where the force comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothContact {
    /// The contact point, in the world's grid; the device where there is no force.
    pub point_in_grid: DVec3,
    /// From the device to it [mm], along the axes of the grid: stiffness makes it the force.
    pub offset: DVec3,
    /// Direction of the force, of length 1; zero where there is none.
    pub normal: DVec3,
    /// Length of `offset` [mm].
    pub depth_mm: f64,
    /// Share of the smooth point in it; the rest is that of the proxy.
    pub weight: f64,
    /// Where the contact point would be, were its changes not limited.
    pub unlimited_in_grid: DVec3,
    /// Samples of fields taken.
    pub samples: u32,
}

impl Smoother {
    /// The contact point of this tick, from the fields near the proxy. A device that is not a
    /// point is no contact.
    pub fn contact_point<F: Field>(
        &self,
        fields: &NearFields<'_, F>,
        grid: &Grid,
        tick: &SmoothInput<'_>,
        state: &mut SmoothState,
    ) -> SmoothContact {
        let device = tick.device_in_grid;
        let spacing = grid.spacing();
        let hard = (tick.proxy.point() - device) * spacing;
        // written so that NaN is refused
        let reach = DVec3::splat(COORDINATE_LIMIT);
        if !device.abs().cmple(reach).all() {
            state.last = None;
            return SmoothContact::none(tick.proxy.point());
        }

        let (target, weight, samples) = self.target(fields, spacing, tick);
        let target = pushing(target, hard);
        let limited = self.limited(grid, device, target, state);
        let offset = pushing(limited, hard);
        state.last = Some(Last {
            device,
            offset,
            stairs: !self.enabled && offset == target,
        });
        let per_spacing = spacing.recip();
        SmoothContact {
            point_in_grid: device + offset * per_spacing,
            offset,
            normal: offset.normalize_or_zero(),
            depth_mm: offset.length(),
            weight,
            unlimited_in_grid: device + target * per_spacing,
            samples,
        }
    }

    /// The way from the device to where the contact point should be [mm]; the share of the
    /// smooth point in it; samples.
    fn target<F: Field>(
        &self,
        fields: &NearFields<'_, F>,
        spacing: DVec3,
        tick: &SmoothInput<'_>,
    ) -> (DVec3, f64, u32) {
        let [device, proxy] = [tick.device_in_grid, tick.proxy.point()].map(|p| p * spacing);
        let hard = if tick.contact.touching {
            proxy - device
        } else {
            DVec3::ZERO
        };
        if !self.enabled || fields.iter().next().is_none() {
            return (hard, 0.0, 0);
        }
        let held_by = tick.contact.stopped_by.map(|solid| solid.body);
        let query = Query {
            device: device - proxy,
            held_by: held_by.filter(|_| tick.contact.touching),
        };
        let found = descend(self, fields, &query);
        let smooth = (proxy - device) + found.point;
        let target = hard.lerp(smooth, found.weight);
        (target, found.weight, found.samples)
    }

    /// The way there as far as one tick may go.
    #[inline]
    fn limited(&self, grid: &Grid, device: DVec3, target: DVec3, state: &SmoothState) -> DVec3 {
        let Some(last) = state.last else {
            return target.clamp_length_max(self.largest_change * grid.smallest_spacing());
        };
        if last.stairs && !self.enabled {
            return target;
        }
        let moved = ((device - last.device) * grid.spacing()).length();
        let allowed = moved + self.largest_change * grid.smallest_spacing();
        let change = target - last.offset;
        if change.length() <= allowed {
            target
        } else {
            last.offset + change.clamp_length_max(allowed)
        }
    }
}

/// What a tick knows when it asks for the contact point.
#[derive(Clone, Copy, Debug)]
pub struct SmoothInput<'a> {
    /// The hard proxy, after its moves.
    pub proxy: &'a Proxy,
    /// The device, or the target that friction leads the proxy to; grid.
    pub device_in_grid: DVec3,
    /// What the proxy met.
    pub contact: &'a Contact,
}

impl SmoothContact {
    /// No force.
    fn none(point: DVec3) -> Self {
        Self {
            point_in_grid: point,
            offset: DVec3::ZERO,
            normal: DVec3::ZERO,
            depth_mm: 0.0,
            weight: 0.0,
            unlimited_in_grid: point,
            samples: 0,
        }
    }
}

/// A way without what of it leads away from the proxy: no force pulls into an obstacle.
fn pushing(offset: DVec3, hard: DVec3) -> DVec3 {
    let along = offset.dot(hard);
    if along >= 0.0 {
        return offset;
    }
    // by a trace more, so that rounding leaves no pull
    let rest = offset - hard * (along / hard.length_squared() * (1.0 + 1e-9));
    if rest.dot(hard) >= 0.0 {
        rest
    } else {
        DVec3::ZERO
    }
}

/// 0 up to the first limit, 1 from the second on, and without a kink between.
fn smooth_step([low, high]: [f32; 2], value: f32) -> f32 {
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
