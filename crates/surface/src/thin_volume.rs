//! How much of space a thin part takes: its voxels or, by the values around it, shares of them.
//!
//! What is thinner than about two voxels is mixed with its surroundings in every voxel (partial
//! volume), so whole voxels say little. The values of what is free around tell the one end of the
//! mixture. The other is the highest of the part, or what lies as far beyond the limit as the
//! surroundings fall short of it where that is higher: a limit is usually set halfway (full width
//! at half maximum), and no voxel of a thin part need be full. Only where the values change from
//! one voxel to the next, without any between, the highest are taken as they are. Surroundings of
//! several kinds tell nothing: then voxels count as they are.

use glam::IVec3;
use palpate_volume::bits::Bits;
use palpate_volume::voxel_box::VoxelBox;

use crate::settings::Limits;
use crate::thin_voxels::ThinVoxels;
use crate::voxel_source::VoxelSource;

/// Voxels of a part whose surroundings are looked at: enough for a median.
const LOOKED_AT: usize = 2000;

/// A part whose highest values pass the limit by less than this share of what the surroundings
/// fall short of it has no full voxels.
const BARELY: f32 = 0.25;

/// Values between both ends are there where free voxels hold more than this share of a part.
const SPILT: f64 = 0.03;

/// Surroundings are of one kind where most of them differ by less than this share of what lies
/// between them and the part. Of several, none tells what a free voxel is mixed with.
const ALIKE: f32 = 0.25;

/// Where between the depths of the part and of its surroundings the noise of a free voxel counts.
const NOISE: f32 = 0.1;

/// Volume of a thin part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ThinVolume {
    /// [voxels]
    pub(crate) voxels: f64,
    /// Whether the limit was taken for halfway.
    pub(crate) is_halfway: bool,
}

/// Finds the volume of a thin part.
pub(crate) fn thin_volume(
    voxels: &VoxelSource<'_>,
    limits: Option<Limits>,
    thin: &ThinVoxels,
    part: &[IVec3],
) -> ThinVolume {
    let told = |voxels: f64, is_halfway: bool| ThinVolume { voxels, is_halfway };
    let ends = limits.and_then(|limits| Some((limits, Ends::of(voxels, limits, part)?)));
    let Some((limits, ends)) = ends else {
        return told(part.len() as f64, false);
    };
    let solid = part.iter().map(|&voxel| (depth(voxels, limits, voxel), 1));
    let free = beside(voxels.bits, part).into_iter().filter_map(|voxel| {
        let parts = parts_near(voxels.bits, thin, voxel);
        (parts > 0).then(|| (depth(voxels, limits, voxel), parts))
    });
    let (solid, free): (Vec<_>, Vec<_>) = (solid.collect(), free.collect());
    let sum = |ends: &Ends| {
        [
            shared(&solid, |depth| ends.share_of_solid(depth)),
            shared(&free, |depth| ends.share_of_free(depth)),
        ]
    };
    let [within, spilt] = sum(&ends);
    // a limit that is the highest value itself chooses values, as of a label
    let is_barely = ends.full > 0.0 && ends.full < BARELY * -ends.free;
    if ends.full < -ends.free && (is_barely || spilt > SPILT * within) {
        let halfway = Ends {
            full: -ends.free,
            ..ends
        };
        return told(sum(&halfway).iter().sum(), true);
    }
    told(within + spilt, false)
}

/// Sum of the shares of voxels by their depths, each parted among so many parts.
fn shared(depths: &[(f32, usize)], share: impl Fn(f32) -> f32) -> f64 {
    let shares = depths.iter();
    shares
        .map(|&(depth, parts)| f64::from(share(depth)) / parts as f64)
        .sum()
}

/// Depths at both ends of a mixture.
struct Ends {
    full: f32,
    free: f32,
}

impl Ends {
    /// None where nothing around is free, or it is of several kinds.
    fn of(voxels: &VoxelSource<'_>, limits: Limits, part: &[IVec3]) -> Option<Self> {
        let grid = VoxelBox::of_dimensions(voxels.bits.dimensions());
        let every = part.len().div_ceil(LOOKED_AT);
        let mut free = Vec::new();
        for &voxel in part.iter().step_by(every) {
            let around = VoxelBox::of_voxel(voxel).dilate(2).intersect(&grid);
            let apart = around.voxels().filter(|&other| {
                let near = VoxelBox::of_voxel(other).dilate(1).intersect(&grid);
                (other - voxel).abs().max_element() == 2
                    && voxels.bits.is_free(near.min, near.max - 1)
            });
            free.extend(apart.map(|other| depth(voxels, limits, other)));
        }
        let [low, free, high] = quantiles(free, [0.1, 0.5, 0.9]).filter(|found| found[1] < 0.0)?;
        let solid = part.iter().map(|&voxel| depth(voxels, limits, voxel));
        let [full] = quantiles(solid.filter(|depth| *depth >= 0.0).collect(), [0.9])?;
        (high - low < ALIKE * (full - free)).then_some(Self { full, free })
    }

    /// Share of a solid voxel; one that an edit made solid is full.
    fn share_of_solid(&self, depth: f32) -> f32 {
        if depth < 0.0 {
            return 1.0;
        }
        self.share(depth).clamp(0.0, 1.0)
    }

    /// Share of a free voxel; one that an edit made free is empty. Noise below nothing counts, so
    /// that noise above it does not add up.
    fn share_of_free(&self, depth: f32) -> f32 {
        if depth >= 0.0 {
            return 0.0;
        }
        self.share(depth).clamp(-NOISE, 1.0)
    }

    fn share(&self, depth: f32) -> f32 {
        (depth - self.free) / (self.full - self.free)
    }
}

fn depth(voxels: &VoxelSource<'_>, limits: Limits, voxel: IVec3) -> f32 {
    let mut depth = [0.0];
    voxels.depths(limits, 1, voxel, &mut depth);
    depth[0]
}

/// Free voxels of the grid beside those of a part, each once.
fn beside(bits: &Bits, part: &[IVec3]) -> Vec<IVec3> {
    let grid = VoxelBox::of_dimensions(bits.dimensions());
    let mut free: Vec<_> = part
        .iter()
        .flat_map(|&voxel| {
            let near = VoxelBox::of_voxel(voxel).dilate(1).intersect(&grid);
            near.voxels().filter(|&other| !bits.is_solid(other))
        })
        .collect();
    free.sort_unstable_by_key(|voxel| voxel.to_array());
    free.dedup();
    free
}

/// How many thin parts a free voxel is beside; 0 where it is beside something thick.
fn parts_near(bits: &Bits, thin: &ThinVoxels, voxel: IVec3) -> usize {
    let mut parts = Vec::new();
    let around = VoxelBox::of_voxel(voxel).dilate(1).voxels();
    for near in around.filter(|&near| bits.is_solid(near)) {
        match thin.part_of(near) {
            Some(part) => parts.push(part),
            None => return 0,
        }
    }
    parts.sort_unstable();
    parts.dedup();
    parts.len()
}

/// The values below which such shares of values lie; none where there are none.
fn quantiles<const N: usize>(mut values: Vec<f32>, shares: [f64; N]) -> Option<[f32; N]> {
    values.sort_unstable_by(f32::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some(shares.map(|share| values[(last as f64 * share).round() as usize]))
}
