//! Where nodes and bonds stand in memory.
//!
//! Memory: x fastest, then y, then z, with one column, one row and a tail of nodes that do not
//! exist. A bond is kept at its lower node; all bonds of one family lead from node n to node
//! n + offset, so that a family is one straight run through memory. Runs that leave the box end
//! in nodes that do not exist, where the stiffness is 0.

use glam::{IVec3, UVec3};

/// Nodes that are worked on together; a multiple of every vector width.
pub(super) const CHUNK: usize = 64;

/// From the lower node of a bond to its upper one: 3 faces, then 6 edges. With their opposites
/// these are the 18 neighbours.
pub const FAMILIES: [[i32; 3]; 9] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [-1, 1, 0],
    [1, 0, 1],
    [-1, 0, 1],
    [0, 1, 1],
    [0, -1, 1],
];

/// The number of bond families.
pub(super) const FAMILY_COUNT: usize = FAMILIES.len();

/// Sizes of a box of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    size: UVec3,
    row: usize,
    plane: usize,
    chunks: usize,
}

impl Layout {
    /// For a box of so many nodes along each axis.
    ///
    /// # Panics
    /// Where there are fewer than 2 or more than 256 along an axis.
    #[must_use]
    pub fn new(size: UVec3) -> Self {
        assert!(
            size.min_element() >= 2 && size.max_element() <= 256,
            "a box of {size} nodes"
        );
        let row = size.x as usize + 1;
        let plane = row * (size.y as usize + 1);
        Self {
            size,
            row,
            plane,
            chunks: (plane * size.z as usize).div_ceil(CHUNK),
        }
    }

    /// Nodes along each axis.
    #[must_use]
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Offset in memory from a node to the next along y.
    #[must_use]
    pub(super) fn row(&self) -> usize {
        self.row
    }

    /// Offset in memory from a node to the next along z.
    #[must_use]
    pub(super) fn plane(&self) -> usize {
        self.plane
    }

    /// Runs of nodes that are worked on together.
    #[must_use]
    pub(super) fn chunks(&self) -> usize {
        self.chunks
    }

    /// Length of an array with one entry for each node.
    #[must_use]
    pub fn len(&self) -> usize {
        // the last node's farthest neighbour must be in memory too
        self.chunks * CHUNK + (self.plane + self.row + 1).next_multiple_of(CHUNK)
    }

    /// Never: a box has nodes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Place of a node, which must be in the box.
    #[must_use]
    pub fn index(&self, node: UVec3) -> usize {
        (node.z as usize) * self.plane + (node.y as usize) * self.row + node.x as usize
    }

    /// Place of a node; none outside the box.
    #[must_use]
    pub fn index_of(&self, node: IVec3) -> Option<usize> {
        let inside = node.cmpge(IVec3::ZERO).all() && node.cmplt(self.size.as_ivec3()).all();
        inside.then(|| self.index(node.as_uvec3()))
    }

    /// The node at a place; none where no node exists.
    #[must_use]
    pub fn node_at(&self, index: usize) -> Option<UVec3> {
        let node = UVec3::new(
            (index % self.row) as u32,
            (index % self.plane / self.row) as u32,
            (index / self.plane) as u32,
        );
        node.cmplt(self.size).all().then_some(node)
    }

    /// All nodes with their places, in the order of memory.
    pub fn nodes(&self) -> impl Iterator<Item = (UVec3, usize)> + use<> {
        let layout = *self;
        let UVec3 { x, y, z } = layout.size;
        let rows = (0..z).flat_map(move |z| (0..y).map(move |y| UVec3::new(0, y, z)));
        rows.flat_map(move |row| {
            let first = layout.index(row);
            (0..x).map(move |x| (row.with_x(x), first + x as usize))
        })
    }

    /// Offset in memory from the lower node of a bond to its upper one.
    #[must_use]
    pub(super) fn offset(&self, family: usize) -> usize {
        let [x, y, z] = FAMILIES[family].map(|step| step as isize);
        let offset = x + y * self.row as isize + z * self.plane as isize;
        offset as usize
    }
}
