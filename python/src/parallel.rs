//! Work without the GIL that may use all cores, also in a forked child.
//!
//! A fork copies the memory of a process but none of its threads: a child would wait without end
//! for the threads of its parent's pool. So it works on a pool of its own.

use std::sync::{Mutex, OnceLock, PoisonError};

use palpate_engine::threads::priority::{self, share_cores};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The process that rayon's own pool belongs to, or will.
static FIRST: OnceLock<u32> = OnceLock::new();

/// The pool of a forked child, with its process. Never freed: its threads are not there to end in a
/// child of this child.
static OWN: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Whether this process was forked from one that had begun to work in parallel.
pub fn is_forked() -> bool {
    *FIRST.get_or_init(std::process::id) != std::process::id()
}

/// Works without the GIL.
pub fn parallel<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| match own_pool() {
        Some(pool) => pool.install(work),
        None => work(),
    })
}

/// The pool of a forked child; none where rayon's own works.
fn own_pool() -> Option<&'static ThreadPool> {
    is_forked().then(|| pool_of_process(&OWN, |_| ()))
}

/// The pool that is kept in a place, or one that is made for this process.
fn pool_of_process(
    place: &Mutex<Option<(u32, &'static ThreadPool)>>,
    begin: fn(usize),
) -> &'static ThreadPool {
    let here = std::process::id();
    let mut kept = place.lock().unwrap_or_else(PoisonError::into_inner);
    match *kept {
        Some((process, pool)) if process == here => pool,
        _ => {
            let pool = ThreadPoolBuilder::new()
                .start_handler(begin)
                .build()
                .expect("a process may start threads");
            let pool: &'static ThreadPool = Box::leak(Box::new(pool));
            *kept = Some((here, pool));
            pool
        }
    }
}

/// The pool of pictures with its process; its threads give way to all others.
static BACKGROUND: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Works without the GIL on threads that give way to a session's.
pub fn in_background<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| pool_of_process(&BACKGROUND, |_| share_cores(priority::BACKGROUND)).install(work))
}
