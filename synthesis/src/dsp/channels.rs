//! Signals of several channels.

use std::borrow::Cow;

/// The mean of the channels, sample by sample; at least one channel is needed, and all have one length. A single channel is its
/// own mean, and is not copied: it may be many minutes long.
pub(crate) fn mean_of(channels: &[Vec<f64>]) -> Cow<'_, [f64]> {
    if let [only] = channels {
        return Cow::Borrowed(only);
    }
    let scale = 1.0 / channels.len() as f64;
    Cow::Owned((0..channels[0].len()).map(|i| channels.iter().map(|x| x[i]).sum::<f64>() * scale).collect())
}
