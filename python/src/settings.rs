//! Settings of touch as a dictionary; its keys are the fields of `protocol.Settings`.

use palpate_engine::touch::{Model, Settings, Smoothing};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;

/// The contact model of a name.
pub fn model_named(name: &str) -> Result<Model, CoreError> {
    Model::named(name).ok_or_else(|| {
        let allowed = Model::ALL.map(|model| format!("'{}'", model.name()));
        CoreError::value(format!(
            "contact model {name:?} given; allowed: {}",
            allowed.join(", ")
        ))
    })
}

/// Where the force comes from, by its name.
fn smoothing_named(name: &str) -> Result<Smoothing, CoreError> {
    Smoothing::named(name).ok_or_else(|| {
        let allowed = Smoothing::ALL.map(|smoothing| format!("'{}'", smoothing.name()));
        CoreError::value(format!(
            "smoothing {name:?} given; allowed: {}",
            allowed.join(", ")
        ))
    })
}

/// Settings with those changed that are given; None leaves one as it is.
pub fn changed(mut settings: Settings, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Settings> {
    let Some(changes) = changes else {
        return Ok(settings);
    };
    for (name, value) in changes {
        if value.is_none() {
            continue;
        }
        let name: String = name.extract()?;
        match name.as_str() {
            "model" => settings.model = model_named(&value.extract::<String>()?)?,
            "stiffness" => settings.stiffness = value.extract()?,
            "damping" => settings.damping = value.extract()?,
            "friction_static" => settings.friction_static = value.extract()?,
            "friction_kinetic" => settings.friction_kinetic = value.extract()?,
            "smoothing" => settings.smoothing = smoothing_named(&value.extract::<String>()?)?,
            "probe_radius" => settings.probe_radius = value.extract()?,
            "force_limit" => settings.force_limit = value.extract()?,
            "gain" => settings.gain = value.extract()?,
            _ => return Err(CoreError::value(format!("no setting has the name {name:?}")).into()),
        }
    }
    Ok(settings)
}

/// The settings that hold.
pub fn settings_dict(py: Python<'_>, settings: Settings) -> PyResult<Bound<'_, PyDict>> {
    let dictionary = PyDict::new(py);
    dictionary.set_item("model", settings.model.name())?;
    dictionary.set_item("stiffness", settings.stiffness)?;
    dictionary.set_item("damping", settings.damping)?;
    dictionary.set_item("friction_static", settings.friction_static)?;
    dictionary.set_item("friction_kinetic", settings.friction_kinetic)?;
    dictionary.set_item("smoothing", settings.smoothing.name())?;
    dictionary.set_item("probe_radius", settings.probe_radius)?;
    dictionary.set_item("force_limit", settings.force_limit)?;
    dictionary.set_item("gain", settings.gain)?;
    Ok(dictionary)
}
