//! Recorded rows, stored beside their texture until it is complete.
//!
//! Format: a line of settings; then for each row its speed and gain as `f64`, the steps of its period as `u32`, and its
//! steps, component by component, as `f32`, all little-endian. Rows are stored exactly as recorded, so a texture does
//! not depend on how often it was interrupted.

use std::io::{BufRead, Write};
use std::path::{Path, PathBuf};

use pyrophone_recording::write_file;
use pyrophone_synthesis::vortex::texture::{COMPONENTS, Row};

use crate::error::Error;
use crate::progress::note;

/// Largest file accepted, in bytes.
const MOST_BYTES: u64 = 1 << 30;

/// Bytes of a row before its steps.
const ROW_HEAD: usize = 20;

/// The rows, in the order in which they were finished.
pub struct TextureCheckpoint {
    path: PathBuf,
    settings: String,
    rows: Vec<Row>,
}

impl TextureCheckpoint {
    /// Opens the checkpoint beside `output`. `settings` are those that a resumed run must share with the interrupted
    /// one.
    pub fn open(output: &Path, settings: String) -> Self {
        let mut name = output.file_name().unwrap_or_default().to_os_string();
        name.push(".vortex-progress");
        Self { path: output.with_file_name(name), settings, rows: vec![] }
    }

    /// Reads what the previous run left, if its settings were the same.
    pub fn restore(&mut self) {
        if !self.path.is_file() {
            return;
        }
        match self.try_restore() {
            Ok(rows) => self.rows = rows,
            Err(reason) => note(&format!("{}: cannot be resumed ({reason}); starting again", self.path.display())),
        }
    }

    fn try_restore(&self) -> Result<Vec<Row>, String> {
        let message = |error: std::io::Error| error.kind().to_string();
        if std::fs::metadata(&self.path).map_err(message)?.len() > MOST_BYTES {
            return Err("it was not written by this program".into());
        }
        let bytes = std::fs::read(&self.path).map_err(message)?;
        let mut rest = bytes.as_slice();
        let mut settings = vec![];
        rest.read_until(b'\n', &mut settings).map_err(message)?;
        let settings = String::from_utf8(settings).map_err(|_| "it was not written by this program")?;
        if settings.trim_end() != self.settings {
            let other = settings.trim_end().chars().take(200).collect::<String>().replace('\r', " ");
            return Err(format!("it belongs to a run with other settings: {other}"));
        }
        let mut rows = vec![];
        while !rest.is_empty() {
            rows.push(read_row(&mut rest).ok_or("it is damaged")?);
        }
        Ok(rows)
    }

    /// The row of a speed, if it is finished.
    pub fn row(&self, speed_m_s: f64) -> Option<Row> {
        self.rows.iter().find(|row| row.speed_m_s == speed_m_s).cloned()
    }

    /// Stores a row.
    pub fn keep(&mut self, row: Row) -> Result<(), Error> {
        self.rows.push(row);
        let mut bytes = vec![];
        self.rows.iter().for_each(|row| write_row(row, &mut bytes));
        write_file(&self.path, |file| {
            writeln!(file, "{}", self.settings)?;
            file.write_all(&bytes)
        })?;
        Ok(())
    }

    /// Removes the checkpoint after complete work.
    pub fn remove(self) {
        let _ = std::fs::remove_file(&self.path);
    }

    /// Wraps the error of interrupted work, with the location of the checkpoint if there is one.
    pub fn unfinished(self, reason: Error) -> Error {
        if self.rows.is_empty() {
            return reason;
        }
        let path = self.path.display().to_string();
        Error::Unfinished { reason: Box::new(reason), done: self.rows.len(), what: "rows", path }
    }
}

fn write_row(row: &Row, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&row.speed_m_s.to_le_bytes());
    bytes.extend_from_slice(&row.gain.to_le_bytes());
    bytes.extend_from_slice(&(row.components[0].len() as u32).to_le_bytes());
    row.components.iter().flatten().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
}

fn read_row(rest: &mut &[u8]) -> Option<Row> {
    let (head, after) = rest.split_at_checked(ROW_HEAD)?;
    let speed_m_s = f64::from_le_bytes(head[..8].try_into().ok()?);
    let gain = f64::from_le_bytes(head[8..16].try_into().ok()?);
    let steps = u32::from_le_bytes(head[16..].try_into().ok()?) as usize;
    let (data, after) = after.split_at_checked(steps.checked_mul(4 * COMPONENTS)?)?;
    *rest = after;
    let values: Vec<f32> = data.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let series = |component: usize| values[component * steps..(component + 1) * steps].to_vec();
    Some(Row { speed_m_s, gain, components: std::array::from_fn(series) })
}
