//! A vortex-sound texture: the sound of a small turbulent region, over a range of flow speeds.
//!
//! A region's sound is x·T(t)x for a listener in direction x, with T symmetric and without trace, so five series
//! represent its sound in every direction. They are stored in the basis of [`directivity`].
//!
//! As bytes (little-endian): `PYROVTX1`; step rate in Hz, number of rows, and steps in a period as `u32`; per row its
//! speed, gain and scale as `f32`; then, row by row and component by component, the steps as `i16`, whose products with
//! the row's scale are the values.

use crate::error::Error;

/// Series per row.
pub const COMPONENTS: usize = 5;

/// First bytes; the number changes with the layout.
const MAGIC: &[u8; 8] = b"PYROVTX1";
/// Bytes before the rows' table.
const HEAD: usize = 20;
/// Bytes of a row in the table.
const ROW_HEAD: usize = 12;

/// Largest number of rows, and of steps in a period, in a file.
const MOST_ROWS: usize = 256;
const MOST_STEPS: usize = 1 << 20;

/// Share of each component that reaches a listener in direction `x` (a unit vector): harmonics of degree two, whose
/// mean square over the sphere is 1.
pub fn directivity([x, y, z]: [f64; 3]) -> [f64; COMPONENTS] {
    let root15 = 15f64.sqrt();
    [
        root15 * x * y,
        root15 * y * z,
        root15 * z * x,
        0.5 * root15 * (x * x - y * y),
        0.5 * 5f64.sqrt() * (3.0 * z * z - 1.0),
    ]
}

/// The sound of one flow speed over one period.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Mean flow speed in m/s.
    pub speed_m_s: f64,
    /// Root mean square over time and directions of the sound pressure at 1 m, in Pa; the series are divided by it.
    pub gain: f64,
    /// The series by component, of unit power together.
    pub components: [Vec<f32>; COMPONENTS],
}

/// Rows by rising speed, all with the same period, which repeats seamlessly.
#[derive(Debug, Clone, PartialEq)]
pub struct VortexTexture {
    sample_rate_hz: f64,
    rows: Vec<Row>,
}

impl VortexTexture {
    /// A texture of rows recorded at `sample_rate_hz` (1,000-48,000, an integer).
    ///
    /// Fails without a row, if speeds do not rise from above 0, if series differ in length or contain values that are
    /// not finite, or if a period has less than 16 steps.
    pub fn new(sample_rate_hz: f64, rows: Vec<Row>) -> Result<Self, Error> {
        let refuse = |reason: String| Err(Error::VortexTexture { reason });
        if !(1_000.0..=48_000.0).contains(&sample_rate_hz) || sample_rate_hz.fract() != 0.0 {
            return refuse(format!("its rate of {sample_rate_hz} Hz is not a whole number from 1000 to 48000"));
        }
        let steps = rows.first().map_or(0, |row| row.components[0].len());
        if !(1..=MOST_ROWS).contains(&rows.len()) || !(16..=MOST_STEPS).contains(&steps) {
            let found = rows.len();
            return refuse(format!(
                "it has {found} rows of {steps} steps; 1 to {MOST_ROWS} rows of 16 to {MOST_STEPS} steps are possible"
            ));
        }
        let mut before = 0.0;
        for Row { speed_m_s, gain, components } in &rows {
            if !(*speed_m_s > before && speed_m_s.is_finite()) {
                return refuse(format!("a speed of {speed_m_s} m/s follows one of {before} m/s; they must rise"));
            }
            before = *speed_m_s;
            if !(*gain >= 0.0 && gain.is_finite()) {
                return refuse(format!("the gain of {speed_m_s} m/s is {gain}"));
            }
            if components.iter().any(|series| series.len() != steps) {
                return refuse(format!("the series of {speed_m_s} m/s differ in length"));
            }
            if components.iter().flatten().any(|value| !value.is_finite()) {
                return refuse(format!("a series of {speed_m_s} m/s holds a value that is not finite"));
            }
        }
        Ok(Self { sample_rate_hz, rows })
    }

    /// Steps per second.
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// Steps of a period.
    pub fn period_samples(&self) -> usize {
        self.rows.first().map_or(0, |row| row.components[0].len())
    }

    /// Rows by rising speed.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The texture as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let steps = self.period_samples();
        let mut bytes = Vec::with_capacity(HEAD + self.rows.len() * (ROW_HEAD + 2 * COMPONENTS * steps));
        bytes.extend_from_slice(MAGIC);
        for number in [self.sample_rate_hz as u32, self.rows.len() as u32, steps as u32] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        let scales: Vec<f32> = self.rows.iter().map(Row::scale).collect();
        for (row, scale) in self.rows.iter().zip(&scales) {
            for number in [row.speed_m_s as f32, row.gain as f32, *scale] {
                bytes.extend_from_slice(&number.to_le_bytes());
            }
        }
        for (row, scale) in self.rows.iter().zip(&scales) {
            for value in row.components.iter().flatten() {
                bytes.extend_from_slice(&((value / scale).round() as i16).to_le_bytes());
            }
        }
        bytes
    }

    /// Reads the output of [`to_bytes`](Self::to_bytes).
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let refuse = |reason: &str| Error::VortexTexture { reason: reason.to_owned() };
        let Some(head) = bytes.get(..HEAD).filter(|head| head.starts_with(MAGIC)) else {
            return Err(refuse("this is not a vortex texture, or it has an unknown version"));
        };
        let number = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]) as usize;
        let (sample_rate_hz, rows, steps) = (number(8), number(12), number(16));
        if rows > MOST_ROWS || steps > MOST_STEPS {
            return Err(refuse("it declares more rows or steps than are allowed"));
        }
        let (table, data) = (rows * ROW_HEAD, rows * COMPONENTS * steps * 2);
        if bytes.len() != HEAD + table + data {
            let (found, expected) = (bytes.len(), HEAD + table + data);
            return Err(refuse(&format!("it has {found} bytes instead of {expected}")));
        }
        let (table, data) = bytes[HEAD..].split_at(table);
        let heads = table.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect::<Vec<f32>>();
        let values: Vec<i16> = data.as_chunks().0.iter().map(|bytes| i16::from_le_bytes(*bytes)).collect();
        let row = |index: usize| {
            let [speed, gain, scale] = [0, 1, 2].map(|field| heads[3 * index + field]);
            let series = |component: usize| {
                let start = (index * COMPONENTS + component) * steps;
                values[start..start + steps].iter().map(|value| f32::from(*value) * scale).collect()
            };
            Row { speed_m_s: f64::from(speed), gain: f64::from(gain), components: std::array::from_fn(series) }
        };
        Self::new(sample_rate_hz as f64, (0..rows).map(row).collect())
    }
}

impl Row {
    /// Value of one step of the 16-bit form.
    fn scale(&self) -> f32 {
        let largest = self.components.iter().flatten().fold(0.0f32, |largest, value| largest.max(value.abs()));
        if largest > 0.0 { largest / 32_767.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::White;

    fn texture(rows: usize, steps: usize) -> VortexTexture {
        let row = |index: usize| Row {
            speed_m_s: 1.0 + index as f64,
            gain: 0.5 * (1 << index) as f64,
            components: std::array::from_fn(|component| {
                let noise = White::new(index as u32, component as u32);
                (0..steps).map(|step| noise.sample_at(step as i64) as f32).collect()
            }),
        };
        VortexTexture::new(4000.0, (0..rows).map(row).collect()).expect("a texture")
    }

    #[test]
    fn bytes_read_back_to_16_bits() {
        let texture = texture(3, 100);
        let back = VortexTexture::from_bytes(&texture.to_bytes()).expect("readable");
        assert_eq!((back.sample_rate_hz(), back.period_samples(), back.rows().len()), (4000.0, 100, 3));
        for (a, b) in texture.rows().iter().zip(back.rows()) {
            assert_eq!((a.speed_m_s, a.gain), (b.speed_m_s, b.gain));
            let off = a.components.iter().flatten().zip(b.components.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f32::max) <= 0.51 * a.scale());
        }
        // A texture that has been written and read once no longer changes.
        assert_eq!(VortexTexture::from_bytes(&back.to_bytes()).expect("readable"), back);
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let bytes = texture(2, 50).to_bytes();
        for end in 0..bytes.len() {
            assert!(VortexTexture::from_bytes(&bytes[..end]).is_err(), "{end} bytes");
        }
        let changed = |at: usize, with: &[u8]| {
            let mut bytes = bytes.clone();
            bytes[at..at + with.len()].copy_from_slice(with);
            VortexTexture::from_bytes(&bytes)
        };
        assert!(changed(0, b"X").is_err());
        assert!(changed(8, &0u32.to_le_bytes()).is_err(), "no rate");
        assert!(changed(12, &u32::MAX.to_le_bytes()).is_err(), "rows without number");
        assert!(changed(20, &f32::NAN.to_le_bytes()).is_err(), "a speed that is none");
        assert!(changed(32, &0.5f32.to_le_bytes()).is_err(), "speeds that fall");
        assert!(changed(28, &f32::INFINITY.to_le_bytes()).is_err(), "a scale without end");
    }

    #[test]
    fn directivities_are_orthonormal_over_the_sphere() {
        let mut sums = [[0.0; COMPONENTS]; COMPONENTS];
        let (rings, spokes) = (200, 40);
        for ring in 0..rings {
            // Rings of equal area.
            let z = (2.0 * f64::from(ring) + 1.0) / f64::from(rings) - 1.0;
            for spoke in 0..spokes {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(spoke) / f64::from(spokes)).sin_cos();
                let radius = (1.0 - z * z).sqrt();
                let b = directivity([radius * cos, radius * sin, z]);
                for (sums, a) in sums.iter_mut().zip(b) {
                    sums.iter_mut().zip(b).for_each(|(sum, b)| *sum += a * b / f64::from(rings * spokes));
                }
            }
        }
        for (i, row) in sums.iter().enumerate() {
            for (j, sum) in row.iter().enumerate() {
                let expected = f64::from(u8::from(i == j));
                assert!((sum - expected).abs() < 1e-3, "{i} {j}: {sum}");
            }
        }
    }
}
