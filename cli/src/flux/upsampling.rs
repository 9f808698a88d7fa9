//! What stands between the frames of a simulation that has too few of them for sound.

use pyrophone_flame::upsample::{Method, Upsampler};

use crate::args::{FluxArgs, Kind, Measure, Upsample};
use crate::error::Error;
use crate::progress::note;

/// Steps per second that are made.
const TARGET_HZ: f64 = 360.0;

/// How far below that they may stay, so that television's rates take no step more than others.
const NEARLY: f64 = 0.98;

/// Steps per second from which nothing is added unless asked for.
const ENOUGH_HZ: f64 = 200.0;

/// The upsampler that is asked for, or that the rate calls for; says what is made up.
///
/// Fails where one is asked for and nobody knows the rate.
pub fn chosen(args: &FluxArgs, rate_hz: Option<f64>) -> Result<Option<Upsampler>, Error> {
    let is_envelope = args.sound.kind == Kind::Envelope;
    let method = match (args.upsample, rate_hz) {
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
            "{}: --upsample needs to know how many frames a second has; give the simulation's by --rate",
            args.input.display()
        );
        return Err(Error::Conflict(message));
    };
    if args.measure == Measure::Change && matches!(method, Method::Flips | Method::Release) {
        let message = "--measure change tells no parts of the flame apart; use --upsample noise, cubic or off with it";
        return Err(Error::Conflict(message.into()));
    }
    let substeps = (NEARLY * TARGET_HZ / rate_hz).ceil().max(1.0) as usize;
    if substeps == 1 {
        return Ok(None);
    }
    note(&format!(
        "{} steps per second are made of {rate_hz} frames (--upsample {}): above {:.1} Hz loudness and timbre are likely ones, but the phases are plausible, not true",
        rate_hz * substeps as f64,
        method.name(),
        0.5 * rate_hz
    ));
    Ok(Some(Upsampler::new(method, substeps, args.upsample_seed)?))
}
