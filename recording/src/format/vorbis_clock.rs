//! The clock of a Vorbis stream: the decoded samples that are sound.

/// Positions in samples, as stated by pages, each with the number of packets before it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Clock(Vec<(usize, i64)>);

impl Clock {
    /// Records the position after the first `packets`.
    pub fn set(&mut self, packets: usize, position: i64) {
        if self.0.last().is_none_or(|(last, _)| *last < packets) {
            self.0.push((packets, position));
        }
    }

    /// The same clock without the first packets.
    pub fn behind(self, headers: usize) -> Self {
        Self(
            self.0
                .into_iter()
                .filter(|(packets, _)| *packets > headers)
                .map(|(packets, at)| (packets - headers, at))
                .collect(),
        )
    }

    /// Number of samples to leave out at the start and at the end, given the number decoded from each packet.
    ///
    /// If a first page has fewer samples on its clock than in its packets, the sound starts within them; likewise for
    /// the last page's end. More than a page is never left out: then the clock is wrong.
    pub fn ends(&self, samples: &[u64]) -> (u64, u64) {
        let sum = |packets: usize| samples.iter().take(packets).sum::<u64>();
        let (Some((first_packets, first)), Some((packets, last))) = (self.0.first(), self.0.last()) else {
            return (0, 0);
        };
        let is_single = self.0.len() < 2;
        let offset = if is_single { 0 } else { first - sum(*first_packets) as i64 };
        let before_last = self.0.iter().rev().nth(1).map_or(0, |(packets, _)| sum(*packets));
        let total = sum(*packets);
        let excess = u64::try_from(total as i64 - (last.saturating_sub(offset))).unwrap_or(0);
        let skip_start = u64::try_from(-offset).unwrap_or(0);
        let page = total - before_last;
        (skip_start.min(sum(*first_packets)), if excess <= page { excess } else { 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_cuts_both_ends() {
        let samples = [0, 1024, 1024, 1024, 1024];
        let clock = |stamps: &[(usize, i64)]| Clock(stamps.to_vec());
        assert_eq!(clock(&[(3, 2048), (5, 4000)]).ends(&samples), (0, 96));
        assert_eq!(clock(&[(3, 2000), (5, 4000)]).ends(&samples), (48, 48));
        assert_eq!(clock(&[(3, 1_002_048), (5, 1_004_096)]).ends(&samples), (0, 0), "cut from a longer one");
        assert_eq!(clock(&[(5, 4000)]).ends(&samples), (0, 96), "one page");
        assert_eq!(clock(&[(3, 2048), (5, 1)]).ends(&samples), (0, 0), "a wrong clock");
        assert_eq!(clock(&[]).ends(&samples), (0, 0));
    }
}
