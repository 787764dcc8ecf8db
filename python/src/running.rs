//! All sessions of the process, so that none pushes on when Python ends.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use palpate_engine::session::Session;
use pyo3::prelude::*;

use crate::parallel::is_forked;

static SESSIONS: Mutex<Vec<Weak<Session>>> = Mutex::new(Vec::new());

/// Ends every session; in a forked child there is none to end.
#[pyfunction]
pub fn stop_all(py: Python<'_>) {
    if is_forked() {
        return;
    }
    py.detach(|| {
        let mut sessions = SESSIONS.lock().unwrap_or_else(PoisonError::into_inner);
        for session in sessions.drain(..) {
            if let Some(session) = session.upgrade() {
                session.stop();
            }
        }
    });
}

/// Notes a session for [`stop_all`] and forgets those that are gone.
pub fn note(session: &Arc<Session>) {
    let mut sessions = SESSIONS.lock().unwrap_or_else(PoisonError::into_inner);
    sessions.retain(|session| session.strong_count() > 0);
    sessions.push(Arc::downgrade(session));
}
