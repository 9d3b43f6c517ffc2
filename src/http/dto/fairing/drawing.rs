//! From a stored result to what the file writers draw.

use super::FairingResult;
use crate::http::dto::job::VerdictWord;
use crate::http::methods::Format;
use crate::http::problem::{ApiError, Code};

impl FairingResult {
    /// Whether every point keeps its tolerance.
    #[must_use]
    pub fn is_within_limits(&self) -> bool {
        self.verdict == VerdictWord::WithinLimits
    }

    /// The result in another form.
    ///
    /// # Errors
    /// `format-not-available`.
    pub fn write(&self, format: Format) -> Result<String, ApiError> {
        let _ = format;
        Err(ApiError::new(Code::FormatNotAvailable, "not yet"))
    }
}
