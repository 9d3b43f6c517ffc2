//! What the method takes.

use nalgebra::Vector3;

/// A table of offsets and what is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// x of the stations, increasing.
    pub stations: Vec<f64>,
    /// z of the waterlines, increasing.
    pub waterlines: Vec<f64>,
    /// Half-breadths ≥ 0, one row a station, one cell a waterline; `None`
    /// where nothing was measured.
    pub half_breadths: Vec<Vec<Option<f64>>>,
    /// What is asked.
    pub options: Options,
}

/// What is asked of the faired table.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// No half-breadth changes by more. `None`: by its noise, which is
    /// estimated from the table.
    pub tolerance: Option<f64>,
    /// Tolerances of single cells (station, waterline, tolerance); they need
    /// a [`Options::tolerance`] for the others.
    pub cell_tolerances: Vec<(usize, usize, f64)>,
    /// Cells (station, waterline) that must not change.
    pub locked: Vec<[usize; 2]>,
    /// Stations (by index, not the first or last) across which the waterlines
    /// may have a knuckle.
    pub knuckle_stations: Vec<usize>,
    /// Waterlines (by index) across which the stations may have a knuckle.
    pub knuckle_waterlines: Vec<usize>,
    /// Gross errors lose their pull instead of bending the surface.
    pub robust: bool,
    /// y of the buttocks to draw; empty: at ¼, ½ and ¾ of the greatest
    /// half-breadth.
    pub buttocks: Vec<f64>,
    /// Direction of the light for isophotes, any length but zero.
    pub light: Vector3<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: None,
            cell_tolerances: Vec::new(),
            locked: Vec::new(),
            knuckle_stations: Vec::new(),
            knuckle_waterlines: Vec::new(),
            robust: false,
            buttocks: Vec::new(),
            light: crate::methods::fairing::surface::request::Options::default().light,
        }
    }
}
