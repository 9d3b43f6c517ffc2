//! Numbers of binary files.

use super::error::{Fault, MeshReadError, Place};

/// Which byte of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Length in bytes.
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }
}

/// Reads numbers one after the other.
#[derive(Debug, Clone)]
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    at: usize,
    order: ByteOrder,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8], at: usize, order: ByteOrder) -> Self {
        Bytes { bytes, at, order }
    }

    /// Bytes that are left.
    pub fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }

    /// The next number; whole numbers of all types are exact in an `f64`.
    pub fn scalar(&mut self, kind: Scalar) -> Result<f64, MeshReadError> {
        Ok(match kind {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes, the least significant first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], MeshReadError> {
        let found = self.bytes.get(self.at..).and_then(|b| b.first_chunk::<N>());
        let Some(found) = found else {
            let place = Place::Byte(self.bytes.len());
            return Err(MeshReadError::new(place, "", Fault::EndsEarly));
        };
        self.at += N;
        let mut bytes = *found;
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// Passes over so many bytes.
    pub fn skip(&mut self, count: usize) -> Result<(), MeshReadError> {
        if count > self.left() {
            let place = Place::Byte(self.bytes.len());
            return Err(MeshReadError::new(place, "", Fault::EndsEarly));
        }
        self.at += count;
        Ok(())
    }
}
