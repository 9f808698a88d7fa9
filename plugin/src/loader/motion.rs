//! The speed field that vortex sound follows: from a file or a session to the engine.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use pyrophone_settings::session::{FieldReference, MAX_FIELD_BYTES, Session};
use pyrophone_synthesis::vortex::SpeedField;

use super::link::{LoaderLink, Update};
use super::status::Status;

/// The field, and whether the engine has it.
#[derive(Default)]
pub struct Motion {
    field: Option<Arc<SpeedField>>,
    is_sent: bool,
    /// Error in the session's field, until it is reported.
    error: Option<String>,
}

impl Motion {
    /// Has the field sent again.
    pub fn resend(&mut self) {
        self.is_sent = false;
    }

    /// Loads the field from a file into the session; on failure the old one stays, and the reason is returned.
    pub fn load(&mut self, path: &Path, session: &mut Session, status: &Status) -> Result<(), String> {
        let shown = path.display();
        let cannot = |error: std::io::Error| format!("{shown}: {}; choose a readable file", error.kind());
        // Reading a pipe could block for ever.
        if !path.metadata().map_err(cannot)?.is_file() {
            return Err(format!("{shown}: this is not a file; choose a speed field"));
        }
        let mut bytes = vec![];
        let file = std::fs::File::open(path).map_err(cannot)?;
        file.take(MAX_FIELD_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(cannot)?;
        if bytes.len() > MAX_FIELD_BYTES {
            let most = MAX_FIELD_BYTES >> 20;
            return Err(format!("{shown}: a speed field may have at most {most} MB; export fewer seconds"));
        }
        let field = SpeedField::from_bytes(&bytes).map_err(|error| format!("{shown}: {error}"))?;
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).to_string_lossy().into_owned();
        session.field = Some(FieldReference { path, bytes });
        self.set(Some(field), session, status);
        Ok(())
    }

    /// Reads the session's field, if any.
    pub fn read(&mut self, session: &Session, status: &Status) {
        let field = session.field.as_ref().map(|field| SpeedField::from_bytes(&field.bytes));
        match field.transpose() {
            Ok(field) => self.set(field, session, status),
            Err(error) => {
                self.set(None, session, status);
                self.error = Some(error.to_string());
            }
        }
    }

    /// The error in the session's field, once.
    pub fn take_error(&mut self) -> Option<String> {
        self.error.take()
    }

    /// Sends the field to the engine, if it lacks it.
    pub fn send(&mut self, link: &mut LoaderLink) {
        if !self.is_sent {
            self.is_sent = link.send(Update::Field(self.field.clone()));
        }
    }

    fn set(&mut self, field: Option<SpeedField>, session: &Session, status: &Status) {
        let name = session.field.as_ref().map(|field| field.path.rsplit(['/', '\\']).next().unwrap_or_default());
        let shown = field.as_ref().zip(name).map(|(field, name)| {
            let seconds = field.steps() as f64 / field.rate_hz();
            format!("{name}: {seconds:.1} s, {} sources", field.sources())
        });
        status.update(|view| view.field = shown);
        self.field = field.map(Arc::new);
        self.is_sent = false;
    }
}
