//! The loudness of what is added between frames, estimated from the frames' flux.
//!
//! A flame is the louder, the more it burns, and the more its flux differs from a smooth curve. Both are known at the
//! frames. The constants are means over the eight scenes and the three flames published with Chadwick & James 2011, all
//! of them at 360 steps per second and thinned out to 24, 30, 60 and 120.

use super::filter;

/// Lowest frequency of the added steps, as a share of the frame rate; below it, the curve through the frames is used.
const CORNER: f64 = 0.45;

/// Contribution of the difference between a frame's neighbours to its loudness. With it, a flux that passes through zero
/// does not fall silent there.
const SLOPE_SHARE: f64 = 0.25;

/// Level of the added pressure (flux per step) relative to the product of loudness and unsteadiness, in dB: at one step
/// from each frame to the next, and its change for each doubling of their number. The deviation over the eleven flames
/// is 2 dB.
const LEVEL_DB: [f64; 2] = [-8.6, -1.3];

/// Steps over which the loudness of a carrier is measured, before and after each.
const MEASURED_STEPS: f64 = 3.0;

/// Loudness of a carrier, relative to its mean, below which it is not raised further.
const QUIETEST: f64 = 0.01;

/// Signal to add to a curve through `values`: flux of the pressure `carrier`, whose own loudness is replaced by the
/// flame's. It has `substeps` steps for each value. Silent if there are fewer than three values.
pub fn shaped(values: &[f64], carrier: &[f64], substeps: usize) -> Vec<f64> {
    let loudness = loudness(values);
    let at = |step: usize| {
        let (frame, share) = (step / substeps, (step % substeps) as f64 / substeps as f64);
        let next = loudness[(frame + 1).min(loudness.len() - 1)];
        loudness[frame] * (1.0 - share) + next * share
    };
    let mut pressure = levelled(carrier);
    let (mut found, mut wanted) = (0.0, 0.0);
    for (step, pressure) in pressure.iter_mut().enumerate() {
        *pressure *= at(step);
        found += maths::square(*pressure);
        wanted += maths::square(at(step));
    }
    if found > 0.0 {
        let level_db = LEVEL_DB[0] + LEVEL_DB[1] * maths::log2(substeps as f64);
        let gain = unsteadiness(values, &loudness) * maths::pow(10.0, level_db / 20.0) * (wanted / found).sqrt();
        pressure.iter_mut().for_each(|pressure| *pressure *= gain);
    }
    flux(&pressure, CORNER / substeps as f64)
}

/// The loudness at every frame, in units of flux.
fn loudness(values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let slope = |frame: usize| values[(frame + 1).min(last)] - values[frame.saturating_sub(1)];
    values.iter().enumerate().map(|(frame, flux)| flux.abs() + SLOPE_SHARE * slope(frame).abs()).collect()
}

/// The mean distance from a smooth curve, as a share of the loudness: of second differences, because these are small for
/// whatever is slow. Sums of absolute values are less sensitive to a single burst or ignition than squares.
fn unsteadiness(values: &[f64], loudness: &[f64]) -> f64 {
    let bends: f64 = values.windows(3).map(|near| (near[0] - 2.0 * near[1] + near[2]).abs()).sum();
    let whole: f64 = loudness.iter().skip(1).take(values.len().saturating_sub(2)).sum();
    if whole > 0.0 { bends / whole } else { 0.0 }
}

/// The carrier at an even loudness.
fn levelled(carrier: &[f64]) -> Vec<f64> {
    let power: Vec<f64> = carrier.iter().copied().map(maths::square).collect();
    let mean = power.iter().sum::<f64>() / power.len().max(1) as f64;
    let least = (mean * maths::square(QUIETEST)).max(f64::MIN_POSITIVE);
    let power = filter::smoothed(&power, MEASURED_STEPS);
    carrier.iter().zip(power).map(|(carrier, power)| carrier / power.max(least).sqrt()).collect()
}

/// The flux whose change per step is the pressure, above `corner` (cycles per step).
fn flux(pressure: &[f64], corner: f64) -> Vec<f64> {
    // Silence before the start, into which the filter rings, so that the sum begins at zero.
    let before = filter::ringing_steps(corner);
    let padded: Vec<f64> = std::iter::repeat_n(0.0, before).chain(pressure.iter().copied()).collect();
    let mut sum = 0.0;
    let sums = filter::high_passed(&padded, corner).into_iter().map(|pressure| {
        sum += pressure;
        sum
    });
    sums.skip(before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of a burst, and a carrier that is loud elsewhere: the burst decides.
    #[test]
    fn loudness_is_the_flux_and_not_the_carriers() {
        let values: Vec<f64> =
            (0..48).map(|frame| if frame / 12 == 2 { 5.0 + f64::from(frame % 2) } else { 0.5 }).collect();
        let level = |step: usize| if step < 240 { 40.0 } else { 1.0 };
        let wave = |step: usize| level(step) * (1.9 * step as f64).sin();
        let carrier: Vec<f64> = (0..48 * 15).map(wave).collect();
        let added = shaped(&values, &carrier, 15);
        let power = |frames: std::ops::Range<usize>| {
            let steps = &added[frames.start * 15..frames.end * 15];
            steps.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>() / steps.len() as f64
        };
        let [before, burst, after] = [power(2..20), power(26..34), power(40..46)];
        assert!((burst / before / 121.0).log10().abs() < 0.2, "{burst} beside {before}");
        assert!((after / before).log10().abs() < 0.2, "{after} after {before}");
    }

    #[test]
    fn steady_flux_and_silence_stay_as_they_are() {
        let carrier: Vec<f64> = (0..120).map(|step| f64::from(step).sin()).collect();
        for values in [vec![3.0; 8], vec![0.0; 8], (0..8).map(f64::from).collect()] {
            assert!(shaped(&values, &carrier, 15).iter().all(|step| step.abs() < 1e-9), "{values:?}");
        }
        for values in [vec![], vec![1.0], vec![1.0, 4.0]] {
            let carrier = &carrier[..15 * values.len()];
            assert_eq!(shaped(&values, carrier, 15), vec![0.0; carrier.len()]);
        }
        let unsteady = [1.0, 3.0, 1.0, 4.0];
        assert_eq!(shaped(&unsteady, &[0.0; 60], 15), [0.0; 60], "a silent carrier");
    }
}
