//! Signed distances of simple shapes, and curves given by a few points.
//!
//! Distances [mm] are negative inside and exact to first order near the surface, which is
//! what partial volumes need; far away they only tell near from far.
//!
//! Sources: Inigo Quilez, "Distance functions" (2008–2023), for ellipsoid, capsule and
//! polygon; Fritsch & Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer.
//! Anal. 17 (1980), for the curves.

use glam::{Vec2, Vec3};

/// Distance to a sphere.
pub(super) fn sphere(point: Vec3, centre: impl Into<Vec3>, radius: f32) -> f32 {
    point.distance(centre.into()) - radius
}

/// Distance to an ellipsoid with axes along x, y, z.
pub(super) fn ellipsoid(point: Vec3, centre: impl Into<Vec3>, radii: impl Into<Vec3>) -> f32 {
    let radii = radii.into();
    let unit = (point - centre.into()) / radii;
    let share = unit.length();
    let slope = (unit / radii).length();
    if slope == 0.0 {
        return -radii.min_element();
    }
    share * (share - 1.0) / slope
}

/// Distance to an ellipse with axes along x and y, centred at 0.
pub(super) fn ellipse(point: Vec2, radii: Vec2) -> f32 {
    let unit = point / radii;
    let share = unit.length();
    let slope = (unit / radii).length();
    if slope == 0.0 {
        return -radii.min_element();
    }
    share * (share - 1.0) / slope
}

/// Distance to a straight rod with round ends, whose radius changes from `start` to `end`.
pub(super) fn rod(
    point: Vec3,
    start: impl Into<Vec3>,
    end: impl Into<Vec3>,
    start_radius: f32,
    end_radius: f32,
) -> f32 {
    let (start, end) = (start.into(), end.into());
    let along = end - start;
    let share = ((point - start).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let radius = start_radius + (end_radius - start_radius) * share;
    point.distance(start + along * share) - radius
}

/// Distance to a chain of rods of one radius.
pub(super) fn chain(point: Vec3, joints: &[[f32; 3]], radius: f32) -> f32 {
    joints
        .windows(2)
        .map(|pair| rod(point, pair[0], pair[1], radius, radius))
        .fold(f32::INFINITY, f32::min)
}

/// Distance to a closed polygon in the plane.
pub(super) fn polygon(point: Vec2, corners: &[[f32; 2]]) -> f32 {
    let mut squared = f32::INFINITY;
    let mut inside = false;
    let mut previous = Vec2::from(corners[corners.len() - 1]);
    for &corner in corners {
        let corner = Vec2::from(corner);

        // nearest point of this edge
        let edge = previous - corner;
        let to_point = point - corner;
        let share = (to_point.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        squared = squared.min((to_point - edge * share).length_squared());

        // a ray to the right changes sides at each edge that it meets
        if (corner.y > point.y) != (previous.y > point.y) {
            let meets = corner.x + edge.x * (point.y - corner.y) / edge.y;
            inside ^= point.x < meets;
        }
        previous = corner;
    }
    let distance = squared.sqrt();
    if inside { -distance } else { distance }
}

/// Union whose seam is rounded over `width` [mm].
pub(super) fn blend(a: f32, b: f32, width: f32) -> f32 {
    let near = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - near * near * width * 0.25
}

/// Intersection whose edge is rounded over `width` [mm].
pub(super) fn cut(a: f32, b: f32, width: f32) -> f32 {
    -blend(-a, -b, width)
}

/// A smooth curve through a few points, sampled once so that reading it is cheap.
pub(super) struct Curve {
    start: f32,
    samples: Vec<f32>,
}

impl Curve {
    /// Samples per mm of the argument.
    const DENSITY: f32 = 1.0;

    /// Curve through (argument, value) points in descending order of the argument, constant
    /// beyond them and without overshoot between them.
    pub(super) fn through(points: &[(f32, f32)]) -> Self {
        let start = points[points.len() - 1].0;
        let count = ((points[0].0 - start) * Self::DENSITY).ceil() as usize + 1;
        let ascending: Vec<(f32, f32)> = points.iter().rev().copied().collect();
        let samples = (0..count)
            .map(|i| interpolate(&ascending, start + i as f32 / Self::DENSITY))
            .collect();
        Self { start, samples }
    }

    /// Value at an argument.
    pub(super) fn at(&self, argument: f32) -> f32 {
        self.with_slope(argument).0
    }

    /// Value and slope at an argument.
    pub(super) fn with_slope(&self, argument: f32) -> (f32, f32) {
        let last = self.samples.len() - 1;
        let position = ((argument - self.start) * Self::DENSITY).clamp(0.0, last as f32);
        let below = (position as usize).min(last - 1);
        let step = self.samples[below + 1] - self.samples[below];
        let value = self.samples[below] + step * (position - below as f32);
        (value, step * Self::DENSITY)
    }
}

/// Monotone cubic interpolation (Fritsch & Carlson 1980) in ascending points.
fn interpolate(points: &[(f32, f32)], argument: f32) -> f32 {
    let last = points.len() - 1;
    let argument = argument.clamp(points[0].0, points[last].0);
    let right = points
        .partition_point(|point| point.0 < argument)
        .clamp(1, last);
    let (x0, y0) = points[right - 1];
    let (x1, y1) = points[right];
    let width = x1 - x0;
    let t = (argument - x0) / width;
    let (m0, m1) = (
        tangent(points, right - 1) * width,
        tangent(points, right) * width,
    );

    let (t2, t3) = (t * t, t * t * t);
    y0 * (2.0 * t3 - 3.0 * t2 + 1.0)
        + m0 * (t3 - 2.0 * t2 + t)
        + y1 * (3.0 * t2 - 2.0 * t3)
        + m1 * (t3 - t2)
}

/// Slope at a point: the harmonic mean of its neighbours', 0 at a turn or an end.
fn tangent(points: &[(f32, f32)], index: usize) -> f32 {
    if index == 0 || index == points.len() - 1 {
        return 0.0;
    }
    let slope = |i: usize| (points[i + 1].1 - points[i].1) / (points[i + 1].0 - points[i].0);
    let (left, right) = (slope(index - 1), slope(index));
    if left * right <= 0.0 {
        0.0
    } else {
        2.0 * left * right / (left + right)
    }
}

/// An upright tube whose cross-section, an ellipse squared off a little, changes with height.
pub(super) struct Tube {
    /// Half width along x at each height [mm].
    half_width: Curve,
    /// Half depth along y at each height [mm].
    half_depth: Curve,
    /// y of the centre at each height [mm].
    centre: Curve,
    /// How square the cross-section is, 0 (ellipse) to 1.
    squareness: f32,
}

impl Tube {
    /// Tube through cross-sections (z, half width, half depth, y of the centre), from above
    /// downward.
    pub(super) fn through(sections: &[(f32, f32, f32, f32)], squareness: f32) -> Self {
        let curve = |pick: fn(&(f32, f32, f32, f32)) -> f32| {
            Curve::through(&sections.iter().map(|s| (s.0, pick(s))).collect::<Vec<_>>())
        };
        Self {
            half_width: curve(|s| s.1),
            half_depth: curve(|s| s.2),
            centre: curve(|s| s.3),
            squareness,
        }
    }

    /// Point in the cross-section at its height: distance [mm] to the wall, and the angle
    /// around the tube [rad], 0 at the back, ±π in front, positive on the patient's left.
    pub(super) fn locate(&self, point: Vec3) -> (f32, f32) {
        let (width, width_slope) = self.half_width.with_slope(point.z);
        let (depth, depth_slope) = self.half_depth.with_slope(point.z);
        let (centre, centre_slope) = self.centre.with_slope(point.z);
        let x = point.x / width;
        let y = (point.y - centre) / depth;

        // level 1 is the wall: x² + y² - s x² y² = level²; far outside an ellipse will do
        let square = self.squareness * (2.0 - x * x - y * y).clamp(0.0, 1.0);
        let level = (x * x + y * y - square * x * x * y * y).max(1e-6).sqrt();
        let by_x = x * (1.0 - square * y * y);
        let by_y = y * (1.0 - square * x * x);
        let slope = Vec3::new(
            by_x / width,
            by_y / depth,
            -by_x * x * width_slope / width - by_y * (y * depth_slope + centre_slope) / depth,
        );
        let distance = (level - 1.0) * level / slope.length().max(1e-6);
        (distance, x.atan2(y))
    }

    /// Half width [mm] at a height.
    pub(super) fn half_width_at(&self, z: f32) -> f32 {
        self.half_width.at(z)
    }

    /// y [mm] of the wall at the back, at a place across the tube and a height.
    pub(super) fn back(&self, x: f32, z: f32) -> f32 {
        let share = (x / self.half_width.at(z)).min(1.0);
        self.centre.at(z) + self.half_depth.at(z) * (1.0 - share * share).sqrt()
    }

    /// Distance [mm] to the wall.
    pub(super) fn distance(&self, point: Vec3) -> f32 {
        self.locate(point).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_points(count: usize, size: f32) -> impl Iterator<Item = Vec3> {
        let mut random = oorandom::Rand32::new(5);
        let mut coordinate = move || (random.rand_float() - 0.5) * size;
        (0..count).map(move |_| Vec3::new(coordinate(), coordinate(), coordinate()))
    }

    /// Near the surface a distance must be one: its slope is 1, within the share given.
    fn assert_is_distance(shape: impl Fn(Vec3) -> f32, tolerance: f32) {
        let step = 0.05;
        let mut checked = 0;
        for point in random_points(20_000, 60.0) {
            if shape(point).abs() > 1.0 {
                continue;
            }
            let along = |axis: Vec3| (shape(point + axis) - shape(point - axis)) / (2.0 * step);
            let slope = Vec3::new(
                along(Vec3::X * step),
                along(Vec3::Y * step),
                along(Vec3::Z * step),
            );
            let length = slope.length();
            assert!((length - 1.0).abs() < tolerance, "{point}: slope {length}");
            checked += 1;
        }
        assert!(checked > 100, "{checked}");
    }

    #[test]
    fn shapes_measure_mm_at_their_surface() {
        // exact ones: rounding of f32 in a difference over 0.1 mm
        assert_is_distance(|p| sphere(p, [3.0, -2.0, 5.0], 20.0), 1e-2);
        assert_is_distance(
            |p| rod(p, [-15.0, 0.0, 3.0], [15.0, 4.0, 0.0], 8.0, 8.0),
            1e-2,
        );
        // first order ones: the error grows with the distance over the radius of curvature
        assert_is_distance(|p| ellipsoid(p, [0.0; 3], [25.0, 15.0, 20.0]), 0.2);
        let tube = Tube::through(&[(40.0, 15.0, 12.0, 2.0), (-40.0, 22.0, 16.0, -2.0)], 0.3);
        assert_is_distance(|p| tube.distance(p), 0.2);
    }

    #[test]
    fn a_polygon_is_negative_inside_and_measures_to_its_nearest_edge() {
        let corner = [
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 4.0],
            [4.0, 4.0],
            [4.0, 10.0],
            [0.0, 10.0],
        ];
        for (point, distance) in [
            ((2.0, 2.0), -2.0),
            ((5.0, 2.0), -2.0),
            ((5.0, 5.0), 1.0),
            ((7.0, 7.0), 3.0),
            ((-3.0, 5.0), 3.0),
            ((13.0, -4.0), 5.0),
        ] {
            let measured = polygon(point.into(), &corner);
            assert!((measured - distance).abs() < 1e-5, "{point:?}: {measured}");
        }
    }

    #[test]
    fn blends_round_seams_and_leave_the_rest() {
        assert_eq!(blend(1.0, 9.0, 5.0), 1.0);
        assert_eq!(blend(2.0, 2.0, 8.0), 0.0);
        assert_eq!(cut(1.0, 9.0, 5.0), 9.0);
        assert_eq!(cut(2.0, 2.0, 8.0), 4.0);
    }

    #[test]
    fn curves_meet_their_points_and_never_overshoot() {
        let points = [(20.0, 1.0), (10.0, 5.0), (7.0, 5.0), (-4.0, 2.0)];
        let curve = Curve::through(&points);
        for (argument, value) in points {
            assert!((curve.at(argument) - value).abs() < 1e-4, "{argument}");
        }
        for i in -100..300 {
            let value = curve.at(i as f32 / 10.0);
            assert!((1.0..=5.0).contains(&value), "{i}: {value}");
        }
        assert_eq!(curve.at(99.0), 1.0);
        assert_eq!(curve.at(-99.0), 2.0);
    }

    #[test]
    fn the_angle_around_a_tube_starts_at_the_back_and_grows_to_the_left() {
        let tube = Tube::through(&[(10.0, 20.0, 10.0, 3.0), (-10.0, 20.0, 10.0, 3.0)], 0.0);
        let angle = |x: f32, y: f32| tube.locate(Vec3::new(x, y, 0.0)).1;
        assert!(angle(0.0, 13.0).abs() < 1e-6);
        assert!((angle(20.0, 3.0) - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!((angle(-20.0, 3.0) + std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!((tube.back(0.0, 0.0) - 13.0).abs() < 1e-5);
        assert!(tube.distance(Vec3::new(20.0, 3.0, 0.0)).abs() < 1e-5);
    }
}
