//! The only place that knows every layer.
