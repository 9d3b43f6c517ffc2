//! The durable queue: state machine, store, workers.
