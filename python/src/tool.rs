//! Tools as the package names and reads them.

use palpate_engine::picture::Frame;
use palpate_engine::touch::NeedleDisplay;
use palpate_haptics::needle::events::NeedleEvent;
use palpate_tools::drill::DrillSettings;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::painter::PaintSettings;
use palpate_tools::specific_energy::SpecificEnergy;
use palpate_volume::clip::ClipMask;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::tissue::Tissue;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::triple;
use crate::errors::CoreError;
use crate::frame::dictionary;
use crate::scenario::Figures;

/// A tool by its name; `energy` is the drill's work per volume, none that of bone by HU; `tissues` are
/// those of a needle, `paint` the depth of a painter and whether segments may overlap.
pub fn tool_settings(
    kind: &str,
    radius: f64,
    segments: Vec<u8>,
    air: Option<f64>,
    energy: Option<f64>,
    tissues: Vec<Figures>,
    (depth, overlaps): (Option<f64>, bool),
) -> Result<ToolSettings, CoreError> {
    Ok(ToolSettings {
        kind: ToolKind::from_name(kind)?,
        radius,
        segments: segments.into_iter().map(SegmentId).collect(),
        drill: drill_settings(air, energy),
        tissues: tissues.into_iter().map(Tissue::of_figures).collect(),
        paint: PaintSettings { depth, overlaps },
        spared: SegmentSet::EMPTY,
        locked: SegmentSet::EMPTY,
        cut_away: ClipMask::default(),
    })
}

/// A drill by what the scan reads where matter went and its work per volume; none are as usual.
pub fn drill_settings(air: Option<f64>, energy: Option<f64>) -> DrillSettings {
    let usual = DrillSettings::default();
    DrillSettings {
        air: air.unwrap_or(usual.air),
        specific_energy: energy.map_or(usual.specific_energy, SpecificEnergy::Everywhere),
        ..usual
    }
}

/// The tool in the hand; its keys are the fields of `protocol.ToolState`.
pub fn tool_dict<'py>(py: Python<'py>, frame: &Frame) -> PyResult<Bound<'py, PyDict>> {
    let tool = frame.tool;
    dictionary!(py,
        "kind": tool.kind.map_or("none", ToolKind::name),
        "radius": tool.radius,
        "on": tool.on,
        "voxels": tool.report.voxels,
        "volume": tool.report.volume,
        "time": tool.report.time,
        "energy": tool.report.energy,
        "load": tool.report.load,
        "undo_bytes": frame.undo_bytes,
        "undo_budget": frame.undo_budget,
    )
}

/// A needle in the hand; its keys are the fields of `protocol.NeedleState`.
pub fn needle_dict<'py>(py: Python<'py>, needle: &NeedleDisplay) -> PyResult<Bound<'py, PyDict>> {
    let place = needle.place.unwrap_or_default();
    dictionary!(py,
        "inside": needle.place.is_some(),
        "depth": place.depth,
        "entry": triple(place.entry),
        "direction": triple(place.direction),
        "segment": place.segment,
        "tip": needle.forces.stiffness + needle.forces.cutting,
        "friction": needle.forces.friction,
        "wall": needle.forces.wall,
        "events": needle.events,
        "set_direction": needle.direction.map(triple),
    )
}

/// Kind, segment, time [s], depth [mm] and force [N] of what happened to a needle.
pub type Event = (&'static str, u8, f64, f64, f64);

/// An event as Python has it.
pub fn event_tuple(event: &NeedleEvent) -> Event {
    let NeedleEvent {
        kind,
        segment,
        time,
        depth,
        force,
    } = *event;
    (kind.name(), segment, time, depth, force)
}
