use std::path::PathBuf;

use crate::BusLayout;

/// Reason why a host could not do as requested.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// The bundle could not be opened.
    #[error("cannot load {}: {reason}", path.display())]
    Load {
        /// The bundle.
        path: PathBuf,
        /// The cause.
        reason: String,
    },
    /// No parameter has this numeric id.
    #[error("the plug-in has no parameter with the numeric id {id}; `Plugin::parameters` lists those it has")]
    UnknownParameter {
        /// The requested id.
        id: u32,
    },
    /// The plugin does not understand this text as a value.
    #[error("the plug-in does not accept {text:?} as a value of parameter {id}")]
    Text {
        /// The parameter.
        id: u32,
        /// The text.
        text: String,
    },
    /// The plugin refused to save or load its state.
    #[error("the plug-in refused to {action} its state")]
    State {
        /// `save` or `load`.
        action: &'static str,
    },
    /// A state is not in nice-plug's format.
    #[error("not a state of this plug-in: {0}")]
    StateFormat(String),
    /// The plugin has no such channel layout.
    #[error("the plug-in has no layout {0}")]
    Layout(BusLayout),
    /// The plug-in refused to become active, or the configuration makes no sense.
    #[error("the plug-in cannot be activated: {0}")]
    Activate(String),
    /// The plug-in is active and must not be, or vice versa.
    #[error("the plug-in is {found}, but must be {needed} for this")]
    Lifecycle {
        /// Its state.
        found: &'static str,
        /// The state needed.
        needed: &'static str,
    },
    /// A block is longer than announced at activation.
    #[error("a block of {frames} frames, but at most {max_block} were announced when activating")]
    BlockTooLong {
        /// Frames of the block.
        frames: usize,
        /// Frames announced.
        max_block: usize,
    },
    /// A bus of a block has the wrong number of channels, or a channel the wrong length.
    #[error("{bus}: {found}, but the layout and block need {needed}")]
    Channels {
        /// The bus.
        bus: &'static str,
        /// Channels given.
        found: String,
        /// Channels needed.
        needed: String,
    },
    /// An event is outside its block, or earlier than the previous event.
    #[error("an event at offset {offset} in a block of {frames} frames; events must be in order and inside the block")]
    EventOffset {
        /// The event's offset.
        offset: u32,
        /// Frames of the block.
        frames: usize,
    },
    /// The plugin reported an error from `process`.
    #[error("the plug-in failed to process a block")]
    Process,
    /// The plugin wrote past the end of a block.
    #[error("the plug-in wrote past the end of a block of {frames} frames")]
    Overrun {
        /// Frames of the block.
        frames: usize,
    },
    /// The request is not possible in this format or on this system.
    #[error("{0}")]
    Unsupported(String),
}
