//! The state's field with the recording and the learned distribution, between the host, which loads and saves it on any
//! thread, and the loader, which interprets it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pyrophone_settings::Session;

/// Store of the field as text. The loaded text is saved unchanged until the loader replaces it, so a session that is
/// unreadable or whose recording is missing is saved unharmed.
pub struct SessionStore {
    inner: Mutex<Inner>,
    /// Called after a field has arrived; must not block.
    on_arrival: Box<dyn Fn() + Send + Sync>,
}

struct Inner {
    field: Arc<str>,
    /// True if `field` came from the host and the loader has not read it.
    unread: bool,
}

impl SessionStore {
    /// A store with an empty session; `on_arrival` is called on the thread that loads a state, which may be the audio
    /// thread.
    pub fn new(on_arrival: impl Fn() + Send + Sync + 'static) -> Self {
        let field = encode(&Session::default());
        Self { inner: Mutex::new(Inner { field, unread: false }), on_arrival: Box::new(on_arrival) }
    }

    /// The field to be saved.
    pub fn field(&self) -> Arc<str> {
        self.lock().field.clone()
    }

    /// Stores a field loaded by the host; short work only.
    pub fn arrive(&self, field: Arc<str>) {
        let old = {
            let mut inner = self.lock();
            inner.unread = true;
            std::mem::replace(&mut inner.field, field)
        };
        drop(old);
        (self.on_arrival)();
    }

    /// The field loaded by the host, once.
    pub fn take_arrived(&self) -> Option<Arc<str>> {
        let mut inner = self.lock();
        std::mem::take(&mut inner.unread).then(|| inner.field.clone())
    }

    /// Replaces the field to be saved, unless the host has loaded a newer one.
    pub fn store(&self, session: &Session) {
        let field = encode(session);
        let mut inner = self.lock();
        if !inner.unread {
            inner.field = field;
        }
    }

    /// The lock is held only while pointers are moved, so nobody waits for it for long.
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The session's text as a field of the state, which is JSON: a string.
fn encode(session: &Session) -> Arc<str> {
    serde_json::to_string(&session.to_json()).unwrap_or_default().into()
}

/// The session in a state's field.
pub fn decode(field: &str) -> Result<Session, pyrophone_settings::Error> {
    let damaged = |error: serde_json::Error| pyrophone_settings::Error::Session { message: error.to_string() };
    let text: String = serde_json::from_str(field).map_err(damaged)?;
    Session::from_json(&text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pyrophone_settings::session::RecordingReference;

    fn some_session() -> Session {
        let recording = RecordingReference { path: "/a.wav".into(), content_hash: "00".into(), embedded: None };
        Session { recording: Some(recording), ..Session::default() }
    }

    #[test]
    fn loaded_field_is_saved_unchanged_until_the_loader_replaces_it() {
        let store = SessionStore::new(|| {});
        assert_eq!(decode(&store.field()).unwrap(), Session::default());
        store.arrive("garbage".into());
        store.store(&some_session());
        assert_eq!(&*store.field(), "garbage", "unread fields are not overwritten");
        assert_eq!(store.take_arrived().as_deref(), Some("garbage"));
        assert_eq!(store.take_arrived(), None);
        store.store(&some_session());
        assert_eq!(decode(&store.field()).unwrap(), some_session());
    }
}
