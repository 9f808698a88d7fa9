//! The factor that gives texture the drive's loudness, for recordings of any level.

/// Loudness by frames, interpolated between their centres. A recording's own level is applied on reading.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct OutputGain {
    frame: Option<i64>,
    /// Loudness, and the share of it that the gate passes, for the frames before and after.
    from: [f64; 2],
    to: [f64; 2],
}

impl OutputGain {
    /// Moves to the interval between `frame` and the next; `values_of` is called once for every frame.
    #[inline]
    pub fn go_to(&mut self, frame: i64, mut values_of: impl FnMut(i64) -> [f64; 2]) {
        if self.frame != Some(frame) {
            let follows = self.frame.is_some_and(|before| before + 1 == frame);
            self.from = if follows { self.to } else { values_of(frame) };
            self.to = values_of(frame + 1);
            self.frame = Some(frame);
        }
    }

    /// The factor, at the fraction `part` of the way to the next frame, for a recording of this `level`.
    #[inline]
    pub fn gain_at(&self, part: f64, level: f64) -> f64 {
        let [from, to] = [self.from, self.to].map(|[loudness, audible]| level * loudness * audible);
        from + part * (to - from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_frame_is_computed_once_and_interpolated() {
        let (mut gain, mut asked) = (OutputGain::default(), Vec::new());
        let mut go_to = |gain: &mut OutputGain, frame: i64| {
            gain.go_to(frame, |frame| {
                asked.push(frame);
                [frame as f64, 0.5]
            });
        };
        [3, 3, 4, 9].into_iter().for_each(|frame| go_to(&mut gain, frame));
        assert_eq!(asked, [3, 4, 5, 9, 10]);
        assert_eq!((gain.gain_at(0.0, 2.0), gain.gain_at(0.5, 2.0)), (9.0, 9.5));
    }
}
