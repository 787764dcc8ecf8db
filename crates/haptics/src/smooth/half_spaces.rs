//! The point nearest to another on the free side of up to three planes.
//!
//! Frame: any with axes in mm.

use glam::{DMat2, DMat3, DVec2, DVec3};

/// The free side of a plane: all points x with x·outward >= offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfSpace {
    /// Outward normal of length 1.
    pub(crate) outward: DVec3,
    /// Distance of the plane from the origin along it [mm].
    pub(crate) offset: f64,
}

impl HalfSpace {
    /// Depth of a point under the plane [mm]; negative where it is free.
    fn depth(&self, point: DVec3) -> f64 {
        self.offset - point.dot(self.outward)
    }
}

/// How far under a plane a point may be and still count as free [mm]; rounding.
const SLACK: f64 = 1e-7;
/// Planes count as parallel where the volume between their normals is less.
const PARALLEL: f64 = 1e-6;

/// The nearest point to `target` in all half-spaces; where there is none, as with two that
/// face each other, on the plane that `target` is deepest under.
pub(crate) fn nearest(planes: &[HalfSpace], target: DVec3) -> DVec3 {
    let is_free = |point: DVec3| planes.iter().all(|plane| plane.depth(point) <= SLACK);
    if is_free(target) {
        return target;
    }

    // on one plane, on the line of two, in the corner of three: the nearest that is free
    let mut best: Option<DVec3> = None;
    let mut offer = |point: Option<DVec3>| {
        let Some(point) = point.filter(|point| is_free(*point)) else {
            return;
        };
        let nearer =
            |best: DVec3| (point - target).length_squared() < (best - target).length_squared();
        if best.is_none_or(nearer) {
            best = Some(point);
        }
    };
    for (number, first) in planes.iter().enumerate() {
        offer(Some(target + first.outward * first.depth(target)));
        for (other, second) in planes.iter().enumerate().skip(number + 1) {
            offer(on_line(first, second, target));
            for third in planes.iter().skip(other + 1) {
                offer(in_corner(first, second, third));
            }
        }
    }
    best.unwrap_or_else(|| {
        let deepest = planes
            .iter()
            .max_by(|a, b| a.depth(target).total_cmp(&b.depth(target)));
        deepest.map_or(target, |plane| target + plane.outward * plane.depth(target))
    })
}

/// The foot of `target` on the line that two planes share.
fn on_line(first: &HalfSpace, second: &HalfSpace, target: DVec3) -> Option<DVec3> {
    let cosine = first.outward.dot(second.outward);
    let gram = DMat2::from_cols(DVec2::new(1.0, cosine), DVec2::new(cosine, 1.0));
    if gram.determinant() < PARALLEL {
        return None;
    }
    let depths = DVec2::new(first.depth(target), second.depth(target));
    let shares = gram.inverse() * depths;
    // a plane that would have to pull is not touched
    let pushes = shares.cmpge(DVec2::ZERO).all();
    pushes.then(|| target + first.outward * shares.x + second.outward * shares.y)
}

/// The point that three planes share.
fn in_corner(first: &HalfSpace, second: &HalfSpace, third: &HalfSpace) -> Option<DVec3> {
    let rows = DMat3::from_cols(first.outward, second.outward, third.outward).transpose();
    if rows.determinant().abs() < PARALLEL {
        return None;
    }
    Some(rows.inverse() * DVec3::new(first.offset, second.offset, third.offset))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_direction(random: &mut oorandom::Rand64) -> DVec3 {
        loop {
            let point = DVec3::from_array([(); 3].map(|()| 2.0 * random.rand_float() - 1.0));
            if (0.01..1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }

    /// The same by going to one plane after the other (Dykstra), which converges to it.
    fn by_dykstra(planes: &[HalfSpace], target: DVec3) -> DVec3 {
        let mut at = target;
        let mut kept = [DVec3::ZERO; 3];
        for _ in 0..20_000 {
            for (plane, kept) in planes.iter().zip(&mut kept) {
                let from = at + *kept;
                at = from + plane.outward * plane.depth(from).max(0.0);
                *kept = from - at;
            }
        }
        at
    }

    #[test]
    fn the_nearest_free_point_is_that_of_an_iteration_known_to_converge() {
        let mut random = oorandom::Rand64::new(5);
        let mut corners = 0;
        for _ in 0..300 {
            let planes: [HalfSpace; 3] = std::array::from_fn(|_| HalfSpace {
                outward: random_direction(&mut random),
                offset: random.rand_float() - 0.3,
            });
            // the iteration is slow between planes that nearly face each other, or share a line
            let opposed = |a: &HalfSpace, b: &HalfSpace| a.outward.dot(b.outward) < -0.8;
            let [a, b, c] = &planes;
            let volume = a.outward.cross(b.outward).dot(c.outward);
            if opposed(a, b) || opposed(b, c) || opposed(c, a) || volume.abs() < 0.1 {
                continue;
            }
            for count in 0..=3 {
                let planes = &planes[..count];
                let target = random_direction(&mut random) * 2.0 * random.rand_float();
                let found = nearest(planes, target);
                let expected = by_dykstra(planes, target);
                // 1e-4: what the iteration leaves after its steps
                assert!((found - expected).length() < 1e-4, "{planes:?} {target}");
                let touched = planes.iter().filter(|plane| plane.depth(found) > -1e-9);
                corners += usize::from(touched.count() == 3);
            }
        }
        assert!(corners > 5, "no corner was ever met");
    }

    #[test]
    fn between_walls_that_leave_no_room_the_deeper_one_counts() {
        let wall = |outward: DVec3, offset: f64| HalfSpace { outward, offset };
        let planes = [wall(DVec3::X, 1.0), wall(DVec3::NEG_X, 1.0)];
        assert_eq!(nearest(&planes, DVec3::new(0.5, 2.0, 0.0)).x, -1.0);
    }
}
