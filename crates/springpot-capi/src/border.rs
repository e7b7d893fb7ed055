//! Pointers of C as slices, panics as problems.

use crate::status::{Problem, Status};
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs what must not unwind into C.
///
/// What the closure changes half before a panic is told to be begun anew ([`Status::Defect`]).
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, Problem>) -> Result<T, Problem> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<String>().map(String::as_str);
        let words = words.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic");
        Err(Problem::new(Status::Defect, format!("a defect of the library: {words}")))
    })
}

/// `length` values at `data`; none where it is NULL and the length 0.
///
/// # Safety
/// `data` is NULL, or points to `length` values that nobody writes to during the call.
pub(crate) unsafe fn slice<'a, T>(what: &str, data: *const T, length: usize) -> Result<&'a [T], Problem> {
    if length == 0 {
        return Ok(&[]);
    }
    check(what, data)?;
    // SAFETY: not NULL and aligned; as many values as the caller says.
    Ok(unsafe { std::slice::from_raw_parts(data, length) })
}

/// As [`slice`], to be written to.
///
/// # Safety
/// `data` is NULL, or points to `length` values that nobody else reads or writes during the call.
pub(crate) unsafe fn slice_mut<'a, T>(what: &str, data: *mut T, length: usize) -> Result<&'a mut [T], Problem> {
    if length == 0 {
        return Ok(&mut []);
    }
    check(what, data)?;
    // SAFETY: not NULL and aligned; as many values as the caller says, which are his alone.
    Ok(unsafe { std::slice::from_raw_parts_mut(data, length) })
}

/// What `pointer` points to.
///
/// # Safety
/// `pointer` is NULL, or points to a value that nobody writes to during the call.
pub(crate) unsafe fn shared<'a, T>(what: &str, pointer: *const T) -> Result<&'a T, Problem> {
    check(what, pointer)?;
    // SAFETY: not NULL and aligned, a value as the caller says.
    Ok(unsafe { &*pointer })
}

/// As [`shared`], to be written to.
///
/// # Safety
/// `pointer` is NULL, or points to a value that nobody else reads or writes during the call.
pub(crate) unsafe fn exclusive<'a, T>(what: &str, pointer: *mut T) -> Result<&'a mut T, Problem> {
    check(what, pointer)?;
    // SAFETY: not NULL and aligned, a value that is the caller's alone.
    Ok(unsafe { &mut *pointer })
}

/// A text of C.
///
/// # Safety
/// `text` is NULL, or points to bytes that end with a NUL and that nobody writes to during the call.
pub(crate) unsafe fn text<'a>(what: &str, text: *const c_char) -> Result<&'a str, Problem> {
    check(what, text)?;
    // SAFETY: not NULL; it ends, as the caller says.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Problem::new(Status::Argument, format!("{what} is not UTF-8")))
}

fn check<T>(what: &str, pointer: *const T) -> Result<(), Problem> {
    let wrong = if pointer.is_null() { "NULL" } else { "not aligned" };
    match !pointer.is_null() && pointer.is_aligned() {
        true => Ok(()),
        false => Err(Problem::new(Status::Argument, format!("{what} is {wrong}"))),
    }
}
