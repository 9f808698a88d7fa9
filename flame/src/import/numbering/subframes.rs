//! Decision between readings of `fire.1.25`: frame 1.25, or frame 25 of `fire.1`.

use std::collections::{BTreeMap, BTreeSet};

use super::{MOST_SUBFRAMES, Name, Number};
use crate::import::format::Format;

/// The stems whose last two numbers are a frame and its fraction.
///
/// They are, if the first number varies and the second is one of a few even fractions of a frame. The frames of several
/// shots have two numbers as well, but their second one counts up.
pub fn stems<'a>(names: impl Iterator<Item = (Format, &'a Name)>) -> BTreeSet<(Format, String)> {
    let (mut read, mut whole) = (BTreeMap::<(Format, String), Vec<Number>>::new(), BTreeMap::<_, Vec<i64>>::new());
    for (format, name) in names {
        match name.with_fraction() {
            Some(name) => read.entry((format, name.stem())).or_default().push(name.number),
            None => whole.entry((format, name.stem())).or_default().push(name.number.whole),
        }
    }
    let are_subframes = |key: &(Format, String), numbers: &[Number]| {
        are_subframes(numbers, whole.get(key).map(Vec::as_slice).unwrap_or_default())
    };
    read.iter().filter(|(key, numbers)| are_subframes(key, numbers)).map(|(key, _)| key.clone()).collect()
}

/// True if `numbers` are sub-frames; `whole` are frames of the same name without a fraction.
fn are_subframes(numbers: &[Number], whole: &[i64]) -> bool {
    let wholes: BTreeSet<i64> = numbers.iter().map(|number| number.whole).chain(whole.iter().copied()).collect();
    let fractions: BTreeSet<&str> = numbers.iter().map(|number| number.fraction.as_str()).collect();
    let is_even = (2..=MOST_SUBFRAMES).any(|parts| {
        // As many fractions as possible, or nearly: a few that happen to fit a fine grid are not sub-frames.
        fractions.len() as i64 + 1 >= parts / 2 && numbers.iter().all(|number| number.fits(parts))
    });
    let is_one = fractions.iter().all(|fraction| fraction.chars().all(|digit| digit == '0'));
    wholes.len() > 1 && is_even && !is_one
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(names: &[&str]) -> Vec<String> {
        let names: Vec<Name> = names.iter().map(|name| Name::of_name(name).unwrap()).collect();
        stems(names.iter().map(|name| (Format::Vdb, name))).into_iter().map(|(_, stem)| stem).collect()
    }

    #[test]
    fn fractions_are_few_and_even() {
        assert_eq!(found(&["fire.1.25", "fire.1.5", "fire.1.75", "fire.2.25"]), ["fire."]);
        assert_eq!(found(&["fire.0001.50", "fire.0002.00", "fire.0002.50"]), ["fire."]);
        assert_eq!(found(&["fire.1.333", "fire.1.667", "fire.2.333"]), ["fire."]);
        assert_eq!(found(&["fire.1.5", "fire.2.5"]), ["fire."]);
        for shots in [
            &["shot.1.0001", "shot.1.0002", "shot.2.0001", "shot.2.0002"][..],
            &["shot.2.0001", "shot.2.0002", "shot.2.0003"],
            &["shot.1.1001", "shot.2.1001"],
            &["shot.1.0000", "shot.2.0000"],
        ] {
            assert_eq!(found(shots), Vec::<String>::new(), "{shots:?}");
        }
    }
}
