//! What lies on the line of a needle: its layers as far as the tip has been, found voxel by
//! voxel, and looked at again part by part, so that edits count behind the tip too.
//!
//! Depths in mm from the entry along the line; walks in the grid.

use glam::DVec3;
use palpate_volume::grid::Grid;
use palpate_volume::tissue::Tissue;
use serde::{Deserialize, Serialize};

use super::stretches::{Stretch, Stretches, finest, met_at};
use super::tissues::{Layered, Met, TissueMap, Tissues, World};

/// Layers that are told apart; what lies beyond counts to the last of them.
const MAX_LAYERS: usize = 256;
/// Layers in a file of 0.1.
const LAYERS_BEFORE: usize = 32;
/// Voxels looked up in each grid in a tick, at most: so far ahead a tip can come in one.
const MAX_VOXELS: u32 = 24;
/// Length of what is looked at again in a tick [smallest spacings of all grids].
const AGAIN: f64 = 2.0;
/// Voxels of it in each grid, at most: some three for each spacing, and those at both ends.
const MAX_AGAIN: u32 = 12;
/// A way through a voxel or a layer that is shorter is none: it grazes a corner [mm].
const GRAZED: f64 = 1e-6;
/// Ticks in a second by which that part is chosen.
const PARTS_HZ: f64 = 1000.0;
/// Beyond the face of a wall by so much, its voxel is asked for again [mm].
const INTO_WALL: f64 = 1e-6;

/// A straight line in the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Where the needle went in [mm].
    pub entry: DVec3,
    /// Inward, of length 1.
    pub direction: DVec3,
}

impl Line {
    /// A point on it [mm].
    #[must_use]
    pub fn at(&self, depth: f64) -> DVec3 {
        self.entry + self.direction * depth
    }

    /// Depth of a point along the line [mm].
    #[must_use]
    pub fn depth_of(&self, point: DVec3) -> f64 {
        (point - self.entry).dot(self.direction)
    }

    /// The way from the line to a point, across it [mm].
    #[must_use]
    pub fn aside_of(&self, point: DVec3) -> DVec3 {
        let way = point - self.entry;
        way - self.direction * way.dot(self.direction)
    }

    /// The point at a depth [mm], in the grid.
    fn in_grid(&self, grid: &Grid, depth: f64) -> DVec3 {
        grid.grid_from_patient().transform_point3(self.at(depth))
    }
}

/// A stretch of the line in one tissue, or in none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Layer {
    /// Depth at which the layer begins [mm].
    from: f64,
    met: Met,
}

/// The layers on a line.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(from = "TrackOnFile", into = "TrackOnFile")]
pub struct Track {
    layers: [Layer; MAX_LAYERS],
    count: u16,
    /// Known up to here [mm].
    seen: f64,
    /// Where what no needle punctures begins, and its segment.
    wall: Option<(f64, u8)>,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            layers: [Layer::default(); MAX_LAYERS],
            count: 0,
            seen: 0.0,
            wall: None,
        }
    }
}

/// Tracks are equal by what is known of them.
impl PartialEq for Track {
    fn eq(&self, other: &Self) -> bool {
        let same = (self.seen, self.wall) == (other.seen, other.wall);
        same && self.known() == other.known()
    }
}

/// A track in a file. One of few layers is written as by 0.1, with places for all that it knew, and read there.
#[derive(Serialize, Deserialize)]
struct TrackOnFile {
    layers: Vec<Layer>,
    count: u16,
    seen: f64,
    wall: Option<(f64, u8)>,
}

impl From<TrackOnFile> for Track {
    fn from(file: TrackOnFile) -> Self {
        let mut track = Self {
            seen: file.seen,
            wall: file.wall,
            ..Self::default()
        };
        let there = file.layers.into_iter().take(usize::from(file.count));
        for (place, layer) in track.layers.iter_mut().zip(there) {
            *place = layer;
            track.count += 1;
        }
        track
    }
}

impl From<Track> for TrackOnFile {
    fn from(track: Track) -> Self {
        Self {
            layers: track.layers[..usize::from(track.count).max(LAYERS_BEFORE)].to_vec(),
            count: track.count,
            seen: track.seen,
            wall: track.wall,
        }
    }
}

impl Track {
    /// Known up to here [mm].
    #[must_use]
    pub fn seen(&self) -> f64 {
        self.seen
    }

    /// Where the needle ends [mm], and at which segment, if it does.
    #[must_use]
    pub fn wall(&self) -> Option<(f64, u8)> {
        self.wall
    }

    /// What a layer is.
    #[must_use]
    pub fn met(&self, place: u16) -> Met {
        let layer = self.layers.get(usize::from(place));
        layer.map_or(Met::Nothing, |layer| layer.met)
    }

    /// Where a layer ends; none where that is not seen yet.
    #[must_use]
    pub fn end(&self, place: u16) -> Option<f64> {
        let next = usize::from(place) + 1;
        (next < usize::from(self.count)).then(|| self.layers[next].from)
    }

    /// Looks further along a line, up to a depth [mm] or as far as one tick allows.
    pub fn look(&mut self, line: &Line, to: f64, world: &World<'_, impl TissueMap>) {
        let grid = world.scan.grid;
        if let Some((wall, _)) = self.wall {
            let inside = line.in_grid(grid, wall + INTO_WALL);
            if to <= wall || matches!(met_at(inside, world), Met::Wall(_)) {
                return;
            }
            // it is gone
            self.wall = None;
        }
        let (from, way) = (self.seen, to - self.seen);
        // written so that NaN is refused
        if !(way > 0.0 && way.is_finite()) {
            return;
        }
        let ends = [from, to].map(|depth| line.in_grid(grid, depth));
        let Some(mut stretches) = Stretches::new(ends[0], ends[1], world) else {
            return;
        };
        for _ in 0..MAX_VOXELS * stretches.grids() {
            let Stretch { begin, end, met } = stretches.now();
            let depth = from + way * begin;
            match met {
                Met::Wall(segment) => {
                    self.seen = depth;
                    self.wall = Some((depth, segment));
                    return;
                }
                met => self.note(depth, met),
            }
            self.seen = from + way * end;
            if !stretches.advance() {
                self.seen = to;
                return;
            }
        }
    }

    /// Looks again at a part of what is known, another one each tick, and follows what was edited there;
    /// whether anything was. `tip`: where the needle's tip is [mm]; what is hard stops it beyond only.
    pub fn look_again(
        &mut self,
        line: &Line,
        (tip, time): (f64, f64),
        world: &World<'_, impl TissueMap>,
    ) -> bool {
        let grid = world.scan.grid;
        let length = AGAIN * finest(world);
        let parts = (self.seen / length).ceil();
        // written so that NaN is refused
        if !(parts >= 1.0 && time >= 0.0) {
            return false;
        }
        let from = (time * PARTS_HZ).round() % parts * length;
        let to = (from + length).min(self.seen);
        let ends = [from, to].map(|depth| line.in_grid(grid, depth));
        let Some(mut stretches) = Stretches::new(ends[0], ends[1], world) else {
            return false;
        };
        let mut found = Self::default();
        let mut changed = false;
        for _ in 0..MAX_AGAIN * stretches.grids() {
            let Stretch { begin, end, met } = stretches.now();
            let [begin, end] = [begin, end].map(|part| from + (to - from) * part);
            if end - begin > GRAZED {
                changed |= self.met_at(0.5 * (begin + end)) != met;
                found.note(begin, met);
                found.seen = end;
            }
            if !stretches.advance() {
                break;
            }
        }
        if changed {
            self.put(&found, from, tip);
        }
        changed
    }

    /// Puts what was found from a depth on in the place of what was known there.
    fn put(&mut self, found: &Self, from: f64, tip: f64) {
        let before = *self;
        self.count = 0;
        let ahead = before.known().iter().filter(|layer| layer.from < from);
        let behind = before
            .known()
            .iter()
            .filter(|layer| layer.from > found.seen);
        let goes_on = Layer {
            from: found.seen,
            met: before.met_at(found.seen),
        };
        let all = ahead.chain(found.known()).chain([&goes_on]).chain(behind);
        for layer in all {
            let is_wall = layer.from >= tip && matches!(layer.met, Met::Wall(_));
            if is_wall {
                // from here on it is looked at anew
                self.seen = layer.from;
                self.wall = None;
                return;
            }
            self.note(layer.from, layer.met);
        }
    }

    /// The layers that are known.
    fn known(&self) -> &[Layer] {
        &self.layers[..usize::from(self.count)]
    }

    /// The layer in which a depth lies; the first one before all of them.
    #[must_use]
    pub fn place_at(&self, depth: f64) -> u16 {
        let before = self.known().iter().take_while(|layer| layer.from <= depth);
        u16::try_from(before.count().saturating_sub(1)).unwrap_or(u16::MAX)
    }

    fn met_at(&self, depth: f64) -> Met {
        self.met(self.place_at(depth))
    }

    /// Sum over the shaft from the entry to a depth of a figure per length of its tissues.
    #[must_use]
    pub fn along(&self, depth: f64, tissues: &Tissues, figure: impl Fn(&Tissue) -> f64) -> f64 {
        let mut sum = 0.0;
        for place in 0..self.count {
            let Met::Tissue(layer) = self.met(place) else {
                continue;
            };
            let from = self.layers[usize::from(place)].from.max(0.0);
            let to = self.end(place).unwrap_or(f64::INFINITY).min(depth);
            if let Some((_, tissue)) = tissues.top(layer) {
                sum += figure(&tissue) * (to - from).max(0.0);
            }
        }
        sum
    }

    /// Whether the line comes through a tissue before a depth.
    #[must_use]
    pub fn meets(&self, tissue: u8, depth: f64) -> bool {
        let mut before = self.known().iter().take_while(|layer| layer.from <= depth);
        before.any(|layer| matches!(layer.met, Met::Tissue(met) if met.has(tissue)))
    }

    /// The first tissue on the line, as far as it is known.
    #[must_use]
    pub fn first(&self) -> Option<Layered> {
        let mut tissues = self.known().iter().filter_map(|layer| match layer.met {
            Met::Tissue(met) => Some(met),
            Met::Nothing | Met::Wall(_) => None,
        });
        tissues.next()
    }

    /// The first tissue that the line leads through, and does not only graze.
    #[must_use]
    pub fn entered(&self) -> Option<Layered> {
        let mut tissues = (0..self.count).filter_map(|place| {
            let from = self.layers[usize::from(place)].from;
            let end = self.end(place).unwrap_or(self.seen);
            match self.met(place) {
                Met::Tissue(met) if end - from > GRAZED => Some(met),
                _ => None,
            }
        });
        tissues.next()
    }

    fn note(&mut self, from: f64, met: Met) {
        let count = usize::from(self.count);
        let goes_on = count > 0 && self.layers[count - 1].met == met;
        if !goes_on && count < MAX_LAYERS {
            self.layers[count] = Layer { from, met };
            self.count += 1;
        }
    }
}
