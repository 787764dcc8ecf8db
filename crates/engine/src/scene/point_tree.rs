//! Nearest of many points: a balanced k-d tree in one array.
//!
//! Memory: the middle of each range is its node, what lies lower on the node's axis stands before
//! it. Ranges are parted at their median place, so that points with the same coordinate, of which
//! surfaces of voxels have thousands, cost no more than others. Points in mm, any frame.
//! Source: Bentley, "Multidimensional binary search trees used for associative searching",
//! Communications of the ACM 18 (1975).

use glam::DVec3;

/// A tree of points.
#[derive(Clone, Debug, Default)]
pub struct PointTree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    point: DVec3,
    /// Its place among the points that were given.
    place: u32,
    axis: u8,
}

impl PointTree {
    /// A tree of these points; their places tell them apart.
    #[must_use]
    pub fn new(points: impl Iterator<Item = DVec3>) -> Self {
        let mut nodes: Vec<Node> = (0..)
            .zip(points)
            .map(|(place, point)| Node {
                point,
                place,
                axis: 0,
            })
            .collect();
        part(&mut nodes);
        Self { nodes }
    }

    /// The point nearest to another one and its squared distance, where that is below `limit`.
    #[must_use]
    pub fn nearest(&self, to: DVec3, limit: f64) -> Option<(u32, f64)> {
        let mut best = (u32::MAX, limit);
        search(&self.nodes, to, &mut best);
        (best.0 != u32::MAX).then_some(best)
    }
}

fn part(nodes: &mut [Node]) {
    if nodes.len() < 2 {
        return;
    }
    let ends = |bound: fn(DVec3, DVec3) -> DVec3| {
        let points = nodes.iter().map(|node| node.point);
        points.reduce(bound).unwrap_or_default()
    };
    let size = ends(DVec3::max) - ends(DVec3::min);
    let axis = size.max_position();
    let middle = nodes.len() / 2;
    nodes.select_nth_unstable_by(middle, |a, b| a.point[axis].total_cmp(&b.point[axis]));
    nodes[middle].axis = axis as u8;
    let (low, high) = nodes.split_at_mut(middle);
    part(low);
    part(&mut high[1..]);
}

fn search(nodes: &[Node], to: DVec3, best: &mut (u32, f64)) {
    let Some(node) = nodes.get(nodes.len() / 2) else {
        return;
    };
    let (low, high) = nodes.split_at(nodes.len() / 2);
    let squared = node.point.distance_squared(to);
    if squared < best.1 {
        *best = (node.place, squared);
    }
    let ahead = to[usize::from(node.axis)] - node.point[usize::from(node.axis)];
    let (near, far) = if ahead < 0.0 {
        (low, &high[1..])
    } else {
        (&high[1..], low)
    };
    search(near, to, best);
    if ahead * ahead < best.1 {
        search(far, to, best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_of_stacked_points_is_that_of_a_search_through_all() {
        // a lattice: many points share each coordinate, and many distances are the same
        let points: Vec<DVec3> = (0..9 * 7 * 5)
            .map(|i| DVec3::new(f64::from(i % 9), f64::from(i / 9 % 7), f64::from(i / 63)))
            .collect();
        let tree = PointTree::new(points.iter().copied());
        for step in 0..500 {
            let turn = f64::from(step) * 0.7;
            let to = DVec3::new(9.0 * turn.sin(), 8.0 * turn.cos(), 6.0 * (1.3 * turn).sin());
            let least = points.iter().map(|point| point.distance_squared(to));
            let least = least.fold(f64::INFINITY, f64::min);
            let (place, squared) = tree.nearest(to, f64::INFINITY).expect("some points");
            assert_eq!(squared, least);
            assert_eq!(points[place as usize].distance_squared(to), least);
            assert_eq!(
                tree.nearest(to, least),
                None,
                "none is nearer than the nearest"
            );
        }
        assert_eq!(PointTree::default().nearest(DVec3::ZERO, 1.0), None);
    }
}
