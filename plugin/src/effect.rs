//! The effect as called by hosts.

use std::sync::Arc;
use std::time::{Duration, Instant};

use nice_plug::prelude::*;
use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::{ControllerFile, Recent};
use pyrophone_synthesis::chain::{self, Channels};

use crate::audio::engines::Builder;
use crate::audio::note_bursts::NoteBursts;
use crate::audio::{Audio, Tail};
use crate::drain_barrier::DrainBarrier;
use crate::editor::Window;
use crate::editor::frame::PyrophoneEditor;
use crate::entry::instance::{self, Instance};
use crate::frame_pace::FramePace;
use crate::host_clock::{HostClock, Reported};
use crate::loader::{Engine, Loader};
use crate::meters::Meters;
use crate::parameters::{EffectParams, sanitize};
use crate::probe::{self, ProbeOut};
use crate::remote_pages;

/// Longest time that an activation in real-time mode takes of the host's main thread, with a margin to 50 ms: engines
/// and recordings that are not ready by then arrive while the host plays. Where the host reports offline rendering there
/// is no limit.
const ACTIVATION_LIMIT: Duration = Duration::from_millis(40);

/// The effect.
pub struct Pyrophone {
    params: Arc<EffectParams>,
    loader: Loader,
    audio: Audio,
    meters: Arc<Meters>,
    probe: ProbeOut,
    clock: HostClock,
    drain_barrier: DrainBarrier,
    builder: Builder,
    executor: Option<AsyncExecutor<Self>>,
    notifier: RepaintNotifier,
    sample_rate_hz: f32,
    /// True if the host renders as fast as it can, and waits for slow work.
    is_offline: bool,
    /// True if the last activation had a sample rate that the engines do not support.
    is_rate_refused: bool,
    frame_pace: FramePace,
    /// File with the MIDI controllers for future instances.
    controllers: Option<ControllerFile>,
}

/// Task of an instance for the framework's threads.
pub enum EffectTask {
    /// On the background thread: nothing, see [`DrainBarrier`].
    PassDrainBarrier,
    /// On the host's main thread: pending requests to the host's menu.
    HostMenu,
}

impl Default for Pyrophone {
    fn default() -> Self {
        let notifier = RepaintNotifier::new();
        let (loader, params, link) = Loader::start(notifier.clone(), Recent::of_user());
        let controllers = ControllerFile::of_user();
        if let Some(file) = &controllers {
            params.controllers.set_all(&file.read());
        }
        let (probe_in, probe) = probe::pair();
        let meters = Arc::<Meters>::default();
        let announced = Instance { params: params.clone(), meters: meters.clone(), loader: loader.handle() };
        instance::announce(announced);
        Self {
            params,
            loader,
            audio: Audio::new(link, probe_in),
            meters,
            probe,
            clock: HostClock::default(),
            drain_barrier: DrainBarrier::default(),
            builder: Builder::default(),
            executor: None,
            notifier,
            sample_rate_hz: 0.0,
            is_offline: false,
            is_rate_refused: false,
            frame_pace: FramePace::default(),
            controllers,
        }
    }
}

const fn layout(input: u32, output: u32, sidechain: &'static [NonZeroU32], name: &'static str) -> AudioIOLayout {
    AudioIOLayout {
        main_input_channels: NonZeroU32::new(input),
        main_output_channels: NonZeroU32::new(output),
        aux_input_ports: sidechain,
        aux_output_ports: &[],
        names: PortNames { layout: Some(name), aux_inputs: &["Sidechain"], ..PortNames::const_default() },
    }
}

const MONO: &[NonZeroU32] = &[new_nonzero_u32(1)];
const STEREO: &[NonZeroU32] = &[new_nonzero_u32(2)];
const SURROUND_50: &[NonZeroU32] = &[new_nonzero_u32(5)];
const SURROUND_51: &[NonZeroU32] = &[new_nonzero_u32(6)];

/// Reports the latency to the host. In CLAP the guard around the effect does that, within `activate`: the framework
/// would ask for a restart first, at every first activation.
fn announce_latency(context: &mut impl ActivateContext<Pyrophone>, latency_samples: u32) {
    if context.plugin_api() != PluginApi::Clap {
        context.set_latency_samples(latency_samples);
    }
}

/// The bursts that the block's notes light, as loud as they are struck.
fn note_bursts(context: &mut impl ProcessContext<Pyrophone>, samples: usize) -> NoteBursts {
    let mut bursts = NoteBursts::default();
    while let Some(event) = context.next_event() {
        if let NoteEvent::NoteOn { timing, velocity, .. } = event {
            bursts.push((timing as usize).min(samples.saturating_sub(1)), velocity);
        }
    }
    bursts
}

impl Pyrophone {
    /// Runs without engines, which do not support this sample rate; the window says why.
    fn pass_through(&mut self, channels: Channels, config: &BufferConfig, reason: &str) {
        self.audio.pass_through(channels, config.max_buffer_size as usize);
        self.meters.set_engine(config.sample_rate, 0);
        self.is_rate_refused = true;
        self.loader.handle().status.fail(format!("{reason}; the input passes through"));
    }

    /// Runs engines from now on, with the recording if that is ready in time: those of the last activation if they fit,
    /// else new ones. `began` is the activation's beginning.
    ///
    /// # Errors
    /// What is wrong with `engine`.
    fn start(&mut self, engine: Engine, config: &BufferConfig, began: Instant) -> Result<u32, String> {
        let latency_samples = chain::latency_samples(engine.sample_rate_hz, &engine.structure);
        let latency_samples = latency_samples.map_err(|error| error.to_string())? as u32;
        let ticket = self.loader.set_engine(engine);
        let limit = || (!self.is_offline).then(|| ACTIVATION_LIMIT.saturating_sub(began.elapsed()));
        let max_block = config.max_buffer_size as usize;
        if !self.audio.rerun(&engine, self.is_offline, max_block) {
            let built = self.builder.build(engine, self.is_offline, limit())?;
            self.audio.run(built, engine.channels, max_block);
        }
        let is_loaded = self.loader.wait(ticket, limit());
        let waited_s = began.elapsed().as_secs_f32();
        if !is_loaded {
            nice_log!("Pyrophone starts without its recording, which is still loading");
        } else if waited_s > 0.2 {
            nice_log!("Pyrophone waited {waited_s:.1} s, because an offline render needs its recording");
        }
        self.audio.receive_updates();
        Ok(latency_samples)
    }

    /// The sound as seen by the window.
    pub fn probe(&self) -> ProbeOut {
        self.probe.clone()
    }

    /// The parameters, shared by window and host.
    pub fn effect_params(&self) -> &EffectParams {
        &self.params
    }

    /// The content of the editor in a window of the host.
    pub fn window(&self) -> Window {
        let (params, meters) = (self.params.clone(), self.meters.clone());
        let window = Window::new(params, self.loader.handle(), meters, self.probe(), self.notifier.clone());
        window.keeping_controllers(self.controllers.clone())
    }
}

/// Automation points reserved for every parameter in one block: one at every sample of a block of 64.
const POINTS_PER_BLOCK: usize = 64;

impl Plugin for Pyrophone {
    const NAME: &'static str = "Pyrophone";
    const VENDOR: &'static str = "Pyrophone";
    const URL: &'static str = "https://pyrophone.org";
    const EMAIL: &'static str = "support@pyrophone.org";
    const VERSION: &'static str = env!("CARGO_PKG_VERSION");

    // Of the layouts beyond stereo these are the two that VST3 can describe correctly. Seven channels and more would be
    // named as cinema layouts, with loudspeakers in front of the listener where the engine has them behind. CLAP gets
    // the number alone. VST3 hosts can have a sidechain of as many channels as the main input only: nice-plug 0.4.2
    // compares it with that.
    const AUDIO_IO_LAYOUTS: &'static [AudioIOLayout] = &[
        layout(2, 2, STEREO, "Stereo, stereo sidechain"),
        layout(2, 2, &[], "Stereo"),
        layout(2, 2, MONO, "Stereo, mono sidechain"),
        layout(1, 2, STEREO, "Mono to stereo, stereo sidechain"),
        layout(1, 2, &[], "Mono to stereo"),
        layout(1, 2, MONO, "Mono to stereo, mono sidechain"),
        layout(1, 1, STEREO, "Mono, stereo sidechain"),
        layout(1, 1, &[], "Mono"),
        layout(1, 1, MONO, "Mono, mono sidechain"),
        layout(6, 6, STEREO, "5.1 (L R C LFE Ls Rs), stereo sidechain"),
        layout(6, 6, SURROUND_51, "5.1 (L R C LFE Ls Rs), 5.1 sidechain"),
        layout(6, 6, MONO, "5.1 (L R C LFE Ls Rs), mono sidechain"),
        layout(6, 6, &[], "5.1 (L R C LFE Ls Rs)"),
        layout(2, 6, STEREO, "Stereo to 5.1 (L R C LFE Ls Rs), stereo sidechain"),
        layout(2, 6, &[], "Stereo to 5.1 (L R C LFE Ls Rs)"),
        layout(1, 6, STEREO, "Mono to 5.1 (L R C LFE Ls Rs), stereo sidechain"),
        layout(1, 6, &[], "Mono to 5.1 (L R C LFE Ls Rs)"),
        layout(1, 6, MONO, "Mono to 5.1 (L R C LFE Ls Rs), mono sidechain"),
        layout(5, 5, STEREO, "5.0 (L R C Ls Rs), stereo sidechain"),
        layout(5, 5, SURROUND_50, "5.0 (L R C Ls Rs), 5.0 sidechain"),
        layout(5, 5, MONO, "5.0 (L R C Ls Rs), mono sidechain"),
        layout(5, 5, &[], "5.0 (L R C Ls Rs)"),
        layout(2, 5, STEREO, "Stereo to 5.0 (L R C Ls Rs), stereo sidechain"),
        layout(2, 5, &[], "Stereo to 5.0 (L R C Ls Rs)"),
    ];
    const SAMPLE_ACCURATE_AUTOMATION: bool = true;
    // The framework allocates on the audio thread for more events than this in one block. Its default, 1024, is passed by
    // a host that automates all parameters at a dozen points.
    const INPUT_EVENT_CAPACITY: usize = pyrophone_settings::PARAMETERS.len() * POINTS_PER_BLOCK;
    const MIDI_INPUT: MidiConfig = MidiConfig::Basic;

    type Editor = PyrophoneEditor;
    type SysExMessage = ();
    type BackgroundTask = EffectTask;

    fn task_executor(&mut self) -> TaskExecutor<Self> {
        let (drain_barrier, params, notifier) =
            (self.drain_barrier.clone(), self.params.clone(), self.notifier.clone());
        Box::new(move |task| match task {
            EffectTask::PassDrainBarrier => drain_barrier.pass(),
            EffectTask::HostMenu => {
                if params.host_menu.work() {
                    notifier.request_repaint();
                }
            }
        })
    }

    fn params(&self) -> Arc<dyn Params> {
        self.params.clone()
    }

    fn editor(&mut self, executor: AsyncExecutor<Self>) -> Option<Self::Editor> {
        let main_thread = executor.clone();
        self.params.host_menu.set_caller(move || main_thread.execute_gui(EffectTask::HostMenu));
        self.executor = Some(executor);
        PyrophoneEditor::new(self.window(), self.params.window.clone(), self.notifier.clone())
    }

    fn filter_state(state: &mut PluginState) {
        sanitize(state);
    }

    fn activate(
        &mut self,
        layout: &AudioIOLayout,
        config: &BufferConfig,
        context: &mut impl ActivateContext<Self>,
    ) -> bool {
        let began = Instant::now();
        let count = |channels: Option<NonZeroU32>| channels.map_or(0, |channels| channels.get() as usize);
        let channels = Channels {
            input: count(layout.main_input_channels),
            sidechain: layout.aux_input_ports.first().map_or(0, |port| port.get() as usize),
            output: count(layout.main_output_channels),
        };
        self.meters.set_sidechain(channels.sidechain as u32);
        let sample_rate_hz = f64::from(config.sample_rate);
        self.sample_rate_hz = config.sample_rate;
        self.is_offline = config.process_mode == ProcessMode::Offline;
        let engine = Engine { sample_rate_hz, structure: self.params.values().structure(), channels };
        let latency_samples = match self.start(engine, config, began) {
            Ok(latency_samples) => latency_samples,
            Err(reason) => {
                self.pass_through(channels, config, &reason);
                announce_latency(context, 0);
                return true;
            }
        };
        if std::mem::take(&mut self.is_rate_refused) {
            self.loader.handle().status.update(|view| view.error = None);
        }
        self.meters.set_engine(config.sample_rate, latency_samples);
        announce_latency(context, latency_samples);
        true
    }

    fn reset(&mut self) {
        self.audio.reset();
        self.clock.reset();
    }

    fn process(
        &mut self,
        buffer: &mut Buffer,
        aux: &mut AuxiliaryBuffers,
        context: &mut impl ProcessContext<Self>,
    ) -> ProcessStatus {
        let began = self.audio.is_watched().then(Instant::now);
        if self.is_offline {
            // A state loaded since the activation may still be in progress; offline there is no time limit.
            self.loader.wait_for_all();
        }
        self.audio.receive_updates();
        let values = self.params.values();
        let samples = buffer.samples();
        let transport = context.transport();
        let reported = Reported {
            api: context.plugin_api(),
            playing: transport.playing,
            position: transport.pos_samples(),
            has_tempo: transport.tempo.is_some(),
        };
        let transport = self.clock.transport(reported, samples);
        let bursts = note_bursts(context, samples);
        let sidechain = aux.inputs.first().map_or(&[] as &[_], |port| port.as_slice_immutable());
        if self.audio.is_watched() {
            let peak = sidechain.iter().flat_map(|channel| channel.iter()).fold(0.0f32, |peak, x| peak.max(x.abs()));
            self.meters.sidechain.raise(peak);
        }
        self.audio.process(buffer.as_slice(), sidechain, &values, &bursts, transport);

        self.meters.publish(&self.audio.take_meters());
        if let Some(began) = began {
            self.audio.report_load(began.elapsed().as_secs_f32() * self.sample_rate_hz / samples.max(1) as f32);
        }
        let is_lively = transport.playing || self.audio.tail() != Tail::Over;
        if self.frame_pace.process(samples, is_lively, self.sample_rate_hz) && self.audio.is_watched() {
            self.notifier.request_repaint();
        }
        // The new latency is reported by the activation, which is the only place for it.
        if self.audio.wants_restart(&values) {
            context.request_restart();
        }
        match self.audio.tail() {
            // A window may start a burst or play the recording while the input is silent: hosts must keep calling.
            _ if self.audio.is_watched() => ProcessStatus::KeepAlive,
            Tail::Over => ProcessStatus::Normal,
            Tail::Samples(samples) => ProcessStatus::Tail(samples),
            Tail::Endless => ProcessStatus::KeepAlive,
        }
    }

    fn deactivate(&mut self) {
        self.builder.finish();
        self.audio.stop_gas();
        if let Some(executor) = &self.executor
            && !self.drain_barrier.wait(|| executor.execute_background(EffectTask::PassDrainBarrier))
        {
            nice_warn!("Pyrophone's background tasks did not end in time");
        }
    }
}

impl ClapPlugin for Pyrophone {
    const CLAP_ID: &'static str = "org.pyrophone.pyrophone";
    const CLAP_DESCRIPTION: Option<&'static str> =
        Some("Turns a low-frequency flame signal, or any sound's envelope, into the full-band sound of fire");
    const CLAP_MANUAL_URL: Option<&'static str> = Some("https://pyrophone.org/manual");
    const CLAP_SUPPORT_URL: Option<&'static str> = Some("https://pyrophone.org/support");
    const CLAP_FEATURES: &'static [ClapFeature] = &[
        ClapFeature::AudioEffect,
        ClapFeature::Mono,
        ClapFeature::Stereo,
        ClapFeature::Surround,
        ClapFeature::MultiEffects,
    ];

    fn remote_controls(&self, context: &mut impl RemoteControlsContext) {
        remote_pages::define(&self.params, context);
    }
}

impl Vst3Plugin for Pyrophone {
    const VST3_CLASS_ID: [u8; 16] = pyrophone_settings::vst3_preset::CLASS_ID;
    const VST3_SUBCATEGORIES: &'static [Vst3SubCategory] =
        &[Vst3SubCategory::Fx, Vst3SubCategory::Generator, Vst3SubCategory::Surround];
}
