//! Cells whose light is no longer known.

use std::ops::Range;

use glam::Vec3;
use palpate_volume::voxel_box::VoxelBox;

use crate::light_volume::cells::CellGrid;
use crate::light_volume::{lamp, sky};

/// Steps toward the lamp along an axis that count as none [cells].
const LEVEL: f32 = 1e-6;

/// More than rounding moves a place [cells].
const ROUNDING: f32 = 0.01;

/// Cells whose sky and lamp are no longer known, and those whose opacity has changed, in whose shadow the lamp isn't.
pub(super) struct Stale {
    around: VoxelBox,
    shading: VoxelBox,
    /// Cells of a row.
    columns: i32,
}

impl Stale {
    pub fn everywhere(all: VoxelBox) -> Self {
        Self {
            around: all,
            shading: all,
            columns: all.max.x,
        }
    }

    /// The lamp has moved.
    pub fn of_lamp(all: VoxelBox) -> Self {
        Self {
            around: VoxelBox::EMPTY,
            shading: all,
            columns: all.max.x,
        }
    }

    /// The opacity of some cells has changed, or whether anything is drawn there.
    pub fn by_edit(cells: VoxelBox, grid: &CellGrid) -> Self {
        let reach = sky::reach(grid).ceil().as_ivec3() + 1;
        let reach = reach.max(grid.seen_from_brick());
        Self {
            around: VoxelBox::new(cells.min - reach, cells.max + reach).intersect(&grid.all()),
            shading: cells,
            columns: grid.counts.x,
        }
    }

    /// Cells of a row whose sky is no longer known.
    pub fn sky(&self, (y, z): (i32, i32)) -> Range<usize> {
        let VoxelBox { min, max } = self.around;
        let is_in = (min.y..max.y).contains(&y) && (min.z..max.z).contains(&z);
        if is_in {
            min.x as usize..max.x as usize
        } else {
            0..0
        }
    }

    /// Cells of a row whose part of the lamp is no longer known.
    pub fn lamp(&self, row: (i32, i32), stride: Vec3) -> Range<usize> {
        let around = self.sky(row);
        let shaded = self.shaded(row, stride);
        if around.is_empty() || shaded.is_empty() {
            return if around.is_empty() { shaded } else { around };
        }
        around.start.min(shaded.start)..around.end.max(shaded.end)
    }

    /// Cells of a row from which a line toward the lamp meets cells that shade.
    fn shaded(&self, (y, z): (i32, i32), stride: Vec3) -> Range<usize> {
        let [x_sides, y_sides, z_sides] = self.sides();
        let mut steps = (0.0, lamp::MOST_CELLS as f32);
        for ((low, high), place, step) in [(y_sides, y, stride.y), (z_sides, z, stride.z)] {
            let (low, high) = (low - place as f32, high - place as f32);
            if step.abs() < LEVEL {
                if low > 0.0 || high < 0.0 {
                    return 0..0;
                }
            } else {
                let (a, b) = (low / step, high / step);
                steps = (f32::max(steps.0, a.min(b)), f32::min(steps.1, a.max(b)));
            }
        }
        if steps.0 > steps.1 {
            return 0..0;
        }
        let (a, b) = (steps.0 * stride.x, steps.1 * stride.x);
        self.whole_cells(x_sides.0 - a.max(b), x_sides.1 - a.min(b))
    }

    /// Along each axis, between which places light is looked up in the cells that shade [cells' middles].
    fn sides(&self) -> [(f32, f32); 3] {
        let VoxelBox { min, max } = self.shading;
        let (low, high) = (min.as_vec3() - 1.0 - ROUNDING, max.as_vec3() + ROUNDING);
        [(low.x, high.x), (low.y, high.y), (low.z, high.z)]
    }

    fn whole_cells(&self, low: f32, high: f32) -> Range<usize> {
        let low = (low.floor() as i32).clamp(0, self.columns);
        let high = (high.ceil() as i32).saturating_add(1);
        low as usize..high.clamp(low, self.columns) as usize
    }
}
