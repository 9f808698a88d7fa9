//! Recent sound: running spectra and spectrograms of drive and output, aligned in time.
//!
//! A spectrum or spectrogram is analysed when it is shown. The recent sound is kept, so a page that is turned to shows
//! the seconds before, and a page that is not shown costs nothing.

use std::collections::VecDeque;

use pyrophone_synthesis::chain::Telemetry;

use super::plots::beta::Betas;
use super::plots::dynamics::DynamicsPlot;
use super::plots::heat::Heat;
use super::plots::pyramid::Levels;
use super::plots::space::Space;
use super::plots::spectrogram::{COLUMNS, Spectrogram};
use super::plots::spectrum::Spectra;
use super::plots::trace::Outline;
use super::take::Take;
use crate::probe::{LAYERS, Listen, ProbeOut};
use pyrophone_analysis::bands::BANDS;
use pyrophone_analysis::{Analyser, Character, Fidelity, Figures};

/// Windows in seconds: long for the spectra, which must resolve frequencies, short for the spectrograms, which must show
/// the times of sounds.
const SPECTRUM_S: f64 = 0.17;
const COURSE_S: f64 = 0.04;
/// Steps of both, in seconds.
const SPECTRUM_STEP_S: f64 = 0.03;
const COURSE_STEP_S: f64 = 1.0 / 60.0;

/// Seconds before the present that each shows when it is turned to: a few time constants of the curves, and all columns
/// of a spectrogram.
const SPECTRUM_PAST_S: f64 = 3.0;
const COURSE_PAST_S: f64 = COLUMNS as f64 * COURSE_STEP_S;

/// Seconds for which the load stays as it is: figures that change with every frame cannot be read, and their text is laid
/// out each time.
const LOAD_S: f64 = 0.25;

/// Share of their time that blocks use, as shown, and the largest over about a second.
#[derive(Debug, Default)]
struct Load {
    shown: (f32, f32),
    shown_until_s: f64,
    held: f32,
    held_until_s: f64,
}

/// Analysers of drive and output.
pub struct Monitor {
    probe: ProbeOut,
    engine: Option<(u32, f32)>,
    sides: Option<Sides>,
    spectra: Spectra,
    /// Outline of the drive.
    pub trace: Outline,
    drive: Spectrogram,
    output: Spectrogram,
    /// Positions in the recording where the texture was found.
    pub heat: Heat,
    /// Noise factors of extension's windows.
    pub betas: Betas,
    /// Levels of the output pyramid.
    pub levels: Levels,
    /// Mapping by dynamic-range matching.
    pub dynamics: DynamicsPlot,
    /// Sources of vortex sound.
    pub space: Space,
    /// Recorded drive and output, for saving.
    pub take: Take,
    load: Load,
}

struct Sides {
    drive: Side,
    output: Side,
    past: Past,
    fidelity: Fidelity,
    /// Drive samples waiting for the output, which is late by the latency.
    waiting: VecDeque<f32>,
    latency_samples: usize,
}

/// Analyses of the drive or of the output.
struct Side {
    spectrum: Running,
    course: Running,
}

impl Side {
    /// Analyses of the sound at `index` in [`Past`].
    fn new(sample_rate_hz: f64, index: usize) -> Self {
        let running = |window_s, step_s, past_s: f64| Running {
            analyser: Analyser::new(sample_rate_hz, window_s, step_s),
            index,
            reach: (past_s * sample_rate_hz) as u64,
            done: 0,
        };
        Self {
            spectrum: running(SPECTRUM_S, SPECTRUM_STEP_S, SPECTRUM_PAST_S),
            course: running(COURSE_S, COURSE_STEP_S, COURSE_PAST_S),
        }
    }
}

/// Recent samples of drive and output, side by side.
struct Past {
    samples: VecDeque<[f32; 2]>,
    most: usize,
    /// Number of the first sample, counted from the start.
    first: u64,
}

impl Past {
    fn new(sample_rate_hz: f64) -> Self {
        let most = (COURSE_PAST_S * sample_rate_hz) as usize + 1;
        Self { samples: VecDeque::with_capacity(most), most, first: 0 }
    }

    fn push(&mut self, sample: [f32; 2]) {
        if self.samples.len() == self.most {
            self.samples.pop_front();
            self.first += 1;
        }
        self.samples.push_back(sample);
    }

    fn end(&self) -> u64 {
        self.first + self.samples.len() as u64
    }
}

/// An analysis that is done when its result is wanted.
struct Running {
    analyser: Analyser,
    index: usize,
    /// Largest number of samples that it catches up with, and number of samples that it has analysed or skipped.
    reach: u64,
    done: u64,
}

impl Running {
    /// Analyses new samples; `take` gets the densities of each step.
    fn catch_up(&mut self, past: &Past, mut take: impl FnMut(&[f32; BANDS])) {
        let from = self.done.max(past.first).max(past.end().saturating_sub(self.reach));
        if from > self.done {
            self.analyser.reset();
        }
        for sample in past.samples.range((from - past.first) as usize..) {
            if let Some(density) = self.analyser.push(sample[self.index]) {
                take(density);
            }
        }
        self.done = past.end();
    }
}

impl Monitor {
    /// A monitor of the data from a probe.
    pub fn new(probe: ProbeOut) -> Self {
        let (spectra, drive, output) = (Spectra::default(), Spectrogram::new("drive"), Spectrogram::new("output"));
        Self {
            probe,
            engine: None,
            sides: None,
            spectra,
            trace: Outline::default(),
            drive,
            output,
            heat: Heat::default(),
            betas: Betas::default(),
            levels: Levels::default(),
            dynamics: DynamicsPlot::default(),
            space: Space::default(),
            take: Take::default(),
            load: Load::default(),
        }
    }

    /// Starts watching, or stops and forgets.
    pub fn watch(&mut self, watched: bool) {
        self.probe.watch(watched);
        self.sides = None;
        self.engine = None;
        self.spectra = Spectra::default();
        self.trace = Outline::default();
        self.drive.clear();
        self.output.clear();
        self.heat = Heat::default();
        self.betas = Betas::default();
        self.levels = Levels::default();
        self.dynamics = DynamicsPlot::default();
        self.space = Space::default();
        self.take = Take::default();
    }

    /// Takes over new sound; `engine` is latency in samples and sample rate in Hz.
    pub fn follow(&mut self, engine: Option<(u32, f32)>) {
        if engine != self.engine {
            self.engine = engine;
            self.sides = engine.map(|(latency, rate_hz)| Sides {
                drive: Side::new(f64::from(rate_hz), 0),
                output: Side::new(f64::from(rate_hz), 1),
                past: Past::new(f64::from(rate_hz)),
                fidelity: Fidelity::new(f64::from(rate_hz)),
                waiting: VecDeque::with_capacity(latency as usize + 1),
                latency_samples: latency as usize,
            });
        }
        let Some(sides) = &mut self.sides else {
            self.probe.drain(|_| {});
            return;
        };
        let (take, channels) = (&mut self.take, self.probe.channels());
        let (trace, rate_hz) = (&mut self.trace, self.engine.map_or(44_100.0, |(_, rate_hz)| f64::from(rate_hz)));
        take.lose(self.probe.take_lost());
        self.probe.drain(|frame| {
            sides.waiting.push_back(frame.drive);
            if sides.waiting.len() <= sides.latency_samples {
                return;
            }
            let drive = sides.waiting.pop_front().unwrap_or(0.0);
            take.push(drive, &frame.output[..channels]);
            trace.push(drive, rate_hz);
            let output = frame.mean(channels);
            sides.fidelity.push(drive, output);
            sides.past.push([drive, output]);
        });
    }

    /// Spectra of drive and output, up to date.
    pub fn spectra(&mut self) -> &mut Spectra {
        if let Some(Sides { drive, output, past, .. }) = &mut self.sides {
            let Spectra { drive: below, output: above, .. } = &mut self.spectra;
            drive.spectrum.catch_up(past, |density| below.take(density, SPECTRUM_STEP_S as f32));
            output.spectrum.catch_up(past, |density| above.take(density, SPECTRUM_STEP_S as f32));
        }
        &mut self.spectra
    }

    /// Spectrogram of the drive, up to date.
    pub fn drive(&mut self) -> &mut Spectrogram {
        if let Some(Sides { drive, past, .. }) = &mut self.sides {
            drive.course.catch_up(past, |density| self.drive.push(density));
        }
        &mut self.drive
    }

    /// Spectrogram of the output, up to date.
    pub fn output(&mut self) -> &mut Spectrogram {
        if let Some(Sides { output, past, .. }) = &mut self.sides {
            output.course.catch_up(past, |density| self.output.push(density));
        }
        &mut self.output
    }

    /// Takes over the engines' telemetry; `recording_s` is the recording's length, and the start in it of the part used
    /// for learning; `now_s` is the window's clock.
    pub fn follow_traces(&mut self, recording_s: Option<[f64; 2]>, now_s: f64) {
        self.heat.cool(now_s);
        let (heat, dynamics, levels, betas) = (&mut self.heat, &mut self.dynamics, &mut self.levels, &mut self.betas);
        let space = &mut self.space;
        self.probe.take_traces(|trace| match trace {
            Telemetry::Sources(count) => space.begin(count),
            Telemetry::Source(source) => space.take(source),
            Telemetry::Beta(beta) => betas.take(beta),
            Telemetry::Extent(extent) => levels.take(extent),
            Telemetry::Match(found) => {
                if let Some([duration_s, start_s]) = recording_s {
                    heat.take(((start_s + f64::from(found.place_s)) / duration_s) as f32);
                }
                dynamics.take(found);
            }
        });
    }

    /// Channels of the output.
    pub fn channels(&self) -> usize {
        self.probe.channels()
    }

    /// The monitored sound.
    pub fn listen(&self) -> Listen {
        self.probe.listen()
    }

    /// Chooses the sound to be monitored while the window is open.
    pub fn listen_to(&self, listen: Listen) {
        self.probe.listen_to(listen);
    }

    /// Adds a burst to the input.
    pub fn burst(&self) {
        self.probe.burst();
    }

    /// Scores: the output's similarity to a recording, and its correlation with the drive.
    pub fn figures(&self, recording: Option<&Character>) -> Figures {
        self.sides.as_ref().map(|sides| sides.fidelity.figures(recording)).unwrap_or_default()
    }

    /// Chooses the layers that are silent while the window is open.
    pub fn silence(&self, layers: [bool; LAYERS]) {
        self.probe.silence(layers);
    }

    /// Share of their time that blocks use, and the maximum in the last second; `now_s` is the window's clock.
    pub fn load(&mut self, now_s: f64) -> (f32, f32) {
        let (mean, worst) = self.probe.load();
        let load = &mut self.load;
        if worst >= load.held || now_s >= load.held_until_s {
            (load.held, load.held_until_s) = (worst, now_s + 1.0);
        }
        if now_s >= load.shown_until_s {
            (load.shown, load.shown_until_s) = ((mean, load.held), now_s + LOAD_S);
        }
        load.shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_wanted_late_shows_the_seconds_before() {
        let rate_hz = 8000.0;
        let (mut past, mut early, mut late) = (Past::new(rate_hz), Side::new(rate_hz, 1), Side::new(rate_hz, 1));
        let (mut seen, mut steps) = (vec![], vec![]);
        for n in 0..12 * 8000 {
            past.push([1.0, (n as f32).sin()]);
            if n % 133 == 0 {
                early.course.catch_up(&past, |density| seen.push(*density));
            }
        }
        early.course.catch_up(&past, |density| seen.push(*density));
        late.course.catch_up(&past, |density| steps.push(*density));
        // All that a spectrogram shows, and no more.
        assert!(steps.len().abs_diff(COLUMNS) <= 2, "{}", steps.len());
        assert!(seen.len().abs_diff(12 * 60) <= 4, "{}", seen.len());
        let apart = seen[seen.len() - 1].iter().zip(&steps[steps.len() - 1]).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f32::max) < 1e-3);
        late.course.catch_up(&past, |_| panic!("nothing is new"));
    }
}
