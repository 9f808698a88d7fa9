//! Retiming: a curve from film frames to simulation frames.

use std::path::Path;

use crate::error::Error;
use crate::flux::signal::Signal;
use crate::input::text;

/// Longest film in seconds.
const MOST_S: f64 = 3600.0;

/// A curve from film frames to simulation frames, linear between its points.
pub struct Retime {
    points: Vec<(f64, f64)>,
}

impl Retime {
    /// Reads a table of two columns, `film frame, simulation frame`, with or without a header.
    ///
    /// Fails, naming the line, if it does not hold two numbers or if film frames do not ascend; also with fewer than
    /// two rows.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let shown = path.display().to_string();
        let failed = |line: usize, reason: &str| Err(Error::Conflict(format!("{shown}: line {line}: {reason}")));
        let mut points: Vec<(f64, f64)> = vec![];
        for (index, line) in text(path)?.lines().enumerate() {
            if line.trim().is_empty() || line.starts_with('#') {
                continue;
            }
            let numbers: Vec<Option<f64>> = line.split([',', ';', '\t']).map(|cell| cell.trim().parse().ok()).collect();
            match numbers[..] {
                [Some(film), Some(frame)] if film.is_finite() && frame.is_finite() => match points.last() {
                    Some((last, _)) if *last >= film => return failed(index + 1, "film frames must ascend"),
                    _ => points.push((film, frame)),
                },
                [None, None] if points.is_empty() => {}
                _ => return failed(index + 1, "expected two numbers: film frame, simulation frame"),
            }
        }
        if points.len() < 2 {
            return Err(Error::Conflict(format!("{shown}: a curve needs at least two points")));
        }
        Ok(Self { points })
    }

    /// First frame of the film.
    pub fn first(&self) -> f64 {
        self.points.first().map_or(0.0, |(film, _)| *film)
    }

    fn frame_at(&self, film: f64) -> f64 {
        let after = self.points.partition_point(|(at, _)| *at <= film).clamp(1, self.points.len() - 1);
        let ((from, a), (to, b)) = (self.points[after - 1], self.points[after]);
        a + (b - a) * ((film - from) / (to - from)).clamp(0.0, 1.0)
    }

    /// The signal as the film shows it; its first step is at the curve's first frame.
    ///
    /// Fails if the film would be longer than an hour.
    pub fn applied(&self, signal: &Signal, film_hz: f64) -> Result<Vec<f64>, Error> {
        let (first, last) = (self.first(), self.points.last().map_or(0.0, |(film, _)| *film));
        let seconds = (last - first) / film_hz;
        crate::input::in_range("the length of --retime in seconds", seconds, 0.0, MOST_S)?;
        let per_frame = signal.numbering.steps_per_frame() * signal.substeps as f64;
        let start = signal.first_number();
        let steps = (seconds * signal.rate_hz).round() as usize + 1;
        let value = |step: usize| {
            let film = first + step as f64 / signal.rate_hz * film_hz;
            cubic(&signal.flux, (self.frame_at(film) - start) * per_frame)
        };
        Ok((0..steps).map(value).collect())
    }
}

/// Value between steps: the cubic through the four nearest (Catmull & Rom), with constant ends.
fn cubic(values: &[f64], at: f64) -> f64 {
    let last = values.len() as f64 - 1.0;
    let at = at.clamp(0.0, last.max(0.0));
    let (base, t) = (at.floor() as i64, at.fract());
    let value = |offset: i64| values[(base + offset).clamp(0, values.len() as i64 - 1) as usize];
    let [a, b, c, d] = [-1, 0, 1, 2].map(value);
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}

impl Signal {
    /// The signal as a retimed film shows it; unchanged without a retiming curve.
    pub fn retimed(self) -> Result<Self, Error> {
        let Some((path, rate)) =
            self.timeline.as_ref().and_then(|timeline| timeline.retime.as_ref().zip(timeline.film_rate))
        else {
            return Ok(self);
        };
        let retime = Retime::read(path)?;
        let flux = retime.applied(&self, rate.hz())?;
        Ok(Self { flux, area: vec![], film_frame: Some(retime.first()), ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_slows_down_and_stops() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curve.csv");
        std::fs::write(&path, "film,simulation\n1001,1\n1011,6\n1021,6\n").unwrap();
        let retime = Retime::read(&path).unwrap();
        let signal = Signal::of_series((0..100).map(f64::from).collect(), 0, 24.0);
        let film = retime.applied(&signal, 24.0).unwrap();
        assert_eq!(film.len(), 21);
        assert_eq!((film[0], film[4], film[10], film[20]), (1.0, 3.0, 6.0, 6.0), "half as fast, then still");
        for (text, says) in [
            ("1,2\n", "two points"),
            ("1,2\n1,3\n", "line 2: film frames must ascend"),
            ("a,b\n1,2\n2,x\n", "line 3"),
            ("1,2,3\n", "line 1"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error = Retime::read(&path).err().unwrap().to_string();
            assert!(error.contains(says), "{text:?}: {error}");
        }
    }
}
