//! Offset tables faired as one surface.
