//! How the surface of a segment feels, where it differs from the settings of touch.

use palpate_deform::material::MaterialLaw;
use palpate_haptics::force::MAX_FRICTION;
use palpate_volume::edit::SegmentId;
use serde::{Deserialize, Serialize};

use crate::touch::settings::{Settings, SettingsError};

/// A probe that slides over a surface is held back by this fraction of what holds one that sticks.
/// Tables of textbooks have 0.8 for rubber on concrete and 0.77 for steel on steel; for tissue none
/// is known.
const SLIDING_SHARE: f64 = 0.8;

/// What a segment has of its own; none is as the settings say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchFeel {
    /// Of the spring between probe and device [N/mm].
    pub stiffness: Option<f64>,
    /// Coulomb coefficient of a probe that sticks.
    pub friction_static: Option<f64>,
    /// Coulomb coefficient of a probe that slides, at most the static one.
    pub friction_kinetic: Option<f64>,
}

impl TouchFeel {
    /// Without friction, whatever the segment is made of.
    pub const SLIPPERY: Self = Self {
        stiffness: None,
        friction_static: Some(0.0),
        friction_kinetic: Some(0.0),
    };

    /// The settings for a contact with the segment.
    #[must_use]
    pub fn over(self, settings: &Settings) -> Settings {
        let friction_static = self.friction_static.unwrap_or(settings.friction_static);
        let friction_kinetic = self.friction_kinetic.unwrap_or(settings.friction_kinetic);
        Settings {
            stiffness: self.stiffness.unwrap_or(settings.stiffness),
            friction_static,
            // a segment that has only one of them keeps the cone a cone
            friction_kinetic: friction_kinetic.min(friction_static),
            ..*settings
        }
    }

    /// With the friction of what the segment is made of, where it has none of its own.
    #[must_use]
    pub fn of_material(self, law: Option<&MaterialLaw>) -> Self {
        let has_own = self.friction_static.or(self.friction_kinetic).is_some();
        let Some(law) = law.filter(|_| !has_own) else {
            return self;
        };
        let sticks = law.friction().min(MAX_FRICTION);
        Self {
            friction_static: Some(sticks),
            friction_kinetic: Some(SLIDING_SHARE * sticks),
            ..self
        }
    }

    /// Checks what is given.
    ///
    /// # Errors
    /// [`SettingsError`] names the first value that is not allowed.
    pub fn check(self) -> Result<(), SettingsError> {
        let given = Settings {
            stiffness: self.stiffness.unwrap_or(1.0),
            friction_static: self
                .friction_static
                .or(self.friction_kinetic)
                .unwrap_or(0.0),
            friction_kinetic: self.friction_kinetic.unwrap_or(0.0),
            ..Settings::default()
        };
        given.check()
    }
}

/// How each segment feels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<(u8, TouchFeel)>", into = "Vec<(u8, TouchFeel)>")]
pub struct TouchFeels([TouchFeel; 256]);

impl Default for TouchFeels {
    /// All as the settings say.
    fn default() -> Self {
        Self([TouchFeel::default(); 256])
    }
}

impl TouchFeels {
    /// How a segment feels.
    #[must_use]
    pub fn of(&self, id: SegmentId) -> TouchFeel {
        self.0[usize::from(id.0)]
    }

    /// A segment feels like this from now on.
    pub fn set(&mut self, id: SegmentId, feel: TouchFeel) {
        self.0[usize::from(id.0)] = feel;
    }
}

/// Those that have something of their own.
impl From<TouchFeels> for Vec<(u8, TouchFeel)> {
    fn from(feels: TouchFeels) -> Self {
        let numbered = (0..=u8::MAX).zip(feels.0);
        numbered
            .filter(|(_, feel)| *feel != TouchFeel::default())
            .collect()
    }
}

impl From<Vec<(u8, TouchFeel)>> for TouchFeels {
    fn from(own: Vec<(u8, TouchFeel)>) -> Self {
        let mut feels = Self::default();
        for (id, feel) in own {
            feels.set(SegmentId(id), feel);
        }
        feels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_without_a_feel_of_its_own_feels_as_the_settings_say() {
        let settings = Settings::default();
        assert_eq!(TouchFeel::default().over(&settings), settings);
        let hard = TouchFeel {
            stiffness: Some(4.0),
            friction_static: Some(0.1),
            ..TouchFeel::default()
        };
        let rough = Settings {
            friction_static: 0.5,
            friction_kinetic: 0.4,
            ..settings
        };
        let felt = hard.over(&rough);
        assert_eq!((felt.stiffness, felt.friction_static), (4.0, 0.1));
        assert_eq!(felt.friction_kinetic, 0.1);
    }

    #[test]
    fn matter_gives_its_friction_where_the_segment_has_none_of_its_own() {
        let bone = palpate_deform::material::preset("cortical-bone");
        let bone = bone.unwrap().law().unwrap();
        let stiff = TouchFeel {
            stiffness: Some(4.0),
            ..TouchFeel::default()
        };
        assert_eq!(stiff.of_material(None), stiff);
        let felt = stiff.of_material(Some(&bone));
        assert_eq!(felt.stiffness, Some(4.0));
        assert_eq!(felt.friction_static, Some(0.3));
        assert_eq!(felt.friction_kinetic, Some(0.8 * 0.3));
        for own in [
            TouchFeel {
                friction_static: Some(0.0),
                ..stiff
            },
            TouchFeel {
                friction_kinetic: Some(0.1),
                ..stiff
            },
        ] {
            assert_eq!(own.of_material(Some(&bone)), own);
        }
    }

    #[test]
    fn a_feel_out_of_range_is_refused_by_name() {
        let stiff = TouchFeel {
            stiffness: Some(f64::NAN),
            ..TouchFeel::default()
        };
        assert_eq!(stiff.check().unwrap_err().name, "stiffness [N/mm]");
        let inverted = TouchFeel {
            friction_static: Some(0.1),
            friction_kinetic: Some(0.2),
            ..TouchFeel::default()
        };
        assert_eq!(inverted.check().unwrap_err().name, "kinetic friction");
    }
}
