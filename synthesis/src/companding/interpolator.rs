//! Gains given by frames, applied sample by sample.

/// A quantity given by frames, interpolated between their centres.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Interpolator {
    frame: Option<i64>,
    from: f64,
    to: f64,
}

impl Interpolator {
    /// The value at `position`; `value_of` is called once for every frame.
    #[inline]
    pub fn value_at(&mut self, position: (i64, f64), mut value_of: impl FnMut(i64) -> f64) -> f64 {
        let (frame, part) = position;
        if self.frame != Some(frame) {
            let follows = self.frame.is_some_and(|before| before + 1 == frame);
            self.from = if follows { self.to } else { value_of(frame) };
            self.to = value_of(frame + 1);
            self.frame = Some(frame);
        }
        self.from + part * (self.to - self.from)
    }
}
