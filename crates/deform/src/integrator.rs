//! How particles move: velocity Verlet in scaled and in physical time.
