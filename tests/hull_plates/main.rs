//! The method `hull_plates`, held to its figures from outside.
//!
//! Everything about a delivered plate is measured again by `checker`, which
//! shares no code with the method; the method's own figures are only compared
//! with what the checker finds.

// Tests may panic; comparisons are written so that NaN fails them.
#![allow(
    clippy::unwrap_used,
    clippy::neg_cmp_op_on_partial_ord,
    clippy::redundant_closure,
    dead_code
)]

mod checker;
mod control;
mod hulls;
mod inputs;
mod invariance;
mod random;
mod support;
mod trawler;
mod verdicts;
