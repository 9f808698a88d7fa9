//! Joining of the parts' extra data.

use std::path::Path;

use super::extras::{Fronts, PartExtras, path_of};
use super::facts::CacheFacts;
use super::measuring::Span;
use super::motion::{Speeds, Survey};
use crate::error::Error;

/// The extra data of some parts, with the parts' names.
pub struct Extras(Vec<(String, PartExtras)>);

impl Extras {
    /// Reads the extra data of all parts; none if no part has any.
    ///
    /// # Errors
    /// If only some parts have extra data, or if one file does not match its part.
    pub fn read(parts: &[&Path]) -> Result<Option<Self>, Error> {
        if parts.iter().all(|part| !path_of(part).exists()) {
            return Ok(None);
        }
        let read = |part: &&Path| Ok((part.display().to_string(), PartExtras::read(part)?));
        parts.iter().map(read).collect::<Result<_, Error>>().map(|extras| Some(Self(extras)))
    }

    /// Rejects an incomplete set of parts: frames were chosen from the whole that each part was measured for.
    ///
    /// # Errors
    /// Names the first part that was measured for a whole other than steps `first` to `last`.
    pub fn check(&self, first: i64, last: i64, label: impl Fn(i64) -> String) -> Result<(), Error> {
        let is_other = |(_, extras): &&(String, PartExtras)| (extras.span.first, extras.span.last) != (first, last);
        let Some((name, PartExtras { span, .. })) = self.0.iter().find(is_other) else { return Ok(()) };
        let [whole_first, whole_last, first, last] = [span.first, span.last, first, last].map(label);
        Err(Error::Conflict(format!(
            "{name}: it was measured as a part of frames {whole_first}-{whole_last}, but the parts together cover {first}-{last}; add the missing parts, or measure these again with --partial-of {first}-{last}"
        )))
    }

    /// Speeds of all parts.
    ///
    /// # Errors
    /// Names the first part that has none, or that measured them differently from the first part.
    pub fn speeds(&self) -> Result<(Survey, Speeds), Error> {
        let mut joined: Option<(Survey, Speeds)> = None;
        for (name, extras) in &self.0 {
            let Some((survey, speeds)) = &extras.speeds else { return Err(no_speeds(name)) };
            let (first, all) = joined.get_or_insert_with(|| (*survey, Speeds::new()));
            if first != survey {
                let message = format!(
                    "{name}: its flow was measured at a different rate or in a different box from that of {}; measure all parts with the same options",
                    self.0[0].0
                );
                return Err(Error::Conflict(message));
            }
            all.extend(speeds.iter().map(|(step, speeds)| (*step, speeds.clone())));
        }
        joined.ok_or_else(|| pyrophone_flame::Error::NoFrames.into())
    }

    /// Facts and fronts of all parts, and the span of the whole; none if a part has no fronts.
    pub fn report(&self) -> Option<(CacheFacts, Fronts, Span)> {
        let mut fronts = vec![];
        for (_, extras) in &self.0 {
            fronts.extend(extras.fronts.as_ref()?.iter().cloned());
        }
        fronts.sort_by_key(|(step, _)| *step);
        let (_, first) = self.0.first()?;
        // Only parts in which something burns know sizes; the first of these is the one that one run would look at.
        let sizes = self.0.iter().filter(|(_, extras)| extras.facts.size.is_some());
        let size = sizes.min_by_key(|(_, extras)| extras.first_own).and_then(|(_, extras)| extras.facts.size.clone());
        Some((CacheFacts { size, ..first.facts.clone() }, fronts, first.span))
    }
}

/// Error for a speed field requested from parts that have none.
pub fn no_speeds(part: &str) -> Error {
    Error::Conflict(format!(
        "{part}: this part contains no speeds; measure all parts with --partial-with speed-field, or leave out --speed-field"
    ))
}
