//! Draws a picture: bands of rows on all threads, each in packets of eight rays.

use std::ops::Range;

use glam::{Vec3, Vec4};
use palpate_volume::simd_dispatch;
use palpate_volume::simd_dispatch::SimdLevel;
use rayon::prelude::*;

use crate::appearance::Blend;
use crate::camera::{Camera, RayFan};
#[cfg(target_arch = "x86_64")]
use crate::lanes::Avx2;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Plain};
use crate::light_volume::{LightLookup, LightVolume};
use crate::lighting::Light;
use crate::march::{CLEAR_ENOUGH, Layers, PACKET, Packet, Pixels, Seen, seen_along};
use crate::part::Part;
use crate::picture::Picture;
use crate::prepared::Prepared;
use crate::scene::Scene;
use crate::second::SecondShading;
use crate::shading::{FAR_AWAY, Shading};
use crate::stop::Stop;
use crate::surfaces::{BandFragments, DrawnSurface, OnScreen};

/// Rows of a band, the portion of a thread.
const BAND: usize = 8;

/// What is drawn of a scene, from where, and how finely.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// From where.
    pub camera: Camera,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// The pixels that are drawn; none: all.
    pub part: Option<Part>,
    /// Steps for each smallest voxel edge.
    pub steps_per_voxel: f32,
    /// Shift within the pixel, −½ to ½ to the right and down, for averaging several pictures.
    pub shift: (f32, f32),
    /// Number of the noise pattern by which rays start at a share of a step; none: at half of one.
    pub noise: Option<u32>,
    /// Leaves out the occlusion by the nearest voxels.
    pub is_in_haste: bool,
    /// The widest vectors that are used.
    pub level: SimdLevel,
}

/// Draws a picture, or the part that was asked for; none where `stop` said so meanwhile.
///
/// # Panics
/// Where the picture has no such part.
pub fn draw(
    scene: &Scene,
    prepared: &Prepared,
    light: Option<&LightVolume>,
    request: &Request,
    stop: Stop<'_>,
) -> Option<Picture> {
    let fan = RayFan::new(&request.camera, scene.grid(), request.size);
    let alone = shading_of(scene, prepared, light, request, &fan);
    let second = scene.second.as_deref().map(|second| SecondShading {
        second,
        shading: second.shading(&alone),
    });
    let shading = Shading {
        second: second.as_ref(),
        ..alone
    };
    let on_screen = surfaces_on_screen(scene, prepared, request);
    let part = request.part.unwrap_or(Part::whole(request.size));
    assert!(part.is_of(request.size), "a part of no such picture");
    let mut picture = Picture::clear(part.size.into());
    let band = BAND * part.size.x as usize;
    let colours = picture.colours.par_chunks_mut(band);
    let depths = picture.depths.par_chunks_mut(band);
    let segments = picture.segments.par_chunks_mut(band);
    let stopped = colours.zip(depths).zip(segments).enumerate().try_for_each(
        |(number, ((colours, depths), segments))| {
            if stop() {
                return Err(());
            }
            // parts begin with a band
            let number = part.first.y as usize / BAND + number;
            let band = Band {
                columns: part.first.x..part.first.x + part.size.x,
                first: (number * BAND) as u32,
                colours,
                depths,
                segments,
            };
            let fragments = on_screen
                .as_ref()
                .filter(|it| it.has_any(number))
                .map(|it| {
                    BandFragments::new(it, &shading, (&fan, request.shift), (number, band.rows()))
                });
            let job = Job {
                shading: &shading,
                fan: &fan,
                shift: request.shift,
                noise: request.noise,
                fragments: fragments.as_ref(),
            };
            draw_band(job, band, request.level);
            Ok(())
        },
    );
    stopped.is_ok().then_some(picture)
}

/// The triangles of a picture; none where there are none.
fn surfaces_on_screen<'a>(
    scene: &'a Scene,
    prepared: &'a Prepared,
    request: &Request,
) -> Option<OnScreen<'a>> {
    let surfaces = DrawnSurface::all(scene, prepared);
    (!surfaces.is_empty()).then(|| OnScreen::new(surfaces, request, BAND as u32))
}

/// Draws the mean of several pictures, each with rays through another place of every pixel and, where there is noise, with
/// another pattern; none where `stop` said so meanwhile.
pub fn draw_averaged(
    scene: &Scene,
    prepared: &Prepared,
    light: Option<&LightVolume>,
    request: &Request,
    samples: u32,
    stop: Stop<'_>,
) -> Option<Picture> {
    let mut sum = draw(scene, prepared, light, request, stop)?;
    for sample in 1..samples {
        let shifted = Request {
            shift: (halton(sample, 2) - 0.5, halton(sample, 3) - 0.5),
            noise: request.noise.map(|first| first + sample),
            ..*request
        };
        let picture = draw(scene, prepared, light, &shifted, stop)?;
        for (sum, colour) in sum.colours.iter_mut().zip(picture.colours) {
            *sum = (Vec4::from(*sum) + Vec4::from(colour)).into();
        }
    }
    let share = 1.0 / samples.max(1) as f32;
    for colour in &mut sum.colours {
        *colour = (Vec4::from(*colour) * share).into();
    }
    Some(sum)
}

/// Numbers that cover 0 to 1 evenly, however many of them are taken. Source: Halton, Numerische Mathematik 2 (1960).
fn halton(index: u32, base: u32) -> f32 {
    let (mut left, mut share, mut number) = (index, 1.0, 0.0);
    while left > 0 {
        share /= base as f32;
        number += share * (left % base) as f32;
        left /= base;
    }
    number
}

/// Some rows of a picture.
struct Band<'a> {
    /// In the whole picture.
    columns: Range<u32>,
    /// The first row, in the whole picture.
    first: u32,
    colours: &'a mut [[f32; 4]],
    depths: &'a mut [f32],
    segments: &'a mut [u8],
}

/// What all bands of a picture have in common.
#[derive(Clone, Copy)]
struct Job<'a> {
    shading: &'a Shading<'a>,
    fan: &'a RayFan,
    shift: (f32, f32),
    noise: Option<u32>,
    /// Surfaces in the band.
    fragments: Option<&'a BandFragments<'a>>,
}

#[cfg(target_arch = "x86_64")]
simd_dispatch! {
    fn draw_band(job: Job<'_>, band: Band<'_>, level: SimdLevel) =
        [avx2 => rows_avx2] rows_plain, at level
}

#[cfg(not(target_arch = "x86_64"))]
fn draw_band(job: Job<'_>, band: Band<'_>, level: SimdLevel) {
    rows_plain(job, band, level);
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn rows_avx2(job: Job<'_>, band: Band<'_>, _: SimdLevel) {
    rows::<Avx2>(job, band);
}

fn rows_plain(job: Job<'_>, band: Band<'_>, _: SimdLevel) {
    rows::<Plain>(job, band);
}

#[inline(always)]
fn rows<L: Gather>(job: Job<'_>, mut band: Band<'_>) {
    let columns = band.columns.len() as u32;
    let rows = band.rows().len() as u32;
    let mut row = 0;
    while row < rows {
        let mut column = 0;
        while column < columns {
            let pixels = Pixels {
                column: band.columns.start + column,
                row: band.first + row,
                shift: job.shift,
                noise: job.noise,
            };
            let mut packet = Packet::<L>::new(job.fan, pixels, job.shading);
            let layers = job
                .fragments
                .and_then(|it| Layers::new(it, job.shading, &pixels, packet.stretch));
            let mut reaches = packet.enter.less(packet.leave);
            let mut beside = packet.beside(job.fan, job.shading);
            if let Some(beside) = &beside {
                reaches = reaches | beside.rays.enter.less(beside.rays.leave);
            }
            if layers.is_some() || reaches.any() {
                let layers = layers.unwrap_or_else(Layers::none);
                packet.leave = packet.leave.min(layers.end);
                if let Some(beside) = &mut beside {
                    beside.rays.leave = beside.rays.leave.min(layers.end);
                }
                let seen = seen_along(job.shading, &packet, beside.as_ref(), layers);
                band.put(&job, (column, row), &packet, &seen);
            }
            column += PACKET.0;
        }
        row += PACKET.1;
    }
}

impl Band<'_> {
    /// Its rows in the picture.
    fn rows(&self) -> Range<u32> {
        let count = self.colours.len() / self.columns.len();
        self.first..self.first + count as u32
    }

    /// Writes a packet's pixels; those beyond the picture are left out.
    #[inline(always)]
    fn put<L: Gather>(
        &mut self,
        job: &Job<'_>,
        (column, row): (u32, u32),
        packet: &Packet<L>,
        seen: &Seen<L>,
    ) {
        let columns = self.columns.len() as u32;
        let opacity = opacity_of(job.shading.blend, seen);
        let light = weighted(job.shading.blend, seen, opacity);
        let (red, green, blue) = (light.x.store(), light.y.store(), light.z.store());
        let opacity = opacity.store();
        let far = L::Float::splat(f32::INFINITY);
        let zero = L::Float::splat(0.0);
        let haze = far.or_else(seen.haze.less(zero), zero - seen.haze.div(packet.stretch));
        let is_haze = seen.depth.less(zero);
        let depths = haze
            .or_else(is_haze, seen.depth.div(packet.stretch))
            .store();
        let codes = seen.segment.store();
        for lane in 0..LANES as u32 {
            let (x, y) = (column + lane % PACKET.0, row + lane / PACKET.0);
            let pixel = (x + columns * y) as usize;
            if x >= columns || pixel >= self.colours.len() {
                continue;
            }
            let lane = lane as usize;
            self.colours[pixel] = [red[lane], green[lane], blue[lane], opacity[lane]];
            self.depths[pixel] = depths[lane];
            self.segments[pixel] = job.shading.segments.number(codes[lane]);
        }
    }
}

#[inline(always)]
fn opacity_of<L: Gather>(blend: Blend, seen: &Seen<L>) -> L::Float {
    let one = L::Float::splat(1.0);
    if blend == Blend::Emission {
        // light is added to what is behind, and covers it as far as it outshines it
        let brightest = seen.light.x.max(seen.light.y).max(seen.light.z);
        return (one - seen.clarity).max(brightest.min(one));
    }
    // what was left out would have looked like the rest
    let ended = seen.clarity.at_most(Floats::splat(CLEAR_ENOUGH));
    one.or_else(ended, one - seen.clarity)
}

/// Light multiplied by opacity.
#[inline(always)]
fn weighted<L: Gather>(blend: Blend, seen: &Seen<L>, opacity: L::Float) -> crate::lanes::Vector<L> {
    if matches!(
        blend,
        Blend::Emission | Blend::Mip | Blend::MinIp | Blend::Average
    ) {
        return seen.light;
    }
    let covered = (L::Float::splat(1.0) - seen.clarity).max(Floats::splat(1e-6));
    seen.light.scaled(opacity.div(covered))
}

fn shading_of<'a>(
    scene: &'a Scene,
    prepared: &'a Prepared,
    light: Option<&'a LightVolume>,
    request: &Request,
    fan: &RayFan,
) -> Shading<'a> {
    let appearance = &prepared.appearance;
    let spacing = scene.field.spacing();
    let lighting = appearance.lighting;
    let shades = if appearance.blend.is_lit() {
        (lighting.occlusion, lighting.shadow)
    } else {
        (0.0, 0.0)
    };
    let half = appearance.slab.map(|slab| slab as f32 / 2.0);
    Shading {
        blend: appearance.blend,
        field: &scene.field,
        displaced: scene.displaced.as_ref(),
        second: None,
        own_turns: None,
        segments: &prepared.segments,
        transfer: &prepared.transfer,
        empty: &prepared.empty,
        light: Light::new(fan, lighting),
        lookup: LightLookup::new(light, scene.field.dimensions().as_vec3(), spacing, shades),
        planes: &prepared.planes,
        density: appearance.density,
        edge_gradient: appearance.edge_gradient as f32,
        flat_share: 1.0 - lighting.edges,
        grey: prepared.grey,
        tissue_from: prepared.tissue_from,
        iso_colour: appearance.iso_colour,
        step: smallest(spacing) / request.steps_per_voxel,
        slab: half.map_or((-FAR_AWAY, FAR_AWAY), |half| {
            (fan.middle - half, fan.middle + half)
        }),
        is_in_haste: request.is_in_haste,
    }
}

fn smallest(spacing: Vec3) -> f32 {
    spacing.min_element()
}
