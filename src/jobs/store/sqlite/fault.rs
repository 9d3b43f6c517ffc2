//! What SQLite says, sorted into what a caller can do about it.

use rusqlite::ErrorCode;
use rusqlite::ffi::SQLITE_IOERR_SHMSIZE;

use crate::jobs::store::StoreError;

impl From<rusqlite::Error> for StoreError {
    /// Full and busy are told apart because they pass. An error of input and
    /// output is `Broken`: after a failed fsync nobody knows what is on the
    /// disk. Whatever is left would be a defect of ours in one statement.
    fn from(error: rusqlite::Error) -> Self {
        let text = error.to_string();
        match error {
            rusqlite::Error::SqliteFailure(code, _) => sort(code, text),
            rusqlite::Error::FromSqlConversionFailure(..)
            | rusqlite::Error::IntegralValueOutOfRange(..)
            | rusqlite::Error::InvalidColumnType(..) => StoreError::Corrupt(text),
            _ => StoreError::Defect(text),
        }
    }
}

fn sort(code: rusqlite::ffi::Error, text: String) -> StoreError {
    if code.extended_code == SQLITE_IOERR_SHMSIZE {
        return StoreError::Full;
    }
    match code.code {
        ErrorCode::DiskFull => StoreError::Full,
        ErrorCode::DatabaseBusy
        | ErrorCode::DatabaseLocked
        | ErrorCode::FileLockingProtocolFailed
        | ErrorCode::OutOfMemory
        | ErrorCode::ReadOnly
        | ErrorCode::CannotOpen => StoreError::Busy(text),
        ErrorCode::SystemIoFailure | ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase => {
            StoreError::Broken(text)
        }
        _ => StoreError::Defect(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rusqlite::ffi;

    #[test]
    fn what_passes_is_told_from_what_stays() {
        let of =
            |code| StoreError::from(rusqlite::Error::SqliteFailure(ffi::Error::new(code), None));
        assert_eq!(of(ffi::SQLITE_FULL), StoreError::Full);
        assert!(matches!(of(ffi::SQLITE_BUSY), StoreError::Busy(_)));
        assert!(matches!(of(ffi::SQLITE_IOERR_FSYNC), StoreError::Broken(_)));
        assert!(matches!(of(ffi::SQLITE_CORRUPT), StoreError::Broken(_)));
        assert!(matches!(of(ffi::SQLITE_CONSTRAINT), StoreError::Defect(_)));
    }
}
