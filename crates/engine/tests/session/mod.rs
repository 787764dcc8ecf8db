//! Whole sessions.

mod offline;
