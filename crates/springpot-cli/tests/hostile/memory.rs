//! What is allocated at a time.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Most bytes that an answer may take.
const MOST: usize = 1 << 30;

static HELD: AtomicUsize = AtomicUsize::new(0);

struct Bounded;

/// Ends the process where the next bytes are too many, before the system does.
fn take(bytes: usize) {
    if HELD.fetch_add(bytes, Relaxed) + bytes > MOST {
        super::trial::end("more than a gibibyte is asked for");
    }
}

#[allow(unsafe_code, reason = "an allocator is")]
unsafe impl GlobalAlloc for Bounded {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        take(size);
        HELD.fetch_sub(layout.size(), Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;
