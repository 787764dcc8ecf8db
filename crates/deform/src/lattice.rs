//! The bonded lattice: the default model.
