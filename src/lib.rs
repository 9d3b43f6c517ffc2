//! # mouldloft: the mould loft as a service
//!
//! A mould loft is where a ship's lines are drawn full size, faired, and its
//! plates developed. This crate is that loft behind HTTP: a JSON job with the
//! profile curves of a hull goes in; B-spline plates that a yard can bend from
//! flat steel come out, with the figures that prove it. Or measured offsets go
//! in, and fair lines and surfaces come out, with the table of corrections. Or a
//! coarse net of quads goes in, and a skin of cyclide patches comes out, with
//! the flat patterns of its strips and supports. Or a strip goes in, and the
//! cones, cylinders and planes to roll it from come out.
//!
//! ```text
//!             app ─────────────► everything
//! http ─────► jobs ────► methods ────► solver ───► numerics
//!   │                       └────────► geometry ─► numerics
//!   ├───────► workshop ──────────────► geometry
//!   └───────► formats ───────────────► geometry
//! ```
//!
//! ## Invariants
//!
//! * [`geometry`] and [`solver`] never see each other, nor the wire, the
//!   runtime, HTTP or the clock.
//! * A method is a pure, synchronous function
//!   `fit(&Request, &Control) -> Result<Outcome, FitError>`: the same request
//!   gives the same outcome whatever the thread count; it can be cancelled and
//!   reports progress through [`solver::Control`]; it never panics on bad input.
//! * Each method is a least-squares problem handed to the one [`solver`];
//!   every Jacobian is analytic and checked against differences in a test.
//! * Only `jobs::store` writes to disk (and [`cli`] the files that it is told
//!   to), only `jobs::clock` reads the clock, only `http::problem` picks status
//!   codes, only the programme's own part ([`app`], [`cli`], `main`) reads
//!   [`settings`].
//! * A fit that does not reach its goal is a result with a report, not an error.
//!
//! `tests/architecture.rs` reads the `use crate::` lines and refuses arrows
//! that point upwards.
//!
//! ## Reading order
//!
//! [`methods::hull_plates`], [`methods::fairing`], [`methods::curvature_net`]
//! and [`methods::cone_spline`] for what is computed and why, [`solver`] for how
//! it is minimised, [`geometry`] for the splines beneath; [`jobs`] for the
//! durable queue and [`http`] for the contract with the world.

pub mod app;
pub mod cli;
pub mod formats;
pub mod geometry;
pub mod http;
pub mod jobs;
pub mod methods;
pub mod numerics;
pub mod settings;
pub mod solver;
pub mod telemetry;
pub mod workshop;
