//! What all models share.
