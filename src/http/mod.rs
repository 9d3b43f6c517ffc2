//! The HTTP contract: axum router, one file a resource.
