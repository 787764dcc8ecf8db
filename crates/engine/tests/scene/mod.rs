//! Segments beside touch: cuts, gaps, and the occupancy fractions of masks.

mod cut;
mod gap;
mod mask_fractions;
