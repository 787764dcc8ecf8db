//! What is measured on: the CThead where the data folder is there, else a built head.
//!
//! The data folder is `PALPATE_DATA`, by default `shared/data` beside the project.

use std::path::PathBuf;

use glam::{IVec3, UVec3};
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::threshold::threshold;

/// CThead: 113 slices of 256×256.
const CTHEAD: UVec3 = UVec3::new(256, 256, 113);

/// Its values are not HU but about HU + 1024; this is bone from 250 HU.
const CTHEAD_BONE: f64 = 1274.0;

/// The bone of a head and where it comes from.
pub fn bone() -> (&'static str, Segment) {
    match cthead() {
        Some(scan) => ("cthead", threshold(&scan, None, CTHEAD_BONE, f64::INFINITY)),
        None => ("built", built_bone()),
    }
}

/// The CThead from its raw big-endian slices; none where they are not there.
pub fn cthead() -> Option<Intensities> {
    let folder = data_folder().join("cthead_stanford/raw");
    let mut values = Vec::new();
    for slice in 1..=CTHEAD.z {
        let bytes = std::fs::read(folder.join(format!("CThead.{slice}"))).ok()?;
        let pairs = bytes.chunks_exact(2);
        values.extend(pairs.map(|pair| i16::from_be_bytes([pair[0], pair[1]])));
    }
    Intensities::new(CTHEAD, values, 1.0, 0.0).ok()
}

/// Noise around soft tissue and a bony core, of any size.
pub fn built_scan(dimensions: UVec3) -> Intensities {
    let mut random = oorandom::Rand32::new(11);
    let centre = dimensions.as_dvec3() / 2.0;
    let mut values = Vec::new();
    for z in 0..dimensions.z {
        for y in 0..dimensions.y {
            for x in 0..dimensions.x {
                let offset = (UVec3::new(x, y, z).as_dvec3() - centre) / centre;
                let tissue = if offset.length() < 0.5 { 400.0 } else { 40.0 };
                values.push((tissue + 20.0 * random.rand_float() as f64) as i16);
            }
        }
    }
    Intensities::new(dimensions, values, 1.0, 0.0).expect("one value per voxel")
}

/// A bumpy shell, two to three voxels thick, of the size of CThead.
fn built_bone() -> Segment {
    let centre = CTHEAD.as_dvec3() / 2.0;
    Segment::from_fn(CTHEAD, |voxel: IVec3| {
        let offset = (voxel.as_dvec3() + 0.5 - centre) / centre;
        let bumps = 0.02
            * (voxel.as_dvec3() * 0.4)
                .to_array()
                .map(f64::sin)
                .iter()
                .sum::<f64>();
        (offset.length() + bumps - 0.8).abs() < 0.02
    })
}

fn data_folder() -> PathBuf {
    std::env::var_os("PALPATE_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")),
        PathBuf::from,
    )
}
