//! A face: the vertices at its corners, in order around it.

/// A triangle or a quad, by the indices of its vertices, counterclockwise as
/// seen from the side that its normal points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    /// Three corners.
    Triangle([usize; 3]),
    /// Four corners, not necessarily in one plane.
    Quad([usize; 4]),
}

impl Face {
    /// A face of three or four corners; `None` for any other number.
    #[must_use]
    pub fn of(corners: &[usize]) -> Option<Face> {
        match *corners {
            [a, b, c] => Some(Face::Triangle([a, b, c])),
            [a, b, c, d] => Some(Face::Quad([a, b, c, d])),
            _ => None,
        }
    }

    /// The corners in order.
    #[must_use]
    pub fn corners(&self) -> &[usize] {
        match self {
            Face::Triangle(corners) => corners,
            Face::Quad(corners) => corners,
        }
    }

    /// The sides `(from, to)`, in the direction of the face.
    pub fn sides(&self) -> impl ExactSizeIterator<Item = (usize, usize)> + '_ {
        let corners = self.corners();
        (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]))
    }

    /// The same face seen from its other side; the first corner stays first.
    #[must_use]
    pub fn flipped(self) -> Face {
        match self {
            Face::Triangle([a, b, c]) => Face::Triangle([a, c, b]),
            Face::Quad([a, b, c, d]) => Face::Quad([a, d, c, b]),
        }
    }
}
