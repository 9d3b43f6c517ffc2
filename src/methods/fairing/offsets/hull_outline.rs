//! Which cells of a table lie on the hull.
//!
//! Tables write zero for two things: the centreline, where the hull ends, and
//! the air beyond. A surface made to pass through the second kind bends. So
//! all zeros before the first and after the last positive cell of a waterline,
//! or below the lowest and above the highest of a station, are outside; of
//! those next to a positive cell the fit decides (an ending where the surface
//! that never saw it comes to zero there).

use super::request::Request;

/// What is known of a cell before any fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// Measured on the hull.
    Hull,
    /// A zero next to the hull: perhaps its ending.
    Edge,
    /// Not measured, between cells of the hull.
    Gap,
    /// Outside.
    Outside,
}

/// One place a cell, stations first.
pub(super) fn places(request: &Request) -> Vec<Vec<Place>> {
    let y = &request.half_breadths;
    let (rows, columns) = (y.len(), request.waterlines.len());
    let positive = |i: usize, j: usize| y[i][j].is_some_and(|v| v > 0.0);
    // First and last positive cell along each station and each waterline.
    let along_station: Vec<Option<[usize; 2]>> = (0..rows)
        .map(|i| range((0..columns).filter(|j| positive(i, *j))))
        .collect();
    let along_waterline: Vec<Option<[usize; 2]>> = (0..columns)
        .map(|j| range((0..rows).filter(|i| positive(*i, j))))
        .collect();
    let within = |r: &Option<[usize; 2]>, k: usize| r.is_some_and(|[a, b]| a <= k && k <= b);
    let place = |i: usize, j: usize| {
        let (of_station, of_waterline) =
            (within(&along_station[i], j), within(&along_waterline[j], i));
        match y[i][j] {
            Some(v) if v > 0.0 => Place::Hull,
            Some(_) if of_station && of_waterline => Place::Hull,
            Some(_) if near(i, j, (rows, columns), positive) => Place::Edge,
            Some(_) => Place::Outside,
            None if of_station && of_waterline => Place::Gap,
            None => Place::Outside,
        }
    };
    (0..rows)
        .map(|i| (0..columns).map(|j| place(i, j)).collect())
        .collect()
}

fn range(mut places: impl Iterator<Item = usize>) -> Option<[usize; 2]> {
    let first = places.next()?;
    Some([first, places.last().unwrap_or(first)])
}

/// Whether one of the four cells about (i, j) is positive.
fn near(
    i: usize,
    j: usize,
    (rows, columns): (usize, usize),
    positive: impl Fn(usize, usize) -> bool,
) -> bool {
    (i > 0 && positive(i - 1, j))
        || (i + 1 < rows && positive(i + 1, j))
        || (j > 0 && positive(i, j - 1))
        || (j + 1 < columns && positive(i, j + 1))
}
