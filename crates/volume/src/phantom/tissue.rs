//! What the phantom is made of, and how it shows in CT.
//!
//! Intensities [HU] are usual ones of a contrast-enhanced scan in the portal venous phase;
//! no soft tissue reaches 250 HU, noise included, so that a threshold there takes bone only.

/// What a voxel is made of; the number is its label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Tissue {
    /// Around the body.
    Air,
    /// The outermost layer.
    Skin,
    /// Under the skin, and around the organs.
    Fat,
    /// Between the fat and the cavities.
    Muscle,
    /// Both lungs.
    Lungs,
    /// The air in windpipe and main bronchi.
    Trachea,
    /// Muscle and chambers.
    Heart,
    /// Aorta, caval veins and their first branches.
    Vessels,
    /// Liver, on the patient's right.
    Liver,
    /// Spleen, on the patient's left.
    Spleen,
    /// Stomach with its content.
    Stomach,
    /// Both kidneys.
    Kidneys,
    /// Small bowel and colon.
    Bowel,
    /// The urinary bladder.
    Bladder,
    /// Cartilage of ribs, airways and the pubic joint.
    Cartilage,
    /// Between the vertebrae.
    Discs,
    /// Behind the vertebral bodies.
    SpinalCanal,
    /// Twelve pairs.
    Ribs,
    /// The breastbone.
    Sternum,
    /// Vertebrae, sacrum and coccyx.
    Spine,
    /// Both hip bones.
    Pelvis,
    /// Collar bones, shoulder blades, upper ends of the arm bones.
    Shoulders,
    /// Upper ends of the thigh bones.
    Femurs,
}

/// Each label with its name.
pub const NAMES: &[(&str, u8)] = &[
    ("air", Tissue::Air as u8),
    ("skin", Tissue::Skin as u8),
    ("fat", Tissue::Fat as u8),
    ("muscle", Tissue::Muscle as u8),
    ("lungs", Tissue::Lungs as u8),
    ("trachea", Tissue::Trachea as u8),
    ("heart", Tissue::Heart as u8),
    ("vessels", Tissue::Vessels as u8),
    ("liver", Tissue::Liver as u8),
    ("spleen", Tissue::Spleen as u8),
    ("stomach", Tissue::Stomach as u8),
    ("kidneys", Tissue::Kidneys as u8),
    ("bowel", Tissue::Bowel as u8),
    ("bladder", Tissue::Bladder as u8),
    ("cartilage", Tissue::Cartilage as u8),
    ("discs", Tissue::Discs as u8),
    ("spinal canal", Tissue::SpinalCanal as u8),
    ("ribs", Tissue::Ribs as u8),
    ("sternum", Tissue::Sternum as u8),
    ("spine", Tissue::Spine as u8),
    ("pelvis", Tissue::Pelvis as u8),
    ("shoulders", Tissue::Shoulders as u8),
    ("femurs", Tissue::Femurs as u8),
];

/// Thickness of the dense shell of bones [mm]; over as much again it passes to the core.
const SHELL: f32 = 2.0;

impl Tissue {
    /// All tissues, by label.
    pub const ALL: [Self; 23] = [
        Self::Air,
        Self::Skin,
        Self::Fat,
        Self::Muscle,
        Self::Lungs,
        Self::Trachea,
        Self::Heart,
        Self::Vessels,
        Self::Liver,
        Self::Spleen,
        Self::Stomach,
        Self::Kidneys,
        Self::Bowel,
        Self::Bladder,
        Self::Cartilage,
        Self::Discs,
        Self::SpinalCanal,
        Self::Ribs,
        Self::Sternum,
        Self::Spine,
        Self::Pelvis,
        Self::Shoulders,
        Self::Femurs,
    ];

    /// Mean intensity at the core and at the surface [HU]; they differ in bone only, whose
    /// shell is denser than its spongy core.
    pub fn intensity(self) -> (f32, f32) {
        let value = match self {
            Self::Air => -1000.0,
            Self::Skin => 20.0,
            Self::Fat => -100.0,
            Self::Muscle => 55.0,
            Self::Lungs => -820.0,
            Self::Trachea => -990.0,
            Self::Heart => 130.0,
            Self::Vessels => 165.0,
            Self::Liver => 110.0,
            Self::Spleen => 120.0,
            Self::Stomach => 30.0,
            Self::Kidneys => 180.0,
            Self::Bowel => 40.0,
            Self::Bladder => 5.0,
            Self::Cartilage => 120.0,
            Self::Discs => 85.0,
            Self::SpinalCanal => 25.0,
            Self::Ribs
            | Self::Sternum
            | Self::Spine
            | Self::Pelvis
            | Self::Shoulders
            | Self::Femurs => return (400.0, 950.0),
        };
        (value, value)
    }

    /// Whether the tissue is bone.
    pub fn is_bone(self) -> bool {
        self.intensity().0 != self.intensity().1
    }

    /// Mean intensity [HU] at a depth [mm] below the tissue's surface.
    pub(super) fn intensity_at(self, depth: f32) -> f32 {
        let (core, surface) = self.intensity();
        let share = ((depth - SHELL) / SHELL).clamp(0.0, 1.0);
        surface + (core - surface) * share
    }
}
