//! A speed field as bytes, from a simulation to the plug-in.
//!
//! Little-endian: `PYROFLD1`; steps per second and time of the first step in seconds on the timeline as `f64`; a flag
//! for repetition (1 or 0), number of sources, and number of steps as `u32`; the fastest speed in m/s as `f32`; per
//! source its position in m (right, front, up) as `f32`; then, step by step and source by source, one byte b for a
//! speed of (b / 255)^2 times the fastest: resolution is finest where gas is slow, as for levels.

use super::field::{End, SpeedField};
use crate::error::Error;

/// First bytes; the number changes with the layout.
const MAGIC: &[u8; 8] = b"PYROFLD1";
/// Number of bytes before the positions.
const HEAD: usize = 8 + 8 + 8 + 4 * 4;
/// Number of bytes in a position.
const PLACE: usize = 12;

/// Farthest start from the timeline's, in seconds: thirty years.
const FARTHEST_S: f64 = 1e9;

/// Most sources and steps of a file.
const MOST_SOURCES: usize = 4096;
const MOST_STEPS: usize = 1 << 20;

impl SpeedField {
    /// The field as bytes. Speeds are rounded to 1/255 of the square root of the fastest; of changing positions, only
    /// those of the first step are kept.
    pub fn to_bytes(&self) -> Vec<u8> {
        let fastest = self.speeds().iter().fold(0.0f32, |fastest, speed| fastest.max(*speed));
        let mut bytes = Vec::with_capacity(HEAD + PLACE * self.sources() + self.speeds().len());
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&self.rate_hz().to_le_bytes());
        bytes.extend_from_slice(&self.start_s().to_le_bytes());
        let repeats = u32::from(self.end() == End::Periodic);
        for number in [repeats, self.sources() as u32, self.steps() as u32] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.extend_from_slice(&fastest.to_le_bytes());
        for place in self.positions().iter().take(self.sources()).flatten() {
            bytes.extend_from_slice(&place.to_le_bytes());
        }
        let byte = |speed: &f32| if fastest > 0.0 { (255.0 * (speed / fastest).sqrt()).round() as u8 } else { 0 };
        bytes.extend(self.speeds().iter().map(byte));
        bytes
    }

    /// Reads the output of [`to_bytes`](Self::to_bytes).
    ///
    /// Fails if the bytes are something else, are too few or too many, or contain values that [`new`](Self::new)
    /// rejects, and if there are more than 4,096 sources or 1,048,576 steps.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let refuse = |reason: String| Error::SpeedField { reason };
        let head = bytes.first_chunk::<HEAD>().filter(|head| head.starts_with(MAGIC));
        let Some((head, rest)) = head.map(|head| (head, &bytes[HEAD..])) else {
            return Err(refuse("this is not a speed field, or it has an unknown version".to_owned()));
        };
        let double = |at: usize| f64::from_le_bytes(std::array::from_fn(|byte| head[at + byte]));
        let word = |at: usize| std::array::from_fn(|byte| head[at + byte]);
        let (rate_hz, start_s) = (double(8), double(16));
        let [repeats, sources, steps] = [24, 28, 32].map(|at| u32::from_le_bytes(word(at)) as usize);
        let fastest = f32::from_le_bytes(word(36));
        if sources > MOST_SOURCES || steps > MOST_STEPS {
            let most = format!("{MOST_SOURCES} sources and {MOST_STEPS} steps");
            return Err(refuse(format!("it declares {sources} sources and {steps} steps; at most {most} are allowed")));
        }
        // Within 32 bits too: 4096 times a million.
        let expected = sources as u64 * (PLACE + steps) as u64;
        if rest.len() as u64 != expected {
            return Err(refuse(format!("it has {} bytes instead of {}", bytes.len(), HEAD as u64 + expected)));
        }
        if !(-FARTHEST_S..=FARTHEST_S).contains(&start_s) || repeats > 1 {
            return Err(refuse(format!("it starts at {start_s} s, and repeats {repeats} times")));
        }
        let (places, speeds) = rest.split_at(sources * PLACE);
        let coordinates: Vec<f32> = places.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        let speed = |byte: &u8| fastest * maths::square(f32::from(*byte) / 255.0);
        let end = if repeats == 1 { End::Periodic } else { End::Clamped };
        let field =
            Self::new(rate_hz, sources, coordinates.as_chunks().0.to_vec(), speeds.iter().map(speed).collect(), end)?;
        Ok(field.starting_at(start_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> SpeedField {
        let speeds = (0..60).map(|step| (step as f32 * 0.37).sin().abs() * 9.0).collect();
        let places = vec![[0.5, -1.0, 2.0], [0.0, 0.25, 3.0], [-4.0, 0.0, 0.0]];
        SpeedField::new(30.0, 3, places, speeds, End::Clamped).unwrap().starting_at(-1.5)
    }

    #[test]
    fn bytes_read_back() {
        let field = field();
        let back = SpeedField::from_bytes(&field.to_bytes()).unwrap();
        assert_eq!((back.rate_hz(), back.start_s(), back.end()), (30.0, -1.5, End::Clamped));
        assert_eq!((back.sources(), back.steps(), back.positions()), (3, 20, field.positions()));
        for (a, b) in field.speeds().iter().zip(back.speeds()) {
            assert!((a - b).abs() <= 9.0 / 255.0, "{a} {b}");
        }
        assert_eq!(SpeedField::from_bytes(&back.to_bytes()).unwrap(), back, "once rounded it stays");
    }

    #[test]
    fn damage_is_refused_and_never_trusted() {
        let bytes = field().to_bytes();
        for end in 0..bytes.len() {
            assert!(SpeedField::from_bytes(&bytes[..end]).is_err(), "cut to {end}");
        }
        assert!(SpeedField::from_bytes(&[bytes.clone(), vec![0]].concat()).is_err());
        for at in 0..HEAD + 3 * PLACE {
            for value in [0, 0x7f, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] = value;
                // Any accepted file gives speeds and places at any time.
                let Ok(field) = SpeedField::from_bytes(&damaged) else { continue };
                for time_s in [-1e9, 0.0, 0.21, 1e9] {
                    let state = field.state_at(0, field.moment(time_s));
                    let all = state.position.into_iter().chain([state.speed_m_s, state.presence]);
                    assert!(all.into_iter().all(f64::is_finite), "byte {at} is {value}: {state:?}");
                }
            }
        }
    }
}
