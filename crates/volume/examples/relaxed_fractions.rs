//! What it costs to work out the fractions of a mask: all of them, and around an edit.
//!
//! The mask is a file of one byte per voxel, x fastest, 0 where free:
//!
//!     cargo run --release -p palpate-volume --example relaxed_fractions mask.raw 512 512 133 0.7 0.7 2.5
#![expect(clippy::print_stdout, reason = "figures are what this example is for")]

use std::error::Error;
use std::time::Instant;

use glam::{IVec3, Vec3};
use palpate_volume::occupancy_fractions::OccupancyFractions;
use palpate_volume::relax::{regions, relaxed_fractions};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

/// Radius of the hole that the edit makes [mm].
const HOLE: f32 = 3.5;
/// How far from a change fractions are worked out again [voxels].
const REACH: i32 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [path, sizes @ ..] = &given[..] else {
        return Err("a file, three counts and three sides [mm] are wanted".into());
    };
    let number = |place: usize| -> Result<f32, Box<dyn Error>> {
        Ok(sizes
            .get(place)
            .ok_or("three counts and three sides are wanted")?
            .parse()?)
    };
    let dimensions = Vec3::new(number(0)?, number(1)?, number(2)?).as_uvec3();
    let spacing = Vec3::new(number(3)?, number(4)?, number(5)?);
    let mask = Segment::from_mask(dimensions, &std::fs::read(path)?)?;
    let bits = mask.occupancy();

    let began = Instant::now();
    let mut fractions = OccupancyFractions::unknown(dimensions);
    let regions = regions(bits);
    let mut slowest = 0.0_f64;
    for region in &regions {
        let known = fractions.clone();
        let one = Instant::now();
        for mut swap in relaxed_fractions(bits, spacing, region, &known) {
            fractions.swap(&mut swap);
        }
        slowest = slowest.max(one.elapsed().as_secs_f64());
    }
    let known = known_voxels(&fractions);
    println!(
        "{} regions, {known} voxels at the surface: {:.1} s, the slowest {:.0} ms; {:.1} MB beside \
         {:.1} MB of bits",
        regions.len(),
        began.elapsed().as_secs_f64(),
        1e3 * slowest,
        fractions.memory_bytes() as f64 / 1e6,
        bits.memory_bytes() as f64 / 1e6,
    );

    let mut drilled = mask.clone();
    let Some(hole) = hole(&mask, spacing) else {
        return Ok(());
    };
    let began = Instant::now();
    let middle = 0.5 * (hole.min + hole.max).as_vec3();
    let inside = |voxel: IVec3| ((voxel.as_vec3() + 0.5 - middle) * spacing).length() < HOLE;
    drilled = Segment::from_fn(dimensions, |voxel| {
        drilled.contains(voxel) && !inside(voxel)
    });
    println!(
        "(the hole took {:.0} ms to make)",
        1e3 * began.elapsed().as_secs_f64()
    );
    let mut times: Vec<f64> = (0..9)
        .map(|_| {
            let began = Instant::now();
            let again = relaxed_fractions(
                drilled.occupancy(),
                spacing,
                &hole.dilate(REACH),
                &fractions,
            );
            assert!(!again.is_empty(), "a hole has a surface");
            began.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("around a hole of {HOLE} mm: {:.1} ms", 1e3 * times[4]);
    Ok(())
}

fn known_voxels(fractions: &OccupancyFractions) -> usize {
    let bricks = fractions.bricks().entries().iter().flatten();
    bricks
        .map(|brick| brick.0.iter().filter(|byte| **byte != 0).count())
        .sum()
}

/// A box of a hole in the surface, half way up the mask.
fn hole(mask: &Segment, spacing: Vec3) -> Option<VoxelBox> {
    let all = mask.bounding_box()?;
    let z = (all.min.z + all.max.z) / 2;
    let slice = VoxelBox::new(all.min.with_z(z), all.max.with_z(z + 1));
    let first = slice.voxels().find(|voxel| mask.contains(*voxel))?;
    let reach = (HOLE / spacing).ceil().as_ivec3();
    let grid = VoxelBox::of_dimensions(mask.dimensions());
    Some(VoxelBox::new(first - reach, first + reach + 1).intersect(&grid))
}
