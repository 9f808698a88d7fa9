//! Additional steps between the frames of a simulation that has too few for sound.

use pyrophone_flame::upsample::{Method, Upsampler};

use crate::args::{FluxArgs, Measure, SoundKind, Upsample};
use crate::error::Error;
use crate::progress::note;

/// Steps per second to upsample to.
const TARGET_HZ: f64 = 360.0;

/// Tolerance below that rate, so that television rates need no more steps than others.
const NEARLY: f64 = 0.98;

/// Steps per second from which nothing is added unless requested.
const ENOUGH_HZ: f64 = 200.0;

/// The content of an input from which steps can be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// The parts of the flame.
    Fields,
    /// The change of the whole flame from frame to frame.
    Changes,
    /// A value per step.
    Series,
}

impl Content {
    /// What a simulation's frames give.
    pub fn of_measure(measure: Measure) -> Self {
        if measure == Measure::Change { Self::Changes } else { Self::Fields }
    }
}

/// The upsampler that was requested or that the rate calls for; notes what is estimated.
///
/// Fails if upsampling was requested and the rate is unknown, or if the method needs fields that there are not.
pub fn chosen(args: &FluxArgs, content: Content, rate_hz: Option<f64>) -> Result<Option<Upsampler>, Error> {
    let is_envelope = args.sound.kind == SoundKind::Envelope;
    let method = match (args.upsample.method, rate_hz) {
        (Upsample::Off, _) => return Ok(None),
        (Upsample::Auto, Some(rate_hz)) if rate_hz >= ENOUGH_HZ || is_envelope => return Ok(None),
        (Upsample::Auto, None) => return Ok(None),
        (Upsample::Auto, _) if content != Content::Fields => Method::Noise,
        (Upsample::Flips | Upsample::Auto, _) => Method::Flips,
        (Upsample::Release, _) => Method::Release,
        (Upsample::Noise, _) => Method::Noise,
        (Upsample::Cubic, _) => Method::Cubic,
    };
    let Some(rate_hz) = rate_hz else {
        let message = format!(
            "{}: --upsample needs the simulation's frames per second; give them with --rate",
            args.input.display()
        );
        return Err(Error::Conflict(message));
    };
    if content != Content::Fields && matches!(method, Method::Flips | Method::Release) {
        let what = match content {
            Content::Changes => "--measure change".to_owned(),
            _ => format!("{}: a series", args.input.display()),
        };
        let message =
            format!("{what} does not distinguish parts of the flame; use it with --upsample noise, cubic or off");
        return Err(Error::Conflict(message));
    }
    let substeps = (NEARLY * TARGET_HZ / rate_hz).ceil().max(1.0) as usize;
    if substeps == 1 {
        return Ok(None);
    }
    note(&format!(
        "{rate_hz} frames per second are upsampled to {} steps (--upsample {}): above {:.1} Hz, loudness and timbre are estimates, and phases are plausible, not true",
        rate_hz * substeps as f64,
        method.name(),
        0.5 * rate_hz
    ));
    Ok(Some(Upsampler::new(method, substeps, args.upsample.seed)?))
}
