//! What is done of a simulation, kept beside its output until it is whole.

use std::io::{BufRead, Read, Write};
use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Partial, Steps};
use pyrophone_flame::scenes::Simulation;
use pyrophone_recording::write_file;

use crate::error::Error;
use crate::progress::note;

/// Longest table that is believed, in bytes: ten million steps.
const MOST_TABLE_BYTES: u64 = 1 << 30;

/// A table of flux, and the gas as it was after the last step in it.
pub struct Kept {
    path: PathBuf,
    settings: String,
    done: usize,
}

impl Kept {
    /// Beside `output`; `settings` say what a run must have in common with one that goes on with it.
    pub fn open(output: &Path, settings: String) -> Self {
        let mut name = output.file_name().unwrap_or_default().to_os_string();
        name.push(".simulation-progress");
        Self { path: output.with_file_name(name), settings, done: 0 }
    }

    /// Brings `simulation` to where the run before was stopped, if it was one of the same settings; answers what was
    /// measured until then.
    pub fn restore(&mut self, simulation: &mut Simulation) -> Steps {
        if !self.path.is_file() {
            return Steps::new();
        }
        match self.try_restore(simulation) {
            Ok(steps) => {
                self.done = steps.len();
                steps
            }
            Err(reason) => {
                simulation.reset();
                note(&format!("{}: not gone on with ({reason})", self.path.display()));
                Steps::new()
            }
        }
    }

    fn try_restore(&self, simulation: &mut Simulation) -> Result<Steps, String> {
        let said = |error: std::io::Error| error.kind().to_string();
        let mut file = std::io::BufReader::new(std::fs::File::open(&self.path).map_err(said)?);
        let mut size = String::new();
        file.by_ref().take(32).read_line(&mut size).map_err(said)?;
        let size =
            size.trim().parse().ok().filter(|size| *size <= MOST_TABLE_BYTES).ok_or("it is not of this program")?;
        let mut table = String::new();
        file.by_ref().take(size).read_to_string(&mut table).map_err(said)?;
        let partial = Partial::read(&table, &self.path.display().to_string()).map_err(|error| error.to_string())?;
        if partial.settings != self.settings {
            return Err(format!("it belongs to {}", partial.settings));
        }
        simulation.load(file).map_err(|error| error.to_string())?;
        Ok(partial.steps)
    }

    /// Keeps what is done.
    pub fn keep(&mut self, simulation: &Simulation, steps: &Steps) -> Result<(), Error> {
        let mut table = vec![];
        let partial = Partial { settings: self.settings.clone(), steps: steps.clone() };
        write_file(&self.path, |file| {
            partial.write(&mut table)?;
            let mut file = std::io::BufWriter::new(file);
            writeln!(file, "{}", table.len())?;
            file.write_all(&table)?;
            simulation.save(&mut file)?;
            file.flush()
        })?;
        self.done = steps.len();
        Ok(())
    }

    /// The work is whole.
    pub fn remove(self) {
        let _ = std::fs::remove_file(&self.path);
    }

    /// The work ends early: says what is kept, if anything is.
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
