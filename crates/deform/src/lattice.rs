//! The bonded lattice: isotropic nodes that carry a body's tissue around the tools.
//!
//! Nodes stand on a cubic lattice of their own, whatever the voxels' shape; each is bonded to
//! its 6 face and 12 edge neighbours. Equal springs on all of them are exactly isotropic with
//! ν = 1/4; a term on the volume of each cell of 8 nodes gives the other ratios. A box of nodes
//! moves with the tool; its border stands for the body behind it. Each frame the nodes are
//! brought to rest from where they were; voxels follow them.
//!
//! Frame of this module: the lattice's own, mm along the axes of the grid; node (i, j, k) of
//! the box rests at (i, j, k) · spacing. Source: thesis errata, sections 3, 6 and 7;
//! `docs/understand/deformation.md` has the whole method.

#![allow(
    clippy::needless_range_loop,
    reason = "an index names the same node, axis or mode in several arrays at once"
)]

mod bond_forces;
mod border;
mod box_place;
mod coarse;
mod conjugate;
mod contact_law;
mod damage;
mod driven;
mod inelastic;
mod lattice_model;
mod layout;
mod measured_stiffness;
mod moduli;
mod moving_box;
mod needle_drag;
mod needle_tissue;
mod node_contacts;
mod nodes;
mod plastic_set;
mod pressure_easing;
mod relax;
mod resample;
mod settings;
mod shift;
mod stiffening;
mod structure;
mod tangent;
mod told_force;
mod tool_contact;
mod tool_way;
mod turning;
mod vectors;
mod volume_forces;
mod whole_body;
mod whole_contacts;
mod whole_lattice;
mod whole_picture;
mod whole_sites;
mod write_back;

pub use border::Border;
pub use inelastic::{Breaking, Inelastic, InelasticSettings, Prony};

pub use lattice_model::LatticeModel;
pub use layout::{FAMILIES, Layout};
pub use moduli::{LatticeModuli, POISSON_RANGE};
pub use needle_drag::{CARRIED, DEEPEST, NeedleDrag};
pub use needle_tissue::{NeedleInput, NeedleTissue};
pub use nodes::{Lattice, NodeMaterial};
pub use relax::{RelaxReport, RelaxSettings, Relaxer};
pub use settings::LatticeSettings;
pub use tool_contact::{LatticeTool, ToolForce};
