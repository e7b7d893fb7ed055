//! The element bank in C; `include/springpot.h` is made of this file by cbindgen.

use crate::bank::{Answers, Bank, Told};
use crate::border::{exclusive, guarded, shared, slice, slice_mut, text};
use crate::laws::catalog;
use crate::status::{Problem, Status};
use springpot::collocation::Nodes as CollocationNodes;
use springpot::elements::MemoryRange;
use springpot::fractional::Form as PieceForm;
use springpot::law::Course as StepCourse;
use std::cell::RefCell;
use std::ffi::{CString, c_char};

/// Elements with their laws, states and energies. One thread at a time may use a bank; different banks may be used by different threads.
pub struct SpringpotBank {
    bank: Bank,
    names: Vec<CString>,
    inputs: Vec<CString>,
}

/// Where a step of size h from t on is asked: at the nodes t + c_i h, i = 1 ... s.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nodes {
    /// s = 1, c = (1): steps of one size, as in real time or in engines with a fixed step.
    One = 1,
    /// s = 3, c = ((4 - sqrt 6)/10, (4 + sqrt 6)/10, 1): Radau IIA, order five in forward dynamics.
    Radau = 3,
}

/// What the fractional derivatives take x' for over a step.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// The polynomial through the rates at the start and at the nodes: order 5 - alpha along a known motion with SPRINGPOT_NODES_RADAU.
    Rates = 0,
    /// The derivative of the polynomial through the strokes: order 4 - alpha with SPRINGPOT_NODES_RADAU, 2 - alpha (the L1 scheme) with SPRINGPOT_NODES_ONE;
    /// stable however stiff the element is.
    Strokes = 1,
}

/// What the strokes of a step are. It matters after a Riemann-Liouville start with x(0) != 0 alone, whose force is singular at t = 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    /// Those of a motion that is known: forces are those at the nodes.
    Given = 0,
    /// Sought, so that equations of motion hold: the singular part enters by its moments over the step, and impulses are exact.
    Sought = 1,
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Keeps the words of a problem for `springpot_last_error`.
fn told(outcome: Result<(), Problem>) -> Status {
    match outcome {
        Ok(()) => Status::Ok,
        Err(Problem { status, message }) => {
            LAST.with_borrow_mut(|last| *last = CString::new(message.replace('\0', "\u{fffd}")).unwrap_or_default());
            status
        }
    }
}

fn choice<T: Copy>(what: &str, given: u32, all: &[(u32, T)]) -> Result<T, Problem> {
    let known = all.iter().find(|(number, _)| *number == given).map(|(_, value)| *value);
    known.ok_or_else(|| Problem::new(Status::Argument, format!("{what} = {given} is none of its values")))
}

/// The version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn springpot_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// What was wrong with the last call of this thread that did not return SPRINGPOT_STATUS_OK, in words (UTF-8); valid until its next such call.
#[unsafe(no_mangle)]
pub extern "C" fn springpot_last_error() -> *const c_char {
    LAST.with_borrow(|last| last.as_ptr())
}

/// Makes a bank of the elements of a text.
///
/// The text (UTF-8) is JSON, `[{ "law": "springpot", "parameters": { "c": "50 N*s^alpha/m", "alpha": 0.4 }, "derivative": "caputo" }, ...]`, or `[[element]]`
/// tables of a scenario (TOML), with the keys name, law or network, parameters, inputs, derivative or past, shift, thermal, expansion, as docs/SCENARIO.md has
/// them: numbers are SI, quantities have units. Inputs that the text leaves out are told by the caller. The force is F(x) as `springpot laws NAME` says it,
/// positive in tension, for the stroke x, length less rest length; on an angle m reads rad and N reads N*m.
///
/// `nodes` is a springpot_nodes, `form` a springpot_form. `*bank` is the new bank, to be freed by springpot_bank_free; NULL after an error.
///
/// Errors: ARGUMENT, TEXT.
///
/// # Safety
/// `text` is NULL or ends with a NUL; `bank` is NULL or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_new(
    text: *const c_char,
    nodes: u32,
    form: u32,
    bank: *mut *mut SpringpotBank,
) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let place = unsafe { exclusive("bank", bank) }?;
        *place = std::ptr::null_mut();
        // SAFETY: as the caller says.
        let elements = unsafe { self::text("text", text) }?;
        let nodes = choice("nodes", nodes, &[(1, CollocationNodes::One), (3, CollocationNodes::Radau)])?;
        let form = choice("form", form, &[(0, PieceForm::Rates), (1, PieceForm::Strokes)])?;
        let bank = Bank::new(elements, catalog(), nodes, form)?;
        let c = |name: &str| CString::new(name).unwrap_or_default();
        let names = (0..bank.len()).filter_map(|e| bank.name(e).map(c)).collect();
        let inputs = (0..bank.inputs()).filter_map(|input| bank.input_name(input)).map(|name| c(&name)).collect();
        *place = Box::into_raw(Box::new(SpringpotBank { bank, names, inputs }));
        Ok(())
    }))
}

/// Frees a bank; NULL is nothing.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new, and no longer used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_free(bank: *mut SpringpotBank) {
    if !bank.is_null() {
        // SAFETY: of `Box::into_raw` in springpot_bank_new, freed once.
        let bank = unsafe { Box::from_raw(bank) };
        _ = guarded(|| {
            drop(bank);
            Ok(())
        });
    }
}

/// Number of elements n; 0 of NULL.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_elements(bank: *const SpringpotBank) -> usize {
    // SAFETY: as the caller says.
    unsafe { shared("bank", bank) }.map_or(0, |bank| bank.bank.len())
}

/// Number of inputs of all elements m; 0 of NULL.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_inputs(bank: *const SpringpotBank) -> usize {
    // SAFETY: as the caller says.
    unsafe { shared("bank", bank) }.map_or(0, |bank| bank.bank.inputs())
}

/// Name of element `element`, 0 ... n - 1, valid as long as the bank; NULL where there is none.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_name(bank: *const SpringpotBank, element: usize) -> *const c_char {
    // SAFETY: as the caller says.
    let bank = unsafe { shared("bank", bank) }.ok();
    bank.and_then(|bank| bank.names.get(element)).map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Name of input `input`, 0 ... m - 1, as ELEMENT.INPUT, valid as long as the bank; NULL where there is none. Inputs stand in the order of the elements, each in
/// the order of its law.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_input_name(bank: *const SpringpotBank, input: usize) -> *const c_char {
    // SAFETY: as the caller says.
    let bank = unsafe { shared("bank", bank) }.ok();
    bank.and_then(|bank| bank.inputs.get(input)).map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Writes the nodes c_1 ... c_s of a step into `positions`, which has room for `length` = s numbers.
///
/// Errors: ARGUMENT.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new; `positions` is NULL or has room for `length` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_positions(
    bank: *const SpringpotBank,
    positions: *mut f64,
    length: usize,
) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let (bank, room) = unsafe { (shared("bank", bank)?, slice_mut("positions", positions, length)?) };
        let nodes = bank.bank.nodes().positions();
        if room.len() != nodes.len() {
            let message = format!("positions holds {length} numbers, not {}", nodes.len());
            return Err(Problem::new(Status::Argument, message));
        }
        room.copy_from_slice(nodes);
        Ok(())
    }))
}

/// Says what the strokes of the steps to come are, a springpot_course; at first SPRINGPOT_COURSE_GIVEN.
///
/// Errors: ARGUMENT.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_set_course(bank: *mut SpringpotBank, course: u32) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let bank = unsafe { exclusive("bank", bank) }?;
        bank.bank.set_course(choice("course", course, &[(0, StepCourse::Given), (1, StepCourse::Sought)])?);
        Ok(())
    }))
}

/// Goes to t = 0; whatever was is forgotten.
///
/// `strokes`: x(0), m, shape (n). A Riemann-Liouville element with x(0) != 0 has jumped there: write 0 where it is rounding alone. `inputs`: at t = 0, SI, shape (m);
/// NULL with `inputs_length` = 0: what the text says. `tolerance`: relative error of the memories, 1e-13 ... 0.1, such as 1e-9. `shortest`: the shortest step that is
/// planned, s; shorter ones may follow all the same. `horizon`: the longest past that is remembered to the tolerance, s.
///
/// Errors: ARGUMENT, NUMBER, INPUT, UNSOLVED.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new; arrays are NULL or as long as is said.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_begin(
    bank: *mut SpringpotBank,
    strokes: *const f64,
    strokes_length: usize,
    inputs: *const f64,
    inputs_length: usize,
    tolerance: f64,
    shortest: f64,
    horizon: f64,
) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let bank = unsafe { exclusive("bank", bank) }?;
        // SAFETY: as the caller says.
        let strokes = unsafe { slice("strokes", strokes, strokes_length) }?;
        // SAFETY: as the caller says.
        let inputs = unsafe { slice("inputs", inputs, inputs_length) }?;
        bank.bank.begin(strokes, inputs, MemoryRange { tolerance, shortest, horizon })
    }))
}

/// Forces and tangents of a step of size `h` > 0 from `t` on, where the last committed one ended, s. May be called any number of times, with other strokes and other
/// sizes; nothing is remembered before springpot_bank_commit.
///
/// `points` = n (s + 1) numbers each: `strokes` x, m, and `rates` x', m/s, shape (n, s + 1), the start of the step first, then its nodes.
/// `input_points` = m (s + 1): `inputs`, SI, shape (m, s + 1); NULL: what the text says at those times; `input_rates`, their time derivatives, which energies take;
/// NULL: 0.
/// `nodes` = n s: `forces` F_i, N, positive in tension, shape (n, s), are written.
/// `tangents` = n s s: `by_stroke` dF_i/dx_j, N/m, and `by_rate` dF_i/dx'_j, N s/m, shape (n, s, s), are written where they are not NULL. Of linear laws
/// F_i = sum_j dF_i/dx_j (x_j - x_0) + sum_j dF_i/dx'_j x'_j + H_i, where H_i is known at the start of the step.
///
/// Errors: ARGUMENT, ORDER, NUMBER, INPUT, UNSOLVED.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new; arrays are NULL or as long as is said, those that are written overlap with none.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn springpot_bank_evaluate(
    bank: *mut SpringpotBank,
    t: f64,
    h: f64,
    strokes: *const f64,
    rates: *const f64,
    points: usize,
    inputs: *const f64,
    input_rates: *const f64,
    input_points: usize,
    forces: *mut f64,
    nodes: usize,
    by_stroke: *mut f64,
    by_rate: *mut f64,
    tangents: usize,
) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let bank = unsafe { exclusive("bank", bank) }?;
        // SAFETY: as the caller says.
        let (strokes, rates) = unsafe { (slice("strokes", strokes, points)?, slice("rates", rates, points)?) };
        let optional = |what, data: *const f64| match data.is_null() {
            true => Ok(None),
            // SAFETY: as the caller says.
            false => unsafe { slice(what, data, input_points) }.map(Some),
        };
        let (inputs, input_rates) = (optional("inputs", inputs)?, optional("input_rates", input_rates)?);
        let room = |what, data: *mut f64| match data.is_null() {
            true => Ok(None),
            // SAFETY: as the caller says.
            false => unsafe { slice_mut(what, data, tangents) }.map(Some),
        };
        let (by_stroke, by_rate) = (room("by_stroke", by_stroke)?, room("by_rate", by_rate)?);
        // SAFETY: as the caller says.
        let forces = unsafe { slice_mut("forces", forces, nodes) }?;
        let told = Told { strokes, rates, inputs, input_rates };
        bank.bank.evaluate(t, h, told, &mut Answers { forces, by_stroke, by_rate })
    }))
}

/// Takes the step that was evaluated last into the past; the next one starts where it ended.
///
/// Errors: ARGUMENT, ORDER.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_commit(bank: *mut SpringpotBank) -> Status {
    // SAFETY: as the caller says.
    told(guarded(|| unsafe { exclusive("bank", bank) }?.bank.commit()))
}

/// Writes the energies of element `element` after the last commit into `energies`, 3 numbers, J: stored, and since t = 0 dissipated and supplied by inputs; NaN
/// where unknown, as after a Riemann-Liouville start with x(0) != 0. d(stored) = F dx - d(dissipated) + d(supplied).
///
/// Errors: ARGUMENT.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new; `energies` is NULL or has room for 3 numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_energies(
    bank: *const SpringpotBank,
    element: usize,
    energies: *mut f64,
) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let (bank, room) = unsafe { (shared("bank", bank)?, slice_mut("energies", energies, 3)?) };
        room.copy_from_slice(&bank.bank.energies(element)?);
        Ok(())
    }))
}

/// Writes what it takes to go on from the last commit, to the bit, into `bytes`, and how many bytes these are into `*needed`. With `length` below that, or `bytes`
/// NULL, nothing but `*needed` is written.
///
/// Errors: ARGUMENT (too few bytes, unless `bytes` is NULL), ORDER.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new; `bytes` is NULL or has room for `length` bytes; `needed` is NULL or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_save(
    bank: *const SpringpotBank,
    bytes: *mut u8,
    length: usize,
    needed: *mut usize,
) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let (bank, needed) = unsafe { (shared("bank", bank)?, exclusive("needed", needed)?) };
        let saved = bank.bank.save()?;
        *needed = saved.len();
        if bytes.is_null() {
            return Ok(());
        }
        if length < saved.len() {
            let message = format!("bytes has room for {length} bytes, not {}", saved.len());
            return Err(Problem::new(Status::Argument, message));
        }
        // SAFETY: as the caller says.
        unsafe { slice_mut("bytes", bytes, length) }?[..saved.len()].copy_from_slice(&saved);
        Ok(())
    }))
}

/// Goes on from what springpot_bank_save wrote of a bank of the same text, nodes and form, which has begun, later or earlier; nothing changes after an error.
///
/// Errors: ARGUMENT, ORDER, STATE.
///
/// # Safety
/// `bank` is NULL or of springpot_bank_new; `bytes` is NULL or holds `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn springpot_bank_load(bank: *mut SpringpotBank, bytes: *const u8, length: usize) -> Status {
    told(guarded(|| {
        // SAFETY: as the caller says.
        let (bank, bytes) = unsafe { (exclusive("bank", bank)?, slice("bytes", bytes, length)?) };
        bank.bank.load(bytes)
    }))
}
