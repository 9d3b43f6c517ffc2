//! Independent checks of surfaces, whoever made them: one check a file. They
//! know nothing of how a surface came about and measure it alone.
//!
//! * [`shape`]: area, curvature, radii of any tensor-product surface;
//! * [`ruling`]: twist, clearance and bend radius of one that is ruled;
//! * [`joins`]: where edges meet, how well, and at which angle;
//! * [`strays`]: how far points lie from the edges.

pub mod joins;
pub mod ruling;
pub mod shape;
pub mod strays;
