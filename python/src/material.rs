//! Materials and deformation as the package names and reads them.

use palpate_deform::material::{
    MaterialError, MaterialLaw, PRESETS, Preset, Region, Solid, SolidSi, Treatment, preset,
};
use palpate_deform::registry::{
    Calibration, MODELS, ModelOptions, Motion, Prony, Range, Registered,
};
use palpate_engine::deformable::{DeformationStatus, ForceSource, ShownParts};
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::triple;
use crate::errors::CoreError;
use crate::frame::dictionary;

impl From<MaterialError> for CoreError {
    fn from(error: MaterialError) -> Self {
        Self::value(error.to_string())
    }
}

/// Young's modulus [Pa], Poisson's ratio, density [kg/m³], fracture energy [J/m²], friction, strain
/// stiffening.
pub type SolidTuple = (f64, f64, f64, f64, f64, f64);

/// An interval of HU with the constants at its ends.
pub type LinearTuple = ((f64, f64), SolidTuple, SolidTuple);

fn solid((young, poisson, density, fracture_energy, friction, stiffening): SolidTuple) -> SolidSi {
    SolidSi {
        young,
        poisson,
        density,
        fracture_energy,
        friction,
        stiffening,
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

/// A treatment, a box of voxels, and another segment; without both, the whole segment.
pub type RegionTuple = (String, Option<([i32; 3], [i32; 3])>, Option<u8>);

/// A region of a segment and how it takes part.
pub fn region((treatment, within, shared): RegionTuple) -> Result<(Region, Treatment), CoreError> {
    let treatment = match treatment.as_str() {
        "deformable" => Treatment::Deformable,
        "rigid" => Treatment::Rigid,
        "empty" => Treatment::Empty,
        other => {
            return Err(CoreError::value(format!(
                "treatment {other:?} given; allowed: deformable, rigid, empty"
            )));
        }
    };
    let region = match (within, shared) {
        (None, None) => Region::Whole,
        (Some((low, high)), None) => Region::Within(VoxelBox::new(low.into(), high.into())),
        (None, Some(id)) => Region::Shared(SegmentId(id)),
        (Some(_), Some(_)) => {
            return Err(CoreError::value(
                "a box and another segment given; allowed: one of them, or none for all of it"
                    .to_owned(),
            ));
        }
    };
    Ok((region, treatment))
}

/// Name, source, whether it follows HU, the constants at the ends of its HU, and the range of Young's
/// moduli [Pa].
type PresetTuple = (
    &'static str,
    &'static str,
    bool,
    SolidTuple,
    SolidTuple,
    (f64, f64),
);

/// Materials by name, each with the source of its constants.
#[pyfunction]
pub fn material_presets() -> Result<Vec<PresetTuple>, CoreError> {
    let preset = |preset: &Preset| {
        let law = preset.law()?;
        let [low, high] = law.ends().map(solid_tuple);
        Ok((
            preset.name,
            preset.source,
            law.needs_hounsfield(),
            low,
            high,
            preset.young_range.into(),
        ))
    };
    PRESETS.iter().map(preset).collect()
}

fn solid_tuple(solid: Solid) -> SolidTuple {
    let si = solid.si();
    (
        si.young,
        si.poisson,
        si.density,
        si.fracture_energy,
        si.friction,
        si.stiffening,
    )
}

/// What a segment is made of: the name, where it is one of the list, and the constants at the ends
/// of its HU; these are told where somebody chose them.
pub fn material_dict<'py>(py: Python<'py>, law: &MaterialLaw) -> PyResult<Bound<'py, PyDict>> {
    let preset = PRESETS.iter().find(|preset| preset.law() == Ok(*law));
    let [low, high] = law.ends().map(solid_tuple);
    let interval = match law {
        MaterialLaw::Linear { interval, .. } => Some(*interval),
        _ => None,
    };
    dictionary!(py,
        "preset": preset.map(|preset| preset.name),
        "low": low,
        "high": high,
        "interval": interval,
    )
}

/// The parts of a model as the page draws them: the fields of `protocol.MatterParts`.
pub fn parts_dict<'py>(py: Python<'py>, parts: &ShownParts) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "origin": triple(parts.origin),
        "size": triple(parts.size),
        "apart": parts.apart,
        "places": PyBytes::new(py, &parts.places),
        "strains": PyBytes::new(py, &parts.strains),
    )
}

/// The models of soft tissue, with what each offers to choose.
#[pyfunction]
pub fn deformation_models(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    MODELS.iter().map(|model| offered(py, model)).collect()
}

fn offered<'py>(py: Python<'py>, model: &Registered) -> PyResult<Bound<'py, PyDict>> {
    let offers = &model.offers;
    dictionary!(py,
        "name": model.name,
        "title": model.title,
        "bonded": model.bonded,
        "boxes": offers.boxes.map(|b| (b.least, b.usual, b.most)),
        "binding": offers.binding.map(|b| (b.least, b.usual, b.most)),
        "walls": offers.walls,
        "fades": offers.fades.map(|fading| (range(fading.shares), range(fading.times))),
        "yields": offers.yields.map(range),
        "layers": offers.layers,
        "calibration": offers.calibration,
        "motion": offers.motion,
        "whole_segment": offers.whole_segment,
    )
}

fn range(range: Range) -> (f64, f64) {
    (range.least, range.most)
}

/// What of a model is not as usual: edge, binding, walls, share and time [s] of what fades, the
/// strain from which on matter yields, layers, calibration and motion, and
/// whether the whole segment is behind the box.
pub type OptionsTuple = (
    Option<u32>,
    Option<f64>,
    bool,
    Option<(f64, f64)>,
    Option<f64>,
    Option<u32>,
    Option<String>,
    Option<String>,
    bool,
);

/// How the stiffness of particles follows from the material, by name.
const CALIBRATIONS: [(&str, Calibration); 2] = [
    ("young", Calibration::Young),
    ("wave-speed", Calibration::WaveSpeed),
];

/// How particles come to rest, by name.
const MOTIONS: [(&str, Motion); 2] = [("scaled-time", Motion::SCALED_TIME), ("fire", Motion::Rest)];

/// What is chosen of a model.
pub fn model_options(options: OptionsTuple) -> Result<ModelOptions, CoreError> {
    let (edge, binding, walls, prony, yield_strain, layers, calibration, motion, whole_segment) =
        options;
    let calibration = calibration.map(|name| named("calibration", &CALIBRATIONS, &name));
    let motion = motion.map(|name| named("motion", &MOTIONS, &name));
    Ok(ModelOptions {
        edge,
        binding,
        walls,
        prony: prony.map(|(share, time)| Prony { share, time }),
        yield_strain,
        layers,
        calibration: calibration.transpose()?,
        motion: motion.transpose()?,
        rearranges: false,
        whole_segment,
    })
}

fn options_dict<'py>(py: Python<'py>, options: &ModelOptions) -> PyResult<Bound<'py, PyDict>> {
    let prony = options.prony.map(|prony| -> PyResult<_> {
        dictionary!(py,
            "share": prony.share,
            "time": prony.time,
        )
    });
    dictionary!(py,
        "edge": options.edge,
        "binding": options.binding,
        "walls": options.walls,
        "prony": prony.transpose()?,
        "yield_strain": options.yield_strain,
        "layers": options.layers,
        "calibration": options.calibration.and_then(|each| name_of(&CALIBRATIONS, each)),
        "motion": options.motion.and_then(|each| name_of(&MOTIONS, each)),
        "whole_segment": options.whole_segment,
    )
}

/// What is called so.
fn named<T: Copy>(what: &str, known: &[(&str, T)], name: &str) -> Result<T, CoreError> {
    let found = known.iter().find(|(known, _)| *known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<_> = known.iter().map(|(name, _)| *name).collect();
        let names = names.join(", ");
        CoreError::value(format!("{what} {name:?} given; allowed: {names}"))
    })
}

/// How it is called.
fn name_of<T: PartialEq>(known: &[(&'static str, T)], value: T) -> Option<&'static str> {
    let found = known.iter().find(|(_, known)| *known == value);
    found.map(|(name, _)| *name)
}

/// What a tool can feel of soft tissue, by name.
const FORCE_SOURCES: [(&str, ForceSource); 2] = [
    ("matter", ForceSource::Matter),
    ("voxels", ForceSource::Voxels),
];

/// What a tool is to feel, by its name.
pub fn force_source(name: &str) -> Result<ForceSource, CoreError> {
    named("force source", &FORCE_SOURCES, name)
}

/// How the deformation goes.
pub fn deformation_dict<'py>(
    py: Python<'py>,
    now: &DeformationStatus,
) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "model": now.model,
        "options": options_dict(py, &now.options)?,
        "force_source": name_of(&FORCE_SOURCES, now.source),
        "force": now.force.to_array(),
        "answers": now.answers,
        "late": now.late,
        "slips": now.slips,
        "iterations": now.report.iterations,
        "residual": now.report.residual,
        "settling": now.report.settling,
        "small_box": now.report.small_box,
        "nodes": now.report.nodes,
        "moved_voxels": now.report.moved_voxels,
        "lasting_voxels": now.report.plastic_voxels,
        "bonds_broken": now.report.bonds_broken,
        "work_broken": now.report.work_broken,
    )
}
