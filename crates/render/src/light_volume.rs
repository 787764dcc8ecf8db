//! The light that reaches each place through what is drawn around it, in coarse cells: fractions of the
//! sky and of the lamp. First how much passes each cell, then what comes through all of them.
//!
//! The page's shaders have the same (`shaders/light/cell_opacity.frag`, `cell_light.frag`).
//! Source: Hernell et al., "Local ambient occlusion", IEEE TVCG 16 (2010); for the light from a direction
//! Behrens and Ratering, "Adding shadows to a texture-based volume renderer", IEEE VolVis (1998).

use std::sync::Arc;

use glam::{DVec3, IVec3, Vec3};
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

use crate::prepared::Prepared;
use crate::scene::Scene;
use crate::stop::Stop;

mod cells;
mod clarity;
mod lamp;
mod line;
mod lookup;
mod opacity;
mod sky;
mod stale;

use cells::CellGrid;
use clarity::{Clarity, Scratch};
use sky::Sky;
use stale::Stale;

pub(crate) use lookup::LightLookup;

/// All of the light.
const WHOLE: f32 = 32767.0;

/// Fractions of sky and lamp in cells that cover the scan. Nothing of a volume is changed once it is whole:
/// another lamp or an edit gives another volume, so that pictures can be drawn by the one before.
#[derive(Clone, Debug)]
pub struct LightVolume {
    grid: CellGrid,
    clarity: Arc<Clarity>,
    /// Unit vector along the grid's axes.
    lamp: Vec3,
    /// Sky and lamp of each cell in turn, in units of [`WHOLE`], x fastest; one cell of padding.
    cells: Vec<i16>,
}

impl LightVolume {
    /// Works out the light of a scene; none where `stop` said so meanwhile. `lamp`: toward it, patient frame;
    /// `most`: cells along the scan's longest edge, none of which is smaller than a voxel and a half.
    ///
    /// # Panics
    /// Where the lamp has no direction.
    #[must_use]
    pub fn new(
        scene: &Scene,
        prepared: &Prepared,
        lamp: DVec3,
        most: u32,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let level = SimdLevel::widest();
        Self::at_level(scene, prepared, (lamp, most), stop, level)
    }

    fn at_level(
        scene: &Scene,
        prepared: &Prepared,
        (lamp, most): (DVec3, u32),
        stop: Stop<'_>,
        level: SimdLevel,
    ) -> Option<Self> {
        let grid = CellGrid::new(scene.grid(), most);
        let all = grid.all();
        let mut clarity = Clarity::whole(grid.counts);
        opacity::look_at(&mut clarity, &grid, (scene, prepared), &all, (level, stop))?;
        let mut light = Self {
            clarity: Arc::new(clarity),
            lamp: lamp_in_grid(scene, lamp),
            cells: vec![WHOLE as i16; 2 * (grid.counts.element_product() as usize + 1)],
            grid,
        };
        light.renew(prepared, &Stale::everywhere(all), stop)?;
        Some(light)
    }

    /// The light of the same scene with the lamp in another direction; only its part is worked out.
    ///
    /// # Panics
    /// Where the lamp has no direction.
    #[must_use]
    pub fn turn_lamp(
        &self,
        scene: &Scene,
        prepared: &Prepared,
        lamp: DVec3,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let mut light = self.clone();
        light.lamp = lamp_in_grid(scene, lamp);
        light.renew(prepared, &Stale::of_lamp(self.grid.all()), stop)?;
        Some(light)
    }

    /// The light after an edit that changed voxels of a box: what passes the cells there is looked at again, and
    /// what reaches those around and those in their shadow. `prepared` must be that of the scene after the edit.
    #[must_use]
    pub fn follow(
        &self,
        scene: &Scene,
        prepared: &Prepared,
        changed: &VoxelBox,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let mut light = self.clone();
        if changed.is_empty() {
            return Some(light);
        }
        let cells = self.grid.reached_by(changed);
        let mut clarity = Clarity::clone(&self.clarity);
        let how = (SimdLevel::widest(), stop);
        opacity::look_at(&mut clarity, &self.grid, (scene, prepared), &cells, how)?;
        light.clarity = Arc::new(clarity);
        light.renew(prepared, &Stale::by_edit(cells, &self.grid), stop)?;
        Some(light)
    }

    /// Cells along the scan's axes.
    #[must_use]
    pub fn counts(&self) -> IVec3 {
        self.grid.counts
    }

    /// Fractions of sky and lamp, 0 to 1, in a cell.
    ///
    /// # Panics
    /// Where there is no such cell.
    #[must_use]
    pub fn at_cell(&self, cell: IVec3) -> (f32, f32) {
        let counts = self.grid.counts;
        assert!(
            cell.cmpge(IVec3::ZERO).all() && cell.cmplt(counts).all(),
            "cell {cell} given; allowed: below {counts}"
        );
        let index = 2 * (cell.x + counts.x * (cell.y + counts.y * cell.z)) as usize;
        let share = |stored: i16| f32::from(stored) / WHOLE;
        (share(self.cells[index]), share(self.cells[index + 1]))
    }

    /// Works out the light of stale cells.
    fn renew(&mut self, prepared: &Prepared, stale: &Stale, stop: Stop<'_>) -> Option<()> {
        let Self {
            grid,
            clarity,
            lamp,
            cells,
        } = self;
        let (columns, rows) = (grid.counts.x as usize, grid.counts.y);
        let sky = Sky::new(grid);
        let stride = *lamp * grid.cells_per_edge();
        let count = cells.len() - 2;
        let renewed = cells[..count]
            .par_chunks_mut(2 * columns)
            .enumerate()
            .try_for_each_init(
                || Scratch::new(columns),
                |scratch, (index, cells)| {
                    let row = (index as i32 % rows, index as i32 / rows);
                    let (in_sky, in_lamp) = (stale.sky(row), stale.lamp(row, stride));
                    let mut seen = grid.seen_cells(prepared, row, in_sky.clone());
                    sky::reach_row(&sky, clarity, row, &seen.span, scratch);
                    seen.put(scratch.found(), cells, 0);
                    if in_lamp != in_sky {
                        seen = grid.seen_cells(prepared, row, in_lamp);
                    }
                    lamp::reach_row(stride, clarity, row, &seen.span, scratch);
                    seen.put(scratch.found(), cells, 1);
                    if stop() { Err(()) } else { Ok(()) }
                },
            );
        renewed.ok()
    }
}

/// Toward the lamp along the grid's axes.
fn lamp_in_grid(scene: &Scene, lamp: DVec3) -> Vec3 {
    let unit = lamp
        .try_normalize()
        .expect("a lamp without a direction, which cameras do not have");
    (scene.grid().direction().transpose() * unit).as_vec3()
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3, UVec3, Vec3};
    use palpate_volume::grid::Grid;
    use palpate_volume::intensities::Intensities;
    use palpate_volume::simd_dispatch::SimdLevel;
    use palpate_volume::voxels::Voxels;

    use super::LightVolume;
    use crate::appearance::{Appearance, Blend, ControlPoint, Lighting};
    use crate::prepared::Prepared;
    use crate::scene::Scene;

    fn noise() -> Scene {
        let size = UVec3::new(21, 30, 17);
        let mut random = oorandom::Rand32::new(5);
        let values: Vec<i16> = (0..size.element_product())
            .map(|_| random.rand_range(0..1000) as i16)
            .collect();
        let scan = Intensities::new(size, values, 0.5, -3.0).expect("values fit");
        let spacing = DVec3::new(0.9, 1.1, 1.7);
        let grid = Grid::new(size, spacing, DVec3::ZERO, DMat3::IDENTITY).expect("a grid");
        Scene::new(Voxels::new(grid, scan).expect("they fit")).expect("a small scan")
    }

    #[test]
    fn all_instruction_sets_give_the_same_light() {
        let scene = noise();
        let point = |value, extinction| ControlPoint {
            value,
            colour: Vec3::ONE,
            extinction,
        };
        let appearance = Appearance {
            blend: Blend::Shaded,
            density: 1.0,
            transfer: vec![point(100.0, 0.0), point(480.0, 0.3)],
            edge_gradient: 300.0,
            window: (1.0, 0.0),
            iso_value: 0.0,
            iso_colour: Vec3::ONE,
            tissue_from: 0.0,
            slab: None,
            lighting: Lighting::default(),
            segments: vec![],
            surfaces: vec![],
            clip: vec![],
        };
        let prepared = Prepared::new(&scene, appearance);
        let lamp = (DVec3::new(0.3, -0.5, 0.8), 24);
        let [plain, wide] = [SimdLevel::Plain, SimdLevel::widest()].map(|level| {
            LightVolume::at_level(&scene, &prepared, lamp, &|| false, level).expect("not stopped")
        });
        assert!(plain.cells == wide.cells);
        let (least, most) = (plain.cells.iter().min(), plain.cells.iter().max());
        assert!(least < most, "light differs from place to place");
    }
}
