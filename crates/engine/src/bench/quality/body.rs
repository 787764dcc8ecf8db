//! Bodies with an exact surface: how far a point is inside, and which surface point is nearest.
//!
//! Frame: scene [mm]; shapes are described in a frame of their own that is turned and moved.

use glam::{DMat3, DVec2, DVec3, IVec3};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;

/// A shape around the origin of its own frame [mm].
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Everything below a line of points (x, z) by rising x, the same for every y; the first
    /// and the last piece go on for ever.
    Profile(Vec<DVec2>),
    /// A ball.
    Ball {
        /// Its radius.
        radius: f64,
    },
    /// A torus around z.
    Torus {
        /// From the middle to the middle of the tube.
        ring: f64,
        /// Radius of the tube.
        tube: f64,
    },
    /// An endless cylinder around y.
    Cylinder {
        /// Its radius.
        radius: f64,
    },
    /// All but an endless cylinder around y.
    Bore {
        /// Its radius.
        radius: f64,
    },
}

/// The point of a surface that is nearest to some point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// The point of the surface, scene.
    pub point: DVec3,
    /// How far away it is [mm]: negative inside the body.
    pub distance: f64,
    /// From the foot to the nearest edge of the body, straight, scene; none without edges.
    pub to_edge: Option<DVec3>,
}

/// A shape that stands in the scene, filled or as a shell.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// The shape in its own frame.
    pub shape: Shape,
    /// How it is turned.
    pub turn: DMat3,
    /// Where its origin stands, scene [mm].
    pub centre: DVec3,
    /// Where it is a shell: voxels from its outside to its inside, from face to face.
    pub shell: Option<i32>,
}

impl Body {
    /// Whether a point is inside the body, taken as filled.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let [at, _] = self.nearest(self.in_own_frame(point));
        at.z < 0.0
    }

    /// The surface point nearest to a point.
    #[must_use]
    pub fn foot(&self, point: DVec3) -> Foot {
        let own = self.in_own_frame(point);
        let [told, foot] = self.nearest(own);
        let edges = match &self.shape {
            Shape::Profile(points) => &points[1..points.len() - 1],
            _ => &[],
        };
        let to_edge = edges
            .iter()
            .map(|edge| DVec3::new(edge.x - foot.x, 0.0, edge.y - foot.z))
            .min_by(|a, b| a.length().total_cmp(&b.length()));
        Foot {
            point: self.in_scene(foot),
            distance: told.z,
            to_edge: to_edge.map(|way| self.turn * way),
        }
    }

    /// The voxels whose middle is inside; of a shell, those that few steps through faces lead
    /// out of, so that no way through faces crosses it.
    #[must_use]
    pub fn voxelised(&self, grid: &Grid) -> Bits {
        let inside = Segment::from_fn(grid.dimensions(), |voxel| self.holds_middle(grid, voxel));
        let Some(layers) = self.shell else {
            return inside.occupancy().clone();
        };
        let leads_out = |voxel: IVec3| {
            let near = -layers..=layers;
            let steps = |x: i32, y: i32, z: i32| x.abs() + y.abs() + z.abs();
            near.clone().any(|z| {
                near.clone().any(|y| {
                    near.clone().any(|x| {
                        steps(x, y, z) <= layers
                            && !self.holds_middle(grid, voxel + IVec3::new(x, y, z))
                    })
                })
            })
        };
        let shell = Segment::from_fn(grid.dimensions(), |voxel| {
            inside.contains(voxel) && leads_out(voxel)
        });
        shell.occupancy().clone()
    }

    /// Whether the middle of a voxel is inside the body, taken as filled.
    #[must_use]
    pub fn holds_middle(&self, grid: &Grid, voxel: IVec3) -> bool {
        let middle = voxel.as_dvec3() + 0.5;
        self.contains(grid.patient_from_grid().transform_point3(middle))
    }

    /// A point of the scene in the frame of the shape.
    #[must_use]
    pub fn in_own_frame(&self, point: DVec3) -> DVec3 {
        self.turn.transpose() * (point - self.centre)
    }

    /// A point of the shape's frame in the scene.
    #[must_use]
    pub fn in_scene(&self, own: DVec3) -> DVec3 {
        self.centre + self.turn * own
    }

    /// The signed distance (as z of the first) and the nearest point of the surface (second),
    /// both in the frame of the shape.
    fn nearest(&self, point: DVec3) -> [DVec3; 2] {
        let round = |middle: DVec3, radius: f64, sign: f64| {
            let out = point - middle;
            // in the very middle every direction is as good
            let direction = out.try_normalize().unwrap_or(DVec3::X);
            let distance = sign * (out.length() - radius);
            [DVec3::Z * distance, middle + direction * radius]
        };
        match &self.shape {
            Shape::Profile(points) => nearest_of_profile(points, point),
            Shape::Ball { radius } => round(DVec3::ZERO, *radius, 1.0),
            Shape::Torus { ring, tube } => {
                let flat = point.with_z(0.0).try_normalize().unwrap_or(DVec3::X);
                round(flat * *ring, *tube, 1.0)
            }
            Shape::Cylinder { radius } => round(DVec3::Y * point.y, *radius, 1.0),
            Shape::Bore { radius } => round(DVec3::Y * point.y, *radius, -1.0),
        }
    }
}

fn nearest_of_profile(points: &[DVec2], point: DVec3) -> [DVec3; 2] {
    let at = DVec2::new(point.x, point.z);
    let last = points.len() - 2;
    let pieces = points.windows(2).enumerate();
    let feet = pieces.map(|(number, piece)| {
        let way = piece[1] - piece[0];
        let mut along = (at - piece[0]).dot(way) / way.length_squared();
        if number > 0 {
            along = along.max(0.0);
        }
        if number < last {
            along = along.min(1.0);
        }
        piece[0] + way * along
    });
    let foot = feet
        .min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)))
        .expect("a profile has two points or more");
    let sign = if is_below(points, at) { -1.0 } else { 1.0 };
    let foot_in_3d = DVec3::new(foot.x, point.y, foot.y);
    [DVec3::Z * sign * foot.distance(at), foot_in_3d]
}

/// Whether a point is below the piece that stands over or under it.
fn is_below(points: &[DVec2], at: DVec2) -> bool {
    let end = points[1..points.len() - 1]
        .iter()
        .take_while(|point| point.x <= at.x)
        .count()
        + 1;
    let [from, to] = [points[end - 1], points[end]];
    (to - from).perp_dot(at - from) < 0.0
}
