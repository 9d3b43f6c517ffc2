//! Widths of text without a font at hand: estimates on the safe side, so that
//! what is wrapped by them fits in whatever typeface the reader has.

/// Widest of the usual substitutes (DejaVu Sans) against Helvetica, whose
/// widths the table below rounds.
const SUBSTITUTE: f64 = 1.17;
/// Added to a line that was cut off.
const ELLIPSIS: char = '…';

/// Estimated width of a text at the given height of type, in the same unit.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(em).sum::<f64>() * size * SUBSTITUTE
}

/// Advance of a character in Helvetica, in units of the type's height.
fn em(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' | '|' => 0.25,
        'f' | 't' | 'r' | ' ' | '.' | ',' | ':' | ';' | '!' | '(' | ')' | '[' | ']' | '/' | '-' => {
            0.34
        }
        'm' | 'M' | 'W' | '%' | '@' | '—' | '…' => 0.95,
        'A'..='Z' | 'w' | '&' => 0.72,
        '0'..='9' | 'a'..='z' | ' '..='~' => 0.56,
        // Latin letters with accents, Greek, Cyrillic, punctuation.
        '\u{80}'..='\u{2fff}' => 0.75,
        // Full-width scripts.
        _ => 1.1,
    }
}

/// Breaks a text into lines no wider than `limit`, between words where it can
/// and inside a word where it must. Never empty.
pub(super) fn wrap(text: &str, size: f64, limit: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        for piece in pieces(word, size, limit) {
            let line = lines.last_mut();
            match line {
                Some(line) if line.is_empty() => *line = piece,
                Some(line)
                    if width(line, size) + width(&piece, size) + width(" ", size) <= limit =>
                {
                    line.push(' ');
                    line.push_str(&piece);
                }
                _ => lines.push(piece),
            }
        }
    }
    lines
}

/// A word in parts that fit, mostly the word itself.
fn pieces(word: &str, size: f64, limit: f64) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut used = 0.0;
    for c in word.chars() {
        let step = em(c) * size * SUBSTITUTE;
        if used + step > limit && used > 0.0 {
            parts.push(String::new());
            used = 0.0;
        }
        if let Some(part) = parts.last_mut() {
            part.push(c);
        }
        used += step;
    }
    parts
}

/// The text, cut off with an ellipsis where it is wider than `limit`.
pub(super) fn clip(text: &str, size: f64, limit: f64) -> String {
    if width(text, size) <= limit {
        return text.to_owned();
    }
    let mut kept = String::new();
    for c in text.chars() {
        if width(&kept, size) + width(&format!("{c}{ELLIPSIS}"), size) > limit {
            break;
        }
        kept.push(c);
    }
    kept.push(ELLIPSIS);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_and_lose_no_word() {
        let text = "Plate 3 (lower chine – profile): worst twist 4.4° at x = 69.1, limit 6.0°.";
        let lines = wrap(text, 3.0, 60.0);
        assert!(
            lines.len() > 1 && lines.iter().all(|l| width(l, 3.0) <= 60.0),
            "{lines:?}"
        );
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn endless_words_are_broken() {
        let word = "x".repeat(500);
        let lines = wrap(&word, 3.0, 40.0);
        assert!(lines.iter().all(|l| width(l, 3.0) <= 40.0));
        assert_eq!(lines.concat(), word);
    }

    #[test]
    fn clipping_marks_the_loss() {
        assert_eq!(clip("short", 3.0, 50.0), "short");
        let clipped = clip(&"long ".repeat(50), 3.0, 50.0);
        assert!(clipped.ends_with('…') && width(&clipped, 3.0) <= 50.0);
    }
}
