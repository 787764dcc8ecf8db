//! What is touched, how it feels, and that changes leave the probe free.

mod admission;
mod carried;
mod clip;
mod intensities;
mod moving;
mod needle;
mod needle_direction;
mod needle_moved;
mod needle_on_file;
mod radius;
mod touchable;
