//! A stroke: the way of a device that presses on a surface and slides over it.
//!
//! Every update moves the device by the same length; the direction turns slowly at random along
//! the surface and keeps the depth. Nothing is repeated. Frame: scene [mm].

use glam::DVec3;
use palpate_haptics::contact::{Exact, Proxy};
use palpate_haptics::force::Uniform;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::Smoothing;
use palpate_haptics::tick::{TickCache, TickInput, TickOutput, TickState, tick};
use palpate_volume::first_solid::first_solid;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

use crate::random::Random;

/// Way of the device per update, in smallest spacings.
pub const STEP: f64 = 0.2;
/// How deep it presses, in smallest spacings: a ball with its own surface, which is as deep as
/// its middle lies behind where it may be.
pub const DEPTH: f64 = 1.5;

/// Fraction of the updates that must be in contact.
const CONTACT_SHARE: f64 = 0.95;
/// Starts tried for it.
const TRIES: usize = 16;
/// How much the direction turns per update.
const TURN: f64 = 0.05;

/// Where the device goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// A free point from which the first update goes.
    pub start: DVec3,
    /// The device at each update.
    pub device: Vec<DVec3>,
    /// The probe after each update.
    pub probe: Vec<DVec3>,
    /// Fraction of the updates in contact.
    pub contact_fraction: f64,
}

impl Stroke {
    /// Way of the device per update, on average [mm].
    #[must_use]
    pub fn mean_step(&self) -> f64 {
        let steps = self.device.windows(2);
        let count = steps.len().max(1) as f64;
        steps.map(|pair| pair[0].distance(pair[1])).sum::<f64>() / count
    }
}

/// A stroke of `count` updates over a solid: the first of some that is in contact nearly always,
/// else the best; none where there is no surface.
#[must_use]
pub fn stroke(
    grid: &Grid,
    solid: &impl Occupancy,
    model: &Exact,
    count: usize,
    seed: u64,
) -> Option<Stroke> {
    let mut random = Random(seed);
    let mut best: Option<Stroke> = None;
    for _ in 0..TRIES {
        let Some(start) = touched_point(grid, solid, &mut random) else {
            continue;
        };
        let tried = slide_from((grid, solid, model), start, count, &mut random);
        if tried.contact_fraction >= CONTACT_SHARE {
            return Some(tried);
        }
        if best
            .as_ref()
            .is_none_or(|best| best.contact_fraction < tried.contact_fraction)
        {
            best = Some(tried);
        }
    }
    best
}

/// Where a stroke begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// A free point at the surface.
    pub free: DVec3,
    /// The middle of the solid voxel next to it.
    pub solid: DVec3,
}

/// A place at the surface that is met from outside.
pub(crate) fn touched_point(
    grid: &Grid,
    solid: &impl Occupancy,
    random: &mut Random,
) -> Option<Touch> {
    let bounds = VoxelBox::of_dimensions(grid.dimensions());
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let middle = (low + high) * 0.5;
    let radius = (high - low).length();
    // from all around toward the middle half of the grid
    for _ in 0..1000 {
        let target = middle + random.in_box(low - middle, high - middle) * 0.5;
        let start = target + random.direction() * radius;
        let Some(hit) = first_solid(solid, start, target) else {
            continue;
        };
        if hit.starts_inside() {
            continue;
        }
        let scene_from_grid = grid.patient_from_grid();
        let inside = hit.voxel.as_dvec3() + 0.5;
        let free = Proxy::nearest_in(hit.last_free, inside);
        return Some(Touch {
            free: scene_from_grid.transform_point3(free.point()),
            solid: scene_from_grid.transform_point3(inside),
        });
    }
    None
}

fn slide_from(
    (grid, solid, model): (&Grid, &impl Occupancy, &Exact),
    start: Touch,
    count: usize,
    random: &mut Random,
) -> Stroke {
    let scene = TouchScene::of_world(solid, grid);
    let proxy = Proxy::at(grid.grid_from_patient().transform_point3(start.free));
    let mut state = TickState::new(proxy.expect("the start is next to a voxel of the grid"));
    let surface = Uniform::smooth(1.0);
    let mut cache = TickCache::default();
    let mut hand = Hand::new(start, grid.smallest_spacing(), random);
    let mut stroke = Stroke {
        start: start.free,
        device: Vec::with_capacity(count),
        probe: Vec::with_capacity(count),
        contact_fraction: 0.0,
    };
    let mut contacts = 0_usize;
    for _ in 0..count {
        let input = TickInput {
            device_in_scene: hand.device,
            velocity_in_scene: DVec3::ZERO,
            damping: 0.0,
            // the depth is that of the hard proxy
            smoothing: Smoothing::Off,
        };
        let output = tick(&scene, model, &surface, &input, &mut state, &mut cache);
        stroke.device.push(hand.device);
        stroke.probe.push(output.proxy_in_scene);
        contacts += usize::from(output.contact);
        hand.advance(&output, random);
    }
    stroke.contact_fraction = contacts as f64 / count.max(1) as f64;
    stroke
}

/// Leads the device along the surface.
struct Hand {
    h: f64,
    device: DVec3,
    /// Out of the solid, where it was last touched.
    outward: DVec3,
    /// Along the surface.
    heading: DVec3,
    /// Where to go when the surface is lost: where it was last touched, or where it surely is.
    back: DVec3,
    anchor: DVec3,
}

impl Hand {
    fn new(start: Touch, h: f64, random: &mut Random) -> Self {
        Self {
            h,
            device: start.solid,
            outward: (start.free - start.solid).normalize(),
            heading: random.direction(),
            back: start.solid,
            anchor: start.solid,
        }
    }

    /// Goes on by one step.
    fn advance(&mut self, touched: &TickOutput, random: &mut Random) {
        let direction = if touched.contact {
            self.along(touched, random)
        } else {
            self.back(random)
        };
        self.device += direction * (STEP * self.h);
    }

    /// Along the surface, and back to the depth that is wanted.
    fn along(&mut self, touched: &TickOutput, random: &mut Random) -> DVec3 {
        let out = (touched.proxy_in_scene - self.device).try_normalize();
        self.outward = out.unwrap_or(self.outward);
        self.back = self.device;
        self.heading += random.direction() * TURN;
        self.heading = self
            .heading
            .reject_from_normalized(self.outward)
            .try_normalize()
            .unwrap_or_else(|| self.outward.any_orthonormal_vector());
        let too_deep = (touched.depth / (DEPTH * self.h) - 1.0).clamp(-1.0, 1.0);
        (self.heading + self.outward * (0.5 * too_deep)).normalize()
    }

    /// Back to the surface, to leave from there in another direction.
    fn back(&mut self, random: &mut Random) -> DVec3 {
        if self.device.distance(self.back) < STEP * self.h {
            self.back = self.anchor;
        }
        self.heading = random.direction();
        (self.back - self.device)
            .try_normalize()
            .unwrap_or(self.heading)
    }
}
