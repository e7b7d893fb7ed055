//! Where a recording goes.

use std::cell::RefCell;
use std::io::{self, Write};
use std::rc::Rc;

/// What could not be written, until someone looks.
#[derive(Debug, Clone, Default)]
pub(super) struct Failure(Rc<RefCell<Option<io::Error>>>);

impl Failure {
    /// # Errors
    /// What was said when something could not be written.
    pub(super) fn check(&self) -> io::Result<()> {
        self.0.borrow_mut().take().map_or(Ok(()), Err)
    }
}

/// Takes everything: what writes an MCAP file must not be stopped within a chunk, and ends its file when it is dropped.
#[derive(Debug)]
pub(super) struct Sink<W> {
    /// `None` from a failure on.
    out: Option<W>,
    failed: Failure,
}

impl<W: Write> Sink<W> {
    pub(super) fn new(out: W) -> (Self, Failure) {
        let failed = Failure::default();
        (Self { out: Some(out), failed: failed.clone() }, failed)
    }

    fn keep(&mut self, result: io::Result<()>) {
        if let Err(error) = result {
            self.out = None;
            *self.failed.0.borrow_mut() = Some(error);
        }
    }
}

impl<W: Write> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.out.as_mut().map_or(Ok(()), |out| out.write_all(bytes));
        self.keep(result);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.out.as_mut().map_or(Ok(()), Write::flush);
        self.keep(result);
        Ok(())
    }
}
