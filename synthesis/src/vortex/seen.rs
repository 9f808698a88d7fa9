//! Positions of the sources, for display.

use super::renderer::Vortex;

/// A source at the end of the last hop.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SeenSource {
    /// Right, front and up from the listener, in m.
    pub position_m: [f32; 3],
    /// Amplitude at the listener, in the texture's own scale.
    pub level: f32,
}

impl Vortex {
    /// Sources that are there, `most` of them at most, spread over all.
    pub fn seen(&self, most: usize) -> impl Iterator<Item = SeenSource> {
        let step = self.present.sources.div_ceil(most.max(1)).max(1);
        let present = self.sources.iter().take(self.present.sources).step_by(step);
        present.filter(|source| source.presence > 0.0).map(|source| {
            let edge = &source.edge;
            let power = edge.gains.iter().map(|gain| gain * gain).sum::<f32>();
            let level = source.presence * power.sqrt() * edge.blend.weights.iter().sum::<f32>();
            SeenSource { position_m: edge.position.map(|x| x as f32), level }
        })
    }

    /// Number of the present hop.
    pub fn hop(&self) -> i64 {
        self.state.position.div_euclid(self.sizes.hop as i64)
    }
}
