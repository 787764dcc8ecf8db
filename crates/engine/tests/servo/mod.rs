//! The servo and device loops, and what they do where something goes wrong.

mod safety;
mod servo_loop;
mod workspace;
