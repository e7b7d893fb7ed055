//! Many cases at once, one file in case order.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Most bytes that wait in memory for their turn, but for one piece per case.
const MOST_HELD: usize = 256 << 20;

/// Writes the text of many cases to one file in their order, whoever is first.
///
/// The case whose turn it is writes through. Later ones wait in memory, as far as it is given to them; beyond that they
/// wait for their turn. So no two cases ever wait for each other.
#[derive(Debug)]
pub struct Ordered<W> {
    state: Mutex<State<W>>,
    changed: Condvar,
    window: usize,
    most_held: usize,
}

#[derive(Debug)]
struct State<W> {
    out: W,
    turn: usize,
    waiting: BTreeMap<usize, Waiting>,
    /// Bytes in `waiting`.
    held: usize,
    error: Option<io::ErrorKind>,
}

#[derive(Debug, Default)]
struct Waiting {
    text: Vec<u8>,
    finished: bool,
}

/// The part of the file that belongs to one case; it ends with [`Section::finish`]. One that is dropped before ends the whole file.
///
/// Every case up to the last that is begun must be begun, or those after it are never written.
#[derive(Debug)]
pub struct Section<'a, W: Write> {
    file: &'a Ordered<W>,
    case: usize,
    finished: bool,
}

impl<W: Write> Ordered<W> {
    /// A writer that lets at most `window` cases be under way or waiting.
    pub fn new(out: W, window: usize) -> Self {
        let state = State { out, turn: 0, waiting: BTreeMap::new(), held: 0, error: None };
        Self { state: Mutex::new(state), changed: Condvar::new(), window: window.max(1), most_held: MOST_HELD }
    }

    /// Lets `case` be the first: those before it are written.
    pub fn from_case(mut self, case: usize) -> Self {
        self.state.get_mut().unwrap_or_else(PoisonError::into_inner).turn = case;
        self
    }

    /// The case whose text goes right to the file; all before it have ended.
    pub fn turn(&self) -> usize {
        self.lock().turn
    }

    /// Begins `case`, once it is within the window.
    pub fn section(&self, case: usize) -> Section<'_, W> {
        let mut state = self.lock();
        while case.saturating_sub(state.turn) >= self.window && state.error.is_none() {
            state = self.wait(state);
        }
        Section { file: self, case, finished: false }
    }

    fn write(&self, case: usize, text: &[u8]) -> io::Result<()> {
        let mut state = self.lock();
        while case != state.turn && state.held > self.most_held && state.error.is_none() {
            state = self.wait(state);
        }
        if let Some(kind) = state.error {
            return Err(kind.into());
        }
        if case == state.turn {
            let written = state.out.write_all(text);
            return self.note(&mut state, written);
        }
        state.waiting.entry(case).or_default().text.extend_from_slice(text);
        state.held += text.len();
        Ok(())
    }

    /// Ends `case` and lets the next ones through.
    fn finish(&self, case: usize) -> io::Result<()> {
        let mut state = self.lock();
        state.waiting.entry(case).or_default().finished = true;
        loop {
            let turn = state.turn;
            let Some(waiting) = state.waiting.get_mut(&turn) else { break };
            let (text, finished) = (std::mem::take(&mut waiting.text), waiting.finished);
            state.held -= text.len();
            if state.error.is_none() {
                let written = state.out.write_all(&text);
                self.note(&mut state, written)?;
            }
            if !finished {
                break;
            }
            state.waiting.remove(&turn);
            state.turn += 1;
        }
        self.changed.notify_all();
        state.error.map_or(Ok(()), |kind| Err(kind.into()))
    }

    /// Takes no more text; whoever waits is told.
    fn close(&self) {
        self.lock().error.get_or_insert(io::ErrorKind::BrokenPipe);
        self.changed.notify_all();
    }

    /// Keeps the first error, which every later call meets, and wakes those who wait for their turn.
    fn note(&self, state: &mut State<W>, result: io::Result<()>) -> io::Result<()> {
        if let Err(error) = &result {
            state.error = Some(error.kind());
            self.changed.notify_all();
        }
        result
    }

    fn lock(&self) -> MutexGuard<'_, State<W>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State<W>>) -> MutexGuard<'a, State<W>> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }
}

impl<W: Write> Section<'_, W> {
    /// Adds whole lines.
    ///
    /// # Errors
    /// The file's; where another case met one first, its kind.
    pub fn write(&self, text: &[u8]) -> io::Result<()> {
        self.file.write(self.case, text)
    }

    /// Ends the case.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn finish(mut self) -> io::Result<()> {
        self.finished = true;
        self.file.finish(self.case)
    }
}

impl<W: Write> Drop for Section<'_, W> {
    /// A case that stops on an error of its own, or panics, ends the file: the text of later ones has no place behind half of it.
    fn drop(&mut self) {
        if !self.finished {
            self.file.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn line(case: usize, line: usize) -> String {
        format!("{case} {line}\n")
    }

    fn expected(cases: usize, lines: usize) -> String {
        (0..cases).flat_map(|case| (0..lines).map(move |k| line(case, k))).collect()
    }

    fn text(ordered: Ordered<Vec<u8>>) -> String {
        String::from_utf8(ordered.state.into_inner().unwrap().out).unwrap()
    }

    /// Writes through a file that takes `room` bytes and is full after that.
    struct Full(usize);

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            if taken == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(taken) }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn text_comes_out_in_case_order() {
        let ordered = Ordered::new(Vec::new(), 8);
        std::thread::scope(|scope| {
            for case in (0..8).rev() {
                let ordered = &ordered;
                scope.spawn(move || {
                    let section = ordered.section(case);
                    (0..50).for_each(|k| section.write(line(case, k).as_bytes()).unwrap());
                    section.finish().unwrap();
                });
            }
        });
        assert_eq!(text(ordered), expected(8, 50));
    }

    #[test]
    fn little_memory_and_a_small_window_only_make_it_wait() {
        for (window, most_held) in [(1, usize::MAX), (3, 0), (100, 0), (100, 20)] {
            let ordered = Ordered { most_held, ..Ordered::new(Vec::new(), window) };
            let next = AtomicUsize::new(0);
            let work = || {
                loop {
                    let case = next.fetch_add(1, Ordering::Relaxed);
                    if case >= 40 {
                        return;
                    }
                    let section = ordered.section(case);
                    for k in 0..20 {
                        section.write(line(case, k).as_bytes()).unwrap();
                        // At most one piece of each thread beyond what may be held.
                        assert!(ordered.lock().held <= most_held.saturating_add(4 * line(40, 20).len()));
                    }
                    section.finish().unwrap();
                }
            };
            std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(work))));
            assert_eq!(text(ordered), expected(40, 20));
        }
    }

    #[test]
    fn a_full_disk_reaches_every_case_and_stops_none_from_ending() {
        // Threads wait for the window, for memory and for each other when the disk is full.
        for window in [1, 2, 100] {
            let ordered = Ordered { most_held: 0, ..Ordered::new(Full(100), window) };
            let (next, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let work = || -> io::Result<()> {
                loop {
                    let case = next.fetch_add(1, Ordering::Relaxed);
                    let section = ordered.section(case);
                    for k in 0..20 {
                        section.write(line(case, k).as_bytes())?;
                    }
                    section.finish()?;
                }
            };
            std::thread::scope(|scope| {
                for _ in 0..4 {
                    scope.spawn(|| {
                        assert_eq!(work().unwrap_err().kind(), io::ErrorKind::StorageFull);
                        failed.fetch_add(1, Ordering::Relaxed);
                    });
                }
            });
            assert_eq!(failed.into_inner(), 4);
        }
    }

    #[test]
    fn behind_half_a_case_there_is_nothing() {
        let ordered = Ordered::new(Vec::new(), 2);
        let (first, second) = (ordered.section(0), ordered.section(1));
        second.write(b"waits\n").unwrap();
        first.write(b"half\n").unwrap();
        drop(first);
        // The file knows no reason: whoever has one tells it.
        assert_eq!(second.write(b"late\n").unwrap_err().kind(), io::ErrorKind::BrokenPipe);
        assert!(second.finish().is_err() && ordered.section(9).finish().is_err());
        assert_eq!(text(ordered), "half\n");
    }
}
