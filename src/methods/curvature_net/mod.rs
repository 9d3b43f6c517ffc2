//! Curvature nets: surfaces whose patch borders are lines of curvature.
//!
//! # Problem
//! A coarse regular net of quads says roughly where a skin runs and how its
//! seams lie. Wanted is a smooth surface near it whose seams are lines of
//! curvature: along them frames stand square to the skin without twist, strips
//! between them are developable, and offsets keep the net.
//!
//! # Unknowns
//! At every vertex of the net P, P_u, P_v, P_uv: the bicubic Hermite patches on
//! them are C¹ by construction.
//!
//! # Residuals
//! With S the surface, N = S_u × S_v, a line c of the net in direction u and
//! N_c its derivative along c:
//!
//! * torsion: det(S_u, N, N_u) / (|N|² |S_u|) at K + 1 places of every border,
//!   the geodesic torsion times the length of the border, radians; 0 ⇔ N_c ∥ c′
//!   ⇔ c is a line of curvature (do Carmo 1976, §3.3);
//! * squareness: S_u·S_v / (|S_u| |S_v|) at every vertex;
//! * closeness: the way D = S − S₀ of a vertex from the start S₀, along its
//!   normal and across it;
//! * fairness: the bending D_uu, D_vv, D_uv, D_uuv, D_uvv of the way.
//!
//! The torsion's weight rises ×1, ×10, ×100, ×1000 on every level; then each
//! patch is split in four, which changes nothing of the shape, until the net is
//! as fine as asked.
//!
//! # Sources
//! Zheng & Bo, *Design of smooth surfaces with regular network of curvature
//! curves*, Journal of Graphics 40(1), 2019, eqs. 1, 2 (in Chinese); Bobenko &
//! Huhnen-Venedey, arXiv 1101.5955; Bo, Liu, Tu, Zhang & Wang, *Surface fitting
//! with cyclide splines*, CAGD 43, 2016; Liu, Pottmann et al., *Geometric
//! modeling with conical meshes and developable surfaces*, 2006.
//!
//! # What was changed against the paper
//! * Hermite unknowns at the vertices instead of Bézier points: the paper's
//!   F_smooth is not needed, and there are 12 unknowns a patch instead of 48.
//! * The torsion is an angle, so that its weight does not depend on size.
//! * Fairness is asked of the way from the start instead of the vertices, so
//!   that a net that is laid right stays as it is.
//!
//! # Limits
//! Nets without singular vertices only; see [`request::Input`].

mod bend;
pub mod build;
pub mod cyclide;
pub mod diagnose;
mod input;
pub mod lines;
pub mod net;
pub mod outcome;
pub mod request;
mod smooth;
pub mod structure;
pub mod surface;

pub use input::MOST_PATCHES;
pub use net::Net;
pub use request::Request;
pub use smooth::{Smooth, smooth};
pub use surface::Surface;
