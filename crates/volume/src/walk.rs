//! The voxels of a straight move, in order, from face to face.
//!
//! The numbers of steps along each axis are integers known before the first one, so the
//! walk ends exactly in the voxel of the end point, whatever the rounding; rounding only
//! decides the order of planes that are met within some 1e-16 of the move of one another.
//! Every voxel shares a face with the one before.
//!
//! Frame: grid; voxel (i, j, k) covers [i, i+1) on each axis, so a point on a plane belongs
//! to the voxel above it: a move down from a plane leaves that voxel at fraction 0, a move
//! up onto a plane enters the voxel above at fraction 1, a move down onto a plane stays
//! above it. Where a move meets an edge or a corner, x is stepped before y before z.
//! Source: Amanatides & Woo, "A fast voxel traversal algorithm for ray tracing",
//! Eurographics (1987); integer step counts instead of their exit test on t.

use glam::{DVec3, IVec3};

/// Farthest coordinate of a move [voxels]. Grids end long before it, and a move of this
/// length still takes less than a second.
pub const COORDINATE_LIMIT: f64 = 16_777_216.0;

/// A face of a voxel, by the axis across it and the side that it looks to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Face {
    /// 0, 1 or 2.
    pub axis: usize,
    /// Outward normal along the axis: 1 or -1; 0 for no face.
    pub sign: i32,
}

impl Face {
    /// Outward normal in the grid frame; zero for no face.
    pub fn normal(&self) -> IVec3 {
        let mut normal = IVec3::ZERO;
        normal[self.axis] = self.sign;
        normal
    }
}

/// A traversal: where it is and when it meets the next plane of each axis.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    x: Axis,
    y: Axis,
    z: Axis,
    /// Bits, as in [`Axis`].
    fraction: u64,
    /// The axis of the last step.
    axis: usize,
    steps_left: u32,
}

/// One axis of a traversal. Fractions are kept as the bits of numbers that are not
/// negative: these compare as integers do, which is quicker, and nothing beats [`NEVER`].
#[derive(Clone, Copy, Debug)]
struct Axis {
    voxel: i32,
    /// Fraction of the move at the next plane.
    next: u64,
    /// Fraction at the plane after that.
    following: u64,
    /// 1 or -1.
    step: i32,
    /// Offset from a voxel to the plane after the next: 2 or -1.
    to_following: i32,
    /// The voxel from which one step leads to that of the end point.
    last_but_one: i32,
    start: f64,
    /// Fraction of the move per voxel length.
    per_voxel: f64,
}

/// Fraction of a plane beyond the end point's voxel.
const NEVER: u64 = u64::MAX;

impl Walk {
    /// Stands in the first voxel of a move; none where a coordinate is not finite or
    /// beyond [`COORDINATE_LIMIT`].
    #[inline(always)]
    pub fn new(start: DVec3, end: DVec3) -> Option<Self> {
        // written so that NaN is refused
        let limit = DVec3::splat(COORDINATE_LIMIT);
        if !(start.abs().cmple(limit).all() && end.abs().cmple(limit).all()) {
            return None;
        }

        let (x, x_steps) = Axis::new(start.x, end.x);
        let (y, y_steps) = Axis::new(start.y, end.y);
        let (z, z_steps) = Axis::new(start.z, end.z);
        Some(Self {
            x,
            y,
            z,
            fraction: 0,
            axis: 0,
            steps_left: x_steps + y_steps + z_steps,
        })
    }

    /// The voxel that the walk is in.
    #[inline]
    pub fn voxel(&self) -> IVec3 {
        IVec3::new(self.x.voxel, self.y.voxel, self.z.voxel)
    }

    /// Share of the move before this voxel, 0..=1; it never falls.
    #[inline]
    pub fn fraction(&self) -> f64 {
        f64::from_bits(self.fraction.min(1.0_f64.to_bits()))
    }

    /// Share of the move until it leaves this voxel, 0..=1.
    #[inline]
    pub fn exit_fraction(&self) -> f64 {
        let next = self.x.next.min(self.y.next).min(self.z.next);
        f64::from_bits(next.min(1.0_f64.to_bits()))
    }

    /// Steps to the end point's voxel.
    #[inline]
    pub fn steps_left(&self) -> u32 {
        self.steps_left
    }

    /// The face of this voxel through which it came in. Before the first step there is none,
    /// and the answer has no meaning.
    #[inline]
    pub fn face(&self) -> Face {
        let step = match self.axis {
            0 => self.x.step,
            1 => self.y.step,
            _ => self.z.step,
        };
        Face {
            axis: self.axis,
            sign: -step,
        }
    }

    /// Enters the next voxel; false, and nothing done, at the end of the move.
    #[inline]
    pub fn advance(&mut self) -> bool {
        if self.steps_left == 0 {
            return false;
        }
        self.step();
        true
    }

    /// Enters the next voxel; steps must be left.
    #[inline]
    pub(crate) fn step(&mut self) {
        self.steps_left -= 1;

        // which axis is next is as good as random: choosing without branches halves the cost
        let [x, y, z] = [self.x.next, self.y.next, self.z.next];
        let x_first = (x <= y) & (x <= z);
        let y_first = !x_first & (y <= z);
        let z_first = !(x_first | y_first);
        self.axis = usize::from(y_first) | usize::from(z_first) << 1;
        self.fraction = x.min(y).min(z);
        self.x.step_if(x_first);
        self.y.step_if(y_first);
        self.z.step_if(z_first);
    }
}

impl Axis {
    /// An axis of a move within the limit, and its number of steps.
    #[inline]
    fn new(start: f64, end: f64) -> (Self, u32) {
        let [first, last] = [floor(start), floor(end)];
        let (up, steps) = (i32::from(last > first), first.abs_diff(last));
        let step = 2 * up - 1;
        let mut axis = Self {
            voxel: first,
            next: NEVER,
            following: NEVER,
            step,
            to_following: up + step,
            last_but_one: last - step,
            start,
            // finite, so that a plane met at once gives 0 even on the shortest move
            per_voxel: less((end - start).abs().recip(), f64::MAX),
        };
        if steps > 0 {
            axis.next = axis.fraction_at(first + up);
        }
        axis.following = axis.fraction_after_next();
        (axis, steps)
    }

    /// Fraction of the move at a plane.
    #[inline]
    fn fraction_at(&self, plane: i32) -> u64 {
        ((f64::from(plane) - self.start).abs() * self.per_voxel).to_bits()
    }

    /// Fraction at the plane after the next. Without a next one it has no meaning.
    #[inline]
    fn fraction_after_next(&self) -> u64 {
        let fraction = self.fraction_at(self.voxel + self.to_following);
        let ends = self.voxel == self.last_but_one;
        if ends { NEVER } else { fraction }
    }

    /// Crosses the next plane or stays.
    #[inline]
    fn step_if(&mut self, crossing: bool) {
        self.voxel += self.step * i32::from(crossing);
        self.next = if crossing { self.following } else { self.next };
        self.following = self.fraction_after_next();
    }
}

/// The smaller of two numbers that are not NaN: one instruction.
#[inline]
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The voxel that holds a point, which has to be within twice the limit; quicker than what the
/// processors of all targets have an instruction for.
#[inline]
pub fn voxel_of(point: DVec3) -> IVec3 {
    IVec3::new(floor(point.x), floor(point.y), floor(point.z))
}

/// Floor within the limit: the machines that wheels are built for have no instruction for
/// it. Adding 1.5 · 2^52 rounds to the nearest integer and leaves it in the low bits.
#[inline]
fn floor(x: f64) -> i32 {
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let shifted = x + ROUND;
    shifted.to_bits() as i32 - i32::from(shifted - ROUND > x)
}
