//! Which segments a needle can puncture and what they are made of, and what it meets on its way.

use glam::IVec3;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::tissue::{MAX_TISSUES, Tissue};
use serde::{Deserialize, Serialize};

use super::stretches::NeedleBody;

/// Most segments that a needle can puncture: as many as a scan has.
const MAX_SEGMENTS: usize = 255;
/// Places in a file of 0.1: a table that fits is written as it was, and read there.
const PLACES_BEFORE: usize = 16;
/// The place of a segment that is in no table.
const NO_PLACE: u8 = u8::MAX;

/// Segments, by number, that a needle can puncture, each with its tissue.
///
/// On file a list of numbers with tissues.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<Option<(u8, Tissue)>>", into = "Vec<Option<(u8, Tissue)>>")]
pub struct Tissues {
    /// At each place the number of a segment, and where its tissue is.
    segments: [(u8, u8); MAX_SEGMENTS],
    count: u8,
    tissues: [Option<Tissue>; MAX_TISSUES],
    /// By the number of a segment: asked for in each voxel.
    places: [u8; 256],
}

impl Default for Tissues {
    fn default() -> Self {
        Self {
            segments: [(0, 0); MAX_SEGMENTS],
            count: 0,
            tissues: [None; MAX_TISSUES],
            places: [NO_PLACE; 256],
        }
    }
}

impl Tissues {
    /// These segments, each once; none that is no tissue, and none of more than [`MAX_TISSUES`] tissues.
    pub fn of(segments: impl IntoIterator<Item = (u8, Tissue)>) -> Self {
        let mut tissues = Self::default();
        for (segment, tissue) in segments {
            if tissue.check().is_ok() && tissues.place_of(segment).is_none() {
                tissues.add(segment, tissue);
            }
        }
        tissues
    }

    fn add(&mut self, segment: u8, tissue: Tissue) {
        let is_it = |known: &Option<Tissue>| known.is_none_or(|known| known == tissue);
        let kind = self.tissues.iter().position(is_it);
        let free = self.segments.get_mut(usize::from(self.count));
        if let (Some(kind), Some(free)) = (kind, free) {
            self.tissues[kind] = Some(tissue);
            *free = (segment, u8::try_from(kind).unwrap_or(0));
            self.places[usize::from(segment)] = self.count;
            self.count += 1;
        }
    }

    /// All tissues with the numbers of their segments.
    pub fn segments(&self) -> impl Iterator<Item = (u8, Tissue)> {
        (0..self.count).filter_map(|place| self.at(place))
    }

    /// Segment and tissue at a place.
    fn at(&self, place: u8) -> Option<(u8, Tissue)> {
        let (segment, kind) = *self.segments.get(usize::from(place))?;
        let tissue = *self.tissues.get(usize::from(kind))?;
        Some((segment, tissue?))
    }

    /// The place of a segment in the table; none where it cannot be punctured.
    #[must_use]
    pub fn place_of(&self, segment: u8) -> Option<u8> {
        let place = self.places[usize::from(segment)];
        (place != NO_PLACE).then_some(place)
    }

    /// Segment and tissue of what counts where several are: the last of them, as in the picture.
    #[must_use]
    pub fn top(&self, layer: Layered) -> Option<(u8, Tissue)> {
        layer.last().and_then(|place| self.at(place))
    }

    /// The segments of a layer.
    pub fn segments_of(&self, layer: Layered) -> impl Iterator<Item = SegmentId> {
        let there = (0..self.count).filter(move |place| layer.has(*place));
        there.filter_map(|place| Some(SegmentId(self.at(place)?.0)))
    }
}

impl From<Vec<Option<(u8, Tissue)>>> for Tissues {
    fn from(segments: Vec<Option<(u8, Tissue)>>) -> Self {
        Self::of(segments.into_iter().flatten())
    }
}

impl From<Tissues> for Vec<Option<(u8, Tissue)>> {
    fn from(tissues: Tissues) -> Self {
        let mut all: Self = tissues.segments().map(Some).collect();
        all.resize(all.len().max(PLACES_BEFORE), None);
        all
    }
}

/// Tissues that overlap, one bit for each place in [`Tissues`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "LayeredOnFile", into = "LayeredOnFile")]
pub struct Layered([u64; 4]);

/// As 0.1 wrote it, where that has room for all places, or as it is.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum LayeredOnFile {
    Few(u16),
    All([u64; 4]),
}

impl From<LayeredOnFile> for Layered {
    fn from(file: LayeredOnFile) -> Self {
        match file {
            LayeredOnFile::Few(bits) => Self([bits.into(), 0, 0, 0]),
            LayeredOnFile::All(bits) => Self(bits),
        }
    }
}

impl From<Layered> for LayeredOnFile {
    fn from(Layered(bits): Layered) -> Self {
        match (u16::try_from(bits[0]), bits) {
            (Ok(few), [_, 0, 0, 0]) => Self::Few(few),
            _ => Self::All(bits),
        }
    }
}

impl Layered {
    /// The tissue at a place alone.
    #[must_use]
    pub fn of(place: u8) -> Self {
        Self::default().with(place)
    }

    /// This one too.
    #[must_use]
    pub fn with(mut self, place: u8) -> Self {
        self.0[usize::from(place >> 6)] |= 1 << (place & 63);
        self
    }

    /// The tissues of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|part| self.0[part] | other.0[part]))
    }

    /// Whether the tissue at a place belongs to it.
    #[must_use]
    pub fn has(self, place: u8) -> bool {
        self.0[usize::from(place >> 6)] >> (place & 63) & 1 != 0
    }

    /// The last place of all.
    fn last(self) -> Option<u8> {
        let part = self.0.iter().rposition(|bits| *bits != 0)?;
        let place = part * 64 + 63 - self.0[part].leading_zeros() as usize;
        u8::try_from(place).ok()
    }
}

/// What stands in a voxel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Met {
    /// Nothing solid.
    #[default]
    Nothing,
    /// Tissues; one, where segments do not overlap.
    Tissue(Layered),
    /// What no needle punctures, by the number of its segment.
    Wall(u8),
}

impl Met {
    /// Both at one place: what is hard counts before whatever else is there, tissues count together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Wall(_), _) | (_, Self::Nothing) => self,
            (_, Self::Wall(_)) | (Self::Nothing, _) => other,
            (Self::Tissue(one), Self::Tissue(other)) => Self::Tissue(one.and(other)),
        }
    }
}

/// What a needle can meet: body 0 stands in the scan's grid, and each other one in its own; neither
/// allocates nor panics.
pub trait TissueMap {
    /// What stands in a voxel of a body, whether it is punctured or not, for a needle that can
    /// puncture these tissues.
    fn at(&self, body: usize, voxel: IVec3, tissues: &Tissues) -> Met;

    /// Where a body stands, from number 1 on without a gap; none where there is no more.
    fn body(&self, number: usize) -> Option<NeedleBody<'_>>;

    /// Whether a segment that was punctured is no obstacle for the probe by now.
    fn is_open(&self) -> bool;
}

/// The scan that a needle goes into.
#[derive(Debug)]
pub struct NeedleScan<'a, M> {
    /// Where the scan stands.
    pub grid: &'a Grid,
    /// What stands in its voxels.
    pub map: &'a M,
}

impl<M> Clone for NeedleScan<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for NeedleScan<'_, M> {}

/// The scan, and what a needle can puncture of it.
#[derive(Debug)]
pub struct World<'a, M> {
    /// The scan.
    pub scan: NeedleScan<'a, M>,
    /// Tissues that the needle can puncture.
    pub tissues: &'a Tissues,
}

impl<M: TissueMap> World<'_, M> {
    /// What stands in a voxel of a body.
    pub fn at(&self, body: usize, voxel: IVec3) -> Met {
        self.scan.map.at(body, voxel, self.tissues)
    }
}
