use std::fmt;
use std::str::FromStr;

use crate::HostError;

/// A plugin format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// CLAP.
    Clap,
    /// VST3.
    Vst3,
}

impl Format {
    /// Both formats, for tests that must pass in each.
    pub const ALL: [Self; 2] = [Self::Clap, Self::Vst3];

    /// The bundle's file name extension, without the dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Clap => "clap",
            Self::Vst3 => "vst3",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.extension())
    }
}

impl FromStr for Format {
    type Err = HostError;

    fn from_str(text: &str) -> Result<Self, HostError> {
        Self::ALL
            .into_iter()
            .find(|format| format.extension().eq_ignore_ascii_case(text))
            .ok_or_else(|| HostError::Unsupported(format!("unknown plugin format {text:?}: give clap or vst3")))
    }
}

/// Channels of the buses. `sidechain: 0` means that none is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BusLayout {
    /// Channels of the main input.
    pub input: u32,
    /// Channels of the sidechain input, 0 for none.
    pub sidechain: u32,
    /// Channels of the main output.
    pub output: u32,
}

impl fmt::Display for BusLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in, {} sidechain, {} out", self.input, self.sidechain, self.output)
    }
}

/// Configuration for an activation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Configuration {
    /// Sample rate in Hz.
    pub sample_rate: f64,
    /// Longest block that will be played, in frames; at least 1.
    pub max_block: usize,
    /// The buses.
    pub layout: BusLayout,
    /// True if the host renders offline (as fast as possible), false in real time.
    pub offline: bool,
}

/// A parameter as the host sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Numeric id, see [`numeric_id`](crate::numeric_id).
    pub id: u32,
    /// Name shown to people.
    pub name: String,
    /// Its groups, outermost first, separated by `/`; empty outside any group.
    pub group: String,
    /// Unit; always empty in CLAP, where it is part of the text of a value.
    pub unit: String,
    /// Number of steps between the lowest and the highest value, 0 for a continuous parameter.
    pub steps: u32,
    /// Default value, normalised.
    pub default: f64,
    /// True if the host may automate it.
    pub automatable: bool,
    /// True if it is hidden from users.
    pub hidden: bool,
    /// True if it is the host's bypass switch.
    pub bypass: bool,
}

/// A change of a parameter at a frame of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Frame within the block.
    pub offset: u32,
    /// Numeric id of the parameter.
    pub id: u32,
    /// New value, normalised.
    pub value: f64,
}

/// A message of a MIDI controller at a frame of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControllerMessage {
    /// Frame within the block.
    pub offset: u32,
    /// MIDI channel, 0-15.
    pub channel: u8,
    /// Number of the controller, 0-127.
    pub controller: u8,
    /// Position, 0-127.
    pub position: u8,
}

/// The host's timeline at the first frame of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transport {
    /// True if the transport runs.
    pub playing: bool,
    /// Position in samples, if the host has one. A VST3 context always has one: there, `None` omits the whole context.
    pub position: Option<i64>,
    /// Tempo in beats per minute, if the host has one.
    pub tempo: Option<f64>,
}

impl Transport {
    /// A running transport at this position, at 120 beats per minute.
    #[must_use]
    pub const fn playing_at(position: i64) -> Self {
        Self { playing: true, position: Some(position), tempo: Some(120.0) }
    }
}

/// One call of `process`: as many frames as the channels of `output` have.
#[derive(Debug)]
pub struct Block<'a> {
    /// Channels of the main input.
    pub input: &'a [&'a [f32]],
    /// Channels of the sidechain. `None` leaves it away: silent in CLAP, a switched-off bus in VST3.
    pub sidechain: Option<&'a [&'a [f32]]>,
    /// Channels of the main output; every sample is overwritten.
    pub output: &'a mut [&'a mut [f32]],
    /// Changes of parameters, in order of their offsets.
    pub events: &'a [Event],
    /// The timeline; `None` if the host provides none.
    pub transport: Option<Transport>,
    /// True if input and output share their memory, as hosts may choose.
    pub in_place: bool,
}

/// Tail of a plug-in: sound after its input has fallen silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tail {
    /// This many samples.
    Samples(u32),
    /// An infinite tail.
    Infinite,
}

/// Requests made by the plug-in since the last query.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Requests {
    /// Request to be deactivated and activated again.
    pub restart: bool,
    /// Request to read the latency again.
    pub latency_changed: bool,
    /// Request to read the values of the parameters again.
    pub values_changed: bool,
}

impl Requests {
    /// Requests made in either.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self {
            restart: self.restart || other.restart,
            latency_changed: self.latency_changed || other.latency_changed,
            values_changed: self.values_changed || other.values_changed,
        }
    }
}

/// Entries that this crate's hosts add to the menu of every parameter, by their numbers: one in the menu, and one in a
/// submenu.
pub const MENU: [(i32, &str); 2] = [(77, "Show automation"), (78, "To a modulator")];
/// The name of that menu.
pub const SUBMENU: &str = "Link";

/// The half of a plugin instance that belongs to the main thread: the thread that loaded it.
pub trait Plugin {
    /// The format it was loaded from.
    fn format(&self) -> Format;

    /// The plugin's name.
    fn name(&self) -> &str;

    /// Its parameters, in the plugin's order.
    fn parameters(&self) -> &[Parameter];

    /// The present value of a parameter, normalised.
    ///
    /// # Errors
    /// [`HostError::UnknownParameter`].
    fn value(&mut self, id: u32) -> Result<f64, HostError>;

    /// Sets a parameter to a normalised value from the main thread: at once while inactive, with the next block while
    /// active.
    ///
    /// # Errors
    /// [`HostError::UnknownParameter`].
    fn set_value(&mut self, id: u32, value: f64) -> Result<(), HostError>;

    /// The text of a normalised value.
    ///
    /// # Errors
    /// [`HostError::UnknownParameter`].
    fn text(&mut self, id: u32, value: f64) -> Result<String, HostError>;

    /// The normalised value that a text means.
    ///
    /// # Errors
    /// [`HostError::UnknownParameter`]; [`HostError::Text`] when the plugin does not understand it.
    fn parse(&mut self, id: u32, text: &str) -> Result<f64, HostError>;

    /// The whole state, as a host would store it in its session; [`state`](crate::state) describes its contents.
    ///
    /// # Errors
    /// [`HostError::State`].
    fn state(&mut self) -> Result<Vec<u8>, HostError>;

    /// Loads a state, also while the processor plays on another thread.
    ///
    /// # Errors
    /// [`HostError::State`] if the plug-in rejects it.
    fn set_state(&mut self, state: &[u8]) -> Result<(), HostError>;

    /// Prepares the plug-in for playing and returns the half that plays.
    ///
    /// A layout without sidechain also matches if the plug-in only has layouts with one: that bus is then left
    /// unconnected.
    ///
    /// # Errors
    /// [`HostError::Layout`], [`HostError::Activate`], [`HostError::Lifecycle`] if it is active already.
    fn activate(&mut self, configuration: &Configuration) -> Result<Box<dyn Processor>, HostError>;

    /// Takes back the playing half and ends the active state.
    ///
    /// # Errors
    /// [`HostError::Lifecycle`] if the plug-in is not active or `processor` belongs to another instance.
    fn deactivate(&mut self, processor: Box<dyn Processor>) -> Result<(), HostError>;

    /// The values that the plug-in has sent to the host since the last query, because its parameters moved by
    /// themselves. The host records them: in VST3 it passes them on to the controller.
    fn take_reported_values(&mut self) -> Vec<Event>;

    /// Choices in the host's menus since the last query: the parameter, and the number of the entry.
    fn take_menu_choices(&mut self) -> Vec<(u32, i32)>;

    /// The latency that the plugin reports, in samples; meaningful while active.
    fn latency_samples(&mut self) -> u32;

    /// Does the work of an idle main thread: runs the callbacks that the plug-in requested, and returns its other
    /// requests.
    fn run_callbacks(&mut self) -> Requests;

    /// Opens the editor inside a system window and returns its size in pixels.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] if there is no editor, or none that can be embedded.
    fn open_editor(&mut self, window: u32) -> Result<(u32, u32), HostError>;

    /// Sets the number of pixels per point for the open editor, and returns its resulting size in pixels.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] if no editor is open, or it does not support this.
    fn scale_editor(&mut self, scale: f64) -> Result<(u32, u32), HostError>;

    /// Resizes the open editor to the nearest size in pixels that it accepts, and returns that size.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] if no editor is open, or it does not resize.
    fn resize_editor(&mut self, size: (u32, u32)) -> Result<(u32, u32), HostError>;

    /// Size in pixels that the editor has requested since the last call.
    fn take_wanted_editor_size(&mut self) -> Option<(u32, u32)>;

    /// Closes the editor, if it is open.
    fn close_editor(&mut self);

    /// Forgets the open editor without closing it, as hosts should not but may, so that it is destroyed with the
    /// plug-in.
    fn forget_editor(&mut self);
}

/// The half of an active plugin instance that plays; it may live on another thread.
pub trait Processor: Send {
    /// Starts playing; the plugin resets.
    ///
    /// # Errors
    /// [`HostError::Process`] if the plug-in refuses.
    fn start(&mut self) -> Result<(), HostError>;

    /// Stops playing.
    fn stop(&mut self);

    /// Makes the plug-in forget its past input. In VST3 this is a stop and a start.
    ///
    /// # Errors
    /// [`HostError::Process`] if the plug-in refuses.
    fn reset(&mut self) -> Result<(), HostError>;

    /// Plays one block, of any number of frames from 0 to the announced maximum.
    ///
    /// # Errors
    /// [`HostError::Lifecycle`] before `start`; [`HostError::BlockTooLong`], [`HostError::Channels`],
    /// [`HostError::EventOffset`] for a block that makes no sense; [`HostError::Process`] and [`HostError::Overrun`] if
    /// the plug-in fails.
    fn process(&mut self, block: &mut Block<'_>) -> Result<(), HostError>;

    /// Sends these messages with the next block, in order of their offsets. A VST3 host maps them to parameters as the
    /// plug-in states.
    fn move_controllers(&mut self, messages: &[ControllerMessage]);

    /// The tail that the plugin reports at present.
    fn tail(&mut self) -> Tail;

    /// Number of its instance, unique in this process.
    fn instance(&self) -> u64;
}
