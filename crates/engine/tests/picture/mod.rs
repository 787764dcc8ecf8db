//! What the picture is told.

mod surfaces;
