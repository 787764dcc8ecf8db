//! Ways through free voxels, for the probe's middle, in the world and in the grid of an object.

use glam::{DVec3, IVec3};

use super::dense::{Dense, Finder};
use super::guarantee::{Guarantee, Violation, hold};
use super::object::Object;

/// How far beyond the ball around the device a way may lead [voxels]: the window of a slide.
pub const WINDOW: f64 = 8.0;
/// Whole worlds.
pub const EVERYWHERE: i32 = 1000;

/// Guarantee 2 in the grid of one object, between two points of it, for a way that keeps within
/// `reach` [mm] of its `middle`.
pub fn path_past(
    object: &Object,
    ends: [DVec3; 2],
    (middle, reach): (DVec3, f64),
    (finder, radius): (&mut Finder, f64),
) -> Result<(), Violation> {
    let ends = ends.map(|point| point.floor().as_ivec3());
    if ends[0] == ends[1] {
        return Ok(());
    }
    let told = || format!("from {} to {}", ends[0], ends[1]);
    let [part, other] = ends.map(|voxel| object.part(voxel));
    hold(part == other, Guarantee::CrossesNoWall, told)?;
    // near its border a way may lead around outside of it, where nobody looked
    let known = [ends[0], ends[1], middle.floor().as_ivec3()];
    if !known.iter().all(|&voxel| object.is_inside(voxel, radius)) {
        return Ok(());
    }
    let has_path = finder.has_path(&object.dense, ends, EVERYWHERE, |cell| {
        let way = (cell.as_dvec3() + 0.5 - middle) * object.spacing;
        way.length() <= reach && is_free(&object.dense, cell, object.spacing, radius)
    });
    hold(has_path, Guarantee::CrossesNoWall, told)
}

/// Whether the middle of the probe may be anywhere in a cell.
pub fn is_free(dense: &Dense, cell: IVec3, spacing: DVec3, radius: f64) -> bool {
    let low = cell.as_dvec3();
    !dense.is_solid(cell) && (radius == 0.0 || !dense.is_near(low, low + 1.0, spacing, radius))
}

/// Cells that a ball may be in, as far as they were asked for.
#[derive(Debug, Default)]
pub struct Blocked {
    /// 0 where not asked yet, 1 free, 2 blocked.
    known: Vec<u8>,
}

impl Blocked {
    /// After a change of voxels.
    pub fn forget(&mut self) {
        self.known.clear();
    }

    /// Before cells of a world are asked for.
    pub fn fit(&mut self, dense: &Dense) {
        self.known.resize(dense.bytes().len(), 0);
    }

    /// Whether the middle of the probe may be anywhere in a cell.
    pub fn is_free(&mut self, dense: &Dense, cell: IVec3, spacing: DVec3, radius: f64) -> bool {
        if radius == 0.0 {
            return !dense.is_solid(cell);
        }
        let Some(known) = dense
            .index(cell)
            .and_then(|index| self.known.get_mut(index))
        else {
            return true;
        };
        if *known == 0 {
            *known = if is_free(dense, cell, spacing, radius) {
                1
            } else {
                2
            };
        }
        *known == 1
    }
}
