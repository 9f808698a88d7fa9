//! Flames around a listener, as first-order ambisonics.
//!
//! AmbiX: channels W, Y, Z, X with SN3D weights, in which W is the sound pressure and the others are W times
//! the direction's cosines towards left, up and front. Nachbar, Zotter, Deleflie, Sontacchi (2011), "AmbiX – A Suggested
//! Ambisonics Format".

use crate::args::UpAxis;

/// Distance in m at which a flame has the level of its own drive.
const UNIT_M: f64 = 1.0;
/// Distance in m below which a flame becomes no louder: it has an extent, and a listener is not in it.
const NEAREST_M: f64 = 0.5;

/// A position at a time, in seconds from the first sample and metres along the files' axes.
pub type Place = (f64, [f64; 3]);

/// A listener, and the sound that arrives there.
#[derive(Debug)]
pub struct Listener {
    position_m: [f64; 3],
    /// Unit vectors to the left, up and to the front.
    axes: [[f64; 3]; 3],
    /// W, Y, Z, X.
    channels: [Vec<f32>; 4],
    sample_rate_hz: f64,
}

impl Listener {
    /// A listener at `position_m` who faces `facing_m`, upright: the front is level.
    pub fn new(position_m: [f64; 3], facing_m: [f64; 3], up: UpAxis, samples: usize, sample_rate_hz: u32) -> Self {
        // Straight above or below, any front will do: that of the files.
        let (up, any_front) = match up {
            UpAxis::Y => ([0.0, 1.0, 0.0], [0.0, 0.0, -1.0]),
            UpAxis::Z => ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        };
        let towards = minus(facing_m, position_m);
        let height = dot(towards, up);
        let level = std::array::from_fn(|axis| towards[axis] - height * up[axis]);
        let front = unit(level).unwrap_or(any_front);
        let left = cross(up, front);
        Self {
            position_m,
            axes: [left, up, front],
            channels: std::array::from_fn(|_| vec![0.0; samples]),
            sample_rate_hz: f64::from(sample_rate_hz),
        }
    }

    /// Adds a flame's drive, which moves from place to place in a straight line, and rests before the first and after the
    /// last. It is not delayed by its distance, so that it stays in sync with the picture.
    pub fn add(&mut self, drive: &[f32], places: &[Place]) {
        let Some(first) = places.first() else { return };
        let mut after = 0;
        for (n, sample) in drive.iter().enumerate() {
            let time_s = n as f64 / self.sample_rate_hz;
            while places.get(after).is_some_and(|(at_s, _)| *at_s <= time_s) {
                after += 1;
            }
            let (from, to) = (places[after.saturating_sub(1)], places.get(after).copied());
            let position = match to.filter(|_| after > 0) {
                Some(to) => between(from, to, time_s),
                None if after == 0 => first.1,
                None => from.1,
            };
            self.add_sample(n, f64::from(*sample), position);
        }
    }

    fn add_sample(&mut self, n: usize, sample: f64, place_m: [f64; 3]) {
        let away = minus(place_m, self.position_m);
        let distance_m = dot(away, away).sqrt();
        let pressure = sample * UNIT_M / distance_m.max(NEAREST_M);
        let direction = unit(away).unwrap_or([0.0; 3]);
        let cosines = self.axes.map(|axis| dot(axis, direction));
        let weights = [1.0, cosines[0], cosines[1], cosines[2]];
        for (channel, weight) in self.channels.iter_mut().zip(weights) {
            if let Some(to) = channel.get_mut(n) {
                *to += (weight * pressure) as f32;
            }
        }
    }

    /// W, Y, Z, X.
    pub fn into_channels(self) -> Vec<Vec<f32>> {
        self.channels.into()
    }
}

fn between(from: Place, to: Place, time_s: f64) -> [f64; 3] {
    let share = (time_s - from.0) / (to.0 - from.0);
    std::array::from_fn(|axis| from.1[axis] + share * (to.1[axis] - from.1[axis]))
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        a[next] * b[last] - a[last] * b[next]
    })
}

/// The direction of a vector, unless it is too short to have one.
fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(vector, vector).sqrt();
    (length > 1e-9).then(|| vector.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// W, Y, Z, X of a drive of 1 at `position`, for a listener at the origin who faces along x.
    fn encoded(position: [f64; 3], up: UpAxis) -> [f64; 4] {
        let mut listener = Listener::new([0.0; 3], [5.0, 0.0, 0.0], up, 1, 48_000);
        listener.add(&[1.0], &[(0.0, position)]);
        let channels = listener.into_channels();
        std::array::from_fn(|channel| (f64::from(channels[channel][0]) * 1e6).round() / 1e6)
    }

    #[test]
    fn channels_are_pressure_left_up_and_front() {
        for (position, expected) in [
            ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0]),
            ([0.0, 1.0, 0.0], [1.0, 1.0, 0.0, 0.0]),
            ([0.0, 0.0, 1.0], [1.0, 0.0, 1.0, 0.0]),
            ([-4.0, 0.0, 0.0], [0.25, 0.0, 0.0, -0.25]),
            ([0.0, -2.0, 0.0], [0.5, -0.5, 0.0, 0.0]),
            ([0.0, 0.0, 0.01], [2.0, 0.0, 2.0, 0.0]),
            ([0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]),
        ] {
            assert_eq!(encoded(position, UpAxis::Z), expected, "{position:?}");
        }
        // With y up and x in front, left is towards -z.
        assert_eq!(encoded([0.0, 0.0, -1.0], UpAxis::Y), [1.0, 1.0, 0.0, 0.0]);
        assert_eq!(encoded([0.0, 1.0, 0.0], UpAxis::Y), [1.0, 0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_flame_moves_in_straight_lines_and_rests_at_its_ends() {
        let mut listener = Listener::new([0.0; 3], [1.0, 0.0, 0.0], UpAxis::Z, 40, 8000);
        let (begin_s, end_s) = (10.0 / 8000.0, 30.0 / 8000.0);
        listener.add(&[1.0; 40], &[(begin_s, [2.0, 0.0, 0.0]), (end_s, [0.0, 2.0, 0.0])]);
        let [pressure, left, _, front] = &listener.channels;
        assert_eq!((pressure[0], front[9], left[10]), (0.5, 0.5, 0.0));
        // Half-way it is nearer, and half left.
        let nearest = 1.0 / 2f32.sqrt();
        assert!((pressure[20] - nearest).abs() < 1e-6 && (left[20] - 0.5).abs() < 1e-6, "{}", pressure[20]);
        assert_eq!((pressure[39], left[39]), (0.5, 0.5));
    }

    #[test]
    fn facing_straight_up_is_no_obstacle() {
        let mut listener = Listener::new([0.0; 3], [0.0, 0.0, 3.0], UpAxis::Z, 1, 8000);
        listener.add(&[1.0], &[(0.0, [0.0, 0.0, 3.0])]);
        assert!(listener.into_channels().iter().flatten().all(|x| x.is_finite()));
    }
}
