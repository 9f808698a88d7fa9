//! Recent sound: running spectra and spectrograms of drive and output, aligned in time.

use std::collections::VecDeque;

use pyrophone_synthesis::chain::Telemetry;

use super::plots::beta::Betas;
use super::plots::dynamics::DynamicsPlot;
use super::plots::heat::Heat;
use super::plots::pyramid::Levels;
use super::plots::space::Space;
use super::plots::spectrogram::Spectrogram;
use super::plots::spectrum::Spectra;
use super::plots::trace::Outline;
use super::take::Take;
use crate::probe::{LAYERS, Listen, ProbeOut};
use pyrophone_analysis::{Analyser, Character, Fidelity, Figures};

/// Windows in seconds: long for the spectra, which must resolve frequencies, short for the spectrograms, which must show
/// the times of sounds.
const SPECTRUM_S: f64 = 0.17;
const COURSE_S: f64 = 0.04;
/// Steps of both, in seconds.
const SPECTRUM_STEP_S: f64 = 0.03;
const COURSE_STEP_S: f64 = 1.0 / 60.0;

/// Largest share of its time that a block has used, over about a second.
#[derive(Debug, Default)]
struct Worst {
    held: f32,
    until_s: f64,
}

/// Analysers of drive and output.
pub struct Monitor {
    probe: ProbeOut,
    engine: Option<(u32, f32)>,
    sides: Option<Sides>,
    /// Spectra, for the plot.
    pub spectra: Spectra,
    /// Outline of the drive.
    pub trace: Outline,
    /// Course of the drive.
    pub drive: Spectrogram,
    /// Course of the output.
    pub output: Spectrogram,
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
    worst: Worst,
}

struct Sides {
    drive: Side,
    output: Side,
    fidelity: Fidelity,
    /// Drive samples waiting for the output, which is late by the latency.
    waiting: VecDeque<f32>,
    latency_samples: usize,
}

struct Side {
    spectrum: Analyser,
    course: Analyser,
}

impl Side {
    fn new(sample_rate_hz: f64) -> Self {
        Self {
            spectrum: Analyser::new(sample_rate_hz, SPECTRUM_S, SPECTRUM_STEP_S),
            course: Analyser::new(sample_rate_hz, COURSE_S, COURSE_STEP_S),
        }
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
            worst: Worst::default(),
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
                drive: Side::new(f64::from(rate_hz)),
                output: Side::new(f64::from(rate_hz)),
                fidelity: Fidelity::new(f64::from(rate_hz)),
                waiting: VecDeque::with_capacity(latency as usize + 1),
                latency_samples: latency as usize,
            });
        }
        let Some(sides) = &mut self.sides else {
            self.probe.drain(|_| {});
            return;
        };
        let (spectra, drive_course, output_course) = (&mut self.spectra, &mut self.drive, &mut self.output);
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
            if let Some(density) = sides.drive.spectrum.push(drive) {
                spectra.drive.take(density, SPECTRUM_STEP_S as f32);
            }
            if let Some(density) = sides.output.spectrum.push(output) {
                spectra.output.take(density, SPECTRUM_STEP_S as f32);
            }
            if let Some(density) = sides.drive.course.push(drive) {
                drive_course.push(density);
            }
            if let Some(density) = sides.output.course.push(output) {
                output_course.push(density);
            }
        });
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
        let (load, worst) = self.probe.load();
        if worst >= self.worst.held || now_s >= self.worst.until_s {
            self.worst = Worst { held: worst, until_s: now_s + 1.0 };
        }
        (load, self.worst.held)
    }
}
