//! Scans, random numbers and dense copies for the tests of all tools.

pub mod journal;
pub mod place;
pub mod session;

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_tools::tool::ToolInput;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

/// Seeded numbers.
pub struct Random(oorandom::Rand64);

impl Random {
    pub fn new(seed: u128) -> Self {
        Self(oorandom::Rand64::new(seed))
    }

    /// Uniform in [low, high).
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.rand_float()
    }

    /// Uniform in low..high.
    pub fn integer(&mut self, low: i64, high: i64) -> i64 {
        low + self.0.rand_range(0..(high - low) as u64) as i64
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.0.rand_float() < share
    }

    /// A point of the grid or up to `beyond` voxels outside, in patient mm.
    pub fn point(&mut self, grid: &Grid, beyond: f64) -> DVec3 {
        let size = grid.dimensions().as_dvec3();
        let share = |random: &mut Self, n| random.number(-beyond, n + beyond);
        let in_grid = DVec3::new(
            share(self, size.x),
            share(self, size.y),
            share(self, size.z),
        );
        grid.patient_from_grid().transform_point3(in_grid)
    }
}

/// Turned, mirrored, with voxels of three different sides.
pub fn oblique_grid(dimensions: UVec3) -> Grid {
    let direction = DMat3::from_rotation_z(0.4) * DMat3::from_rotation_x(-0.7);
    let mirrored = direction * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    let spacing = DVec3::new(0.7, 0.9, 2.5);
    Grid::new(dimensions, spacing, DVec3::new(-30.0, 12.0, 7.0), mirrored).expect("a grid")
}

/// Cubes of `spacing` [mm] along the patient's axes; voxel 0 begins at the origin.
pub fn straight_grid(dimensions: UVec3, spacing: f64) -> Grid {
    let centre = DVec3::splat(spacing / 2.0);
    Grid::new(dimensions, DVec3::splat(spacing), centre, DMat3::IDENTITY).expect("a grid")
}

/// A scan of one value with these segments, numbered from 1.
pub fn scan(
    grid: Grid,
    stored: impl Fn(IVec3) -> i16,
    segments: &[&(dyn Fn(IVec3) -> bool + Sync)],
) -> Voxels {
    let dimensions = grid.dimensions();
    let values: Vec<i16> = grid.bounds().voxels().map(stored).collect();
    let intensities = Intensities::new(dimensions, values, 1.0, 0.0).expect("one per voxel");
    let mut voxels = Voxels::new(grid, intensities).expect("the same grid");
    for solid in segments {
        voxels
            .add_segment(Segment::from_fn(dimensions, solid))
            .expect("a free number");
    }
    voxels
}

/// Everything that a person could see, voxel by voxel, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    pub stored: Vec<i16>,
    pub masks: BTreeMap<SegmentId, Vec<u8>>,
}

impl Dense {
    pub fn of(voxels: &Voxels) -> Self {
        let stored = |voxel| voxels.stored(voxel).expect("inside");
        Self {
            stored: voxels.grid().bounds().voxels().map(stored).collect(),
            masks: voxels
                .segments()
                .map(|(id, segment)| (id, segment.mask()))
                .collect(),
        }
    }
}

/// The centre of a voxel in patient mm.
pub fn centre(grid: &Grid, voxel: IVec3) -> DVec3 {
    grid.patient_from_grid()
        .transform_point3(voxel.as_dvec3() + 0.5)
}

/// Distance of a point from a way, by the textbook.
pub fn distance_to_way(from: DVec3, to: DVec3, point: DVec3) -> f64 {
    let way = (to - from).length();
    if way == 0.0 {
        return point.distance(from);
    }
    let along = (to - from) / way;
    let place = (point - from).dot(along);
    if place < 0.0 {
        point.distance(from)
    } else if place > way {
        point.distance(to)
    } else {
        (point - from).cross(along).length()
    }
}

/// A pass of 10 ms of a point probe without contact.
pub fn free_move(from: DVec3, to: DVec3) -> ToolInput {
    ToolInput {
        from,
        to,
        body_radius: Some(0.0),
        force: 0.0,
        contact_normal: DVec3::ZERO,
        dt: 0.01,
    }
}

/// Everything solid.
pub fn everywhere(_: IVec3) -> bool {
    true
}

/// A rigid motion.
pub fn rigid() -> DAffine3 {
    DAffine3::from_rotation_y(0.8) * DAffine3::from_translation(DVec3::new(3.0, -2.0, 9.0))
}
