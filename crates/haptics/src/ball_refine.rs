//! From the cell where a ball stands to the very place where it touches.
//!
//! Cells keep a ball up to one of them too far from the surface. From there its centre moves on
//! toward the device, straight and then along what it meets, against the solid voxels as boxes:
//! a god-object with up to three planes. Every move is cast against all boxes around, so the
//! ball overlaps none of them anywhere on the way, to within [`TOLERANCE`]. Nothing is kept from
//! tick to tick: equal places give equal answers.
//!
//! A cast finds where the distance to a box falls to the radius. Along a line the distance to a
//! convex body is a convex function, so Newton's method from the free side comes nearer with
//! each step and never goes too far.
//!
//! Frames: grid at the door; inside mm along the grid's axes, from the start of the ball.
//! Source: Zilles & Salisbury, "A constraint-based god-object method for haptic display",
//! IROS 1995, with the boxes rounded by the radius.

use crate::ball_shape::BallShape;
use crate::proxy::Proxy;
use glam::{DVec3, IVec3};
use palpate_volume::brick_grid::BRICK;
use palpate_volume::occupancy::Occupancy;

/// How much the ball can overlap a box [mm]: far above rounding, far below anything felt.
pub const TOLERANCE: f64 = 1e-9;

/// Straight moves; each may overlap by its share of the tolerance, so that a box that the ball
/// slides over, beside the one that it rests on, does not stop it.
const MOVES: usize = 6;
const SLACK: f64 = TOLERANCE / (2 * MOVES) as f64;

/// Cells that the centre can move along each axis.
const TRAVEL: i32 = 1;
/// Farthest reach of a ball that is moved on; larger ones stay where their cell is.
const MAX_REFINED_REACH: i32 = 8;
/// Voxels along each axis that such a ball can meet.
const WINDOW: usize = 2 * (MAX_REFINED_REACH + TRAVEL) as usize + 1;
/// Most boxes; among more the ball stays where it is.
const MAX_BOXES: usize = 512;

/// Steps of Newton's method; where more are needed the ball stops short of the box.
const NEWTON: usize = 12;
/// Shortest move [mm].
const SHORTEST: f64 = 1e-7;

/// Where the centre of the ball comes to rest, grid; `proxy` is in a free cell.
pub(crate) fn refined(
    inner: &(impl Occupancy + ?Sized),
    shape: &BallShape,
    proxy: &Proxy,
    device_in_grid: DVec3,
) -> DVec3 {
    let (start, spacing) = (proxy.point(), shape.spacing());
    let reach = shape.reach() + TRAVEL;
    let too_large = shape.reach().max_element() > MAX_REFINED_REACH;
    if too_large || shape.radius_mm() < SHORTEST || !device_in_grid.is_finite() {
        return start;
    }

    // the cells that the centre can get to
    let low = (proxy.voxel() - TRAVEL).as_dvec3();
    let high = low + f64::from(2 * TRAVEL + 1);
    let room = Box {
        low: (low - start) * spacing,
        high: (high - start) * spacing,
    };
    let goal = (device_in_grid - start) * spacing;
    if goal.length() < SHORTEST {
        return start;
    }

    // the voxels that the ball can meet there
    let min = proxy.voxel() - reach;
    let rows = read(inner, min, reach);
    let mut boxes = Boxes::new(min.as_dvec3() - start, spacing);
    let all = boxes.collect(&rows, reach);
    if !all {
        return start;
    }
    start + boxes.slide(goal, shape.radius_mm(), &room) / spacing
}

/// Rows along x, by z and y.
type Rows = [[u32; WINDOW]; WINDOW];

/// The voxels from `min` on, `reach` on either side of the middle.
fn read(inner: &(impl Occupancy + ?Sized), min: IVec3, reach: IVec3) -> Rows {
    let mut rows = [[0; WINDOW]; WINDOW];
    let size = 2 * reach + 1;
    for z in (0..size.z).step_by(BRICK as usize) {
        for y in (0..size.y).step_by(BRICK as usize) {
            for x in (0..size.x).step_by(BRICK as usize) {
                let block = inner.block(min + IVec3::new(x, y, z)).0;
                for (layer, word) in rows.iter_mut().skip(z as usize).zip(block) {
                    for (row, bits) in layer.iter_mut().skip(y as usize).zip(word.to_le_bytes()) {
                        *row |= u32::from(bits) << x;
                    }
                }
            }
        }
    }
    rows
}

/// A box [mm].
#[derive(Clone, Copy, Debug)]
struct Box {
    low: DVec3,
    high: DVec3,
}

impl Box {
    /// From its nearest point to `point`.
    #[inline]
    fn to(&self, point: DVec3) -> DVec3 {
        point - point.max(self.low).min(self.high)
    }

    /// The share of a way from a point inside on which it stays inside.
    fn share_within(&self, from: DVec3, way: DVec3) -> f64 {
        let side = DVec3::select(way.cmpgt(DVec3::ZERO), self.high, self.low);
        let shares = DVec3::select(way.cmpeq(DVec3::ZERO), DVec3::ONE, (side - from) / way);
        shares.min_element().clamp(0.0, 1.0)
    }
}

/// Voxels beside each other along x: the first, the one after the last; y; z.
type Run = [u8; 4];

/// The boxes that the ball can meet.
struct Boxes {
    /// Where the planes between voxels are, per axis [mm].
    planes: [[f64; 32]; 3],
    runs: [Run; MAX_BOXES],
    count: usize,
}

impl Boxes {
    /// No boxes, in a window with this corner [voxels from the start].
    fn new(corner: DVec3, spacing: DVec3) -> Self {
        let planes = |axis: usize| {
            std::array::from_fn(|plane| (corner[axis] + plane as f64) * spacing[axis])
        };
        Self {
            planes: [planes(0), planes(1), planes(2)],
            runs: [Run::default(); MAX_BOXES],
            count: 0,
        }
    }

    /// All voxels with a free face; false where there are too many.
    fn collect(&mut self, rows: &Rows, reach: IVec3) -> bool {
        let size = (2 * reach + 1).as_uvec3();
        let at = |y: usize, z: usize| {
            let row = rows.get(z).and_then(|layer| layer.get(y));
            row.copied().unwrap_or(0)
        };
        for z in 0..size.z as usize {
            for y in 0..size.y as usize {
                let row = at(y, z);
                if row == 0 {
                    continue;
                }
                // what is within the solid cannot be met first
                let along_y = at(y.wrapping_sub(1), z) & at(y + 1, z);
                let along_z = at(y, z.wrapping_sub(1)) & at(y, z + 1);
                let mut left = row & !(row << 1 & row >> 1 & along_y & along_z);
                while left != 0 {
                    let first = left.trailing_zeros();
                    let last = first + (left >> first).trailing_ones();
                    left &= u32::MAX.checked_shl(last).unwrap_or(0);
                    let Some(run) = self.runs.get_mut(self.count) else {
                        return false;
                    };
                    *run = [first as u8, last as u8, y as u8, z as u8];
                    self.count += 1;
                }
            }
        }
        true
    }

    #[inline]
    fn box_of(&self, run: Run) -> Box {
        let [first, last, y, z] = run.map(|plane| usize::from(plane & 31));
        let [along_x, along_y, along_z] = &self.planes;
        Box {
            low: DVec3::new(along_x[first], along_y[y], along_z[z]),
            high: DVec3::new(along_x[last], along_y[(y + 1) & 31], along_z[(z + 1) & 31]),
        }
    }

    /// From the start toward `goal`, along what is met, without leaving the room.
    fn slide(&self, goal: DVec3, radius: f64, room: &Box) -> DVec3 {
        let mut point = DVec3::ZERO;
        let mut planes = Planes::default();
        for number in 1..=MOVES {
            let way = planes.allowed(goal - point);
            if way.length_squared() < SHORTEST * SHORTEST {
                break;
            }
            let way = way * room.share_within(point, way);
            let cast = self.cast(point, way, radius - SLACK * number as f64);
            point += way * cast.fraction;
            match cast.normal {
                Some(normal) if planes.add(normal) => {}
                _ => break,
            }
        }
        point
    }

    /// How far a ball gets along a way.
    fn cast(&self, from: DVec3, way: DVec3, radius: f64) -> Cast {
        let length = way.length();
        let mut cast = Cast {
            fraction: 1.0,
            normal: None,
        };
        for &run in self.runs.iter().take(self.count) {
            // too far to be met before the nearest so far
            let solid = self.box_of(run);
            let limit = radius + length * cast.fraction;
            if solid.to(from).length_squared() < limit * limit {
                cast.meet(&solid, from, way, radius);
            }
        }
        cast
    }
}

/// The end of a move.
struct Cast {
    /// Share of the way.
    fraction: f64,
    /// Of what is met there, away from it.
    normal: Option<DVec3>,
}

impl Cast {
    /// Shortens the move to where the ball meets a box, if it does.
    fn meet(&mut self, solid: &Box, from: DVec3, way: DVec3, radius: f64) {
        let mut fraction = 0.0;
        let mut normal = DVec3::ZERO;
        for _ in 0..NEWTON {
            let away = solid.to(from + way * fraction);
            let distance = away.length();
            let approach = -away.dot(way);
            if approach <= 0.0 {
                return;
            }
            normal = away / distance;
            let gap = distance - radius;
            if gap <= SLACK * 0.1 {
                break;
            }
            // gap / speed of the approach
            fraction += gap * distance / approach;
            if fraction >= self.fraction {
                return;
            }
        }
        self.fraction = fraction;
        self.normal = Some(normal);
    }
}

/// What the ball touches: it moves into none of these planes.
#[derive(Default)]
struct Planes {
    normals: [DVec3; 3],
    count: usize,
}

impl Planes {
    /// False where there are three already.
    fn add(&mut self, normal: DVec3) -> bool {
        let place = self.normals.get_mut(self.count);
        self.count += 1;
        place.map(|place| *place = normal).is_some()
    }

    /// The part of a way that leads into no plane and ends nearest to its end.
    fn allowed(&self, way: DVec3) -> DVec3 {
        let normals = self.normals.get(..self.count).unwrap_or_default();
        let mut best = DVec3::ZERO;
        let mut try_way = |tried: DVec3| {
            let limit = -1e-12 * tried.length();
            let legal = normals.iter().all(|normal| normal.dot(tried) >= limit);
            if legal && tried.dot(way) > best.dot(way) {
                best = tried;
            }
        };
        try_way(way);
        for (index, &normal) in normals.iter().enumerate() {
            try_way(way - normal * normal.dot(way));
            for &other in &normals[..index] {
                let along = normal.cross(other).normalize_or_zero();
                try_way(along * along.dot(way));
            }
        }
        best
    }
}
