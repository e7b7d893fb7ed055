//! Many cases at once, one file in case order.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Writes the text of many cases to one file in their order, whoever is first.
///
/// The case whose turn it is writes through; later ones wait in memory. [`Self::wait_for_turn`] keeps the number of waiting
/// cases small.
#[derive(Debug)]
pub struct Ordered<W> {
    state: Mutex<State<W>>,
    advanced: Condvar,
    window: usize,
}

#[derive(Debug)]
struct State<W> {
    out: W,
    turn: usize,
    waiting: BTreeMap<usize, Waiting>,
    error: Option<io::ErrorKind>,
}

#[derive(Debug, Default)]
struct Waiting {
    text: Vec<u8>,
    finished: bool,
}

impl<W: Write> Ordered<W> {
    /// A writer that lets at most `window` cases be under way or waiting.
    pub fn new(out: W, window: usize) -> Self {
        let state = State { out, turn: 0, waiting: BTreeMap::new(), error: None };
        Self { state: Mutex::new(state), advanced: Condvar::new(), window: window.max(1) }
    }

    /// Blocks until `case` is within the window.
    pub fn wait_for_turn(&self, case: usize) {
        let mut state = self.lock();
        while case >= state.turn + self.window && state.error.is_none() {
            state = self.advanced.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Adds whole lines of `case`.
    ///
    /// # Errors
    /// The file's, also where another case met it first.
    pub fn write(&self, case: usize, text: &[u8]) -> io::Result<()> {
        let mut state = self.lock();
        if case == state.turn {
            let written = state.out.write_all(text);
            return state.note(written);
        }
        state.waiting.entry(case).or_default().text.extend_from_slice(text);
        state.note(Ok(()))
    }

    /// Ends `case` and lets the next ones through.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn finish(&self, case: usize) -> io::Result<()> {
        let mut state = self.lock();
        state.waiting.entry(case).or_default().finished = true;
        let mut written = Ok(());
        while written.is_ok() {
            let turn = state.turn;
            let Some(waiting) = state.waiting.get_mut(&turn) else { break };
            let text = std::mem::take(&mut waiting.text);
            let finished = waiting.finished;
            written = state.out.write_all(&text);
            if !finished {
                break;
            }
            state.waiting.remove(&turn);
            state.turn += 1;
        }
        let noted = state.note(written);
        drop(state);
        self.advanced.notify_all();
        noted
    }

    /// Flushes what was written.
    ///
    /// # Errors
    /// The file's.
    pub fn flush(&self) -> io::Result<()> {
        self.lock().out.flush()
    }

    fn lock(&self) -> MutexGuard<'_, State<W>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<W> State<W> {
    fn note(&mut self, result: io::Result<()>) -> io::Result<()> {
        if let Err(error) = &result {
            self.error = Some(error.kind());
        }
        self.error.map_or(result, |kind| Err(kind.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_comes_out_in_case_order() {
        let ordered = Ordered::new(Vec::new(), 8);
        std::thread::scope(|scope| {
            for case in (0..8).rev() {
                let ordered = &ordered;
                scope.spawn(move || {
                    ordered.wait_for_turn(case);
                    for line in 0..50 {
                        ordered.write(case, format!("{case} {line}\n").as_bytes()).unwrap();
                    }
                    ordered.finish(case).unwrap();
                });
            }
        });
        let text = String::from_utf8(ordered.state.into_inner().unwrap().out).unwrap();
        let expected: String = (0..8).flat_map(|case| (0..50).map(move |line| format!("{case} {line}\n"))).collect();
        assert_eq!(text, expected);
    }

    #[test]
    fn a_full_disk_reaches_every_case() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let ordered = Ordered::new(Full, 2);
        assert_eq!(ordered.write(0, b"a").unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!(ordered.write(1, b"b").unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
}
