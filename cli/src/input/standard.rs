//! Sound from standard input.

use std::io::{IsTerminal, Read};
use std::sync::mpsc;
use std::time::Duration;

use pyrophone_recording::{MAX_FILE_BYTES, settle_length};

use crate::error::Error;
use crate::progress::Work;

/// Name of standard input in messages.
pub const NAME: &str = "standard input";

/// Interval at which a wait for input checks for a signal.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// All of standard input, with its true length in the header if its writer did not know it.
pub fn read(work: &Work) -> Result<Vec<u8>, Error> {
    if std::io::stdin().is_terminal() {
        return Err(Error::Conflict("the input is -, but standard input is a terminal; pipe a sound into it".into()));
    }
    // A read that waits cannot be called off, so another thread waits.
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut bytes = vec![];
        let read = std::io::stdin().lock().take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes);
        sender.send(read.map(|_| bytes))
    });
    let read = loop {
        match receiver.recv_timeout(POLL_INTERVAL) {
            Ok(read) => break read,
            Err(mpsc::RecvTimeoutError::Timeout) => work.check()?,
            Err(mpsc::RecvTimeoutError::Disconnected) => break Ok(vec![]),
        }
    };
    let mut bytes = read.map_err(|error| Error::Conflict(format!("{NAME} cannot be read ({})", error.kind())))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        let (name, found_bytes) = (NAME.into(), bytes.len() as u64);
        return Err(pyrophone_recording::Error::FileTooLarge { name, found_bytes }.into());
    }
    settle_length(&mut bytes);
    Ok(bytes)
}
