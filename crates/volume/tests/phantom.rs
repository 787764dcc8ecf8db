//! The phantom is an anatomical trunk, and its labels are the truth about its intensities.

use std::collections::HashSet;
use std::sync::LazyLock;

use glam::{DVec3, IVec3, UVec3};
use palpate_volume::phantom::{FIELD_OF_VIEW, NOISE, Phantom, Tissue, phantom};

/// Voxels of 2.5 mm on all sides: 3.8 million, made once for all tests.
static TRUNK: LazyLock<Phantom> =
    LazyLock::new(|| phantom(UVec3::new(160, 112, 216), 1).expect("valid dimensions"));

fn voxels(of: &Phantom) -> impl Iterator<Item = (IVec3, Tissue, i16)> {
    let size = of.grid.dimensions().as_ivec3();
    let values = of.intensities.values();
    of.labels.iter().enumerate().map(move |(index, &label)| {
        let i = index as i32;
        let voxel = IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
        (voxel, Tissue::ALL[usize::from(label)], values[index])
    })
}

fn points(of: &Phantom, tissue: Tissue) -> Vec<DVec3> {
    let patient_from_grid = of.grid.patient_from_grid();
    voxels(of)
        .filter(|voxel| voxel.1 == tissue)
        .map(|(voxel, ..)| patient_from_grid.transform_point3(voxel.as_dvec3() + 0.5))
        .collect()
}

fn centroid(tissue: Tissue) -> DVec3 {
    let points = points(&TRUNK, tissue);
    points.iter().sum::<DVec3>() / points.len() as f64
}

/// Lowest and highest coordinates [patient].
fn extent(tissue: Tissue) -> (DVec3, DVec3) {
    points(&TRUNK, tissue).into_iter().fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), point| (low.min(point), high.max(point)),
    )
}

fn millilitres(of: &Phantom, tissue: Tissue) -> f64 {
    let count = of
        .labels
        .iter()
        .filter(|&&label| label == tissue as u8)
        .count();
    count as f64 * of.grid.voxel_volume() / 1000.0
}

/// Sizes [voxels] of the face-connected pieces of a tissue, the largest first.
fn pieces(of: &Phantom, tissue: Tissue) -> Vec<usize> {
    const FACES: [IVec3; 6] = [
        IVec3::X,
        IVec3::NEG_X,
        IVec3::Y,
        IVec3::NEG_Y,
        IVec3::Z,
        IVec3::NEG_Z,
    ];
    let mut left: HashSet<IVec3> = voxels(of)
        .filter(|voxel| voxel.1 == tissue)
        .map(|voxel| voxel.0)
        .collect();
    let mut sizes = Vec::new();
    while let Some(&start) = left.iter().next() {
        left.remove(&start);
        let (mut front, mut size) = (vec![start], 0);
        while let Some(voxel) = front.pop() {
            size += 1;
            front.extend(
                FACES
                    .iter()
                    .map(|face| voxel + face)
                    .filter(|next| left.remove(next)),
            );
        }
        sizes.push(size);
    }
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    sizes
}

/// Whether all voxels at most two away along each axis are of one tissue.
fn is_deep_inside(of: &Phantom, voxel: IVec3, tissue: Tissue) -> bool {
    let around = -2..=2;
    around.clone().all(|z| {
        around.clone().all(|y| {
            around.clone().all(|x| {
                let neighbour = voxel + IVec3::new(x, y, z);
                of.grid.contains(neighbour) && of.labels[of.grid.index(neighbour)] == tissue as u8
            })
        })
    })
}

#[test]
fn every_voxel_has_one_label_and_every_label_its_name() {
    assert_eq!(TRUNK.labels.len(), TRUNK.grid.voxel_count());
    for (index, tissue) in Tissue::ALL.into_iter().enumerate() {
        assert_eq!(tissue as usize, index);
        assert_eq!(TRUNK.names[index].1, tissue as u8, "{tissue:?}");
        assert!(
            TRUNK.labels.contains(&(tissue as u8)),
            "there is no {tissue:?}"
        );
    }
    let names: HashSet<&str> = TRUNK.names.iter().map(|name| name.0).collect();
    assert_eq!(names.len(), Tissue::ALL.len());
    assert!(
        TRUNK
            .labels
            .iter()
            .all(|&label| usize::from(label) < Tissue::ALL.len())
    );
}

/// Two voxels below its surface each tissue shows its own value and noise, nothing else.
#[test]
fn intensities_inside_a_tissue_are_its_mean_and_the_noise() {
    let mut sums = [(0.0, 0.0, 0u32); Tissue::ALL.len()];
    for (voxel, tissue, value) in voxels(&TRUNK) {
        if !is_deep_inside(&TRUNK, voxel, tissue) {
            continue;
        }
        // the noise is bounded, and rounding adds half a unit
        let (core, surface) = tissue.intensity();
        let range = core - 3.5 * NOISE - 0.5..=surface + 3.5 * NOISE + 0.5;
        assert!(
            range.contains(&f32::from(value)),
            "{tissue:?} {voxel}: {value}"
        );
        let difference = f64::from(f32::from(value) - core);
        let sum = &mut sums[tissue as usize];
        *sum = (
            sum.0 + difference,
            sum.1 + difference * difference,
            sum.2 + 1,
        );
    }
    for tissue in Tissue::ALL.into_iter().filter(|tissue| !tissue.is_bone()) {
        let (sum, squares, count) = sums[tissue as usize];
        if count < 1000 {
            continue;
        }
        // five standard errors of the mean; of the deviation, about five as well
        let (noise, count) = (f64::from(NOISE), f64::from(count));
        let (mean, deviation) = (sum / count, (squares / count).sqrt());
        assert!(
            mean.abs() < 5.0 * noise / count.sqrt(),
            "{tissue:?}: mean off by {mean}"
        );
        assert!(
            (deviation - noise).abs() < 4.0 * noise / count.sqrt() + 0.01,
            "{tissue:?}: {deviation}"
        );
    }
}

/// What a threshold at 250 HU takes is bone, or touches it.
#[test]
fn bone_alone_is_denser_than_250_hu() {
    let is_bone = |voxel: IVec3| {
        TRUNK.grid.contains(voxel)
            && Tissue::ALL[usize::from(TRUNK.labels[TRUNK.grid.index(voxel)])].is_bone()
    };
    let near_bone = |voxel: IVec3| {
        (-1..=1).any(|z| (-1..=1).any(|y| (-1..=1).any(|x| is_bone(voxel + IVec3::new(x, y, z)))))
    };
    let (mut bone, mut dense_bone) = (0, 0);
    for (voxel, tissue, value) in voxels(&TRUNK) {
        let dense = value > 250;
        assert!(!dense || near_bone(voxel), "{tissue:?} {voxel}: {value}");
        bone += u32::from(tissue.is_bone());
        dense_bone += u32::from(tissue.is_bone() && dense);
    }
    // at the surface bone blends with what is around, so that a few voxels fall below
    assert!(
        f64::from(dense_bone) > 0.97 * f64::from(bone),
        "{dense_bone} of {bone}"
    );
}

#[test]
fn the_same_seed_gives_the_same_volume_on_any_number_of_threads() {
    let dimensions = UVec3::new(50, 41, 62);
    let make = |threads: usize, seed: u64| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool")
            .install(|| phantom(dimensions, seed).expect("valid dimensions"))
    };
    let (alone, together, other) = (make(1, 7), make(3, 7), make(2, 8));
    assert_eq!(alone.intensities.values(), together.intensities.values());
    assert_eq!(alone.labels, together.labels);

    // another seed is other noise in the same body
    assert_ne!(alone.intensities.values(), other.intensities.values());
    assert_eq!(alone.labels, other.labels);
}

/// LPS: x grows toward the patient's left, y toward the back, z toward the head.
#[test]
fn organs_lie_where_they_do_in_a_patient() {
    assert!(centroid(Tissue::Liver).x < -20.0);
    assert!(centroid(Tissue::Spleen).x > 60.0);
    assert!(centroid(Tissue::Stomach).x > 0.0);
    assert!(centroid(Tissue::Heart).x > 5.0);
    assert!(centroid(Tissue::Spine).y > centroid(Tissue::Sternum).y + 80.0);
    assert!(centroid(Tissue::SpinalCanal).y > centroid(Tissue::Discs).y);
    assert!(centroid(Tissue::Heart).z > centroid(Tissue::Liver).z);
    assert!(centroid(Tissue::Pelvis).z < centroid(Tissue::Kidneys).z);
    assert!(centroid(Tissue::Bladder).y < 0.0);

    // paired and middle parts are symmetric, to within a voxel
    for tissue in [
        Tissue::Ribs,
        Tissue::Spine,
        Tissue::Pelvis,
        Tissue::Femurs,
        Tissue::Sternum,
    ] {
        assert!(centroid(tissue).x.abs() < 2.5, "{tissue:?}");
    }
}

#[test]
fn ribs_enclose_the_lungs_and_there_are_two_lungs() {
    let (ribs, lungs) = (extent(Tissue::Ribs), extent(Tissue::Lungs));
    assert!(lungs.0.x > ribs.0.x && lungs.1.x < ribs.1.x);
    assert!(lungs.1.y < ribs.1.y);
    assert!(lungs.1.z < ribs.1.z);

    // a few voxels of the thin lower edge stand alone
    let mut sizes = pieces(&TRUNK, Tissue::Lungs);
    sizes.retain(|&size| size > 50);
    assert_eq!(sizes.len(), 2, "{sizes:?}");
    // the heart takes its room from the left one
    assert!(sizes[1] as f64 > 0.7 * sizes[0] as f64, "{sizes:?}");
}

#[test]
fn there_are_twelve_pairs_of_ribs_and_one_of_other_bones() {
    // finer voxels, so that gaps between ribs are open
    let fine = phantom(UVec3::new(256, 180, 346), 1).expect("valid dimensions");
    let large = |tissue| {
        pieces(&fine, tissue)
            .into_iter()
            .filter(|&size| size > 200)
            .count()
    };
    assert_eq!(large(Tissue::Ribs), 24, "{:?}", pieces(&fine, Tissue::Ribs));
    assert_eq!(large(Tissue::Femurs), 2);
    assert_eq!(large(Tissue::Pelvis), 2);
    assert_eq!(large(Tissue::Sternum), 1);
}

/// Adult volumes [ml] of textbooks, with room for a slim and simplified body.
#[test]
fn organs_have_the_size_of_organs() {
    let usual = [
        (Tissue::Liver, 1000.0..2000.0),
        (Tissue::Spleen, 100.0..350.0),
        (Tissue::Kidneys, 200.0..450.0),
        (Tissue::Heart, 400.0..900.0),
        (Tissue::Lungs, 2000.0..5500.0),
        (Tissue::Bladder, 80.0..400.0),
    ];
    for (tissue, range) in usual {
        let volume = millilitres(&TRUNK, tissue);
        assert!(range.contains(&volume), "{tissue:?}: {volume} ml");
    }
}

/// The body is given in mm, so its volumes do not depend on the voxels.
#[test]
fn volumes_in_millilitres_are_the_same_at_every_resolution() {
    let coarse = phantom(UVec3::new(121, 87, 163), 1).expect("valid dimensions");
    for tissue in Tissue::ALL {
        let (fine, coarse) = (millilitres(&TRUNK, tissue), millilitres(&coarse, tissue));
        // counting voxels errs by chance at the surface: 1 ml, and 3 % of thin structures
        assert!(
            (fine - coarse).abs() < 1.0 + 0.03 * fine,
            "{tissue:?}: {fine} and {coarse} ml"
        );
    }
}

#[test]
fn the_grid_covers_the_field_of_view_around_zero() {
    let grid = &TRUNK.grid;
    let corner = grid.patient_from_grid().transform_point3(DVec3::ZERO);
    let size = grid.dimensions().as_dvec3() * grid.spacing();
    // 1e-9 mm is rounding
    assert!((corner + FIELD_OF_VIEW / 2.0).length() < 1e-9);
    assert!((size - FIELD_OF_VIEW).length() < 1e-9);

    // the body touches the ends only, never the sides
    let last = grid.dimensions().as_ivec3() - 1;
    for (voxel, tissue, _) in voxels(&TRUNK) {
        let at_side = voxel.x == 0 || voxel.y == 0 || voxel.x == last.x || voxel.y == last.y;
        assert!(!at_side || tissue == Tissue::Air, "{tissue:?} at {voxel}");
    }
}

#[test]
fn dimensions_of_no_grid_are_refused() {
    assert!(phantom(UVec3::new(64, 0, 64), 1).is_err());
    assert!(phantom(UVec3::new(70_000, 8, 8), 1).is_err());
    assert!(phantom(UVec3::ONE, 1).is_ok());
}

#[test]
fn its_bones_alone_are_those_of_its_labels() {
    let dimensions = glam::UVec3::new(67, 41, 90);
    let whole = phantom(dimensions, 1).unwrap();
    let (grid, bits) = palpate_volume::phantom::bones(dimensions).unwrap();
    assert_eq!(grid, whole.grid);
    for (voxel, tissue, _) in voxels(&whole) {
        let bone = matches!(
            tissue,
            Tissue::Ribs
                | Tissue::Sternum
                | Tissue::Spine
                | Tissue::Pelvis
                | Tissue::Shoulders
                | Tissue::Femurs
        );
        assert_eq!(bits.is_solid(voxel), bone, "{voxel} {tissue:?}");
    }
}
