//! What can go wrong in a session.

use glam::DVec3;
use palpate_haptics::ball::BallError;
use palpate_haptics::scene::{MAX_OBJECTS, PoseError};
use palpate_tools::journal::JournalError;
use palpate_tools::tool::ToolError;
use palpate_volume::voxels::VoxelsError;

use crate::scene::MOST_POINTS;
use crate::servo::ViewError;
use crate::touch::{MOST_PRESSURE, SettingsError};

/// Why a session does not do what it is asked for.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// It was stopped.
    #[error("the session is stopped; allowed: a session that runs")]
    Stopped,
    /// It ended by itself.
    #[error("the session has ended: {0}")]
    Failed(String),
    /// The system refuses a thread.
    #[error("cannot start the {thread} thread: {reason}")]
    Thread {
        /// Which thread.
        thread: &'static str,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// A rate that no thread can keep.
    #[error("servo rate {0} Hz given; allowed: 500 to 10000 Hz")]
    Rate(u32),
    /// A point that is none.
    #[error("{name} {given} given; allowed: finite, at most {limit} mm from zero")]
    Point {
        /// What the point is for.
        name: &'static str,
        /// The point given.
        given: glam::DVec3,
        /// Largest coordinate [mm].
        limit: f64,
    },
    /// A direction of a press that is none.
    #[error("direction {0} of the press given; allowed: finite and not zero")]
    PressDirection(glam::DVec3),
    /// A force that a mouse does not press with.
    #[error("pressure {0} N given; allowed: more than 0 N, at most {MOST_PRESSURE} N")]
    Pressure(f64),
    /// A device that a person's own hand leads.
    #[error(
        "the device {0} is led by a hand of its own; allowed: a press with the simulated device"
    )]
    NoHand(String),
    /// No free voxel for the probe.
    #[error(
        "no free voxel within {reach} voxels of {point}; allowed: a point nearer to the surface"
    )]
    NoFreeVoxel {
        /// The point given, scene mm.
        point: glam::DVec3,
        /// How far was searched.
        reach: i32,
    },
    /// A box without voxels of the scan.
    #[error("box from {low} to {high} given; allowed: low below high, inside {dimensions}")]
    Box {
        /// First voxel.
        low: glam::IVec3,
        /// One beyond the last voxel.
        high: glam::IVec3,
        /// Voxels of the scan.
        dimensions: glam::UVec3,
    },
    /// Voxels of another grid for a segment.
    #[error(
        "other voxels on another grid given for segment {0}; allowed: the grid that it stands on, \
         or a new segment"
    )]
    OtherGrid(u8),
    /// A change of what is locked.
    #[error("a change of segment {0} given, which is locked; allowed: unlock it first")]
    Locked(u8),
    /// The drill works on the scan's matter alone.
    #[error(
        "segments with a grid of their own given to the drill; allowed: segments of the scan, \
         whose matter it removes"
    )]
    NothingToDrill,
    /// The painter has nothing to take voxels from.
    #[error(
        "all segments to be painted are locked, or stand elsewhere than the one to paint with or on \
         another grid; allowed: segments that are not, and stand together as in the scan"
    )]
    NothingToPaint,
    /// A plane that is none.
    #[error("plane through {point} with normal {normal} given; allowed: finite, normal not zero")]
    Plane {
        /// The point given, scene mm.
        point: glam::DVec3,
        /// The normal given.
        normal: glam::DVec3,
    },
    /// A gap from or to nothing.
    #[error("gap from segment {0} to segment {1}: one of them is empty; allowed: both with voxels")]
    NoGap(u8, u8),
    /// A cut that parts nothing.
    #[error(
        "the plane through {point} leaves all of segment {id} on one side; allowed: a plane \
             with some of it on both"
    )]
    CutMisses {
        /// Which segment.
        id: u8,
        /// The point given, scene mm.
        point: glam::DVec3,
    },
    /// A painted line that is none.
    #[error(
        "a line of {points} points given; allowed: 2 to {MOST_POINTS} finite points before the eye, \
         at two different places of the picture, and a direction of view"
    )]
    PaintedLine {
        /// How many.
        points: usize,
    },
    /// A line that parts nothing.
    #[error(
        "the painted line leaves all of segment {id} on one side; allowed: a line with some of it \
         on both"
    )]
    LineMisses {
        /// Which segment.
        id: u8,
    },
    /// A threshold that is none.
    #[error("threshold {low} to {high} given; allowed: finite, low not above high")]
    Range {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// A stretch of time that is none, or a real session asked to compute one.
    #[error("{0} s given; allowed: 0 to 3600 s")]
    Duration(f64),
    /// A pose that is no rigid motion.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// No more segments can be moved.
    #[error("{MAX_OBJECTS} segments are moved already; allowed: at most as many")]
    TooManyMoved,
    /// A ball that does not fit the scan's voxels.
    #[error(transparent)]
    Ball(#[from] BallError),
    /// Only an offline session is stepped by its owner.
    #[error("this session runs in real time; allowed: run() of a session with real_time off")]
    NotOffline,
    /// No deformation model of that name.
    #[error(transparent)]
    Model(#[from] palpate_deform::registry::UnknownModel),
    /// No such box of a deformation model.
    #[error(transparent)]
    ModelOption(#[from] palpate_deform::registry::WrongOption),
    /// Planes that are no clip.
    #[error(transparent)]
    Clip(#[from] palpate_volume::clip::ClipError),
    /// Voxels that do not fit.
    #[error(transparent)]
    Voxels(#[from] VoxelsError),
    /// Settings out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Settings that make no surface.
    #[error(transparent)]
    Surface(#[from] palpate_surface::settings::SettingsError),
    /// A tool that cannot be made.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// A journal that cannot be written or followed.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A drive of a needle that is none.
    #[error(
        "a drive of {way} mm at {speed} mm/s with a rest of {rest} s given; allowed: a way above 0 \
         up to 1000 mm at a speed above 0 within 5000 s, a rest up to 3600 s"
    )]
    Drive {
        /// Its way [mm].
        way: f64,
        /// Its speed [mm/s].
        speed: f64,
        /// Its rest [s].
        rest: f64,
    },
    /// A direction of a needle that is none.
    #[error(
        "direction {0} of a needle given; allowed: finite, of a length above 0, or none for that of the push"
    )]
    NeedleDirection(DVec3),
    /// No tool is chosen.
    #[error("a stroke without a tool given; allowed: choosing a tool first")]
    NoTool,
    /// View axes that are none.
    #[error(transparent)]
    View(#[from] ViewError),
}
