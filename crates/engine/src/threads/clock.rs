//! The one clock of a session: monotonic, in nanoseconds, with sleeping until a point in time.
//!
//! Sleeping until an absolute time, not for a duration, keeps a thread's ticks from drifting.

/// Nanoseconds of the monotonic clock.
#[cfg(target_os = "linux")]
#[must_use]
pub fn now_ns() -> u64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is a valid timespec, and the monotonic clock exists on every Linux
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    time.tv_sec.unsigned_abs() * 1_000_000_000 + time.tv_nsec.unsigned_abs()
}

/// Sleeps until the monotonic clock shows `deadline_ns`; returns at once where it has passed.
#[cfg(target_os = "linux")]
pub fn sleep_until(deadline_ns: u64) {
    let time = libc::timespec {
        tv_sec: (deadline_ns / 1_000_000_000).cast_signed(),
        tv_nsec: (deadline_ns % 1_000_000_000).cast_signed(),
    };
    // a signal ends the sleep early; any other return is final
    loop {
        // SAFETY: `time` is a valid timespec, and no remaining time is asked for
        let result = unsafe {
            libc::clock_nanosleep(
                libc::CLOCK_MONOTONIC,
                libc::TIMER_ABSTIME,
                &raw const time,
                std::ptr::null_mut(),
            )
        };
        if result != libc::EINTR {
            return;
        }
    }
}

#[cfg(not(target_os = "linux"))]
fn epoch() -> std::time::Instant {
    static EPOCH: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    *EPOCH.get_or_init(std::time::Instant::now)
}

/// Nanoseconds of the monotonic clock.
#[cfg(not(target_os = "linux"))]
#[must_use]
pub fn now_ns() -> u64 {
    u64::try_from(epoch().elapsed().as_nanos()).unwrap_or(u64::MAX)
}

/// Sleeps until the monotonic clock shows `deadline_ns`; returns at once where it has passed.
#[cfg(not(target_os = "linux"))]
pub fn sleep_until(deadline_ns: u64) {
    std::thread::sleep(std::time::Duration::from_nanos(
        deadline_ns.saturating_sub(now_ns()),
    ));
}
