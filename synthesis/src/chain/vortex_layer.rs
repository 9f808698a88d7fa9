//! Vortex sound as a layer: fed by the drive or by a speed field, as late as the other layers.

use std::sync::Arc;

use super::telemetry::Telemetry;
use crate::controls::{DriveMode, Flow, VortexControls};
use crate::dsp::Delay;
use crate::vortex::{Bank, Simulator, SpeakerLayout, SpeedField, TEXTURES, Vortex, factory};
use crate::{Controls, Error};

/// Most sources that an envelope drives: the upper end of the parameter `vortex_sources`.
const SOURCES: usize = 500;

/// Speed of the eddies in live gas, as a multiple of the mean over a sub-volume, which includes still air.
const LIVE_SPEED: f64 = 2.5;

/// Seconds, in addition to twice the latency, after which a layer that is off has fallen silent.
const HOLD_S: f64 = 0.5;

/// Hops between two views of the sources, about a thirtieth of a second, and most sources of a view.
const VIEW_HOPS: i64 = 12;
const VIEW_SOURCES: usize = 128;

/// Field that sets the sources' speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FlowState {
    /// None: the envelope does.
    Nothing,
    /// The user's.
    Own,
    /// Field of a scene that burns as the drive.
    Scene(usize),
}

/// The renderer, its possible inputs, and its delay.
#[derive(Debug)]
pub struct VortexLayer {
    vortex: Vortex,
    banks: [Arc<Bank>; TEXTURES.len()],
    /// Index of the bank in use.
    playing: usize,
    scenes: &'static [Arc<SpeedField>],
    own: Option<Arc<SpeedField>>,
    /// The field that the renderer has.
    loaded: FlowState,
    /// True if it has a simulation.
    is_live: bool,
    delays: Vec<Delay<f64>>,
    /// Samples for which rendering continues after the layer is turned off, and the number left.
    hold_samples: usize,
    left_samples: usize,
    /// Number of the last view of the sources, and whether it contained any.
    viewed: i64,
    was_seen: bool,
}

impl VortexLayer {
    /// A layer with a delay of `latency_samples`, which exceeds the renderer's own. The first layer at a rate makes the
    /// banks.
    pub fn new(sample_rate_hz: f64, channels: usize, latency_samples: usize) -> Result<Self, Error> {
        let mut vortex = Vortex::new(sample_rate_hz, SpeakerLayout::of_channels(channels)?, SOURCES)?;
        let rest_samples = latency_samples.saturating_sub(vortex.latency_samples());
        let banks = factory::banks(sample_rate_hz)?;
        drop(vortex.swap_bank(Some(banks[0].clone())));
        Ok(Self {
            vortex,
            banks,
            playing: 0,
            scenes: factory::fields()?,
            own: None,
            loaded: FlowState::Nothing,
            is_live: false,
            delays: vec![Delay::new(rest_samples); channels],
            hold_samples: 2 * latency_samples + (HOLD_S * sample_rate_hz) as usize,
            left_samples: 0,
            viewed: 0,
            was_seen: false,
        })
    }

    /// Exchanges the user's field; sources beyond the renderer's capacity are not heard.
    pub fn swap_field(&mut self, field: Option<Arc<SpeedField>>) -> Option<Arc<SpeedField>> {
        if self.loaded == FlowState::Own {
            drop(self.vortex.swap_field(field.clone()));
            if field.is_none() {
                self.loaded = FlowState::Nothing;
            }
        }
        std::mem::replace(&mut self.own, field)
    }

    /// Installs a simulation for the flow `live`. Not for the audio thread.
    pub fn set_simulator(&mut self, simulator: Box<dyn Simulator>, places: &[[f32; 3]]) -> Result<(), Error> {
        self.vortex.set_simulator(simulator, places)?;
        self.is_live = true;
        Ok(())
    }

    /// Seconds that a step of that simulation lasts.
    pub fn live_step_s(&self) -> f64 {
        self.vortex.live_step_s()
    }

    /// Number of its steps that came too late since the last call.
    pub fn take_late_steps(&mut self) -> u64 {
        self.vortex.take_late_steps()
    }

    /// Samples for which it continues after the drive has ended, without its delay; none if it never ends.
    pub fn tail_samples(&self, controls: &Controls) -> Option<usize> {
        if controls.mix.vortex == 0.0 { Some(0) } else { self.vortex.tail_samples(&self.effective(controls)) }
    }

    /// Restarts at `position` of the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.vortex.reset(position);
        self.left_samples = 0;
        self.delays.iter_mut().for_each(Delay::reset);
    }

    /// Renders one chunk of the layer. A layer that has been off for long is skipped.
    pub fn process(&mut self, drive: &[f64], controls: &Controls, outputs: &mut [&mut [f64]]) {
        if controls.mix.vortex != 0.0 {
            self.left_samples = drive.len() + self.hold_samples;
        }
        let samples = drive.len().min(self.left_samples);
        self.left_samples -= samples;
        if samples > 0 {
            self.render(&drive[..samples], controls, outputs);
        }
        if samples < drive.len() {
            // By now the delays contain only silence.
            outputs.iter_mut().for_each(|output| output[samples..].fill(0.0));
            self.vortex.skip(drive.len() - samples);
        }
    }

    fn render(&mut self, drive: &[f64], controls: &Controls, outputs: &mut [&mut [f64]]) {
        let effective = self.effective(controls);
        // Everything exchanged here has another owner, so nothing is freed.
        let wanted = controls.vortex.texture.min(TEXTURES.len() - 1);
        if std::mem::replace(&mut self.playing, wanted) != wanted {
            drop(self.vortex.swap_bank(Some(self.banks[wanted].clone())));
        }
        if effective.flow == Flow::Field {
            let wanted = self.wanted(controls);
            if std::mem::replace(&mut self.loaded, wanted) != wanted {
                drop(self.vortex.swap_field(self.field(wanted).cloned()));
            }
        }
        self.vortex.process(drive, &effective, outputs);
        for (delay, output) in self.delays.iter_mut().zip(outputs) {
            delay.process(&mut output[..drive.len()]);
        }
    }

    /// The field for these controls.
    fn wanted(&self, controls: &Controls) -> FlowState {
        match (&self.own, controls.drive.mode) {
            (Some(_), _) => FlowState::Own,
            (None, DriveMode::Flame) => FlowState::Scene(controls.drive.flame.scene.min(self.scenes.len() - 1)),
            (None, _) => FlowState::Nothing,
        }
    }

    fn field(&self, state: FlowState) -> Option<&Arc<SpeedField>> {
        match state {
            FlowState::Nothing => None,
            FlowState::Own => self.own.as_ref(),
            FlowState::Scene(scene) => self.scenes.get(scene),
        }
    }

    /// Returns a view of the sources, some thirty times a second: their number, then each of them.
    pub fn take_view(&mut self) -> impl Iterator<Item = Telemetry> {
        let number = self.vortex.hop().div_euclid(VIEW_HOPS);
        let is_due = std::mem::replace(&mut self.viewed, number) != number;
        let is_on = self.left_samples > 0;
        // The absence of sources is reported only once.
        let is_reported = is_due && (is_on || self.was_seen);
        if is_due {
            self.was_seen = is_on;
        }
        let most = if is_reported && is_on { VIEW_SOURCES } else { 0 };
        let seen = || self.vortex.seen(VIEW_SOURCES).take(most);
        let count = is_reported.then(|| Telemetry::Sources(seen().count()));
        count.into_iter().chain(seen().map(Telemetry::Source))
    }

    /// True if it sounds without any input.
    pub fn is_self_driven(&self, controls: &Controls) -> bool {
        self.effective(controls).flow == Flow::Field
    }

    /// The renderer's effective controls: the envelope if there is no field or simulation, a scene's field if the scene
    /// burns, and nothing if the layer is off and need not be computed.
    fn effective(&self, controls: &Controls) -> VortexControls {
        let mut effective = controls.vortex;
        if controls.mix.vortex == 0.0 {
            (effective.flow, effective.count) = (Flow::Envelope, 0);
        } else if effective.flow == Flow::Live {
            effective.field_speed = LIVE_SPEED;
            if !self.is_live {
                effective.flow = Flow::Envelope;
            }
        } else if effective.flow == Flow::Field {
            match self.wanted(controls) {
                FlowState::Nothing => effective.flow = Flow::Envelope,
                FlowState::Own => {}
                FlowState::Scene(_) => {
                    let flame = &controls.drive.flame;
                    effective.field_offset_s += flame.offset_s;
                    // Twice the fuel lifts gas of twice the buoyancy, and speed goes with its root.
                    effective.field_speed *= flame.intensity.max(0.0).sqrt();
                }
            }
        }
        effective
    }
}
