//! Draws the triangles of a band of rows into its pixels: by whole numbers, so that each pixel on the edge between two
//! triangles belongs to one of them.
//!
//! Source: Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH (1988); Carpenter, "The A-buffer, an
//! antialiased hidden surface method", SIGGRAPH (1984), for lists of what can be seen through.

use std::ops::Range;

use glam::Vec3;
use palpate_volume::simd_dispatch::SimdLevel;

use crate::camera::RayFan;
use crate::shading::Shading;
use crate::surfaces::DrawnSurface;
use crate::surfaces::kept::{Kept, kept_of};
use crate::surfaces::on_screen::{Corner, OnScreen, PARTS, first_middle, last_middle};

/// Number of no fragment.
pub(crate) const NO_FRAGMENT: u32 = u32::MAX;

/// Depths between which two lines of a surface are one that two triangles share [mm].
const SAME_LINE: f32 = 1e-3;

/// A surface in a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment {
    /// Along the direction of view [mm].
    pub depth: f32,
    /// Not of unit length: where the scan has the segment, along the patient's axes; or of a plane that cuts it, along
    /// the grid's axes.
    pub normal: Vec3,
    pub surface: u32,
    /// A clip plane cuts the segment here.
    pub is_cut: bool,
    /// The next one behind it.
    pub next: u32,
}

/// The surfaces in each pixel of a band.
#[derive(Debug)]
pub(crate) struct BandFragments<'a> {
    pub surfaces: &'a [DrawnSurface<'a>],
    /// The widest vectors that are used.
    pub level: SimdLevel,
    columns: u32,
    /// Rows of the picture.
    rows: Range<u32>,
    /// The nearest opaque one of each pixel, at an infinite depth where there is none.
    nearest: Vec<Fragment>,
    /// Of each pixel the first that can be seen through.
    first: Vec<u32>,
    behind: Vec<Fragment>,
    /// What clip planes leave of each pixel; empty where there are none.
    kept: Vec<Kept>,
}

impl<'a> BandFragments<'a> {
    /// Draws the surfaces of a band, the one with this number, of these rows.
    pub fn new(
        on_screen: &'a OnScreen<'a>,
        shading: &Shading<'_>,
        (fan, shift): (&RayFan, (f32, f32)),
        (number, rows): (usize, Range<u32>),
    ) -> Self {
        let columns = fan.size.0;
        let pixels = columns as usize * rows.len();
        let none = Fragment {
            depth: f32::INFINITY,
            normal: Vec3::ZERO,
            surface: 0,
            is_cut: false,
            next: NO_FRAGMENT,
        };
        let kept = if shading.planes.is_empty() {
            Vec::new()
        } else {
            let places = rows
                .clone()
                .flat_map(|row| (0..columns).map(move |column| (column, row)));
            places
                .map(|place| kept_of(fan, shading.planes, place, shift))
                .collect()
        };
        let mut band = Self {
            surfaces: &on_screen.surfaces,
            level: on_screen.level,
            columns,
            rows,
            nearest: vec![none; pixels],
            first: vec![NO_FRAGMENT; pixels],
            behind: Vec::new(),
            kept,
        };
        for (patch, numbers) in on_screen.in_band(number) {
            let triangle = Triangle {
                corners: numbers.map(|corner| patch.corners[corner as usize]),
                normals: numbers.map(|corner| Vec3::from(patch.normals[corner as usize])),
                surface: patch.surface,
                in_perspective: on_screen.in_perspective,
            };
            if band.surfaces[patch.surface as usize].shown.is_wireframe {
                band.draw_lines(shading, &triangle);
            } else {
                band.draw_triangle(shading, triangle);
            }
        }
        band
    }

    /// The opaque fragment of a pixel, at an infinite depth where there is none; and the number of the first that can be
    /// seen through.
    pub fn at(&self, column: u32, row: u32) -> (&Fragment, u32) {
        // rays beside the picture are not looked at
        let column = column.min(self.columns - 1);
        let row = row.min(self.rows.end - 1) - self.rows.start;
        let pixel = (column + row * self.columns) as usize;
        (&self.nearest[pixel], self.first[pixel])
    }

    /// A fragment that can be seen through.
    pub fn veil(&self, number: u32) -> &Fragment {
        &self.behind[number as usize]
    }

    fn draw_triangle(&mut self, shading: &Shading<'_>, mut triangle: Triangle) {
        let area = triangle.turn();
        if area == 0 {
            return;
        }
        let [a, b, c] = triangle.corners;
        let columns = self.columns_between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        let rows = self.rows_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        let edges = [Edge::new(b, c), Edge::new(c, a), Edge::new(a, b)];
        for row in rows {
            let mut sides = edges.each_ref().map(|edge| edge.side(columns.start, row));
            for column in columns.clone() {
                if edges
                    .iter()
                    .zip(sides)
                    .all(|(edge, side)| side >= edge.least)
                {
                    let shares = sides.map(|side| side as f32 / area as f32);
                    self.put(shading, (column as u32, row as u32), triangle.at(shares));
                }
                for (side, edge) in sides.iter_mut().zip(&edges) {
                    *side += edge.across;
                }
            }
        }
    }

    /// Draws the three sides as lines, one pixel wide.
    fn draw_lines(&mut self, shading: &Shading<'_>, triangle: &Triangle) {
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let place = |end: usize| (triangle.corners[end].x, triangle.corners[end].y);
            // in one direction, whichever triangle it is of
            let (from, to) = if place(from) <= place(to) {
                (from, to)
            } else {
                (to, from)
            };
            self.draw_line(shading, triangle, (from, to));
        }
    }

    fn draw_line(
        &mut self,
        shading: &Shading<'_>,
        triangle: &Triangle,
        (from, to): (usize, usize),
    ) {
        let (a, b) = (triangle.corners[from], triangle.corners[to]);
        let (width, height) = (b.x - a.x, b.y - a.y);
        let is_flat = width.abs() >= height.abs();
        let ((begin, end), length) = if is_flat {
            ((a.x, b.x), width)
        } else {
            ((a.y, b.y), height)
        };
        let (low, high) = (begin.min(end), begin.max(end));
        let along = if is_flat {
            self.columns_between(low, high - 1)
        } else {
            self.rows_between(low, high - 1)
        };
        for middle in along {
            let share =
                (middle as f32 * PARTS as f32 + 0.5 * PARTS as f32 - begin as f32) / length as f32;
            let across = if is_flat {
                a.y as f32 + share * height as f32
            } else {
                a.x as f32 + share * width as f32
            };
            let across = (across / PARTS as f32).floor() as i32;
            let (column, row) = if is_flat {
                (middle, across)
            } else {
                (across, middle)
            };
            let is_inside = (0..self.columns as i32).contains(&column)
                && (self.rows.start as i32..self.rows.end as i32).contains(&row);
            if is_inside {
                let mut shares = [0.0; 3];
                (shares[from], shares[to]) = (1.0 - share, share);
                self.put(shading, (column as u32, row as u32), triangle.at(shares));
            }
        }
    }

    fn columns_between(&self, low: i32, high: i32) -> Range<i32> {
        first_middle(low).max(0)..last_middle(high).min(self.columns as i32 - 1) + 1
    }

    fn rows_between(&self, low: i32, high: i32) -> Range<i32> {
        first_middle(low).max(self.rows.start as i32)
            ..last_middle(high).min(self.rows.end as i32 - 1) + 1
    }

    /// Takes a fragment, unless it is cut away; a plane that cuts its segment stands before all of it.
    fn put(&mut self, shading: &Shading<'_>, (column, row): (u32, u32), mut fragment: Fragment) {
        let pixel = (column + (row - self.rows.start) * self.columns) as usize;
        let surface = &self.surfaces[fragment.surface as usize];
        if let Some(kept) = self.kept.get(pixel) {
            if fragment.depth < kept.from || fragment.depth > kept.to {
                return;
            }
            if let Some((place, normal)) = kept.face
                && !surface.shown.is_wireframe
            {
                // a hundredth of a mm behind the plane
                let within = place - 0.01 * normal / shading.field.spacing();
                if surface.holds(shading.field, within) {
                    let cut = Fragment {
                        depth: kept.from,
                        normal,
                        is_cut: true,
                        ..fragment
                    };
                    if surface.shown.opacity < 1.0 {
                        self.insert(pixel, cut);
                    } else {
                        fragment = cut;
                    }
                }
            }
        }
        if surface.shown.opacity < 1.0 {
            self.insert(pixel, fragment);
        } else if fragment.depth < self.nearest[pixel].depth {
            self.nearest[pixel] = fragment;
        }
    }

    /// Takes a fragment that can be seen through at its depth; one that is there already is left out.
    fn insert(&mut self, pixel: usize, mut fragment: Fragment) {
        let is_line = self.surfaces[fragment.surface as usize].shown.is_wireframe;
        let apart = if is_line { SAME_LINE } else { 0.0 };
        let (mut before, mut next) = (NO_FRAGMENT, self.first[pixel]);
        while next != NO_FRAGMENT {
            let other = &self.behind[next as usize];
            let is_same = other.surface == fragment.surface
                && (is_line || fragment.is_cut)
                && (other.depth - fragment.depth).abs() <= apart;
            if is_same {
                return;
            }
            if other.depth > fragment.depth {
                break;
            }
            (before, next) = (next, other.next);
        }
        fragment.next = next;
        let number = self.behind.len() as u32;
        self.behind.push(fragment);
        if before == NO_FRAGMENT {
            self.first[pixel] = number;
        } else {
            self.behind[before as usize].next = number;
        }
    }
}

/// A triangle on the screen.
struct Triangle {
    corners: [Corner; 3],
    normals: [Vec3; 3],
    surface: u32,
    in_perspective: bool,
}

impl Triangle {
    /// Turns it so that it runs in one direction; returns twice its area.
    fn turn(&mut self) -> i64 {
        let [a, b, c] = self.corners;
        let area = Edge::new(a, b).side_of(i64::from(c.x), i64::from(c.y));
        if area < 0 {
            self.corners.swap(1, 2);
            self.normals.swap(1, 2);
        }
        area.abs()
    }

    /// What lies at these shares of its corners on the screen.
    fn at(&self, shares: [f32; 3]) -> Fragment {
        let depths = self.corners.map(|corner| corner.depth);
        // what runs evenly on the surface runs by the inverse of depth on the screen
        let (weights, depth) = if self.in_perspective {
            let weights = [0, 1, 2].map(|i| shares[i] / depths[i]);
            (weights, 1.0 / (weights[0] + weights[1] + weights[2]))
        } else {
            let depth = shares[0] * depths[0] + shares[1] * depths[1] + shares[2] * depths[2];
            (shares, depth)
        };
        let [a, b, c] = self.normals;
        Fragment {
            depth,
            normal: weights[0] * a + weights[1] * b + weights[2] * c,
            surface: self.surface,
            is_cut: false,
            next: NO_FRAGMENT,
        }
    }
}

/// A side of a triangle.
struct Edge {
    from: (i64, i64),
    way: (i64, i64),
    /// The side of a place is above 0 within; of those on the edge, one of the two triangles beside it has them.
    least: i64,
    /// By how much the side grows from a pixel to the next.
    across: i64,
}

impl Edge {
    fn new(from: Corner, to: Corner) -> Self {
        let (x, y) = (i64::from(to.x - from.x), i64::from(to.y - from.y));
        let has_its_places = y > 0 || (y == 0 && x > 0);
        Self {
            from: (i64::from(from.x), i64::from(from.y)),
            way: (x, y),
            least: i64::from(!has_its_places),
            across: -y * i64::from(PARTS),
        }
    }

    /// Of a pixel's middle.
    fn side(&self, column: i32, row: i32) -> i64 {
        let middle = |pixel: i32| i64::from(pixel) * i64::from(PARTS) + i64::from(PARTS / 2);
        self.side_of(middle(column), middle(row))
    }

    fn side_of(&self, x: i64, y: i64) -> i64 {
        self.way.0 * (y - self.from.1) - self.way.1 * (x - self.from.0)
    }
}
