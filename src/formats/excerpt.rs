//! Pieces of a file as they are repeated in an error.

/// Letters of the file repeated in an error.
const MOST_LETTERS: usize = 40;

/// At most [`MOST_LETTERS`] of a text, on one line.
pub(super) fn shortened(text: &str) -> String {
    let mut letters = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let mut kept: String = letters.by_ref().take(MOST_LETTERS).collect();
    if letters.next().is_some() {
        kept.push('…');
    }
    kept
}
