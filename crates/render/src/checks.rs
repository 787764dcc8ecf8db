//! What a camera and an appearance have to be.

use glam::{DVec3, Vec3};
use thiserror::Error;

use crate::appearance::{Appearance, Blend};
use crate::camera::Camera;
use crate::second::{SecondAppearance, Turns};

/// A camera or an appearance of which no picture can be drawn.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CheckError {
    /// The axes of a camera are not three unit vectors at right angles, or not finite.
    #[error(
        "camera axes right {right}, up {up}, back {back} given; allowed: unit vectors at right angles"
    )]
    Axes {
        /// To the right.
        right: DVec3,
        /// Upward.
        up: DVec3,
        /// Toward the person.
        back: DVec3,
    },
    /// A number out of its range.
    #[error("{name} {given} given; allowed: {allowed}")]
    Number {
        /// What it is.
        name: &'static str,
        /// The number.
        given: f64,
        /// Its range.
        allowed: &'static str,
    },
    /// Points of a transfer function that describe none.
    #[error(
        "transfer function of {given} points given; allowed: at least 2, by rising value, finite, extinction from 0 on"
    )]
    Transfer {
        /// Number of points.
        given: usize,
    },
}

/// Farthest place and largest length that a picture can be of [mm].
const FARTHEST: f64 = 1e7;

fn number(
    name: &'static str,
    given: f64,
    is_allowed: bool,
    allowed: &'static str,
) -> Result<(), CheckError> {
    is_allowed.then_some(()).ok_or(CheckError::Number {
        name,
        given,
        allowed,
    })
}

fn colour(name: &'static str, given: Vec3) -> Result<(), CheckError> {
    given.to_array().into_iter().try_for_each(|channel| {
        let is_light = channel >= 0.0 && channel.is_finite();
        number(name, f64::from(channel), is_light, "from 0 on, finite")
    })
}

impl Camera {
    /// Refuses a camera that sees nothing.
    ///
    /// # Errors
    /// Where a number is not finite, too large, or an axis no unit vector at right angles to the others.
    pub fn check(&self) -> Result<(), CheckError> {
        let Self {
            right, up, back, ..
        } = *self;
        let units = [right, up, back].map(|axis| (axis.length() - 1.0).abs());
        let angles = [right.dot(up), up.dot(back), back.dot(right)].map(f64::abs);
        // what is not finite is not below
        if !units.into_iter().chain(angles).all(|error| error < 1e-3) {
            return Err(CheckError::Axes { right, up, back });
        }
        let near = |length: f64| length > 0.0 && length < FARTHEST;
        for place in self.target.to_array() {
            // what is no number is not below
            let is_near = place.abs() < FARTHEST;
            number("camera target", place, is_near, "within 10 km [mm]")?;
        }
        number(
            "camera distance",
            self.distance,
            near(self.distance),
            "above 0, at most 10 km [mm]",
        )?;
        let parallel = self.parallel.unwrap_or(1.0);
        number(
            "parallel distance",
            parallel,
            near(parallel),
            "above 0, at most 10 km [mm]",
        )?;
        let is_field = self.field > 0.0 && self.field < std::f64::consts::PI;
        number(
            "angle of view",
            self.field,
            is_field,
            "above 0, below pi [rad]",
        )?;
        let is_eye = self.aside.abs() <= 1.0;
        number("eye aside", self.aside, is_eye, "-1 to 1")
    }
}

impl Appearance {
    /// Refuses an appearance that is none.
    ///
    /// # Errors
    /// Where a number is not finite or out of its range, or the transfer function has fewer than two points.
    pub fn check(&self) -> Result<(), CheckError> {
        self.check_transfer()?;
        let rising = |name, given: f32| {
            number(
                name,
                f64::from(given),
                (0.0..=1e6).contains(&given),
                "0 to 1e6",
            )
        };
        rising("density", self.density)?;
        let light = &self.lighting;
        rising("ambient light", light.ambient)?;
        rising("diffuse light", light.diffuse)?;
        rising("specular light", light.specular)?;
        rising("shininess", light.shininess)?;
        for (name, share) in [
            ("edges", light.edges),
            ("occlusion", light.occlusion),
            ("shadow", light.shadow),
        ] {
            number(
                name,
                f64::from(share),
                (0.0..=1.0).contains(&share),
                "0 to 1",
            )?;
        }
        let gradient = self.edge_gradient;
        let is_gradient = gradient.is_finite() && gradient > 0.0;
        number("edge gradient", gradient, is_gradient, "above 0, finite")?;
        let window = self.window.0;
        let is_window = window.is_finite() && window > 0.0;
        number("window", window, is_window, "above 0, finite")?;
        for (name, value) in [
            ("level", self.window.1),
            ("value of the iso-surface", self.iso_value),
            ("value of tissue", self.tissue_from),
        ] {
            number(name, value, value.is_finite(), "finite")?;
        }
        let slab = self.slab.unwrap_or(1.0);
        number("slab", slab, slab > 0.0 && slab.is_finite(), "above 0 [mm]")?;
        colour("colour of the iso-surface", self.iso_colour)?;
        for segment in &self.segments {
            let id = segment.id;
            number("segment", f64::from(id), id > 0, "1 to 255")?;
            colour("colour of a segment", segment.colour)?;
            rising("ambient light of a segment", segment.ambient)?;
            rising("specular light of a segment", segment.specular)?;
            let (low, high) = segment.range.unwrap_or((0.0, 0.0));
            number("lower limit", low, !low.is_nan(), "a number")?;
            number("upper limit", high, !high.is_nan(), "a number")?;
        }
        for surface in &self.surfaces {
            let opacity = surface.opacity;
            let is_opacity = opacity > 0.0 && opacity <= 1.0;
            number(
                "opacity of a surface",
                f64::from(opacity),
                is_opacity,
                "above 0, at most 1",
            )?;
            colour("colour of a surface", surface.colour)?;
            rising("ambient light of a surface", surface.ambient)?;
            rising("specular light of a surface", surface.specular)?;
        }
        for plane in &self.clip {
            let length = plane.normal.length();
            let is_unit = (length - 1.0).abs() < 1e-3 && plane.offset.is_finite();
            number("length of a plane's normal", length, is_unit, "1")?;
        }
        Ok(())
    }

    fn check_transfer(&self) -> Result<(), CheckError> {
        let points = &self.transfer;
        let are_rising = points.windows(2).all(|pair| pair[0].value <= pair[1].value);
        let are_finite = points.iter().all(|point| {
            point.value.is_finite()
                && point.extinction >= 0.0
                && point.extinction.is_finite()
                && point.colour.cmpge(Vec3::ZERO).all()
                && point.colour.is_finite()
        });
        let spans =
            points.first().map(|point| point.value) < points.last().map(|point| point.value);
        if are_rising && are_finite && spans {
            return Ok(());
        }
        Err(CheckError::Transfer {
            given: points.len(),
        })
    }
}

impl SecondAppearance {
    /// Refuses an appearance that is none.
    ///
    /// # Errors
    /// Where a number is not finite or out of its range, or the transfer function has fewer than two points.
    pub fn check(&self) -> Result<(), CheckError> {
        let opacity = f64::from(self.opacity);
        number("opacity", opacity, (0.0..=1.0).contains(&opacity), "0 to 1")?;
        if let Turns::Cells(edge) = self.turns {
            let edge = f64::from(edge);
            let allowed = "0.1 to 10000 mm";
            number("cells", edge, (0.1..=1e4).contains(&edge), allowed)?;
        }
        self.alone(Blend::Shaded).check()
    }
}
