//! What segments are made of, which of their parts give way, and where that is.

use std::collections::BTreeMap;

use glam::DVec3;
use palpate_deform::material::{MaterialLaw, Materials, Part, SegmentMatter, Treatment};
use palpate_volume::edit::SegmentId;

use crate::scene::Scene;

/// What is told of segments. Those that were moved do not give way.
#[derive(Clone, Debug, Default)]
pub struct GivingMatter {
    laws: BTreeMap<SegmentId, MaterialLaw>,
    parts: BTreeMap<SegmentId, Vec<(Part, Treatment)>>,
}

impl GivingMatter {
    /// What a segment is made of; none where it is hard.
    pub fn set_law(&mut self, id: SegmentId, law: Option<MaterialLaw>) {
        match law {
            Some(law) => self.laws.insert(id, law),
            None => self.laws.remove(&id),
        };
    }

    /// What a segment is made of; none where it is hard.
    #[must_use]
    pub fn law(&self, id: SegmentId) -> Option<MaterialLaw> {
        self.laws.get(&id).copied()
    }

    /// How parts of a segment take part; of several that hold a voxel the last counts.
    pub fn set_parts(&mut self, id: SegmentId, parts: Vec<(Part, Treatment)>) {
        self.parts.insert(id, parts);
    }

    /// How parts of a segment take part.
    #[must_use]
    pub fn parts(&self, id: SegmentId) -> &[(Part, Treatment)] {
        self.parts.get(&id).map_or(&[], Vec::as_slice)
    }

    /// Segments that give way within `reach` [mm] of a place, one bit for each number.
    #[must_use]
    pub fn near(&self, scene: &Scene, place: DVec3, reach: f64) -> [u64; 4] {
        let grid = scene.voxels().grid();
        let mut bits = [0; 4];
        for id in self.laws.keys() {
            let is_there = scene.is_obstacle(*id) && scene.properties_of(*id).pose.is_none();
            let bounds = scene.voxels().segment(*id).and_then(|s| s.bounding_box());
            let near = bounds.is_some_and(|bounds| {
                let point = grid.grid_from_patient().transform_point3(place);
                let nearest = point.clamp(bounds.min.as_dvec3(), bounds.max.as_dvec3());
                ((nearest - point) * grid.spacing()).length() <= reach
            });
            if is_there && near {
                bits[usize::from(id.0 / 64)] |= 1 << (id.0 % 64);
            }
        }
        bits
    }

    /// What all obstacles are made of: those without a material hold what is bonded to them.
    #[must_use]
    pub fn materials(&self, scene: &Scene) -> Materials {
        let unmoved = scene
            .obstacles()
            .filter(|(_, _, properties)| properties.pose.is_none());
        let matter = |segment| match self.law(segment) {
            Some(law) => SegmentMatter {
                segment,
                law,
                treatments: self.parts(segment).to_vec(),
            },
            None => SegmentMatter {
                segment,
                law: hard(),
                treatments: vec![(Part::Whole, Treatment::Rigid)],
            },
        };
        let mut segments: Vec<_> = unmoved.map(|(segment, _, _)| matter(segment)).collect();
        // where a voxel belongs to several the last counts: what is hard stays hard
        segments.sort_by_key(|matter| (self.law(matter.segment).is_none(), matter.segment));
        Materials { segments }
    }
}

/// Of matter that does not give way, of which only that it is stiff counts.
fn hard() -> MaterialLaw {
    let bone = palpate_deform::material::preset("cortical-bone").and_then(|preset| preset.law());
    bone.expect("a preset of the list")
}
