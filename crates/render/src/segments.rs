//! Which segment a place belongs to: 0 none, −1 a hidden one, else a code that tells colour and light.
//!
//! Segments that a threshold made test the interpolated value, so that their surface is as smooth as the
//! scan; others their voxels. Where a threshold's segment was edited, its voxels decide too, but only beside
//! those that are not what their value says.

use glam::{IVec3, Vec3};
use palpate_volume::intensities::Intensities;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use crate::appearance::{Appearance, Shown, ShownSegment};
use crate::field::Field;
use crate::labels::Labels;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Vector};
use crate::lighting::OwnFactors;

/// Segments that values tell of at once.
const MOST_RANGES: usize = 32;

/// Codes above this one are segments by their voxels' number.
const LABELS: i32 = MOST_RANGES as i32;

/// No code: values tell of these voxels.
const NOT_TOLD: i32 = i32::MIN;

const CODES: usize = MOST_RANGES + 256;

/// Place of a code's appearance; 0 stands for no segment.
#[derive(Clone, Debug)]
pub(crate) struct Segments {
    ranges: Vec<Range>,
    labels: Option<Labels>,
    /// By number: the code of voxels that values do not tell of, `NOT_TOLD` of all others.
    by_label: Vec<i32>,
    /// By code: 1 where solid; then linear colour and factors on ambient and specular light.
    solid: Vec<i32>,
    colours: Vec<[f32; 4]>,
    factors: Vec<[f32; 4]>,
    numbers: Vec<u8>,
}

/// Limits of a threshold [stored values].
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f32,
    high: f32,
    shown: Shown,
    /// Its number where it was edited, else 0.
    label: u8,
}

impl Segments {
    /// What an appearance shows; `labels` holds the voxels of those that [`by_voxels`] names.
    pub fn new(appearance: &Appearance, labels: Option<Labels>, scan: &Intensities) -> Self {
        let mut segments = Self {
            ranges: Vec::new(),
            labels,
            by_label: vec![NOT_TOLD; 256],
            solid: vec![0; CODES],
            colours: vec![[0.0; 4]; CODES],
            factors: vec![[1.0, 1.0, 0.0, 0.0]; CODES],
            numbers: numbers_of_labels(),
        };
        for segment in &appearance.segments {
            let code = match segment.range {
                Some(range) if segments.ranges.len() < MOST_RANGES => {
                    segments.ranges.push(Range::new(segment, range, scan));
                    segments.ranges.len()
                }
                _ => {
                    let code = LABELS + i32::from(segment.id);
                    let is_hidden = segment.shown == Shown::Hidden;
                    segments.by_label[usize::from(segment.id)] = if is_hidden { -1 } else { code };
                    code as usize
                }
            };
            let Vec3 { x, y, z } = segment.colour;
            segments.solid[code] = i32::from(segment.shown == Shown::Solid);
            segments.colours[code] = [x, y, z, 0.0];
            segments.factors[code] = [segment.ambient, segment.specular, 0.0, 0.0];
            segments.numbers[code] = segment.id;
        }
        segments
    }

    /// Takes the voxels of a box from a later edit, of the segments that [`by_voxels`] names.
    pub fn renew(&mut self, voxels: &Voxels, asked: &[u8], changed: &VoxelBox) {
        let before = self.labels.take();
        let kept = before.and_then(|labels| labels.renewed(voxels, asked, changed));
        self.labels = kept.or_else(|| Labels::of(voxels, asked));
    }

    /// The voxels of segments, for another appearance.
    pub fn take_labels(&mut self) -> Option<Labels> {
        self.labels.take()
    }

    /// Whether a value from `low` to `high` is that of a solid body.
    pub fn show(&self, low: i16, high: i16) -> bool {
        self.ranges.iter().any(|range| {
            range.shown == Shown::Solid
                && range.low <= f32::from(high)
                && f32::from(low) <= range.high
        })
    }

    /// Whether a brick has voxels of segments of which values do not tell.
    pub fn hold(&self, brick: usize) -> bool {
        self.labels
            .as_ref()
            .is_some_and(|labels| labels.has_any(brick))
    }

    /// Code of the segment at a place with this stored value.
    #[inline(always)]
    pub fn at<L: Gather>(&self, field: &Field, grid: Vector<L>, value: L::Float) -> L::Int {
        let mut code = L::Int::splat(0);
        if self.ranges.is_empty() && self.labels.is_none() {
            return code;
        }
        let label = match &self.labels {
            Some(labels) => labels.around(grid),
            None => code,
        };
        // the last to be taken wins: hidden ones first, then the first of those that are seen
        for range in self
            .ranges
            .iter()
            .filter(|range| range.shown == Shown::Hidden)
        {
            let inside = self.inside_range::<L>(range, field, grid, value, label);
            code = L::Int::splat(-1).or_else(inside, code);
        }
        if self.labels.is_some() {
            code = self.by_labels::<L>(label, code);
        }
        for (i, range) in self.ranges.iter().enumerate().rev() {
            if range.shown != Shown::Hidden {
                let inside = self.inside_range::<L>(range, field, grid, value, label);
                code = L::Int::splat(i as i32 + 1).or_else(inside, code);
            }
        }
        code
    }

    #[inline(always)]
    fn by_labels<L: Gather>(&self, label: L::Int, before: L::Int) -> L::Int {
        // SAFETY: labels are bytes, of which each has its code
        let code = unsafe { L::ints(&self.by_label, label) };
        before.or_else(code.equal(Ints::splat(NOT_TOLD)), code)
    }

    #[inline(always)]
    fn inside_range<L: Gather>(
        &self,
        range: &Range,
        field: &Field,
        grid: Vector<L>,
        value: L::Float,
        label: L::Int,
    ) -> L::Mask {
        let by_value =
            L::Float::splat(range.low).at_most(value) & value.at_most(Floats::splat(range.high));
        if range.label == 0 || self.labels.is_none() {
            return by_value;
        }
        let by_label = label.equal(Ints::splat(i32::from(range.label)));
        let differ = (by_value & !by_label) | (by_label & !by_value);
        if !differ.any() {
            return by_value;
        }
        let edited = L::Mask::from_bits(self.edited_around::<L>(range, field, grid, differ.bits()));
        (by_label & edited) | (by_value & !edited)
    }

    /// Lanes of `asked` beside whose place there is a voxel that is not what its value says.
    #[inline(never)]
    fn edited_around<L: Gather>(
        &self,
        range: &Range,
        field: &Field,
        grid: Vector<L>,
        asked: u8,
    ) -> u8 {
        let (x, y, z) = (grid.x.store(), grid.y.store(), grid.z.store());
        (0..LANES)
            .filter(|lane| asked >> lane & 1 == 1)
            .filter(|&lane| {
                self.is_edited_around(range, field, Vec3::new(x[lane], y[lane], z[lane]))
            })
            .fold(0, |bits, lane| bits | 1 << lane)
    }

    fn is_edited_around(&self, range: &Range, field: &Field, place: Vec3) -> bool {
        let Some(labels) = &self.labels else {
            return false;
        };
        let first = (place - 0.5).floor().as_ivec3();
        (0..8).any(|corner| {
            let voxel = first + IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let value = f32::from(field.stored(voxel));
            (range.low <= value && value <= range.high) != (labels.at(voxel) == range.label)
        })
    }

    /// Whether a segment is a solid body.
    #[inline(always)]
    pub fn are_solid<L: Gather>(&self, code: L::Int) -> L::Mask {
        let seen = code.greater(Ints::splat(0));
        if !seen.any() {
            return seen;
        }
        // SAFETY: a code that is not positive was replaced by 0, and all others lie in the table
        let solid = unsafe { L::ints(&self.solid, code.max(Ints::splat(0))) };
        solid.greater(Ints::splat(0))
    }

    /// Linear colour of segments; black of none.
    #[inline(always)]
    pub fn colour<L: Gather>(&self, code: L::Int) -> Vector<L> {
        // SAFETY: as in `are_solid`
        let [x, y, z, _] = unsafe { L::rows(&self.colours, code.max(Ints::splat(0))) };
        Vector::new(x, y, z)
    }

    /// Factors on light; 1 outside of segments.
    #[inline(always)]
    pub fn factors<L: Gather>(&self, code: L::Int) -> OwnFactors<L> {
        let one = L::Float::splat(1.0);
        if !code.greater(Ints::splat(0)).any() {
            return OwnFactors {
                ambient: one,
                specular: one,
            };
        }
        // SAFETY: as in `are_solid`
        let [ambient, specular, _, _] = unsafe { L::rows(&self.factors, code.max(Ints::splat(0))) };
        OwnFactors { ambient, specular }
    }

    /// Limits of a segment that is just a threshold [stored values].
    pub fn limits_of(&self, number: u8) -> Option<(f32, f32)> {
        let is_its =
            |(i, range): &(usize, &Range)| self.numbers[i + 1] == number && range.label == 0;
        let (_, range) = self.ranges.iter().enumerate().find(is_its)?;
        Some((range.low, range.high))
    }

    /// The segment's number; 0 of none.
    pub fn number(&self, code: i32) -> u8 {
        self.numbers[code.max(0) as usize]
    }

    /// Outward normal of a segment's surface at a place; `smooth` where values tell of it.
    #[inline(always)]
    pub fn normal_at<L: Gather>(
        &self,
        field: &Field,
        smooth: Vector<L>,
        grid: Vector<L>,
        code: L::Int,
    ) -> Vector<L> {
        let stepped = self.stepped(field, grid, code);
        if stepped == 0 {
            return smooth;
        }
        let blocky = self.label_normals::<L>(field, grid, code, stepped);
        blocky.or_else(L::Mask::from_bits(stepped), smooth)
    }

    /// Lanes whose surface is that of voxels.
    #[inline(always)]
    fn stepped<L: Gather>(&self, field: &Field, grid: Vector<L>, code: L::Int) -> u8 {
        if self.labels.is_none() {
            return 0;
        }
        let mut lanes = code.greater(Ints::splat(LABELS)).bits();
        for (i, range) in self.ranges.iter().enumerate() {
            if range.label != 0 {
                let asked = code.equal(Ints::splat(i as i32 + 1)).bits();
                lanes |= if asked == 0 {
                    0
                } else {
                    self.edited_around::<L>(range, field, grid, asked)
                };
            }
        }
        lanes
    }

    #[inline(never)]
    fn label_normals<L: Gather>(
        &self,
        field: &Field,
        grid: Vector<L>,
        code: L::Int,
        lanes: u8,
    ) -> Vector<L> {
        let (x, y, z) = (grid.x.store(), grid.y.store(), grid.z.store());
        let codes = code.store();
        let mut normals = [[0.0; LANES]; 3];
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let label = match codes[lane] {
                code if code > LABELS => (code - LABELS) as u8,
                code => self.ranges[code as usize - 1].label,
            };
            let place = Vec3::new(x[lane], y[lane], z[lane]);
            let normal = self.label_normal(place, label, field.spacing());
            for (axis, values) in normals.iter_mut().enumerate() {
                values[lane] = normal[axis];
            }
        }
        Vector::new(
            Floats::load(&normals[0]),
            Floats::load(&normals[1]),
            Floats::load(&normals[2]),
        )
    }

    /// From the fraction of a segment's voxels around a place.
    fn label_normal(&self, place: Vec3, label: u8, spacing: Vec3) -> Vec3 {
        let Some(labels) = &self.labels else {
            return Vec3::ZERO;
        };
        (0..27)
            .map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) - 1.0)
            .filter(|&offset| labels.at((place + 1.5 * offset).floor().as_ivec3()) == label)
            .fold(Vec3::ZERO, |sum, offset| sum - offset / spacing)
    }
}

/// Code that tells nothing of a segment but its number.
pub(crate) fn code_of_number(number: u8) -> i32 {
    LABELS + i32::from(number)
}

/// Number of the segment of each code above `LABELS`, of others 0.
fn numbers_of_labels() -> Vec<u8> {
    let ranges = std::iter::repeat_n(0, MOST_RANGES);
    ranges.chain(0..=u8::MAX).collect()
}

impl Range {
    fn new(segment: &ShownSegment, (low, high): (f64, f64), scan: &Intensities) -> Self {
        let stored = |value: f64| limit(value, scan);
        let (a, b) = (stored(low), stored(high));
        Self {
            low: a.min(b),
            high: a.max(b),
            shown: segment.shown,
            label: if segment.is_edited { segment.id } else { 0 },
        }
    }
}

/// A limit as a stored value; one that is a stored value but for rounding is that.
fn limit(value: f64, scan: &Intensities) -> f32 {
    const FLOAT_ERROR: f64 = 4.0 * f32::EPSILON as f64;
    let stored = (value - scan.intercept()) / scan.slope();
    let error = FLOAT_ERROR * (value.abs() + scan.intercept().abs()) / scan.slope().abs();
    let near = (stored - stored.round()).abs() <= error.min(0.01);
    (if near { stored.round() } else { stored }) as f32
}

/// The segments whose voxels tell of them: all but those that are just a threshold.
pub(crate) fn by_voxels(appearance: &Appearance) -> Vec<u8> {
    let mut ranges = 0;
    let mut asked = Vec::new();
    for segment in &appearance.segments {
        let by_value = segment.range.is_some() && ranges < MOST_RANGES;
        ranges += usize::from(by_value);
        if !by_value || segment.is_edited {
            asked.push(segment.id);
        }
    }
    // where segments overlap a voxel has the highest number, as in the session
    asked.sort_unstable();
    asked
}
