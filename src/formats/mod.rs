//! Bytes ↔ geometry: what enters and leaves the loft as a file.
//!
//! A writer is a pure function from a drawing (plain geometry, already
//! sampled) to text or bytes: the same drawing gives the same bytes. The writers know
//! neither the method that made the geometry nor who asked for the file.
//!
//! | module | writes | for whom |
//! |---|---|---|
//! | [`mesh_out`] | the tessellation of any result, for the four below | – |
//! | [`obj`] | triangles, watertight along shared borders | viewers, meshers, CAD |
//! | [`stl`] | triangles alone | printers, meshers |
//! | [`ply`] | triangles with colours and a number a vertex | measuring, meshers |
//! | [`glb`] | a scene with named parts, colours, numbers and lines | viewers, browsers |
//! | [`csv`] | the roll table, one row a ruling | spreadsheets, marking-off |
//! | [`svg`] | the lines plan with the rulings coloured by twist | print, README, browser |
//! | [`fair_curve`] | corrections of a faired curve (CSV), its plot (SVG) | loftsmen, print |
//! | [`fair_surface`] | corrections of a faired surface (CSV), isophotes (SVG) | loftsmen, print |
//! | [`cones`] | the workshop sheets of a strip of cones (CSV) | yards |
//! | [`cyclides`] | the bill of the arcs of a net of patches (CSV) | yards |
//! | [`step`] | surfaces sewn along shared edges, curves beside them | CAD |
//! | [`iges`] | surfaces and curves | older CAD |
//! | [`patterns`] | flat patterns (SVG), the same for the cutting table ([`dxf`]) | yards |
//! | [`offsets`] | a faired table of offsets (CSV), its lines plan (SVG) | loftsmen, print |
//!
//! [`measured`] tells any of these drawings in another unit.
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
pub mod glb;
pub mod iges;
pub mod length_unit;
pub mod measured;
pub mod mesh_in;
pub mod mesh_out;
pub mod obj;
pub mod offsets;
pub mod patterns;
pub mod plates;
pub mod ply;
pub mod points_in;
pub mod step;
pub mod step_in;
pub mod stl;
mod strip;
pub mod svg;
