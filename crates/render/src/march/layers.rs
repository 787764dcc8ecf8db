//! Surfaces of triangles in the way of rays: light of those that can be seen through comes in at their depth, and the
//! first opaque one ends the ray.

use glam::{Affine3A, Vec3};
use palpate_volume::simd_dispatch;
use palpate_volume::simd_dispatch::SimdLevel;

#[cfg(target_arch = "x86_64")]
use crate::lanes::Avx2;
use crate::lanes::Plain;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Vector};
use crate::lighting::OwnFactors;
use crate::march::solid::{OwnPlaces, openness};
use crate::march::{CLEAR_ENOUGH, PACKET, Packet, Pixels, Seen};
use crate::shading::{FAR_AWAY, Shading};
use crate::surfaces::{BandFragments, DrawnSurface, Fragment, NO_FRAGMENT, Own};

/// What stands in the way of eight rays.
#[derive(Clone, Copy)]
pub(crate) struct Layers<'a, L: Gather> {
    fragments: Option<&'a BandFragments<'a>>,
    /// The first pixel.
    at: (u32, u32),
    /// Lengths at which rays end at an opaque surface [mm], far away where there is none.
    pub end: L::Float,
    /// Numbers of the next fragments that can be seen through, and lengths at which their light comes in.
    next: [u32; LANES],
    place: L::Float,
}

impl<'a, L: Gather> Layers<'a, L> {
    /// Nothing.
    #[inline(always)]
    pub fn none() -> Self {
        Self {
            fragments: None,
            at: (0, 0),
            end: Floats::splat(FAR_AWAY),
            next: [NO_FRAGMENT; LANES],
            place: Floats::splat(FAR_AWAY),
        }
    }

    /// What a band's surfaces are for these rays; none where there is nothing. A surface is met a little before it is
    /// reached, so that it covers its own voxels.
    #[inline(always)]
    pub fn new(
        fragments: &'a BandFragments<'a>,
        shading: &Shading<'_>,
        pixels: &Pixels,
        stretch: L::Float,
    ) -> Option<Self> {
        let at = (pixels.column, pixels.row);
        let mut next = [NO_FRAGMENT; LANES];
        let mut depths = [f32::INFINITY; LANES];
        for lane in 0..LANES {
            let (nearest, first) =
                fragments.at(at.0 + lane as u32 % PACKET.0, at.1 + lane as u32 / PACKET.0);
            depths[lane] = nearest.depth;
            next[lane] = first;
        }
        let has_any = (0..LANES).any(|lane| depths[lane].is_finite() || next[lane] != NO_FRAGMENT);
        if !has_any {
            return None;
        }
        let mut layers = Self {
            fragments: Some(fragments),
            at,
            end: lengths::<L>(shading, depths, stretch),
            next,
            place: Floats::splat(FAR_AWAY),
        };
        layers.look(shading, stretch);
        Some(layers)
    }

    /// Where the next fragments stand.
    #[inline(always)]
    fn look(&mut self, shading: &Shading<'_>, stretch: L::Float) {
        let mut depths = [f32::INFINITY; LANES];
        if let Some(fragments) = self.fragments {
            for (depth, &next) in depths.iter_mut().zip(&self.next) {
                if next != NO_FRAGMENT {
                    *depth = fragments.veil(next).depth;
                }
            }
        }
        let place = lengths::<L>(shading, depths, stretch);
        // what stands behind an opaque one is not seen
        self.place = place.or_else(place.less(self.end), Floats::splat(FAR_AWAY));
    }

    /// Lets the light of all that stands before a length in, for some lanes.
    #[inline(always)]
    pub fn pass(
        &mut self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        length: L::Float,
        lanes: L::Mask,
        seen: &mut Seen<L>,
    ) {
        loop {
            let due = lanes & self.place.less(length);
            if !due.any() {
                return;
            }
            self.pass_next(shading, packet, due, seen);
        }
    }

    #[inline(always)]
    fn pass_next(
        &mut self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        due: L::Mask,
        seen: &mut Seen<L>,
    ) {
        let Some(fragments) = self.fragments else {
            return;
        };
        let bits = due.bits();
        let mut met = [None; LANES];
        for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
            let fragment = fragments.veil(self.next[lane]);
            met[lane] = Some(fragment);
            self.next[lane] = fragment.next;
        }
        let place = self.place + lead::<L>(shading);
        let lit = Lit::of(shading, packet, fragments, met, place);
        let share = (seen.clarity * lit.opacity).or_else(due, Floats::splat(0.0));
        seen.light = seen.light.along(lit.light, share);
        seen.clarity = seen.clarity - share;
        seen.note_depth(place, lit.segment, due);
        self.look(shading, packet.stretch);
    }

    /// What is still seen through the scan.
    #[inline(always)]
    pub fn end(mut self, shading: &Shading<'_>, packet: &Packet<L>, seen: &mut Seen<L>) {
        let Some(fragments) = self.fragments else {
            return;
        };
        let looks = L::Float::splat(CLEAR_ENOUGH).less(seen.clarity);
        self.pass(shading, packet, Floats::splat(FAR_AWAY), looks, seen);
        let ends = looks & self.end.less(Floats::splat(FAR_AWAY));
        let bits = ends.bits();
        if bits == 0 {
            return;
        }
        let mut met = [None; LANES];
        for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
            let (column, row) = (lane as u32 % PACKET.0, lane as u32 / PACKET.0);
            met[lane] = Some(fragments.at(self.at.0 + column, self.at.1 + row).0);
        }
        let place = self.end + lead::<L>(shading);
        let lit = Lit::of(shading, packet, fragments, met, place);
        let share = seen.clarity.or_else(ends, Floats::splat(0.0));
        seen.light = seen.light.along(lit.light, share);
        seen.clarity = seen.clarity - share;
        seen.note_depth(place, lit.segment, ends);
    }
}

/// A surface is drawn this far before it, so that it covers its own voxels [mm].
#[inline(always)]
fn lead<L: Gather>(shading: &Shading<'_>) -> L::Float {
    Floats::splat(shading.field.spacing().min_element())
}

/// Lengths along rays at which what stands at these depths is met.
#[inline(always)]
fn lengths<L: Gather>(shading: &Shading<'_>, depths: [f32; LANES], stretch: L::Float) -> L::Float {
    let length = L::Float::load(&depths) * stretch - lead::<L>(shading);
    length.min(Floats::splat(FAR_AWAY))
}

/// Light of surfaces.
struct Lit<L: Gather> {
    light: Vector<L>,
    opacity: L::Float,
    /// Code of the segment.
    segment: L::Int,
}

impl<L: Gather> Lit<L> {
    /// Of fragments at lengths of their rays.
    #[inline(always)]
    fn of(
        shading: &Shading<'_>,
        packet: &Packet<L>,
        fragments: &BandFragments<'_>,
        met: [Option<&Fragment>; LANES],
        length: L::Float,
    ) -> Self {
        let mut lit = LitLanes {
            light: [[0.0; LANES]; 3],
            opacity: [0.0; LANES],
            segment: [0; LANES],
        };
        let job = LitJob {
            shading,
            surfaces: fragments.surfaces,
            met,
            place: stored(packet.at(length)),
            to_eye: stored(packet.to_eye()),
        };
        light_up(&job, &mut lit, fragments.level);
        Self {
            light: loaded(&lit.light),
            opacity: Floats::load(&lit.opacity),
            segment: Ints::load(&lit.segment),
        }
    }
}

/// What is lit. In memory: this is compiled once, beside the loops in which it is asked for.
struct LitJob<'a> {
    shading: &'a Shading<'a>,
    surfaces: &'a [DrawnSurface<'a>],
    met: [Option<&'a Fragment>; LANES],
    place: [[f32; LANES]; 3],
    to_eye: [[f32; LANES]; 3],
}

/// [`Lit`] in memory.
struct LitLanes {
    light: [[f32; LANES]; 3],
    opacity: [f32; LANES],
    segment: [i32; LANES],
}

#[cfg(target_arch = "x86_64")]
simd_dispatch! {
    fn light_up(job: &LitJob<'_>, lit: &mut LitLanes, level: SimdLevel) =
        [avx2 => light_up_avx2] light_up_plain, at level
}

#[cfg(not(target_arch = "x86_64"))]
fn light_up(job: &LitJob<'_>, lit: &mut LitLanes, level: SimdLevel) {
    light_up_plain(job, lit, level);
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn light_up_avx2(job: &LitJob<'_>, lit: &mut LitLanes, _: SimdLevel) {
    light_all::<Avx2>(job, lit);
}

fn light_up_plain(job: &LitJob<'_>, lit: &mut LitLanes, _: SimdLevel) {
    light_all::<Plain>(job, lit);
}

/// Lights one surface after the other.
#[inline(always)]
fn light_all<L: Gather>(job: &LitJob<'_>, lit: &mut LitLanes) {
    let mut normals = [[0.0; LANES]; 3];
    let mut cut = 0_u8;
    let mut left = 0_u8;
    for (lane, fragment) in job.met.iter().enumerate() {
        if let Some(fragment) = fragment {
            for (axis, values) in normals.iter_mut().enumerate() {
                values[lane] = fragment.normal[axis];
            }
            cut |= u8::from(fragment.is_cut) << lane;
            left |= 1 << lane;
        }
    }
    let normal = (loaded::<L>(&normals), L::Mask::from_bits(cut));
    while left != 0 {
        let Some(first) = job.met[left.trailing_zeros() as usize] else {
            return;
        };
        let surface = &job.surfaces[first.surface as usize];
        let light = stored(light_of::<L>(job, surface, normal));
        for (lane, fragment) in job.met.iter().enumerate() {
            if fragment.is_some_and(|it| it.surface == first.surface) {
                for (lit, light) in lit.light.iter_mut().zip(&light) {
                    lit[lane] = light[lane];
                }
                lit.opacity[lane] = surface.shown.opacity;
                lit.segment[lane] = surface.code;
                left &= !(1 << lane);
            }
        }
    }
}

/// Light of one surface.
#[inline(always)]
fn light_of<L: Gather>(
    job: &LitJob<'_>,
    surface: &DrawnSurface<'_>,
    (normal, cut): (Vector<L>, L::Mask),
) -> Vector<L> {
    let one = L::Float::splat(1.0);
    let shading = job.shading;
    let grid = loaded::<L>(&job.place);
    let to_eye = loaded::<L>(&job.to_eye);
    let posed = turned(surface.posed, normal).facing(to_eye);
    let posed = normal.or_else(cut, posed);
    let asks =
        !(shading.is_in_haste || surface.shown.is_wireframe || matches!(surface.own, Own::Nothing));
    let near = if asks {
        let at_rest = turned(surface.at_rest, normal).normalized();
        let place = moved(surface.rest_from_posed, grid);
        let open = openness(shading, place, at_rest, &PlacesOf(surface));
        one.or_else(cut, open)
    } else {
        one
    };
    let reaching = shading.lookup.at(grid, posed);
    let own = OwnFactors {
        ambient: L::Float::splat(surface.shown.ambient),
        specular: L::Float::splat(surface.shown.specular),
    };
    let colour = Vector::splat(surface.shown.colour);
    shading
        .light
        .on_surface(colour, posed, to_eye, near, reaching, own)
}

/// Places of a surface's segment that are not cut away, where the scan has it.
struct PlacesOf<'a>(&'a DrawnSurface<'a>);

impl<L: Gather> OwnPlaces<L> for PlacesOf<'_> {
    #[inline(always)]
    fn at(&self, shading: &Shading<'_>, place: Vector<L>) -> L::Mask {
        let own = self.0.own_at(shading.field, place);
        if shading.planes.is_empty() {
            return own;
        }
        own & !shading.is_cut_away(moved(self.0.posed_from_rest, place))
    }
}

#[inline(always)]
fn stored<L: Gather>(vector: Vector<L>) -> [[f32; LANES]; 3] {
    [vector.x.store(), vector.y.store(), vector.z.store()]
}

#[inline(always)]
fn loaded<L: Gather>([x, y, z]: &[[f32; LANES]; 3]) -> Vector<L> {
    Vector::new(Floats::load(x), Floats::load(y), Floats::load(z))
}

#[inline(always)]
fn turned<L: Gather>(by: glam::Mat3, vector: Vector<L>) -> Vector<L> {
    Vector::splat(by.x_axis)
        .scaled(vector.x)
        .along(Vector::splat(by.y_axis), vector.y)
        .along(Vector::splat(by.z_axis), vector.z)
}

#[inline(always)]
fn moved<L: Gather>(by: Affine3A, place: Vector<L>) -> Vector<L> {
    let matrix = glam::Mat3::from(by.matrix3);
    turned(matrix, place) + Vector::splat(Vec3::from(by.translation))
}
