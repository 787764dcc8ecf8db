//! What touch promises, by number, and what is told of a promise that was broken.

/// A promise that can be broken; numbers 1 to 6 are those of the design, section 5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guarantee {
    /// The probe's body is in no solid voxel.
    StaysOut = 1,
    /// It goes through free voxels, from face to face.
    CrossesNoWall = 2,
    /// Bounded work; no force without contact.
    BoundedWork = 3,
    /// At rest nothing changes.
    ComesToRest = 4,
    /// What is sent is safe.
    SafeForce = 5,
    /// The force never pulls in.
    NeverPulls = 6,
    /// A change of voxels that is not held back is touched.
    ChangesArrive = 7,
    /// The smooth force changes by little more than the hand's own move.
    StepsLittle = 8,
    /// What is rigid stays and pushes back, whatever a model of deformation says.
    HardHolds = 9,
}

/// A promise that was broken.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// Which.
    pub guarantee: Guarantee,
    /// How.
    pub what: String,
}

impl Violation {
    /// In whose grid it was broken.
    pub fn of_object(mut self, number: usize) -> Self {
        self.what += &format!(" in the grid of object {number}");
        self
    }
}

/// Makes an `Err` of a violation where something does not hold.
pub fn hold(
    holds: bool,
    guarantee: Guarantee,
    what: impl FnOnce() -> String,
) -> Result<(), Violation> {
    if holds {
        return Ok(());
    }
    let what = what();
    Err(Violation { guarantee, what })
}
