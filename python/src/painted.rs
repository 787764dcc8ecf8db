//! Lines that were painted on the picture, to cut segments along.

use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use palpate_engine::scene::Painted;

use crate::arrays::{Triple, vector};
use crate::errors::CoreError;

/// Points of shape [count, 3], eye, view and whether the line is closed: what
/// `palpate.painted_cut.PaintedCut.given` gives.
pub type GivenLine<'py> = (PyReadonlyArray2<'py, f64>, Triple, Triple, bool);

/// A line as it is given.
pub fn painted((line, eye, view, closed): &GivenLine<'_>) -> Result<Painted, CoreError> {
    let points = line.as_array();
    if points.ncols() != 3 {
        return Err(CoreError::value(format!(
            "points of shape {:?} given; allowed: [count, 3]",
            line.shape()
        )));
    }
    let rows = points.rows().into_iter();
    Ok(Painted {
        eye: vector(*eye),
        view: vector(*view),
        line: rows.map(|row| vector((row[0], row[1], row[2]))).collect(),
        closed: *closed,
    })
}
