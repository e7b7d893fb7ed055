//! How far an iteration has come that finds changes column by column.

/// The change of a column, in units of itself, at which it is found, and the one that it must come below at least.
const ENOUGH: f64 = 1e-14;
const LEAST: f64 = 1e-10;

/// Passes after which none is looked for any more.
const MOST: usize = 60;

/// Which columns are found: each by itself, so that it has the same bits whatever stands beside it.
#[derive(Debug)]
pub(crate) struct Found {
    pass: usize,
    done: Vec<bool>,
    /// The change of the last pass, in units of the column.
    last: Vec<f64>,
}

impl Found {
    /// Of so many columns, of which nothing is known.
    pub(crate) fn new(count: usize) -> Self {
        Self { pass: 0, done: vec![false; count], last: vec![f64::INFINITY; count] }
    }

    /// Whether nothing was found yet.
    pub(crate) fn is_first(&self) -> bool {
        self.pass == 0
    }

    /// Whether all are found.
    pub(crate) fn is_all(&self) -> bool {
        self.done.iter().all(|done| *done)
    }

    /// Whether the passes lead nowhere.
    pub(crate) fn fails(&self) -> bool {
        self.pass >= MOST && self.last.iter().zip(&self.done).any(|(last, done)| !done && *last > LEAST)
    }

    /// Looks at what the next pass changes, in rows of one number for each column; `size(column)` is how large what it changes is.
    pub(crate) fn take(&mut self, changes: &[f64], size: impl Fn(usize) -> f64) {
        let count = self.done.len();
        if self.pass == 0 {
            return;
        }
        for column in (0..count).filter(|column| !self.done[*column]).collect::<Vec<_>>() {
            let largest = changes.iter().skip(column).step_by(count).fold(0.0, |most: f64, x| most.max(x.abs()));
            let change = if largest == 0.0 { 0.0 } else { largest / size(column) };
            // What no longer shrinks is rounding.
            let stands = change <= LEAST && change >= self.last[column];
            self.done[column] = change <= ENOUGH || stands || change.is_nan() || self.pass >= MOST;
            self.last[column] = change;
        }
    }

    /// Takes a row of the changes off what they change, where that was not found before this pass.
    pub(crate) fn add(&self, to: &mut [f64], changes: &[f64]) {
        for ((to, change), done) in to.iter_mut().zip(changes).zip(&self.done) {
            match (self.pass, done) {
                (0, _) => *to = -change,
                (_, false) => *to -= change,
                _ => {}
            }
        }
    }

    /// The pass was taken.
    pub(crate) fn go_on(&mut self) {
        self.pass += 1;
    }
}
