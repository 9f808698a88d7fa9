//! The host's position, made consistent.

use nice_plug::prelude::PluginApi;
use pyrophone_synthesis::chain;

/// Report of the host at one call.
#[derive(Debug, Clone, Copy)]
pub struct Reported {
    /// The plugin format.
    pub api: PluginApi,
    /// True while the host plays.
    pub playing: bool,
    /// Position in samples.
    pub position: Option<i64>,
    /// True if the host reports a tempo.
    pub has_tempo: bool,
}

/// Tracker of the host's position over calls.
///
/// Under CLAP a block is cut at automation points, and the framework advances the position of the later pieces only
/// where the host reports a tempo; without one, every piece reports the position of the whole block. A repeated
/// position is therefore treated as continuing.
#[derive(Debug, Clone, Copy, Default)]
pub struct HostClock {
    last: Option<i64>,
    next: i64,
}

impl HostClock {
    /// Forgets the past.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// The transport of a call of `samples` samples.
    pub fn transport(&mut self, reported: Reported, samples: usize) -> chain::Transport {
        let Reported { api, playing, position, has_tempo } = reported;
        let repeats = api == PluginApi::Clap && !has_tempo && playing && position.is_some() && position == self.last;
        let actual = if repeats { Some(self.next) } else { position };
        self.last = position.filter(|_| playing);
        self.next = actual.unwrap_or(0).wrapping_add(samples as i64);
        chain::Transport { playing, position: actual }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(api: PluginApi, playing: bool, position: i64, has_tempo: bool) -> Reported {
        Reported { api, playing, position: Some(position), has_tempo }
    }

    #[test]
    fn pieces_of_a_clap_block_without_tempo_go_on() {
        let mut clock = HostClock::default();
        let clap = |position| at(PluginApi::Clap, true, position, false);
        let positions: Vec<_> = [(-100, 30), (-100, 1), (-100, 33), (-36, 64), (5000, 64)]
            .into_iter()
            .map(|(position, samples)| clock.transport(clap(position), samples).position.unwrap())
            .collect();
        assert_eq!(positions, [-100, -70, -69, -36, 5000]);
    }

    #[test]
    fn reported_position_is_kept_if_the_host_states_one() {
        for reported in [
            at(PluginApi::Vst3, true, 7, false),
            at(PluginApi::Clap, true, 7, true),
            at(PluginApi::Clap, false, 7, false),
        ] {
            let mut clock = HostClock::default();
            for _ in 0..3 {
                assert_eq!(clock.transport(reported, 64).position, Some(7), "{reported:?}");
            }
        }
        let silent = Reported { position: None, ..at(PluginApi::Clap, false, 0, false) };
        assert_eq!(HostClock::default().transport(silent, 64).position, None);
    }
}
