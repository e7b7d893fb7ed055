//! Long work that Ctrl-C ends.

use pyo3::prelude::*;
use springpot::system::Stop;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How long a signal may wait.
pub(crate) const PATIENCE: Duration = Duration::from_millis(30);

/// Does work on a thread of its own, without the GIL, while this one looks after signals. Where one raises an exception, the work is told to stop
/// and the exception comes once it has.
pub(crate) fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&Stop) -> T + Send) -> PyResult<T> {
    let stop = Stop::new(false);
    let (done, told) = watched(py, &stop, |_| Ok(()), || work(&stop));
    told.map(|()| done)
}

/// Does work that cannot be told to stop on a thread of its own, without the GIL. Where a signal raises an exception, that comes at once; `stop` is set,
/// and the work, which nobody waits for any more, ends by itself.
pub(crate) fn left_behind<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> T + Send + 'static,
) -> PyResult<T> {
    let stop = Arc::new(Stop::new(false));
    let (sender, mut receiver) = channel();
    let told = stop.clone();
    let thread = std::thread::spawn(move || _ = sender.send(work(&told)));
    loop {
        let waiting = &mut receiver;
        match py.detach(move || waiting.recv_timeout(PATIENCE)) {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => {}
        }
        py.check_signals().inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
    }
    match py.detach(|| thread.join()) {
        Err(panic) => std::panic::resume_unwind(panic),
        Ok(()) => unreachable!("what ends without a panic has sent what it found"),
    }
}

/// Does `work` on a thread of its own, without the GIL; now and then `look` is called with it. What `look` or a signal raises sets `stop`, and
/// stands beside what the work then came to.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    stop: &Stop,
    mut look: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce() -> T + Send,
) -> (T, PyResult<()>) {
    std::thread::scope(|scope| {
        let (sender, mut receiver) = channel();
        let thread = scope.spawn(move || _ = sender.send(work()));
        let mut told = Ok(());
        let done = loop {
            let waiting = &mut receiver;
            match py.detach(move || waiting.recv_timeout(PATIENCE)) {
                Ok(done) => break Some(done),
                Err(RecvTimeoutError::Disconnected) => break None,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if told.is_ok() {
                told = py.check_signals().and_then(|()| look(py));
                stop.fetch_or(told.is_err(), Ordering::Relaxed);
            }
        };
        if let Err(panic) = py.detach(|| thread.join()) {
            std::panic::resume_unwind(panic);
        }
        let done = done.expect("the work has ended without a panic");
        (done, told.and_then(|()| look(py)))
    })
}
