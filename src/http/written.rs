//! Files that were written lately. A client that reads a file by ranges, or
//! asks for its size and then for itself, has it written once.

use super::methods::Form;
use crate::jobs::JobId;
use bytes::Bytes;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// Bytes that are kept at most; a hull's forms together are a few megabytes.
const MOST_BYTES: usize = 64 << 20;

/// What a file is known by. A result never changes, so its files do not either.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Key {
    /// The job.
    pub job: JobId,
    /// The name of a file of a part; none for the whole.
    pub part: Option<String>,
    /// Its form.
    pub form: Form,
}

/// The files, those used last at the end.
#[derive(Debug, Default)]
pub(super) struct Written {
    files: Mutex<VecDeque<(Key, Bytes)>>,
}

impl Written {
    /// The file, if it is kept. Whoever asks has made sure that the job is
    /// there and theirs.
    pub fn get(&self, key: &Key) -> Option<Bytes> {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        let at = files.iter().position(|(known, _)| known == key)?;
        let file = files.remove(at)?;
        let bytes = file.1.clone();
        files.push_back(file);
        Some(bytes)
    }

    /// Keeps a file; others go that were not used for long.
    pub fn keep(&self, key: Key, bytes: Bytes) {
        if bytes.len() > MOST_BYTES / 4 {
            return;
        }
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.retain(|(known, _)| *known != key);
        files.push_back((key, bytes));
        let mut total: usize = files.iter().map(|(_, b)| b.len()).sum();
        while total > MOST_BYTES {
            let Some((_, oldest)) = files.pop_front() else {
                break;
            };
            total -= oldest.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::methods::Format;

    fn key(job: JobId, format: Format) -> Key {
        Key {
            job,
            part: None,
            form: format.into(),
        }
    }

    #[test]
    fn files_are_known_by_job_and_form() {
        let written = Written::default();
        let [a, b] = [0, 1].map(|_| JobId::random());
        written.keep(key(a, Format::Obj), Bytes::from_static(b"a"));
        assert_eq!(written.get(&key(a, Format::Obj)).unwrap(), "a");
        assert_eq!(written.get(&key(a, Format::Stl)), None);
        assert_eq!(written.get(&key(b, Format::Obj)), None);
        let part = Key {
            part: Some("plate-1.obj".into()),
            ..key(a, Format::Obj)
        };
        assert_eq!(written.get(&part), None);
    }

    #[test]
    fn what_was_not_used_for_long_goes_first() {
        let written = Written::default();
        let job = JobId::random();
        let quarter = Bytes::from(vec![0; MOST_BYTES / 4]);
        let forms = [Format::Obj, Format::Stl, Format::Ply, Format::Glb];
        for format in forms {
            written.keep(key(job, format), quarter.clone());
        }
        assert!(written.get(&key(job, Format::Obj)).is_some());
        written.keep(key(job, Format::Step), quarter.clone());
        assert!(written.get(&key(job, Format::Obj)).is_some());
        assert!(written.get(&key(job, Format::Stl)).is_none());
        let huge = Bytes::from(vec![0; MOST_BYTES / 2]);
        written.keep(key(job, Format::Igs), huge);
        assert!(written.get(&key(job, Format::Igs)).is_none());
        assert!(written.get(&key(job, Format::Glb)).is_some());
    }
}
