//! Where a page of jobs ended: the last job's moment and id, as one opaque
//! word. Both are known to who sees the page, so the word gives nothing away
//! (a row number would tell how many jobs others have).

use crate::jobs::model::{JobId, Timestamp};

/// The place after one job in a list that is newest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cursor {
    /// When the job was accepted.
    pub created: Timestamp,
    /// Its id, for jobs of the same millisecond.
    pub id: JobId,
}

/// Marks the form, so that another may come.
const PREFIX: &str = "c1";

impl Cursor {
    /// The word to hand out.
    #[must_use]
    pub fn to_word(&self) -> String {
        format!(
            "{PREFIX}{:016x}{}",
            self.created.as_millis(),
            self.id.as_uuid().simple()
        )
    }

    /// The place that a word means; none if it was not made here.
    #[must_use]
    pub fn parse(word: &str) -> Option<Self> {
        let rest = word.strip_prefix(PREFIX)?;
        let (created, id) = rest.split_at_checked(16)?;
        let created = u64::from_str_radix(created, 16).ok()?;
        let cursor = Cursor {
            created: Timestamp::from_millis(created.cast_signed()),
            id: id.parse().ok()?,
        };
        (cursor.to_word() == word).then_some(cursor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_means_its_place() {
        for ms in [0, 1_700_000_000_123, -5] {
            let cursor = Cursor {
                created: Timestamp::from_millis(ms),
                id: JobId::random(),
            };
            assert_eq!(Cursor::parse(&cursor.to_word()), Some(cursor));
        }
    }

    #[test]
    fn other_words_mean_nothing() {
        for word in ["", "c1", "c1ü", "c2zz", "c1+000000000000001", "x"] {
            assert_eq!(Cursor::parse(word), None, "{word}");
        }
        let good = Cursor {
            created: Timestamp::from_millis(7),
            id: JobId::random(),
        }
        .to_word();
        assert_eq!(Cursor::parse(&good.to_uppercase()), None);
        assert_eq!(Cursor::parse(&format!("{good}0")), None);
    }
}
