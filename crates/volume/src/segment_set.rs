//! A set of segments, as one bit for each number.

use serde::{Deserialize, Serialize};

use crate::edit::SegmentId;

/// A set of segments, one bit for each number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SegmentSet([u64; 4]);

impl SegmentSet {
    /// The empty set.
    pub const EMPTY: Self = Self([0; 4]);

    /// The set and this segment.
    #[must_use]
    pub fn with(mut self, id: SegmentId) -> Self {
        self.0[usize::from(id.0 >> 6)] |= 1 << (id.0 & 63);
        self
    }

    /// The set without this segment.
    #[must_use]
    pub fn without(mut self, id: SegmentId) -> Self {
        self.0[usize::from(id.0 >> 6)] &= !(1 << (id.0 & 63));
        self
    }

    /// Whether the segment belongs to the set.
    pub fn contains(&self, id: SegmentId) -> bool {
        self.0[usize::from(id.0 >> 6)] >> (id.0 & 63) & 1 != 0
    }

    /// Segments of the set, by rising number.
    pub fn ids(&self) -> impl Iterator<Item = SegmentId> {
        let set = *self;
        (0..=u8::MAX)
            .map(SegmentId)
            .filter(move |id| set.contains(*id))
    }

    /// The segments of both sets.
    #[must_use]
    pub fn intersect(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] & other.0[i]))
    }

    /// Number of segments in the set.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.iter().map(|bits| bits.count_ones() as usize).sum()
    }

    /// Whether no segment belongs to it.
    pub fn is_empty(&self) -> bool {
        *self == Self::EMPTY
    }
}

impl FromIterator<SegmentId> for SegmentSet {
    fn from_iter<I: IntoIterator<Item = SegmentId>>(ids: I) -> Self {
        ids.into_iter().fold(Self::EMPTY, Self::with)
    }
}
