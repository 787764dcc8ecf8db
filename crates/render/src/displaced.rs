//! Tissue that stands beside the voxels that show it: the scan is pulled back through its displacements.
//!
//! What is seen at a place is what the scan holds where the tissue of that place is at rest. The page's shaders have
//! the same (`shaders/scan/displacements.glsl`). Positions are those of the grid.

use glam::{DVec3, IVec3, UVec3, Vec3};
use palpate_volume::brick_grid::BRICK;
use palpate_volume::simd_dispatch;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxel_box::VoxelBox;

use crate::field::Field;
#[cfg(target_arch = "x86_64")]
use crate::lanes::Avx2;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Plain, Vector};

/// Displacements at the nodes of a box; node (i, j, k) stands at `origin + step · (i, j, k)`.
#[derive(Clone, Copy, Debug)]
pub struct Displacements<'a> {
    /// First node [grid].
    pub origin: DVec3,
    /// Between nodes [voxels], above 0.
    pub step: DVec3,
    /// Nodes along each axis, x fastest in memory.
    pub size: UVec3,
    /// How far tissue stands from the voxels that show it, along the axes of the grid [mm].
    pub moved: &'a [Vec3],
}

/// By less nobody sees a node stand elsewhere [voxels].
const SEEN: f32 = 0.005;

/// Displacements as rays look them up: those of all boxes that hold a place add up.
#[derive(Clone, Debug)]
pub(crate) struct Displaced {
    boxes: Vec<NodeBox>,
}

/// Displacements of one box: trilinear between nodes, none more than half a step beyond the outermost.
#[derive(Clone, Debug)]
struct NodeBox {
    /// Voxels along each axis, and 0.
    moved: Vec<[f32; 4]>,
    size: IVec3,
    /// From a node to the next along each axis in memory, 0 where there is none.
    strides: [i32; 3],
    /// Nodes from the first on, at a place: factor and term.
    scale: Vec3,
    term: Vec3,
    /// No node goes farther along an axis [voxels].
    farthest: f32,
    /// Bricks, at most, between a place and what is seen there.
    reach: f32,
}

impl Displaced {
    /// In a scan of voxels of this size [mm]; none without a box.
    ///
    /// # Panics
    /// Where there is no node, or not one displacement for each.
    pub fn new(given: &[Displacements<'_>], spacing: Vec3) -> Option<Self> {
        let boxes = given.iter().map(|given| NodeBox::new(given, spacing));
        (!given.is_empty()).then(|| Self {
            boxes: boxes.collect(),
        })
    }

    /// Voxels that look different with one than with the other.
    pub fn differing(one: Option<&Self>, other: Option<&Self>) -> VoxelBox {
        let [one, other] = [one, other].map(|it| it.map_or(&[][..], |it| &it.boxes));
        let differing = |n| NodeBox::differing(one.get(n), other.get(n));
        let numbers = 0..one.len().max(other.len());
        numbers
            .map(differing)
            .fold(VoxelBox::EMPTY, |all, voxels| all.union(&voxels))
    }

    /// How far what stands in the scan may be from the voxels that show it [voxels].
    pub fn farthest(&self) -> f32 {
        self.boxes.iter().map(|nodes| nodes.farthest).sum()
    }

    /// Where the tissue that stands at places is at rest, by two steps of a fixed-point iteration.
    #[inline(always)]
    pub fn at_rest<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        if !self.hold(grid, 0.0).any() {
            return grid;
        }
        let mut places = stored(grid);
        pull_back(self, &mut places, SimdLevel::widest());
        loaded(&places)
    }

    /// Gradient of what is seen at places, in the scan's unit [per mm].
    #[inline(always)]
    pub fn gradient_at<L: Gather>(&self, field: &Field, grid: Vector<L>) -> Vector<L> {
        let mut places = stored(grid);
        differ((self, field), &mut places, SimdLevel::widest());
        loaded(&places)
    }

    /// What stands at rest at places, displaced: where it stands then [grid], and its normals, along the grid's axes, as
    /// they turn with the tissue around them, not of length 1. None where none of the places is displaced.
    #[inline(always)]
    pub fn stood_at<L: Gather>(
        &self,
        rest: Vector<L>,
        normal: Vector<L>,
        spacing: Vec3,
    ) -> Option<(Vector<L>, Vector<L>)> {
        let inside = self.hold(rest, 0.0);
        if !inside.any() {
            return None;
        }
        let turned = self.turned(rest, normal, spacing);
        let place = rest + self.at(rest, rest);
        Some((place.or_else(inside, rest), turned.or_else(inside, normal)))
    }

    /// Normals as they turn with the tissue around them: by the cofactors of the displacements' gradient, from
    /// differences over a voxel. Tissue that is folded has no side: there they stay.
    #[inline(always)]
    fn turned<L: Gather>(&self, rest: Vector<L>, normal: Vector<L>, spacing: Vec3) -> Vector<L> {
        let column = |axis: Vec3| {
            let reach = Vector::splat(0.5 * axis);
            let there = self.at(rest, rest + reach) - self.at(rest, rest - reach);
            // voxels to mm, over a voxel along the axis
            there.times(Vector::splat(spacing / spacing.dot(axis))) + Vector::splat(axis)
        };
        let (x, y, z) = (column(Vec3::X), column(Vec3::Y), column(Vec3::Z));
        let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
        let is_whole = L::Float::splat(0.1).less(x.dot(yz));
        let turned = yz.scaled(normal.x) + zx.scaled(normal.y) + xy.scaled(normal.z);
        turned.normalized().or_else(is_whole, normal)
    }

    /// Which places lie among the nodes of a box, or so many voxels beside them.
    #[inline(always)]
    pub fn hold<L: Gather>(&self, grid: Vector<L>, beside: f32) -> L::Mask {
        let holds = |held: L::Mask, nodes: &NodeBox| held | nodes.hold(grid, beside);
        self.boxes.iter().fold(Masks::splat(false), holds)
    }

    /// Bricks by which empty space ends earlier along rays: along those that meet a box, beside whose voxels
    /// something may stand. `inverse`: mm for each voxel along each axis.
    #[inline(always)]
    pub fn margin<L: Gather>(&self, origin: Vector<L>, inverse: Vector<L>) -> L::Float {
        let add = |sum: L::Float, nodes: &NodeBox| sum + nodes.margin(origin, inverse);
        self.boxes.iter().fold(L::Float::splat(0.0), add)
    }

    /// Displacements at places [voxels], of the boxes that hold the `held` ones.
    #[inline(always)]
    fn at<L: Gather>(&self, held: Vector<L>, grid: Vector<L>) -> Vector<L> {
        let none = Vector::splat(Vec3::ZERO);
        let add = |sum: Vector<L>, nodes: &NodeBox| {
            sum + nodes.at(grid).or_else(nodes.hold(held, 0.0), none)
        };
        self.boxes.iter().fold(none, add)
    }

    #[inline(always)]
    fn pulled_back<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        let first = grid - self.at(grid, grid);
        grid - self.at(grid, first)
    }

    /// Central differences over a voxel to each side, to a gradient in the scan's unit [per mm].
    #[inline(always)]
    fn differences<L: Gather>(&self, field: &Field, grid: Vector<L>) -> Vector<L> {
        let zero = L::Float::splat(0.0);
        let mut sums = [zero; 3];
        // one body for all six
        for i in 0..6 {
            let axis = i / 2;
            let toward = if i % 2 == 0 { -1.0 } else { 1.0 };
            let aside = grid + Vector::splat(toward * Vec3::AXES[axis]);
            let value = field.value_at(self.pulled_back(aside));
            sums[axis] = sums[axis] + value * Floats::splat(toward);
        }
        let [x, y, z] = sums;
        Vector::new(x, y, z).times(Vector::splat(field.gradient_scale()))
    }
}

impl NodeBox {
    /// In a scan of voxels of this size [mm].
    ///
    /// # Panics
    /// Where there is no node, or not one displacement for each.
    fn new(given: &Displacements<'_>, spacing: Vec3) -> Self {
        let size = given.size.as_ivec3();
        let nodes = given.size.element_product() as usize;
        assert!(
            nodes > 0 && given.moved.len() == nodes,
            "{} displacements for {nodes} nodes",
            given.moved.len()
        );
        let in_voxels = |moved: &Vec3| {
            let moved = *moved / spacing;
            if moved.is_finite() { moved } else { Vec3::ZERO }
        };
        let moved: Vec<_> = given.moved.iter().map(in_voxels).collect();
        let farthest = moved
            .iter()
            .fold(0.0, |most: f32, it| most.max(it.abs().max_element()));
        let stride = |size: i32, stride: i32| if size > 1 { stride } else { 0 };
        Self {
            moved: moved.iter().map(|it| [it.x, it.y, it.z, 0.0]).collect(),
            size,
            strides: [
                stride(size.x, 1),
                stride(size.y, size.x),
                stride(size.z, size.x * size.y),
            ],
            scale: given.step.recip().as_vec3(),
            term: (-given.origin / given.step).as_vec3(),
            farthest,
            reach: (farthest / BRICK as f32).ceil(),
        }
    }

    /// Voxels that look different with the nodes of one than with those of the other.
    fn differing(one: Option<&Self>, other: Option<&Self>) -> VoxelBox {
        match (one, other) {
            (Some(one), Some(other)) if one.has_nodes_of(other) => {
                let nodes = one.moved.iter().zip(&other.moved).enumerate();
                let differ = nodes.filter(|(_, (a, b))| (0..3).any(|n| (a[n] - b[n]).abs() > SEEN));
                let reach = one.farthest.max(other.farthest);
                one.around(differ.map(|(index, _)| index), reach)
            }
            (one, other) => {
                let all = |nodes: &Self| nodes.around(0..nodes.moved.len(), nodes.farthest);
                let [one, other] = [one, other].map(|it| it.map_or(VoxelBox::EMPTY, all));
                one.union(&other)
            }
        }
    }

    fn has_nodes_of(&self, other: &Self) -> bool {
        (self.size, self.scale, self.term) == (other.size, other.scale, other.term)
    }

    /// Voxels in which nodes show what is up to `reach` voxels away.
    fn around(&self, nodes: impl Iterator<Item = usize>, reach: f32) -> VoxelBox {
        let place = |index: usize| {
            let [x, y] = [self.size.x, self.size.y];
            let index = index as i32;
            IVec3::new(index % x, index / x % y, index / (x * y))
        };
        let ends = nodes.map(place).map(|node| (node, node));
        let ends = ends.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)));
        let Some((first, last)) = ends else {
            return VoxelBox::EMPTY;
        };
        // a node counts as far as the next ones
        let in_grid = |node: IVec3| (node.as_vec3() - self.term) / self.scale;
        let (low, high) = (in_grid(first - 1) - reach, in_grid(last + 1) + reach);
        VoxelBox::new(low.floor().as_ivec3(), high.ceil().as_ivec3())
    }

    /// Which places lie among the nodes, or so many voxels beside them.
    #[inline(always)]
    fn hold<L: Gather>(&self, grid: Vector<L>, beside: f32) -> L::Mask {
        let place = self.in_nodes(grid);
        let low = -0.5 - beside * self.scale;
        let high = self.size.as_vec3() - low - 1.0;
        L::Float::splat(low.x).less(place.x)
            & L::Float::splat(low.y).less(place.y)
            & L::Float::splat(low.z).less(place.z)
            & place.x.less(Floats::splat(high.x))
            & place.y.less(Floats::splat(high.y))
            & place.z.less(Floats::splat(high.z))
    }

    /// Bricks by which empty space ends earlier along rays that meet the box.
    #[inline(always)]
    fn margin<L: Gather>(&self, origin: Vector<L>, inverse: Vector<L>) -> L::Float {
        let zero = L::Float::splat(0.0);
        let low = (-self.term - 0.5) / self.scale;
        let high = low + self.size.as_vec3() / self.scale;
        let a = (Vector::splat(low) - origin).times(inverse);
        let b = (Vector::splat(high) - origin).times(inverse);
        let enter = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z));
        let leave = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z));
        let meets = enter.at_most(leave) & zero.at_most(leave);
        L::Float::splat(self.reach).or_else(meets, zero)
    }

    #[inline(always)]
    fn in_nodes<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        grid.times(Vector::splat(self.scale)) + Vector::splat(self.term)
    }

    /// Displacements at places [voxels]; beyond the outermost nodes theirs.
    #[inline(always)]
    fn at<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        let place = self.in_nodes(grid);
        let (x, x_share) = between::<L>(place.x, self.size.x);
        let (y, y_share) = between::<L>(place.y, self.size.y);
        let (z, z_share) = between::<L>(place.z, self.size.z);
        let [_, rows, layers] = self.strides;
        let first = x + y * Ints::splat(rows) + z * Ints::splat(layers);
        let near = mixed(
            self.row::<L>(first, 0, x_share),
            self.row::<L>(first, rows, x_share),
            y_share,
        );
        let far = mixed(
            self.row::<L>(first, layers, x_share),
            self.row::<L>(first, layers + rows, x_share),
            y_share,
        );
        mixed(near, far, z_share)
    }

    /// Two neighbouring nodes along x, mixed; `offset` nodes from the first in memory.
    #[inline(always)]
    fn row<L: Gather>(&self, first: L::Int, offset: i32, share: L::Float) -> Vector<L> {
        let low = first + Ints::splat(offset);
        let high = low + Ints::splat(self.strides[0]);
        // SAFETY: the first was clamped to nodes that have a next one along each axis in which there are several
        let (low, high) = unsafe { (L::rows(&self.moved, low), L::rows(&self.moved, high)) };
        mixed(
            Vector::new(low[0], low[1], low[2]),
            Vector::new(high[0], high[1], high[2]),
            share,
        )
    }
}

/// The first of two nodes, and the fraction of the way to the second.
#[inline(always)]
fn between<L: Gather>(place: L::Float, count: i32) -> (L::Int, L::Float) {
    let inside = place
        .max(Floats::splat(0.0))
        .min(Floats::splat((count - 1) as f32));
    let first = inside
        .truncated()
        .min(Ints::splat(count - 2))
        .max(Ints::splat(0));
    (first, inside - first.to_float())
}

#[inline(always)]
fn mixed<L: Gather>(a: Vector<L>, b: Vector<L>, share: L::Float) -> Vector<L> {
    a + (b - a).scaled(share)
}

/// Eight vectors in memory.
type Vectors = [[f32; LANES]; 3];

#[inline(always)]
fn stored<L: Gather>(vectors: Vector<L>) -> Vectors {
    [vectors.x.store(), vectors.y.store(), vectors.z.store()]
}

#[inline(always)]
fn loaded<L: Gather>([x, y, z]: &Vectors) -> Vector<L> {
    Vector::new(Floats::load(x), Floats::load(y), Floats::load(z))
}

// functions of their own: they are large, and most pictures show no displaced tissue
#[cfg(target_arch = "x86_64")]
simd_dispatch! {
    fn pull_back(displaced: &Displaced, places: &mut Vectors, level: SimdLevel) =
        [avx2 => pull_back_avx2] pull_back_plain, at level
}

#[cfg(target_arch = "x86_64")]
simd_dispatch! {
    fn differ(scan: (&Displaced, &Field), places: &mut Vectors, level: SimdLevel) =
        [avx2 => differ_avx2] differ_plain, at level
}

#[cfg(not(target_arch = "x86_64"))]
fn pull_back(displaced: &Displaced, places: &mut Vectors, level: SimdLevel) {
    pull_back_plain(displaced, places, level);
}

#[cfg(not(target_arch = "x86_64"))]
fn differ(scan: (&Displaced, &Field), places: &mut Vectors, level: SimdLevel) {
    differ_plain(scan, places, level);
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn pull_back_avx2(displaced: &Displaced, places: &mut Vectors, _: SimdLevel) {
    *places = stored(displaced.pulled_back::<Avx2>(loaded(places)));
}

fn pull_back_plain(displaced: &Displaced, places: &mut Vectors, _: SimdLevel) {
    *places = stored(displaced.pulled_back::<Plain>(loaded(places)));
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn differ_avx2((displaced, field): (&Displaced, &Field), places: &mut Vectors, _: SimdLevel) {
    *places = stored(displaced.differences::<Avx2>(field, loaded(places)));
}

fn differ_plain((displaced, field): (&Displaced, &Field), places: &mut Vectors, _: SimdLevel) {
    *places = stored(displaced.differences::<Plain>(field, loaded(places)));
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, UVec3, Vec3};
    use palpate_volume::simd_dispatch::SimdLevel;

    use super::{Displaced, Displacements, pull_back};
    use crate::lanes::LANES;

    const SPACING: Vec3 = Vec3::new(0.5, 1.0, 2.0);
    const ORIGIN: Vec3 = Vec3::new(2.0, -1.0, 4.0);
    const STEP: Vec3 = Vec3::new(2.0, 1.5, 3.0);

    fn nodes(random: &mut oorandom::Rand32, size: UVec3) -> Vec<Vec3> {
        let mut side = || random.rand_float() - 0.5;
        (0..size.element_product())
            .map(|_| Vec3::new(side(), side(), side()))
            .collect()
    }

    /// Displacement at a place [voxels], by the formula.
    fn at(moved: &[Vec3], size: UVec3, place: Vec3) -> Vec3 {
        let last = (size - 1).as_vec3();
        let node = ((place - ORIGIN) / STEP).clamp(Vec3::ZERO, last);
        let mut sum = Vec3::ZERO;
        for (index, moved) in moved.iter().enumerate() {
            let index = index as u32;
            let here = UVec3::new(
                index % size.x,
                index / size.x % size.y,
                index / (size.x * size.y),
            );
            let near = (1.0 - (node - here.as_vec3()).abs()).max(Vec3::ZERO);
            sum += *moved * near.element_product();
        }
        sum / SPACING
    }

    #[test]
    fn places_at_rest_are_those_of_the_formula_whatever_the_machine() {
        let mut random = oorandom::Rand32::new(3);
        for size in [UVec3::new(4, 5, 3), UVec3::ONE, UVec3::new(1, 3, 1)] {
            let moved = nodes(&mut random, size);
            let given = Displacements {
                origin: ORIGIN.as_dvec3(),
                step: STEP.as_dvec3(),
                size,
                moved: &moved,
            };
            let displaced = Displaced::new(&[given], SPACING).unwrap();
            for _ in 0..40 {
                let places: [Vec3; LANES] = std::array::from_fn(|_| {
                    let share = Vec3::from_array([(); 3].map(|()| random.rand_float()));
                    ORIGIN + (share * 1.4 - 0.2) * STEP * size.as_vec3()
                });
                let lanes = [0, 1, 2].map(|axis| places.map(|place| place[axis]));
                let [plain, wide] = [SimdLevel::Plain, SimdLevel::widest()].map(|level| {
                    let mut found = lanes;
                    pull_back(&displaced, &mut found, level);
                    found
                });
                assert_eq!(plain, wide);
                for (lane, place) in places.into_iter().enumerate() {
                    let node = (place - ORIGIN) / STEP + 0.5;
                    let is_inside =
                        node.cmpgt(Vec3::ZERO).all() && node.cmplt(size.as_vec3()).all();
                    let first = place - at(&moved, size, place);
                    let expected = if is_inside {
                        place - at(&moved, size, first)
                    } else {
                        place
                    };
                    let found = Vec3::from_array(plain.map(|axis| axis[lane]));
                    assert!(found.distance(expected) < 1e-4, "{found} {expected}");
                }
            }
        }
    }

    #[test]
    fn empty_space_ends_earlier_by_the_bricks_that_tissue_can_go() {
        let reach = |moved: Vec3| {
            let given = Displacements {
                origin: DVec3::ZERO,
                step: DVec3::ONE,
                size: UVec3::ONE,
                moved: &[moved],
            };
            Displaced::new(&[given], SPACING).unwrap().boxes[0].reach
        };
        // 0.5 mm a voxel along x: 4.5 mm are nine voxels
        let cases = [(0.0, 0.0), (0.1, 1.0), (4.0, 1.0), (-4.5, 2.0)];
        for (x, bricks) in cases {
            assert_eq!(reach(Vec3::new(x, 0.0, 0.0)), bricks, "{x}");
        }
    }
}
