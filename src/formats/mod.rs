//! Bytes ↔ geometry: what leaves the loft as a file.
