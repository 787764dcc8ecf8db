//! How work is given up that nobody wants any more.

/// Asked now and then by what takes long: whether the work is no longer wanted. Any thread may ask.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);
