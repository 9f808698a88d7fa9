//! The memory a plugin plays from and into.

use crate::{Block, BusLayout, HostError};

/// Samples after the end of a block that the plug-in must not touch.
const GUARD_SAMPLES: usize = 16;
/// Value in the output before the plug-in writes it, and in the guard after it: an untouched sample is recognised.
const UNTOUCHED: f32 = f32::from_bits(0x7fc0_dead);

/// Owned channels of one instance, so that no pointer given to a plug-in outlives its target.
pub(crate) struct Buses {
    layout: BusLayout,
    max_block: usize,
    input: Vec<Vec<f32>>,
    sidechain: Vec<Vec<f32>>,
    output: Vec<Vec<f32>>,
}

/// Pointers to the channels of a block, valid until the [`Buses`] are used again.
pub(crate) struct Pointers {
    pub input: Vec<*mut f32>,
    pub sidechain: Vec<*mut f32>,
    pub output: Vec<*mut f32>,
}

impl Buses {
    /// Buses for `layout`, the plug-in's own: with a sidechain that the caller may omit.
    pub fn new(layout: BusLayout, max_block: usize) -> Self {
        let channels = |count: u32| vec![vec![0.0; max_block + GUARD_SAMPLES]; count as usize];
        Self {
            layout,
            max_block,
            input: channels(layout.input),
            sidechain: channels(layout.sidechain),
            output: channels(layout.output),
        }
    }

    /// Checks a block, copies its input here and gives its number of frames and the pointers for the plugin.
    pub fn load(&mut self, block: &Block<'_>) -> Result<(usize, Pointers), HostError> {
        let frames = block.output.first().map_or(0, |channel| channel.len());
        if frames > self.max_block {
            return Err(HostError::BlockTooLong { frames, max_block: self.max_block });
        }
        check_bus("main output", block.output.iter().map(|channel| channel.len()), self.layout.output, frames)?;
        check_bus("main input", block.input.iter().map(|channel| channel.len()), self.layout.input, frames)?;
        let mut earliest = 0;
        for event in block.events {
            if event.offset < earliest || event.offset as usize >= frames {
                return Err(HostError::EventOffset { offset: event.offset, frames });
            }
            earliest = event.offset;
        }
        for channel in &mut self.output {
            channel[..frames + GUARD_SAMPLES].fill(UNTOUCHED);
        }
        for (own, given) in self.input.iter_mut().zip(block.input) {
            own[..frames].copy_from_slice(given);
        }
        if let Some(sidechain) = block.sidechain {
            check_bus("sidechain", sidechain.iter().map(|channel| channel.len()), self.layout.sidechain, frames)?;
            for (own, given) in self.sidechain.iter_mut().zip(sidechain) {
                own[..frames].copy_from_slice(given);
            }
        } else {
            for own in &mut self.sidechain {
                own[..frames].fill(0.0);
            }
        }
        let output: Vec<*mut f32> = self.output.iter_mut().map(|c| c.as_mut_ptr()).collect();
        let mut input: Vec<*mut f32> = self.input.iter_mut().map(|c| c.as_mut_ptr()).collect();
        if block.in_place {
            let shared = self.input.len().min(self.output.len());
            for (channel, given) in self.output.iter_mut().zip(block.input) {
                channel[..frames].copy_from_slice(given);
            }
            input[..shared].copy_from_slice(&output[..shared]);
        }
        let sidechain = self.sidechain.iter_mut().map(|c| c.as_mut_ptr()).collect();
        Ok((frames, Pointers { input, sidechain, output }))
    }

    /// Copies the plug-in's output into the block.
    pub fn store(&self, block: &mut Block<'_>, frames: usize) -> Result<(), HostError> {
        for (own, taken) in self.output.iter().zip(block.output.iter_mut()) {
            let guard = &own[frames..frames + GUARD_SAMPLES];
            if guard.iter().any(|s| s.to_bits() != UNTOUCHED.to_bits()) {
                return Err(HostError::Overrun { frames });
            }
            taken.copy_from_slice(&own[..frames]);
        }
        Ok(())
    }
}

fn check_bus(
    bus: &'static str,
    lengths: impl ExactSizeIterator<Item = usize>,
    channels: u32,
    frames: usize,
) -> Result<(), HostError> {
    let found: Vec<usize> = lengths.collect();
    if found.len() == channels as usize && found.iter().all(|&length| length == frames) {
        return Ok(());
    }
    Err(HostError::Channels {
        bus,
        found: format!("channels of {found:?} frames"),
        needed: format!("{channels} channels of {frames} frames"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUT: BusLayout = BusLayout { input: 1, sidechain: 0, output: 2 };

    fn block<'a>(input: &'a [&'a [f32]], output: &'a mut [&'a mut [f32]], events: &'a [crate::Event]) -> Block<'a> {
        Block { input, sidechain: None, output, events, transport: None, in_place: false }
    }

    #[test]
    fn a_write_past_the_end_is_seen() {
        let mut buses = Buses::new(LAYOUT, 4);
        let (mut left, mut right) = ([0.0; 3], [0.0; 3]);
        let mut output = [&mut left[..], &mut right[..]];
        let mut block = block(&[&[1.0, 2.0, 3.0]], &mut output, &[]);
        let (frames, pointers) = buses.load(&block).unwrap();
        assert_eq!(frames, 3);
        assert_eq!((pointers.input.len(), pointers.output.len()), (1, 2));
        buses.output[1][..3].fill(0.5);
        assert!(buses.store(&mut block, 3).is_ok());
        assert_eq!(block.output[1], [0.5; 3]);
        buses.output[1][3] = 0.0;
        assert!(matches!(buses.store(&mut block, 3), Err(HostError::Overrun { frames: 3 })));
    }

    #[test]
    fn senseless_blocks_are_refused() {
        let mut buses = Buses::new(LAYOUT, 4);
        let event = |offset| crate::Event { offset, id: 0, value: 0.0 };
        let (mut a, mut b) = ([0.0; 5], [0.0; 5]);
        let too_long = buses.load(&block(&[&[0.0; 5]], &mut [&mut a, &mut b], &[]));
        assert!(matches!(too_long, Err(HostError::BlockTooLong { .. })));
        let narrow = buses.load(&block(&[&[0.0; 4]], &mut [&mut a[..4]], &[]));
        assert!(matches!(narrow, Err(HostError::Channels { .. })));
        for events in [&[event(4)][..], &[event(2), event(1)][..]] {
            let late = buses.load(&block(&[&[0.0; 4]], &mut [&mut a[..4], &mut b[..4]], events));
            assert!(matches!(late, Err(HostError::EventOffset { .. })));
        }
    }
}
