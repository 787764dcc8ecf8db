//! Bodies to touch, random points, and an independent count of what is connected.

#![allow(dead_code, reason = "examples share it, each its own part")]

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::ball::{Ball, BallShape, ProbeSolid};
use palpate_haptics::contact::{Contact, ContactModel, Exact, Proxy};
use palpate_haptics::force::{Coupling, Surface, Uniform};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::Smoothing;
use palpate_haptics::smooth::occupancy_fractions::{Around, Limits};
use palpate_haptics::tick::{TickCache, TickInput, TickOutput, TickState, tick};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

/// Voxel sizes that tests run on: cubes, and slices thicker than their pixels [mm].
pub const SPACINGS: [DVec3; 2] = [DVec3::ONE, DVec3::new(0.7, 0.7, 2.5)];

/// A grid whose scene is its own millimetres.
pub fn grid(dimensions: UVec3, spacing: DVec3) -> Grid {
    let origin = spacing * 0.5;
    Grid::new(dimensions, spacing, origin, DMat3::IDENTITY).expect("a valid grid")
}

/// A body of any size by a rule; `Occupancy` has no closures of its own.
pub struct Body<F>(pub F);
impl<F: Fn(IVec3) -> bool> Occupancy for Body<F> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        (self.0)(voxel)
    }
}

/// Random numbers with a seed.
pub struct Random(oorandom::Rand64);

impl Random {
    pub fn new(seed: u128) -> Self {
        Self(oorandom::Rand64::new(seed))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.rand_float()
    }

    pub fn below(&mut self, count: usize) -> usize {
        self.0.rand_range(0..count as u64) as usize
    }

    /// A point of the cube from `low` to `high` along each axis.
    pub fn point(&mut self, low: f64, high: f64) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.between(low, high)))
    }

    /// A direction, all equally likely.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.point(-1.0, 1.0);
            if (0.01..1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }
}

/// A rotation by some angle about some axis.
pub fn rotation(random: &mut Random) -> DMat3 {
    DMat3::from_axis_angle(random.direction(), random.between(-3.0, 3.0))
}

/// Normals that point up and differ by 40° at least.
pub fn open_normals(count: usize, random: &mut Random) -> Vec<DVec3> {
    let mut normals: Vec<DVec3> = Vec::new();
    while normals.len() < count {
        let normal = (random.direction() + DVec3::Z).normalize_or_zero();
        if normal.z > 0.1 && normals.iter().all(|other| other.dot(normal) < 0.76) {
            normals.push(normal);
        }
    }
    normals
}

/// The point nearest to `device` outside half spaces whose planes pass zero.
/// Source: Dykstra, "An algorithm for restricted least squares regression", JASA 78 (1983).
pub fn nearest_outside(normals: &[DVec3], device: DVec3) -> DVec3 {
    let mut point = device;
    let mut corrections = vec![DVec3::ZERO; normals.len()];
    for _ in 0..2_000 {
        for (normal, correction) in normals.iter().zip(&mut corrections) {
            let back = point + *correction;
            point = back - *normal * normal.dot(back).min(0.0);
            *correction = back - point;
        }
    }
    point
}

/// Voxels solid with a probability, independently.
pub fn noise(size: u32, share: f64, seed: u128) -> Segment {
    let mut random = Random::new(seed);
    let count = (size as usize).pow(3);
    let mask: Vec<u8> = (0..count)
        .map(|_| u8::from(random.between(0.0, 1.0) < share))
        .collect();
    Segment::from_mask(UVec3::splat(size), &mask).expect("one byte per voxel")
}

/// Which free voxels are connected face to face, by flooding the whole grid and a margin
/// around it: a second way to the answer, which shares nothing with the code tested.
pub struct Components {
    bounds: VoxelBox,
    labels: Vec<u32>,
}

impl Components {
    /// The label of everything outside.
    pub const OUTSIDE: u32 = 1;

    pub fn of(solid: &impl Occupancy, dimensions: UVec3) -> Self {
        let bounds = VoxelBox::of_dimensions(dimensions).dilate(1);
        let count = bounds.voxel_count() as usize;
        let mut components = Self {
            bounds,
            labels: vec![0; count],
        };
        let mut next = Self::OUTSIDE;
        for voxel in bounds.voxels() {
            if components.label(voxel) == 0 && !solid.is_solid(voxel) {
                components.flood(solid, voxel, next);
                next += 1;
            }
        }
        components
    }

    fn flood(&mut self, solid: &impl Occupancy, start: IVec3, label: u32) {
        let mut stack = vec![start];
        while let Some(voxel) = stack.pop() {
            if !self.bounds.contains(voxel) || solid.is_solid(voxel) || self.label(voxel) != 0 {
                continue;
            }
            let index = self.index(voxel);
            self.labels[index] = label;
            for axis in IVec3::AXES {
                stack.push(voxel + axis);
                stack.push(voxel - axis);
            }
        }
    }

    fn index(&self, voxel: IVec3) -> usize {
        let offset = (voxel - self.bounds.min).as_uvec3();
        let size = self.bounds.size();
        ((offset.z * size.y + offset.y) * size.x + offset.x) as usize
    }

    /// 0 for a solid voxel.
    pub fn label(&self, voxel: IVec3) -> u32 {
        if self.bounds.contains(voxel) {
            self.labels[self.index(voxel)]
        } else {
            Self::OUTSIDE
        }
    }
}

/// A ball with a radius in smallest spacings.
pub fn hard(radius: f64, spacing: DVec3) -> Ball {
    let shape = BallShape::new(radius * spacing.min_element(), spacing);
    Ball::new(shape.expect("within the window"))
}

/// What is solid for a probe with a radius in smallest spacings.
pub fn probe_solid<O: Occupancy>(inner: O, radius: f64, spacing: DVec3) -> ProbeSolid<O> {
    let radius_mm = radius * spacing.min_element();
    ProbeSolid::new(inner, radius_mm, spacing).expect("within the window")
}

/// Distance [mm] from a point of the grid to the nearest solid voxel within `reach`.
pub fn distance_to_solid(inner: &impl Occupancy, spacing: DVec3, point: DVec3, reach: i32) -> f64 {
    let around = VoxelBox::of_voxel(point.floor().as_ivec3()).dilate(reach);
    around
        .voxels()
        .filter(|&voxel| inner.is_solid(voxel))
        .map(|voxel| {
            let low = voxel.as_dvec3();
            let outside = (low - point).max(point - (low + 1.0)).max(DVec3::ZERO);
            (outside * spacing).length()
        })
        .fold(f64::INFINITY, f64::min)
}

/// One update of `exact`, which must leave the probe free.
pub fn advance(
    occupancy: &impl Occupancy,
    grid: &Grid,
    device: DVec3,
    proxy: &mut Proxy,
) -> Contact {
    let scene = TouchScene::of_world(occupancy, grid);
    let contact = Exact::default().advance(&scene, device, proxy);
    assert!(!contact.violation && !occupancy.is_solid(proxy.voxel()));
    contact
}

/// What a tick is given where the surface is the same everywhere and stairs are felt.
#[derive(Clone, Copy, Debug)]
pub struct Press {
    pub device_in_scene: DVec3,
    pub velocity_in_scene: DVec3,
    pub coupling: Coupling,
}

/// A tick without friction and without smoothing.
pub fn press<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    model: &impl ContactModel,
    press: &Press,
    state: &mut TickState,
) -> TickOutput {
    let surface = Uniform::smooth(press.coupling.stiffness);
    let input = press.input(Smoothing::Off);
    tick(
        scene,
        model,
        &surface,
        &input,
        state,
        &mut TickCache::default(),
    )
}

/// A tick without friction, with smoothing; the scene is always the same.
pub fn press_smooth<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    press: &Press,
    state: &mut TickState,
    cache: &mut TickCache,
) -> TickOutput {
    let surface = Uniform::smooth(press.coupling.stiffness);
    let input = press.input(Smoothing::Bits);
    tick(scene, &Exact::default(), &surface, &input, state, cache)
}

/// A tick with friction, the force from somewhere else in each epoch.
pub fn rub<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    press: &Press,
    state: &mut TickState,
    (cache, epoch): (&mut TickCache, u64),
) -> TickOutput {
    let surface = Uniform(Surface {
        friction_static: 0.4,
        friction_kinetic: 0.3,
        ..Uniform::smooth(press.coupling.stiffness).0
    });
    cache.set_epoch(epoch);
    let input = press.input(Smoothing::ALL[epoch as usize % 3]);
    tick(scene, &Exact::default(), &surface, &input, state, cache)
}

impl Press {
    fn input(&self, smoothing: Smoothing) -> TickInput {
        TickInput {
            device_in_scene: self.device_in_scene,
            velocity_in_scene: self.velocity_in_scene,
            damping: self.coupling.damping,
            smoothing,
        }
    }
}

/// Voxels and the scan from which thresholds made them.
#[derive(Clone, Copy, Debug)]
pub struct Thresholded<'a> {
    pub bits: &'a Bits,
    pub scan: &'a Intensities,
    pub limits: Limits,
}

impl<'a> Thresholded<'a> {
    pub fn new(bits: &'a Bits, scan: &'a Intensities, range: (f64, f64)) -> Self {
        let limits = Limits::new((scan.slope(), scan.intercept()), [range]);
        Self { bits, scan, limits }
    }
}

impl Occupancy for Thresholded<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.bits.is_solid(voxel)
    }

    fn block(&self, min: IVec3) -> BitBrick {
        self.bits.block(min)
    }

    fn knows_fractions(&self) -> bool {
        true
    }

    fn occupancy_fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        self.limits.fraction(&Around::of(self.scan, voxel), solid)
    }

    fn fraction_changes(&self, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        let stored = |voxel| Around::stored(self.scan, voxel);
        self.limits.fraction_changes(stored, voxels, changes);
    }
}
