//! One bounce.

use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use pyrophone_host::bounce::{AutomationPoint, BlockSize, BounceOptions, bounce};
use pyrophone_host::state::State;
use pyrophone_host::{BusLayout, Configuration, Format, Plugin, load, numeric_id};
use pyrophone_recording::Recording;
use pyrophone_settings::session::{FIELD, Learned, RecordingReference};
use pyrophone_settings::{Automation, PARAMETERS, Session, Values};
use pyrophone_synthesis::texture::PyramidConfig;
use pyrophone_synthesis::texture::shape::Padding;

use super::layout;
use crate::project;

/// A signal to play, with its settings.
pub struct Request<'a> {
    /// Format of the bundle.
    pub format: Format,
    /// Values of all parameters at the start.
    pub values: &'a Values,
    /// Their steps.
    pub automation: &'a Automation,
    /// Main input.
    pub main: &'a Recording,
    /// Channels of the sidechain, as long as the input; empty = not connected.
    pub sidechain: &'a [Vec<f32>],
    /// The recording that texture draws from.
    pub training: Option<RecordingReference>,
    /// The learned distribution of the input's amplitudes.
    pub learned: Option<Learned>,
    /// Cutting into blocks.
    pub block: BlockSize,
    /// True if the host renders offline.
    pub offline: bool,
    /// True to add the zero padding of the published program and trim it again.
    pub reference_padding: bool,
    /// Channels of the output.
    pub output_channels: usize,
}

/// Result of playing.
pub struct Played {
    /// As long as the input, aligned with it.
    pub channels: Vec<Vec<f32>>,
    /// The latency that was compensated.
    pub latency_samples: u32,
    /// Time until the recording was read and indexed.
    pub loading: Duration,
    /// Time for playing everything.
    pub playing: Duration,
}

/// Loads the built bundle and plays the input through it.
pub fn play(request: &Request<'_>) -> Result<Played> {
    let name = format!("Pyrophone.{}", request.format.extension());
    let bundle = project::target_dir().join("bundled").join(name);
    let mut plugin = load(&bundle, request.format)?;
    let layout = layout(request)?;
    let sample_rate = f64::from(request.main.sample_rate_hz);
    set_session(plugin.as_mut(), request)?;
    set_values(plugin.as_mut(), request.format, request.values)?;
    let began = Instant::now();
    wait_for_recording(plugin.as_mut(), sample_rate, layout)
        .with_context(|| format!("with {layout}: try another --channels, or another sidechain"))?;
    let loading = began.elapsed();

    let mut options = BounceOptions::new(sample_rate, layout);
    options.block = request.block.clone();
    options.offline = request.offline;
    options.automation = automation(plugin.as_mut(), request.automation, sample_rate)?;
    let samples = request.main.len_samples();
    if request.reference_padding {
        let levels = PyramidConfig::at_rate(&request.values.structure(), sample_rate).levels;
        let padding = Padding::new(samples, levels, "input")?;
        options.pad_before = padding.start[0];
        options.extra_after = padding.size[0] - padding.end[0];
    }
    let sidechain = (!request.sidechain.is_empty()).then_some(request.sidechain);
    let began = Instant::now();
    let bounced = bounce(plugin.as_mut(), &request.main.channels, sidechain, &options)?;
    let playing = began.elapsed();
    ensure!(
        !bounced.requests.restart && !bounced.requests.latency_changed,
        "the plugin asked for a restart while playing, so its output is not aligned"
    );
    let mut channels = bounced.channels;
    channels.iter_mut().for_each(|channel| channel.truncate(samples));
    Ok(Played { channels, latency_samples: bounced.latency_samples, loading, playing })
}

/// Puts the recording and the learned distribution into the plugin's state.
fn set_session(plugin: &mut dyn Plugin, request: &Request<'_>) -> Result<()> {
    let session =
        Session { recording: request.training.clone(), learned: request.learned.clone(), ..Session::default() };
    let mut state = State::from_bytes(request.format, &plugin.state()?)?;
    // A field of a state is JSON, and this one's content is JSON text.
    state.fields.insert(FIELD.to_owned(), serde_json::to_string(&session.to_json())?);
    plugin.set_state(&state.to_bytes(request.format)?)?;
    Ok(())
}

/// A parameter's text as the plugin gives it to hosts of this format: VST3 hosts append the unit themselves.
fn shown<'a>(format: Format, unit: &str, text: &'a str) -> &'a str {
    match format {
        Format::Clap => text,
        Format::Vst3 => text.strip_suffix(unit).map_or(text, str::trim_end),
    }
}

/// Sets every parameter by its text, as a person would, and checks that the plugin returns the same text.
fn set_values(plugin: &mut dyn Plugin, format: Format, values: &Values) -> Result<()> {
    for (parameter, plain) in PARAMETERS.iter().zip(values.as_slice()) {
        let id = numeric_id(parameter.id);
        let text = parameter.to_text(*plain);
        let normalised = plugin.parse(id, &text)?;
        plugin.set_value(id, normalised)?;
        let value = plugin.value(id)?;
        let found = plugin.text(id, value)?;
        let expected = shown(format, parameter.unit, &text);
        ensure!(found == expected, "{} was set to {expected}, but the plugin says {found}", parameter.id);
    }
    Ok(())
}

/// An activation in offline mode returns only when the recording is ready.
fn wait_for_recording(plugin: &mut dyn Plugin, sample_rate: f64, layout: BusLayout) -> Result<()> {
    let processor = plugin.activate(&Configuration { sample_rate, max_block: 512, layout, offline: true })?;
    plugin.run_callbacks();
    plugin.deactivate(processor)?;
    plugin.run_callbacks();
    Ok(())
}

fn automation(plugin: &mut dyn Plugin, automation: &Automation, sample_rate: f64) -> Result<Vec<AutomationPoint>> {
    let events = automation.events(sample_rate);
    let points = events.iter().map(|event| {
        let parameter = &PARAMETERS[event.parameter];
        let id = numeric_id(parameter.id);
        let value = plugin.parse(id, &parameter.to_text(event.value))?;
        let sample = i64::try_from(event.sample).context("automation later than any host can play")?;
        Ok(AutomationPoint { sample, id, value })
    });
    points.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vst3_texts_have_no_unit() {
        for (unit, text, in_vst3) in [("dB", "-3.00 dB", "-3.00"), ("", "Bridge", "Bridge"), ("%", "50 %", "50")] {
            assert_eq!(shown(Format::Vst3, unit, text), in_vst3);
            assert_eq!(shown(Format::Clap, unit, text), text);
        }
    }
}
