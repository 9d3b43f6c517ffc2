//! All files of a result in one, the same bytes for the same result: no times,
//! one order, one compression.

use super::methods::{self, Document, Format};
use super::problem::ApiError;
use bytes::Bytes;
use std::io::{Cursor, Write as _};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The job as it was posted, the result, and every form that it has.
///
/// # Errors
/// A form that cannot be written, a fault of ours.
pub(super) fn pack(
    document: &dyn Document,
    input: &Bytes,
    result: &Bytes,
) -> Result<Vec<u8>, ApiError> {
    let mut files = vec![
        ("job.json".to_owned(), input.to_vec()),
        ("result.json".to_owned(), result.to_vec()),
    ];
    for format in document.formats() {
        if !matches!(format, Format::Json | Format::Zip) {
            let bytes = methods::document::write(document, format.into())?;
            files.push((format!("result.{}", format.extension()), bytes));
        }
    }
    zipped(&files).map_err(|e| ApiError::internal(&e))
}

fn zipped(files: &[(String, Vec<u8>)]) -> zip::result::ZipResult<Vec<u8>> {
    // The first time that the format knows, 1980-01-01.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        archive.start_file(name.as_str(), options)?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read as _;

    #[test]
    fn files_come_out_as_they_went_in_and_twice_the_same() {
        let files = [
            ("job.json".to_owned(), b"{}\n".to_vec()),
            ("result.stl".to_owned(), vec![7; 10_000]),
        ];
        let bytes = zipped(&files).unwrap();
        assert!(bytes.len() < 1_000, "{}", bytes.len());
        assert_eq!(bytes, zipped(&files).unwrap());
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        for (name, expected) in &files {
            let mut file = archive.by_name(name).unwrap();
            let mut read = Vec::new();
            file.read_to_end(&mut read).unwrap();
            assert_eq!(&read, expected);
        }
    }
}
