//! Range of a sound's amplitudes, and the likelihood that matching it with another's buzzes.

/// Steps of probability in a stored distribution.
const STEPS: usize = 65;
/// Windows needed before the first result: about a second.
const PATIENCE: usize = 700;

/// Amplitudes of a sound at equal steps of probability, ascending.
#[derive(Debug, Clone, PartialEq)]
pub struct Amplitudes(pub Vec<f32>);

impl Amplitudes {
    /// The distribution of these magnitudes; none where there are too few.
    pub fn of_magnitudes(magnitudes: impl Iterator<Item = f32>) -> Option<Self> {
        let mut sorted: Vec<f32> = magnitudes.collect();
        if sorted.len() < PATIENCE {
            return None;
        }
        sorted.sort_unstable_by(f32::total_cmp);
        let last = sorted.len() - 1;
        Some(Self((0..STEPS).map(|step| sorted[step * last / (STEPS - 1)]).collect()))
    }
}

/// Mean gain in dB beyond which matching is likely to buzz. Of the nine pairs of the reference data all that buzz lie
/// above it (9 to 15 dB), and of those that do not four lie below (1 to 7 dB), two above.
pub const BUZZING_DB: f64 = 8.5;

/// Mean distance, in dB, by which dynamic-range matching (§5.3, eq. 17) moves windows from their own level to the
/// drive's, over all but the drive's quietest quarter. Many large factors in a row add up to a buzz (§6). Both
/// distributions ascend in equal steps of probability.
pub fn mean_gain_db(drive: &[f32], recording: &[f32], scaling_alpha: f64) -> f64 {
    let steps = drive.len().min(recording.len());
    let first = steps / 4;
    let gain_db = |(drive, recording): (&f32, &f32)| {
        let ratio = f64::from(*recording) / f64::from(drive.max(1e-9));
        let scale = (1.0 - scaling_alpha) + scaling_alpha * ratio;
        20.0 * scale.max(1e-9).log10().abs()
    };
    let gains = drive[..steps].iter().zip(&recording[..steps]).skip(first).map(gain_db);
    gains.sum::<f64>() / (steps - first).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitudes_ascend_from_the_least_to_the_largest() {
        assert_eq!(Amplitudes::of_magnitudes([0.5; 10].into_iter()), None, "too few");
        let Amplitudes(found) = Amplitudes::of_magnitudes((0..6401).rev().map(|n| n as f32)).unwrap();
        assert_eq!(found, (0..STEPS).map(|step| 100.0 * step as f32).collect::<Vec<_>>());
    }

    #[test]
    fn gains_are_those_of_the_mapping() {
        let recording: Vec<f32> = (0..65).map(|n| 0.001 * n as f32).collect();
        let louder: Vec<f32> = recording.iter().map(|x| 10.0 * x).collect();
        assert!((mean_gain_db(&louder, &recording, 1.0) - 20.0).abs() < 1e-3);
        assert!((mean_gain_db(&recording, &louder, 1.0) - 20.0).abs() < 1e-3, "up or down");
        assert_eq!(mean_gain_db(&louder, &recording, 0.0), 0.0, "nothing is mapped");
        // (1 - 0.5) + 0.5 / 10.
        assert!((mean_gain_db(&louder, &recording, 0.5) + 20.0 * 0.55f64.log10()).abs() < 1e-3);
        assert_eq!(mean_gain_db(&[], &recording, 1.0), 0.0);
    }
}
