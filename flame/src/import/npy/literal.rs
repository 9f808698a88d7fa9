//! The dictionary at the head of an array: a Python literal of three known entries.

use crate::import::error::{FormatFault, damaged};

/// The entries.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Literal {
    pub descr: String,
    pub fortran_order: bool,
    pub shape: Vec<usize>,
}

/// Parses the dictionary: keys in any order, either kind of quote, with or without a final comma.
pub(super) fn parse(text: &[u8]) -> Result<Literal, FormatFault> {
    let mut parser = Parser { text };
    let (mut descr, mut fortran_order, mut shape) = (None, None, None);
    let Some(()) = parser.token(b'{') else { return damaged("an array whose header is not a dictionary") };
    while parser.token(b'}').is_none() {
        let entry = parser.string().and_then(|key| parser.token(b':').map(|()| key));
        let found = match entry.as_deref() {
            Some("descr") if parser.next() == Some(b'[') => {
                return Err(FormatFault::Unsupported {
                    found: "an array of records".into(),
                    advice: "save an array of plain numbers such as float32",
                });
            }
            Some("descr") => parser.string().map(|found| descr = Some(found)),
            Some("fortran_order") => parser.truth().map(|found| fortran_order = Some(found)),
            Some("shape") => parser.tuple().map(|found| shape = Some(found)),
            _ => None,
        };
        let ended = found.and_then(|()| parser.token(b',').or_else(|| (parser.next() == Some(b'}')).then_some(())));
        if ended.is_none() {
            return damaged("an array whose header cannot be understood");
        }
    }
    match (descr, fortran_order, shape) {
        (Some(descr), Some(fortran_order), Some(shape)) => Ok(Literal { descr, fortran_order, shape }),
        _ => damaged("an array whose header lacks its type, order or shape"),
    }
}

struct Parser<'a> {
    text: &'a [u8],
}

impl Parser<'_> {
    /// The next byte that is not a space, left in place.
    fn next(&mut self) -> Option<u8> {
        self.text = self.text.trim_ascii_start();
        self.text.first().copied()
    }

    /// Consumes `expected` if it comes next.
    fn token(&mut self, expected: u8) -> Option<()> {
        let _ = self.next().filter(|found| *found == expected)?;
        self.text = self.text.get(1..)?;
        Some(())
    }

    fn string(&mut self) -> Option<String> {
        let quote = self.next().filter(|quote| matches!(quote, b'\'' | b'"'))?;
        let inside = self.text.get(1..)?;
        let length = inside.iter().position(|byte| *byte == quote)?;
        self.text = inside.get(length + 1..)?;
        Some(String::from_utf8_lossy(inside.get(..length)?).into_owned())
    }

    fn truth(&mut self) -> Option<bool> {
        let truth = self.next()? == b'T';
        self.text = self.text.strip_prefix(if truth { b"True".as_slice() } else { b"False" })?;
        Some(truth)
    }

    fn tuple(&mut self) -> Option<Vec<usize>> {
        self.token(b'(')?;
        let mut numbers = vec![];
        while self.token(b')').is_none() {
            numbers.push(self.number()?);
            if self.token(b',').is_none() && self.next()? != b')' {
                return None;
            }
        }
        Some(numbers)
    }

    fn number(&mut self) -> Option<usize> {
        self.next()?;
        let digits = self.text.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let number = std::str::from_utf8(self.text.get(..digits)?).ok()?.parse().ok()?;
        self.text = self.text.get(digits..)?;
        // Python 2 marks its long integers.
        self.text = self.text.strip_prefix(b"L").unwrap_or(self.text);
        Some(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: Option<(&str, bool, &[usize])>) {
        let found = parse(text.as_bytes()).ok();
        let expected = expected.map(|(descr, fortran_order, shape)| Literal {
            descr: descr.into(),
            fortran_order,
            shape: shape.into(),
        });
        assert_eq!(found, expected, "{text}");
    }

    #[test]
    fn every_way_to_write_it() {
        check("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }   \n", Some(("<f4", false, &[2, 3])));
        check("{\"shape\":(5,),\"fortran_order\":True,\"descr\":\"|u1\"}", Some(("|u1", true, &[5])));
        check(" { 'shape' : ( ) , 'descr' : '>f8' , 'fortran_order' : False } ", Some((">f8", false, &[])));
        check("{'descr': '<f4', 'fortran_order': False, 'shape': (2L, 3L), }", Some(("<f4", false, &[2, 3])));
    }

    #[test]
    fn malformed_headers_are_refused() {
        for text in [
            "",
            "{",
            "{'descr': '<f4'}",
            "{'descr': '<f4', 'fortran_order': 0, 'shape': (2,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (2 3)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (2,",
            "{'descr': '<f4', 'fortran_order': False, 'shape': 2}",
            "{'descr': '<f4' 'fortran_order': False, 'shape': (2,)}",
            "{'descr': '<f4, 'fortran_order': False, 'shape': (2,)}",
            "{'other': 1, 'descr': '<f4', 'fortran_order': False, 'shape': (2,)}",
        ] {
            check(text, None);
        }
    }
}
