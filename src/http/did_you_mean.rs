//! The known name that a slip of the pen resembles.

use super::problem::FieldError;

/// The error for a name that is not known, with the known name it resembles.
#[must_use]
pub fn unknown(pointer: String, code: &str, name: &str, known: &[&str]) -> FieldError {
    let error = FieldError::new(pointer, code, format!("\"{name}\" is not known here"));
    match nearest(name, known) {
        Some(near) => error.hint(format!("did you mean \"{near}\"?")),
        None if known.is_empty() => error.hint("nothing is known here"),
        None => error.hint(format!("known here: {}", known.join(", "))),
    }
}

/// The known name that needs the fewest changes, if those are few enough to be
/// a slip: a third of its letters, at least one.
#[must_use]
pub fn nearest<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    /// Longer names are no slip of a short one, and comparing them is dear.
    const LONGEST: usize = 64;
    if name.len() > LONGEST {
        return None;
    }
    let plain = |s: &str| s.to_lowercase().replace('-', "_");
    let name = plain(name);
    known
        .iter()
        .map(|candidate| (changes(&name, &plain(candidate)), *candidate))
        .min_by_key(|(n, _)| *n)
        .filter(|(n, candidate)| *n <= (candidate.len() / 3).max(1))
        .map(|(_, candidate)| candidate)
}

/// Levenshtein distance: insertions, deletions and replacements.
fn changes(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_gets_the_name_it_resembles() {
        let hint = |name: &str| unknown(String::new(), "x", name, &["max_twist_deg", "ends"]).hint;
        assert_eq!(
            hint("max_twist").unwrap(),
            "did you mean \"max_twist_deg\"?"
        );
        assert_eq!(hint("Ends").unwrap(), "did you mean \"ends\"?");
        assert_eq!(hint("colour").unwrap(), "known here: max_twist_deg, ends");
    }
}
