//! Deformable segments: which, of what, which of their regions, and where that is.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use palpate_deform::material::{MaterialLaw, Materials, Region, SegmentMaterial, Treatment};
use palpate_volume::clip::{Clip, ClipMask};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::segment_set::SegmentSet;

use crate::deformable::rigid_regions::Regions;
use crate::scene::Scene;

/// How regions of segments take part, and the materials of the last job, for the next ones until
/// something is another.
#[derive(Debug, Default)]
pub struct DeformableSegments {
    regions: BTreeMap<SegmentId, Vec<(Region, Treatment)>>,
    laws: Vec<(SegmentId, Option<MaterialLaw>)>,
    /// What is cut away of the scan; none where nothing is.
    cut_away: Option<Arc<ClipMask>>,
    materials: Arc<Materials>,
}

impl DeformableSegments {
    /// How regions of a segment take part; of several that hold a voxel the last counts.
    pub fn set_regions(&mut self, id: SegmentId, regions: Vec<(Region, Treatment)>) {
        self.regions.insert(id, regions);
        self.laws.clear();
    }

    /// What a clip cuts away of a scan with this grid takes no part.
    pub fn set_clip(&mut self, clip: &Clip, grid: &Grid) {
        let mask = || Arc::new(clip.mask(grid, DAffine3::IDENTITY));
        self.cut_away = (!clip.is_empty()).then(mask);
        self.laws.clear();
    }

    /// How regions of a segment take part.
    #[must_use]
    pub fn regions(&self, id: SegmentId) -> &Regions {
        self.regions.get(&id).map_or(&[], Vec::as_slice)
    }

    /// Segments with regions, and these.
    pub fn with_regions(&self) -> impl Iterator<Item = (SegmentId, &Regions)> {
        let regions = self.regions.iter();
        regions.map(|(id, regions)| (*id, regions.as_slice()))
    }

    /// Whether a region is shared with a segment.
    #[must_use]
    pub fn is_shared(&self, id: SegmentId) -> bool {
        let mut regions = self.regions.values().flatten();
        regions.any(|(region, _)| *region == Region::Shared(id))
    }

    /// Forgets the regions of segments that are no more.
    pub fn follow(&mut self, scene: &Scene) {
        self.regions
            .retain(|id, _| scene.voxels().segment(*id).is_some());
    }

    /// What all obstacles are made of: those without a material hold what is bonded to them.
    pub fn materials(&mut self, scene: &Scene) -> Arc<Materials> {
        let now = || matter_in(scene).map(|(id, _, law)| (id, law));
        if !now().eq(self.laws.iter().copied()) {
            self.laws = now().collect();
            self.materials = Arc::new(self.made());
        }
        Arc::clone(&self.materials)
    }

    fn made(&self) -> Materials {
        let cut_away = self.cut_away.iter().cloned().map(Region::CutAway);
        let cut_away = cut_away.map(|region| (region, Treatment::Empty));
        let matter = |&(segment, law): &(SegmentId, Option<MaterialLaw>)| SegmentMaterial {
            segment,
            law: law.unwrap_or_else(hard),
            regions: match law {
                Some(_) => self.regions(segment).to_vec(),
                None => vec![(Region::Whole, Treatment::Rigid)],
            }
            .into_iter()
            .chain(cut_away.clone())
            .collect(),
        };
        // where a voxel belongs to several the last counts: what is hard stays hard
        let (soft, stiff): (Vec<_>, Vec<_>) = self.laws.iter().partition(|(_, law)| law.is_some());
        Materials {
            segments: soft.iter().chain(&stiff).map(matter).collect(),
        }
    }
}

/// Whether anything is deformable.
#[must_use]
pub fn has_soft_segments(scene: &Scene) -> bool {
    matter_in(scene).any(|(_, _, law)| law.is_some())
}

/// Deformable segments within `reach` [mm] of a place.
#[must_use]
pub fn soft_segments(scene: &Scene, place: DVec3, reach: f64) -> SegmentSet {
    let grid = scene.voxels().grid();
    let point = grid.grid_from_patient().transform_point3(place);
    let is_near = |segment: &Segment| {
        segment.bounding_box().is_some_and(|bounds| {
            let nearest = point.clamp(bounds.min.as_dvec3(), bounds.max.as_dvec3());
            ((nearest - point) * grid.spacing()).length() <= reach
        })
    };
    let soft = matter_in(scene).filter(|(_, _, law)| law.is_some());
    let near = soft.filter(|(_, segment, _)| is_near(segment));
    near.map(|(id, _, _)| id).collect()
}

/// What takes part in a deformation, by rising number: obstacles that stand where the scan has
/// them, and what they are made of. What is locked is an obstacle to matter, and hard.
fn matter_in(scene: &Scene) -> impl Iterator<Item = (SegmentId, &Segment, Option<MaterialLaw>)> {
    scene
        .segments()
        .filter(|(id, _, properties)| scene.is_obstacle(*id) || properties.locked)
        .filter(|(_, segment, properties)| {
            properties.pose.is_none() && segment.own_grid().is_none()
        })
        .map(|(id, segment, properties)| {
            (id, segment, properties.law.filter(|_| !properties.locked))
        })
}

/// The law of what is rigid to a model: only that it is stiff counts.
fn hard() -> MaterialLaw {
    let bone = palpate_deform::material::preset("cortical-bone").and_then(|preset| preset.law());
    bone.expect("a preset of the list")
}
