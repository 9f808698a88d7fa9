//! Checkpoint of an interrupted run: a partial table beside the output.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Changes, FluxShard, Row, Steps};

use crate::error::Error;

/// Suffix that turns the output's name into the checkpoint's.
const SUFFIX: &str = ".flux-progress";

/// Finished frames, in a file that is removed once the work is complete.
pub struct FluxCheckpoint {
    path: PathBuf,
    settings: String,
    /// Frames finished by the previous run; in the end, all frames.
    pub steps: Steps,
    /// Changes from each step to the next, if upsampling needs them.
    pub changes: Changes,
    /// Open once there is something to store.
    file: Option<File>,
    done: usize,
}

impl FluxCheckpoint {
    /// Finds what a previous run with the same settings, over the same files, left beside `output`.
    pub fn open(output: &Path, settings: String) -> Self {
        let mut name = output.file_name().unwrap_or_default().to_os_string();
        name.push(SUFFIX);
        let path = output.with_file_name(name);
        // A file that is unreadable or has other settings is ignored: it will be written again.
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        // The last line may have been cut off while it was written.
        let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
        let found = FluxShard::read_unfinished(whole, "").ok().filter(|part| part.settings == settings);
        let FluxShard { steps, changes, .. } = found.unwrap_or_default();
        let done = steps.values().flatten().count();
        Self { path, settings, steps, changes, file: None, done }
    }

    /// Adds frames and the changes between them.
    pub fn add<'a>(&mut self, rows: impl Iterator<Item = (&'a Row, Option<&'a [f64]>)>) -> Result<(), Error> {
        let (mut text, mut count) = (vec![], 0);
        let failure = |error: std::io::Error| {
            let reason = error.kind().to_string();
            Error::Recording(pyrophone_recording::Error::NotWritten { path: self.path.display().to_string(), reason })
        };
        for (row, change) in rows {
            FluxShard::write_step(row.frame, Some(row), &mut text).map_err(failure)?;
            change.map_or(Ok(()), |change| FluxShard::write_change(row.frame, change, &mut text)).map_err(failure)?;
            count += 1;
        }
        if text.is_empty() {
            return Ok(());
        }
        let file = match &mut self.file {
            Some(file) => file,
            none => {
                let mut head = vec![];
                let part = FluxShard { settings: self.settings.clone(), ..FluxShard::default() };
                part.write_head(&mut head).map_err(failure)?;
                for (frame, row) in &self.steps {
                    FluxShard::write_step(*frame, row.as_ref(), &mut head).map_err(failure)?;
                }
                for (frame, change) in &self.changes {
                    FluxShard::write_change(*frame, change, &mut head).map_err(failure)?;
                }
                let mut file = File::create(&self.path).map_err(failure)?;
                file.write_all(&head).map_err(failure)?;
                none.insert(file)
            }
        };
        file.write_all(&text).and_then(|()| file.flush()).map_err(failure)?;
        self.done += count;
        Ok(())
    }

    /// Removes the checkpoint after complete work.
    pub fn remove(self) {
        drop(self.file);
        let _ = std::fs::remove_file(&self.path);
    }

    /// Wraps the error of interrupted work, with the location of the checkpoint if there is one.
    pub fn unfinished(self, reason: Error) -> Error {
        if self.done == 0 {
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
