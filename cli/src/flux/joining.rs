//! Joining what parts hold beside their tables.

use std::path::Path;

use super::extras::{Fronts, PartExtras, path_of};
use super::facts::CacheFacts;
use super::measuring::Span;
use super::motion::{Speeds, Survey};
use crate::error::Error;

/// The extras of some parts, with their names.
pub struct Extras(Vec<(String, PartExtras)>);

impl Extras {
    /// Reads those of all parts; none where no part has any.
    ///
    /// # Errors
    /// Where some have them and others do not, or where one belongs to another state of its part.
    pub fn read(parts: &[&Path]) -> Result<Option<Self>, Error> {
        if parts.iter().all(|part| !path_of(part).exists()) {
            return Ok(None);
        }
        let read = |part: &&Path| Ok((part.display().to_string(), PartExtras::read(part)?));
        parts.iter().map(read).collect::<Result<_, Error>>().map(|extras| Some(Self(extras)))
    }

    /// Refuses parts that are not all those they were measured as: frames were chosen from the whole.
    ///
    /// # Errors
    /// With the first part of another whole than steps `first` to `last`.
    pub fn check(&self, first: i64, last: i64, label: impl Fn(i64) -> String) -> Result<(), Error> {
        let is_other = |(_, extras): &&(String, PartExtras)| (extras.span.first, extras.span.last) != (first, last);
        let Some((name, PartExtras { span, .. })) = self.0.iter().find(is_other) else { return Ok(()) };
        let [whole_first, whole_last, first, last] = [span.first, span.last, first, last].map(label);
        Err(Error::Conflict(format!(
            "{name}: it was measured as a part of frames {whole_first}-{whole_last}, but the parts together are {first}-{last}; add the parts that are missing, or measure them with --partial-of {first}-{last}"
        )))
    }

    /// The speeds of all parts.
    ///
    /// # Errors
    /// With the first part that has none, or that measured them in another way than the first.
    pub fn speeds(&self) -> Result<(Survey, Speeds), Error> {
        let mut joined: Option<(Survey, Speeds)> = None;
        for (name, extras) in &self.0 {
            let Some((survey, speeds)) = &extras.speeds else { return Err(no_speeds(name)) };
            let (first, all) = joined.get_or_insert_with(|| (*survey, Speeds::new()));
            if first != survey {
                let message = format!(
                    "{name}: its flow was measured at another rate or in another box than that of {}; measure all parts alike",
                    self.0[0].0
                );
                return Err(Error::Conflict(message));
            }
            all.extend(speeds.iter().map(|(step, speeds)| (*step, speeds.clone())));
        }
        joined.ok_or_else(|| pyrophone_flame::Error::NoFrames.into())
    }

    /// The facts and the fronts of all parts, and the whole's span; none where a part has no fronts.
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

/// The refusal where a speed field is wanted of parts that have none.
pub fn no_speeds(part: &str) -> Error {
    Error::Conflict(format!(
        "{part}: this part holds no speeds; measure all parts with --partial-with speed-field, or leave out --speed-field"
    ))
}
