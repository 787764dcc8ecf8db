//! Materials and deformation as the package names and reads them.

use palpate_deform::material::{MaterialError, MaterialLaw, PRESETS, SolidSi, preset};
use palpate_deform::model::MODELS;
use palpate_engine::deformation::DeformationNow;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;
use crate::frame::dictionary;

impl From<MaterialError> for CoreError {
    fn from(error: MaterialError) -> Self {
        Self::value(error.to_string())
    }
}

/// Young's modulus [Pa], Poisson's ratio, density [kg/m³], breaking strain, friction.
pub type SolidTuple = (f64, f64, f64, f64, f64);

/// An interval of HU with the constants at its ends.
pub type LinearTuple = ((f64, f64), SolidTuple, SolidTuple);

fn solid((young, poisson, density, breaking_strain, friction): SolidTuple) -> SolidSi {
    SolidSi {
        young,
        poisson,
        density,
        breaking_strain,
        friction,
    }
}

/// A material by its name.
pub fn material_named(name: &str) -> Result<MaterialLaw, CoreError> {
    let names = || PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>();
    let preset = preset(name).map_err(|_| {
        CoreError::value(format!(
            "material {name:?} given; allowed: {}",
            names().join(", ")
        ))
    })?;
    Ok(preset.law()?)
}

/// The same constants everywhere.
pub fn constant_material(given: SolidTuple) -> Result<MaterialLaw, CoreError> {
    Ok(MaterialLaw::constant(solid(given))?)
}

/// Constants linear in HU.
pub fn linear_material(
    ((low_hu, high_hu), low, high): LinearTuple,
) -> Result<MaterialLaw, CoreError> {
    Ok(MaterialLaw::linear(
        [low_hu, high_hu],
        solid(low),
        solid(high),
    )?)
}

/// Materials by name, each with the source of its constants.
#[pyfunction]
pub fn material_presets() -> Vec<(&'static str, &'static str)> {
    let presets = PRESETS.iter();
    presets.map(|preset| (preset.name, preset.source)).collect()
}

/// Names of the models by which matter gives way.
#[pyfunction]
pub fn deformation_models() -> Vec<&'static str> {
    MODELS.iter().map(|model| model.name).collect()
}

/// How the deformation goes.
pub fn deformation_dict<'py>(
    py: Python<'py>,
    now: &DeformationNow,
) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "model": now.model,
        "force": now.force.to_array(),
        "answers": now.answers,
        "slips": now.slips,
        "iterations": now.report.iterations,
        "residual": now.report.residual,
        "nodes": now.report.nodes,
        "bonds_broken": now.report.bonds_broken,
        "work_broken": now.report.work_broken,
    )
}
