//! Recorded drive and output, for saving as sound files.

/// Longest take in seconds.
pub const LONGEST_S: f64 = 300.0;

/// Drive and output, in time with each other, of one stretch of playing.
#[derive(Debug, Clone, Default)]
pub struct Take {
    is_on: bool,
    drive: Vec<f32>,
    output: Vec<Vec<f32>>,
    /// Frames that the window was too slow for.
    lost: u64,
    most: usize,
}

impl Take {
    /// True while recording.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Starts a new recording of sound at `sample_rate_hz`.
    pub fn start(&mut self, sample_rate_hz: f64) {
        *self = Self { is_on: true, most: (LONGEST_S * sample_rate_hz) as usize, ..Self::default() };
    }

    /// Stops; the recorded sound is kept.
    pub fn stop(&mut self) {
        self.is_on = false;
    }

    /// Adds one frame while recording, which stops by itself at the maximum length and where the number of channels
    /// changes.
    pub fn push(&mut self, drive: f32, output: &[f32]) {
        if !self.is_on {
            return;
        }
        if self.drive.is_empty() {
            self.output = vec![vec![]; output.len()];
        }
        if self.drive.len() >= self.most || self.output.len() != output.len() {
            self.is_on = false;
            return;
        }
        self.drive.push(drive);
        self.output.iter_mut().zip(output).for_each(|(channel, sample)| channel.push(*sample));
    }

    /// Notes that frames were lost.
    pub fn lose(&mut self, frames: u32) {
        if self.is_on {
            self.lost += u64::from(frames);
        }
    }

    /// Frames that are missing.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Length in samples.
    pub fn len_samples(&self) -> usize {
        self.drive.len()
    }

    /// The drive, one channel.
    pub fn drive(&self) -> Vec<Vec<f32>> {
        vec![self.drive.clone()]
    }

    /// The output by channel.
    pub fn output(&self) -> Vec<Vec<f32>> {
        self.output.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_take_keeps_what_passes_while_it_is_on() {
        let mut take = Take::default();
        take.push(1.0, &[1.0]);
        take.lose(3);
        assert_eq!((take.len_samples(), take.lost()), (0, 0));
        take.start(10.0);
        for n in 0..20 {
            take.push(n as f32, &[1.0, -(n as f32)]);
        }
        take.lose(3);
        take.stop();
        take.push(9.0, &[9.0, 9.0]);
        assert_eq!((take.len_samples(), take.lost(), take.drive()[0][19]), (20, 3, 19.0));
        assert_eq!((take.output().len(), take.output()[1][19]), (2, -19.0));
        take.start(10.0);
        for _ in 0..5000 {
            take.push(0.5, &[0.5]);
        }
        assert_eq!((take.is_on(), take.len_samples(), take.lost()), (false, 3000, 0), "five minutes");
        take.start(10.0);
        take.push(0.5, &[0.5]);
        take.push(0.5, &[0.5, 0.5]);
        assert_eq!((take.is_on(), take.len_samples()), (false, 1), "another layout is another take");
    }
}
