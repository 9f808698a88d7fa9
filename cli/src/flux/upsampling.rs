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

/// The upsampler that was requested or that the rate calls for; notes what is estimated.
///
/// Fails if upsampling was requested and the rate is unknown.
pub fn chosen(args: &FluxArgs, rate_hz: Option<f64>) -> Result<Option<Upsampler>, Error> {
    let is_envelope = args.sound.kind == SoundKind::Envelope;
    let method = match (args.upsample.method, rate_hz) {
        (Upsample::Off, _) => return Ok(None),
        (Upsample::Auto, Some(rate_hz)) if rate_hz >= ENOUGH_HZ || is_envelope => return Ok(None),
        (Upsample::Auto, None) => return Ok(None),
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
    if args.measure == Measure::Change && matches!(method, Method::Flips | Method::Release) {
        let message =
            "--measure change does not distinguish parts of the flame; use it with --upsample noise, cubic or off";
        return Err(Error::Conflict(message.into()));
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
