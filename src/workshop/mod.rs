//! What a yard cuts and rolls from: the flat pattern of a ruled plate, the table
//! of its rulings, and what of the plate the pattern does not hold.
//!
//! * [`flatten`] lays a plate out so that both its boundaries and all its
//!   rulings keep their lengths (`development`), in pieces where it would lie on
//!   itself (`overlap`), outlined by lines and arcs ([`outline`]), with station
//!   marks (`stations`).
//! * A plate with thickness is laid out by its middle (`neutral_surface`).
//! * A plate that twists cannot be laid out without strain: it is measured, as
//!   lengths and areas (`strain`) and by rolling the pattern up again (`refold`).
//! * [`HullFrame`] tells which way is along the hull and which side is inside.

mod development;
mod flat_plate;
mod hull_frame;
mod neutral_surface;
pub mod outline;
mod overlap;
mod refold;
mod stations;
mod strain;
#[cfg(test)]
mod tests;

pub use flat_plate::{
    Face, FlatFigures, FlatPiece, FlatPlate, FlatRuling, StationMark, flatten, flatten_thick,
};
pub use hull_frame::{HullFrame, Side};
pub use outline::OutlineCorner;
