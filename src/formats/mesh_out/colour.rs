//! The colour of a number on a mesh: the ramp of the drawings, by magnitude.

use super::MeshDrawing;
use crate::formats::svg::colour;

/// A colour in linear sRGB and as 8-bit sRGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::formats) struct Rgb {
    /// Linear light, 0 to 1.
    pub linear: [f64; 3],
    /// Encoded.
    pub encoded: [u8; 3],
}

/// What has no number: a quiet grey blue.
const PLAIN: [u8; 3] = [0x8c, 0xa8, 0xc7];

/// The colours of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::formats) struct Colours {
    /// The magnitude at which they end.
    full: f64,
}

impl Colours {
    pub fn of(drawing: &MeshDrawing) -> Self {
        Colours {
            full: drawing.full_scale(),
        }
    }

    /// The colour of a number; of none where there is none.
    pub fn at(&self, value: Option<f64>) -> Rgb {
        let Some(value) = value else {
            return of_bytes(PLAIN);
        };
        // All zero: nothing is used of a scale that has no length.
        let share = if value == 0.0 {
            0.0
        } else {
            value.abs() / self.full
        };
        match colour::linear_of_share(share) {
            Some(linear) => Rgb {
                linear: linear.map(|c| c.clamp(0.0, 1.0)),
                encoded: linear.map(colour::encode),
            },
            None => of_bytes(colour::ABOVE_LIMIT_RGB),
        }
    }
}

fn of_bytes(encoded: [u8; 3]) -> Rgb {
    Rgb {
        linear: encoded.map(colour::decode),
        encoded,
    }
}
