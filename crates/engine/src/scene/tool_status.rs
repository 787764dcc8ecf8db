//! The tool in the hand, as frames and recordings have it.

use palpate_tools::factory::ToolKind;
use palpate_tools::tool::ToolReport;

/// The tool in the hand as the picture shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolStatus {
    /// Which one; none where the hand is empty.
    pub kind: Option<ToolKind>,
    /// Radius of its ball [mm]; 0 where the hand is empty.
    pub radius: f64,
    /// Whether a stroke is on.
    pub on: bool,
    /// What it has done in the stroke that is on, or in the last one.
    pub report: ToolReport,
}
