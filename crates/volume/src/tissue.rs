//! How tissue resists a needle: what a segment is made of for the needle law.
//!
//! Units: mm, N, s. The figures of the presets are of the order that is measured with needles of
//! 0.7 to 1.3 mm; `docs/understand/needle.md` says which are measured and which are assumed.
//! Sources: Okamura, Simone, O'Leary, "Force modeling for needle insertion into soft tissue",
//! IEEE Trans. Biomed. Eng. 51 (2004); van Gerwen, Dankelman, van den Dobbelsteen, "Needle-tissue
//! interaction forces: a survey of experimental data", Med. Eng. Phys. 34 (2012).

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Tissues, each different from the others, that a needle can puncture at a time.
pub const MAX_TISSUES: usize = 32;

/// What a needle meets in a tissue that it can puncture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tissue {
    /// Force per deflection of the tissue under the tip [N/mm], > 0.
    pub linear: f64,
    /// What the square of the deflection adds [N/mm²], >= 0.
    pub quadratic: f64,
    /// Force at which the tip goes in [N], > 0.
    pub puncture: f64,
    /// Force at the tip while it cuts its way on [N]; at most `puncture`.
    pub cutting: f64,
    /// Friction of the shaft per length in the tissue [N/mm], >= 0.
    pub friction: f64,
    /// Stiffness against the side per length of shaft in the tissue [N/mm per mm], >= 0.
    pub lateral: f64,
    /// Share of the cutting force that a tip at rest loses, 0 to 1.
    pub relaxation: f64,
    /// Time in which that loss comes to 63 % [s], > 0.
    pub relaxation_secs: f64,
}

/// A figure of a tissue that is out of range or not a number.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{what} {given} of a tissue given; allowed: {allowed}")]
pub struct TissueError {
    /// Which figure, with its unit.
    pub what: &'static str,
    /// The value given.
    pub given: f64,
    /// What may be given.
    pub allowed: &'static str,
}

impl Tissue {
    /// Skin: the toughest layer, and thin.
    pub const SKIN: Self = Self {
        linear: 0.3,
        quadratic: 0.1,
        puncture: 2.0,
        cutting: 0.5,
        friction: 0.05,
        lateral: 0.1,
        relaxation: 0.3,
        relaxation_secs: 1.5,
    };
    /// Fat under the skin.
    pub const FAT: Self = Self {
        linear: 0.05,
        quadratic: 0.02,
        puncture: 0.3,
        cutting: 0.2,
        friction: 0.004,
        lateral: 0.005,
        relaxation: 0.3,
        relaxation_secs: 1.5,
    };
    /// Muscle across its fibres.
    pub const MUSCLE: Self = Self {
        linear: 0.1,
        quadratic: 0.05,
        puncture: 0.8,
        cutting: 0.5,
        friction: 0.02,
        lateral: 0.03,
        relaxation: 0.3,
        relaxation_secs: 1.5,
    };
    /// Liver: its capsule is punctured, its parenchyma is cut.
    pub const LIVER: Self = Self {
        linear: 0.1,
        quadratic: 0.05,
        puncture: 1.6,
        cutting: 0.9,
        friction: 0.012,
        lateral: 0.01,
        relaxation: 0.4,
        relaxation_secs: 2.0,
    };
    /// Presets by name. Bone is none of them: no needle punctures it.
    pub const PRESETS: [(&'static str, Self); 4] = [
        ("skin", Self::SKIN),
        ("fat", Self::FAT),
        ("muscle", Self::MUSCLE),
        ("liver", Self::LIVER),
    ];

    /// The preset of a name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        let mut presets = Self::PRESETS.into_iter();
        presets.find_map(|(known, tissue)| (known == name).then_some(tissue))
    }

    /// All figures, in the order of the fields.
    #[must_use]
    pub fn figures(&self) -> [f64; 8] {
        [
            self.linear,
            self.quadratic,
            self.puncture,
            self.cutting,
            self.friction,
            self.lateral,
            self.relaxation,
            self.relaxation_secs,
        ]
    }

    /// A tissue of its figures, in the order of the fields.
    #[must_use]
    #[rustfmt::skip]
    pub fn of_figures(
        [linear, quadratic, puncture, cutting, friction, lateral, relaxation, relaxation_secs]: [f64; 8],
    ) -> Self {
        Self { linear, quadratic, puncture, cutting, friction, lateral, relaxation, relaxation_secs }
    }

    /// Force of a deflection under the tip [N]; none without one.
    #[must_use]
    pub fn force(&self, deflection: f64) -> f64 {
        let deflection = deflection.max(0.0);
        deflection * (self.linear + self.quadratic * deflection)
    }

    /// The deflection [mm] that gives a force [N].
    #[must_use]
    pub fn deflection(&self, force: f64) -> f64 {
        let force = force.max(0.0);
        // the root of q x² + l x = f, in the form that bears q = 0
        let root = (self.linear * self.linear + 4.0 * self.quadratic * force).sqrt();
        2.0 * force / (self.linear + root)
    }

    /// Checks each figure.
    ///
    /// # Errors
    /// [`TissueError`] names the first that is not allowed.
    pub fn check(&self) -> Result<(), TissueError> {
        let positive = |given: f64| given > 0.0 && given <= 1e3;
        let not_negative = |given: f64| (0.0..=1e3).contains(&given);
        let rows = [
            ("stiffness [N/mm]", self.linear, positive(self.linear)),
            (
                "quadratic stiffness [N/mm²]",
                self.quadratic,
                not_negative(self.quadratic),
            ),
            ("puncture force [N]", self.puncture, positive(self.puncture)),
            (
                "friction [N/mm]",
                self.friction,
                not_negative(self.friction),
            ),
            (
                "lateral stiffness [N/mm²]",
                self.lateral,
                not_negative(self.lateral),
            ),
            (
                "relaxation time [s]",
                self.relaxation_secs,
                positive(self.relaxation_secs),
            ),
        ];
        for (what, given, fits) in rows {
            if !fits {
                let allowed = "finite, not negative (stiffness, puncture force and time above 0), \
                               at most 1000";
                return Err(TissueError {
                    what,
                    given,
                    allowed,
                });
            }
        }
        if !(0.0..=self.puncture).contains(&self.cutting) {
            return Err(TissueError {
                what: "cutting force [N]",
                given: self.cutting,
                allowed: "0 to the puncture force",
            });
        }
        if !(0.0..=1.0).contains(&self.relaxation) {
            return Err(TissueError {
                what: "relaxation",
                given: self.relaxation,
                allowed: "0 to 1",
            });
        }
        Ok(())
    }
}
