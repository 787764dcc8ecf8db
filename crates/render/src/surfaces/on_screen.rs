//! The corners of surfaces as they are on the screen, and which triangles each band of rows has to draw.

use std::borrow::Cow;

use glam::{DVec2, DVec3, DVec4, Vec4};
use palpate_volume::simd_dispatch::SimdLevel;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::draw::Request;
use crate::surfaces::{DrawnSurface, SegmentSurface, Triangles};

/// Parts of a pixel to which corners are rounded, so that it is exact which pixels a triangle covers: none is left out
/// between two triangles, and none is drawn twice.
pub(super) const PARTS: i32 = 256;

/// Farthest place of a corner on the screen [pixels].
const FARTHEST: f32 = 1e6;

/// Nothing nearer to the eye is drawn [mm].
const NEAREST: f32 = 1e-2;

/// Surfaces on the screen.
#[derive(Debug)]
pub(crate) struct OnScreen<'a> {
    pub surfaces: Vec<DrawnSurface<'a>>,
    pub(super) patches: Vec<PatchOnScreen<'a>>,
    pub(super) in_perspective: bool,
    pub(super) level: SimdLevel,
}

/// Something of each corner.
type OfCorners<'a> = Cow<'a, [[f32; 3]]>;

/// A part of a surface on the screen.
#[derive(Debug)]
pub(super) struct PatchOnScreen<'a> {
    /// Number of its surface.
    pub surface: u32,
    pub triangles: &'a dyn Triangles,
    pub corners: Vec<Corner>,
    pub normals: OfCorners<'a>,
    /// Triangles by band: those of the i-th band from `first` on lie from `starts[i]` to `starts[i + 1]`.
    first: usize,
    starts: Vec<u32>,
    order: Vec<u32>,
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// To the right and down [parts of a pixel].
    pub x: i32,
    pub y: i32,
    /// Of view [mm]; not above 0 where it is not before the eye.
    pub depth: f32,
}

/// Takes positions of a surface to the screen: numbers to the right and up, which are divided by depth in perspective.
struct Projection {
    right: Vec4,
    up: Vec4,
    depth: Vec4,
    /// Where 0 lies [pixels].
    middle: (f32, f32),
    in_perspective: bool,
}

impl<'a> OnScreen<'a> {
    /// Takes all triangles to a picture in bands of so many rows.
    pub fn new(surfaces: Vec<DrawnSurface<'a>>, request: &Request, band: u32) -> Self {
        let Request {
            camera,
            size,
            shift,
            level,
            ..
        } = *request;
        let patches: Vec<(u32, &dyn Triangles)> = surfaces
            .iter()
            .zip(0..)
            .flat_map(|(it, number)| it.surface.patches.iter().map(move |p| (number, &**p)))
            .collect();
        let projections: Vec<Projection> = surfaces
            .iter()
            .map(|it| Projection::new(it.surface, &camera, size, shift))
            .collect();
        let patches = patches
            .into_par_iter()
            .map(|(surface, triangles)| {
                let drawn = &surfaces[surface as usize];
                let (positions, normals) = stood(drawn, triangles);
                let corners = projections[surface as usize].corners_of(&positions);
                let is_wire = drawn.shown.is_wireframe;
                PatchOnScreen::new(
                    surface,
                    triangles,
                    (corners, normals),
                    (size, band, is_wire),
                )
            })
            .collect();
        Self {
            surfaces,
            patches,
            in_perspective: camera.parallel.is_none(),
            level,
        }
    }

    /// Triangles that may lie in a band.
    pub(super) fn in_band(
        &self,
        band: usize,
    ) -> impl Iterator<Item = (&PatchOnScreen<'a>, [u32; 3])> {
        self.patches.iter().flat_map(move |patch| {
            let corners = patch.triangles.corners();
            let numbers = patch.in_band(band).iter();
            numbers.map(move |&number| (patch, corners[number as usize]))
        })
    }

    /// Whether a band has any triangle.
    pub fn has_any(&self, band: usize) -> bool {
        self.patches
            .iter()
            .any(|patch| !patch.in_band(band).is_empty())
    }
}

impl<'a> PatchOnScreen<'a> {
    fn new(
        surface: u32,
        triangles: &'a dyn Triangles,
        (corners, normals): (Vec<Corner>, OfCorners<'a>),
        (size, band, is_wire): ((u32, u32), u32, bool),
    ) -> Self {
        let bands: Vec<Option<(u32, u32)>> = triangles
            .corners()
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(|corner| corners[corner as usize]);
                let rows = rows_of([a, b, c], size, is_wire)?;
                Some((rows.0 / band, rows.1 / band))
            })
            .collect();
        let first = bands.iter().flatten().map(|it| it.0).min().unwrap_or(0);
        let last = bands.iter().flatten().map(|it| it.1).max().unwrap_or(0);
        let mut starts = vec![0_u32; (last - first) as usize + 2];
        for &(from, to) in bands.iter().flatten() {
            for band in from..=to {
                starts[(band - first) as usize + 1] += 1;
            }
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut order = vec![0; starts[starts.len() - 1] as usize];
        for (number, bands) in bands.iter().enumerate() {
            for band in bands.iter().flat_map(|&(from, to)| from..=to) {
                let place = &mut next[(band - first) as usize];
                order[*place as usize] = number as u32;
                *place += 1;
            }
        }
        Self {
            surface,
            triangles,
            corners,
            normals,
            first: first as usize,
            starts,
            order,
        }
    }

    fn in_band(&self, band: usize) -> &[u32] {
        let Some(i) = band
            .checked_sub(self.first)
            .filter(|i| i + 1 < self.starts.len())
        else {
            return &[];
        };
        &self.order[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}

/// Positions and normals of corners where they stand, those that are shared where nothing displaces them.
fn stood<'a>(
    drawn: &DrawnSurface<'_>,
    triangles: &'a dyn Triangles,
) -> (OfCorners<'a>, OfCorners<'a>) {
    let moving = drawn.moving.as_ref();
    match moving.and_then(|it| it.corners(triangles)) {
        Some((positions, normals)) => (positions.into(), normals.into()),
        None => (triangles.positions().into(), triangles.normals().into()),
    }
}

/// The first and last row of a triangle; none where it is not before the eye or covers no pixel's middle.
fn rows_of(corners: [Corner; 3], size: (u32, u32), is_wire: bool) -> Option<(u32, u32)> {
    if corners.iter().any(|corner| corner.depth < NEAREST) {
        return None;
    }
    let within = |places: [i32; 3], count: u32| {
        let low = places.into_iter().min()?;
        let high = places.into_iter().max()?;
        // lines are drawn in the pixels in which they lie, triangles in those whose middles they cover
        let (first, last) = if is_wire {
            (low.div_euclid(PARTS), high.div_euclid(PARTS))
        } else {
            (first_middle(low), last_middle(high))
        };
        let (first, last) = (first.max(0), last.min(count as i32 - 1));
        (first <= last).then_some((first as u32, last as u32))
    };
    within(corners.map(|corner| corner.x), size.0)?;
    within(corners.map(|corner| corner.y), size.1)
}

/// The first pixel whose middle is not before a place, and the last whose middle is not behind it.
pub(super) fn first_middle(place: i32) -> i32 {
    (place + PARTS / 2 - 1).div_euclid(PARTS)
}

pub(super) fn last_middle(place: i32) -> i32 {
    (place - PARTS / 2).div_euclid(PARTS)
}

impl Projection {
    fn new(surface: &SegmentSurface, camera: &Camera, size: (u32, u32), shift: (f32, f32)) -> Self {
        let in_perspective = camera.parallel.is_none();
        let pixels = DVec2::new(f64::from(size.0), f64::from(size.1)) / 2.0;
        let half = (camera.field / 2.0).tan() * camera.parallel.map_or(1.0, |_| camera.distance);
        // half the picture is as many pixels wide as it is mm, at 1 mm of depth in perspective
        let scale = pixels.y / half;
        let begin = surface.pose.transform_point3(surface.origin) - camera.eye();
        let row = |axis: DVec3| -> DVec4 {
            (surface.pose.matrix3.transpose() * axis).extend(axis.dot(begin))
        };
        let depth = row(-camera.back);
        let mut right = row(camera.right) * scale;
        let mut middle = (pixels.x, pixels.y);
        let aside = camera.aside * scale;
        if in_perspective {
            middle.0 += aside;
        } else {
            right += depth * aside;
        }
        Self {
            right: right.as_vec4(),
            up: (row(camera.up) * scale).as_vec4(),
            depth: depth.as_vec4(),
            middle: (middle.0 as f32 - shift.0, middle.1 as f32 - shift.1),
            in_perspective,
        }
    }

    fn corners_of(&self, positions: &[[f32; 3]]) -> Vec<Corner> {
        positions
            .iter()
            .map(|&[x, y, z]| self.corner(Vec4::new(x, y, z, 1.0)))
            .collect()
    }

    fn corner(&self, position: Vec4) -> Corner {
        let depth = self.depth.dot(position);
        let share = if self.in_perspective {
            1.0 / depth
        } else {
            1.0
        };
        let x = self.middle.0 + share * self.right.dot(position);
        let y = self.middle.1 - share * self.up.dot(position);
        let parts = |place: f32| (place.clamp(-FARTHEST, FARTHEST) * PARTS as f32).round() as i32;
        Corner {
            x: parts(x),
            y: parts(y),
            depth,
        }
    }
}
