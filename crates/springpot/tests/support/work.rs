//! Processor time of a thread: what work costs, whatever else the machine does.

use std::time::{Duration, Instant};

/// A stretch of work of the thread that begins it.
pub(crate) struct Work {
    begun: Instant,
    before: Option<Duration>,
}

impl Work {
    pub(crate) fn begin() -> Self {
        Self { begun: Instant::now(), before: on_processor() }
    }

    /// Processor time since then; wall time where the system does not list it.
    pub(crate) fn done(&self) -> Duration {
        on_processor().zip(self.before).map_or_else(|| self.begun.elapsed(), |(now, before)| now - before)
    }
}

/// Linux lists nanoseconds on a processor as the first number.
fn on_processor() -> Option<Duration> {
    let listed = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(listed.split(' ').next()?.parse().ok()?))
}
