//! `_core.touch_quality_cases` and `_core.bench_touch_quality`: for `palpate bench touch-quality`.

use palpate_bench::quality::{Figures, Touch, cases, cases_where, measure};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;

/// Names of all cases, in the order of their report.
#[pyfunction]
pub fn touch_quality_cases(py: Python<'_>) -> Vec<String> {
    py.detach(|| cases().into_iter().map(|case| case.name).collect())
}

/// Touches one case in one way of touch.
#[pyfunction]
pub fn bench_touch_quality<'py>(
    py: Python<'py>,
    case: &str,
    touch: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let touch = touch_named(touch)?;
    let figures = py
        .detach(|| {
            let case = cases_where(touch.radius(), |name| name == case).pop()?;
            Some(measure(&case, touch))
        })
        .ok_or_else(|| {
            CoreError::value(format!(
                "case {case:?} given; allowed: those of touch_quality_cases"
            ))
        })?;
    figures_dict(py, &figures)
}

fn touch_named(name: &str) -> Result<Touch, CoreError> {
    Touch::named(name).ok_or_else(|| {
        let allowed = Touch::ALL.map(|touch| format!("'{}'", touch.name()));
        CoreError::value(format!(
            "way of touch {name:?} given; allowed: {}",
            allowed.join(", ")
        ))
    })
}

fn figures_dict<'py>(py: Python<'py>, figures: &Figures) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for (name, value) in figures.named() {
        dictionary.set_item(name, value)?;
    }
    Ok(dictionary)
}
