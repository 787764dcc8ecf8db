//! Recordings by columns, as dictionaries of arrays from and to Python, and their replay.

use glam::{DQuat, DVec3};
use numpy::ndarray::Array2;
use numpy::{
    Element, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
    ToPyArray,
};
use palpate_engine::replay::{
    BUILD, BrickColumns, Difference, FractionColumns, Recording, ReplayEnd, Replayed, Tape,
    TapeColumns, ValueColumns, replay,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::rows;
use crate::errors::CoreError;
use crate::frame::dictionary;
use crate::parallel::parallel;

/// Names the build that computes the ticks.
#[pyfunction]
pub fn build() -> &'static str {
    BUILD
}

/// The columns of the ticks.
pub fn recording_dict(py: Python<'_>, recording: Recording) -> PyResult<Bound<'_, PyDict>> {
    let quaternions = &recording.orientation;
    let orientation = Array2::from_shape_fn((quaternions.len(), 4), |(row, axis)| {
        quaternions[row].to_array()[axis]
    });
    dictionary!(py,
        "tick": PyArray1::from_vec(py, recording.tick),
        "time": PyArray1::from_vec(py, recording.time),
        "device": rows(py, &recording.device),
        "hand": rows(py, &recording.hand),
        "proxy": rows(py, &recording.proxy),
        "force": rows(py, &recording.force),
        "sent_force": rows(py, &recording.sent_force),
        "contact": PyArray1::from_vec(py, recording.contact),
        "touched": PyArray1::from_vec(py, recording.touched),
        "tool_volume": PyArray1::from_vec(py, recording.tool_volume),
        "tool_time": PyArray1::from_vec(py, recording.tool_time),
        "tool_load": PyArray1::from_vec(py, recording.tool_load),
        "command": PyArray1::from_vec(py, recording.command),
        "reading": PyArray1::from_vec(py, recording.reading),
        "read_at": PyArray1::from_vec(py, recording.read_at),
        "position_in_device": rows(py, &recording.position_in_device),
        "velocity_in_device": rows(py, &recording.velocity_in_device),
        "orientation": orientation.to_pyarray(py),
        "buttons": PyArray1::from_vec(py, recording.buttons),
        "hand_target": rows(py, &recording.hand_target),
        "hand_number": PyArray1::from_vec(py, recording.hand_number),
        "has_room": PyArray1::from_vec(py, recording.has_room),
    )
}

/// The columns of what else a replay needs.
pub fn tape_dict<'py>(py: Python<'py>, tape: &Tape) -> PyResult<Bound<'py, PyDict>> {
    let columns = parallel(py, || TapeColumns::from(tape));
    dictionary!(py,
        "start": PyArray1::from_vec(py, columns.start),
        "commands": PyArray1::from_vec(py, columns.commands),
        "command_ends": PyArray1::from_vec(py, columns.command_ends),
        "brick_ends": PyArray1::from_vec(py, columns.brick_ends),
        "brick_segment": PyArray1::from_vec(py, columns.bricks.segment),
        "brick_index": PyArray1::from_vec(py, columns.bricks.index),
        "brick_words": words(py, &columns.bricks.words),
        "solid_segment": PyArray1::from_vec(py, columns.solid.segment),
        "solid_index": PyArray1::from_vec(py, columns.solid.index),
        "solid_words": words(py, &columns.solid.words),
        "value_index": PyArray1::from_vec(py, columns.values.index),
        "value_stored": stored(py, &columns.values.stored),
        "share_ends": PyArray1::from_vec(py, columns.fraction_ends),
        "share_segment": PyArray1::from_vec(py, columns.fractions.segment),
        "share_index": PyArray1::from_vec(py, columns.fractions.index),
        "share_bytes": bytes(py, &columns.fractions.bytes),
        "known_segment": PyArray1::from_vec(py, columns.known.segment),
        "known_index": PyArray1::from_vec(py, columns.known.index),
        "known_bytes": bytes(py, &columns.known.bytes),
    )
}

/// Computes a recording again. Both dictionaries have the keys that `stop_recording` gives.
#[pyfunction]
pub fn replay_recording<'py>(
    py: Python<'py>,
    recording: &Bound<'py, PyDict>,
    tape: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let recording = recording_of(recording)?;
    let columns = tape_columns_of(tape)?;
    let replayed = parallel(py, || {
        let tape = Tape::try_from(&columns).map_err(|error| CoreError::value(error.to_string()))?;
        replay(&recording, &tape).map_err(|error| CoreError::value(error.to_string()))
    })?;
    replayed_dict(py, replayed)
}

fn replayed_dict(py: Python<'_>, replayed: Replayed) -> PyResult<Bound<'_, PyDict>> {
    let end = match replayed.end {
        ReplayEnd::Whole => ("whole", 0, 0),
        ReplayEnd::Lost { after, count } => ("lost", after, count),
        ReplayEnd::Commands { after } => ("commands", after, 0),
    };
    let first = replayed.first_difference.map(
        |Difference {
             tick,
             time,
             proxy,
             force,
         }| (tick, time, proxy, force),
    );
    dictionary!(py,
        "first_row": replayed.first_row,
        "recorded_hash": replayed.recorded_hash,
        "replayed_hash": replayed.replayed_hash,
        "different": replayed.different,
        "first_difference": first,
        "end": end,
        "ticks": recording_dict(py, replayed.ticks)?,
    )
}

fn recording_of(columns: &Bound<'_, PyDict>) -> PyResult<Recording> {
    let quaternions = wide::<f64, 4>(columns, "orientation")?;
    let recording = Recording {
        tick: column(columns, "tick")?,
        time: column(columns, "time")?,
        device: vectors(columns, "device")?,
        hand: vectors(columns, "hand")?,
        proxy: vectors(columns, "proxy")?,
        force: vectors(columns, "force")?,
        sent_force: vectors(columns, "sent_force")?,
        contact: column(columns, "contact")?,
        touched: column(columns, "touched")?,
        tool_volume: column(columns, "tool_volume")?,
        tool_time: column(columns, "tool_time")?,
        tool_load: column(columns, "tool_load")?,
        command: column(columns, "command")?,
        reading: column(columns, "reading")?,
        read_at: column(columns, "read_at")?,
        position_in_device: vectors(columns, "position_in_device")?,
        velocity_in_device: vectors(columns, "velocity_in_device")?,
        orientation: quaternions.into_iter().map(DQuat::from_array).collect(),
        buttons: column(columns, "buttons")?,
        hand_target: vectors(columns, "hand_target")?,
        hand_number: column(columns, "hand_number")?,
        has_room: column(columns, "has_room")?,
    };
    if recording.is_whole() {
        Ok(recording)
    } else {
        Err(CoreError::value("recording with columns of different length given").into())
    }
}

fn tape_columns_of(columns: &Bound<'_, PyDict>) -> PyResult<TapeColumns> {
    let bricks = |name: &str| -> PyResult<BrickColumns> {
        Ok(BrickColumns {
            segment: column(columns, &format!("{name}_segment"))?,
            index: column(columns, &format!("{name}_index"))?,
            words: wide(columns, &format!("{name}_words"))?,
        })
    };
    let fractions = |name: &str| -> PyResult<FractionColumns> {
        Ok(FractionColumns {
            segment: column(columns, &format!("{name}_segment"))?,
            index: column(columns, &format!("{name}_index"))?,
            bytes: wide(columns, &format!("{name}_bytes"))?,
        })
    };
    Ok(TapeColumns {
        start: column(columns, "start")?,
        commands: column(columns, "commands")?,
        command_ends: column(columns, "command_ends")?,
        brick_ends: column(columns, "brick_ends")?,
        bricks: bricks("brick")?,
        solid: bricks("solid")?,
        values: ValueColumns {
            index: column(columns, "value_index")?,
            stored: wide(columns, "value_stored")?,
        },
        fraction_ends: column(columns, "share_ends")?,
        fractions: fractions("share")?,
        known: fractions("known")?,
    })
}

/// A column of one number a row.
fn column<T: Element + Copy>(columns: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<T>> {
    let array: PyReadonlyArray1<'_, T> = columns.as_any().get_item(name)?.extract()?;
    Ok(array.as_array().iter().copied().collect())
}

/// A column of N numbers a row.
fn wide<T: Element + Copy, const N: usize>(
    columns: &Bound<'_, PyDict>,
    name: &str,
) -> PyResult<Vec<[T; N]>> {
    let array: PyReadonlyArray2<'_, T> = columns.as_any().get_item(name)?.extract()?;
    if array.shape()[1] != N {
        return Err(CoreError::value(format!(
            "{name} of shape {:?} given; allowed: [count, {N}]",
            array.shape()
        ))
        .into());
    }
    let view = array.as_array();
    let rows = view.rows();
    Ok(rows
        .into_iter()
        .map(|row| std::array::from_fn(|axis| row[axis]))
        .collect())
}

fn vectors(columns: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<DVec3>> {
    let rows = wide::<f64, 3>(columns, name)?;
    Ok(rows.into_iter().map(DVec3::from_array).collect())
}

/// Bricks of values, shape [count, 512].
fn stored<'py>(py: Python<'py>, bricks: &[[i16; 512]]) -> Bound<'py, numpy::PyArray2<i16>> {
    let flat = bricks.as_flattened().to_vec();
    let shape = (bricks.len(), 512);
    let array = Array2::from_shape_vec(shape, flat).expect("512 values for each brick");
    PyArray2::from_owned_array(py, array)
}

/// Bricks of occupancy fractions, shape [count, 512].
fn bytes<'py>(py: Python<'py>, bricks: &[[u8; 512]]) -> Bound<'py, numpy::PyArray2<u8>> {
    let flat = bricks.as_flattened().to_vec();
    let shape = (bricks.len(), 512);
    let array = Array2::from_shape_vec(shape, flat).expect("512 bytes for each brick");
    PyArray2::from_owned_array(py, array)
}

/// Bricks, shape [count, 8].
fn words<'py>(py: Python<'py>, words: &[[u64; 8]]) -> Bound<'py, numpy::PyArray2<u64>> {
    Array2::from_shape_fn((words.len(), 8), |(row, z)| words[row][z]).to_pyarray(py)
}
