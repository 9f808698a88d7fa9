//! One attempt of the loader's thread to do the missing work: its validity and its progress.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use pyrophone_synthesis::EngineConfig;

use super::mailbox::Mailbox;
use super::status::Status;
use crate::parameters::EffectParams;

/// One attempt to do the missing work.
pub struct Job {
    mailbox: Arc<Mailbox>,
    status: Arc<Status>,
    params: Arc<EffectParams>,
    epoch: u64,
    wanted: EngineConfig,
    /// Progress last shown, in percent.
    shown: AtomicU32,
}

impl Job {
    /// An attempt to carry out the orders up to `epoch` for the structure given by the parameters.
    pub fn new(mailbox: &Arc<Mailbox>, status: &Arc<Status>, params: &Arc<EffectParams>, epoch: u64) -> Self {
        Self {
            wanted: params.values().structure(),
            mailbox: mailbox.clone(),
            status: status.clone(),
            params: params.clone(),
            epoch,
            shown: AtomicU32::new(0),
        }
    }

    /// The structure given by the parameters at the start.
    pub fn wanted(&self) -> &EngineConfig {
        &self.wanted
    }

    /// True if a later order makes the work useless.
    pub fn is_called_off(&self) -> bool {
        self.mailbox.is_called_off(self.epoch)
    }

    /// Shows progress (0-1); returns false if the work should stop.
    pub fn report(&self, what: &str, done: f32) -> bool {
        // 0 is kept for no progress shown yet.
        let percent = (done * 100.0) as u32 + 1;
        if self.shown.swap(percent, Ordering::Relaxed) != percent {
            self.status.update(|view| view.progress = Some((what.to_owned(), done)));
        }
        !self.is_called_off()
    }

    /// As `report`, for work that depends on the structure.
    pub fn report_indexing(&self, what: &str, done: f32) -> bool {
        self.report(what, done) && self.params.values().structure() == self.wanted
    }

    /// Clears the displayed progress.
    pub fn end(&self) {
        if self.shown.load(Ordering::Relaxed) != 0 {
            self.status.update(|view| view.progress = None);
        }
    }
}
