//! The way from the proxy to the smooth contact point.
//!
//! Where each body's field is ½ is its surface. At a point, value and gradient give a plane
//! that stands for it; the contact point is moved to the point of the free side of all planes
//! that is nearest to the device, again and again, with short steps. It starts at the proxy
//! and stays near it, so that it is on the proxy's side of every wall.
//!
//! Two kernels see the surface: a narrow one and a wide one. Where both agree, the wide one
//! counts, in which the stairs of voxels hardly show; at edges and small features, where they
//! do not, the narrow one. A blur pulls a bent surface toward its inner side, by half its
//! variance times the curvature; that is measured around the point at the end, and undone.
//!
//! Frame: mm along the axes of the world's grid.

use super::cache::{NearFields, PlacedField};
use super::field::{Field, Level};
use super::half_spaces::{HalfSpace, nearest};
use super::{Smoother, smooth_step};
use glam::{DMat3, DVec3};

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query {
    /// The device.
    pub(crate) device: DVec3,
    /// The proxy.
    pub(crate) proxy: DVec3,
    /// The body that holds it; none where it is free.
    pub(crate) held_by: Option<u8>,
}

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    /// The smooth contact point; the device where no surface is above it.
    pub(crate) point: DVec3,
    /// How far it is to be believed, 0..=1; the rest belongs to the proxy.
    pub(crate) weight: f64,
    /// Samples of fields taken.
    pub(crate) samples: u32,
}

/// A body's surface as seen from a point.
#[derive(Clone, Copy, Debug)]
struct Surface {
    outward: DVec3,
    /// How far the point is under it [mm].
    depth: f64,
    /// Share of the wide kernel in both.
    wide: f64,
    /// Outward by the wide kernel alone.
    wide_outward: DVec3,
}

/// Levels whose change over a cell is less tell no direction.
const FLATTEST: f64 = 2e-3;

/// Finds the smooth contact point.
pub(crate) fn descend<F: Field>(
    smoother: &Smoother,
    fields: &NearFields<'_, F>,
    query: &Query,
) -> Found {
    let length = fields
        .iter()
        .map(|field| field.cell_length)
        .fold(f64::INFINITY, f64::min);
    let mut search = Search {
        smoother,
        fields,
        query,
        length,
        samples: 0,
    };
    let surfaces = search.surfaces(query.proxy);
    let weight = search.weight(&surfaces);
    if weight == 0.0 {
        return Found {
            point: query.proxy,
            weight,
            samples: search.samples,
        };
    }
    let (at, surfaces) = search.settle(surfaces);
    Found {
        point: search.corrected(at, &surfaces),
        weight,
        samples: search.samples,
    }
}

/// The surfaces of the bodies as seen from a point; fewer where some have none there.
type Surfaces = [Option<Surface>; super::cache::MAX_FIELDS];

struct Search<'a, F> {
    smoother: &'a Smoother,
    fields: &'a NearFields<'a, F>,
    query: &'a Query,
    /// The shortest edge of a cell [mm].
    length: f64,
    samples: u32,
}

impl<F: Field> Search<'_, F> {
    /// How far the surfaces near the proxy can be believed: not where it is deep below one, as
    /// in a narrow gap, nor where the one that holds it is far below, as with a thin rod.
    fn weight(&self, at_proxy: &Surfaces) -> f64 {
        let mut farthest = 0.0_f64;
        let mut known = self.query.held_by.is_none();
        for (surface, field) in at_proxy.iter().zip(self.fields.iter()) {
            let holds = self.query.held_by == Some(field.body);
            let Some(surface) = surface else {
                continue;
            };
            known |= holds;
            let depth = surface.depth / self.length;
            farthest = farthest.max(if holds { depth.abs() } else { depth });
        }
        let [near, far] = self.smoother.trusted;
        if known {
            1.0 - smooth_step(near, far, farthest)
        } else {
            0.0
        }
    }

    /// Steps from the proxy on, where `surfaces` are seen, until nothing changes; what is seen
    /// from there, or from less than the tolerance beside.
    fn settle(&mut self, mut surfaces: Surfaces) -> (DVec3, Surfaces) {
        let mut at = self.query.proxy;
        let mut last_step = DVec3::ZERO;
        let mut ease = 1.0;
        for _ in 0..self.smoother.max_steps {
            let mut step = goal(at, &surfaces, self.query.device) - at;
            step = step.clamp_length_max(self.smoother.longest_step * self.length);
            // to and fro between the sides of a valley: shorter steps end it
            if step.dot(last_step) < 0.0 {
                ease *= 0.5;
            }
            let next = self.within_reach(at + step * ease);
            last_step = next - at;
            if last_step.length() < self.smoother.tolerance * self.length {
                break;
            }
            at = next;
            surfaces = self.surfaces(at);
        }
        (at, surfaces)
    }

    fn surfaces(&mut self, at: DVec3) -> Surfaces {
        let mut surfaces = [None; super::cache::MAX_FIELDS];
        for (surface, field) in surfaces.iter_mut().zip(self.fields.iter()) {
            self.samples += 1;
            *surface = field.surface(at, self.smoother);
        }
        surfaces
    }

    /// A point no farther from the proxy than allowed.
    fn within_reach(&self, point: DVec3) -> DVec3 {
        let reach = self.smoother.reach * self.length;
        self.query.proxy + (point - self.query.proxy).clamp_length_max(reach)
    }

    /// The contact point after the pull of the blur is undone.
    fn corrected(&mut self, at: DVec3, surfaces: &Surfaces) -> DVec3 {
        let mut corrected = *surfaces;
        for (surface, field) in corrected.iter_mut().zip(self.fields.iter()) {
            if let Some(surface) = surface {
                let largest = self.smoother.largest_correction * self.length;
                let pull = field.pull(at, surface, self.smoother.baseline * self.length);
                // what stairs may have bent is left alone
                let [small, large] = self.smoother.curved;
                let share = surface.wide * smooth_step(small, large, pull.abs() / self.length);
                surface.depth += (share * pull).clamp(-largest, largest);
                self.samples += 4;
            }
        }
        let device = self.query.device;
        let change = goal(at, &corrected, device) - goal(at, surfaces, device);
        self.within_reach(at + change)
    }
}

/// The point nearest to the device on the free side of all surfaces seen from a point.
fn goal(at: DVec3, surfaces: &Surfaces, device: DVec3) -> DVec3 {
    // one surface, as nearly always
    if let [Some(surface), None, None] = surfaces {
        let under = surface.depth - surface.outward.dot(device - at);
        return device + surface.outward * under.max(0.0);
    }
    let mut planes = [HalfSpace {
        outward: DVec3::X,
        offset: f64::NEG_INFINITY,
    }; super::cache::MAX_FIELDS];
    let mut count = 0;
    for (plane, surface) in planes.iter_mut().zip(surfaces.iter().flatten()) {
        *plane = HalfSpace {
            outward: surface.outward,
            offset: surface.depth,
        };
        count += 1;
    }
    // from the point, so that rounding stays relative to the way
    at + nearest(&planes[..count], device - at)
}

impl<F: Field> PlacedField<'_, F> {
    /// The surface as seen from a point; none where the level tells nothing.
    #[inline]
    fn surface(&self, at: DVec3, smoother: &Smoother) -> Option<Surface> {
        let kernel = self.field.kernel();
        let axes = &self.field_from_world_mm.matrix3;
        let sample = self
            .field
            .sample(self.field_from_world_mm.transform_point3(at));
        let (wide_outward, wide_depth) = plane(&sample.wide, kernel.wide, kernel.cell, axes)?;
        let all_wide = Surface {
            outward: wide_outward,
            depth: wide_depth,
            wide: 1.0,
            wide_outward,
        };
        let Some((outward, depth)) = plane(&sample.fine, kernel.fine, kernel.cell, axes) else {
            return Some(all_wide);
        };

        // the wide kernel where it agrees with the narrow one
        let apart = (wide_depth - depth).abs() / self.cell_length;
        let turned = (wide_outward - outward).length_squared();
        let [near, far] = smoother.agreed_depth;
        let [alike, unlike] = smoother.agreed_turn.map(|chord| chord * chord);
        if apart <= near && turned <= alike {
            return Some(all_wide);
        }
        let wide =
            (1.0 - smooth_step(near, far, apart)) * (1.0 - smooth_step(alike, unlike, turned));
        Some(Surface {
            outward: outward.lerp(wide_outward, wide).normalize_or(outward),
            depth: depth + (wide_depth - depth) * wide,
            wide,
            wide_outward,
        })
    }

    /// How far the wide kernel pulls the surface inward [mm]: half its variance times the
    /// curvature, along two directions of the surface, from normals `baseline` to each side.
    fn pull(&self, at: DVec3, surface: &Surface, baseline: f64) -> f64 {
        let kernel = self.field.kernel();
        let axes = self.field_from_world_mm.matrix3;
        let outward = |at: DVec3| {
            let at = self.field_from_world_mm.transform_point3(at);
            let gradient = axes.transpose() * self.field.wide_gradient(at);
            (-gradient).normalize_or(surface.wide_outward)
        };
        let (first, second) = surface.wide_outward.any_orthonormal_pair();
        let pulls = [first, second].map(|tangent| {
            let aside = tangent * baseline;
            let turn = outward(at + aside) - outward(at - aside);
            let curvature = turn.dot(tangent) / (2.0 * baseline);
            // the kernel's width along the tangent, in mm, by the axes of the body
            let along = axes * tangent * self.spacing;
            let variance = (along * self.spacing * kernel.wide).length_squared();
            0.5 * variance * curvature
        });
        pulls.iter().sum()
    }
}

/// The plane that a level stands for, from where it was sampled: outward, and how far the
/// point is under it [mm].
///
/// A blurred edge rises like the integral of a Gaussian, so that value over slope tells the
/// distance; the root keeps it right, within a tenth, up to 1.5 σ on either side.
fn plane(level: &Level, sigma: DVec3, cell: DVec3, axes: &DMat3) -> Option<(DVec3, f64)> {
    // written so that NaN is refused
    if !((level.gradient * cell).length_squared() > FLATTEST * FLATTEST) {
        return None;
    }
    let gradient = axes.transpose() * level.gradient;
    let per_steepness = gradient.length_recip();
    // σ across the surface, times its steepness
    let rise = (level.gradient * sigma).length_squared();
    let above = level.value - 0.5;
    let share = (rise / (rise + above * above / 3.0)).sqrt();
    Some((gradient * -per_steepness, above * per_steepness * share))
}
