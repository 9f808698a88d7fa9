//! Level of a sound: its peak, and its integrated loudness (ITU-R BS.1770).

use ebur128::{Channel, EbuR128, Mode};

use crate::notes::note;

/// Loudness in LUFS below which listeners turn up the volume or miss the sound.
const QUIET_LUFS: f64 = -40.0;

/// Samples per call of the meter, so that no second copy of the sound is needed.
const BLOCK_SAMPLES: usize = 1 << 16;

/// Peak and loudness of a sound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Magnitude of the largest sample; 1 is full scale.
    pub peak: f32,
    /// Integrated loudness; none for silence, or for sounds shorter than the 0.4 s of a measuring block.
    pub lufs: Option<f64>,
}

impl Level {
    /// Measures `channels` of equal length, in the channel order of this project's layouts.
    pub fn of_channels(channels: &[Vec<f32>], sample_rate_hz: u32) -> Self {
        let peak = channels.iter().flatten().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
        let lufs = loudness(channels, sample_rate_hz).ok().filter(|lufs| lufs.is_finite());
        Self { peak, lufs }
    }

    /// The peak in dBFS; none for silence.
    pub fn peak_dbfs(&self) -> Option<f64> {
        (self.peak > 0.0).then(|| 20.0 * f64::from(self.peak).log10())
    }

    /// Notes a sound that is too loud for players, or hard to hear.
    pub fn note_extremes(&self) {
        if let Some(message) = self.remark() {
            note(&message);
        }
    }

    fn remark(&self) -> Option<String> {
        let Some(peak_dbfs) = self.peak_dbfs() else {
            return Some("the output is silent".to_owned());
        };
        if self.peak > 1.0 {
            return Some(format!(
                "the output's peak is {peak_dbfs:+.1} dBFS, where players clip; turn it down by {:.1} dB or more",
                (10.0 * peak_dbfs).ceil() / 10.0
            ));
        }
        let lufs = self.lufs.filter(|lufs| *lufs < QUIET_LUFS)?;
        Some(format!("the output is quiet: {lufs:.1} LUFS, with a peak of {peak_dbfs:.1} dBFS"))
    }
}

fn loudness(channels: &[Vec<f32>], sample_rate_hz: u32) -> Result<f64, ebur128::Error> {
    let mut meter = EbuR128::new(channels.len() as u32, sample_rate_hz, Mode::I)?;
    meter.set_channel_map(map(channels.len()))?;
    let samples = channels.iter().map(Vec::len).min().unwrap_or(0);
    for start in (0..samples).step_by(BLOCK_SAMPLES) {
        let end = samples.min(start + BLOCK_SAMPLES);
        let block: Vec<&[f32]> = channels.iter().map(|channel| &channel[start..end]).collect();
        meter.add_frames_planar_f32(&block)?;
    }
    meter.loudness_global()
}

/// Loudspeakers of a channel count, for the weights of the measurement: surrounds count more, the LFE not at all.
fn map(channels: usize) -> &'static [Channel] {
    use Channel::{Center, Left, LeftSurround, Mm090, Mm135, Mp090, Mp135, Right, RightSurround, Um045, Unused, Up045};
    match channels {
        1 => &[Left],
        2 => &[Left, Right],
        3 => &[Left, Right, Center],
        4 => &[Left, Right, Mp135, Mm135],
        5 => &[Left, Right, Center, LeftSurround, RightSurround],
        6 => &[Left, Right, Center, Unused, LeftSurround, RightSurround],
        7 => &[Left, Right, Center, Mp135, Mm135, Mp090, Mm090],
        8 => &[Left, Right, Center, Unused, Mp135, Mm135, Mp090, Mm090],
        9 => &[Left, Right, Center, Mp135, Mm135, Mp090, Mm090, Up045, Um045],
        _ => &[Left, Right, Center, Unused, Mp135, Mm135, Mp090, Mm090, Up045, Um045],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(amplitude: f32, seconds: f32) -> Vec<f32> {
        let samples = (48_000.0 * seconds) as usize;
        (0..samples).map(|n| amplitude * (std::f32::consts::TAU * 997.0 * n as f32 / 48_000.0).sin()).collect()
    }

    #[test]
    fn loudness_is_that_of_the_standard() {
        // BS.1770: a tone of 997 Hz at full scale in one of the front channels reads -3.01.
        let level = Level::of_channels(&[tone(1.0, 2.0)], 48_000);
        assert!((level.lufs.unwrap() + 3.01).abs() < 0.02, "{level:?}");
        let both = Level::of_channels(&[tone(1.0, 2.0), tone(1.0, 2.0)], 48_000);
        assert!(both.lufs.unwrap().abs() < 0.02, "{both:?}");
        assert!(level.peak_dbfs().unwrap().abs() < 0.01, "{level:?}");
    }

    #[test]
    fn every_layout_is_measured_and_the_lfe_is_left_out() {
        for channels in 1..=10 {
            let level = Level::of_channels(&vec![tone(0.1, 1.0); channels], 48_000);
            assert!(level.lufs.is_some(), "{channels} channels");
        }
        let mut surround = vec![vec![0.0; 96_000]; 6];
        surround[3] = tone(0.5, 2.0);
        assert_eq!(Level::of_channels(&surround, 48_000).lufs, None);
    }

    #[test]
    fn extremes_are_remarked_with_the_peak() {
        let remark = |sound: Vec<f32>| Level::of_channels(&[sound], 48_000).remark();
        assert_eq!(remark(tone(0.5, 1.0)), None);
        assert!(remark(tone(2.0, 1.0)).unwrap().contains("+6.0 dBFS"));
        assert!(remark(tone(0.001, 1.0)).unwrap().contains("-63.0 LUFS, with a peak of -60.0 dBFS"));
        assert!(remark(vec![0.0; 48_000]).unwrap().contains("silent"));
        assert_eq!(remark(tone(0.001, 0.1)), None, "too short to be measured");
    }
}
