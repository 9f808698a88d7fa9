//! Checkpoints of a simulation, stored beside its output until it is complete.

use std::io::{BufRead, Read, Write};
use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{FluxShard, Steps};
use pyrophone_flame::scenes::Simulation;
use pyrophone_recording::write_file;

use crate::error::Error;
use crate::progress::note;

/// Longest table accepted, in bytes: ten million steps.
const MOST_TABLE_BYTES: u64 = 1 << 30;

/// Speeds of sub-volumes, step by step.
pub type Flow = Vec<Vec<f32>>;

/// A table of flux, speeds, and the state of the gas after the table's last step.
pub struct SimulationCheckpoint {
    path: PathBuf,
    settings: String,
    /// Speeds per step.
    columns: usize,
    done: usize,
}

impl SimulationCheckpoint {
    /// Opens the checkpoint beside `output`. `settings` are those that a resumed run must share with the interrupted
    /// one; `columns` is the number of speeds per step.
    pub fn open(output: &Path, settings: String, columns: usize) -> Self {
        let mut name = output.file_name().unwrap_or_default().to_os_string();
        name.push(".simulation-progress");
        Self { path: output.with_file_name(name), settings, columns, done: 0 }
    }

    /// Brings `simulation` to the point where the previous run stopped, if its settings were the same; returns the
    /// measurements up to that point.
    pub fn restore(&mut self, simulation: &mut Simulation) -> (Steps, Flow) {
        if !self.path.is_file() {
            return Default::default();
        }
        match self.try_restore(simulation) {
            Ok((steps, flow)) => {
                self.done = steps.len();
                (steps, flow)
            }
            Err(reason) => {
                simulation.reset();
                note(&format!("{}: cannot be resumed ({reason}); starting again", self.path.display()));
                Default::default()
            }
        }
    }

    fn try_restore(&self, simulation: &mut Simulation) -> Result<(Steps, Flow), String> {
        let message = |error: std::io::Error| error.kind().to_string();
        let mut file = std::io::BufReader::new(std::fs::File::open(&self.path).map_err(message)?);
        let mut line = String::new();
        file.by_ref().take(64).read_line(&mut line).map_err(message)?;
        let mut numbers = line.split_whitespace().map(|number| number.parse::<u64>().ok());
        let mut number = |most: u64| {
            numbers.next().flatten().filter(|number| *number <= most).ok_or("it was not written by this program")
        };
        let size = number(MOST_TABLE_BYTES)?;
        let (rows, columns) = (number(MOST_TABLE_BYTES)?, number(1 << 16)?);
        let mut table = String::new();
        file.by_ref().take(size).read_to_string(&mut table).map_err(message)?;
        let partial = FluxShard::read(&table, &self.path.display().to_string()).map_err(|error| error.to_string())?;
        if partial.settings != self.settings {
            return Err(format!("it belongs to a run with other settings: {}", partial.settings));
        }
        let mut speeds = vec![];
        let bytes = (4 * rows).checked_mul(columns).filter(|bytes| *bytes <= MOST_TABLE_BYTES);
        let bytes = bytes.ok_or("it was not written by this program")?;
        file.by_ref().take(bytes).read_to_end(&mut speeds).map_err(message)?;
        if speeds.len() as u64 != bytes {
            return Err("it ends early".to_owned());
        }
        let speeds: Vec<f32> = speeds.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        if rows > 0 && columns as usize != self.columns || !speeds.iter().all(|speed| (0.0..f32::MAX).contains(speed)) {
            return Err("its speeds are from another build, or damaged".to_owned());
        }
        simulation.load(file).map_err(|error| error.to_string())?;
        Ok((partial.steps, speeds.chunks_exact((columns as usize).max(1)).map(<[f32]>::to_vec).collect()))
    }

    /// Stores the work done so far.
    pub fn keep(&mut self, simulation: &Simulation, steps: &Steps, flow: &Flow) -> Result<(), Error> {
        let mut table = vec![];
        let partial = FluxShard { settings: self.settings.clone(), steps: steps.clone(), ..FluxShard::default() };
        write_file(&self.path, |file| {
            partial.write(&mut table)?;
            let mut file = std::io::BufWriter::new(file);
            writeln!(file, "{} {} {}", table.len(), flow.len(), flow.first().map_or(0, Vec::len))?;
            file.write_all(&table)?;
            for speed in flow.iter().flatten() {
                file.write_all(&speed.to_le_bytes())?;
            }
            simulation.save(&mut file)?;
            file.flush()
        })?;
        self.done = steps.len();
        Ok(())
    }

    /// Removes the checkpoint after complete work.
    pub fn remove(self) {
        let _ = std::fs::remove_file(&self.path);
    }

    /// Wraps the error of interrupted work, with the location of the checkpoint if there is one.
    pub fn unfinished(self, reason: Error) -> Error {
        if !self.path.is_file() {
            return reason;
        }
        Error::Unfinished {
            reason: Box::new(reason),
            done: self.done,
            what: "frames",
            path: self.path.display().to_string(),
        }
    }
}
