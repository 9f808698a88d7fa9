//! Blocks of several channels, without allocating.

/// Largest number of channels of any bus: those of 7.1.2.
pub(super) const MAX_CHANNELS: usize = 10;

/// Calls `process` with the first `samples` of every channel, without allocating.
pub(super) fn with_blocks(channels: &mut [Vec<f64>], samples: usize, process: impl FnOnce(&mut [&mut [f64]])) {
    let mut blocks: [&mut [f64]; MAX_CHANNELS] = Default::default();
    let count = channels.len().min(MAX_CHANNELS);
    for (block, channel) in blocks.iter_mut().zip(channels) {
        *block = &mut channel[..samples];
    }
    process(&mut blocks[..count]);
}
