//! A picture: colour, depth and segment of each pixel, and its colours on a screen.

use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// What stands behind everything, linear RGB: in the middle and toward the edges; as the page has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// A little above the middle of the picture.
    pub centre: Vec3,
    /// Toward its corners.
    pub edge: Vec3,
}

/// Pixels row by row from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Across and down.
    pub size: (u32, u32),
    /// Linear colour multiplied by opacity, and opacity.
    pub colours: Vec<[f32; 4]>,
    /// Distance from the eye along the direction of view where a ray became more opaque than clear [mm]; infinite where
    /// it has not. In modes that show all of a ray, negative: that of the middle of what is seen through.
    pub depths: Vec<f32>,
    /// The segment there; 0 of none.
    pub segments: Vec<u8>,
}

impl Picture {
    /// A clear picture.
    #[must_use]
    pub fn clear(size: (u32, u32)) -> Self {
        let count = size.0 as usize * size.1 as usize;
        Self {
            size,
            colours: vec![[0.0; 4]; count],
            depths: vec![f32::INFINITY; count],
            segments: vec![0; count],
        }
    }

    /// Bytes of sRGB for each pixel: over a ground, or with their opacity. `bends`: highlights are bent instead of clipped.
    #[must_use]
    pub fn to_screen(&self, ground: Option<Ground>, bends: bool) -> Vec<[u8; 4]> {
        let columns = self.size.0 as usize;
        let size = Vec2::new(self.size.0 as f32, self.size.1 as f32);
        let pixels = self.colours.par_iter().enumerate();
        pixels
            .map(|(i, &colour)| {
                let pixel = Vec2::new((i % columns) as f32, (i / columns) as f32) + 0.5;
                on_screen(Vec4::from(colour), pixel, size, ground, bends)
            })
            .collect()
    }
}

fn on_screen(
    colour: Vec4,
    pixel: Vec2,
    size: Vec2,
    ground: Option<Ground>,
    bends: bool,
) -> [u8; 4] {
    let light = if bends {
        softened(colour.truncate())
    } else {
        colour.truncate()
    };
    let bytes = |colour: Vec3| {
        (colour * 255.0)
            .round()
            .clamp(Vec3::ZERO, Vec3::splat(255.0))
    };
    let Some(ground) = ground else {
        let own = bytes(srgb_from_linear(light / colour.w.max(1e-4)));
        return [
            own.x as u8,
            own.y as u8,
            own.z as u8,
            (colour.w * 255.0).round() as u8,
        ];
    };
    let place = pixel / size - Vec2::new(0.5, 0.48);
    let away = (place * Vec2::new(1.1, 1.25)).length();
    let share = (away / 0.85).clamp(0.0, 1.0);
    let behind = ground
        .centre
        .lerp(ground.edge, share * share * (3.0 - 2.0 * share));
    // less than one step of noise hides the steps of a dark gradient
    let grain = (52.982_918 * pixel.dot(Vec2::new(0.067_110_56, 0.005_837_15)).fract()).fract();
    let shown = srgb_from_linear(light + (1.0 - colour.w) * behind) + (grain - 0.5) / 255.0;
    let shown = bytes(shown);
    [shown.x as u8, shown.y as u8, shown.z as u8, 255]
}

fn srgb_from_linear(colour: Vec3) -> Vec3 {
    let bent = |c: f32| {
        if c <= 0.003_130_8 {
            12.92 * c
        } else {
            1.055 * c.powf(1.0 / 2.4) - 0.055
        }
    };
    let c = colour.clamp(Vec3::ZERO, Vec3::ONE);
    Vec3::new(bent(c.x), bent(c.y), bent(c.z))
}

/// Bends highlights; identity below 0.7.
fn softened(colour: Vec3) -> Vec3 {
    let over = (colour - 0.7).max(Vec3::ZERO);
    colour.min(Vec3::splat(0.7)) + 0.3 * (1.0 - (-over / 0.3).exp())
}
