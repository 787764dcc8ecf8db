//! What is thin keeps its volume: its vertices move along their edges until it has it.
//!
//! Marching cubes takes the corners of what is thin: of a rod of one voxel half is left, of a
//! voxel a sixth. Vertices stay on their edges, so the surface keeps its topology and cannot cut
//! itself; only those on edges of thin voxels move, all of a part by the same share of an edge.
//! What an edge is too short for stays lost, and is told.
//!
//! Frame: grid, whose samples stand at the middles of voxels; lengths in voxels.

use glam::{DVec3, IVec3};
use palpate_volume::bodies::Bodies;
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

use crate::cell_volume::{below, faces};
use crate::frame::Frame;
use crate::patch::Patch;
use crate::quick_map::QuickMap;
use crate::settings::{Limits, SurfaceSettings};
use crate::thin_volume::thin_volume;
use crate::thin_voxels::ThinVoxels;
use crate::voxel_source::VoxelSource;

/// How near a vertex comes to the ends of its edge: a row of voxels holds up to twice its volume.
const NEAREST: f64 = 0.005;

/// Halvings of the way that vertices move: to a millionth of an edge.
const HALVINGS: usize = 20;

/// A thin part of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinPart {
    /// Middle of one of its voxels [grid], near its middle.
    pub place: DVec3,
    /// Volume of its voxels [mm³].
    pub voxel_volume: f64,
    /// Its volume by its voxels, or by the values around where they tell [mm³].
    pub expected: f64,
    /// Whether the threshold was taken for halfway between the part and its surroundings.
    pub is_halfway: bool,
    /// What the surface encloses of it [mm³].
    pub kept: f64,
}

/// Moves the vertices of what is thin, until each part has its volume; tells what parts there are.
///
/// The mesh is the whole one of step 1.
pub(crate) fn keep_thin_parts(
    mesh: &mut Patch,
    grid: &Grid,
    voxels: &VoxelSource<'_>,
    limits: Option<Limits>,
    bodies: &Bodies,
) -> Vec<ThinPart> {
    let thin = ThinVoxels::of(voxels.bits, bodies);
    if thin.parts.is_empty() {
        return Vec::new();
    }
    let near = NearThin::of(mesh, grid, voxels, &thin);
    let voxel_volume = grid.spacing().element_product();
    let parts = thin.parts.par_iter().zip(&near.parts);
    let solved: Vec<(f64, ThinPart)> = parts
        .map(|(part, around)| {
            let thick = octants_of_thick(&around.cells, voxels, &thin);
            let expected = thin_volume(voxels, limits, &thin, part);
            let held = near.volume_in(around, voxels);
            let (by, gained) = near.way_to_gain(around, expected.voxels + thick - held);
            let told = ThinPart {
                place: middle_of(part),
                voxel_volume: part.len() as f64 * voxel_volume,
                expected: expected.voxels * voxel_volume,
                is_halfway: expected.is_halfway,
                kept: (held + gained - thick) * voxel_volume,
            };
            (by, told)
        })
        .collect();
    let frame = Frame::new(grid);
    for (around, (by, _)) in near.parts.iter().zip(&solved) {
        for vertex in around.vertices() {
            let crossing = near.at[&vertex];
            if crossing.moves {
                // samples stand at the middles of voxels
                let point = crossing.moved(*by).point() + 0.5;
                mesh.vertices[vertex as usize] = frame.position(point);
            }
        }
    }
    solved.into_iter().map(|(_, told)| told).collect()
}

/// Tells of each thin part how much of it coarse samples of step³ voxels hold.
pub(crate) fn thin_parts_in_samples(
    grid: &Grid,
    voxels: &VoxelSource<'_>,
    settings: &SurfaceSettings,
    bodies: &Bodies,
) -> Vec<ThinPart> {
    let (bits, step) = (voxels.bits, i32::from(settings.step));
    let limits = settings.limits.filter(|_| voxels.values.is_some());
    let is_held = |voxel: &IVec3| {
        let low = voxel.div_euclid(IVec3::splat(step)) * step;
        let block = VoxelBox::new(low, low + step).voxels();
        2 * block.filter(|&voxel| bits.is_solid(voxel)).count() >= step.pow(3) as usize
    };
    let voxel_volume = grid.spacing().element_product();
    let thin = ThinVoxels::of(bits, bodies);
    let parts = thin.parts.iter().map(|part| {
        let held = part.iter().filter(|voxel| is_held(voxel)).count() as f64;
        let volume = thin_volume(voxels, limits, &thin, part);
        let expected = volume.voxels * voxel_volume;
        ThinPart {
            place: middle_of(part),
            voxel_volume: part.len() as f64 * voxel_volume,
            expected,
            is_halfway: volume.is_halfway,
            kept: held / part.len() as f64 * expected,
        }
    });
    parts.collect()
}

/// What of a mesh is near thin parts.
struct NearThin {
    /// Crossings by vertex.
    at: QuickMap<u32, Crossing>,
    /// Shares by edge.
    shares: QuickMap<(IVec3, usize), f64>,
    parts: Vec<Around>,
}

/// Cells with a thin voxel of a part at a corner, and the triangles there.
#[derive(Default)]
struct Around {
    cells: Vec<IVec3>,
    triangles: Vec<(IVec3, [u32; 3])>,
}

impl Around {
    /// Each vertex once.
    fn vertices(&self) -> Vec<u32> {
        let corners = self.triangles.iter().flat_map(|&(_, corners)| corners);
        let mut vertices: Vec<u32> = corners.collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }
}

impl NearThin {
    fn of(mesh: &Patch, grid: &Grid, voxels: &VoxelSource<'_>, thin: &ThinVoxels) -> Self {
        let mut part_of_cell = QuickMap::default();
        let mut parts: Vec<Around> = thin.parts.iter().map(|_| Around::default()).collect();
        for (number, part) in thin.parts.iter().enumerate() {
            for cell in part.iter().flat_map(|&voxel| cells_around(voxel)) {
                if part_of_cell.insert(cell, number).is_none() {
                    parts[number].cells.push(cell);
                }
            }
        }
        let patient_from_grid = grid.patient_from_grid().matrix3;
        let grid_from_patient = patient_from_grid.inverse();
        let mut at = QuickMap::default();
        for (vertex, &position) in (0..).zip(&mesh.vertices) {
            let in_patient = DVec3::from_array(position.map(f64::from));
            let point = grid_from_patient * in_patient - 0.5;
            let crossing = Crossing::at(point, voxels, thin);
            let mut cells = crossing.cells();
            if cells.any(|cell| part_of_cell.contains_key(&cell)) {
                at.insert(vertex, crossing);
            }
        }
        let is_mirrored = patient_from_grid.determinant() < 0.0;
        for &[a, b, c] in &mesh.triangles {
            let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
            let crossings = corners.map(|vertex| at.get(&vertex));
            if let [Some(a), Some(b), Some(c)] = crossings {
                let cell = cell_of([a, b, c]);
                if let Some(&part) = part_of_cell.get(&cell) {
                    parts[part].triangles.push((cell, corners));
                }
            }
        }
        let crossings = at.values();
        let shares = crossings.map(|one: &Crossing| ((one.sample, one.axis), one.share));
        Self {
            shares: shares.collect(),
            at,
            parts,
        }
    }

    /// What the surface encloses of the cells of a part [voxels].
    fn volume_in(&self, around: &Around, voxels: &VoxelSource<'_>) -> f64 {
        let is_solid = |sample| voxels.bits.is_solid(sample);
        let share = |sample, axis| self.shares[&(sample, axis)];
        let of_faces: f64 = around
            .cells
            .iter()
            .map(|&cell| faces(cell, is_solid, share))
            .sum();
        let of_triangles = around.triangles.iter().map(|&(cell, corners)| {
            below(
                corners.map(|vertex| self.at[&vertex].point()),
                cell.as_dvec3(),
            )
        });
        of_faces + of_triangles.sum::<f64>()
    }

    /// By which share of their edges the vertices of a part move, so that it gains a volume or as
    /// much of it as it can; and what it gains then [voxels].
    fn way_to_gain(&self, around: &Around, wanted: f64) -> (f64, f64) {
        let origin = around.cells[0].as_dvec3();
        let corners: Vec<[Crossing; 3]> = around
            .triangles
            .iter()
            .map(|(_, corners)| corners.map(|vertex| self.at[&vertex]))
            .collect();
        let gain = |by: f64| -> f64 {
            let triangles = corners.iter().map(|corners| {
                let [before, after] =
                    [0.0, by].map(|by| corners.map(|corner| corner.moved(by).point()));
                below(after, origin) - below(before, origin)
            });
            triangles.sum()
        };
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if gain(middle) < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        let by = f64::midpoint(low, high);
        (by, gain(by))
    }
}

/// Where a surface crosses the edge from a sample to the next along an axis.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    sample: IVec3,
    axis: usize,
    share: f64,
    /// Whether the solid end is the first.
    rises: bool,
    /// Whether the solid end is thin.
    moves: bool,
}

impl Crossing {
    /// Of a vertex, counted from the middle of the first voxel.
    fn at(point: DVec3, voxels: &VoxelSource<'_>, thin: &ThinVoxels) -> Self {
        let off = (point - point.round()).abs();
        let axis = off.max_position();
        let mut sample = point.round();
        sample[axis] = point[axis].floor();
        let (sample, share) = (sample.as_ivec3(), point[axis] - sample[axis]);
        let rises = voxels.bits.is_solid(sample);
        let solid = if rises {
            sample
        } else {
            sample + IVec3::AXES[axis]
        };
        Self {
            sample,
            axis,
            share,
            rises,
            moves: thin.part_of(solid).is_some(),
        }
    }

    /// The four cells that its edge belongs to.
    fn cells(&self) -> impl Iterator<Item = IVec3> {
        let reach = IVec3::ONE - IVec3::AXES[self.axis];
        VoxelBox::new(self.sample - reach, self.sample + 1).voxels()
    }

    /// Counted from the middle of the first voxel.
    fn point(&self) -> DVec3 {
        let mut point = self.sample.as_dvec3();
        point[self.axis] += self.share;
        point
    }

    /// With the vertex moved by a share of the edge, away from the solid end.
    fn moved(mut self, by: f64) -> Self {
        if self.moves {
            let way = if self.rises { by } else { -by };
            self.share = (self.share + way).clamp(NEAREST, 1.0 - NEAREST);
        }
        self
    }
}

/// The cells between samples that have a sample at a corner, each by its first sample.
fn cells_around(sample: IVec3) -> impl Iterator<Item = IVec3> {
    VoxelBox::new(sample - 1, sample + 1).voxels()
}

/// The cell of a triangle, whose corners lie on edges of it.
fn cell_of(corners: [&Crossing; 3]) -> IVec3 {
    let lowest = corners.map(|corner| corner.sample - IVec3::ONE + IVec3::AXES[corner.axis]);
    lowest[0].max(lowest[1]).max(lowest[2])
}

/// Octants of solid voxels that are not thin, in cells [voxels].
fn octants_of_thick(cells: &[IVec3], voxels: &VoxelSource<'_>, thin: &ThinVoxels) -> f64 {
    let corners = cells
        .iter()
        .flat_map(|&cell| VoxelBox::new(cell, cell + 2).voxels());
    let is_thick = |voxel: &IVec3| voxels.bits.is_solid(*voxel) && thin.part_of(*voxel).is_none();
    corners.filter(is_thick).count() as f64 / 8.0
}

/// Middle of the voxel of a part nearest to the middle of all [grid].
fn middle_of(part: &[IVec3]) -> DVec3 {
    let mean = part.iter().map(|voxel| voxel.as_dvec3()).sum::<DVec3>() / part.len() as f64;
    let nearest = part.iter().copied().min_by(|a, b| {
        let [a, b] = [a, b].map(|voxel| voxel.as_dvec3().distance_squared(mean));
        a.total_cmp(&b)
    });
    nearest.expect("a part has voxels").as_dvec3() + 0.5
}
