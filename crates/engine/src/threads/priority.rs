//! Real-time priority for the two threads that must not wait, and which of the others come first, where the
//! system allows it.
//!
//! Both real-time priorities stay far below the kernel's watchdogs (99), and both threads sleep between
//! ticks, so that they cannot starve the machine.

/// Priority of a thread under SCHED_FIFO, 1..=99.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Priority(u8);

/// The device thread: it writes the forces and holds the watchdog, so it comes first.
pub const DEVICE: Priority = Priority(70);
/// The servo thread.
pub const SERVO: Priority = Priority(69);

/// Asks for real-time priority for the calling thread.
///
/// # Errors
/// The system's reason where it refuses.
pub fn make_real_time(priority: Priority) -> Result<(), String> {
    use thread_priority::ThreadPriority;
    let value = thread_priority::ThreadPriorityValue::try_from(priority.0)
        .map_err(|reason| reason.to_string())?;
    set(ThreadPriority::Crossplatform(value))
}

#[cfg(unix)]
fn set(priority: thread_priority::ThreadPriority) -> Result<(), String> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, set_thread_priority_and_policy,
        thread_native_id,
    };
    set_thread_priority_and_policy(
        thread_native_id(),
        priority,
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    )
    .map_err(sentence)
}

#[cfg(not(unix))]
fn set(priority: thread_priority::ThreadPriority) -> Result<(), String> {
    thread_priority::set_current_thread_priority(priority).map_err(sentence)
}

/// The system's reason in its own words.
fn sentence(reason: thread_priority::Error) -> String {
    match reason {
        thread_priority::Error::OS(code) => std::io::Error::from_raw_os_error(code).to_string(),
        other => format!("{other:?}"),
    }
}

/// How a thread of a session shares the cores with others that have no real-time priority: its niceness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share(i32);

/// What a hand waits for: three quarters of a core beside another thread, so that a page gets its part of
/// a single core too.
pub const PREFERRED: Share = Share(-5);
/// Pictures, and the fractions by which masks are smooth: less than half of the time of a thread beside it, and
/// no less, since what a drill has just cut waits for them, too.
pub const BACKGROUND: Share = Share(4);

/// Has the calling thread share the cores so, as far as the system allows; a refusal is not told, since a
/// system that refuses it refuses real-time priority, too.
pub fn share_cores(Share(niceness): Share) {
    #[cfg(target_os = "linux")]
    // SAFETY: a system call on numbers; 0 is the calling thread
    unsafe {
        libc::setpriority(libc::PRIO_PROCESS, 0, niceness);
    }
    #[cfg(not(target_os = "linux"))]
    let _ = niceness;
}

/// Makes the calling thread's sleeps end on time where it has no real-time priority: by default
/// Linux may add 50 µs to each of them.
pub fn make_sleeps_exact() {
    #[cfg(target_os = "linux")]
    // SAFETY: PR_SET_TIMERSLACK takes one integer and touches only the calling thread
    unsafe {
        libc::prctl(libc::PR_SET_TIMERSLACK, 1_u64);
    }
}
