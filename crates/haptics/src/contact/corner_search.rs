//! Out of a corner that faces of several bodies form: short legs to all sides, along the faces
//! that they meet, until one ends nearer to the device.
//!
//! Where the stairs of two bodies cross at an angle, no lattice fits: the ways out of a pit
//! between them can be narrower than any step. So the ways are felt, not computed: from each
//! place that was reached, a step along each axis of the bodies met, and where a face is in the
//! way, on along it. A place counts once per cell of a small grid around the proxy. Every leg
//! is walked in every body, so whatever is reached is reached by a legal way.
//!
//! Frame: the world's grid, lengths in mm.

use crate::contact::bodies::{Bodies, Leg, Visits};
use crate::contact::descent::{Faces, before};
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;

/// Length of a step, in smallest spacings.
const STEP: f64 = 0.5;
/// The same where these lead to few places: out of a pit narrower than they are.
const SMALL: f64 = 0.3;
const FEW_PLACES: usize = 24;
/// And over thick slices, in parts of their thickness.
const WIDE: f64 = 0.6;
/// Steps to all sides: six for each of three bodies.
const STEPS: usize = 18;
/// Side of a cell, in steps.
const CELL: f64 = 0.8;
/// Cells along the edge of the grid: 3.2 smallest spacings to each side.
const EDGE: i32 = 16;
/// Most places looked at.
const PLACES: usize = 96;
/// Attempts to reach a cell that has no place yet.
const AIMS: usize = 2;
/// Legs of a step: one, and on along a face and a crease.
const LEGS: u32 = 4;
/// Less of a step is no way.
const LEAST_WAY: f64 = 0.02;

/// Feels around `from` for a place whose squared distance to the device is below `limit`
/// [mm²]; `met` has the bodies whose axes are tried, as bits.
pub(crate) fn search_corner<O: Occupancy>(
    bodies: &Bodies<'_, O>,
    from: DVec3,
    device: DVec3,
    met: u32,
    limit: f64,
    visits: &mut Visits,
) -> Option<DVec3> {
    let h = bodies.smallest_spacing();
    let is_met = |body: &u8| met >> body & 1 == 1;
    let widest = bodies
        .numbers()
        .filter(is_met)
        .map(|body| bodies.spacing(body).max_element())
        .fold(h, f64::max);
    let mut search = |scale: f64| {
        let length = STEP * scale * h;
        let search = Search {
            bodies,
            device,
            limit,
            length,
            steps: steps_of(bodies, met, length),
        };
        search.run(from, visits)
    };
    let scale = match search(1.0) {
        Found::Nearer(point) => return Some(point),
        Found::OutOfVisits => return None,
        Found::Places(count) if count < FEW_PLACES => SMALL,
        Found::Places(_) if widest >= 2.0 * h => WIDE * widest / h,
        Found::Places(_) => return None,
    };
    match search(scale) {
        Found::Nearer(point) => Some(point),
        Found::Places(_) | Found::OutOfVisits => None,
    }
}

/// A search with steps of one length.
struct Search<'a, 'b, O> {
    bodies: &'a Bodies<'b, O>,
    device: DVec3,
    limit: f64,
    /// Length of a step [mm].
    length: f64,
    steps: [DVec3; STEPS],
}

/// What a search has found.
enum Found {
    Nearer(DVec3),
    /// Nothing nearer, among so many places.
    Places(usize),
    OutOfVisits,
}

impl<O: Occupancy> Search<'_, '_, O> {
    fn run(&self, from: DVec3, visits: &mut Visits) -> Found {
        let spacing = self.bodies.scene.grid.spacing();
        let mut places = Places::new(from, spacing / (CELL * self.length));
        while let Some(place) = places.next() {
            for step in self.steps {
                if step == DVec3::ZERO || !places.wants(place + step / spacing) {
                    continue;
                }
                let Some(point) = step_along(self.bodies, place, step, visits) else {
                    return Found::OutOfVisits;
                };
                let distance = self.bodies.squared_distance(point, self.device);
                if distance < self.limit {
                    return Found::Nearer(point);
                }
                places.add(point, distance);
            }
        }
        Found::Places(places.count)
    }
}

/// A step up and down each axis of the bodies met [mm]; zeros where fewer were met.
fn steps_of<O: Occupancy>(bodies: &Bodies<'_, O>, met: u32, length: f64) -> [DVec3; STEPS] {
    let is_met = |body: &u8| met >> body & 1 == 1;
    let axes = bodies
        .numbers()
        .filter(is_met)
        .flat_map(|body| bodies.axes(body));
    let both = axes.flat_map(|axis| [axis * length, axis * -length]);
    let mut steps = [DVec3::ZERO; STEPS];
    for (place, step) in steps.iter_mut().zip(both) {
        *place = step;
    }
    steps
}

/// A step [mm], and where a face is in the way, on along it; none without visits.
fn step_along<O: Occupancy>(
    bodies: &Bodies<'_, O>,
    from: DVec3,
    step: DVec3,
    visits: &mut Visits,
) -> Option<DVec3> {
    let spacing = bodies.scene.grid.spacing();
    let mut faces = Faces::default();
    let (mut at, mut left) = (from, step);
    for _ in 0..LEGS {
        let goal = at + left / spacing;
        match bodies.walk(at, goal, visits) {
            Leg::Free => return Some(goal),
            Leg::Unknown => return None,
            Leg::Hit(hit) => {
                if hit.fraction * left.length() > LEAST_WAY * step.length()
                    && let Some(point) = before(bodies, at, goal, &hit, visits)
                {
                    at = point;
                    faces.keep_along(left);
                }
                let known = !faces.add(hit.normal);
                left = faces.allowed(left * (1.0 - hit.fraction));
                if known || left.length() < LEAST_WAY * step.length() {
                    break;
                }
            }
        }
    }
    Some(at)
}

/// The places reached, one per cell.
struct Places {
    points: [DVec3; PLACES],
    /// Squared distances to the device [mm²]; infinity where a place was left already.
    distances: [f64; PLACES],
    count: usize,
    /// Cells with a place, and cells that were aimed at once, twice.
    taken: Cells,
    aims: [Cells; AIMS],
    origin: DVec3,
    /// Cells per voxel of the world.
    scale: DVec3,
}

impl Places {
    fn new(origin: DVec3, scale: DVec3) -> Self {
        let mut places = Self {
            points: [origin; PLACES],
            distances: [f64::INFINITY; PLACES],
            count: 0,
            taken: Cells::EMPTY,
            aims: [Cells::EMPTY; AIMS],
            origin,
            scale,
        };
        places.add(origin, 0.0);
        places
    }

    /// The place nearest to the device that was not left yet: so a pit is left by its lowest
    /// rim first.
    fn next(&mut self) -> Option<DVec3> {
        let known = self.distances.get(..self.count)?;
        let waiting = known
            .iter()
            .enumerate()
            .filter(|(_, distance)| distance.is_finite());
        let (place, _) = waiting.min_by(|a, b| a.1.total_cmp(b.1))?;
        *self.distances.get_mut(place)? = f64::INFINITY;
        self.points.get(place).copied()
    }

    /// Whether a step toward a point is worth its walk: its cell is near, has no place yet,
    /// and was not aimed at often.
    fn wants(&mut self, point: DVec3) -> bool {
        let Some(cell) = self.cell(point) else {
            return false;
        };
        let aims = &mut self.aims;
        !self.taken.has(cell) && aims.iter_mut().any(|aimed| aimed.add(cell))
    }

    /// Adds a place in a cell without one.
    fn add(&mut self, point: DVec3, distance: f64) {
        if let Some(cell) = self.cell(point)
            && let Some(place) = self.points.get_mut(self.count)
            && self.taken.add(cell)
        {
            *place = point;
            if let Some(place) = self.distances.get_mut(self.count) {
                *place = distance;
            }
            self.count += 1;
        }
    }

    /// The number of the cell that holds a point, if it is near.
    fn cell(&self, point: DVec3) -> Option<usize> {
        let offset = (point - self.origin) * self.scale + f64::from(EDGE / 2);
        let cell = offset.floor().as_ivec3();
        let is_near = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(IVec3::splat(EDGE)).all();
        is_near.then(|| ((cell.z * EDGE + cell.y) * EDGE + cell.x) as usize)
    }
}

/// A set of cells.
struct Cells([u64; (EDGE * EDGE * EDGE / 64) as usize]);

impl Cells {
    const EMPTY: Self = Self([0; (EDGE * EDGE * EDGE / 64) as usize]);

    fn has(&self, cell: usize) -> bool {
        let word = self.0.get(cell / 64).copied().unwrap_or(0);
        word >> (cell % 64) & 1 == 1
    }

    /// Adds a cell; false where it was there.
    fn add(&mut self, cell: usize) -> bool {
        let is_new = !self.has(cell);
        if let Some(word) = self.0.get_mut(cell / 64) {
            *word |= 1 << (cell % 64);
        }
        is_new
    }
}
