//! Voxels that follow coarse particles: each reads what stood where it came from.
//!
//! A particle takes tens of thousands of voxels along, more than one answer has the time for. So
//! voxels follow tile by tile, those first that have waited longest for how far they are from the
//! tool; and of a tile only voxels are worked out whose tissue comes from another voxel than
//! before. What an answer leaves over, the next ones do: an answer takes the same work however
//! large the body is and however much of it moves. The force waits for none of it.
//! Source: thesis 5.26.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, IVec3};
use palpate_volume::edit::Edit;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

use super::global_field::GlobalField;
use crate::material::Treatment;
use crate::model::{Budget, Effort, ModelInput};
use crate::voxel_ledger::{Ledger, Wanted, solid_of};

/// Voxels along each edge of a tile.
const TILE: i32 = 16;
/// Voxels of a tile.
const IN_TILE: usize = (TILE * TILE * TILE) as usize;
/// Tiles that one answer looks at, at most.
const TILES: u64 = 32;
/// Voxels that are worked out anew before an answer begins no other tile.
const FOLLOWED: u64 = 6_000;
/// Voxels along a side of what one answer changes, at most: an edit looks at each in between.
const WIDEST: u32 = 48;

/// Displacement from rest of what a voxel shows [voxels].
type Come = [i16; 3];

/// Nobody knows what the voxel shows.
const UNKNOWN: Come = [i16::MIN; 3];

/// What voxels follow, and by which rule.
pub(super) struct FollowRule<'a> {
    pub input: &'a ModelInput<'a>,
    /// Budget; no other tile is begun once it is spent.
    pub budget: Budget,
    /// Displacement of the voxels; none where nothing has moved.
    pub field: Option<&'a GlobalField>,
    /// Voxels around this one come first.
    pub middle: IVec3,
    /// Displacement below which voxels stay [mm].
    pub least: f64,
    /// Stored value where tissue left.
    pub air: i16,
}

/// The voxels that follow, by tiles.
#[derive(Debug, Default)]
pub(super) struct Following {
    /// All tiles with a voxel that is not as at rest, and those beside where something has moved.
    tiles: BTreeMap<[i32; 3], Tile>,
    answers: u64,
}

#[derive(Debug)]
struct Tile {
    /// The answer in which it was last looked at.
    looked_at: u64,
    /// What its voxels were last made to show, x fastest.
    come: Vec<Come>,
}

/// A voxel that is to show tissue from elsewhere.
#[derive(Clone, Copy, Debug)]
struct Change {
    /// Index of the voxel in its tile.
    place: usize,
    voxel: IVec3,
    come: Come,
}

impl Following {
    /// Somebody else has changed voxels: what they show is to be worked out anew.
    pub fn forget(&mut self) {
        for tile in self.tiles.values_mut() {
            tile.come.fill(UNKNOWN);
        }
    }

    /// The edit by which voxels read what stood where they came from, those around the middle first;
    /// none where nothing changes.
    pub fn advance(
        &mut self,
        rule: &FollowRule<'_>,
        ledger: &mut Ledger,
        effort: &mut Effort,
    ) -> Option<Edit> {
        self.answers += 1;
        let moving = self.meet(rule);
        let mut wanted = Wanted::new();
        let mut region = VoxelBox::EMPTY;
        let mut worked = Vec::new();
        for key in self.by_urgency(rule.middle) {
            let is_over = effort.looked_at >= TILES * IN_TILE as u64
                || effort.followed >= FOLLOWED
                || (effort.looked_at > 0 && rule.budget.is_late());
            if is_over {
                break;
            }
            effort.looked_at += IN_TILE as u64;
            let changes = self.changes_of(key, rule);
            if !changes.is_empty() {
                let grown = region.union(&box_of(key));
                if grown.size().max_element() > WIDEST {
                    continue;
                }
                region = grown;
            }
            effort.followed += changes.len() as u64;
            let follow =
                |change: &Change| Some((change.voxel.to_array(), rule.matter(change, ledger)?));
            wanted.extend(changes.iter().filter_map(follow));
            worked.push((key, changes));
        }
        let edit = ledger.write(rule.input.voxels, &wanted);
        for (key, changes) in worked {
            self.note(key, &changes, |change| {
                is_done(change, &wanted, rule.input.voxels, ledger)
            });
            self.drop_at_rest(key, &moving);
        }
        edit
    }

    /// Takes in all tiles where something has moved, and tells which these are.
    fn meet(&mut self, rule: &FollowRule<'_>) -> BTreeSet<[i32; 3]> {
        let tiles = |field: &GlobalField| field.moving_tiles(TILE, rule.least);
        let moving = rule.field.map(tiles).unwrap_or_default();
        let before = self.answers - 1;
        for key in &moving {
            self.tiles.entry(*key).or_insert_with(|| Tile {
                looked_at: before,
                come: vec![[0; 3]; IN_TILE],
            });
        }
        moving
    }

    /// All tiles by urgency: first those that have waited longest for their distance.
    fn by_urgency(&self, middle: IVec3) -> Vec<[i32; 3]> {
        let here = middle.div_euclid(IVec3::splat(TILE));
        let urgency = |(key, tile): (&[i32; 3], &Tile)| {
            let apart = (IVec3::from_array(*key) - here).abs().max_element();
            let waited = self.answers - tile.looked_at;
            (waited as f64 / f64::from(1 + apart), *key)
        };
        let mut order: Vec<_> = self.tiles.iter().map(urgency).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        order.into_iter().map(|(_, key)| key).collect()
    }

    fn changes_of(&self, key: [i32; 3], rule: &FollowRule<'_>) -> Vec<Change> {
        let Some(tile) = self.tiles.get(&key) else {
            return Vec::new();
        };
        let places = box_of(key).voxels().zip(&tile.come).enumerate();
        let change = |(place, (voxel, shown)): (usize, (IVec3, &Come))| {
            let come = rule.come(voxel);
            (come != *shown).then_some(Change { place, voxel, come })
        };
        places.filter_map(change).collect()
    }

    fn note(&mut self, key: [i32; 3], changes: &[Change], is_done: impl Fn(&Change) -> bool) {
        let Some(tile) = self.tiles.get_mut(&key) else {
            return;
        };
        tile.looked_at = self.answers;
        for change in changes {
            tile.come[change.place] = if is_done(change) {
                change.come
            } else {
                UNKNOWN
            };
        }
    }

    fn drop_at_rest(&mut self, key: [i32; 3], moving: &BTreeSet<[i32; 3]>) {
        let is_at_rest = |tile: &Tile| tile.come.iter().all(|come| *come == [0; 3]);
        if !moving.contains(&key) && self.tiles.get(&key).is_some_and(is_at_rest) {
            self.tiles.remove(&key);
        }
    }
}

/// Whether a voxel shows what it is to show, once the edit is applied. What comes back to rest is
/// looked at once more: then the ledger lets it go.
fn is_done(change: &Change, wanted: &Wanted, voxels: &Voxels, ledger: &Ledger) -> bool {
    let Some((matter, _)) = wanted.get(&change.voxel.to_array()) else {
        return true;
    };
    match ledger.changed(change.voxel) {
        Some(changed) => change.come != [0; 3] && changed.written == *matter,
        None => voxels.state(change.voxel) == Some(*matter),
    }
}

fn box_of(tile: [i32; 3]) -> VoxelBox {
    let first = IVec3::from_array(tile) * TILE;
    VoxelBox::new(first, first + TILE)
}

impl FollowRule<'_> {
    /// Displacement from rest of what a voxel is to show.
    fn come(&self, voxel: IVec3) -> Come {
        let moved = self
            .field
            .map_or(DVec3::ZERO, |field| field.at_voxel(voxel));
        if moved.length_squared() <= self.least.powi(2) {
            return [0; 3];
        }
        let come = (moved / self.input.voxels.grid().spacing()).round();
        come.as_i16vec3().to_array()
    }

    /// What a voxel is to be, and how far what it shows has come; none where it is at rest and
    /// stays so. What does not give way stays where it is.
    fn matter(&self, change: &Change, ledger: &Ledger) -> Option<(VoxelState, Option<DVec3>)> {
        let (voxels, voxel) = (self.input.voxels, change.voxel);
        let rest = ledger.rest(voxels, voxel)?;
        let back = (rest, Some(DVec3::ZERO));
        let back = ledger.changed(voxel).map(|_| back);
        let [x, y, z] = change.come.map(i32::from);
        let come = IVec3::new(x, y, z);
        let from = voxel - come;
        let Some(source) = ledger.rest(voxels, from).filter(|_| come != IVec3::ZERO) else {
            return back;
        };
        if self.is_held(voxel, &rest) || self.is_held(from, &source) {
            return back;
        }
        Some(
            match (rest.segments.is_empty(), source.segments.is_empty()) {
                (_, false) => (source, Some(come.as_dvec3())),
                (false, true) => (self.nothing(), None),
                (true, true) => (rest, None),
            },
        )
    }

    /// Whether there is tissue that does not give way.
    fn is_held(&self, voxel: IVec3, matter: &VoxelState) -> bool {
        let solid = solid_of(self.input.voxels, self.input.materials, voxel, matter);
        let gives = solid.is_some_and(|(_, treatment)| treatment == Treatment::Deformable);
        !matter.segments.is_empty() && !gives
    }

    fn nothing(&self) -> VoxelState {
        VoxelState {
            stored: self.air,
            segments: SegmentSet::EMPTY,
        }
    }
}
