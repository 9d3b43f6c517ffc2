//! The port through which the queue runs a method without knowing the wire.

use crate::methods::{Control, Stop};

use super::model::Verdict;

/// Runs methods. Called on the threads of the fitting pool, several at once.
pub trait Engine: Send + Sync + 'static {
    /// Runs `method` on `input`, which are the bytes that were submitted.
    /// Must be a pure function of the two; polls `control` at least every
    /// 50 ms and may use rayon, which is the same pool here.
    ///
    /// # Errors
    /// See [`EngineError`]. A panic is caught by the queue and fails the job.
    fn run(
        &self,
        method: &str,
        input: &[u8],
        control: &dyn Control,
    ) -> Result<Product, EngineError>;
}

/// What a method made.
#[derive(Debug, Clone, PartialEq)]
pub struct Product {
    /// The result, kept and given back byte for byte.
    pub result: Vec<u8>,
    /// The diagnostics, kept and given back byte for byte.
    pub diagnostics: Vec<u8>,
    /// Whether every limit is kept.
    pub verdict: Verdict,
    /// What the owner should know; added to the job's warnings.
    pub warnings: Vec<String>,
    /// One sentence about the outcome.
    pub message: String,
}

/// Why a method made nothing. None of these is tried again.
#[derive(Debug, Clone, PartialEq)]
pub enum EngineError {
    /// The input breaks rules that only the method could check.
    Invalid {
        /// A sentence for people.
        detail: String,
        /// The broken rules, as JSON text.
        errors_json: String,
    },
    /// It did as its control asked.
    Stopped(Stop),
    /// It broke down.
    Failed {
        /// A stable word for programmes.
        code: String,
        /// A sentence for people.
        detail: String,
        /// What it can say about the state it broke down in.
        diagnostics: Option<Vec<u8>>,
    },
}
