//! Light of the picture: a lamp over the viewer's left shoulder, a soft sky and ground. Unit vectors along
//! the grid's axes; colours are linear. The page's shaders have the same (`shaders/light/light.glsl`).
//!
//! Source: Blinn, "Models of light reflection", SIGGRAPH (1977).

use glam::Vec3;

use crate::appearance::Lighting;
use crate::camera::RayFan;
use crate::lanes::{Floats, Lanes, Vector, power};

const LAMP: Vec3 = Vec3::new(1.06, 1.0, 0.92);
const SKY: Vec3 = Vec3::new(0.36, 0.38, 0.42);
const GROUND: Vec3 = Vec3::new(0.14, 0.11, 0.10);

/// Where the light comes from, and factors on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    lamp: Vec3,
    up: Vec3,
    factors: Lighting,
}

/// What reaches a place: fractions of the sky and of the lamp.
#[derive(Clone, Copy)]
pub(crate) struct Reaching<L: Lanes> {
    pub sky: L::Float,
    pub lamp: L::Float,
}

/// Factors of a segment on ambient and specular light.
#[derive(Clone, Copy)]
pub(crate) struct OwnFactors<L: Lanes> {
    pub ambient: L::Float,
    pub specular: L::Float,
}

impl Light {
    pub fn new(fan: &RayFan, factors: Lighting) -> Self {
        Self {
            lamp: fan.lamp,
            up: fan.up,
            factors,
        }
    }

    #[inline(always)]
    fn sky_at<L: Lanes>(&self, normal: Vector<L>) -> Vector<L> {
        let half = L::Float::splat(0.5);
        let share = half + half * normal.dot(Vector::splat(self.up));
        Vector::splat(GROUND).along(Vector::splat(SKY - GROUND), share)
    }

    /// The picture's factors with those of segments.
    #[inline(always)]
    fn with_own<L: Lanes>(&self, own: OwnFactors<L>) -> OwnFactors<L> {
        OwnFactors {
            ambient: own.ambient * Floats::splat(self.factors.ambient),
            specular: own.specular * Floats::splat(self.factors.specular),
        }
    }

    /// Strength of highlights whose sharpness is an exponent.
    #[inline(always)]
    fn highlight<L: Lanes>(&self, normal: Vector<L>, to_eye: Vector<L>, exponent: f32) -> L::Float {
        let halfway = (Vector::splat(self.lamp) + to_eye).normalized();
        let toward = normal.dot(halfway).max(Floats::splat(0.0));
        power::<L>(toward, exponent * self.factors.shininess)
    }

    /// A solid surface. `near`: the fraction of the sky that what stands close leaves it.
    #[inline(always)]
    pub fn on_surface<L: Lanes>(
        &self,
        colour: Vector<L>,
        normal: Vector<L>,
        to_eye: Vector<L>,
        near: L::Float,
        reaching: Reaching<L>,
        own: OwnFactors<L>,
    ) -> Vector<L> {
        let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
        let OwnFactors { ambient, specular } = self.with_own(own);
        let open = near.min(reaching.sky);
        let key = normal.dot(Vector::splat(self.lamp)).max(zero);
        let facing = normal.dot(to_eye).max(zero);
        let highlight = self.highlight(normal, to_eye, 28.0);
        let shine = L::Float::splat(0.16) * specular * highlight;

        let sky = self.sky_at(normal).scaled(ambient * open);
        let direct = Vector::splat(LAMP).scaled(
            L::Float::splat(0.82 * self.factors.diffuse)
                * key
                * reaching.lamp
                * (L::Float::splat(0.45) + L::Float::splat(0.55) * open),
        );
        // light scattered below the surface warms what is turned away and what is covered
        let rim = L::Float::splat(0.04) * (one - facing);
        let scattered = Vector::splat(Vec3::new(0.10, 0.055, 0.04)).scaled(one - open)
            + Vector::new(rim, rim, rim);
        let light = colour.times(sky + direct + scattered.scaled(ambient));
        let shine = shine * open * reaching.lamp;
        light + Vector::new(shine, shine, shine)
    }

    /// Translucent tissue. `boundary`: how much of a surface it is here, 0 to 1.
    #[inline(always)]
    pub fn on_tissue<L: Lanes>(
        &self,
        colour: Vector<L>,
        normal: Vector<L>,
        to_eye: Vector<L>,
        boundary: L::Float,
        reaching: Reaching<L>,
        own: OwnFactors<L>,
    ) -> Vector<L> {
        let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
        let OwnFactors { ambient, specular } = self.with_own(own);
        let wrapped = ((normal.dot(Vector::splat(self.lamp)) + Floats::splat(0.35))
            * Floats::splat(1.0 / 1.35))
        .max(zero);
        let grazing = one - normal.dot(to_eye).max(zero);
        let rim = L::Float::splat(0.18) * (grazing * grazing * grazing);
        let highlight = self.highlight(normal, to_eye, 36.0);
        let shine = L::Float::splat(0.22) * specular * highlight * reaching.lamp;

        let sky = (self.sky_at(normal) + Vector::new(rim, rim, rim)).scaled(ambient * reaching.sky);
        let lamp = Vector::splat(LAMP)
            .scaled(L::Float::splat(0.85 * self.factors.diffuse) * reaching.lamp * wrapped);
        let surface = colour.times(sky + lamp) + Vector::new(shine, shine, shine);
        // flat tissue has no direction: it glows with all of the light
        let glow = L::Float::splat(0.2) * ambient * reaching.sky
            + L::Float::splat(0.35 * self.factors.diffuse) * reaching.lamp;
        let flat = colour.scaled(glow);
        flat + (surface - flat).scaled(boundary)
    }
}
