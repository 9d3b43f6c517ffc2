//! Blobs as they lie in a row: compressed by zstd, with their length beside.

use bytes::Bytes;

use super::StoreError;

/// zstd's own default: JSON shrinks about five times at some 300 MB/s; higher
/// levels gain little on numbers.
const LEVEL: i32 = 3;

/// A compressed blob.
#[derive(Debug, Clone)]
pub(crate) struct Packed {
    /// The zstd frame.
    pub data: Vec<u8>,
    /// Length before compression, in bytes.
    pub raw_len: u64,
}

impl Packed {
    /// Compresses `raw`.
    ///
    /// # Errors
    /// `Busy` if there is no memory for it just now.
    pub fn pack(raw: &[u8]) -> Result<Self, StoreError> {
        let data = zstd::bulk::compress(raw, LEVEL)
            .map_err(|e| StoreError::Busy(format!("compressing {} bytes: {e}", raw.len())))?;
        Ok(Packed {
            data,
            raw_len: raw.len() as u64,
        })
    }

    /// The bytes as they were.
    ///
    /// # Errors
    /// `Corrupt` if the frame is not one of `raw_len` bytes.
    pub fn unpack(&self) -> Result<Bytes, StoreError> {
        let corrupt = |what: String| StoreError::Corrupt(format!("blob: {what}"));
        let len = usize::try_from(self.raw_len).map_err(|e| corrupt(e.to_string()))?;
        let raw = zstd::bulk::decompress(&self.data, len).map_err(|e| corrupt(e.to_string()))?;
        if raw.len() == len {
            Ok(Bytes::from(raw))
        } else {
            Err(corrupt(format!("{} bytes instead of {len}", raw.len())))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_as_they_were() {
        for raw in [&b""[..], b"{}\n", &[0, 255, 7].repeat(100_000)] {
            assert_eq!(Packed::pack(raw).unwrap().unpack().unwrap(), raw);
        }
    }

    #[test]
    fn a_damaged_frame_is_told() {
        let mut packed = Packed::pack(b"a hull of three plates").unwrap();
        packed.raw_len += 1;
        assert!(matches!(packed.unpack(), Err(StoreError::Corrupt(_))));
        packed.data.truncate(5);
        assert!(matches!(packed.unpack(), Err(StoreError::Corrupt(_))));
    }
}
