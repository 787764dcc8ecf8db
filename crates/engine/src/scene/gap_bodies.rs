//! Segments made ready for the gap, whose surfaces are kept and follow edits by their boxes.
//!
//! Where a segment is drawn as a surface that is made in the same way, that one is taken: its
//! patches are shared. Others are kept here, as long as their segments are measured.

use std::collections::BTreeMap;
use std::sync::Arc;

use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

use crate::scene::gap::GapBody;
use crate::scene::incremental_surface::{IncrementalSurface, SegmentVoxels, SurfaceOptions};

/// A segment to be measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Its number.
    pub id: SegmentId,
    /// It.
    pub segment: Segment,
    /// Its voxels with the threshold that made them.
    pub voxels: SegmentVoxels,
    /// The surface of it that is drawn, if it is made as [`making`] says.
    pub drawn: Option<IncrementalSurface>,
}

/// How the surfaces are made: as those that are drawn where nobody chooses otherwise.
#[must_use]
pub fn gap_surface_options() -> SurfaceOptions {
    SurfaceOptions::default()
}

/// The segments that were measured last.
#[derive(Debug, Default)]
pub struct GapBodies(BTreeMap<SegmentId, (IncrementalSurface, Arc<GapBody>)>);

impl GapBodies {
    /// Makes segments of a scan ready; all others are forgotten.
    pub fn ready<const COUNT: usize>(
        &mut self,
        measured: [Measured; COUNT],
        grid: &Grid,
        scan: &Intensities,
    ) -> [Arc<GapBody>; COUNT] {
        self.0
            .retain(|id, _| measured.iter().any(|one| one.id == *id));
        measured.map(|one| self.body(one, grid, scan))
    }

    /// The surface that is kept of a segment.
    #[must_use]
    pub fn surface(&self, id: SegmentId) -> Option<&IncrementalSurface> {
        self.0.get(&id).map(|(surface, _)| surface)
    }

    fn body(&mut self, measured: Measured, grid: &Grid, scan: &Intensities) -> Arc<GapBody> {
        let kept = self.0.remove(&measured.id);
        if let Some((surface, body)) = &kept
            && surface.has(&measured.voxels)
        {
            let body = Arc::clone(body);
            self.0.extend(kept.map(|kept| (measured.id, kept)));
            return body;
        }
        let known = measured.drawn.or(kept.map(|(surface, _)| surface));
        let known = known.filter(|surface| *surface.grid() == measured.voxels.grid);
        let mut surface = match known {
            Some(surface) => surface,
            None => IncrementalSurface::new(gap_surface_options(), measured.voxels.clone())
                .expect("the usual settings make a surface"),
        };
        surface.replace(measured.voxels);
        surface.follow(scan);
        let body = Arc::new(GapBody::new(
            &measured.segment,
            surface.surface(),
            measured.segment.grid(grid),
        ));
        self.0.insert(measured.id, (surface, Arc::clone(&body)));
        body
    }
}
