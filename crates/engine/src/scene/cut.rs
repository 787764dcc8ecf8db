//! Parts a segment by a plane, or along a line that was painted on the picture. Frame: the scan,
//! before the segment's pose; mm.

use glam::{DAffine3, DVec2, DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;

/// Points of a painted line, at most: work is bounded by them and by the voxels.
pub const MOST_POINTS: usize = 1000;

/// A plane in the scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of it [mm].
    pub point: DVec3,
    /// Out of it, of any length but zero.
    pub normal: DVec3,
}

impl Plane {
    /// The plane of the scene in the scan of a segment that stands at a pose; none where it has
    /// no direction or no place.
    #[must_use]
    pub fn in_scan(point: DVec3, normal: DVec3, pose: &DAffine3) -> Option<Self> {
        if !point.is_finite() {
            return None;
        }
        let normal = unit(normal)?;
        Some(Self {
            point: pose.inverse().transform_point3(point),
            normal: pose.matrix3.transpose() * normal,
        })
    }

    /// The voxels of a segment on a grid whose middles lie behind the plane, and those before it.
    #[must_use]
    pub fn part(&self, segment: &Segment, grid: &Grid) -> (Segment, Segment) {
        // (middle - point) · normal, as a sum along the voxel's axes
        let axes = grid.patient_from_grid().matrix3.transpose() * self.normal;
        let start = grid.patient_from_grid().transform_point3(DVec3::splat(0.5)) - self.point;
        let level = start.dot(self.normal);
        let side = |before: bool| {
            segment.part(|voxel| (axes.dot(voxel.as_dvec3()) + level > 0.0) == before)
        };
        (side(false), side(true))
    }
}

/// A line on the picture of an eye, as it is painted: points of the scene that lie under it.
#[derive(Clone, Debug, PartialEq)]
pub struct Painted {
    /// Where the eye is [mm].
    pub eye: DVec3,
    /// Where it looks, of any length but zero.
    pub view: DVec3,
    /// Points before the eye, at any distance [mm].
    pub line: Vec<DVec3>,
    /// Whether its end is joined to its beginning; else both go on straight without end.
    pub closed: bool,
}

/// A painted line as what it parts the space before the eye by: it is extruded away from the eye.
///
/// Two points are on different sides where a ray of the picture between the one and far away
/// crosses the line oftener by an odd number than that of the other (even-odd rule). An open line
/// goes on straight at its ends, and the rays run parallel to neither of them; so a line that does
/// not cross itself has two sides.
#[derive(Clone, Debug, PartialEq)]
pub struct LineCut {
    eye: DVec3,
    /// Rows: along the rays of the picture, across them, away from the eye.
    axes: [DVec3; 3],
    /// Ends of the line's pieces along and across the rays.
    pieces: Vec<[DVec2; 2]>,
}

impl LineCut {
    /// The painted line in the scan of a segment that stands at a pose; none where it has fewer
    /// than two places, more than [`MOST_POINTS`] points, or some that are not before the eye.
    #[must_use]
    pub fn in_scan(painted: &Painted, pose: &DAffine3) -> Option<Self> {
        if painted.line.len() > MOST_POINTS || !painted.eye.is_finite() {
            return None;
        }
        let away = unit(painted.view)?;
        let (right, up) = away.any_orthonormal_pair();
        let flat = |point: &DVec3| in_picture(*point - painted.eye, [right, up, away]);
        let mut points: Vec<DVec2> = painted.line.iter().map(flat).collect::<Option<_>>()?;
        points.dedup();
        let along = if painted.closed {
            points.push(*points.first()?);
            DVec2::X
        } else {
            let [first, .., last] = points[..] else {
                return None;
            };
            let [first_end, last_end] = ends(&points)?;
            points.insert(0, first + first_end);
            points.push(last + last_end);
            across_both(first_end, last_end)
        };
        if points.len() < 3 {
            return None;
        }

        // turned so that rays run along the first axis
        let turn = |point: DVec2| DVec2::new(point.dot(along), along.perp_dot(point));
        let scan_from_scene = pose.inverse();
        let axis = |direction: DVec3| scan_from_scene.transform_vector3(direction);
        Some(Self {
            eye: scan_from_scene.transform_point3(painted.eye),
            axes: [
                axis(right * along.x + up * along.y),
                axis(up * along.x - right * along.y),
                axis(away),
            ],
            pieces: points
                .windows(2)
                .map(|pair| [turn(pair[0]), turn(pair[1])])
                .collect(),
        })
    }

    /// The larger part of a segment on a grid, and the smaller one.
    #[must_use]
    pub fn part(&self, segment: &Segment, grid: &Grid) -> (Segment, Segment) {
        let patient_from_grid = grid.patient_from_grid();
        let odd = segment.part(|voxel: IVec3| {
            let middle = patient_from_grid.transform_point3(voxel.as_dvec3() + 0.5);
            self.is_odd(middle)
        });
        let even = segment.part(|voxel| !odd.contains(voxel));
        if odd.count() > even.count() {
            (odd, even)
        } else {
            (even, odd)
        }
    }

    /// Whether the ray from a point crosses the line an odd number of times; never behind the eye.
    fn is_odd(&self, point: DVec3) -> bool {
        let Some(point) = in_picture(point - self.eye, self.axes) else {
            return false;
        };
        let crosses = |[from, to]: &&[DVec2; 2]| {
            // half-open, so that a corner counts once
            if (from.y > point.y) == (to.y > point.y) {
                return false;
            }
            let share = (point.y - from.y) / (to.y - from.y);
            from.x + share * (to.x - from.x) > point.x
        };
        self.pieces.iter().filter(crosses).count() % 2 == 1
    }
}

/// Where a point stands in the picture of an eye, at distance 1; none behind the eye.
fn in_picture(from_eye: DVec3, [right, up, away]: [DVec3; 3]) -> Option<DVec2> {
    let depth = from_eye.dot(away);
    let place = DVec2::new(from_eye.dot(right), from_eye.dot(up)) / depth;
    (depth > 0.0 && place.is_finite()).then_some(place)
}

/// How far the picture reaches: a line that goes on so far has no end in it.
const FAR: f64 = 1e6;

/// Ways from both ends of a line onward, straight and far; none where all is one place.
fn ends(points: &[DVec2]) -> Option<[DVec2; 2]> {
    let onward = |end: DVec2, before: DVec2| (end - before).try_normalize().map(|way| way * FAR);
    let [first, second, ..] = *points else {
        return None;
    };
    let [.., before, last] = *points else {
        return None;
    };
    Some([onward(first, second)?, onward(last, before)?])
}

/// The direction that is the least parallel to two others.
fn across_both(one: DVec2, other: DVec2) -> DVec2 {
    const CHOICES: u32 = 16;
    let directions = (0..CHOICES).map(|step| {
        let angle = std::f64::consts::PI * f64::from(step) / f64::from(CHOICES);
        DVec2::from_angle(angle)
    });
    let apart = |direction: &DVec2| {
        let sine = |way: DVec2| way.perp_dot(*direction).abs();
        sine(one).min(sine(other))
    };
    directions
        .max_by(|a, b| apart(a).total_cmp(&apart(b)))
        .unwrap_or(DVec2::X)
}

/// A direction of length 1; none where it is none.
fn unit(direction: DVec3) -> Option<DVec3> {
    if !direction.is_finite() {
        return None;
    }
    // by the largest component first, so that no square over- or underflows
    (direction / direction.abs().max_element()).try_normalize()
}
