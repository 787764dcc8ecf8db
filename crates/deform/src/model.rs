//! What all models of deformation share: what they are told and what they answer.
//!
//! A model is told the true voxels, what they are made of, where the tools are and how much it
//! may work; it answers with an edit (solid voxels and their intensities that moved), a field of
//! displacements for the picture, and for each tool the contact force with its stiffness. It
//! applies nothing and sends nothing.
//!
//! Frame: patient (LPS mm) of the scan. Units: mm, N, N/mm, N·mm, s.
//! Source: thesis 5.1.

use std::fmt;
use std::time::Instant;

use glam::{DMat3, DQuat, DVec3, UVec3, Vec3};
use palpate_volume::edit::Edit;
use palpate_volume::material::LocalContact;
use palpate_volume::voxels::Voxels;

use crate::at_rest::AtRest;
use crate::material::Materials;

/// Sizes of tools that make sense [mm].
const SIZE_LIMITS: [f64; 2] = [1e-3, 100.0];

/// The rigid body of a tool, centred at its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolShape {
    /// A ball of this radius [mm].
    Ball(f64),
    /// An ellipsoid with these half axes [mm], along the tool's own axes.
    Ellipsoid(DVec3),
}

impl ToolShape {
    /// Half axes [mm].
    #[must_use]
    pub fn half_axes(&self) -> DVec3 {
        match self {
            Self::Ball(radius) => DVec3::splat(*radius),
            Self::Ellipsoid(half_axes) => *half_axes,
        }
    }
}

/// A tool as a model sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState {
    /// Number by which its contact is reported.
    pub id: u32,
    /// Rigid body of the tool.
    pub shape: ToolShape,
    /// Centre of the tool [mm].
    pub position: DVec3,
    /// Takes the tool's own axes to those of the patient.
    pub orientation: DQuat,
}

impl ToolState {
    /// Whether it is a body at a place; any other is passed over and feels no force.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        let half_axes = self.shape.half_axes();
        let [low, high] = SIZE_LIMITS.map(DVec3::splat);
        // comparisons with NaN are false
        let sizes = half_axes.cmpge(low).all() && half_axes.cmple(high).all();
        sizes
            && self.position.abs().cmple(DVec3::splat(1e9)).all()
            && self.orientation.is_finite()
            && (self.orientation.length_squared() - 1.0).abs() < 1e-3
    }
}

/// Limit on the work of a model in one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Iterations or sub-steps at most. With this alone the answer is the same to the bit.
    pub iterations: u32,
    /// Time at which to stop although not at rest; none off-line and in tests. What works on one thread
    /// may take the time until then as processor time of its own.
    pub deadline: Option<Instant>,
    /// Nodes along each edge of the box at most, odd; none for the model's own. The lattice follows it, also
    /// while it is pressed, but for tissue that yields.
    pub edge: Option<u32>,
}

impl Budget {
    /// So many iterations, however long they take.
    #[must_use]
    pub const fn iterations(iterations: u32) -> Self {
        Self {
            iterations,
            deadline: None,
            edge: None,
        }
    }

    /// The budget of a part of the work: it is late when this share of the time since `began` is over.
    #[must_use]
    pub fn until(&self, began: Instant, share: f64) -> Self {
        let part = |end: Instant| began + end.saturating_duration_since(began).mul_f64(share);
        Self {
            deadline: self.deadline.map(part),
            ..*self
        }
    }

    /// Whether the time is over.
    #[must_use]
    pub fn is_late(&self) -> bool {
        self.deadline.is_some_and(|end| Instant::now() >= end)
    }
}

/// What a model is told in one call.
#[derive(Clone, Copy, Debug)]
pub struct ModelInput<'a> {
    /// The true voxels, earlier edits of this model included.
    pub voxels: &'a Voxels,
    /// What they are made of.
    pub materials: &'a Materials,
    /// All tools; the box stands around the first one that is usable.
    pub tools: &'a [ToolState],
    /// Time since the last call [s], for tissue whose force fades.
    pub dt: f64,
    /// Limit on the work of this call.
    pub budget: Budget,
}

/// The contact of one tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolContact {
    /// Number of the tool.
    pub tool: u32,
    /// Force on it and how it changes with its place; none without contact.
    pub contact: Option<LocalContact>,
}

/// Something that happened at once, and may make the force jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelEvent {
    /// Bonds broke.
    BondsBroken {
        /// Number of bonds.
        count: u32,
        /// Work that they took [N·mm].
        work: f64,
        /// The middle of them [mm].
        place: DVec3,
    },
    /// Particles changed their neighbours: a crystal slips by rows.
    Slipped {
        /// Links that parted.
        count: u32,
        /// The middle of them [mm].
        place: DVec3,
    },
    /// Poisson's ratio was out of what the model can do, and the nearest one is used: one of a
    /// range, or the only one that particles on a lattice have.
    PoissonClamped {
        /// The ratio that was asked for.
        asked: f64,
        /// The ratio that is used.
        used: f64,
    },
    /// The state was lost to numbers that are none, and everything is at rest again.
    Reset,
}

/// The displacement that the voxels do not show yet: the whole one less what was written back.
///
/// What the voxels show at a place y, the edit of the same answer taken in, stands at
/// y + moved(y): trilinear between nodes, zero outside the box. Where nothing was written back
/// that is all of the displacement from rest; where voxels have moved, it is what rounding to
/// voxels left over, about half a voxel at most. Beside tissue it goes on into empty space for some nodes, so that a
/// surface between nodes moves as the tissue under it.
///
/// To draw: a vertex of a patch at y goes to y + moved(y); a sample of the volume at x reads
/// the voxels at the y with y + moved(y) = x (y = x − moved(y), from y = x in some steps).
///
/// Memory: x fastest; node (i, j, k) is at `origin + axes · (i, j, k) · spacing`.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplacementField {
    /// First node [mm].
    pub origin: DVec3,
    /// Directions of the three indices, of length 1.
    pub axes: DMat3,
    /// Between nodes [mm].
    pub spacing: f64,
    /// Nodes along each index.
    pub size: UVec3,
    /// For each node, from where voxels show it to where it stands [mm], patient axes.
    pub moved: Vec<Vec3>,
}

/// Report on one call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelReport {
    /// Iterations or sub-steps.
    pub iterations: u32,
    /// What was left of unbalanced force, as a share of the contact force.
    pub residual: f64,
    /// Nodes or particles that take part.
    pub nodes: u32,
    /// Voxels that are not as they were at rest.
    pub moved_voxels: u32,
    /// Those of the moved voxels that stay displaced because their tissue has yielded (plastic
    /// set).
    pub plastic_voxels: u32,
    /// Bonds broken since the start.
    pub bonds_broken: u64,
    /// Work that breaking them took since the start [N·mm].
    pub work_broken: f64,
    /// Whether tissue is not at rest yet: the next call brings it nearer.
    pub settling: bool,
    /// Whether the box is smaller than the model's own, for the budget's sake.
    pub small_box: bool,
    /// What the call has done, by what takes time; zero where a model does not count.
    pub effort: Effort,
}

impl ModelReport {
    /// Whether voxels that the model moved are to come back yet.
    #[must_use]
    pub fn comes_back(&self) -> bool {
        self.moved_voxels > self.plastic_voxels
    }
}

/// What a call has done, by what takes time: counts, so that the same calls give the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Places that voxels were asked about what they are made of.
    pub sampled: u64,
    /// Nodes whose bonds were built.
    pub built: u64,
    /// Evaluations of all forces: those to rest, for the contact's stiffness and for what eases both.
    pub evaluations: u64,
    /// Voxels that were looked at for whether they follow.
    pub looked_at: u64,
    /// Of these, voxels that were worked out anew; a model that does so with all leaves it zero.
    pub followed: u64,
}

/// What a model answers.
#[derive(Clone, Debug, Default)]
pub struct ModelAnswer {
    /// Voxels that moved, with their intensities; none where nothing changed.
    pub edit: Option<Edit>,
    /// What all voxels that the model has moved by then, this edit's among them, are without a tool;
    /// none from a model all of whose edits stay.
    pub at_rest: Option<AtRest>,
    /// One for each tool, in order.
    pub contacts: Vec<ToolContact>,
    /// Displacement that the voxels do not show; none where they show all.
    pub displacement: Option<DisplacementField>,
    /// Displacement of the body behind, which no voxel follows, to be added to it; none where that stands still.
    pub behind: Option<DisplacementField>,
    /// What happened at once.
    pub events: Vec<ModelEvent>,
    /// Report on the call.
    pub report: ModelReport,
}

/// Where the parts of a model are, for whoever looks at the model itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelParts {
    /// Place at rest and present place of each part [mm].
    pub places: Vec<[DVec3; 2]>,
    /// Distance of neighbours at rest [mm].
    pub apart: f64,
}

/// A model of deformation. Its state is its own; the same calls give the same answers.
pub trait DeformationModel: Send + fmt::Debug {
    /// Brings tissue to rest, or one step further, with the tools where they are now.
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer;

    /// Forgets all displacements and what broke, as after undo or a change of the materials.
    /// What it wrote into voxels, and still stands there, the next answers give back; but what has
    /// yielded stays, as if anybody had cut it so.
    fn reset(&mut self);

    /// Its nodes or particles; empty where the model has none, or before the first call.
    fn parts(&self) -> ModelParts {
        ModelParts::default()
    }
}
