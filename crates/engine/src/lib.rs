//! The live session: a scan that is touched with a device, its threads and what they share.
//!
//! Four threads (device, servo, simulation, picture) hand over latest values and queues without
//! ever waiting for one another; the same loops can be stepped offline, deterministically. This
//! is the only crate that knows all others; it will not depend on Python or on the page.
//!
//! Frames: points in the scene, LPS mm, unless a name says otherwise; forces N, times s.

pub mod assembly;
pub mod bell;
pub mod body;
pub mod clock;
pub mod cut;
pub mod deformation;
pub mod deformation_loop;
pub mod device_loop;
pub mod displaced;
pub mod error;
pub mod feel;
pub mod frame;
pub mod gap;
pub mod gap_bodies;
pub mod giving_matter;
pub mod grip;
pub mod guarantee_watch;
pub mod handover;
pub mod hard_matter;
pub mod kept_surface;
pub mod known_shares;
pub mod live;
pub mod mapping;
pub mod mask_runs;
pub mod mask_shares;
pub mod matter_view;
pub mod model;
pub mod moved_poses;
pub mod needle;
pub mod offline;
pub mod owners;
pub mod pacing;
pub mod packed_patch;
pub mod patched;
pub mod picture;
pub mod placement;
#[cfg(feature = "planted-fault")]
mod planted_fault;
pub mod point_tree;
pub mod priority;
pub mod probe;
pub mod rate;
pub mod recording;
pub mod replay;
pub mod rigid_matter;
pub mod scan_values;
pub mod scenario;
pub mod scene;
pub mod scene_news;
pub mod servo;
pub mod servo_state;
pub mod session;
pub mod session_config;
pub mod settings;
pub mod shared;
pub mod simulation;
pub mod surface_loop;
pub mod surfaces;
pub mod tape;
pub mod tape_columns;
pub mod tool_stroke;
pub mod touch_occupancy;
pub mod touch_sender;
pub mod touchable;
pub mod touched_surfaces;
pub mod union_shares;
