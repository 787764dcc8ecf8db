//! The one place where errors of the engine become Python exceptions.
//!
//! `ValueError` for what the caller gave, `RuntimeError` for what the session cannot do any
//! more, `OSError` for what the disk refuses. The sentences are the engine's own.

use palpate_bench::haptics::BenchError;
use palpate_device::scripted::PathError;
use palpate_device::simulated::SettingsError;
use palpate_engine::error::SessionError;
use palpate_render::checks::CheckError;
use palpate_render::renderer::NoAppearance;
use palpate_render::scene::SceneError;
use palpate_surface::SettingsError as SurfaceSettingsError;
use palpate_surface::voxelise::MeshError;
use palpate_tools::journal::JournalError;
use palpate_tools::tool::ToolError;
use palpate_volume::grid::GridError;
use palpate_volume::intensities::IntensitiesError;
use palpate_volume::segment::SegmentError;
use palpate_volume::voxels::VoxelsError;
use pyo3::PyErr;
use pyo3::exceptions::{PyBlockingIOError, PyOSError, PyRuntimeError, PyValueError};

/// An error of the engine on its way to Python.
#[derive(Debug)]
pub enum CoreError {
    /// The caller gave what is not allowed.
    Value(String),
    /// The session cannot do it.
    Session(SessionError),
}

impl CoreError {
    /// What was given and what is allowed.
    pub fn value(message: impl Into<String>) -> Self {
        Self::Value(message.into())
    }
}

impl From<CoreError> for PyErr {
    fn from(error: CoreError) -> Self {
        match error {
            CoreError::Value(message) => PyValueError::new_err(message),
            CoreError::Session(
                error @ (SessionError::Stopped
                | SessionError::Failed(_)
                | SessionError::Thread { .. }
                | SessionError::NotOffline),
            ) => PyRuntimeError::new_err(error.to_string()),
            CoreError::Session(SessionError::Journal(error @ JournalError::InUse(_))) => {
                PyBlockingIOError::new_err(error.to_string())
            }
            CoreError::Session(SessionError::Journal(
                error @ (JournalError::Disk { .. } | JournalError::Exists(_)),
            )) => PyOSError::new_err(error.to_string()),
            CoreError::Session(error) => PyValueError::new_err(error.to_string()),
        }
    }
}

impl From<SessionError> for CoreError {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}

/// Errors that are always about a value given.
macro_rules! value_errors {
    ($($error:ty),*) => {$(
        impl From<$error> for CoreError {
            fn from(error: $error) -> Self {
                Self::value(error.to_string())
            }
        }
    )*};
}

value_errors!(
    BenchError,
    GridError,
    IntensitiesError,
    SegmentError,
    PathError,
    SettingsError,
    SurfaceSettingsError,
    ToolError,
    MeshError,
    SceneError,
    CheckError,
    NoAppearance,
    VoxelsError
);
