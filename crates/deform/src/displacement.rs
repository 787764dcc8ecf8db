//! How far tissue has moved from rest, and what of it the voxels do not show yet.
//!
//! Nodes stand on a cubic lattice along the axes of the grid. A place of tissue at rest X stands
//! at X + u(X) now; so what stands at x was at rest where X + u(X) = x.
//!
//! Frame: mm along the axes of the grid, from its corner.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use crate::model::DisplacementField;
use crate::voxel_ledger::Ledger;

/// Shares of the displacement of tissue with which the empty nodes beside it go along, by their
/// distance [nodes].
pub(crate) const BESIDE: [f64; 4] = [1.0, 0.75, 0.5, 0.25];
/// Steps of Newton toward the place at rest.
const STEPS: u32 = 12;
/// How far voxels are behind the tissue that they show, at most: half of one and the margin by
/// which they change late [voxels].
const BEHIND: f64 = 0.65;
/// Halvings of that way by which the last of tissue before a face is found: to a fortieth of a voxel.
const HALVINGS: u32 = 5;
/// Nodes before the border of a box over which what is left to show fades, where it does.
const EDGE: f64 = 3.0;
/// Accuracy with which the place at rest is found [spacings].
const NEAR: f64 = 1e-3;

/// Displacements on a box of nodes, x fastest.
#[derive(Clone, Debug)]
pub(crate) struct Displacement {
    /// Where the first node is at rest.
    pub first: DVec3,
    /// Between nodes.
    pub spacing: f64,
    /// Nodes along each axis.
    pub size: UVec3,
    /// Displacement of each node from rest; continued beside tissue, zero farther away.
    moved: Vec<DVec3>,
    has_matter: Vec<bool>,
    /// Whether tissue beyond the border has moved too, and is shown by voxels alone.
    goes_on: bool,
}

impl Displacement {
    /// A field from the displacements of the nodes that hold tissue.
    pub fn new(first: DVec3, spacing: f64, size: UVec3, moved: Vec<Option<DVec3>>) -> Self {
        Self {
            first,
            spacing,
            size,
            has_matter: moved.iter().map(Option::is_some).collect(),
            moved: continued(size, moved),
            goes_on: false,
        }
    }

    /// As it is, and tissue beyond the border may have moved too: there voxels alone show it.
    pub fn going_on(self) -> Self {
        Self {
            goes_on: true,
            ..self
        }
    }

    /// A box around all places that have moved by as much as `least` along any axis; none where none
    /// has.
    pub fn moving(&self, least: DVec3) -> Option<[DVec3; 2]> {
        let far = |moved: &DVec3| moved.abs().cmpge(least).any();
        let moving = self
            .moved
            .iter()
            .enumerate()
            .filter(|(_, moved)| far(moved));
        let boxes = moving.map(|(node, _)| {
            let place = self.place_of(node);
            [place - self.spacing, place + self.spacing]
        });
        boxes.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])
    }

    /// Voxels that the nodes reach.
    pub fn region(&self, grid: &Grid) -> VoxelBox {
        region_of(self.first, self.spacing, self.size, grid)
    }

    /// Between nodes trilinear; zero outside the box.
    pub fn at(&self, rest: DVec3) -> DVec3 {
        self.cell(rest).map_or(DVec3::ZERO, |cell| cell.value())
    }

    /// Where what stands at a place was at rest; none where tissue is folded so that nobody can
    /// tell. By Newton's method.
    pub fn rest_of(&self, place: DVec3) -> Option<DVec3> {
        let mut rest = place;
        for _ in 0..STEPS {
            let (moved, slope) = match self.cell(rest) {
                Some(cell) => (cell.value(), cell.slope() * self.spacing.recip()),
                None => (DVec3::ZERO, DMat3::ZERO),
            };
            let miss = rest + moved - place;
            if miss.abs().max_element() < NEAR * self.spacing {
                return Some(rest);
            }
            let stretch = DMat3::IDENTITY + slope;
            // where it is nearly folded, the plain step
            let step = if stretch.determinant() > 0.1 {
                stretch.inverse() * miss
            } else {
                miss
            };
            rest -= step.clamp_length_max(2.0 * self.spacing);
        }
        None
    }

    /// What the voxels do not show yet, the ledger's last edit taken in; none where that is
    /// below `least` everywhere. It fades toward a border beyond which voxels alone show it.
    pub fn residual(
        &self,
        voxels: &Voxels,
        ledger: &Ledger,
        least: f64,
    ) -> Option<DisplacementField> {
        let grid = voxels.grid();
        let view = Shown::new(self, voxels, ledger);
        let nodes = 0..self.moved.len();
        let left: Vec<_> = nodes.clone().map(|node| view.left_at(node)).collect();
        let beside = |node: usize| left[node].or_else(|| view.left_beside(node, &left));
        let left = nodes.map(beside).collect();
        let mut left = continued(self.size, left);
        if self.goes_on {
            for (node, left) in left.iter_mut().enumerate() {
                *left *= self.share_inside(node);
            }
        }
        self.seen(&left, grid, least)
    }

    /// All of it, no place farther than `farthest`, where no voxel shows any; none where that is below
    /// `least` everywhere.
    pub fn whole(&self, grid: &Grid, least: f64, farthest: f64) -> Option<DisplacementField> {
        let near = |moved: &DVec3| moved.clamp_length_max(farthest);
        let moved: Vec<_> = self.moved.iter().map(near).collect();
        self.seen(&moved, grid, least)
    }

    /// What is to be seen of this at the nodes; none where it is below `least` everywhere.
    fn seen(&self, moved: &[DVec3], grid: &Grid, least: f64) -> Option<DisplacementField> {
        let seen = moved.iter().any(|moved| moved.length() >= least);
        let axes = grid.direction();
        let in_voxels = self.first / grid.spacing();
        seen.then(|| DisplacementField {
            origin: grid.patient_from_grid().transform_point3(in_voxels),
            axes,
            spacing: self.spacing,
            size: self.size,
            moved: moved
                .iter()
                .map(|moved| (axes * *moved).as_vec3())
                .collect(),
        })
    }

    fn place_of(&self, node: usize) -> DVec3 {
        self.first + node_at(self.size, node).as_dvec3() * self.spacing
    }

    /// 1 inside of the box, and less from [`EDGE`] nodes before its border on, to 0 there.
    fn share_inside(&self, node: usize) -> f64 {
        let node = node_at(self.size, node);
        let before = node.min(self.size.as_ivec3() - 1 - node).min_element();
        (f64::from(before) / EDGE).min(1.0)
    }

    /// Whether tissue at rest is at a place.
    fn has_matter_at(&self, rest: DVec3) -> bool {
        let node = ((rest - self.first) / self.spacing).round().as_ivec3();
        let inside = node.cmpge(IVec3::ZERO).all() && node.cmplt(self.size.as_ivec3()).all();
        inside && self.has_matter[index_of(self.size, node)]
    }

    fn cell(&self, rest: DVec3) -> Option<Cell> {
        let at = (rest - self.first) / self.spacing;
        let last = self.size.as_ivec3() - 1;
        // comparisons with NaN are false
        let inside = at.cmpge(DVec3::ZERO).all() && at.cmple(last.as_dvec3()).all();
        if !inside {
            return None;
        }
        let low = at.floor().as_ivec3().min(last - 1);
        let step = |corner: i32| IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
        let node = |corner| self.moved[index_of(self.size, low + step(corner as i32))];
        Some(Cell {
            corners: std::array::from_fn(node),
            share: at - low.as_dvec3(),
        })
    }
}

/// A field of displacements and the voxels that show a part of it.
struct Shown<'a> {
    field: &'a Displacement,
    voxels: &'a Voxels,
    ledger: &'a Ledger,
    /// Size of a voxel [mm].
    spacing: DVec3,
    /// How far the tissue that the voxel of a node shows has come from rest; none where it
    /// shows none.
    shown: Vec<Option<DVec3>>,
}

impl<'a> Shown<'a> {
    fn new(field: &'a Displacement, voxels: &'a Voxels, ledger: &'a Ledger) -> Self {
        let spacing = voxels.grid().spacing();
        let mut view = Self {
            field,
            voxels,
            ledger,
            spacing,
            shown: Vec::new(),
        };
        let shown = |node: usize| match ledger.changed(view.voxel_of(node)) {
            Some(changed) => changed.shown.map(|shown| shown * spacing),
            None => field.has_matter[node].then_some(DVec3::ZERO),
        };
        view.shown = (0..field.moved.len()).map(shown).collect();
        view
    }

    fn voxel_of(&self, node: usize) -> IVec3 {
        (self.field.place_of(node) / self.spacing)
            .floor()
            .as_ivec3()
    }

    /// What is left to show of the tissue that is shown at a node.
    fn left_at(&self, node: usize) -> Option<DVec3> {
        let shown = self.shown[node]?;
        Some(self.field.at(self.field.place_of(node) - shown) - shown)
    }

    /// For an empty node, the value that brings the face which is shown beside it to where the
    /// face of tissue is: the mean over the nodes beside it that show tissue.
    fn left_beside(&self, node: usize, left: &[Option<DVec3>]) -> Option<DVec3> {
        let (mut sum, mut count) = (DVec3::ZERO, 0.0);
        for near in neighbours(self.field.size, node) {
            let Some(left) = left[near] else {
                continue;
            };
            let step = node_at(self.field.size, node) - node_at(self.field.size, near);
            let (place, toward) = (self.field.place_of(near), step.as_dvec3());
            let face = self.face_of(self.voxel_of(near), place, toward);
            let along = left.dot(toward);
            let left_at_face = left + toward * (self.ahead_of(face, toward) - along);
            // a face just beside the node would throw the value far away
            let way = (face - place).dot(toward) / self.field.spacing;
            sum += left + (left_at_face - left) / way.clamp(0.5, 1.0);
            count += 1.0;
        }
        (count > 0.0).then(|| sum / count)
    }

    /// Where the line from a place in a voxel leaves it.
    fn face_of(&self, voxel: IVec3, place: DVec3, toward: DVec3) -> DVec3 {
        let end = (voxel.as_dvec3() + toward.max(DVec3::ZERO)) * self.spacing;
        DVec3::select(toward.cmpeq(DVec3::ZERO), place, end)
    }

    /// Whether the voxel of a place at rest is solid: nodes may stand farther apart than voxels.
    fn is_solid_at_rest(&self, rest: DVec3) -> bool {
        let voxel = (rest / self.spacing).floor().as_ivec3();
        let matter = self.ledger.rest(self.voxels, voxel);
        matter.is_some_and(|matter| !matter.segments.is_empty())
    }

    /// How far before a face that voxels show the face of tissue stands, or less than zero behind
    /// it [mm]: layers that are pressed flat between the two, and shown by no voxel, are taken in.
    fn ahead_of(&self, face: DVec3, toward: DVec3) -> f64 {
        let most = BEHIND * self.spacing.dot(toward.abs());
        let matter_at = |ahead: f64| {
            let rest = self.field.rest_of(face + toward * ahead);
            rest.filter(|rest| self.field.has_matter_at(*rest) && self.is_solid_at_rest(*rest))
        };
        let [mut low, mut high] = [-most, most];
        let mut last = None;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let matter = matter_at(middle);
            match matter {
                Some(_) => (low, last) = (middle, matter),
                None => high = middle,
            }
        }
        // the face of the last voxel of tissue, where it stands
        last.map_or(-most, |rest| {
            let end = self.face_of((rest / self.spacing).floor().as_ivec3(), rest, toward);
            (end + self.field.at(end) - face)
                .dot(toward)
                .clamp(-most, most)
        })
    }
}

/// Eight nodes around a place.
struct Cell {
    corners: [DVec3; 8],
    /// Where in it the place is, 0..1.
    share: DVec3,
}

impl Cell {
    fn value(&self) -> DVec3 {
        let [x, y, z] = self.share.to_array();
        let along_x = |n: usize| self.corners[n].lerp(self.corners[n + 1], x);
        let along_y = |n: usize| along_x(n).lerp(along_x(n + 2), y);
        along_y(0).lerp(along_y(4), z)
    }

    /// Gradient of the displacement, per step of one node.
    fn slope(&self) -> DMat3 {
        let [x, y, z] = self.share.to_array();
        let c = &self.corners;
        let mean = |[a, b, c, d]: [DVec3; 4], p: f64, q: f64| a.lerp(b, p).lerp(c.lerp(d, p), q);
        DMat3::from_cols(
            mean([c[1] - c[0], c[3] - c[2], c[5] - c[4], c[7] - c[6]], y, z),
            mean([c[2] - c[0], c[3] - c[1], c[6] - c[4], c[7] - c[5]], x, z),
            mean([c[4] - c[0], c[5] - c[1], c[6] - c[2], c[7] - c[3]], x, y),
        )
    }
}

/// Voxels that a box of nodes from `first` on reaches.
pub(crate) fn region_of(first: DVec3, spacing: f64, size: UVec3, grid: &Grid) -> VoxelBox {
    let last = first + (size.as_dvec3() - 1.0) * spacing;
    let low = (first / grid.spacing()).floor().as_ivec3();
    let high = (last / grid.spacing()).ceil().as_ivec3();
    VoxelBox::new(low, high).intersect(&grid.bounds())
}

fn index_of(size: UVec3, node: IVec3) -> usize {
    let node = node.as_uvec3();
    (node.x + size.x * (node.y + size.y * node.z)) as usize
}

pub(crate) fn node_at(size: UVec3, index: usize) -> IVec3 {
    let index = index as u32;
    UVec3::new(
        index % size.x,
        index / size.x % size.y,
        index / (size.x * size.y),
    )
    .as_ivec3()
}

/// Has empty nodes beside tissue go along with it, so that a surface between nodes moves as the
/// tissue under it, and those farther away less and less.
fn continued(size: UVec3, mut moved: Vec<Option<DVec3>>) -> Vec<DVec3> {
    let mut share_before = 1.0;
    let mut front: Vec<usize> = (0..moved.len()).filter(|&n| moved[n].is_some()).collect();
    for share in BESIDE {
        let beside = front.iter().flat_map(|&index| {
            let value = moved[index].unwrap_or_default();
            neighbours(size, index).map(move |near| (near, value))
        });
        let mut given: Vec<_> = beside.filter(|(near, _)| moved[*near].is_none()).collect();
        // stable: the same sums, in the order of the nodes that they are of
        given.sort_by_key(|(near, _)| *near);
        front.clear();
        for of_one in given.chunk_by(|one, other| one.0 == other.0) {
            let (near, count) = (of_one[0].0, of_one.len() as f64);
            let sum: DVec3 = of_one.iter().map(|(_, value)| *value).sum();
            moved[near] = Some(sum * (share / share_before / count));
            front.push(near);
        }
        share_before = share;
    }
    moved.into_iter().map(Option::unwrap_or_default).collect()
}

/// The six nodes beside one, as far as they are in the box.
fn neighbours(size: UVec3, index: usize) -> impl Iterator<Item = usize> {
    let node = node_at(size, index);
    let steps = IVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    let inside =
        move |node: &IVec3| node.cmpge(IVec3::ZERO).all() && node.cmplt(size.as_ivec3()).all();
    steps
        .map(move |step| node + step)
        .filter(inside)
        .map(move |near| index_of(size, near))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slab whose upper face at z = 4 is pressed down by 1.2, less and less below.
    fn slab() -> Displacement {
        let size = UVec3::new(5, 5, 12);
        let moved = |index| {
            let z = node_at(size, index).z;
            (z < 4).then(|| DVec3::NEG_Z * 0.4 * f64::from(z))
        };
        let nodes = (0..size.element_product() as usize).map(moved);
        Displacement::new(DVec3::splat(0.5), 1.0, size, nodes.collect())
    }

    #[test]
    fn what_stands_at_a_place_is_found_at_rest_inside_matter_and_beside_it() {
        let field = slab();
        for step in 0..100 {
            let rest = DVec3::new(2.1, 2.7, 0.6 + 0.1 * f64::from(step));
            let found = field.rest_of(rest + field.at(rest)).expect("not folded");
            assert!((found - rest).length() < 0.02, "{rest} {found}");
        }
        // the face itself moves as the node under it does
        assert!((field.at(DVec3::new(2.5, 2.5, 4.0)).z + 1.2).abs() < 1e-12);
        assert_eq!(field.at(DVec3::new(2.5, 2.5, 11.0)), DVec3::ZERO);
    }

    #[test]
    fn places_that_are_none_harm_nothing() {
        let field = slab();
        assert_eq!(field.at(DVec3::NAN), DVec3::ZERO);
        assert_eq!(field.rest_of(DVec3::NAN), None);
        assert_eq!(field.rest_of(DVec3::splat(1e9)), Some(DVec3::splat(1e9)));
    }
}
