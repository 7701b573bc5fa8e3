//! Processor time, which does not count other programs of the machine, and memory.

/// Processes whose time is taken.
#[derive(Clone, Copy)]
pub(crate) enum Of {
    /// All threads of this process.
    Ourselves,
    /// The processes that this one started and that have ended.
    Children,
}

/// Seconds since the start of the processes, in programs and in the kernel.
#[derive(Clone, Copy)]
pub(crate) struct CpuTime(f64);

impl CpuTime {
    /// Returns the time until now; `None` if the system does not report it.
    #[cfg(unix)]
    pub(crate) fn now(of: Of) -> Option<Self> {
        use nix::sys::resource::{UsageWho, getrusage};
        use nix::sys::time::TimeValLike as _;

        let usage = getrusage(match of {
            Of::Ourselves => UsageWho::RUSAGE_SELF,
            Of::Children => UsageWho::RUSAGE_CHILDREN,
        })
        .ok()?;
        let microseconds = (usage.user_time() + usage.system_time()).num_microseconds();
        u64::try_from(microseconds)
            .ok()
            .map(|microseconds| Self(std::time::Duration::from_micros(microseconds).as_secs_f64()))
    }

    /// Returns `None`, because this system has no such call.
    #[cfg(not(unix))]
    pub(crate) const fn now(_: Of) -> Option<Self> {
        None
    }

    pub(crate) fn since(self, before: Self) -> f64 {
        self.0 - before.0
    }
}

/// Returns the largest memory of the processes that this one started and that have ended, MB;
/// `None` if the system does not report it in kilobytes.
#[cfg(target_os = "linux")]
pub(crate) fn most_memory_of_children_mb() -> Option<i64> {
    use nix::sys::resource::{UsageWho, getrusage};

    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).ok()?;
    Some(usage.max_rss() / 1024)
}

/// Returns `None`, because this system counts in another unit, or has no such call.
#[cfg(not(target_os = "linux"))]
pub(crate) const fn most_memory_of_children_mb() -> Option<i64> {
    None
}
