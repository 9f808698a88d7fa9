//! Comparison of names as people read them, ignoring case and the encoding of accented letters; and suggestions for
//! misspelt names.

use unicode_normalization::UnicodeNormalization;

/// The form in which names are compared: composed (NFC), in lower case, without spaces around it.
///
/// macOS stores file names decomposed, so the same name may have different bytes in a file and from a keyboard.
pub(crate) fn folded(name: &str) -> String {
    let lower = name.trim().nfc().collect::<String>().to_lowercase();
    // A lower-case letter may decompose although its capital does not (İ, for one).
    lower.nfc().collect()
}

/// The most similar of the `known` names, if at most a third of it, or two characters, are mistyped.
pub(crate) fn nearest(found: &str, known: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let (distance, name) = known.map(|name| (edits(name, found), name)).min()?;
    // Two, for swapped letters. For the shortest names, that would match nearly all others.
    let allowed = (name.len() / 3).max(if name.len() < 5 { 1 } else { 2 });
    (distance <= allowed).then_some(name)
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(64).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::{folded, nearest};

    #[test]
    fn case_and_unicode_form_do_not_tell_names_apart() {
        assert_eq!(folded(" Zu\u{308}ndholz "), folded("ZÜNDHOLZ"));
        assert_eq!(folded("İ"), folded("I\u{307}"));
        assert_ne!(folded("Zundholz"), folded("Zündholz"));
    }

    #[test]
    fn misspelt_names_find_the_one_that_was_meant() {
        let known = ["gate", "alpha", "scaling_alpha"];
        for (found, expected) in
            [("alhpa", Some("alpha")), ("scaling-alfa", Some("scaling_alpha")), ("gat", Some("gate")), ("gong", None)]
        {
            assert_eq!(nearest(found, known.into_iter()), expected, "{found}");
        }
        assert_eq!(nearest("alpha", [].into_iter()), None);
    }
}
