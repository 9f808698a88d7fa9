//! Signals of several channels.

/// The mean of the channels, sample by sample; at least one channel is needed, and all have one length.
pub(crate) fn mean_of(channels: &[Vec<f64>]) -> Vec<f64> {
    if let [only] = channels {
        return only.clone();
    }
    let scale = 1.0 / channels.len() as f64;
    (0..channels[0].len()).map(|i| channels.iter().map(|x| x[i]).sum::<f64>() * scale).collect()
}
