//! Comparing names as people do: without regard to case, or to how a letter with an accent is encoded.

use unicode_normalization::UnicodeNormalization;

/// The form in which names are compared: composed (NFC), in lower case, without spaces around it.
///
/// macOS stores file names decomposed, so one name may come in other bytes from a file than from a keyboard.
pub(crate) fn folded(name: &str) -> String {
    let lower = name.trim().nfc().collect::<String>().to_lowercase();
    // A lower-case letter may decompose where its capital does not (İ, for one).
    lower.nfc().collect()
}

#[cfg(test)]
mod tests {
    use super::folded;

    #[test]
    fn case_and_unicode_form_do_not_tell_names_apart() {
        assert_eq!(folded(" Zu\u{308}ndholz "), folded("ZÜNDHOLZ"));
        assert_eq!(folded("İ"), folded("I\u{307}"));
        assert_ne!(folded("Zundholz"), folded("Zündholz"));
    }
}
