//! Long work that Ctrl-C ends.

use pyo3::prelude::*;
use springpot::integrate::Stop;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How long a signal may wait.
pub(crate) const PATIENCE: Duration = Duration::from_millis(30);

/// Does work on a thread of its own, without the GIL, while this one looks after signals. Where one raises an exception, the work is told to stop
/// and the exception comes once it has.
pub(crate) fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&Stop) -> T + Send) -> PyResult<T> {
    let stop = Stop::new(false);
    std::thread::scope(|scope| {
        let (sender, mut receiver) = channel();
        let stopped = &stop;
        let thread = scope.spawn(move || _ = sender.send(work(stopped)));
        let mut raised = None;
        let done = loop {
            let waiting = &mut receiver;
            let waited = py.detach(move || waiting.recv_timeout(PATIENCE));
            match waited {
                Ok(done) => break Some(done),
                Err(RecvTimeoutError::Disconnected) => break None,
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(error) = py.check_signals() {
                        stop.store(true, Ordering::Relaxed);
                        raised = raised.or(Some(error));
                    }
                }
            }
        };
        if let Err(panic) = py.detach(|| thread.join()) {
            std::panic::resume_unwind(panic);
        }
        match (raised, done) {
            (Some(error), _) => Err(error),
            (None, Some(done)) => Ok(done),
            (None, None) => unreachable!("the work has ended without a panic"),
        }
    })
}
