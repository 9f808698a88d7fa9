//! The built-in textures and speed fields of scenes.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError, Weak};

use pyrophone_assets::{SCENES, VORTEX_TEXTURES};

use super::bank::Bank;
use super::field::SpeedField;
use super::texture::VortexTexture;
use crate::error::Error;

/// Names of the shipped textures.
pub const TEXTURES: [&str; 2] = [VORTEX_TEXTURES[0].name, VORTEX_TEXTURES[1].name];

/// Output per Pa at which gas flowing at 8 m/s, with the other controls at their defaults, gives an rms of about 0.1
/// (-20 dBFS).
pub const OUTPUT_PER_PA: [f64; TEXTURES.len()] = [132.0, 89.0];

static READ_FIELDS: LazyLock<Result<Vec<Arc<SpeedField>>, Error>> =
    LazyLock::new(|| SCENES.iter().map(|scene| SpeedField::from_bytes(scene.field).map(Arc::new)).collect());

/// Speed fields of all scenes, of the very flames whose pressure the drive has, in the order of
/// [`drive::SCENES`](crate::drive::SCENES); read at the first call.
pub fn fields() -> Result<&'static [Arc<SpeedField>], Error> {
    READ_FIELDS.as_deref().map_err(Error::clone)
}

/// The textures prepared for one rate, in the order of [`TEXTURES`].
pub type Banks = [Arc<Bank>; TEXTURES.len()];

/// Banks made earlier.
static MADE: Mutex<Made> = Mutex::new(Made { latest: None, played: BTreeMap::new() });

/// Making the banks takes as long as some hosts allow for a whole activation, and hosts activate repeatedly.
struct Made {
    /// Banks of the most recent rate, by the rate's bits.
    latest: Option<(u64, Banks)>,
    /// Banks of all rates that are in use.
    played: BTreeMap<u64, [Weak<Bank>; TEXTURES.len()]>,
}

impl Made {
    fn get(&mut self, sample_rate_hz: f64) -> Result<Banks, Error> {
        let key = sample_rate_hz.to_bits();
        let banks = match self.known(key) {
            Some(banks) => banks,
            None => made(sample_rate_hz)?,
        };
        self.played.insert(key, banks.each_ref().map(Arc::downgrade));
        self.latest = Some((key, banks.clone()));
        self.played.retain(|_, banks| banks.iter().all(|bank| bank.strong_count() > 0));
        Ok(banks)
    }

    fn known(&self, key: u64) -> Option<Banks> {
        let [fire, jet] = self.played.get(&key)?;
        Some([fire.upgrade()?, jet.upgrade()?])
    }
}

fn made(sample_rate_hz: f64) -> Result<Banks, Error> {
    let make = |file| Bank::new(&VortexTexture::from_bytes(file)?, sample_rate_hz).map(Arc::new);
    let [fire, jet] = VORTEX_TEXTURES;
    Ok([make(fire.file)?, make(jet.file)?])
}

/// The built-in textures, prepared for output at `sample_rate_hz` (8,000-384,000); banks in use, and those of the most
/// recent rate, are shared. Not for the audio thread.
pub fn banks(sample_rate_hz: f64) -> Result<Banks, Error> {
    // A concurrent caller usually needs the same ones.
    MADE.lock().unwrap_or_else(PoisonError::into_inner).get(sample_rate_hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controls::VortexControls;
    use crate::vortex::{SpeakerLayout, Vortex};

    #[test]
    fn gas_of_medium_speed_gives_a_tenth_of_full_scale() {
        let sample_rate_hz = 48_000.0;
        for (which, bank) in banks(sample_rate_hz).unwrap().into_iter().enumerate() {
            let mut vortex = Vortex::new(sample_rate_hz, SpeakerLayout::Mono, 500).unwrap();
            drop(vortex.swap_bank(Some(bank)));
            vortex.reset(0);
            let controls = VortexControls { speed_m_s: 8.0, level: OUTPUT_PER_PA[which], ..VortexControls::default() };
            let mut output = vec![0.0; 4 * 48_000];
            vortex.process(&vec![1.0; output.len()], &controls, &mut [&mut output]);
            let rms = (output.iter().map(|x| x * x).sum::<f64>() / output.len() as f64).sqrt();
            println!(
                "{}: rms {rms:.4}; {:.0} per Pa would be exact",
                TEXTURES[which],
                OUTPUT_PER_PA[which] * 0.1 / rms
            );
            assert!((0.08..0.125).contains(&rms), "{}: {rms}", TEXTURES[which]);
        }
    }

    #[test]
    fn every_scene_has_a_field_that_repeats() {
        for (scene, field) in SCENES.map(|scene| scene.name).iter().zip(fields().unwrap()) {
            assert_eq!(field.end(), crate::vortex::End::Periodic, "{scene}");
            assert!((4..=160).contains(&field.sources()), "{scene}: {} sources", field.sources());
            let seconds = field.steps() as f64 / field.rate_hz();
            assert!((5.0..=10.0).contains(&seconds), "{scene}: {seconds} s");
            assert!(field.positions().iter().all(|[_, _, up]| *up >= 0.0), "{scene} lies below its bottom");
        }
    }

    #[test]
    fn banks_are_shared_while_in_use_and_kept_for_the_latest_rate() {
        let mut made = Made { latest: None, played: BTreeMap::new() };
        let same = |a: &Banks, b: &Banks| a.iter().zip(b).all(|(a, b)| Arc::ptr_eq(a, b));
        let first = made.get(47_999.0).unwrap();
        let other = made.get(47_998.0).unwrap();
        assert!(!same(&first, &other) && same(&first, &made.get(47_999.0).unwrap()), "in use");
        let weak = first.each_ref().map(Arc::downgrade);
        drop((first, other));
        assert!(weak.iter().all(|bank| bank.strong_count() > 0), "kept");
        drop(made.get(47_998.0).unwrap());
        assert!(weak.iter().all(|bank| bank.strong_count() == 0) && made.played.len() == 1, "no longer the latest");
    }
}
