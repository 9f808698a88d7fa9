//! Film time: the position of a simulation's first frame, and the metadata that state it.

use crate::args::TimelineArgs;
use crate::error::Error;
use crate::flux::signal::Signal;

/// Position of the first step on the timeline in seconds; none without a film rate.
///
/// Fails if the film frame is unknown or lies before the start of the timeline.
pub fn place_s(args: &TimelineArgs, signal: &Signal) -> Result<Option<f64>, Error> {
    let Some(rate) = args.film_rate else { return Ok(None) };
    let at_start_s = args.timecode.map_or(Ok(0.0), |timecode| timecode.seconds(rate))?;
    let frames_hz = signal.measured_hz() / signal.numbering.steps_per_frame();
    let given = args.film_frame.map(|frame| frame as f64);
    let first = match signal.film_frame.or(given) {
        Some(frame) => frame,
        None if (frames_hz / rate.hz() - 1.0).abs() < 1e-3 => signal.first_number(),
        None => {
            let message = format!(
                "the simulation has {frames_hz} frames per second and the film {}, so their frame numbers differ; give the film frame of the simulation's first frame with --film-frame",
                rate.hz()
            );
            return Err(Error::Conflict(message));
        }
    };
    let place_s = at_start_s + (first - args.timeline_start as f64) / rate.hz();
    if place_s < 0.0 {
        let message = format!(
            "the first frame is {:.3} s before the timeline's start (--film-frame {first}, --timeline-start {}); start the timeline there or earlier",
            -place_s, args.timeline_start
        );
        return Err(Error::Conflict(message));
    }
    Ok(Some(place_s))
}

/// The iXML chunk (iXML 1.61), which editing programs read as well as the time stamp.
pub fn ixml(args: &TimelineArgs, place_samples: u64, sample_rate_hz: u32) -> Option<String> {
    if args.film_rate.is_none() && args.scene.is_none() && args.take.is_none() {
        return None;
    }
    let escaped = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let entry = |name: &str, text: &Option<String>| {
        text.as_ref().map_or(String::new(), |text| format!("<{name}>{}</{name}>", escaped(text)))
    };
    let flag = if args.timecode.is_some_and(|timecode| timecode.is_drop) { "DF" } else { "NDF" };
    let speed = args.film_rate.map_or(String::new(), |rate| {
        format!(
            "<SPEED><MASTER_SPEED>{rate}</MASTER_SPEED><CURRENT_SPEED>{rate}</CURRENT_SPEED><TIMECODE_RATE>{rate}</TIMECODE_RATE><TIMECODE_FLAG>{flag}</TIMECODE_FLAG><FILE_SAMPLE_RATE>{sample_rate_hz}</FILE_SAMPLE_RATE><TIMESTAMP_SAMPLES_SINCE_MIDNIGHT_HI>{}</TIMESTAMP_SAMPLES_SINCE_MIDNIGHT_HI><TIMESTAMP_SAMPLES_SINCE_MIDNIGHT_LO>{}</TIMESTAMP_SAMPLES_SINCE_MIDNIGHT_LO><TIMESTAMP_SAMPLE_RATE>{sample_rate_hz}</TIMESTAMP_SAMPLE_RATE></SPEED>",
            place_samples >> 32,
            place_samples & 0xffff_ffff
        )
    });
    let (scene, take) = (entry("SCENE", &args.scene), entry("TAKE", &args.take));
    Some(format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?><BWFXML><IXML_VERSION>1.61</IXML_VERSION>{scene}{take}{speed}</BWFXML>"
    ))
}
