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
    watched(py, &stop, |_| Ok(()), || work(&stop))
}

/// Does `work` on a thread of its own, without the GIL; now and then `look` is called with it. What `look` or a signal raises sets `stop`, and comes
/// once the work has ended.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    stop: &Stop,
    mut look: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    std::thread::scope(|scope| {
        let (sender, mut receiver) = channel();
        let thread = scope.spawn(move || _ = sender.send(work()));
        let mut raised = None;
        let done = loop {
            let waiting = &mut receiver;
            match py.detach(move || waiting.recv_timeout(PATIENCE)) {
                Ok(done) => break Some(done),
                Err(RecvTimeoutError::Disconnected) => break None,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if raised.is_none()
                && let Err(error) = py.check_signals().and_then(|()| look(py))
            {
                stop.store(true, Ordering::Relaxed);
                raised = Some(error);
            }
        };
        if let Err(panic) = py.detach(|| thread.join()) {
            std::panic::resume_unwind(panic);
        }
        match (raised, done) {
            (Some(error), _) => Err(error),
            (None, Some(done)) => look(py).map(|()| done),
            (None, None) => unreachable!("the work has ended without a panic"),
        }
    })
}
