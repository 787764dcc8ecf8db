//! Tissue by absorption and emission, front to back. Between two samples the transfer function is integrated over
//! the values between theirs, so that the step changes cost and not look; where tissue becomes opaque, steps are
//! quartered. Solid segments end a ray at their surface.
//!
//! Source: Max, "Optical models for direct volume rendering", IEEE TVCG 1 (1995); Engel et al., "Real-Time Volume
//! Graphics" (2006), ch. 4; Levoy, "Display of surfaces from volume data", IEEE CG&A 8 (1988).

use crate::appearance::Blend;
use crate::lanes::{Floats, Gather, Ints, Masks, Vector, Work, exp_of_negative};
use crate::march::solid::{light_of_body, refined_entry};
use crate::march::{Beside, CLEAR_ENOUGH, Layers, MOST_SAMPLES, Packet, Seen};
use crate::shading::{FAR_AWAY, Shading};

/// Opacity of a whole step from which on it is quartered.
const OPAQUE_STEP: f32 = 0.12;

/// Quarters after each opaque step.
const QUARTERS: i32 = 4;

/// No stored value: an empty brick lies before.
const UNKNOWN: f32 = -1e9;

/// How far rays were followed.
struct March<'a, L: Gather> {
    /// Up to here, with the value there, or `UNKNOWN`.
    last: L::Float,
    front: L::Float,
    /// The next sample.
    next: L::Float,
    /// So many steps from there on are quarters.
    fine: L::Int,
    /// Where rays end, and the segment that ends them, 0 none.
    end: L::Float,
    solid: L::Int,
    /// A face cuts it there.
    cut: L::Mask,
    /// Surfaces of triangles that rays have not come to.
    layers: Layers<'a, L>,
    /// Here is a second scan alone.
    is_beside: bool,
    /// What is seen of all intervals, and the same times their lengths along the ray: where haze lies.
    weight: L::Float,
    weighted: L::Float,
    seen: Seen<L>,
}

/// Tissue between two samples.
struct Interval<L: Gather> {
    colour: Vector<L>,
    /// [1/mm]
    extinction: L::Float,
    /// Code of the segment in whose colour it is, 0 none.
    segment: L::Int,
}

/// Follows rays through tissue to the first solid segment, or to their end; through a second scan before the first,
/// with it, and behind it.
#[inline(always)]
pub(super) fn seen_along<'a, L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    beside: Option<&Beside<'_, L>>,
    layers: Layers<'a, L>,
) -> (Seen<L>, Layers<'a, L>) {
    if let Some(beside) = beside {
        // a function of its own: most pictures show no second scan, and are not to wait for it
        return L::apart(Through {
            shading,
            packet,
            beside,
            layers,
        });
    }
    let mut march = March::new(shading, packet, layers);
    march.follow(shading, packet, None);
    if shading.blend.draws_solids() {
        march.end_at_bodies(shading, packet);
    }
    march.ended()
}

/// Goes through two scans.
struct Through<'a, 'b, L: Gather> {
    shading: &'a Shading<'a>,
    packet: &'a Packet<L>,
    beside: &'a Beside<'a, L>,
    layers: Layers<'b, L>,
}

impl<'b, L: Gather> Work<L> for Through<'_, 'b, L> {
    type Done = (Seen<L>, Layers<'b, L>);

    #[inline(always)]
    fn done(self) -> Self::Done {
        let Self {
            shading,
            packet,
            beside,
            layers,
        } = self;
        let mut march = March::new(shading, packet, layers);
        for stretch in [Stretch::Before, Stretch::Within, Stretch::Behind] {
            march.begin(shading, packet, beside, stretch);
            march.follow(shading, packet, Some(beside));
            if stretch == Stretch::Within && shading.blend.draws_solids() {
                march.end_at_bodies(shading, packet);
            }
        }
        march.ended()
    }
}

/// Where rays are, told by the first scan.
#[derive(Clone, Copy, PartialEq)]
enum Stretch {
    Before,
    Within,
    Behind,
}

impl<'a, L: Gather> March<'a, L> {
    #[inline(always)]
    fn new(shading: &Shading<'_>, packet: &Packet<L>, layers: Layers<'a, L>) -> Self {
        let zero = L::Float::splat(0.0);
        Self {
            last: packet.enter,
            front: Floats::splat(UNKNOWN),
            next: packet.enter + packet.start * Floats::splat(shading.step),
            fine: Ints::splat(0),
            end: packet.leave,
            solid: Ints::splat(0),
            cut: Masks::splat(false),
            layers,
            is_beside: false,
            weight: zero,
            weighted: zero,
            seen: Seen {
                light: Vector::new(zero, zero, zero),
                clarity: Floats::splat(1.0),
                depth: Floats::splat(-1.0),
                segment: Ints::splat(0),
                haze: Floats::splat(-1.0),
            },
        }
    }

    /// What was seen, and the surfaces that rays have not come to.
    #[inline(always)]
    fn ended(mut self) -> (Seen<L>, Layers<'a, L>) {
        let is_any = L::Float::splat(0.0).less(self.weight);
        self.seen.haze = self
            .weighted
            .div(self.weight)
            .or_else(is_any, self.seen.haze);
        (self.seen, self.layers)
    }

    /// Begins another stretch of rays that go through two scans.
    #[inline(always)]
    fn begin(
        &mut self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        beside: &Beside<'_, L>,
        stretch: Stretch,
    ) {
        let far = L::Float::splat(FAR_AWAY);
        let meets = packet.enter.less(packet.leave);
        let (enter, leave) = (beside.rays.enter, beside.rays.leave);
        (self.last, self.end) = match stretch {
            Stretch::Before => (enter, leave.min(packet.enter.or_else(meets, far))),
            Stretch::Within => (packet.enter, packet.leave),
            Stretch::Behind => (enter.max(packet.leave.or_else(meets, far)), leave),
        };
        self.front = Floats::splat(UNKNOWN);
        self.next = self.last + packet.start * Floats::splat(shading.step);
        self.fine = Ints::splat(0);
        self.is_beside = stretch != Stretch::Within;
    }

    /// Goes on to the end of all rays.
    #[inline(always)]
    fn follow(
        &mut self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        beside: Option<&Beside<'_, L>>,
    ) {
        for _ in 0..MOST_SAMPLES {
            let under_way = self.are_under_way();
            if !under_way.any() {
                break;
            }
            self.look(shading, packet, beside, under_way);
        }
    }

    #[inline(always)]
    fn are_under_way(&self) -> L::Mask {
        self.last.less(self.end) & L::Float::splat(CLEAR_ENOUGH).less(self.seen.clarity)
    }

    /// Looks at the rays' next samples, or leaps over empty bricks.
    #[inline(always)]
    fn look(
        &mut self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        beside: Option<&Beside<'_, L>>,
        under_way: L::Mask,
    ) {
        self.next = self.next.min(self.end).or_else(under_way, self.next);
        let grid = packet.at(self.next);
        let leap = self.leap(shading, packet, beside);
        let in_empty = L::Float::splat(0.0).less(leap);
        let unknown = self.front.less(Floats::splat(0.5 * UNKNOWN));
        let leaps = under_way & in_empty & unknown;
        if leaps.any() {
            self.next = (self.next + leap).or_else(leaps, self.next);
            let before = self.next - Floats::splat(shading.step);
            self.last = before.or_else(leaps, self.last);
            self.fine = L::Int::splat(0).or_else(leaps, self.fine);
        }
        let looks = under_way & !leaps;
        if !looks.any() {
            return;
        }
        if (looks & unknown).any() & !self.is_beside {
            let front = shading.value_at(packet.at(self.last));
            self.front = front.or_else(looks & unknown, self.front);
        }
        let zero = L::Float::splat(0.0);
        let (value, code) = if self.is_beside {
            (zero, Ints::splat(0))
        } else {
            shading.seen_at(grid)
        };
        let clear = shading.transfer.are_clear_between::<L>(self.front, value);
        let (colour, extinction) = if (looks & !clear).any() & !self.is_beside {
            shading.transfer.between::<L>(self.front, value)
        } else {
            (Vector::new(zero, zero, zero), zero)
        };
        let solid = shading.segments.are_solid::<L>(code);
        let hidden = L::Int::splat(0).greater(code);
        let mut meets = L::Mask::splat(false);
        if shading.blend.draws_solids() {
            meets = looks & solid & self.solid.equal(Ints::splat(0));
            if meets.any() {
                // they look again, up to the body
                self.meet(shading, packet, code, meets);
            }
        }
        let seen = looks & !meets & !hidden;
        let tissue = match beside {
            None => seen & zero.less(extinction),
            Some(_) => seen,
        };
        if tissue.any() {
            let inside = code.greater(Ints::splat(0)) & !solid;
            let interval = Interval {
                colour: shading.segments.colour::<L>(code).or_else(inside, colour),
                extinction,
                segment: code.or_else(inside, Ints::splat(0)),
            };
            let divided = self.add(shading, packet, beside, interval, tissue);
            let quarter = self.last + Floats::splat(0.25 * shading.step);
            self.fine = L::Int::splat(QUARTERS).or_else(divided, self.fine);
            self.next = quarter.or_else(divided, self.next);
            self.go_on(shading, value, in_empty, tissue & !divided);
        }
        let passes = looks & !meets & !tissue;
        if passes.any() {
            self.fine = L::Int::splat(0).or_else(passes, self.fine);
            self.go_on(shading, value, in_empty, passes);
        }
    }

    /// Length of whole steps over what is empty of all scans from the next sample on; 0 where it is not.
    #[inline(always)]
    fn leap(
        &self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        beside: Option<&Beside<'_, L>>,
    ) -> L::Float {
        let other = match beside {
            None => Floats::splat(FAR_AWAY),
            Some(beside) => beside.steps_over_empty(self.next),
        };
        if self.is_beside {
            return other;
        }
        let leap = packet.steps_over_empty(shading, packet.at(self.next));
        leap.min(other)
    }

    /// Goes on to the next sample.
    #[inline(always)]
    fn go_on(&mut self, shading: &Shading<'_>, value: L::Float, in_empty: L::Mask, lanes: L::Mask) {
        // an empty brick is leapt over from here on
        let front = L::Float::splat(UNKNOWN).or_else(in_empty, value);
        self.front = front.or_else(lanes, self.front);
        self.last = self.next.or_else(lanes, self.last);
        let fine = (self.fine - Ints::splat(1)).max(Ints::splat(0));
        self.fine = fine.or_else(lanes, self.fine);
        let (step, quarter) = (
            L::Float::splat(shading.step),
            L::Float::splat(0.25 * shading.step),
        );
        let stride = quarter.or_else(self.fine.greater(Ints::splat(0)), step);
        self.next = (self.next + stride).or_else(lanes, self.next);
    }

    /// Rays end where the bodies that they have met begin.
    #[inline(always)]
    fn meet(&mut self, shading: &Shading<'_>, packet: &Packet<L>, code: L::Int, meets: L::Mask) {
        let (entry, code) = refined_entry(shading, packet, (self.last, self.next), code, false);
        let begins = meets & self.last.at_most(packet.enter);
        let mut cut = L::Mask::splat(false);
        if begins.any() {
            let (_, there) = shading.seen_at(packet.at(self.last));
            cut = begins & shading.segments.are_solid::<L>(there);
        }
        let entry = self.last.or_else(cut, entry);
        self.end = entry.or_else(meets, self.end);
        self.solid = code.or_else(meets, self.solid);
        self.cut = (cut & meets) | (self.cut & !meets);
    }

    /// Adds the light of tissue between the last sample and the next; returns the lanes in which it is too opaque for
    /// the length of the way, and nothing was added.
    #[inline(always)]
    fn add(
        &mut self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        beside: Option<&Beside<'_, L>>,
        interval: Interval<L>,
        lanes: L::Mask,
    ) -> L::Mask {
        let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
        let size = self.next - self.last;
        let mut extinction = interval.extinction * Floats::splat(shading.density);
        let mut colour = interval.colour;
        let mut divided = L::Mask::splat(false);
        let middle = L::Float::splat(0.5) * (self.last + self.next);
        let (grid, to_eye) = (packet.at(middle), packet.to_eye());
        let mut other = None;
        if let Some(beside) = beside {
            extinction = zero.or_else(beside.second.second.has_turn(grid), extinction);
            other = Some(beside.second.lit(shading, grid, to_eye));
        }
        if shading.blend.draws_solids() {
            let gradient = if self.is_beside {
                Vector::new(zero, zero, zero)
            } else {
                shading.gradient_at(grid)
            };
            let (kept, boundary) = shading.boundary::<L>(gradient.length());
            extinction = extinction * kept;
            let dividable =
                self.fine.equal(Ints::splat(0)) & L::Float::splat(0.3 * shading.step).less(size);
            let whole = match &other {
                None => extinction,
                Some(other) => extinction + other.extinction,
            };
            let opaque = L::Float::splat(OPAQUE_STEP / shading.step).less(whole);
            divided = lanes & dividable & opaque;
            if divided.bits() == lanes.bits() {
                return divided;
            }
            if shading.blend == Blend::Shaded && !self.is_beside {
                let normal = gradient.facing(to_eye);
                let reaching = shading.lookup.at(grid, normal.scaled(boundary));
                let own = shading.segments.factors::<L>(interval.segment);
                colour = shading
                    .light
                    .on_tissue(colour, normal, to_eye, boundary, reaching, own);
            }
        }
        if let Some(other) = other {
            (colour, extinction) = other.mixed_with(colour, extinction);
        }
        let adds = lanes & !divided;
        self.layers
            .pass(shading, packet, middle, adds, &mut self.seen);
        let clarity = self.seen.clarity;
        if shading.blend == Blend::Emission {
            let share = (clarity * extinction * size).or_else(adds, zero);
            self.seen.light = self.seen.light.along(colour, share);
            self.weigh(share, middle);
            return divided;
        }
        let opacity = one - exp_of_negative::<L>(zero - extinction * size);
        let share = (clarity * opacity).or_else(adds, zero);
        self.seen.light = if shading.blend == Blend::Absorption {
            // what is absorbed of the light behind, bright where much is: as a radiograph shows it
            self.weigh(share, middle);
            self.seen.light + Vector::new(share, share, share)
        } else {
            self.seen.light.along(colour, share)
        };
        self.seen.clarity = clarity - share;
        if shading.blend != Blend::Absorption {
            self.seen.note_depth(self.next, interval.segment, adds);
        }
        divided
    }

    /// Which bodies are cut, and by which face: where rays come to them first, or by the side of a cell.
    #[inline(always)]
    fn cut_at_end(&self, shading: &Shading<'_>, packet: &Packet<L>) -> (L::Mask, Vector<L>) {
        let Some(second) = shading.second else {
            return (self.cut, packet.face);
        };
        let side = second.second.side_before(packet, self.end, shading.step);
        let mut opens = side.is_crossed & !self.cut;
        if opens.any() {
            let (_, there) = shading.at(packet.at(side.before));
            opens = opens & shading.segments.are_solid::<L>(there);
        }
        (self.cut | opens, side.face.or_else(opens, packet.face))
    }

    /// Counts what is seen of an interval at the length of its middle.
    #[inline(always)]
    fn weigh(&mut self, share: L::Float, middle: L::Float) {
        self.weight = self.weight + share;
        self.weighted = self.weighted + share * middle;
    }

    /// Adds the light of the bodies at which rays end.
    #[inline(always)]
    fn end_at_bodies(&mut self, shading: &Shading<'_>, packet: &Packet<L>) {
        let zero = L::Float::splat(0.0);
        let ends = self.solid.greater(Ints::splat(0))
            & L::Float::splat(CLEAR_ENOUGH).less(self.seen.clarity);
        if !ends.any() {
            return;
        }
        self.layers
            .pass(shading, packet, self.end, ends, &mut self.seen);
        let cut = self.cut_at_end(shading, packet);
        let light = light_of_body(shading, packet, self.end, self.solid, cut);
        let share = self.seen.clarity.or_else(ends, zero);
        self.seen.light = self.seen.light.along(light, share);
        self.seen.clarity = self.seen.clarity - share;
        self.seen.note_depth(self.end, self.solid, ends);
    }
}
