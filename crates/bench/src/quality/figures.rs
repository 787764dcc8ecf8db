//! What is felt along a stroke, held against what should be.
//!
//! Each stroke begins with an approach from outside, stands still at some places on its way
//! (jitter), and goes on. Only the way itself counts for direction, magnitude and lag, and of
//! it only what is farther than [`EDGE_REACH`] voxels from an edge.

use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;

use super::body::{Body, Foot};
use super::case::Case;
use super::felt::{FeltForce, ForceModel, STIFFNESS, Touch};
use super::solid::Solid;
use crate::timing::quantile;

/// Ticks after which a hand at rest must feel a force that stays to the bit.
pub const REST_TICKS: usize = 64;
/// Ticks of each rest, and rests in each stroke.
const REST: usize = REST_TICKS + 64;
const RESTS: usize = 8;
/// How far outside the approach begins [h].
const APPROACH: f64 = 5.0;
/// Within so many voxels of an edge nothing counts: 2 σ of a blur of 1.5 voxels.
const EDGE_REACH: f64 = 3.0;
/// Stuck: the force point moves less than this [h] ...
const STUCK_MOVE: f64 = 0.5;
/// ... over so much way of the hand [h], of whose foot point ...
const STUCK_WAY: f64 = 10.0;
/// ... at least so much is sideways [h].
const STUCK_FOOT: f64 = 5.0;

/// What was felt of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Angle between the force and the way to the true surface [degrees].
    pub direction_mean: f64,
    /// 95 of 100 angles [degrees].
    pub direction_95: f64,
    /// Root mean square of the magnitude's error, as a fraction of the true magnitude.
    pub magnitude_rmse: f64,
    /// Root mean square of the magnitude's error about its mean [h], in the worst stroke.
    pub ripple: f64,
    /// How far the force point is behind the foot point, sideways [h]: 95 of 100, and most.
    pub force_lag_95: f64,
    /// Most.
    pub force_lag_max: f64,
    /// The same of the hard proxy.
    pub proxy_lag_95: f64,
    /// Most.
    pub proxy_lag_max: f64,
    /// Largest change in a tick of force, force point or proxy at rest [h].
    pub jitter: f64,
    /// How often contact was lost inside the body, or the probe came behind the surface.
    pub pop_throughs: f64,
    /// Fraction of the updates with the proxy in a solid voxel.
    pub solid_fraction: f64,
    /// Updates spent stuck.
    pub stuck: f64,
    /// Largest change of force in a tick beyond that of the hand [h].
    pub force_step: f64,
    /// Fraction of the updates in contact.
    pub contact_fraction: f64,
    /// Updates.
    pub updates: f64,
}

impl Figures {
    /// All of them, by name.
    #[must_use]
    pub fn named(&self) -> [(&'static str, f64); 15] {
        [
            ("direction_mean", self.direction_mean),
            ("direction_95", self.direction_95),
            ("magnitude_rmse", self.magnitude_rmse),
            ("ripple", self.ripple),
            ("force_lag_95", self.force_lag_95),
            ("force_lag_max", self.force_lag_max),
            ("proxy_lag_95", self.proxy_lag_95),
            ("proxy_lag_max", self.proxy_lag_max),
            ("jitter", self.jitter),
            ("pop_throughs", self.pop_throughs),
            ("solid_share", self.solid_fraction),
            ("stuck", self.stuck),
            ("force_step", self.force_step),
            ("contact_share", self.contact_fraction),
            ("updates", self.updates),
        ]
    }
}

/// Touches a case in a way of touch.
#[must_use]
pub fn measure(case: &Case, touch: Touch) -> Figures {
    measure_hand(case, touch, |solid, grid, start| {
        touch.start(solid, grid, start)
    })
}

/// Touches a case in which bodies are made for a way of touch; `start` makes a hand for one, from
/// a free point of the scene on.
pub fn measure_hand(
    case: &Case,
    touch: Touch,
    start: impl for<'a> Fn(&'a Solid, &'a Grid, DVec3) -> ForceModel<'a>,
) -> Figures {
    let mut tally = Tally::default();
    for (body, device) in &case.strokes {
        let solid = touch.solid(body, &case.grid);
        let h = case.grid.smallest_spacing();
        let radius = case.radius * h;
        let first = body.foot_of_ball(device[0], radius);
        let outward = (first.point - device[0]).normalize();
        let outside = first.point + outward * APPROACH * h;
        let mut stroke = Stroke {
            body,
            solid: &solid,
            radius,
            grid: &case.grid,
            h,
            feel: start(&solid, &case.grid, outside),
            last: None,
            popped: false,
            way: Vec::with_capacity(device.len()),
            tally: &mut tally,
        };
        stroke.approach(outside, device[0], case.step * h);
        stroke.follow(device);
        stroke.finish(case.step);
    }
    tally.figures()
}

/// One update on the way.
#[derive(Clone, Copy, Debug)]
struct Sample {
    device: DVec3,
    foot: Foot,
    felt: FeltForce,
}

/// All that was counted.
#[derive(Default)]
struct Tally {
    directions: Vec<f64>,
    magnitudes: Vec<f64>,
    force_lags: Vec<f64>,
    proxy_lags: Vec<f64>,
    contacts: usize,
    solids: usize,
    stuck: usize,
    way: usize,
    updates: usize,
    worst: Figures,
}

struct Stroke<'a> {
    body: &'a Body,
    solid: &'a Solid,
    /// Of the probe [mm].
    radius: f64,
    grid: &'a Grid,
    h: f64,
    feel: ForceModel<'a>,
    last: Option<(DVec3, FeltForce)>,
    popped: bool,
    way: Vec<Sample>,
    tally: &'a mut Tally,
}

impl Stroke<'_> {
    /// Straight in, at the speed of the stroke.
    fn approach(&mut self, from: DVec3, to: DVec3, step: f64) {
        let count = (from.distance(to) / step).ceil();
        for number in 0..count as usize {
            self.update(from.lerp(to, number as f64 / count));
        }
    }

    fn follow(&mut self, device: &[DVec3]) {
        let between_rests = device.len().div_ceil(RESTS);
        for (number, &device) in device.iter().enumerate() {
            let sample = self.update(device);
            self.way.push(sample);
            if (number + 1) % between_rests == 0 {
                self.rest(device);
            }
        }
    }

    fn rest(&mut self, device: DVec3) {
        for tick in 0..REST {
            let before = self.last;
            let now = self.update(device).felt;
            let Some((_, before)) = before.filter(|_| tick >= REST_TICKS) else {
                continue;
            };
            let moved = ((now.force - before.force) / STIFFNESS)
                .length()
                .max(now.force_point.distance(before.force_point))
                .max(now.proxy.distance(before.proxy));
            let worst = &mut self.tally.worst;
            worst.jitter = worst.jitter.max(moved / self.h);
        }
    }

    /// One update, with what is asked of each.
    fn update(&mut self, device: DVec3) -> Sample {
        let felt = (self.feel)(device);
        let foot = self.body.foot_of_ball(device, self.radius);
        self.tally.updates += 1;

        // where the proxy is
        let proxy = self.grid.grid_from_patient().transform_point3(felt.proxy);
        let voxel = proxy.floor().as_ivec3();
        let is_solid = self.overlaps(proxy);
        self.tally.solids += usize::from(is_solid);

        // behind the surface, or nothing felt though the device is deeper than voxels are
        let behind = !is_solid && self.solid.filled.is_solid(voxel);
        let lost = !felt.contact && foot.distance < -0.5 * self.grid.spacing().length();
        let popped = behind || lost;
        if popped && !self.popped {
            self.tally.worst.pop_throughs += 1.0;
        }
        self.popped = popped;

        // how the force follows the hand
        if let Some((last_device, last)) = self.last {
            let change = (felt.force - last.force).length() / STIFFNESS;
            // 1e-9 is rounding
            let beyond = (change - device.distance(last_device)) / self.h - 1e-9;
            self.tally.worst.force_step = self.tally.worst.force_step.max(beyond);
        }
        self.last = Some((device, felt));
        Sample { device, foot, felt }
    }

    /// Whether the probe overlaps a solid voxel with its middle at a point of the grid.
    fn overlaps(&self, point: DVec3) -> bool {
        let spacing = self.grid.spacing();
        let reach = self.radius / spacing;
        let [low, high] = [point - reach, point + reach].map(|corner| corner.floor().as_ivec3());
        // touching is allowed: 1e-9 is rounding
        let limit = self.radius * self.radius * (1.0 - 1e-9);
        let voxels = VoxelBox::new(low, high + 1);
        let is_near = |voxel: IVec3| {
            let corner = voxel.as_dvec3();
            let gap = (corner - point)
                .max(point - (corner + 1.0))
                .max(DVec3::ZERO);
            self.radius == 0.0 || (gap * spacing).length_squared() < limit
        };
        voxels
            .voxels()
            .any(|voxel| self.solid.bits.is_solid(voxel) && is_near(voxel))
    }

    /// Counts the way.
    fn finish(self, step: f64) {
        let Self {
            h,
            radius,
            grid,
            way,
            tally,
            ..
        } = self;
        let mut depths = Vec::with_capacity(way.len());
        for sample in &way {
            let Sample { foot, felt, .. } = sample;
            tally.way += 1;
            tally.contacts += usize::from(felt.contact);
            // a ball meets an edge from as far as it is wide
            let is_near = |way: DVec3| {
                (way / grid.spacing()).length() <= EDGE_REACH + radius / grid.smallest_spacing()
            };
            if foot.distance >= 0.0 || foot.to_edge.is_some_and(is_near) {
                continue;
            }
            let depth = -foot.distance;
            let error = felt.force.length() / STIFFNESS - depth;
            depths.push(error / h);
            tally.magnitudes.push(error / depth);
            tally.count_direction(sample, h);
        }
        tally.worst.ripple = tally.worst.ripple.max(deviation(&depths));
        tally.stuck += stuck_updates(&way, (STUCK_WAY / step).ceil() as usize, h);
    }
}

impl Tally {
    /// Angle and lags of one update; both need the way to the foot point.
    fn count_direction(&mut self, sample: &Sample, h: f64) {
        let Sample { device, foot, felt } = sample;
        let Some(outward) = (foot.point - device).try_normalize() else {
            return;
        };
        if !felt.contact {
            return;
        }
        if felt.force != DVec3::ZERO {
            let angle = felt.force.angle_between(outward);
            self.directions.push(angle.to_degrees());
        }
        let lag = |point: DVec3| {
            (point - foot.point)
                .reject_from_normalized(outward)
                .length()
                / h
        };
        self.force_lags.push(lag(felt.force_point));
        self.proxy_lags.push(lag(felt.proxy));
    }

    fn figures(mut self) -> Figures {
        for list in [
            &mut self.directions,
            &mut self.force_lags,
            &mut self.proxy_lags,
        ] {
            list.sort_by(f64::total_cmp);
        }
        let share = |part: usize, of: usize| part as f64 / of.max(1) as f64;
        Figures {
            direction_mean: mean(&self.directions),
            direction_95: quantile(&self.directions, 0.95),
            magnitude_rmse: mean_square(&self.magnitudes).sqrt(),
            force_lag_95: quantile(&self.force_lags, 0.95),
            force_lag_max: quantile(&self.force_lags, 1.0),
            proxy_lag_95: quantile(&self.proxy_lags, 0.95),
            proxy_lag_max: quantile(&self.proxy_lags, 1.0),
            solid_fraction: share(self.solids, self.updates),
            stuck: self.stuck as f64,
            contact_fraction: share(self.contacts, self.way),
            updates: self.updates as f64,
            ..self.worst
        }
    }
}

/// Updates at which the force point is still where it was some way of the hand ago.
fn stuck_updates(way: &[Sample], window: usize, h: f64) -> usize {
    way.windows(window + 1)
        .filter(|window| {
            let [first, last] = [window[0], window[window.len() - 1]];
            let foot = first.foot.point.distance(last.foot.point);
            let point = first.felt.force_point.distance(last.felt.force_point);
            let held = first.felt.contact && last.felt.contact;
            held && point < STUCK_MOVE * h && foot > STUCK_FOOT * h
        })
        .count()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}

/// Root mean square of the difference from the mean.
fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    (mean_square(values) - mean * mean).max(0.0).sqrt()
}
