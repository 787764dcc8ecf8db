//! The tools by name, how each works, and the tool made of that.
//!
//! A new tool is one more [`ToolKind`]. Lengths mm.

use palpate_volume::clip::ClipMask;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::tissue::{MAX_TISSUES, Tissue};

use crate::adder::Adder;
use crate::drill::{Drill, DrillSettings, MAX_BURR_IN_VOXELS};
use crate::eraser::Eraser;
use crate::needle::Needle;
use crate::painter::{PaintSettings, Painter};
use crate::tool::{MAX_RADIUS, MAX_RADIUS_IN_VOXELS, Tool, ToolError};

/// The tools, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolKind {
    /// Frees voxels of segments.
    Eraser,
    /// Makes voxels of segments solid.
    Adder,
    /// Removes tissue by work.
    Drill,
    /// Goes into tissue and changes no voxel.
    Needle,
    /// Gives voxels that are touched to a segment.
    Painter,
}

impl ToolKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Eraser,
        Self::Adder,
        Self::Drill,
        Self::Needle,
        Self::Painter,
    ];

    /// Name in settings.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Eraser => "eraser",
            Self::Adder => "adder",
            Self::Drill => "drill",
            Self::Needle => "needle",
            Self::Painter => "painter",
        }
    }

    /// The tool of a name.
    ///
    /// # Errors
    /// Where there is none.
    pub fn from_name(name: &str) -> Result<Self, ToolError> {
        let known = Self::ALL.into_iter().find(|kind| kind.name() == name);
        known.ok_or_else(|| ToolError::UnknownTool(name.to_owned()))
    }
}

/// Settings of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolSettings {
    /// Which one.
    pub kind: ToolKind,
    /// Radius of its ball [mm].
    pub radius: f64,
    /// Segments that it changes, all of one grid; for the drill, those of the scan that it cuts;
    /// for the needle, those that it can puncture; the painter gives the first one voxels of the
    /// others.
    pub segments: Vec<SegmentId>,
    /// Settings of the drill; other tools ignore them.
    pub drill: DrillSettings,
    /// What each of the segments is for the needle; other tools pass it over.
    pub tissues: Vec<Tissue>,
    /// Settings of the painter; other tools ignore them.
    pub paint: PaintSettings,
    /// Segments that lose nothing to the drill, since they were moved elsewhere.
    pub spared: SegmentSet,
    /// Segments whose voxels the drill leaves as they are, for other segments too.
    pub locked: SegmentSet,
    /// Voxels of the segments' grid that are cut away: tools leave them as they are.
    pub cut_away: ClipMask,
}

impl ToolSettings {
    /// A tool on these segments, in all else as it is by default.
    #[must_use]
    pub fn new(kind: ToolKind, radius: f64, segments: Vec<SegmentId>) -> Self {
        Self {
            kind,
            radius,
            segments,
            drill: DrillSettings::default(),
            tissues: Vec::new(),
            paint: PaintSettings::default(),
            spared: SegmentSet::EMPTY,
            locked: SegmentSet::EMPTY,
            cut_away: ClipMask::default(),
        }
    }

    /// Makes the tool for segments on a grid: all of them on the same; the drill's is the scan's.
    ///
    /// # Errors
    /// Where the radius is none for voxels of this size, no segment is chosen, or a number of
    /// the drill's is out of range.
    pub fn build(&self, grid: &Grid) -> Result<Box<dyn Tool>, ToolError> {
        self.check(grid)?;
        let segments = self.segments.clone();
        let cut_away = self.cut_away.clone();
        Ok(match self.kind {
            ToolKind::Eraser => Box::new(Eraser::new(self.radius, segments, cut_away)),
            ToolKind::Adder => Box::new(Adder::new(self.radius, segments, cut_away)),
            ToolKind::Drill => Box::new(Drill::new(
                self.radius,
                segments,
                self.drill,
                [self.spared, self.locked],
                cut_away,
            )),
            ToolKind::Needle => Box::new(Needle::default()),
            ToolKind::Painter => {
                Box::new(Painter::new(self.radius, segments, self.paint, cut_away))
            }
        })
    }

    fn check_tissues(&self) -> Result<(), ToolError> {
        let (tissues, segments) = (self.tissues.len(), self.segments.len());
        let is_new = |(place, tissue): &(usize, &Tissue)| !self.tissues[..*place].contains(tissue);
        let different = self.tissues.iter().enumerate().filter(is_new).count();
        if tissues != segments || different > MAX_TISSUES {
            return Err(ToolError::Tissues { tissues, segments });
        }
        self.tissues.iter().try_for_each(Tissue::check)?;
        Ok(())
    }

    fn check_painted(&self) -> Result<(), ToolError> {
        let first = self.segments.first();
        let others = self.segments.iter().filter(|id| Some(*id) != first);
        match others.count() {
            0 => Err(ToolError::NothingToPaint(self.segments.len())),
            _ => Ok(()),
        }
    }

    fn check(&self, grid: &Grid) -> Result<(), ToolError> {
        let in_voxels = match self.kind {
            ToolKind::Eraser | ToolKind::Adder | ToolKind::Painter => MAX_RADIUS_IN_VOXELS,
            ToolKind::Drill => MAX_BURR_IN_VOXELS,
            // what it is drawn with: it does not act on touch
            ToolKind::Needle => f64::INFINITY,
        };
        let allowed = MAX_RADIUS.min(in_voxels * grid.smallest_spacing());
        // written so that NaN is refused
        if !(self.radius > 0.0 && self.radius <= allowed) {
            return Err(ToolError::Radius {
                given: self.radius,
                allowed,
            });
        }
        if self.segments.is_empty() {
            return Err(ToolError::NoSegment);
        }
        if self.kind == ToolKind::Drill {
            self.drill.check()?;
        }
        if self.kind == ToolKind::Needle {
            self.check_tissues()?;
        }
        if self.kind == ToolKind::Painter {
            self.check_painted()?;
            self.paint.check(grid)?;
        }
        Ok(())
    }
}
