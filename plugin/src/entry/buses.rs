//! Channel pointers that are never null.
//!
//! Hosts pass buses with channels and null pointers, fewer buses than were declared, or fewer channels. The framework
//! reads all declared channels. So every missing channel is replaced by silence to read from, or by unused memory to
//! write to. Both are allocated at activation.

use crate::channels::MAX_CHANNELS;

/// Most input buses: main and sidechain.
pub const MAX_INPUTS: usize = 2;

/// Channels of the buses as the plug-in has them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Declared {
    /// Channels of the inputs, main first; 0 for a bus that does not exist.
    pub inputs: [usize; MAX_INPUTS],
    /// Channels of the output.
    pub output: usize,
}

/// Channel pointers of one bus, as many as declared.
pub type Pointers = [*mut f32; MAX_CHANNELS];

/// Memory that replaces missing channels, and the pointers of the current block.
pub struct Buses {
    declared: Declared,
    max_block: usize,
    /// Never written to. Missing inputs share it.
    silence: Vec<f32>,
    /// Never read.
    unheard: Vec<Vec<f32>>,
    /// Inputs of the current block.
    pub inputs: [Pointers; MAX_INPUTS],
    /// Output of the current block.
    pub output: Pointers,
}

// SAFETY: the pointers are to this object's own memory or to that of the current block, which is used by the one thread
// that holds this object exclusively; between blocks nothing dereferences them.
unsafe impl Send for Buses {}

impl Buses {
    /// Replacement channels for up to `max_block` samples; allocates.
    pub fn new(declared: Declared, max_block: usize) -> Self {
        let clamp = |channels: usize| channels.min(MAX_CHANNELS);
        let declared = Declared { inputs: declared.inputs.map(clamp), output: clamp(declared.output) };
        let null = [std::ptr::null_mut(); MAX_CHANNELS];
        Self {
            declared,
            max_block,
            silence: vec![0.0; max_block],
            unheard: vec![vec![0.0; max_block]; declared.output],
            inputs: [null; MAX_INPUTS],
            output: null,
        }
    }

    /// The buses that were declared.
    pub fn declared(&self) -> Declared {
        self.declared
    }

    /// Length of the replacement channels, in samples.
    pub fn max_block(&self) -> usize {
        self.max_block
    }

    /// Sets an input's channels, `given` by the host; real-time safe. Where one of them is missing the whole bus is
    /// silent: hosts built on JUCE that run out of channels pass a null pointer followed by arbitrary ones.
    pub fn set_input(&mut self, bus: usize, given: impl Fn(usize) -> *mut f32) {
        let channels = &mut self.inputs[bus][..self.declared.inputs[bus]];
        for (index, channel) in channels.iter_mut().enumerate() {
            *channel = given(index);
            if channel.is_null() {
                channels.fill(self.silence.as_mut_ptr());
                return;
            }
        }
    }

    /// Sets the output's channels; returns false if the host gave none at all.
    pub fn set_output(&mut self, given: impl Fn(usize) -> *mut f32) -> bool {
        let mut is_heard = false;
        for (channel, unheard) in self.unheard.iter_mut().enumerate() {
            let pointer = given(channel);
            is_heard |= !pointer.is_null();
            self.output[channel] = if pointer.is_null() { unheard.as_mut_ptr() } else { pointer };
        }
        is_heard
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_channels_are_silent_in_and_unheard_out() {
        let mut buses = Buses::new(Declared { inputs: [2, 1], output: 2 }, 8);
        let mut given = [0.5f32; 8];
        let pointer = given.as_mut_ptr();
        buses.set_input(0, |channel| if channel == 0 { pointer } else { std::ptr::null_mut() });
        buses.set_input(1, |_| std::ptr::null_mut());
        assert_eq!(buses.inputs[0][..2], [buses.inputs[1][0]; 2], "half a bus is none");
        buses.set_input(0, |_| pointer);
        assert_eq!(buses.inputs[0][..2], [pointer; 2]);
        // SAFETY: eight samples of the object's own.
        let silence = unsafe { std::slice::from_raw_parts(buses.inputs[1][0], 8) };
        assert_eq!(silence, [0.0; 8]);
        assert!(buses.set_output(|channel| if channel == 1 { pointer } else { std::ptr::null_mut() }));
        assert!(buses.output[1] == pointer && !buses.output[0].is_null());
        assert!(!buses.set_output(|_| std::ptr::null_mut()), "a host that gives no output is told apart");
        assert!(buses.output[0] != buses.output[1], "channels that are written to have their own memory");
    }
}
