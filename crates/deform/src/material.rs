//! What matter is made of.
