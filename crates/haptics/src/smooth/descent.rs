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
//! Frame: mm along the axes of the world's grid, from the proxy on, so that single precision
//! is plenty.

use super::cache::{MAX_FIELDS, NearFields, PlacedField};
use super::field::{Field, Level};
use super::half_spaces::{HalfSpace, nearest};
use super::{Smoother, smooth_step};
use glam::{Affine3A, DAffine3, DVec3, Mat3A, Vec3A};

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query {
    /// The proxy, in mm from the corner of the world's grid.
    pub(crate) proxy: DVec3,
    /// From the proxy to the device [mm].
    pub(crate) device: DVec3,
    /// The body that holds the proxy; none where it is free.
    pub(crate) held_by: Option<u8>,
}

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    /// From the proxy to the smooth contact point [mm]; to the device where no surface is
    /// above that.
    pub(crate) point: DVec3,
    /// How far it is to be believed, 0..=1; the rest belongs to the proxy.
    pub(crate) weight: f64,
    /// Samples of fields taken.
    pub(crate) samples: u32,
}

/// A body's surface as seen from a point.
#[derive(Clone, Copy, Debug)]
struct Surface {
    outward: Vec3A,
    /// How far the point is under it [mm].
    depth: f32,
    /// Share of the wide kernel in both.
    wide: f32,
    /// Outward by the wide kernel alone.
    wide_outward: Vec3A,
}

/// The surfaces of the bodies as seen from a point; fewer where some have none there.
type Surfaces = [Option<Surface>; MAX_FIELDS];

/// Levels whose change from node to node is less tell no direction.
const FLATTEST: f32 = 2e-3;

/// Finds the smooth contact point.
pub(crate) fn descend<F: Field>(
    smoother: &Smoother,
    fields: &NearFields<'_, F>,
    query: &Query,
) -> Found {
    let mut search = Search::new(smoother, fields, query);
    let surfaces = search.surfaces(Vec3A::ZERO);
    let weight = search.weight(&surfaces, query.held_by);
    if weight == 0.0 {
        return Found {
            point: DVec3::ZERO,
            weight: 0.0,
            samples: search.samples,
        };
    }
    let (at, surfaces) = search.settle(surfaces);
    let corrected = search.corrected(at, &surfaces);
    // what is at the device is there to the bit
    let free = corrected == search.device;
    Found {
        point: if free {
            query.device
        } else {
            corrected.as_dvec3()
        },
        weight: f64::from(weight),
        samples: search.samples,
    }
}

/// A field as the search sees it.
#[derive(Clone, Copy)]
struct Seen<'a, F> {
    field: &'a F,
    body: u8,
    /// Takes the search's frame to the field's nodes.
    nodes_from_search: Affine3A,
    /// Takes gradients from there to the search's frame.
    gradient_from_nodes: Mat3A,
    /// The shortest way from a node to the next [mm].
    cell: f32,
    /// Variance of the wide kernel along the axes of the body [mm²], and these axes.
    wide_variance: Vec3A,
}

/// The search; its frame has its origin in the proxy, mm along the axes of the world's grid.
struct Search<'a, F> {
    smoother: &'a Smoother,
    fields: [Option<Seen<'a, F>>; MAX_FIELDS],
    device: Vec3A,
    /// The shortest edge of a cell [mm].
    length: f32,
    samples: u32,
}

impl<'a, F: Field> Search<'a, F> {
    fn new(smoother: &'a Smoother, fields: &NearFields<'a, F>, query: &Query) -> Self {
        let mut seen = [const { None }; MAX_FIELDS];
        let mut length = f32::INFINITY;
        for (seen, field) in seen.iter_mut().zip(fields.iter()) {
            let field = Seen::new(field, query.proxy);
            length = length.min(field.cell);
            *seen = Some(field);
        }
        Self {
            smoother,
            fields: seen,
            device: query.device.as_vec3a(),
            length,
            samples: 0,
        }
    }

    /// How far the surfaces near the proxy can be believed: not where it is deep below one, as
    /// in a narrow gap, nor where the one that holds it is far below, as with a thin rod.
    fn weight(&self, at_proxy: &Surfaces, held_by: Option<u8>) -> f32 {
        let mut farthest = 0.0_f32;
        let mut known = held_by.is_none();
        for (surface, field) in at_proxy.iter().zip(&self.fields) {
            let (Some(surface), Some(field)) = (surface, field) else {
                continue;
            };
            let holds = held_by == Some(field.body);
            known |= holds;
            let depth = surface.depth / self.length;
            farthest = farthest.max(if holds { depth.abs() } else { depth });
        }
        if known {
            1.0 - smooth_step(self.smoother.trusted, farthest)
        } else {
            0.0
        }
    }

    /// Steps from the proxy on, where `surfaces` are seen, until nothing changes; what is seen
    /// from there, or from less than the tolerance beside.
    fn settle(&mut self, mut surfaces: Surfaces) -> (Vec3A, Surfaces) {
        let tolerance = self.smoother.tolerance * self.length;
        let longest = self.smoother.longest_step * self.length;
        let mut at = Vec3A::ZERO;
        let mut last_step = Vec3A::ZERO;
        let mut ease = 1.0;
        for _ in 0..self.smoother.max_steps {
            let step = (goal(at, &surfaces, self.device) - at).clamp_length_max(longest);
            // to and fro between the sides of a valley: shorter steps end it
            if step.dot(last_step) < 0.0 {
                ease *= 0.5;
            }
            let next = self.within_reach(at + step * ease);
            last_step = next - at;
            if last_step.length_squared() < tolerance * tolerance {
                break;
            }
            at = next;
            surfaces = self.surfaces(at);
        }
        (at, surfaces)
    }

    #[inline]
    fn surfaces(&mut self, at: Vec3A) -> Surfaces {
        let mut surfaces = [None; MAX_FIELDS];
        for (surface, field) in surfaces.iter_mut().zip(&self.fields) {
            let Some(field) = field else { break };
            self.samples += 1;
            *surface = field.surface(at, self.smoother);
        }
        surfaces
    }

    /// A point no farther from the proxy than allowed.
    fn within_reach(&self, point: Vec3A) -> Vec3A {
        point.clamp_length_max(self.smoother.reach * self.length)
    }

    /// The contact point after the pull of the blur is undone.
    fn corrected(&mut self, at: Vec3A, surfaces: &Surfaces) -> Vec3A {
        let largest = self.smoother.largest_correction * self.length;
        let mut corrected = *surfaces;
        for (surface, field) in corrected.iter_mut().zip(&self.fields) {
            let (Some(surface), Some(field)) = (surface, field) else {
                continue;
            };
            if surface.wide == 0.0 {
                continue;
            }
            let pull = field.pull(at, surface, self.smoother.baseline * self.length);
            // what stairs may have bent is left alone
            let share = surface.wide * smooth_step(self.smoother.curved, pull.abs() / self.length);
            surface.depth += (share * pull).clamp(-largest, largest);
            self.samples += 3;
        }
        let goal = |surfaces| goal(at, surfaces, self.device);
        let [plain, corrected] = [goal(surfaces), goal(&corrected)];
        // nothing is above the device, and the way there was not cut short
        let near = self.smoother.tolerance * self.length;
        if corrected == self.device && at.distance_squared(self.device) <= near * near {
            return self.device;
        }
        self.within_reach(at + (corrected - plain))
    }
}

/// The point nearest to the device on the free side of all surfaces seen from a point.
#[inline]
fn goal(at: Vec3A, surfaces: &Surfaces, device: Vec3A) -> Vec3A {
    // one surface, as nearly always
    if let [Some(surface), None, None] = surfaces {
        let under = surface.depth - surface.outward.dot(device - at);
        return device + surface.outward * under.max(0.0);
    }
    let mut planes = [HalfSpace {
        outward: DVec3::X,
        offset: f64::NEG_INFINITY,
    }; MAX_FIELDS];
    let mut count = 0;
    for (plane, surface) in planes.iter_mut().zip(surfaces.iter().flatten()) {
        *plane = HalfSpace {
            outward: surface.outward.as_dvec3().normalize(),
            offset: f64::from(surface.depth),
        };
        count += 1;
    }
    // from the point, so that rounding stays relative to the way
    at + nearest(&planes[..count], (device - at).as_dvec3()).as_vec3a()
}

impl<'a, F: Field> Seen<'a, F> {
    fn new(placed: &PlacedField<'a, F>, origin: DVec3) -> Self {
        let map = placed.nodes_from_mm;
        let nodes_from_search =
            DAffine3::from_mat3_translation(map.matrix3, map.transform_point3(origin));
        let sigma = placed.field.kernel().wide.as_dvec3() * placed.cell;
        Self {
            field: placed.field,
            body: placed.body,
            nodes_from_search: nodes_from_search.as_affine3a(),
            gradient_from_nodes: Mat3A::from(map.matrix3.transpose().as_mat3()),
            cell: placed.cell.min_element() as f32,
            wide_variance: (sigma * sigma * placed.cell * placed.cell).as_vec3a(),
        }
    }

    /// The surface as seen from a point; none where the level tells nothing.
    #[inline]
    fn surface(&self, at: Vec3A, smoother: &Smoother) -> Option<Surface> {
        let kernel = self.field.kernel();
        let sample = self
            .field
            .sample(self.nodes_from_search.transform_point3a(at));
        let (wide_outward, wide_depth) = self.plane(&sample.wide, kernel.wide)?;
        let all_wide = Surface {
            outward: wide_outward,
            depth: wide_depth,
            wide: 1.0,
            wide_outward,
        };
        let Some((outward, depth)) = self.plane(&sample.fine, kernel.fine) else {
            return Some(all_wide);
        };

        // the wide kernel where it agrees with the narrow one
        let apart = (wide_depth - depth).abs() / self.cell;
        let turned = (wide_outward - outward).length_squared();
        let alike = smoother.agreed_turn.map(|chord| chord * chord);
        if apart <= smoother.agreed_depth[0] && turned <= alike[0] {
            return Some(all_wide);
        }
        let wide =
            (1.0 - smooth_step(smoother.agreed_depth, apart)) * (1.0 - smooth_step(alike, turned));
        Some(Surface {
            outward: outward.lerp(wide_outward, wide).normalize_or(outward),
            depth: depth + (wide_depth - depth) * wide,
            wide,
            wide_outward,
        })
    }

    /// The plane that a level stands for, from where it was sampled: outward, and how far the
    /// point is under it [mm].
    ///
    /// A blurred edge rises like the integral of a Gaussian, so that value over slope tells the
    /// distance; the root keeps it right, within a tenth, up to 1.5 σ on either side.
    #[inline]
    fn plane(&self, level: &Level, sigma: Vec3A) -> Option<(Vec3A, f32)> {
        let steepness = level.gradient.length_squared();
        if steepness.is_nan() || steepness <= FLATTEST * FLATTEST {
            return None;
        }
        let gradient = self.gradient_from_nodes * level.gradient;
        let per_steepness = gradient.length_recip();
        // σ across the surface, times its steepness
        let rise = (level.gradient * sigma).length_squared();
        let above = level.value - 0.5;
        let share = (rise / (rise + above * above / 3.0)).sqrt();
        Some((gradient * -per_steepness, above * per_steepness * share))
    }

    /// How far the wide kernel pulls the surface inward [mm]: half its variance times the
    /// curvature, summed over the surface, from the normals at three points around.
    fn pull(&self, at: Vec3A, surface: &Surface, baseline: f32) -> f32 {
        let (first, second) = surface.wide_outward.any_orthonormal_pair();
        // a triangle measures the sum over two directions without bias
        const HALF_ROOT: f32 = 0.866_025_4;
        let tangents = [
            first,
            first * -0.5 + second * HALF_ROOT,
            first * -0.5 - second * HALF_ROOT,
        ];
        let pulls = tangents.map(|tangent| {
            let aside = at + tangent * baseline;
            let aside = self.nodes_from_search.transform_point3a(aside);
            let gradient = self.gradient_from_nodes * self.field.wide_gradient(aside);
            let outward = (-gradient).normalize_or(surface.wide_outward);
            // the kernel's width along the tangent
            let in_nodes = self.nodes_from_search.matrix3 * tangent;
            let variance = (in_nodes * in_nodes).dot(self.wide_variance);
            outward.dot(tangent) * variance
        });
        pulls.iter().sum::<f32>() / (3.0 * baseline)
    }
}
