//! Tools at work without a device.

mod drives;
