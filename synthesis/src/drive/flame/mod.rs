//! A flame that burns without any input: the pressure of simulated scenes, as a function of position on the timeline.

mod table;

pub use table::SCENES;
use table::{PLAIN, Table, WAYS, WINDY, tables};

use crate::controls::FlameControls;
use crate::dsp::Smoothed;
use crate::error::{Error, within};

/// Time constant in seconds of intensity and wind.
const SMOOTHING_S: f64 = 0.02;

/// Duration in seconds of a crossfade from one place to another.
const FADE_S: f64 = 0.05;

/// The scene that burns, and the time within its period at the timeline's start.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ScenePosition {
    scene: usize,
    offset_s: f64,
}

/// Pressure of the built-in scenes.
#[derive(Debug)]
pub(super) struct Flame {
    sample_rate_hz: f64,
    tables: &'static [Table],
    intensity: Smoothed,
    wind: Smoothed,
    weights: [f64; WAYS],
    /// The audible place; none right after reset.
    audible: Option<ScenePosition>,
    /// The place that replaces it, and the number of samples since that began.
    coming: Option<(ScenePosition, usize)>,
    fade_samples: usize,
}

impl Flame {
    pub fn new(sample_rate_hz: f64) -> Result<Self, Error> {
        let smoothed = || Smoothed::new(SMOOTHING_S, sample_rate_hz);
        Ok(Self {
            sample_rate_hz,
            tables: tables()?,
            intensity: smoothed(),
            wind: smoothed(),
            weights: [0.0; WAYS],
            audible: None,
            coming: None,
            fade_samples: (FADE_S * sample_rate_hz).ceil() as usize,
        })
    }

    pub fn reset(&mut self) {
        self.audible = None;
        self.coming = None;
    }

    /// Renders the samples from `position` on.
    pub fn process(&mut self, controls: &FlameControls, position: i64, out: &mut [f64]) {
        let wanted = ScenePosition {
            scene: controls.scene.min(self.tables.len() - 1),
            offset_s: within(controls.offset_s, 0.0, 3600.0),
        };
        let (intensity, wind) = (within(controls.intensity, 0.0, 2.0), within(controls.wind, 0.0, 1.0));
        let mut audible = *self.audible.get_or_insert_with(|| {
            (self.intensity.value, self.wind.value) = (intensity, wind);
            self.weights = weights(intensity, wind);
            wanted
        });
        for (offset, sample) in out.iter_mut().enumerate() {
            let before = (self.intensity.value, self.wind.value);
            let now = (self.intensity.next(intensity), self.wind.next(wind));
            // Their roots are computed only while a control moves.
            if now != before {
                self.weights = weights(now.0, now.1);
            }
            if self.coming.is_none() && audible != wanted {
                self.coming = Some((wanted, 0));
            }
            let at = position.wrapping_add(offset as i64);
            *sample = self.pressure(audible, at);
            let Some((coming, age)) = &mut self.coming else { continue };
            *age += 1;
            let (coming, age) = (*coming, *age);
            let (old, new) = equal_power(age as f64 / self.fade_samples as f64);
            *sample = old * *sample + new * self.pressure(coming, at);
            if age >= self.fade_samples {
                audible = coming;
                self.coming = None;
            }
        }
        self.audible = Some(audible);
    }

    fn pressure(&self, scene_position: ScenePosition, position: i64) -> f64 {
        let time_s = position as f64 / self.sample_rate_hz + scene_position.offset_s;
        self.tables[scene_position.scene].pressure(time_s, &self.weights)
    }
}

/// Share of each variant in a flame of this intensity, 0-2, in this wind, 0-1. Flux is proportional to the fuel; the
/// variants differ in their turbulence, so their powers add up.
fn weights(intensity: f64, wind: f64) -> [f64; WAYS] {
    let (plain, windy) = equal_power(wind);
    let mut weights = [0.0; WAYS];
    weights[PLAIN] = intensity * plain;
    weights[WINDY] = intensity * windy;
    weights
}

/// Gain factors of the outgoing and the incoming signal at a share of the way, 0-1; at the ends, exactly one of the
/// two.
fn equal_power(part: f64) -> (f64, f64) {
    ((1.0 - part).max(0.0).sqrt(), part.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wind_0_and_1_play_the_simulated_ways_unmixed() {
        for (wind, way) in [(0.0, PLAIN), (1.0, WINDY)] {
            let mut expected = [0.0; WAYS];
            expected[way] = 1.0;
            assert_eq!(weights(1.0, wind), expected, "{wind}");
        }
        assert_eq!(weights(0.0, 0.7), [0.0; WAYS]);
    }

    #[test]
    fn powers_add_up() {
        for step in 0..=20 {
            let wind = f64::from(step) / 20.0;
            for intensity in [0.5, 1.0, 2.0] {
                let power: f64 = weights(intensity, wind).iter().map(|weight| weight * weight).sum();
                assert!((power - intensity * intensity).abs() < 1e-12, "{intensity} {wind}: {power}");
            }
        }
    }
}
