//! Bytes ↔ geometry: what leaves the loft as a file.
//!
//! A writer is a pure function from a drawing (plain geometry, already
//! sampled) to text: the same drawing gives the same bytes. The writers know
//! neither the method that made the geometry nor who asked for the file.
//!
//! | module | writes | for whom |
//! |---|---|---|
//! | [`obj`] | triangles, watertight along shared chines | viewers, meshers, CAD |
//! | [`csv`] | one row a ruling | spreadsheets, marking-off |
//! | [`svg`] | the lines plan with the rulings coloured by twist | print, README, browser |

pub mod csv;
pub mod fair_curve;
pub mod fair_points;
pub mod fair_surface;
pub mod obj;
pub mod offsets;
pub mod plates;
pub mod points_in;
mod strip;
pub mod svg;
