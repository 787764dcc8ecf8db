//! Whole sessions.

mod offline;
mod press;
