//! The Python module `palpate._core`: thin, one type per argument.
//!
//! Only the package `palpate` imports it, wraps its classes and takes the many types that users
//! have. The GIL is released wherever the engine works. Arrays are [z, y, x], x fastest; points
//! are (x, y, z), LPS mm.

mod arrays;
mod bench;
mod bench_deformation;
mod bench_passivity;
mod bench_quality;
mod bench_stress;
mod device;
mod errors;
mod frame;
mod given_look;
mod kept_surface;
mod material;
mod painted;
mod parallel;
mod phantom;
mod picture;
mod recording;
mod render;
mod running;
mod scenario;
mod segment;
mod session;
mod settings;
mod surface;
mod tool;
mod volume;

use pyo3::prelude::*;

/// The engine of Palpate.
#[pymodule]
mod _core {
    use numpy::PyArrayMethods;
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::bench::{PyGround, PyTouchBench, bench_embedded};
    #[pymodule_export]
    use super::bench_deformation::{
        bench_lattice_cost, bench_lattice_force, bench_lattice_frames, bench_lj_pairs,
        bench_matter_stress, bench_session, particle_limits, press_block,
    };
    #[pymodule_export]
    use super::bench_passivity::{bench_passivity, passivity_devices};
    #[pymodule_export]
    use super::bench_quality::{bench_touch_quality, touch_quality_cases};
    #[pymodule_export]
    use super::bench_stress::bench_stress;
    #[pymodule_export]
    use super::kept_surface::PyKeptSurface;
    #[pymodule_export]
    use super::material::{deformation_models, material_presets};
    #[pymodule_export]
    use super::phantom::make_phantom;
    #[pymodule_export]
    use super::recording::{build, replay_recording};
    #[pymodule_export]
    use super::render::{PyPicture, PyRenderer, PySecondScan};
    #[pymodule_export]
    use super::scenario::{
        drive_drill, drive_needle, drive_rearranging_ball, needle_tissues, press,
    };
    #[pymodule_export]
    use super::segment::PySegment;
    #[pymodule_export]
    use super::session::PySession;
    #[pymodule_export]
    use super::surface::{PySurface, phantom_bones, voxelise_mesh};
    #[pymodule_export]
    use super::volume::PyVolume;

    #[pymodule_init]
    fn begin(module: &Bound<'_, PyModule>) -> PyResult<()> {
        find_numpy(module.py())?;
        stop_sessions_at_exit(module)
    }

    /// Looks up here what rust-numpy would look up at the first array: Ctrl-C that came before that, while an
    /// engine's function ran, would be a panic there instead of a `KeyboardInterrupt`.
    fn find_numpy(py: Python<'_>) -> PyResult<()> {
        py.import("numpy")?;
        numpy::PyArray1::<f32>::zeros(py, 0, false).try_readonly()?;
        Ok(())
    }

    /// A program that ends without stopping its sessions must not leave a force behind.
    fn stop_sessions_at_exit(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let stop_all = wrap_pyfunction!(super::running::stop_all, module)?;
        let atexit = module.py().import("atexit")?;
        atexit.call_method1("register", (stop_all,))?;
        Ok(())
    }
}
