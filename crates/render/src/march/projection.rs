//! One value of all along a ray, as grey by window and level: the largest (MIP), the least (MinIP) or the mean. The
//! last two count from the first to the last tissue on the ray: air around the body would hide all of it. A second scan
//! has a value of its own, by its own window, in its colour over that.
//!
//! Source: Wallis et al., "Three-dimensional display in nuclear medicine", IEEE TMI 8 (1989) for MIP.

use crate::appearance::Blend;
use crate::lanes::{Floats, Gather, Ints, Masks, Vector, Work, power};
use crate::march::{Beside, MOST_SAMPLES, Packet, Seen};
use crate::second::Turns;
use crate::shading::Shading;

/// No fraction of a window.
const NONE: f32 = 1e9;

/// What counts along rays, and what counts as soon as tissue comes after it.
struct Counted<L: Gather> {
    /// The largest fraction, or the least, and where.
    extreme: L::Float,
    place: L::Float,
    waiting: L::Float,
    waiting_place: L::Float,
    /// Sums and numbers of samples.
    sum: L::Float,
    count: L::Float,
    waiting_sum: L::Float,
    waiting_count: L::Float,
    /// From the first tissue to the last.
    first: L::Float,
    last: L::Float,
}

/// The grey of rays, and over it the colour of a second scan.
#[inline(always)]
pub(super) fn seen_along<L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    beside: Option<&Beside<'_, L>>,
) -> Seen<L> {
    let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
    let (share, place) = L::apart(ShareAlong { shading, packet });
    let grey = share.max(zero).min(one);
    // black is air, wherever its values come from
    let haze = place.or_else(zero.less(share), Floats::splat(-1.0));
    let Some(beside) = beside else {
        let light = linear_from_screen::<L>(grey);
        return seen_as(Vector::new(light, light, light), grey, haze);
    };
    let colour = under_second(beside, Vector::new(grey, grey, grey));
    let Vector { x, y, z } = colour;
    let light = Vector::new(
        linear_from_screen::<L>(x),
        linear_from_screen::<L>(y),
        linear_from_screen::<L>(z),
    );
    seen_as(light, x.max(y).max(z), haze)
}

/// Black is as clear as air: the ground shows through.
#[inline(always)]
fn seen_as<L: Gather>(light: Vector<L>, brightest: L::Float, haze: L::Float) -> Seen<L> {
    Seen {
        light,
        clarity: L::Float::splat(1.0) - brightest,
        depth: Floats::splat(-1.0),
        segment: Ints::splat(0),
        haze,
    }
}

/// A colour of the first scan on the screen, under that of a second one; or that alone where it has the ray.
#[inline(always)]
fn under_second<L: Gather>(beside: &Beside<'_, L>, first: Vector<L>) -> Vector<L> {
    let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
    let shading = &beside.second.shading;
    let (share, _) = L::apart(ShareAlong {
        shading,
        packet: &beside.rays,
    });
    // black may have been leapt over
    let least = if shading.blend == Blend::Mip {
        0.0
    } else {
        -NONE
    };
    let shows = L::Float::splat(least).less(share);
    let inside = share.max(zero).min(one);
    let second = beside.second.second;
    if second.turns != Turns::Together {
        return second.tinted(inside).or_else(beside.has_ray, first);
    }
    second.blended(first, inside).or_else(shows, first)
}

/// Fraction of the window along rays, `-NONE` where nothing counts; and the length at which it lies: of a mean, the middle
/// of what counts [mm].
struct ShareAlong<'a, L: Gather> {
    shading: &'a Shading<'a>,
    packet: &'a Packet<L>,
}

impl<L: Gather> Work<L> for ShareAlong<'_, L> {
    type Done = (L::Float, L::Float);

    #[inline(always)]
    fn done(self) -> Self::Done {
        let Self { shading, packet } = self;
        let none = L::Float::splat(if shading.blend == Blend::Mip {
            -NONE
        } else {
            NONE
        });
        let zero = L::Float::splat(0.0);
        let mut counted = Counted::<L> {
            extreme: none,
            place: zero,
            waiting: none,
            waiting_place: zero,
            sum: zero,
            count: zero,
            waiting_sum: zero,
            waiting_count: zero,
            first: zero,
            last: zero,
        };
        let mut next = packet.enter + packet.start * Floats::splat(shading.step);
        for _ in 0..MOST_SAMPLES {
            let mut under_way = next.less(packet.leave);
            if shading.blend == Blend::Mip {
                under_way = under_way & counted.extreme.less(Floats::splat(1.0));
            }
            if !under_way.any() {
                break;
            }
            let grid = packet.at(next);
            let leap = packet.steps_over_empty(shading, grid);
            let leaps = zero.less(leap);
            let looks = under_way & !leaps;
            if looks.any() {
                let (share, counts) = share_at(shading, grid);
                counted.take(shading, share, next, looks & counts);
            }
            let stride = leap.or_else(leaps, Floats::splat(shading.step));
            next = (next + stride).or_else(under_way, next);
        }
        if shading.blend == Blend::Average {
            let mean = counted.sum.div(counted.count.max(Floats::splat(1.0)));
            let middle = L::Float::splat(0.5) * (counted.first + counted.last);
            let share = mean.or_else(zero.less(counted.count), Floats::splat(-NONE));
            return (share, middle);
        }
        let (found, place) = refined(shading, packet, &counted);
        let is_any = found.abs().less(Floats::splat(NONE));
        (found.or_else(is_any, Floats::splat(-NONE)), place)
    }
}

/// Fraction of the window at a place, and whether it counts: what is hidden does not.
#[inline(always)]
fn share_at<L: Gather>(shading: &Shading<'_>, grid: Vector<L>) -> (L::Float, L::Mask) {
    let (value, code) = shading.at(grid);
    let counts = !L::Int::splat(0).greater(code);
    (shading.grey_of::<L>(value), counts)
}

impl<L: Gather> Counted<L> {
    /// Takes a sample of some lanes.
    #[inline(always)]
    fn take(&mut self, shading: &Shading<'_>, share: L::Float, place: L::Float, lanes: L::Mask) {
        if shading.blend == Blend::Mip {
            let more = lanes & self.extreme.less(share);
            self.extreme = share.or_else(more, self.extreme);
            self.place = place.or_else(more, self.place);
            return;
        }
        let (zero, none) = (L::Float::splat(0.0), L::Float::splat(NONE));
        let has_begun = self.extreme.less(none);
        let tissue = lanes & L::Float::splat(shading.tissue_from).at_most(share);
        let waits = tissue | (lanes & has_begun);
        let less = waits & share.less(self.waiting);
        self.waiting_place = place.or_else(less, self.waiting_place);
        self.waiting = share.or_else(less, self.waiting);
        self.waiting_sum = (self.waiting_sum + share).or_else(waits, self.waiting_sum);
        let more = self.waiting_count + Floats::splat(1.0);
        self.waiting_count = more.or_else(waits, self.waiting_count);
        if !tissue.any() {
            return;
        }
        self.first = place.or_else(tissue & !has_begun, self.first);
        self.last = place.or_else(tissue, self.last);
        let least = tissue & self.waiting.less(self.extreme);
        self.place = self.waiting_place.or_else(least, self.place);
        self.extreme = self.waiting.or_else(least, self.extreme);
        self.sum = (self.sum + self.waiting_sum).or_else(tissue, self.sum);
        self.count = (self.count + self.waiting_count).or_else(tissue, self.count);
        self.waiting_sum = zero.or_else(tissue, self.waiting_sum);
        self.waiting_count = zero.or_else(tissue, self.waiting_count);
        self.waiting = none.or_else(tissue, self.waiting);
    }
}

/// The largest value beside a sample, or the least, and where: a thin bone, or an airway, lies between two of them.
#[inline(always)]
fn refined<L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    counted: &Counted<L>,
) -> (L::Float, L::Float) {
    let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
    let (mut found, mut place) = (counted.extreme, counted.place);
    let mut reach = 0.5 * shading.step;
    for _ in 0..4 {
        for side in [-1.0, 1.0] {
            let asked = zero.less(found) & found.less(one);
            if !asked.any() {
                return (found, place);
            }
            let next = place + Floats::splat(side * reach);
            let (share, counts) = share_at(shading, packet.at(next));
            let mut beyond =
                asked & counts & packet.enter.at_most(next) & next.at_most(packet.leave);
            beyond = if shading.blend == Blend::Mip {
                beyond & found.less(share)
            } else {
                let tissue = L::Float::splat(shading.tissue_from).at_most(share);
                let between = counted.first.at_most(next) & next.at_most(counted.last);
                beyond & share.less(found) & (tissue | between)
            };
            found = share.or_else(beyond, found);
            place = next.or_else(beyond, place);
        }
        reach *= 0.5;
    }
    (found, place)
}

/// Light of a grey on the screen.
#[inline(always)]
fn linear_from_screen<L: Gather>(grey: L::Float) -> L::Float {
    let bent = power::<L>(
        (grey + Floats::splat(0.055)) * Floats::splat(1.0 / 1.055),
        2.4,
    );
    let straight = grey * Floats::splat(1.0 / 12.92);
    straight.or_else(grey.at_most(Floats::splat(0.040_45)), bent)
}
