//! Bodies with an exact surface: how far a point is inside, and which surface point is nearest.
//!
//! Frame: scene [mm]; shapes are described in a frame of their own that is turned and moved.

use glam::{DMat3, DVec2, DVec3, IVec3};
use palpate_volume::grid::Grid;

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
        self.distance(point) < 0.0
    }

    /// How far away the surface is [mm]: negative inside.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        self.nearest(self.in_own_frame(point)).distance
    }

    /// The surface point nearest to a point.
    #[must_use]
    pub fn foot(&self, point: DVec3) -> Foot {
        self.foot_of_ball(point, 0.0)
    }

    /// The point nearest to a ball's middle of the surface that middles of such balls [mm] cannot
    /// cross: that of the body dilated by the ball. Exact where no other part of the surface
    /// comes as near.
    #[must_use]
    pub fn foot_of_ball(&self, point: DVec3, radius: f64) -> Foot {
        let nearest = self.nearest(self.in_own_frame(point));
        let foot = nearest.foot;
        let edges = match &self.shape {
            Shape::Profile(points) => &points[1..points.len() - 1],
            _ => &[],
        };
        let to_edge = edges
            .iter()
            .map(|edge| DVec3::new(edge.x - foot.x, 0.0, edge.y - foot.z))
            .min_by(|a, b| a.length().total_cmp(&b.length()));
        Foot {
            point: self.in_scene(foot + nearest.outward * radius),
            distance: nearest.distance - radius,
            to_edge: to_edge.map(|way| self.turn * way),
        }
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

    /// The nearest point of the surface, in the frame of the shape.
    fn nearest(&self, point: DVec3) -> Nearest {
        let round = |middle: DVec3, radius: f64, sign: f64| {
            let out = point - middle;
            // in the very middle every direction is as good
            let direction = out.try_normalize().unwrap_or(DVec3::X);
            Nearest {
                foot: middle + direction * radius,
                distance: sign * (out.length() - radius),
                outward: direction * sign,
            }
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

/// The nearest point of a surface, in the frame of the shape.
struct Nearest {
    foot: DVec3,
    /// How far away [mm]: negative inside.
    distance: f64,
    /// Out of the body there, of length 1.
    outward: DVec3,
}

/// Nearer to a profile than this [mm] the way to it is rounding.
const ON_PROFILE: f64 = 1e-9;

fn nearest_of_profile(points: &[DVec2], point: DVec3) -> Nearest {
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
        (piece[0] + way * along, way)
    });
    let (foot, way) = feet
        .min_by(|(a, _), (b, _)| a.distance(at).total_cmp(&b.distance(at)))
        .expect("a profile has two points or more");
    let sign = if is_below(points, at) { -1.0 } else { 1.0 };
    let distance = foot.distance(at);
    let outward = if distance > ON_PROFILE {
        (at - foot) / distance * sign
    } else {
        way.perp().normalize()
    };
    Nearest {
        foot: DVec3::new(foot.x, point.y, foot.y),
        distance: sign * distance,
        outward: DVec3::new(outward.x, 0.0, outward.y),
    }
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
