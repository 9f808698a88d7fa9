//! What remains of the sound from before an exchange.

/// Number of hops over which it fades away.
pub(super) const HOPS: usize = 2;

/// The sound from before an exchange continues in a straight line, but only briefly.
#[derive(Debug)]
pub(super) struct Declick {
    /// By channel, the last pressure before the exchange and its slope per sample.
    ends: Vec<[f32; 2]>,
    /// Hops since the exchange.
    hop: usize,
}

impl Declick {
    /// Nothing remains.
    pub fn new(channels: usize) -> Self {
        Self { ends: vec![[0.0; 2]; channels], hop: HOPS }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.hop = HOPS;
    }

    /// Takes note of the last hop before an exchange.
    pub fn begin(&mut self, pressures: &[Vec<f32>]) {
        for (end, pressures) in self.ends.iter_mut().zip(pressures) {
            if let [.., before, last] = pressures[..] {
                *end = [last, last - before];
            }
        }
        self.hop = 0;
    }

    /// Adds what remains in this hop.
    pub fn add(&mut self, pressures: &mut [Vec<f32>]) {
        if self.hop == HOPS {
            return;
        }
        for (pressures, [last, slope]) in pressures.iter_mut().zip(&self.ends) {
            let samples = pressures.len() as f32;
            for (n, pressure) in pressures.iter_mut().enumerate() {
                let hops = self.hop as f32 + n as f32 / samples;
                let went_on = slope * (1.0 + hops * samples) * maths::exp(-16.0 * hops);
                *pressure += (last + went_on) * maths::square(1.0 - hops / HOPS as f32);
            }
        }
        self.hop += 1;
    }
}
