//! Rays through the scan: where they go, which part of them is looked at, and how far they leap over what is
//! empty. Positions run in grid coordinates, lengths along a ray in mm.

use glam::Vec3;

use crate::camera::RayFan;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Vector};
use crate::second::SecondShading;
use crate::shading::{FAR_AWAY, Shading};

/// Eight pixels, four beside one another in two rows.
#[derive(Clone, Copy)]
pub(crate) struct Pixels {
    /// Column and row, from the upper left corner.
    pub column: u32,
    pub row: u32,
    /// Shift within each pixel, −½ to ½ to the right and down, for averaging several pictures.
    pub shift: (f32, f32),
    /// Number of the noise pattern by which rays start at a share of a step; none: at half of one.
    pub noise: Option<u32>,
}

/// Pixels of a packet across and down.
pub(crate) const PACKET: (u32, u32) = (4, 2);

/// Eight rays.
pub(crate) struct Packet<L: Gather> {
    /// Where they begin [grid].
    pub origin: Vector<L>,
    /// Unit vectors along the grid's axes [mm], and the same in voxels.
    pub direction: Vector<L>,
    pub in_grid: Vector<L>,
    /// mm of length for each mm of depth.
    pub stretch: L::Float,
    /// From where to where they are followed [mm], and the normal of the face through which they enter.
    pub enter: L::Float,
    pub leave: L::Float,
    pub face: Vector<L>,
    /// Fraction of a step before the first sample.
    pub start: L::Float,
    /// Bricks by which empty space ends earlier: something may stand beside its voxels.
    margin: L::Float,
    /// mm for each brick along each axis, and whether the ray runs toward higher numbers.
    inverse: Vector<L>,
    is_forward: [L::Mask; 3],
}

/// The same rays in the grid of a second scan.
pub(crate) struct Beside<'a, L: Gather> {
    pub second: &'a SecondShading<'a>,
    pub rays: Packet<L>,
    /// Whether they show it alone, in modes with one value for each ray.
    pub has_ray: L::Mask,
    /// Where they are in it, whatever is cut away.
    enter: L::Float,
    leave: L::Float,
}

impl<L: Gather> Packet<L> {
    #[inline(always)]
    pub fn new(fan: &RayFan, pixels: Pixels, shading: &Shading<'_>) -> Self {
        let (column, row) = pixels.of_lanes::<L>();
        let (one, half) = (L::Float::splat(1.0), L::Float::splat(0.5));
        let x = (column + half + Floats::splat(pixels.shift.0))
            * Floats::splat(2.0 / fan.size.0 as f32)
            - one;
        let y = one
            - (row + half + Floats::splat(pixels.shift.1)) * Floats::splat(2.0 / fan.size.1 as f32);
        let sideways = Vector::splat(fan.across).scaled(x) + Vector::splat(fan.upward).scaled(y);
        let eye = Vector::splat(fan.eye);
        let per_mm = Vector::splat(fan.spacing.recip());
        let forward = Vector::splat(fan.forward);
        let (origin, to_pixel) = if fan.is_parallel {
            (eye + sideways.times(per_mm), forward)
        } else {
            (eye, forward + sideways)
        };
        let stretch = to_pixel.length();
        let direction = to_pixel.scaled(one.div(stretch));
        let rays = Rays {
            direction,
            stretch,
            start: pixels.starts::<L>(column, row),
        };
        let in_grid = direction.times(per_mm);
        let (mut packet, inverse) = Self::through(rays, origin, in_grid, shading.end());
        if let Some(displaced) = shading.displaced {
            packet.margin = displaced.margin(origin, inverse);
        }
        packet.keep(fan, shading, (origin, in_grid));
        packet
    }

    /// Rays through a scan that ends here, and mm for each of its voxels along each axis.
    #[inline(always)]
    fn through(
        rays: Rays<L>,
        origin: Vector<L>,
        in_grid: Vector<L>,
        end: Vec3,
    ) -> (Self, Vector<L>) {
        let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
        let speed = Vector::<L>::new(
            not_zero::<L>(in_grid.x),
            not_zero::<L>(in_grid.y),
            not_zero::<L>(in_grid.z),
        );
        let inverse = Vector::<L>::new(one.div(speed.x), one.div(speed.y), one.div(speed.z));
        let is_forward = [
            zero.at_most(speed.x),
            zero.at_most(speed.y),
            zero.at_most(speed.z),
        ];
        let mut packet = Self {
            origin,
            direction: rays.direction,
            in_grid,
            stretch: rays.stretch,
            enter: zero,
            leave: zero,
            face: rays.direction.scaled(Floats::splat(-1.0)),
            start: rays.start,
            margin: zero,
            inverse: Vector::new(
                L::Float::splat(8.0) * inverse.x.abs(),
                L::Float::splat(8.0) * inverse.y.abs(),
                L::Float::splat(8.0) * inverse.z.abs(),
            ),
            is_forward,
        };
        packet.through_box(inverse, Vector::splat(end));
        (packet, inverse)
    }

    /// The same rays through a second scan, which reaches beyond this one; none where there is none.
    #[inline(always)]
    pub fn beside<'a>(&self, fan: &RayFan, shading: &Shading<'a>) -> Option<Beside<'a, L>> {
        let second = shading.second?;
        let rays = Rays {
            direction: self.direction,
            stretch: self.stretch,
            start: self.start,
        };
        let grid = second.second.place(self.origin);
        let in_grid = second.second.turned(self.in_grid);
        let (mut packet, _) = Self::through(rays, grid, in_grid, second.shading.end());
        let (enter, leave) = (packet.enter, packet.leave);
        let normal = second.second.normal_in_first(packet.face);
        let face = normal
            .times(Vector::splat(fan.spacing.recip()))
            .normalized();
        let begins = L::Float::splat(0.0).less(enter);
        packet.face = face.or_else(begins, self.to_eye());
        packet.keep(fan, shading, (self.origin, self.in_grid));
        let meets = packet.enter.less(packet.leave);
        Some(Beside {
            second,
            has_ray: meets & second.second.has_ray::<L>(self.in_plane(fan)),
            rays: packet,
            enter,
            leave,
        })
    }

    /// Where the rays come through the plane through the middle of the view, to the right and up [mm].
    #[inline(always)]
    fn in_plane(&self, fan: &RayFan) -> (L::Float, L::Float) {
        let sideways = if fan.is_parallel {
            (self.origin - Vector::splat(fan.eye)).times(Vector::splat(fan.spacing))
        } else {
            (self.direction.scaled(self.stretch) - Vector::splat(fan.forward))
                .scaled(Floats::splat(fan.middle))
        };
        let along = |axis: Vec3| sideways.dot(Vector::splat(axis.normalize_or_zero()));
        (along(fan.across), along(fan.upward))
    }

    /// Where the rays are inside the scan.
    #[inline(always)]
    fn through_box(&mut self, inverse: Vector<L>, end: Vector<L>) {
        let zero = L::Float::splat(0.0);
        let low = Vector::new(zero, zero, zero) - self.origin;
        let a = low.times(inverse);
        let b = (end - self.origin).times(inverse);
        let (x, y, z) = (a.x.min(b.x), a.y.min(b.y), a.z.min(b.z));
        let enter = x.max(y).max(z);
        self.leave = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z));
        self.enter = enter.max(zero);
        let face = Vector::new(
            side::<L>(self.is_forward[0], enter.at_most(x)),
            side::<L>(self.is_forward[1], enter.at_most(y)),
            side::<L>(self.is_forward[2], enter.at_most(z)),
        );
        // an eye inside the scan looks through no face
        self.face = face.or_else(zero.less(enter), self.face);
    }

    /// Leaves what is looked at and what no plane cuts away: what is kept is convex. Planes are those of the grid in
    /// which the rays begin at `origin` and run along `in_grid`.
    #[inline(always)]
    fn keep(
        &mut self,
        fan: &RayFan,
        shading: &Shading<'_>,
        (origin, in_grid): (Vector<L>, Vector<L>),
    ) {
        let zero = L::Float::splat(0.0);
        let (near, far) = shading.slab;
        let near = self.stretch * Floats::splat(near);
        let to_eye = self.direction.scaled(Floats::splat(-1.0));
        let begins = self.enter.less(near);
        self.face = to_eye.or_else(begins, self.face);
        self.enter = self.enter.max(near);
        self.leave = self.leave.min(self.stretch * Floats::splat(far));
        for plane in shading.planes {
            let normal = Vector::splat(plane.truncate());
            let before = origin.dot(normal) + Floats::splat(plane.w);
            let rise = in_grid.dot(normal);
            let level = rise.abs().less(Floats::splat(1e-7));
            let place = (zero - before).div(rise);
            let leaves = zero.less(rise) & !level;
            let enters = rise.less(zero) & !level;
            self.leave = self.leave.min(place).or_else(leaves, self.leave);
            self.leave = zero.or_else(level & zero.less(before), self.leave);
            let later = enters & self.enter.less(place);
            self.enter = place.or_else(later, self.enter);
            let face = Vector::splat(plane.truncate() / fan.spacing);
            self.face = face.or_else(later, self.face);
        }
    }

    /// The place at a length along each ray [grid].
    #[inline(always)]
    pub fn at(&self, length: L::Float) -> Vector<L> {
        self.origin.along(self.in_grid, length)
    }

    /// Length of whole steps to the first sample beyond what is empty from here; 0 where it is not.
    #[inline(always)]
    pub fn steps_over_empty(&self, shading: &Shading<'_>, grid: Vector<L>) -> L::Float {
        let ahead = shading
            .empty
            .ahead::<L>(grid, self.margin, self.inverse, self.is_forward);
        let zero = L::Float::splat(0.0);
        if !zero.less(ahead).any() {
            return zero;
        }
        let steps = (ahead * Floats::splat(1.0 / shading.step))
            .ceil()
            .max(Floats::splat(1.0));
        (steps * Floats::splat(shading.step)).or_else(zero.less(ahead), zero)
    }

    #[inline(always)]
    pub fn to_eye(&self) -> Vector<L> {
        self.direction.scaled(Floats::splat(-1.0))
    }
}

/// Rays wherever they run.
#[derive(Clone, Copy)]
struct Rays<L: Gather> {
    direction: Vector<L>,
    stretch: L::Float,
    start: L::Float,
}

impl<L: Gather> Beside<'_, L> {
    /// Length of whole steps at a length of each ray over what is empty of the second scan, and where it is not; 0
    /// where something of it is drawn.
    #[inline(always)]
    pub fn steps_over_empty(&self, length: L::Float) -> L::Float {
        let shading = &self.second.shading;
        let (zero, far) = (L::Float::splat(0.0), L::Float::splat(FAR_AWAY));
        let within = self.rays.steps_over_empty(shading, self.rays.at(length));
        let before = length.less(self.enter);
        let missed = self.leave.at_most(length) | self.leave.at_most(self.enter);
        let steps = ((self.enter - length) * Floats::splat(1.0 / shading.step))
            .ceil()
            .max(Floats::splat(1.0))
            * Floats::splat(shading.step);
        let within = within.max(zero);
        far.or_else(missed, steps.or_else(before, within))
    }
}

/// A number that can be divided by.
#[inline(always)]
fn not_zero<L: Gather>(number: L::Float) -> L::Float {
    let small = number.abs().less(Floats::splat(1e-12));
    L::Float::splat(1e-12).or_else(small, number)
}

/// Component of the normal of a face through which rays enter.
#[inline(always)]
fn side<L: Gather>(is_forward: L::Mask, enters: L::Mask) -> L::Float {
    let against = L::Float::splat(-1.0).or_else(is_forward, Floats::splat(1.0));
    against.or_else(enters, Floats::splat(0.0))
}

impl Pixels {
    #[inline(always)]
    fn of_lanes<L: Gather>(self) -> (L::Float, L::Float) {
        const COLUMNS: [i32; LANES] = [0, 1, 2, 3, 0, 1, 2, 3];
        const ROWS: [i32; LANES] = [0, 0, 0, 0, 1, 1, 1, 1];
        let column = L::Int::load(&COLUMNS) + Ints::splat(self.column as i32);
        let row = L::Int::load(&ROWS) + Ints::splat(self.row as i32);
        (column.to_float(), row.to_float())
    }

    /// Fractions of a step before the first sample.
    ///
    /// Source: interleaved gradient noise, whose neighbours differ much, so that the eye averages it away (Jimenez,
    /// "Next generation post processing in Call of Duty", SIGGRAPH 2014).
    #[inline(always)]
    fn starts<L: Gather>(self, column: L::Float, row: L::Float) -> L::Float {
        let Some(pattern) = self.noise else {
            return Floats::splat(0.5);
        };
        let shift = L::Float::splat(5.588_238 * pattern as f32);
        let sum = (column + shift) * Floats::splat(0.067_110_56)
            + (row + shift) * Floats::splat(0.005_837_15);
        let scaled = L::Float::splat(52.982_918) * (sum - sum.floor());
        scaled - scaled.floor()
    }
}
