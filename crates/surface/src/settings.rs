//! How a surface is made of a segment.

use thiserror::Error;

/// The largest degree of smoothing: a patch and its margin then fit a row of 64 bits.
pub const MAX_SMOOTHING: u8 = 12;

/// Cells along the edge of a patch; the first patch along an axis has one more, at the border.
pub const PATCH_CELLS: i32 = 32;

/// Surroundings that the smoothing of a patch takes into account.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SmoothingMode {
    /// Only the patch: fewer patches follow an edit, but they do not meet at their borders.
    Local,
    /// All surroundings that tissue, (degree + 2) · step voxels around the patch: no seams.
    #[default]
    Global,
}

/// Limits of the intensities that are solid [physical units, HU for CT]; one may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The lowest.
    pub low: f64,
    /// The highest.
    pub high: f64,
}

/// Settings that make no surface.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SettingsError {
    /// Not a step.
    #[error("step of {0} voxels given; allowed: 1, 2 or 4")]
    Step(u8),
    /// Too smooth.
    #[error("smoothing degree {0} given; allowed: 0 to {MAX_SMOOTHING}")]
    Smoothing(u8),
    /// The limits enclose no intensity.
    #[error("limits {low} to {high} given; allowed: numbers, the low one below the high one")]
    Limits {
        /// The low one.
        low: f64,
        /// The high one.
        high: f64,
    },
}

/// Settings of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSettings {
    /// Edge of a cell [voxels]: 1, 2 or 4. The thesis calls it dmc.
    pub step: u8,
    /// Smoothing degree d: 0 shows the voxels as they are; each degree looks one cell farther.
    pub smoothing: u8,
    /// What smoothing sees of the patches around.
    pub mode: SmoothingMode,
    /// Where given, the scan's values place the surface between voxels; else the bits alone do.
    pub limits: Option<Limits>,
    /// A patch with more vertices is parted into its octants, so that patches are finer where
    /// the segment is dense; none parts no patch.
    pub most_vertices: Option<u32>,
}

impl Default for SurfaceSettings {
    fn default() -> Self {
        Self {
            step: 1,
            smoothing: 3,
            mode: SmoothingMode::Global,
            limits: None,
            most_vertices: None,
        }
    }
}

impl SurfaceSettings {
    /// Refuses what makes no surface.
    ///
    /// # Errors
    /// See [`SettingsError`].
    pub fn check(&self) -> Result<(), SettingsError> {
        if ![1, 2, 4].contains(&self.step) {
            return Err(SettingsError::Step(self.step));
        }
        if self.smoothing > MAX_SMOOTHING {
            return Err(SettingsError::Smoothing(self.smoothing));
        }
        if let Some(Limits { low, high }) = self.limits
            && (low >= high || low.is_nan() || high.is_nan())
        {
            return Err(SettingsError::Limits { low, high });
        }
        Ok(())
    }

    /// How many samples beyond its own a patch depends on.
    pub(crate) fn margin(&self) -> i32 {
        i32::from(self.smoothing) + 2
    }

    /// The same for the patches that an edit can change: none where each is smoothed alone.
    pub(crate) fn reach(&self) -> i32 {
        match self.mode {
            SmoothingMode::Local if self.smoothing > 0 => 0,
            // a value counts by its slope, which its neighbours tell
            _ => self.margin() + i32::from(self.limits.is_some()),
        }
    }
}
