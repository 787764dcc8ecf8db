//! Blurred occupancy around the proxy: value and gradient at any point.
//!
//! Solid voxels are counted in cells (`window.rs`); a tent over three cells along each axis
//! makes the nodes of the narrow kernel, the same tent twice more those of the wide one; a
//! quadratic B-spline through the nodes (`spline.rs`) gives a field with a continuous gradient. Tents
//! vanish where the lattice of cells would alias, so that the field hardly knows where cells
//! begin. With cells of m voxels, σ² = (10 m² − 1)/12 and (22 m² − 1)/12 voxels²: for m = 2
//! that is σ 1.80 and 2.69 voxels.
//!
//! Beyond the window the outermost cells go on; that is felt only where the wide kernel is
//! used more than a cell away from the proxy.
//!
//! Frame: grid.

use super::aim::Aim;
use super::binomial_filter::{Cells, ChangesOfRows, unit_of};
use super::cache::Source;
use super::cell_fractions::CellFractions;
use super::cell_shape::{CELLS, CellShape};
use super::field::{Field, FieldSample, Kernel};
use super::spline::{Nodes, Place, Width};
use super::window::{Window, counts};
use glam::{DVec3, IVec3, Vec3A};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::simd_dispatch;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::walk::voxel_of;

/// A blurred window.
#[derive(Clone, Debug)]
pub struct BlurField {
    window: Window,
    any_solid: bool,
    spacing: DVec3,
    shape: CellShape,
    kernel: Kernel,
    nodes: Nodes,
}

impl BlurField {
    /// The field of nothing at all.
    pub(crate) fn empty() -> Self {
        let spacing = DVec3::ONE;
        let shape = CellShape::for_spacing(spacing);
        Self {
            window: Window::NONE,
            any_solid: false,
            spacing,
            shape,
            kernel: kernel_of(shape),
            nodes: Nodes::NONE,
        }
    }

    /// Whether this is the field that [`make_around`] makes for an aim at the same solid.
    pub(super) fn is_around(&self, aim: &Aim, spacing: DVec3) -> bool {
        self.spacing == spacing
            && self
                .window
                .is_at(self.shape, first_cell(aim.point, self.shape))
            && self.window.is_from(aim.seed)
    }

    #[inline(always)]
    fn around_plainly(
        &mut self,
        occupancy: &impl Occupancy,
        aim: &Aim,
        spacing: DVec3,
        known: Option<(Source, &mut CellFractions)>,
    ) {
        if self.spacing != spacing {
            self.spacing = spacing;
            self.shape = CellShape::for_spacing(spacing);
            self.kernel = kernel_of(self.shape);
        }
        let first = first_cell(aim.point, self.shape);
        self.any_solid = self.window.read(occupancy, self.shape, first, aim.seed);
        if !self.any_solid {
            return;
        }
        let unit = unit_of(self.shape.volume());
        let full = unit * self.shape.volume();
        let mut cells = Cells::of_counts(&counts(&self.window), unit);
        if let Some((source, known)) = known {
            known.keep(source, self.shape);
            let mut changes = ChangesOfRows::NONE;
            known.look_at(occupancy, &self.window, |row, of_row| {
                changes.set(row, of_row);
            });
            cells.add(&changes, full);
        }
        let scale = 1.0 / (64.0 * f32::from(full));
        blur(&cells, scale, &mut self.nodes);
    }

    /// The voxels of its window.
    pub(super) fn voxels(&self) -> VoxelBox {
        let min = self.window.first() * self.shape.voxels();
        VoxelBox::new(min, min + CELLS * self.shape.voxels())
    }

    /// Whether there is any surface in it.
    pub(crate) fn any_solid(&self) -> bool {
        self.any_solid
    }
}

simd_dispatch! {
    /// Makes it the field around an aim, whose seed is a free voxel, with what is known of the
    /// occupancy fractions of voxels at the surface, where they are to count. Where that voxel is solid,
    /// nothing can be told apart, and the field is that of nothing.
    pub(super) fn make_around[O: Occupancy](
        field: &mut BlurField,
        occupancy: &O,
        aim: &Aim,
        spacing: DVec3,
        known: Option<(Source, &mut CellFractions)>,
    ) = [avx2] BlurField::around_plainly
}

simd_dispatch! {
    /// Sets nodes to the cells, blurred and times a scale.
    fn blur(cells: &Cells, scale: f32, nodes: &mut Nodes) = [avx2] blur_plainly
}

#[inline(always)]
fn blur_plainly(cells: &Cells, scale: f32, nodes: &mut Nodes) {
    cells.blur(|width, cells| nodes.put(cells, scale, width));
}

/// The first cell of the window whose node 3 or 4 is the next to a point, by its number.
fn first_cell(point: DVec3, shape: CellShape) -> IVec3 {
    // cells are numbered from the middle of a cell to the middle of the next
    let halves = voxel_of(point * 2.0) - shape.voxels();
    shape.cell_of_half(halves) - (CELLS / 2 - 1)
}

/// Widths of both kernels in cells.
fn kernel_of(shape: CellShape) -> Kernel {
    let cell = shape.voxels().as_dvec3();
    let sigma = |share: f64| {
        let variance = (share - (cell * cell).recip()) / 12.0;
        variance.map(f64::sqrt).as_vec3a()
    };
    Kernel {
        fine: sigma(10.0),
        wide: sigma(22.0),
    }
}

impl Field for BlurField {
    #[inline(always)]
    fn sample(&self, point: Vec3A) -> FieldSample {
        if !self.any_solid {
            return FieldSample::default();
        }
        let place = Place::of(point);
        FieldSample {
            fine: self.nodes.level(&place, Width::Fine),
            wide: self.nodes.level(&place, Width::Wide),
        }
    }

    #[inline(always)]
    fn wide_value(&self, point: Vec3A) -> f32 {
        if !self.any_solid {
            return 0.0;
        }
        self.nodes.value(&Place::of(point), Width::Wide)
    }

    fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    fn cell(&self) -> Vec3A {
        self.shape.voxels().as_vec3a()
    }

    fn nodes_at(&self, point: DVec3) -> Vec3A {
        // nodes stand in the middles of cells
        let voxels = self.shape.voxels();
        let first = (self.window.first() * voxels).as_dvec3();
        (point - first).as_vec3a() / voxels.as_vec3a() - 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    #[test]
    fn fields_for_wide_machines_are_those_for_plain_ones_to_the_bit() {
        let mut random = oorandom::Rand64::new(13);
        let spacings = [
            DVec3::ONE,
            DVec3::new(0.7, 0.7, 2.5),
            DVec3::new(1.0, 1.0, 2.0),
            DVec3::new(3.0, 0.8, 0.8),
        ];
        let mut solid = 0;
        for run in 0..200_u32 {
            let world = Noise {
                density: 2 + run % 40,
            };
            let spacing = spacings[run as usize % spacings.len()];
            let point = DVec3::from_array([(); 3].map(|()| 30.0 * random.rand_float()));
            let aim = Aim {
                point,
                seed: voxel_of(point),
                contact: DVec3::ZERO,
            };
            let source = Source {
                epoch: 1,
                fractions: true,
            };
            let [mut wide, mut plain] = [BlurField::empty(), BlurField::empty()];
            let mut fractions = CellFractions::EMPTY;
            make_around(
                &mut wide,
                &world,
                &aim,
                spacing,
                Some((source, &mut fractions)),
            );
            let mut fractions = CellFractions::EMPTY;
            plain.around_plainly(&world, &aim, spacing, Some((source, &mut fractions)));
            for _ in 0..50 {
                let at = Vec3A::from_array([(); 3].map(|()| 7.0 * random.rand_float() as f32));
                assert_eq!(wide.sample(at), plain.sample(at), "run {run} at {at}");
            }
            solid += u32::from(plain.any_solid());
        }
        assert!(solid > 100, "{solid} fields");
    }
}
