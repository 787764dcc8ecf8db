//! Which segments a needle can puncture and what they are made of, and what it meets on its way.

use glam::IVec3;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::tissue::Tissue;
use serde::{Deserialize, Serialize};

use super::stretches::NeedleBody;

/// Most segments that a needle can puncture; further ones stay hard.
pub const MAX_TISSUES: usize = 16;

/// Segments, by number, that a needle can puncture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tissues([Option<(u8, Tissue)>; MAX_TISSUES]);

impl Tissues {
    /// These segments; the first [`MAX_TISSUES`] of them, none that is no tissue.
    pub fn of(segments: impl IntoIterator<Item = (u8, Tissue)>) -> Self {
        let mut tissues = Self::default();
        let good = segments
            .into_iter()
            .filter(|(_, tissue)| tissue.check().is_ok());
        for (place, segment) in tissues.0.iter_mut().zip(good) {
            *place = Some(segment);
        }
        tissues
    }

    /// All tissues with the numbers of their segments.
    pub fn segments(&self) -> impl Iterator<Item = (u8, Tissue)> {
        self.0.into_iter().flatten()
    }

    /// The place of a segment in the table; none where it cannot be punctured.
    #[must_use]
    pub fn place_of(&self, segment: u8) -> Option<u8> {
        let is_it = |entry: &Option<(u8, Tissue)>| entry.is_some_and(|(id, _)| id == segment);
        let place = self.0.iter().position(is_it)?;
        u8::try_from(place).ok()
    }

    /// Segment and tissue of what counts where several are: the last of them, as in the picture.
    #[must_use]
    pub fn top(&self, layer: Layered) -> Option<(u8, Tissue)> {
        let there = (0_u8..).zip(self.0).filter(|(place, _)| layer.has(*place));
        there.filter_map(|(_, entry)| entry).last()
    }

    /// The segments of a layer.
    pub fn segments_of(&self, layer: Layered) -> impl Iterator<Item = SegmentId> {
        let there = (0_u8..)
            .zip(self.0)
            .filter(move |(place, _)| layer.has(*place));
        there.filter_map(|(_, entry)| Some(SegmentId(entry?.0)))
    }
}

/// Tissues that overlap, one bit for each place in [`Tissues`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Layered(u16);

impl Layered {
    /// The tissue at a place alone.
    #[must_use]
    pub fn of(place: u8) -> Self {
        Self::default().with(place)
    }

    /// This one too.
    #[must_use]
    pub fn with(self, place: u8) -> Self {
        Self(self.0 | Self::bit(place))
    }

    /// The tissues of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether the tissue at a place belongs to it.
    #[must_use]
    pub fn has(self, place: u8) -> bool {
        self.0 & Self::bit(place) != 0
    }

    fn bit(place: u8) -> u16 {
        1_u16.checked_shl(u32::from(place)).unwrap_or(0)
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
