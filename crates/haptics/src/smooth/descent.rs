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
use glam::{DVec3, Vec3A};

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query {
    /// Vector from the proxy to the device [mm].
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
    /// Weight of the point, 0..=1; the rest belongs to the proxy.
    pub(crate) weight: f64,
    /// Samples of fields taken.
    pub(crate) samples: u32,
}

/// A body's surface as seen from a point.
#[derive(Clone, Copy, Debug)]
struct Surface {
    outward: Vec3A,
    /// Depth of the point under the plane [mm].
    depth: f32,
    /// Share of the wide kernel in both.
    wide: f32,
    /// Plane of the wide kernel alone.
    wide_plane: Plane,
}

impl Surface {
    /// Follows a short displacement of the point [mm]: the depth changes, the normal stays.
    fn move_point(&mut self, way: Vec3A) {
        self.depth -= self.outward.dot(way);
        let plane = &mut self.wide_plane;
        plane.above -= plane.outward.dot(way) / plane.per_steepness;
    }
}

/// The plane that a level stands for, as seen from a point.
#[derive(Clone, Copy, Debug)]
struct Plane {
    outward: Vec3A,
    /// Depth of the point under the plane [mm].
    depth: f32,
    /// The level at the point, beyond ½.
    above: f32,
    /// One by its change [mm].
    per_steepness: f32,
}

/// The surfaces of the bodies as seen from a point; fewer where some have none there.
type Surfaces<const N: usize> = [Option<Surface>; N];

/// Levels whose change from node to node is less tell no direction.
const FLATTEST: f32 = 2e-3;

/// Finds the smooth contact point.
pub(crate) fn descend<F: Field>(
    smoother: &Smoother,
    fields: &NearFields<'_, F>,
    query: &Query,
) -> Found {
    // one field, as nearly always
    match fields.only() {
        Some(only) => Search::new(smoother, [Some(only)], query).find(query),
        None => descend_on_all(smoother, fields, query),
    }
}

/// The search on several fields; apart, so that the search on one stays short.
#[inline(never)]
fn descend_on_all<F: Field>(
    smoother: &Smoother,
    fields: &NearFields<'_, F>,
    query: &Query,
) -> Found {
    Search::new(smoother, fields.all(), query).find(query)
}

/// The search; its frame has its origin in the proxy, mm along the axes of the world's grid.
struct Search<'a, F, const N: usize> {
    smoother: &'a Smoother,
    fields: [Option<&'a PlacedField<'a, F>>; N],
    device: Vec3A,
    /// Vector from a ball's centre to where it touches each body [mm]; zero for a point.
    contacts: [Vec3A; N],
    /// Last correction of each contact, and the fraction of it that was applied.
    turns: [Pace; N],
    /// The largest of those [mm²].
    largest_turn: f32,
    /// The shortest edge of a cell [mm].
    length: f32,
    /// Farthest from the proxy [mm].
    reach: f32,
    samples: u32,
}

/// A way that is asked for again and again, each time from where the last one led, and the share
/// of it that is taken.
#[derive(Clone, Copy, Debug)]
struct Pace {
    way: Vec3A,
    share: f32,
}

impl Pace {
    const FIRST: Self = Self {
        way: Vec3A::ZERO,
        share: 1.0,
    };

    /// The share to take of the next way, so that the one after it is none where all goes on
    /// evenly (the secant rule). So ways that swing to and fro, as between the sides of a valley
    /// or a ball's turns on a bent surface, come to an end, and those that shrink slowly do sooner.
    fn next(&self, way: Vec3A) -> Self {
        let square = self.way.length_squared();
        let ratio = self.way.dot(way) / square;
        let share = if square > 0.0 && ratio < 0.9 {
            (self.share / (1.0 - ratio)).clamp(0.2, 1.5)
        } else {
            self.share
        };
        Self { way, share }
    }

    /// The pace where no more than this step could be taken.
    fn with_step(&self, step: Vec3A) -> Self {
        let share = step.dot(self.way) / self.way.length_squared();
        Self {
            // no way has no share
            share: if share > 0.0 {
                share.clamp(0.05, 1.5)
            } else {
                self.share
            },
            ..*self
        }
    }
}

impl<'a, F: Field, const N: usize> Search<'a, F, N> {
    fn new(
        smoother: &'a Smoother,
        fields: [Option<&'a PlacedField<'a, F>>; N],
        query: &Query,
    ) -> Self {
        let lengths = fields.iter().flatten().map(|field| field.cell);
        let length = lengths.fold(f32::INFINITY, f32::min);
        let [of_point, of_ball] = smoother.reach_by_thickness;
        let farther = fields.iter().flatten().map(|field| {
            let share = if field.is_of_ball() {
                of_ball
            } else {
                of_point
            };
            share * field.thickness()
        });
        Self {
            smoother,
            fields,
            device: query.device.as_vec3a(),
            contacts: fields.map(|field| field.map_or(Vec3A::ZERO, |field| field.contact)),
            turns: [Pace::FIRST; N],
            largest_turn: 0.0,
            length,
            reach: smoother.reach * length + farther.fold(0.0, f32::max),
            samples: 0,
        }
    }

    fn find(mut self, query: &Query) -> Found {
        let surfaces = self.surfaces(Vec3A::ZERO);
        let weight = self.weight(&surfaces, query.held_by);
        if weight == 0.0 {
            return Found {
                point: DVec3::ZERO,
                weight: 0.0,
                samples: self.samples,
            };
        }
        let (at, surfaces) = self.settle(surfaces);
        let corrected = self.corrected(at, &surfaces);
        // what is at the device is there to the bit
        let free = corrected == self.device;
        Found {
            point: if free {
                query.device
            } else {
                corrected.as_dvec3()
            },
            weight: f64::from(weight),
            samples: self.samples,
        }
    }

    /// How far the surfaces near the proxy can be believed: not where it is deep below one, as
    /// in a narrow gap, nor where the one that holds it is far below, as with a thin rod.
    fn weight(&self, at_proxy: &Surfaces<N>, held_by: Option<u8>) -> f32 {
        let mut farthest = 0.0_f32;
        let mut known = held_by.is_none();
        for (surface, field) in at_proxy.iter().zip(&self.fields) {
            let (Some(surface), Some(field)) = (surface, field) else {
                continue;
            };
            let holds = held_by == Some(field.body);
            known |= holds;
            let mut depth = surface.depth / self.length;
            if field.is_of_ball() && holds {
                let overshoot = field.overshoot(surface.outward) / self.length;
                depth = (depth + overshoot).min(depth.max(0.0));
            }
            farthest = farthest.max(if holds { depth.abs() } else { depth });
        }
        if known {
            1.0 - smooth_step(self.smoother.trusted, farthest)
        } else {
            0.0
        }
    }

    /// Steps from the proxy on, where `surfaces` are seen, until nothing changes; what is seen
    /// from there, or from so near that it would hardly look otherwise.
    fn settle(&mut self, mut surfaces: Surfaces<N>) -> (Vec3A, Surfaces<N>) {
        let tolerance = self.smoother.tolerance * self.length;
        let longest = self.smoother.longest_step * self.length;
        let turned = self.smoother.turned * self.length;
        let mut at = Vec3A::ZERO;
        let mut pace = Pace::FIRST;
        for _ in 0..self.smoother.max_steps {
            let before = pace.way.length_squared();
            let way = goal(at, &surfaces, self.device) - at;
            pace = pace.next(way);
            let next = self.within_reach(at + (way * pace.share).clamp_length_max(longest));
            let step = next - at;
            pace = pace.with_step(step);
            let settled = self.largest_turn <= turned * turned;
            if settled && step.length_squared() < tolerance * tolerance {
                break;
            }
            at = next;
            // ways shrink by about the same share: the next one would be too short
            let square = way.length_squared();
            if settled && square * square < tolerance * tolerance * before {
                for surface in surfaces.iter_mut().flatten() {
                    surface.move_point(step);
                }
                break;
            }
            surfaces = self.surfaces(at);
        }
        (at, surfaces)
    }

    /// The surfaces as seen from the probe's middle, each where the probe touches it.
    #[inline]
    fn surfaces(&mut self, at: Vec3A) -> Surfaces<N> {
        self.largest_turn = 0.0;
        let mut surfaces = [None; N];
        for (number, field) in self.fields.into_iter().enumerate() {
            let Some(field) = field else { continue };
            self.samples += 1;
            let contact = self.contacts[number];
            surfaces[number] = field.surface(at + contact, self.smoother);
            if contact != Vec3A::ZERO
                && let Some(surface) = &mut surfaces[number]
            {
                self.turn(number, surface);
            }
        }
        surfaces
    }

    /// Turns the contact of a ball with a body toward where its surface is nearest, as seen from
    /// the old one, and tells the surface as seen from the ball's middle.
    fn turn(&mut self, number: usize, surface: &mut Surface) {
        let contact = self.contacts[number];
        let radius = contact.length();
        // the ball is under by more where the plane is not square to the contact
        surface.depth += radius + surface.outward.dot(contact);
        let wanted = surface.outward * -radius;
        let turn = self.turns[number].next(wanted - contact);
        self.turns[number] = turn;
        self.largest_turn = self.largest_turn.max(turn.way.length_squared());
        let turned = contact + turn.way * turn.share;
        self.contacts[number] = turned.normalize_or_zero() * radius;
    }

    /// A point no farther from the proxy than allowed.
    fn within_reach(&self, point: Vec3A) -> Vec3A {
        point.clamp_length_max(self.reach)
    }

    /// The contact point after the pull of the blur is undone.
    fn corrected(&mut self, at: Vec3A, surfaces: &Surfaces<N>) -> Vec3A {
        let largest = self.smoother.largest_correction * self.length;
        let mut corrected = *surfaces;
        for ((surface, field), contact) in
            corrected.iter_mut().zip(&self.fields).zip(&self.contacts)
        {
            let (Some(surface), Some(field)) = (surface, field) else {
                continue;
            };
            if surface.wide == 0.0 {
                continue;
            }
            let pull = field.pull(at + *contact, surface, self.smoother.baseline * self.length);
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
fn goal<const N: usize>(at: Vec3A, surfaces: &Surfaces<N>, device: Vec3A) -> Vec3A {
    // one surface, as nearly always
    let mut seen = surfaces.iter().flatten();
    if let (Some(surface), None) = (seen.next(), seen.next()) {
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

impl<F: Field> PlacedField<'_, F> {
    /// A point of the search among the nodes.
    #[inline]
    fn nodes_from_point(&self, at: Vec3A) -> Vec3A {
        self.proxy + self.nodes_from_search * at
    }

    fn is_of_ball(&self) -> bool {
        self.contact != Vec3A::ZERO
    }

    /// Difference of the longest and the shortest edge of a voxel [mm].
    fn thickness(&self) -> f32 {
        self.voxel.max_element() - self.voxel.min_element()
    }

    /// How much too far away a ball may be kept by its cells [mm]: by about one of them.
    fn overshoot(&self, outward: Vec3A) -> f32 {
        let in_nodes = self.nodes_from_search * outward;
        let along_axes = in_nodes.abs() * self.field.cell() * self.voxel;
        along_axes.dot(self.voxel)
    }

    /// The surface as seen from a point; none where the level tells nothing.
    #[inline]
    fn surface(&self, at: Vec3A, smoother: &Smoother) -> Option<Surface> {
        let kernel = self.field.kernel();
        let sample = self.field.sample(self.nodes_from_point(at));
        let wide_plane = self.plane(&sample.wide, kernel.wide)?;
        let all_wide = Surface {
            outward: wide_plane.outward,
            depth: wide_plane.depth,
            wide: 1.0,
            wide_plane,
        };
        let Some(fine) = self.plane(&sample.fine, kernel.fine) else {
            return Some(all_wide);
        };

        // the wide kernel where it agrees with the narrow one
        let apart = (wide_plane.depth - fine.depth).abs() / self.cell;
        let turned = (wide_plane.outward - fine.outward).length_squared();
        let alike = smoother.agreed_turn.map(|chord| chord * chord);
        if apart <= smoother.agreed_depth[0] && turned <= alike[0] {
            return Some(all_wide);
        }
        let wide =
            (1.0 - smooth_step(smoother.agreed_depth, apart)) * (1.0 - smooth_step(alike, turned));
        Some(Surface {
            outward: (fine.outward.lerp(wide_plane.outward, wide)).normalize_or(fine.outward),
            depth: fine.depth + (wide_plane.depth - fine.depth) * wide,
            wide,
            wide_plane,
        })
    }

    /// The plane that a level stands for, from where it was sampled: outward, and how far the
    /// point is under it [mm].
    ///
    /// A blurred edge rises like the integral of a Gaussian, so that value over slope tells the
    /// distance; the root keeps it right, within a tenth, up to 1.5 σ on either side.
    #[inline]
    fn plane(&self, level: &Level, sigma: Vec3A) -> Option<Plane> {
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
        Some(Plane {
            outward: gradient * -per_steepness,
            depth: above * per_steepness * share,
            above,
            per_steepness,
        })
    }

    /// How far the wide kernel pulls the surface inward [mm]: half its variance times the
    /// curvature, summed over the surface, from the levels at three points around.
    fn pull(&self, at: Vec3A, surface: &Surface, baseline: f32) -> f32 {
        let plane = &surface.wide_plane;
        let (first, second) = plane.outward.any_orthonormal_pair();
        // a triangle measures the sum over two directions without bias
        const HALF_ROOT: f32 = 0.866_025_4;
        let tangents = [
            first,
            first * -0.5 + second * HALF_ROOT,
            first * -0.5 - second * HALF_ROOT,
        ];
        let middle = self.nodes_from_point(at);
        let bends = tangents.map(|tangent| {
            let in_nodes = self.nodes_from_search * tangent;
            let above = self.field.wide_value(middle + in_nodes * baseline) - 0.5;
            // the kernel's width along the tangent
            let variance = (in_nodes * in_nodes).dot(self.wide_variance);
            (plane.above - above) * variance
        });
        // a level falls with the square of the way aside
        let per_square = 2.0 / (baseline * baseline);
        bends.iter().sum::<f32>() * plane.per_steepness * per_square / 3.0
    }
}
