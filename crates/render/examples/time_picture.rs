//! Draws raw values and says how long it took: FILE NX NY NZ SX SY SZ WIDTH HEIGHT OUT.ppm [MODE] [light=CELLS] [plain]
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    missing_docs,
    reason = "an example"
)]
use glam::{DMat3, DVec3, UVec3, Vec3};
use palpate_render::appearance::{Appearance, Blend, ControlPoint, Lighting};
use palpate_render::camera::Camera;
use palpate_render::draw::{Request, draw};
use palpate_render::light_volume::LightVolume;
use palpate_render::picture::Ground;
use palpate_render::prepared::Prepared;
use palpate_render::scene::Scene;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;
use std::io::Write;
use std::time::Instant;

fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n = |i: usize| a[i].parse::<u32>().unwrap();
    let f = |i: usize| a[i].parse::<f64>().unwrap();
    let dims = UVec3::new(n(2), n(3), n(4));
    let bytes = std::fs::read(&a[1]).unwrap();
    let values: Vec<i16> = bytes
        .chunks_exact(2)
        .map(|b| i16::from_le_bytes([b[0], b[1]]))
        .collect();
    let spacing = DVec3::new(f(5), f(6), f(7));
    let grid = Grid::new(dims, spacing, DVec3::ZERO, DMat3::IDENTITY).unwrap();
    let scan = Intensities::new(dims, values, 1.0, 0.0).unwrap();
    let t = Instant::now();
    let scene = Scene::new(Voxels::new(grid, scan).unwrap()).unwrap();
    println!("scene {:?}", t.elapsed());
    let (level, window) = (f(11), f(12));
    let soft = 0.004_f64 * (1.6_f64 / 0.004).powf(0.28);
    let stops = [
        (-3.0, 0xb8705a, 0.0, 0.0),
        (-1.9, 0xcf9272, 0.0, 0.0),
        (-0.95, 0xe6bd8c, 0.5, 0.0),
        (-0.55, 0xe9c592, 0.35, 0.0),
        (-0.2, 0xc47a5c, 0.8, 0.0),
        (0.15, 0xab4a3f, 1.0, 0.0),
        (0.55, 0xb53c33, 1.1, 0.0),
        (0.9, 0xd9a184, 1.1, 0.0),
        (1.0, 0xe8cfa9, 1.1, 0.4),
        (1.3, 0xefdfc0, 1.1, 1.0),
        (3.0, 0xf4e9d2, 1.1, 2.5),
        (8.0, 0xfdf8ec, 1.1, 4.0),
    ];
    let lin = |c: u32| {
        let c = f64::from(c) / 255.0;
        (if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }) as f32
    };
    let transfer: Vec<ControlPoint> = stops
        .iter()
        .map(|&(at, rgb, s, b): &(f64, u32, f64, f64)| ControlPoint {
            value: level + (at - 0.5) * window,
            colour: Vec3::new(lin(rgb >> 16), lin(rgb >> 8 & 255), lin(rgb & 255)),
            extinction: (s * soft).max(b) as f32,
        })
        .collect();
    let blend = match a.get(13).map(String::as_str) {
        Some("composite") => Blend::Composite,
        Some("absorption") => Blend::Absorption,
        Some("emission") => Blend::Emission,
        Some("mip") => Blend::Mip,
        Some("minip") => Blend::MinIp,
        Some("average") => Blend::Average,
        Some("iso") => Blend::Iso,
        _ => Blend::Shaded,
    };
    let appearance = Appearance {
        blend,
        density: if blend == Blend::Absorption {
            0.012
        } else {
            1.0
        },
        transfer,
        edge_gradient: 0.6 * window / 4.0,
        window: (1000.0, level),
        iso_value: level + 0.5 * window,
        iso_colour: Vec3::new(0.8, 0.7, 0.6),
        tissue_from: level - 1.3 * window,
        slab: None,
        lighting: Lighting::default(),
        segments: vec![],
        clip: vec![],
    };
    let t = Instant::now();
    let prepared = Prepared::new(&scene, appearance);
    println!("prepared {:?}", t.elapsed());
    let size = spacing * dims.as_dvec3();
    let back = DVec3::new(0.4, -0.9, 0.16).normalize();
    let right = DVec3::Z.cross(back).normalize();
    let camera = Camera {
        target: size / 2.0,
        distance: size.length() * 1.9,
        right,
        up: back.cross(right),
        back,
        field: 24_f64.to_radians(),
        parallel: None,
        aside: 0.0,
    };
    let level = if a.last().unwrap() == "plain" {
        SimdLevel::Plain
    } else {
        SimdLevel::widest()
    };
    let request = Request {
        camera,
        size: (n(8), n(9)),
        steps_per_voxel: 1.0,
        shift: (0.0, 0.0),
        noise: None,
        is_in_haste: false,
        level,
    };
    let cells = a.iter().find_map(|arg| arg.strip_prefix("light="));
    let light = cells.map(|cells| {
        let t = Instant::now();
        let go = || false;
        let most = cells.parse().unwrap();
        let light = LightVolume::new(&scene, &prepared, camera.lamp(), most, &go).unwrap();
        println!("light of {} {:?}", light.counts(), t.elapsed());
        let t = Instant::now();
        let turned = light.turn_lamp(&scene, &prepared, camera.lamp() + DVec3::X, &go);
        println!("another lamp {:?}", t.elapsed());
        let middle = dims.as_ivec3() / 2;
        let t = Instant::now();
        let edited = VoxelBox::new(middle, middle + 10);
        let followed = light.follow(&scene, &prepared, &edited, &go);
        println!("an edit {:?}", t.elapsed());
        assert!(turned.is_some() && followed.is_some());
        light
    });
    for divisor in [1, 1, 2, 3] {
        let request = Request {
            size: (n(8) / divisor, n(9) / divisor),
            ..request
        };
        let t = Instant::now();
        let picture = draw(&scene, &prepared, light.as_ref(), &request, &|| false).unwrap();
        println!("1/{divisor} {:?}", t.elapsed());
        if divisor == 1 {
            let ground = Ground {
                centre: Vec3::splat(0.03),
                edge: Vec3::splat(0.01),
            };
            let mut out = std::fs::File::create(&a[10]).unwrap();
            write!(out, "P6 {} {} 255\n", request.size.0, request.size.1).unwrap();
            let rgb: Vec<u8> = picture
                .to_screen(Some(ground), true)
                .iter()
                .flat_map(|p| [p[0], p[1], p[2]])
                .collect();
            out.write_all(&rgb).unwrap();
        }
    }
}
