//! How far the voxels around coarse particles have moved: the mean of the particles near, worked
//! out on nodes that stand closer than the particles do, and trilinear between them.
//!
//! Frame: places in mm along the axes of the grid, from its corner; displacements likewise.
//! Source: thesis 5.26.

use std::collections::BTreeSet;

use glam::{DVec3, IVec3, UVec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;

use super::body::ParticleBody;
use super::global_model::GlobalSettings;
use super::pair_laws::FadedLaw;
use crate::displacement::Displacement;

/// Displacement that is seen [smallest voxel side].
pub(super) const VISIBLE: f64 = 0.03;
/// Voxels that follow along each axis, at most, around the first tool, or around the particle that
/// has moved farthest: all of a large segment would not fit into memory.
const FOLLOWING: i32 = 96;
/// Between nodes [a].
const NODES_APART: f64 = 0.25;
/// Nodes along each edge of what the picture is told, at most: it asks more of a node than this
/// field does.
const REPORTED: u32 = 28;

/// A particle: where it rests, and how far it has moved.
type Moved = (DVec3, DVec3);

/// Displacements on nodes in the middles of voxels, x fastest.
#[derive(Debug)]
pub(super) struct GlobalField {
    grid: Grid,
    /// Voxels that it covers; what is outside does not move.
    region: VoxelBox,
    /// Voxels from node to node.
    stride: IVec3,
    /// Nodes along each axis.
    size: IVec3,
    moved: Vec<DVec3>,
}

impl GlobalField {
    /// Of the voxels around moved particles, near a tool or else near the particle that has moved
    /// farthest, and the voxel in the middle of these; no field where none has moved.
    pub fn of(
        body: &ParticleBody<FadedLaw>,
        settings: &GlobalSettings,
        tool: Option<DVec3>,
    ) -> (Option<Self>, IVec3) {
        let (grid, apart) = (&body.grid, body.scale.equilibrium);
        let (spacing, side) = (grid.spacing(), grid.smallest_spacing());
        let home = |(place, moved): (DVec3, DVec3)| (place - moved, moved);
        let particles: Vec<Moved> = body.places().map(home).collect();
        let by_way = |a: &&Moved, b: &&Moved| a.1.length_squared().total_cmp(&b.1.length_squared());
        let farthest = particles.iter().max_by(by_way).map(|(home, _)| *home);
        let Some(middle) = tool.or(farthest) else {
            return (None, IVec3::ZERO);
        };
        let reach = settings.owned_radius * apart;
        // near the middle the picture shows also what moves by less than voxels follow
        let reported = (reach + 0.5 * f64::from(REPORTED) * side).powi(2);
        let counts = |(home, moved): &&Moved| {
            let least = match home.distance_squared(middle) < reported {
                true => VISIBLE.min(settings.threshold),
                false => settings.threshold,
            };
            moved.length_squared() > (least * side).powi(2)
        };
        let around = |home: &DVec3| {
            let low = ((home - reach) / spacing).floor().as_ivec3();
            VoxelBox::new(low, ((home + reach) / spacing).ceil().as_ivec3() + 1)
        };
        let boxes = particles
            .iter()
            .filter(counts)
            .map(|(home, _)| around(home));
        let region = boxes.fold(VoxelBox::EMPTY, |all, one| all.union(&one));
        let voxel = (middle / spacing).floor().as_ivec3();
        let near = VoxelBox::of_voxel(voxel).dilate(FOLLOWING / 2);
        let region = region.intersect(&near).intersect(&grid.bounds());
        let field = || Self::new(grid, region, &particles, [reach, NODES_APART * apart]);
        ((!region.is_empty()).then(field), voxel)
    }

    /// The mean of the particles within `reach` by (1 − r²/reach²)², nodes at most `apart` from one
    /// another, or a voxel [mm].
    fn new(grid: &Grid, region: VoxelBox, particles: &[Moved], [reach, apart]: [f64; 2]) -> Self {
        let spacing = grid.spacing();
        let stride = (apart / spacing).floor().as_ivec3().max(IVec3::ONE);
        let size = (region.size().as_ivec3() - 2 + stride) / stride + 1;
        let step = stride.as_dvec3() * spacing;
        let first = (region.min.as_dvec3() + 0.5) * spacing;
        let mut sums = vec![(DVec3::ZERO, 0.0); size.element_product() as usize];
        for (home, moved) in particles {
            let low = ((home - reach - first) / step).ceil().as_ivec3();
            let high = ((home + reach - first) / step).floor().as_ivec3();
            let near = VoxelBox::new(low.max(IVec3::ZERO), high.min(size - 1) + 1);
            for node in near.voxels() {
                let apart = first + node.as_dvec3() * step - home;
                let share = 1.0 - apart.length_squared() / reach.powi(2);
                if share > 0.0 {
                    let sum = &mut sums[index_of(size, node)];
                    sum.0 += share * share * moved;
                    sum.1 += share * share;
                }
            }
        }
        let mean = |(sum, weight): (DVec3, f64)| match weight > 0.0 {
            true => sum / weight,
            false => DVec3::ZERO,
        };
        Self {
            grid: *grid,
            region,
            stride,
            size,
            moved: sums.into_iter().map(mean).collect(),
        }
    }

    /// Displacement of the centre of a voxel.
    pub fn at_voxel(&self, voxel: IVec3) -> DVec3 {
        match self.region.contains(voxel) {
            true => self.at((voxel - self.region.min).as_dvec3()),
            false => DVec3::ZERO,
        }
    }

    /// How far a place has moved [voxels from the middle of the first one], which is in the region.
    fn at(&self, place: DVec3) -> DVec3 {
        let at = place / self.stride.as_dvec3();
        let low = at.floor().as_ivec3().clamp(IVec3::ZERO, self.size - 1);
        let high = (low + 1).min(self.size - 1);
        let [x, y, z] = (at - low.as_dvec3()).to_array();
        let along_x = |j: i32, k: i32| {
            let node = |i: i32| self.moved[index_of(self.size, IVec3::new(i, j, k))];
            node(low.x).lerp(node(high.x), x)
        };
        let along_y = |k: i32| along_x(low.y, k).lerp(along_x(high.y, k), y);
        along_y(low.z).lerp(along_y(high.z), z)
    }

    /// Numbers of the tiles, cubes of so many voxels, in which anything has moved by more than
    /// `least` [mm].
    pub fn moving_tiles(&self, edge: i32, least: f64) -> BTreeSet<[i32; 3]> {
        let tile_of = |voxel: IVec3| voxel.div_euclid(IVec3::splat(edge));
        let nodes = VoxelBox::of_dimensions(self.size.as_uvec3()).voxels();
        let moving = nodes
            .zip(&self.moved)
            .filter(|(_, moved)| moved.length_squared() > least.powi(2));
        let mut tiles = BTreeSet::new();
        let mut last = VoxelBox::EMPTY;
        for (node, _) in moving {
            // between this node and those beside it
            let voxel = self.region.min + node * self.stride;
            let first = tile_of(voxel - self.stride + 1);
            let around = VoxelBox::new(first, tile_of(voxel + self.stride - 1) + 1);
            if around != last {
                tiles.extend(around.voxels().map(|tile| tile.to_array()));
                last = around;
            }
        }
        tiles
    }

    /// The field around a voxel on cubic nodes, the smallest voxel side apart.
    pub fn on_nodes(&self, middle: IVec3) -> Displacement {
        let (spacing, side) = (self.grid.spacing(), self.grid.smallest_spacing());
        let middle = middle.clamp(self.region.min, self.region.max - 1);
        let half = (0.5 * f64::from(REPORTED) * side / spacing)
            .ceil()
            .as_ivec3();
        let reported = VoxelBox::new(middle - half, middle + half).intersect(&self.region);
        let first = (reported.min.as_dvec3() + 0.5) * spacing;
        let last = (reported.max.as_dvec3() - 0.5) * spacing;
        let size = ((last - first) / side).round().as_uvec3() + UVec3::ONE;
        let size = size.min(UVec3::splat(REPORTED));
        let begin = (reported.min - self.region.min).as_dvec3();
        let end = (self.region.size().as_ivec3() - 1).as_dvec3();
        let at = |node: IVec3| Some(self.at((begin + node.as_dvec3() * side / spacing).min(end)));
        let nodes = VoxelBox::of_dimensions(size).voxels().map(at).collect();
        Displacement::new(first, side, size, nodes)
    }
}

fn index_of(size: IVec3, node: IVec3) -> usize {
    (node.x + size.x * (node.y + size.y * node.z)) as usize
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;
    use crate::particles::lattices::fcc;

    /// Particles 8 mm apart that are pressed down in the middle, less and less around.
    fn pressed() -> Vec<Moved> {
        let homes = fcc(IVec3::splat(6), 8.0);
        let pressed = |home: DVec3| {
            let apart = home.distance(DVec3::splat(34.0)) / 16.0;
            (home, DVec3::NEG_Z * 6.0 / (1.0 + apart * apart))
        };
        homes.into_iter().map(pressed).collect()
    }

    fn field(apart: f64) -> GlobalField {
        let spacing = DVec3::new(1.0, 1.0, 2.0);
        let size = UVec3::new(68, 68, 34);
        let grid = Grid::new(size, spacing, DVec3::ZERO, DMat3::IDENTITY).expect("a grid");
        let region = VoxelBox::new(IVec3::new(9, 10, 5), IVec3::new(60, 59, 30));
        GlobalField::new(&grid, region, &pressed(), [1.2 * 8.0, apart])
    }

    #[test]
    fn between_nodes_it_is_what_it_is_at_every_voxel() {
        let (coarse, fine) = (field(NODES_APART * 8.0), field(0.5));
        assert_eq!(coarse.stride, IVec3::new(2, 2, 1));
        assert_eq!(fine.stride, IVec3::ONE);
        assert_eq!(fine.moved.len() as u64, fine.region.voxel_count());
        assert!(3 * coarse.moved.len() < fine.moved.len());
        let apart = |voxel| (coarse.at_voxel(voxel) - fine.at_voxel(voxel)).length();
        let farthest = fine.region.voxels().map(apart).fold(0.0, f64::max);
        assert!(farthest < 0.1, "{farthest} mm of 6");
        assert_eq!(fine.at_voxel(fine.region.max), DVec3::ZERO);
    }

    #[test]
    fn tiles_move_where_a_voxel_of_them_does() {
        for field in [field(2.0), field(0.5)] {
            let (edge, least) = (16, 3.0);
            let tiles = field.moving_tiles(edge, least);
            let moves = |voxel: &IVec3| field.at_voxel(*voxel).length() > least;
            let moving = field.region.voxels().filter(moves);
            let of: BTreeSet<_> = moving
                .map(|voxel| voxel.div_euclid(IVec3::splat(edge)).to_array())
                .collect();
            assert!(tiles.is_superset(&of) && !of.is_empty());
            assert!(tiles.len() <= 2 * of.len(), "{tiles:?} for {of:?}");
        }
    }

    #[test]
    fn what_is_reported_lies_around_the_tool_and_is_bounded() {
        let field = field(2.0);
        for middle in [IVec3::new(34, 34, 17), IVec3::new(-500, 20, 90)] {
            let nodes = field.on_nodes(middle);
            assert!(
                nodes.size.max_element() <= REPORTED && nodes.size.min_element() > REPORTED / 4
            );
            let place = nodes.first + 3.0;
            let voxel = (place / field.grid.spacing()).floor().as_ivec3();
            assert!((nodes.at(place) - field.at_voxel(voxel)).length() < 0.6);
        }
    }
}
