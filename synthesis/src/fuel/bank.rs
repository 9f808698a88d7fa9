//! Crackles of all fuels, made once for each sample rate.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use rayon::prelude::*;

use super::draws::Draws;
use super::kind::{BURNING, Properties};
use crate::crackle::{Crackles, Made, Variation};

/// Approximate number of ruptures made for each fuel, and their largest duration in seconds.
const RUPTURES: f64 = 240.0;
const SECONDS: [f64; 2] = [6.0, 60.0];
/// Seed of the bank; a different choice of ruptures is not a different fuel.
const SEED: u32 = 0x4655_454C;
/// Synthetic crackles are varied more than recorded ones, since they are more alike; and panned, since they have no
/// position.
const VARIATION: Variation = Variation { level_db: 2.0, rate: 0.12, tilt_db: 1.5, balance_db: 7.0 };

/// Banks by the bits of their rate, as long as they are in use.
static BANKS: Mutex<Option<HashMap<u64, Weak<[Crackles]>>>> = Mutex::new(None);

/// Crackles of the fuels that burn, in the order of [`Fuel::burning_index`](crate::controls::Fuel::burning_index), for output at
/// `sample_rate_hz` (8,000-384,000). A bank in use is shared. Not for the audio thread.
pub fn bank(sample_rate_hz: f64) -> Arc<[Crackles]> {
    let mut guard = BANKS.lock().unwrap_or_else(PoisonError::into_inner);
    let known = guard.get_or_insert_default();
    if let Some(bank) = known.get(&sample_rate_hz.to_bits()).and_then(Weak::upgrade) {
        return bank;
    }
    let made: Vec<Crackles> =
        BURNING.par_iter().enumerate().map(|(number, fuel)| make(fuel, number as u32, sample_rate_hz)).collect();
    let bank: Arc<[Crackles]> = made.into();
    known.retain(|_, bank| bank.strong_count() > 0);
    known.insert(sample_rate_hz.to_bits(), Arc::downgrade(&bank));
    bank
}

fn make(fuel: &Properties, number: u32, sample_rate_hz: f64) -> Crackles {
    let seconds = (RUPTURES / fuel.bursts.ruptures_per_s()).clamp(SECONDS[0], SECONDS[1]);
    let mut draws = Draws::new(SEED, number);
    let onsets_s = fuel.bursts.onsets_s(seconds, &mut draws);
    let made = onsets_s.iter().map(|onset_s| {
        let (wave, over_softest_db) = fuel.rupture.make(&mut draws, sample_rate_hz);
        Made { onset: (onset_s * sample_rate_hz) as usize, over_softest_db, wave }
    });
    Crackles::made(made.collect(), (seconds * sample_rate_hz).ceil() as usize, VARIATION, sample_rate_hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controls::Fuel;
    use crate::crackle::LONGEST_S;

    #[test]
    fn every_fuel_has_crackles_of_its_kind_at_any_rate() {
        for rate_hz in [22_050.0, 48_000.0] {
            let bank = bank(rate_hz);
            assert_eq!(bank.len(), Fuel::ALL.len() - 1);
            for (crackles, fuel) in bank.iter().zip(BURNING) {
                let summary = crackles.summary();
                let rate = summary.per_second / fuel.bursts.ruptures_per_s();
                assert!((0.7..1.3).contains(&rate), "{} a second", summary.per_second);
                assert!((0.9..4.0).contains(&summary.gap_variation), "{}", summary.gap_variation);
                let longest = crackles.events().iter().map(|event| event.len).max().unwrap();
                let slowest_s = longest as f64 / rate_hz / (1.0 - VARIATION.rate);
                assert!(slowest_s <= LONGEST_S, "{slowest_s} s");
            }
        }
        let centroids: Vec<f64> = bank(48_000.0).iter().map(|crackles| crackles.summary().centroid_hz).collect();
        let [dry, wet, grass, ..] = centroids[..] else { panic!("{centroids:?}") };
        assert!(wet < dry && dry < grass, "{centroids:?} Hz");
    }

    #[test]
    fn a_bank_is_shared_while_in_use_and_made_alike() {
        let first = bank(11_025.0);
        assert!(Arc::ptr_eq(&first, &bank(11_025.0)));
        let peaks = |bank: &[Crackles]| -> Vec<f64> {
            bank.iter().flat_map(|crackles| crackles.events().iter().map(|event| event.peak)).collect()
        };
        let before = peaks(&first);
        drop(first);
        assert_eq!(before, peaks(&bank(11_025.0)));
    }
}
