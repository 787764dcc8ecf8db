//! What is done in a run: made from the seed and the number of the run, and nothing else.

use glam::{DMat3, DVec3, UVec3};
use palpate_volume::grid::Grid;

use super::world::SIZE;
use crate::random::Random;

/// What the probe moves among.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Terrain {
    /// One or two thinnest digital planes across this normal [voxels] that no way through
    /// faces crosses, `apart` voxels from one another.
    Walls {
        /// Across the walls.
        normal: DVec3,
        /// From the first to the second; 0 for one wall.
        apart: f64,
    },
    /// A closed shell, one voxel thick.
    Shell {
        /// Its radius [voxels].
        radius: f64,
    },
    /// Each voxel solid by chance.
    Noise {
        /// Fraction of solid voxels.
        share: f64,
    },
    /// A part of the bone that was given.
    Bone,
}

/// What is done in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// What the probe moves among.
    pub terrain: Terrain,
    /// Voxel size [mm]; the bone has its own.
    pub spacing: DVec3,
    /// How the grid lies in the scene.
    pub direction: DMat3,
    /// Where it lies [mm].
    pub origin: DVec3,
    /// Radius of the probe in smallest spacings; 0 for a point.
    pub radius: f64,
    /// Objects, each with its own grid and pose.
    pub objects: u32,
    /// Whether they move.
    pub motion: bool,
    /// Whether voxels are set and cleared under the probe.
    pub edits: bool,
    /// Moves.
    pub moves: u32,
}

/// Kinds of runs; each takes its turn.
const TURNS: u64 = 20;

/// Moves of a run. A world takes a millisecond or two to make, some 1000 moves.
const MOVES: u32 = 10_000;

impl Plan {
    /// The plan of a run; `has_bone` says whether there is some.
    #[must_use]
    pub fn new(number: u64, has_bone: bool, random: &mut Random) -> Self {
        let turn = number % TURNS;
        let terrain = terrain(turn, has_bone, random);
        // rounds of all kinds: bare, with edits, with objects, with all of it
        let round = number / TURNS % 4;
        let edits = round % 2 == 1;
        let motion = round == 3;
        let objects = if round >= 2 { 1 + (turn % 3) as u32 } else { 0 };
        let radius = radius(turn);
        Self {
            terrain,
            spacing: random_spacing(random),
            direction: direction(random),
            origin: random.in_box(DVec3::splat(-500.0), DVec3::splat(500.0)),
            radius,
            objects,
            motion,
            edits,
            // balls and objects take several times as long to move
            moves: if radius > 0.0 || objects > 0 {
                MOVES / 4
            } else {
                MOVES
            },
        }
    }

    /// The grid of its world.
    ///
    /// # Panics
    /// Never: plans make valid grids.
    #[must_use]
    pub fn grid(&self) -> Grid {
        let size = UVec3::splat(SIZE as u32);
        Grid::new(size, self.spacing, self.origin, self.direction).expect("plans make valid grids")
    }
}

fn terrain(turn: u64, has_bone: bool, random: &mut Random) -> Terrain {
    let wall = |normal: DVec3, apart: f64| Terrain::Walls { normal, apart };
    let slot = 1.0 + 3.0 * random.share();
    let any = random.direction();
    match turn {
        0 => wall(DVec3::new(1.0, 1.0, 0.0), 0.0),
        1 => wall(DVec3::new(1.0, 1.0, 1.0), 0.0),
        2 => wall(DVec3::new(1.0, -1.0, 2.0), slot),
        3 | 4 => wall(any, 0.0),
        5 | 16 => wall(any, slot),
        6 => Terrain::Shell { radius: 16.0 },
        7 => Terrain::Noise { share: 0.02 },
        8 => Terrain::Noise { share: 0.1 },
        9 => Terrain::Noise { share: 0.3 },
        10 => Terrain::Noise { share: 0.5 },
        11 => Terrain::Noise { share: 0.65 },
        // balls need room
        17 => Terrain::Noise { share: 0.01 },
        18 | 19 if !has_bone => Terrain::Noise { share: 0.001 },
        _ if has_bone => Terrain::Bone,
        _ => Terrain::Noise {
            share: 0.5 * random.share(),
        },
    }
}

/// In smallest spacings.
fn radius(turn: u64) -> f64 {
    match turn {
        16 => 1.0,
        17 => 1.5,
        18 => 2.0,
        19 => 5.0,
        _ => 0.0,
    }
}

/// Cubes, thick slices or anything [mm].
pub fn random_spacing(random: &mut Random) -> DVec3 {
    match (3.0 * random.share()) as u32 {
        0 => DVec3::ONE,
        1 => DVec3::new(0.7, 0.7, 2.5),
        _ => random.in_box(DVec3::splat(0.4), DVec3::splat(3.0)),
    }
}

/// A rotation, or a reflection.
fn direction(random: &mut Random) -> DMat3 {
    let angle = std::f64::consts::TAU * random.share();
    let turn = DMat3::from_axis_angle(random.direction(), angle);
    if random.share() < 0.5 {
        turn
    } else {
        turn * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0))
    }
}
