//! The requested frames of a sequence, and the steps that they span.

use pyrophone_flame::import::Sequence;

use crate::args::FluxArgs;
use crate::error::Error;
use crate::frame_list::FrameList;
use crate::progress::note;

/// Frames that belong together: those of one run or of all parts.
#[derive(Debug, Clone)]
pub struct Whole {
    /// Indices into the sequence, ascending.
    pub indices: Vec<usize>,
    /// Steps that these frames span.
    pub span: Span,
}

/// Range of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Span {
    /// First step, with or without a file.
    pub first: i64,
    /// Last step, with or without a file.
    pub last: i64,
    /// First step that has a file.
    pub first_file: i64,
}

/// The frames and the missing steps of a list; without a list, all frames.
pub fn wanted(sequence: &Sequence, list: Option<&FrameList>) -> (Vec<usize>, Vec<i64>) {
    let is_wanted = |step: &i64| list.is_none_or(|list| list.holds(*step, sequence.numbering()));
    let frames = sequence.numbers().enumerate().filter(|(_, step)| is_wanted(step));
    (frames.map(|(index, _)| index).collect(), sequence.missing().into_iter().filter(is_wanted).collect())
}

/// Frames of all parts together, for a part that needs them.
pub fn whole(args: &FluxArgs, sequence: &Sequence, own: &[usize]) -> Result<Option<Whole>, Error> {
    if args.partial.with.is_empty() {
        return Ok(None);
    }
    let numbers: Vec<i64> = sequence.numbers().collect();
    let (indices, missing) = wanted(sequence, args.partial.of.as_ref());
    let span = span(&numbers, &indices, &missing);
    let is_outside = |index: &&usize| indices.binary_search(index).is_err();
    match (span, own.iter().find(is_outside), &args.partial.of) {
        (Some(span), None, _) => Ok(Some(Whole { indices, span })),
        (None, None, None) => Ok(None),
        (_, outside, list) => {
            let list = list.as_ref().map(ToString::to_string).unwrap_or_default();
            let which = outside.and_then(|index| numbers.get(*index)).map(|step| sequence.numbering().label(*step));
            let what = which
                .map_or("contains no frame".into(), |frame| format!("does not contain frame {frame} of this part"));
            let shown = args.input.display();
            Err(Error::Conflict(format!(
                "{shown}: --partial-of is {list}, which {what}; name the frames of all parts together"
            )))
        }
    }
}

/// First and last step, including missing steps; none without any frame.
pub fn span(numbers: &[i64], indices: &[usize], missing: &[i64]) -> Option<Span> {
    let step = |index: Option<&usize>| index.and_then(|index| numbers.get(*index)).copied();
    let (first_file, last_file) = (step(indices.first())?, step(indices.last())?);
    let first = missing.first().map_or(first_file, |missing| first_file.min(*missing));
    let last = missing.last().map_or(last_file, |missing| last_file.max(*missing));
    Some(Span { first, last, first_file })
}

/// Rejects missing frames, and a choice without any frame; only a shard may be empty.
pub fn check_wanted(args: &FluxArgs, sequence: &Sequence, indices: &[usize], missing: &[i64]) -> Result<(), Error> {
    let shown = args.input.display();
    if let (Some(step), false) = (missing.first(), args.skip_bad) {
        return Err(Error::Conflict(format!(
            "{shown}: frame {} is missing ({} in all); add the missing files, or interpolate them with --skip-bad",
            sequence.numbering().label(*step),
            missing.len()
        )));
    }
    let Some(list) = args.frames.as_ref().filter(|_| indices.is_empty()) else { return Ok(()) };
    let ends = [sequence.numbers().next(), sequence.numbers().last()];
    let [first, last] = ends.map(|step| sequence.numbering().label(step.unwrap_or_default()));
    let message = format!("--frames is {list}, but the frames in {shown} are {first}-{last}");
    if args.partial.file.is_none() {
        return Err(Error::Conflict(format!("{message}; choose from those")));
    }
    note(&format!("{message}: the part is empty"));
    Ok(())
}
