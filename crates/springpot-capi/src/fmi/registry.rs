//! All instances of this process, by number: one that was freed is not found, whoever still asks for it.

use super::checkpoint::Checkpoint;
use super::instance::Instance;
use super::log::Log;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// An instance with what belongs to its caller.
#[derive(Debug)]
pub(super) struct Slot {
    pub(super) instance: Instance,
    /// Its states, by number.
    pub(super) states: BTreeMap<usize, Checkpoint>,
    /// The categories of messages that are wanted besides errors.
    pub(super) wanted: BTreeSet<String>,
}

/// An instance that several threads may hold.
#[derive(Debug)]
pub(super) struct Entry {
    pub(super) log: Log,
    slot: Mutex<Slot>,
}

static INSTANCES: Mutex<BTreeMap<usize, Arc<Entry>>> = Mutex::new(BTreeMap::new());

/// The number that was given last; those of instances and states are all different, and no address.
static LAST: AtomicUsize = AtomicUsize::new(0);

/// A number that was never given before.
pub(super) fn number() -> usize {
    // Multiples, as if they were addresses, for callers that look at their bits.
    16 * (LAST.fetch_add(1, Ordering::Relaxed) + 1)
}

fn instances() -> MutexGuard<'static, BTreeMap<usize, Arc<Entry>>> {
    INSTANCES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps an instance; its number.
pub(super) fn keep(log: Log, slot: Slot) -> usize {
    let number = number();
    instances().insert(number, Arc::new(Entry { log, slot: Mutex::new(slot) }));
    number
}

/// The instance of a number, if it was not freed.
pub(super) fn find(number: usize) -> Option<Arc<Entry>> {
    instances().get(&number).cloned()
}

/// Frees an instance.
pub(super) fn free(number: usize) {
    let entry = instances().remove(&number);
    drop(entry);
}

impl Entry {
    /// The instance, once no other thread uses it.
    pub(super) fn slot(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
