//! Tests of `palpate-device`, in one binary.

mod examples;
mod scripted;
mod simulated;
