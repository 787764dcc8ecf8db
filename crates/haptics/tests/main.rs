//! Tests of `palpate-haptics`, in one binary.
//!
//! The allocator of `closed_tick` counts for each thread apart, so all tests share it.

mod admission;
mod ball;
mod ball_admission;
mod ball_smooth;
mod closed_tick;
mod composed;
mod coupling;
mod exact;
mod examples;
mod friction;
mod local_force;
mod moving;
mod needle;
mod needle_direction;
mod needle_layers;
mod needle_stretches;
mod objects;
mod passivity;
mod placement;
mod safety;
mod smooth;
mod soft_contact;
mod support;
mod surface;
mod thesis_force;
mod thesis_models;
mod tick;
