//! Bytes ↔ geometry: what enters and leaves the loft as a file.
//!
//! A writer is a pure function from a drawing (plain geometry, already
//! sampled) to text: the same drawing gives the same bytes. The writers know
//! neither the method that made the geometry nor who asked for the file.
//!
//! | module | writes | for whom |
//! |---|---|---|
//! | [`obj`] | triangles, watertight along shared chines | viewers, meshers, CAD |
//! | [`csv`] | the roll table, one row a ruling | spreadsheets, marking-off |
//! | [`svg`] | the lines plan with the rulings coloured by twist | print, README, browser |
//! | [`fair_curve`] | corrections of a faired curve (CSV), its plot (SVG) | loftsmen, print |
//! | [`fair_surface`] | a trimmed mesh (OBJ), corrections (CSV), isophotes (SVG) | CAD, loftsmen, print |
//! | [`cones`] | a strip of cones (OBJ), its workshop sheets (CSV) | CAD, yards |
//! | [`cyclides`] | a net of patches (OBJ), the bill of its arcs (CSV) | CAD, yards |
//! | [`step`] | surfaces sewn along shared edges, curves beside them | CAD |
//! | [`iges`] | surfaces and curves | older CAD |
//! | [`patterns`] | flat patterns (SVG), the same for the cutting table ([`dxf`]) | yards |
//! | [`offsets`] | a faired table of offsets (CSV), its lines plan (SVG) | loftsmen, print |
//!
//! Three modules read: [`points_in`] lists of points and tables of offsets as
//! yards write them, [`mesh_in`] meshes, [`step_in`] surfaces. They tell how they
//! read a file and guess nothing that changes a number.

pub mod brep;
pub mod cones;
pub mod csv;
pub mod cyclides;
pub mod dxf;
mod excerpt;
pub mod fair_curve;
pub mod fair_points;
pub mod fair_surface;
pub mod iges;
pub mod length_unit;
pub mod mesh_in;
pub mod obj;
pub mod offsets;
pub mod patterns;
pub mod plates;
pub mod points_in;
pub mod step;
pub mod step_in;
mod strip;
pub mod svg;
