//! Tools as the package names and reads them.

use palpate_engine::frame::Frame;
use palpate_tools::drill::DrillSettings;
use palpate_tools::specific_energy::SpecificEnergy;
use palpate_tools::tool::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::matter::SegmentSet;
use palpate_volume::tissue::Tissue;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;
use crate::frame::dictionary;
use crate::needle::Figures;

/// A tool by its name; `energy` is the drill's work per volume, none that of bone by HU; `tissues` are
/// those of a needle.
pub fn tool_settings(
    kind: &str,
    radius: f64,
    segments: Vec<u8>,
    air: Option<f64>,
    energy: Option<f64>,
    tissues: Vec<Figures>,
) -> Result<ToolSettings, CoreError> {
    let usual = DrillSettings::default();
    Ok(ToolSettings {
        kind: ToolKind::from_name(kind)?,
        radius,
        segments: segments.into_iter().map(SegmentId).collect(),
        drill: DrillSettings {
            air: air.unwrap_or(usual.air),
            specific_energy: energy.map_or(usual.specific_energy, SpecificEnergy::Everywhere),
            ..usual
        },
        tissues: tissues.into_iter().map(Tissue::of_figures).collect(),
        spared: SegmentSet::EMPTY,
    })
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
