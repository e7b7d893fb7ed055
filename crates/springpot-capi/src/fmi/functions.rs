//! The functions of FMI 2.0 for Co-Simulation, as headers/fmi2FunctionTypes.h of the standard declares them.
//!
//! All of them answer with a status and tell the logger what was wrong; none unwinds, none follows an instance that was freed. What the
//! description declares as not provided (interpolated inputs, derivatives of outputs, directional derivatives, steps that end later) is
//! `fmi2Error`.

use super::checkpoint::Checkpoint;
use super::description::CATEGORIES;
use super::instance::{Fault, Instance};
use super::log::{Log, Logger};
use super::mode::Mode;
use super::registry::{self, Slot};
use super::resources::Resources;
use super::uri;
use crate::border::{exclusive, guarded, shared, slice, slice_mut, text};
use crate::laws::catalog;
use crate::status::{Problem, Status as CStatus};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::ptr;
use std::sync::Arc;

/// `fmi2Component`: the number of an instance.
pub type Component = *mut c_void;
/// `fmi2FMUstate`: the number of a state.
pub type FmuState = *mut c_void;
/// `fmi2Boolean`.
pub type Boolean = c_int;
/// `fmi2Status`.
pub type Status = c_int;
/// `fmi2ValueReference`.
pub type ValueReference = c_uint;

/// `fmi2OK`.
pub const OK: Status = 0;
/// `fmi2Discard`.
pub const DISCARD: Status = 2;
/// `fmi2Error`.
pub const ERROR: Status = 3;

/// `fmi2CoSimulation` of `fmi2Type`.
const CO_SIMULATION: c_int = 1;
/// Of `fmi2StatusKind`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
const TERMINATED: c_int = 3;

/// `fmi2CallbackFunctions`; memory is the library's own.
#[repr(C)]
#[derive(Debug)]
pub struct CallbackFunctions {
    logger: Option<Logger>,
    allocate_memory: *const c_void,
    free_memory: *const c_void,
    step_finished: *const c_void,
    component_environment: *mut c_void,
}

impl From<Problem> for Fault {
    fn from(problem: Problem) -> Self {
        Self::Error(problem.message)
    }
}

/// Does something with an instance, and tells its logger what was wrong.
fn with(component: Component, work: impl FnOnce(&mut Slot) -> Result<(), Fault>) -> Status {
    let answered = guarded(|| {
        let Some(entry) = registry::find(component.addr()) else { return Ok(ERROR) };
        let mut slot = entry.slot();
        // A panic leaves the instance as one whose step failed.
        let done = guarded(|| Ok(work(&mut slot)));
        let outcome = done.unwrap_or_else(|problem| {
            slot.instance.break_off();
            Err(problem.into())
        });
        drop(slot);
        Ok(match outcome {
            Ok(()) => OK,
            Err(Fault::Error(message)) => {
                entry.log.tell(ERROR, "logStatusError", &message);
                ERROR
            }
            Err(Fault::Discard(message)) => {
                let is_wanted = entry.slot().wants("logStatusDiscard");
                if is_wanted {
                    entry.log.tell(DISCARD, "logStatusDiscard", &message);
                }
                DISCARD
            }
        })
    });
    answered.unwrap_or(ERROR)
}

fn refuse<T>(message: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Error(message.into()))
}

impl Slot {
    fn wants(&self, category: &str) -> bool {
        self.wanted.contains(category) || self.wanted.contains("logAll")
    }
}

/// "default".
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// "2.0".
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Says which messages are wanted: of no category, of these, or of all where none is named. Errors are told in any case.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    component: Component,
    logging_on: Boolean,
    count: usize,
    categories: *const *const c_char,
) -> Status {
    with(component, |slot| {
        // SAFETY: as the standard says.
        let named = unsafe { slice("categories", categories, count) }?;
        let mut wanted = BTreeSet::new();
        for category in named {
            // SAFETY: as the standard says.
            let category = unsafe { text("a category", *category) }?;
            if !CATEGORIES.iter().any(|(known, _)| *known == category) {
                return refuse(format!("there is no category {category:?}"));
            }
            wanted.insert(category.to_owned());
        }
        if named.is_empty() {
            wanted.insert("logAll".to_owned());
        }
        slot.wanted = if logging_on != 0 { wanted } else { BTreeSet::new() };
        Ok(())
    })
}

/// Makes an instance; NULL where the type, the GUID or the resources are not those of the FMU.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: *const c_char,
    fmu_type: c_int,
    guid: *const c_char,
    resources: *const c_char,
    functions: *const CallbackFunctions,
    _visible: Boolean,
    logging_on: Boolean,
) -> Component {
    let made = guarded(|| {
        // SAFETY: as the standard says.
        let name = unsafe { text("the name of the instance", instance_name) }?;
        // SAFETY: as the standard says.
        let functions = unsafe { shared("the callbacks", functions) }?;
        let instance = CString::new(name).unwrap_or_default();
        let log = Log { logger: functions.logger, environment: functions.component_environment, instance };
        let read = guarded(|| {
            let refuse = |message: String| Err(Problem::new(CStatus::Argument, message));
            if name.is_empty() {
                return refuse("the instance has no name".to_owned());
            }
            if fmu_type != CO_SIMULATION {
                return refuse("this is an FMU for co-simulation".to_owned());
            }
            // SAFETY: as the standard says.
            let (guid, uri) = unsafe { (text("the GUID", guid)?, text("the place of the resources", resources)?) };
            let read = uri::folder(uri).and_then(|folder| Resources::read(&folder, catalog()));
            let resources = read.map_err(|message| Problem::new(CStatus::Argument, message))?;
            if resources.guid() != guid {
                return refuse(format!(
                    "the GUID is {guid}, but that of the resources with this version of the library is {}",
                    resources.guid()
                ));
            }
            Ok(resources)
        });
        match read {
            Ok(resources) => {
                let wanted = (logging_on != 0).then(|| "logAll".to_owned()).into_iter().collect();
                let instance = Instance::new(Arc::new(resources));
                Ok(registry::keep(log, Slot { instance, states: BTreeMap::new(), wanted }))
            }
            Err(problem) => {
                log.tell(ERROR, "logStatusError", &problem.message);
                Err(problem)
            }
        }
    });
    made.map_or(ptr::null_mut(), ptr::without_provenance_mut)
}

/// Frees an instance and its states; NULL is nothing.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(component: Component) {
    _ = guarded(|| {
        registry::free(component.addr());
        Ok(())
    });
}

/// Says when the experiment starts, which must be 0, and ends, s; what lies beyond the end is not remembered, and cannot be reached.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    component: Component,
    tolerance_defined: Boolean,
    tolerance: f64,
    start_time: f64,
    stop_time_defined: Boolean,
    stop_time: f64,
) -> Status {
    with(component, |slot| {
        let stop = (stop_time_defined != 0).then_some(stop_time);
        slot.instance.set_up(start_time, stop, (tolerance_defined != 0).then_some(tolerance))
    })
}

/// Begins the initialization.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(component: Component) -> Status {
    with(component, |slot| slot.instance.enter_initialization())
}

/// Ends the initialization.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(component: Component) -> Status {
    with(component, |slot| slot.instance.exit_initialization())
}

/// Ends the simulation; values may still be read.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(component: Component) -> Status {
    with(component, |slot| slot.instance.terminate())
}

/// Makes an instance as it was after fmi2Instantiate; its states stay.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(component: Component) -> Status {
    with(component, |slot| {
        slot.instance.reset();
        Ok(())
    })
}

/// Reads variables, SI; NaN where a column of a run is empty, as forces are at t = 0 of a singular start.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    component: Component,
    references: *const ValueReference,
    count: usize,
    values: *mut f64,
) -> Status {
    with(component, |slot| {
        // SAFETY: as the standard says.
        let (references, values) = unsafe { (slice("vr", references, count)?, slice_mut("value", values, count)?) };
        for (value, reference) in values.iter_mut().zip(references) {
            *value = slot.instance.get(*reference)?;
        }
        Ok(())
    })
}

/// Sets inputs and, before the end of the initialization, parameters, SI. Those behind one that is refused stay as they are.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    component: Component,
    references: *const ValueReference,
    count: usize,
    values: *const f64,
) -> Status {
    with(component, |slot| {
        // SAFETY: as the standard says.
        let (references, values) = unsafe { (slice("vr", references, count)?, slice("value", values, count)?) };
        references.iter().zip(values).try_for_each(|(reference, value)| slot.instance.set(*reference, *value))
    })
}

/// All variables are real: only none of another type can be read or set.
fn none_of(component: Component, kind: &str, count: usize) -> Status {
    with(component, |_| if count == 0 { Ok(()) } else { refuse(format!("there are no {kind} variables")) })
}

/// `fmi2Error` but for no variable: all are real.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetInteger(c: Component, _: *const ValueReference, count: usize, _: *mut c_int) -> Status {
    none_of(c, "integer", count)
}

/// `fmi2Error` but for no variable: all are real.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetInteger(c: Component, _: *const ValueReference, count: usize, _: *const c_int) -> Status {
    none_of(c, "integer", count)
}

/// `fmi2Error` but for no variable: all are real.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetBoolean(c: Component, _: *const ValueReference, count: usize, _: *mut Boolean) -> Status {
    none_of(c, "boolean", count)
}

/// `fmi2Error` but for no variable: all are real.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetBoolean(c: Component, _: *const ValueReference, count: usize, _: *const Boolean) -> Status {
    none_of(c, "boolean", count)
}

/// `fmi2Error` but for no variable: all are real.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetString(c: Component, _: *const ValueReference, count: usize, _: *mut *const c_char) -> Status {
    none_of(c, "string", count)
}

/// `fmi2Error` but for no variable: all are real.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetString(
    c: Component,
    _: *const ValueReference,
    count: usize,
    _: *const *const c_char,
) -> Status {
    none_of(c, "string", count)
}

/// Keeps the state of an instance; one that `*state` is already is replaced.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(component: Component, state: *mut FmuState) -> Status {
    with(component, |slot| {
        // SAFETY: as the standard says.
        let state = unsafe { exclusive("FMUstate", state) }?;
        if !state.is_null() && !slot.states.contains_key(&state.addr()) {
            return refuse("FMUstate is neither NULL nor a state of this instance");
        }
        let checkpoint = slot.instance.checkpoint()?;
        slot.keep(state, checkpoint);
        Ok(())
    })
}

impl Slot {
    /// Keeps a state under its number, or under a new one.
    fn keep(&mut self, state: &mut FmuState, checkpoint: Checkpoint) {
        let number = if state.is_null() { registry::number() } else { state.addr() };
        self.states.insert(number, checkpoint);
        *state = ptr::without_provenance_mut(number);
    }

    fn state(&self, state: FmuState) -> Result<&Checkpoint, Fault> {
        let unknown = || Fault::Error("FMUstate is no state of this instance".to_owned());
        self.states.get(&state.addr()).ok_or_else(unknown)
    }
}

/// Goes on from a state, later or earlier, to the bit.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetFMUstate(component: Component, state: FmuState) -> Status {
    with(component, |slot| {
        let checkpoint = slot.state(state)?.clone();
        slot.instance.restore(&checkpoint)
    })
}

/// Frees a state; NULL is nothing.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(component: Component, state: *mut FmuState) -> Status {
    with(component, |slot| {
        if state.is_null() {
            return Ok(());
        }
        // SAFETY: as the standard says.
        let state = unsafe { exclusive("FMUstate", state) }?;
        if !state.is_null() {
            slot.state(*state)?;
            slot.states.remove(&state.addr());
            *state = ptr::null_mut();
        }
        Ok(())
    })
}

/// How many bytes a state takes.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(component: Component, state: FmuState, size: *mut usize) -> Status {
    with(component, |slot| {
        // SAFETY: as the standard says.
        let size = unsafe { exclusive("size", size) }?;
        *size = slot.state(state)?.bytes()?.len();
        Ok(())
    })
}

/// Writes a state as bytes.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    component: Component,
    state: FmuState,
    bytes: *mut u8,
    size: usize,
) -> Status {
    with(component, |slot| {
        let written = slot.state(state)?.bytes()?;
        if size < written.len() {
            return refuse(format!("serializedState has room for {size} bytes, not {}", written.len()));
        }
        // SAFETY: as the standard says.
        unsafe { slice_mut("serializedState", bytes, size) }?[..written.len()].copy_from_slice(&written);
        Ok(())
    })
}

/// Makes a state of bytes, which may come from another instance of the FMU or from another process.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: Component,
    bytes: *const u8,
    size: usize,
    state: *mut FmuState,
) -> Status {
    with(component, |slot| {
        // SAFETY: as the standard says.
        let (bytes, state) = unsafe { (slice("serializedState", bytes, size)?, exclusive("FMUstate", state)?) };
        let checkpoint = Checkpoint::of_bytes(bytes)?;
        // What it held before was not a state of this instance, or stays one.
        *state = ptr::null_mut();
        slot.keep(state, checkpoint);
        Ok(())
    })
}

/// `fmi2Error`: not provided, as the description says.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub extern "C" fn fmi2GetDirectionalDerivative(
    component: Component,
    _: *const ValueReference,
    _: usize,
    _: *const ValueReference,
    _: usize,
    _: *const f64,
    _: *mut f64,
) -> Status {
    with(component, |_| refuse("directional derivatives are not provided"))
}

/// `fmi2Error`: inputs are held over a step, as the description says.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetRealInputDerivatives(
    component: Component,
    _: *const ValueReference,
    _: usize,
    _: *const c_int,
    _: *const f64,
) -> Status {
    with(component, |_| refuse("inputs are held over a step: their derivatives are not taken"))
}

/// `fmi2Error`: not provided, as the description says.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetRealOutputDerivatives(
    component: Component,
    _: *const ValueReference,
    _: usize,
    _: *const c_int,
    _: *mut f64,
) -> Status {
    with(component, |_| refuse("derivatives of outputs are not provided"))
}

/// Goes from a communication point to the next one, s; inputs hold in between. `fmi2Discard`, and nothing done, where it lies
/// beyond the end; where an event ends the simulation on the way, it stays there.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(component: Component, point: f64, size: f64, _: Boolean) -> Status {
    with(component, |slot| slot.instance.do_step(point, size))
}

/// `fmi2Error`: a step is over when fmi2DoStep returns.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2CancelStep(component: Component) -> Status {
    with(component, |_| refuse("there is no step under way"))
}

/// Nothing is ever pending.
fn untold(component: Component) -> Status {
    with(component, |_| Err(Fault::Discard("a step is over when fmi2DoStep returns".to_owned())))
}

/// `fmi2Discard`: no step is pending.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStatus(component: Component, _: c_int, _: *mut Status) -> Status {
    untold(component)
}

/// The end of the last step that succeeded, s, for `fmi2LastSuccessfulTime`.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(component: Component, kind: c_int, value: *mut f64) -> Status {
    with(component, |slot| {
        if kind != LAST_SUCCESSFUL_TIME {
            return Err(Fault::Discard(format!("status {kind} is no real number")));
        }
        // SAFETY: as the standard says.
        *unsafe { exclusive("value", value) }? = slot.instance.t();
        Ok(())
    })
}

/// `fmi2Discard`: there is no such status.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetIntegerStatus(component: Component, _: c_int, _: *mut c_int) -> Status {
    untold(component)
}

/// Whether a step was to lead beyond the end, for `fmi2Terminated`.
///
/// # Safety
/// As the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(component: Component, kind: c_int, value: *mut Boolean) -> Status {
    with(component, |slot| {
        if kind != TERMINATED {
            return Err(Fault::Discard(format!("status {kind} is no boolean")));
        }
        let is_over = slot.instance.has_ended() || slot.instance.mode() == Mode::Terminated;
        // SAFETY: as the standard says.
        *unsafe { exclusive("value", value) }? = Boolean::from(is_over);
        Ok(())
    })
}

/// `fmi2Discard`: no step is pending.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStringStatus(component: Component, _: c_int, _: *mut *const c_char) -> Status {
    untold(component)
}
