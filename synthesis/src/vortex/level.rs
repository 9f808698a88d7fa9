//! Rows and level of a flow speed.

use std::f32::consts::FRAC_PI_2;

use super::texture::Row;

/// Exponent of the level below a table of one row: the least that theory and measurements give.
const LONE_EXPONENT: f32 = 4.0;

/// Bounds of the exponent that is extrapolated below the lowest row. The lower bound makes sound fade out below it
/// without a corner, whatever the range control.
const LEAST_EXPONENT: f32 = 2.0;
const MOST_EXPONENT: f32 = 12.0;

/// A gain of 0 has no logarithm.
const LEAST_GAIN: f64 = 1e-12;

/// Amplitudes below this are silence, and no denormals.
const SILENCE: f32 = 1e-20;

/// Speeds and gains of a table's rows, as natural logarithms.
#[derive(Debug)]
pub(super) struct Levels {
    ln_speeds: Vec<f32>,
    ln_gains: Vec<f32>,
    /// The level's exponent below the lowest row.
    foot: f32,
}

/// Two neighbouring rows and their amplitudes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Blend {
    /// The lower of the two.
    pub row: usize,
    /// Amplitudes of the lower and of the upper row.
    pub weights: [f32; 2],
}

impl Levels {
    /// Levels for `rows` by rising speed, at least one.
    pub fn new(rows: &[Row]) -> Self {
        let ln_speeds: Vec<f32> = rows.iter().map(|row| maths::ln(row.speed_m_s) as f32).collect();
        let ln_gains: Vec<f32> = rows.iter().map(|row| maths::ln(row.gain.max(LEAST_GAIN)) as f32).collect();
        let foot = match (ln_speeds.as_slice(), ln_gains.as_slice()) {
            ([low, high, ..], [quiet, loud, ..]) => (loud - quiet) / (high - low).max(1e-6),
            _ => LONE_EXPONENT,
        };
        Self { ln_speeds, ln_gains, foot: foot.clamp(LEAST_EXPONENT, MOST_EXPONENT) }
    }

    /// Lowest and highest speed in m/s.
    pub fn speeds_m_s(&self) -> [f64; 2] {
        let speed = |ln: Option<&f32>| ln.map_or(0.0, |ln| maths::exp(f64::from(*ln)));
        [speed(self.ln_speeds.first()), speed(self.ln_speeds.last())]
    }

    /// The lower row of the two around a speed, the fraction of the way to the upper one (0-1), and the logarithm of the
    /// table's gain. The row is probably `near`; the gain is a power law between rows and constant beyond them.
    fn locate(&self, near: usize, ln_speed: f32) -> (usize, f32, f32) {
        let is_near =
            |row: usize, ln: f32| ln <= ln_speed && self.ln_speeds.get(row + 1).is_none_or(|ln| ln_speed < *ln);
        let row = match self.ln_speeds.get(near) {
            Some(ln) if is_near(near, *ln) => near,
            _ => self.ln_speeds.partition_point(|ln| *ln <= ln_speed).saturating_sub(1),
        };
        let Some(above) = self.ln_speeds.get(row + 1) else {
            return (row, 0.0, self.ln_gains[row]);
        };
        let part = ((ln_speed - self.ln_speeds[row]) / (above - self.ln_speeds[row])).clamp(0.0, 1.0);
        (row, part, self.ln_gains[row] + part * (self.ln_gains[row + 1] - self.ln_gains[row]))
    }

    /// Logarithm of the gain at a speed within the table.
    pub fn ln_gain(&self, ln_speed: f32) -> f32 {
        self.locate(0, ln_speed).2
    }

    /// The rows for a speed in m/s by its logarithm, which is minus infinity for 0. Gains are compressed to `range`
    /// times as many decibels around `ln_reference`, the logarithm of a gain. The lower row is probably `near`.
    ///
    /// Rows differ in detail and add by power, so the squares of the two amplitudes add up to that of the gain.
    pub fn blend_at(&self, near: usize, ln_speed: f32, range: f32, ln_reference: f32) -> Blend {
        let (row, part, ln_gain) = self.locate(near, ln_speed);
        let mut ln_level = ln_reference + range * (ln_gain - ln_reference);
        let below = self.ln_speeds[0] - ln_speed;
        if below > 0.0 {
            ln_level -= (range * self.foot).max(LEAST_EXPONENT) * below;
        }
        let level = maths::exp(ln_level);
        if level.is_nan() || level < SILENCE {
            return Blend { row, weights: [0.0; 2] };
        }
        let (sin, cos) = if part == 0.0 { (0.0, 1.0) } else { maths::sin_cos(FRAC_PI_2 * part) };
        Blend { row, weights: [level * cos, level * sin] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels(gains: &[(f64, f64)]) -> Levels {
        let row = |&(speed_m_s, gain): &(f64, f64)| Row { speed_m_s, gain, components: Default::default() };
        Levels::new(&gains.iter().map(row).collect::<Vec<Row>>())
    }

    fn level(levels: &Levels, speed: f32, range: f32) -> f32 {
        let [a, b] = levels.blend_at(2, speed.ln(), range, levels.ln_gain(4f32.ln())).weights;
        a.hypot(b)
    }

    #[test]
    fn gains_are_a_power_law_between_rows_and_below_them_and_hold_above() {
        let levels = levels(&[(1.0, 1e-3), (4.0, 0.256), (8.0, 8.0)]);
        for (speed, expected) in
            [(1.0, 1e-3), (2.0, 0.016), (4.0, 0.256), (8.0, 8.0), (99.0, 8.0), (0.5, 1e-3 / 16.0), (0.0, 0.0)]
        {
            let found = level(&levels, speed, 1.0);
            assert!((found - expected).abs() <= 1e-4 * expected, "{speed} m/s: {found} instead of {expected}");
        }
        assert_eq!(levels.blend_at(1, f32::NEG_INFINITY, 1.0, 0.0).weights, [0.0; 2]);
        assert_eq!(levels.blend_at(0, 8f32.ln(), 1.0, 0.0).row, 2);
    }

    #[test]
    fn the_range_is_compressed_about_its_reference_and_still_ends_in_silence() {
        let levels = levels(&[(1.0, 1e-3), (4.0, 0.256), (8.0, 8.0)]);
        let db = |speed: f32, range: f32| 20.0 * (level(&levels, speed, range) / 0.256).log10();
        assert!((db(1.0, 0.5) - 0.5 * db(1.0, 1.0)).abs() < 1e-3);
        assert!((db(8.0, 0.5) - 0.5 * db(8.0, 1.0)).abs() < 1e-3);
        assert!(db(1.0, 0.0).abs() < 1e-3 && db(8.0, 0.0).abs() < 1e-3);
        assert!(level(&levels, 0.01, 0.0) < 1e-3 && level(&levels, 0.0, 0.0) == 0.0);
    }

    #[test]
    fn a_silent_row_and_a_lone_row_have_levels() {
        assert!(level(&levels(&[(1.0, 0.0), (2.0, 1.0)]), 1.0, 1.0) < 1e-6);
        assert!((level(&levels(&[(2.0, 3.0)]), 1.0, 1.0) - 3.0 / 16.0).abs() < 1e-4);
    }
}
