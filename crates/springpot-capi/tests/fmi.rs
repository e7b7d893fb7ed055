//! The layer of FMI, called as a master calls it: modes, steps, states, and what is refused.
#![allow(unsafe_code)]

use springpot::Simulation;
use springpot::law::Catalog;
use springpot_capi::fmi::functions::*;
use springpot_capi::fmi::{Package, PackageError};
use springpot_scenario::Scenario;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

/// A link that falls on a magnetorheological damper.
const ARM: &str = r#"
title = "A link on a damper"
robot.body = [{ name = "arm", joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }, mass = 1, com = [0.2, 0, 0] }]
[[element]]
name = "damper"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "start"
law = "magnetorheological"
parameters = { E_c = "50 N/m", mu_0 = "50 N*s^alpha/m", mu = "200 N*s^alpha/(m*V)", alpha = 0.8 }
inputs = { u = "1 V" }
[motion]
kind = "forward"
start = { q = { q1 = 0.1 } }
[time]
end = "1 s"
output_step = "10 ms"
"#;

/// What loggers were told, with their environments.
static TOLD: Mutex<Vec<(usize, c_int, String)>> = Mutex::new(Vec::new());

unsafe extern "C" fn logger(
    environment: *mut c_void,
    _: *const c_char,
    status: c_int,
    _: *const c_char,
    message: *const c_char,
) {
    // SAFETY: a text that ends.
    let message = unsafe { CStr::from_ptr(message) }.to_str().unwrap().to_owned();
    TOLD.lock().unwrap().push((environment.addr(), status, message));
}

/// `fmi2CallbackFunctions` as C lays it out.
#[repr(C)]
struct Callbacks([*const c_void; 5]);

/// An FMU where it is unpacked.
struct Unpacked {
    folder: tempfile::TempDir,
    package: Package,
}

impl Unpacked {
    fn of(text: &str) -> Self {
        let scenario = Scenario::parse(text, "arm.toml", "").unwrap();
        let package = Package::new(&scenario, "arm", &Catalog::standard()).unwrap_or_else(|error| panic!("{error}"));
        let folder = tempfile::tempdir().unwrap();
        package.write_resources(folder.path()).unwrap();
        Self { folder, package }
    }

    fn reference(&self, name: &str) -> u32 {
        let at = self.package.variables().iter().position(|variable| variable.name == name);
        at.unwrap_or_else(|| panic!("no variable {name}")) as u32
    }

    /// An instance whose logger is told this number.
    fn instantiate(&self, environment: usize, guid: &str, kind: c_int) -> Component {
        let uri = CString::new(format!("file://{}", self.folder.path().display())).unwrap();
        let guid = CString::new(guid).unwrap();
        let own = std::ptr::without_provenance(environment);
        let callbacks = Callbacks([logger as *const c_void, null(), null(), null(), own]);
        // SAFETY: texts that end, callbacks as C lays them out.
        unsafe {
            let callbacks = (&raw const callbacks).cast();
            fmi2Instantiate(c"one".as_ptr(), kind, guid.as_ptr(), uri.as_ptr(), callbacks, 0, 0)
        }
    }

    fn instance(&self, environment: usize) -> Driven<'_> {
        let component = self.instantiate(environment, self.package.guid(), 1);
        assert!(!component.is_null(), "{:?}", told(environment));
        Driven { unpacked: self, component, environment }
    }
}

fn told(environment: usize) -> Vec<String> {
    let told = TOLD.lock().unwrap();
    told.iter().filter(|(of, ..)| *of == environment).map(|(.., message)| message.clone()).collect()
}

/// An instance that is freed.
struct Driven<'a> {
    unpacked: &'a Unpacked,
    component: Component,
    environment: usize,
}

impl Drop for Driven<'_> {
    fn drop(&mut self) {
        fmi2FreeInstance(self.component);
    }
}

impl Driven<'_> {
    fn last(&self) -> String {
        told(self.environment).pop().unwrap_or_default()
    }

    fn started(self) -> Self {
        assert_eq!(fmi2SetupExperiment(self.component, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(self.component), OK);
        assert_eq!(fmi2ExitInitializationMode(self.component), OK, "{}", self.last());
        self
    }

    fn set(&self, name: &str, value: f64) -> c_int {
        let reference = self.unpacked.reference(name);
        // SAFETY: one reference and one value.
        unsafe { fmi2SetReal(self.component, &reference, 1, &value) }
    }

    fn get(&self, name: &str) -> f64 {
        let (reference, mut value) = (self.unpacked.reference(name), f64::NAN);
        // SAFETY: one reference and room for one value.
        assert_eq!(unsafe { fmi2GetReal(self.component, &reference, 1, &mut value) }, OK, "{}", self.last());
        value
    }

    /// Steps of a size, and what is seen at their ends.
    fn steps(&self, from: u32, to: u32, size: f64) -> Vec<[f64; 3]> {
        let step = |k| {
            assert_eq!(fmi2DoStep(self.component, f64::from(k) * size, size, 1), OK, "{}", self.last());
            ["q.q1", "damper.force", "energy.residual"].map(|name| self.get(name))
        };
        (from..to).map(step).collect()
    }

    fn state(&self) -> FmuState {
        let mut state = null_mut();
        // SAFETY: can be written to.
        assert_eq!(unsafe { fmi2GetFMUstate(self.component, &mut state) }, OK, "{}", self.last());
        state
    }

    fn serialized(&self, state: FmuState) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: can be written to.
        assert_eq!(unsafe { fmi2SerializedFMUstateSize(self.component, state, &mut size) }, OK);
        let mut bytes = vec![0; size];
        // SAFETY: as much room as is said.
        assert_eq!(unsafe { fmi2SerializeFMUstate(self.component, state, bytes.as_mut_ptr(), size) }, OK);
        bytes
    }

    fn deserialized(&self, bytes: &[u8]) -> (c_int, FmuState) {
        let mut state = null_mut();
        // SAFETY: as many bytes as is said, a state that can be written to.
        let status = unsafe { fmi2DeSerializeFMUstate(self.component, bytes.as_ptr(), bytes.len(), &mut state) };
        (status, state)
    }
}

/// The same steps of a simulation of the engine.
fn simulated(text: &str, set: &[&str], steps: u32, size: f64) -> Vec<[f64; 3]> {
    let mut scenario = Scenario::parse(text, "arm.toml", "").unwrap();
    set.iter().for_each(|assignment| scenario.set(assignment).unwrap());
    let plan = scenario.cases(&Catalog::standard()).unwrap().plan(0).unwrap();
    let mut simulation = Simulation::new(plan.system(), plan.settings).unwrap();
    let observables = simulation.system().observables();
    let by_name =
        |name: &str| observables.quantities().into_iter().find(|q| observables.named(*q).to_string() == name).unwrap();
    let wanted = ["q.q1", "damper.force", "energy.residual"].map(by_name);
    let step = |k| {
        simulation.step_to(f64::from(k) * size + size).unwrap();
        let snapshot = simulation.snapshot().unwrap();
        wanted.map(|quantity| snapshot.value(quantity))
    };
    (0..steps).map(step).collect()
}

fn bits(rows: &[[f64; 3]]) -> Vec<[u64; 3]> {
    rows.iter().map(|row| row.map(f64::to_bits)).collect()
}

#[test]
fn steps_are_those_of_a_simulation_to_the_bit() {
    let arm = Unpacked::of(ARM);
    for (set, assignments) in [
        (vec![], vec![]),
        (
            vec![("damper.u", 2.5), ("element.damper.alpha", 0.6)],
            vec!["element.damper.u=2.5", "element.damper.alpha=0.6"],
        ),
        (vec![("motion.start.q.q1", -0.2)], vec!["motion.start.q.q1=-0.2"]),
    ] {
        let instance = arm.instance(1);
        assert_eq!(fmi2EnterInitializationMode(instance.component), OK);
        set.iter().for_each(|(name, value)| assert_eq!(instance.set(name, *value), OK, "{}", instance.last()));
        assert_eq!(fmi2ExitInitializationMode(instance.component), OK, "{}", instance.last());
        let wanted = simulated(ARM, &assignments, 64, 1.0 / 64.0);
        assert_eq!(bits(&instance.steps(0, 64, 1.0 / 64.0)), bits(&wanted));
        assert_eq!(instance.get("time"), 1.0);
        // Beyond the end there is nothing.
        assert_eq!(fmi2DoStep(instance.component, 1.0, 0.1, 1), DISCARD);
        let (mut is_over, mut t) = (0, 0.0);
        // SAFETY: can be written to.
        unsafe {
            assert_eq!(fmi2GetBooleanStatus(instance.component, 3, &mut is_over), OK);
            assert_eq!(fmi2GetRealStatus(instance.component, 2, &mut t), OK);
        }
        assert_eq!((is_over, t), (1, 1.0));
    }
}

#[test]
fn rollback_gives_the_same_bits() {
    let arm = Unpacked::of(ARM);
    let one = arm.instance(2).started();
    one.steps(0, 10, 0.02);
    assert_eq!((one.set("tau.q1", 0.4), one.set("damper.u", 3.0)), (OK, OK));
    one.steps(10, 15, 0.02);
    let state = one.state();
    let there = ["q.q1", "damper.force", "energy.residual", "tau.q1", "damper.u", "time"];
    let before = there.map(|name| one.get(name));
    let bytes = one.serialized(state);
    let wanted = one.steps(15, 30, 0.02);
    assert_eq!((one.set("damper.u", 0.0), one.set("tau.q1", 9.0)), (OK, OK));
    one.steps(30, 32, 0.02);
    for _ in 0..2 {
        assert_eq!(fmi2SetFMUstate(one.component, state), OK, "{}", one.last());
        assert_eq!(there.map(|name| one.get(name)), before);
        assert_eq!(bits(&one.steps(15, 30, 0.02)), bits(&wanted));
    }
    // As bytes, in an instance that never stepped, with other start values of its own.
    let other = arm.instance(3);
    assert_eq!(other.set("element.damper.E_c", 70.0), OK);
    let (status, state) = other.deserialized(&bytes);
    assert_eq!(status, OK);
    assert_eq!(fmi2SetFMUstate(other.component, state), OK, "{}", other.last());
    assert_eq!(there.map(|name| other.get(name)), before);
    assert_eq!(bits(&other.steps(15, 30, 0.02)), bits(&wanted));
    // Torn bytes, states of nobody, states of another instance.
    let mut torn = bytes.clone();
    torn[bytes.len() / 2] ^= 1;
    assert_eq!((other.deserialized(&torn).0, other.deserialized(&[]).0), (ERROR, ERROR));
    assert_eq!(fmi2SetFMUstate(one.component, state), ERROR);
    assert_eq!(fmi2SetFMUstate(one.component, null_mut()), ERROR);
    let mut freed = state;
    // SAFETY: can be written to.
    unsafe {
        assert_eq!(fmi2FreeFMUstate(other.component, &mut freed), OK);
        assert!(freed.is_null());
        assert_eq!(fmi2FreeFMUstate(other.component, &mut freed), OK);
        assert_eq!(fmi2FreeFMUstate(other.component, null_mut()), OK);
    }
    assert_eq!(fmi2SetFMUstate(other.component, state), ERROR);
}

#[test]
fn states_of_every_mode_are_kept() {
    let arm = Unpacked::of(ARM);
    let one = arm.instance(4);
    assert_eq!(one.set("damper.u", 2.0), OK);
    let new = one.state();
    assert_eq!(fmi2EnterInitializationMode(one.component), OK);
    assert_eq!((one.set("motion.start.q.q1", 0.3), one.get("q.q1")), (OK, 0.3));
    let initializing = one.state();
    assert_eq!(fmi2ExitInitializationMode(one.component), OK);
    let wanted = one.steps(0, 5, 0.01);
    assert_eq!(fmi2SetFMUstate(one.component, initializing), OK);
    assert_eq!(fmi2DoStep(one.component, 0.0, 0.01, 1), ERROR);
    assert_eq!(fmi2ExitInitializationMode(one.component), OK);
    assert_eq!(bits(&one.steps(0, 5, 0.01)), bits(&wanted));
    assert_eq!(fmi2SetFMUstate(one.component, new), OK);
    assert_eq!((one.get("damper.u"), one.get("motion.start.q.q1")), (2.0, 0.1));
    assert_eq!(fmi2Reset(one.component), OK);
    assert_eq!(one.get("damper.u"), 1.0);
    let again = one.started();
    assert_eq!(bits(&again.steps(0, 8, 0.125)), bits(&simulated(ARM, &[], 8, 0.125)));
}

#[test]
fn instances_do_not_know_one_another() {
    let arm = Unpacked::of(ARM);
    let wanted = simulated(ARM, &[], 40, 0.025);
    std::thread::scope(|scope| {
        for k in 0..4 {
            let (arm, wanted) = (&arm, &wanted);
            scope.spawn(move || {
                let instance = arm.instance(10 + k).started();
                if k % 2 == 1 {
                    assert_eq!(instance.set("tau.q1", 0.5), OK);
                }
                let rows = instance.steps(0, 40, 0.025);
                assert_eq!(bits(&rows) == bits(wanted), k % 2 == 0, "instance {k}");
            });
        }
    });
}

#[test]
fn torques_and_inputs_act_and_are_told() {
    let arm = Unpacked::of(ARM);
    let instance = arm.instance(20).started();
    let before = instance.get("a.q1");
    assert_eq!(instance.set("tau.q1", 2.0), OK);
    assert_eq!((instance.get("tau.q1"), instance.get("tau.q1.total")), (2.0, 2.0));
    // m l² a = τ of a point mass.
    assert!((instance.get("a.q1") - before - 2.0 / 0.04).abs() < 1e-9);
    instance.steps(0, 4, 0.05);
    let soft = instance.get("damper.force");
    assert_eq!((instance.set("damper.u", 0.0), instance.get("damper.u")), (OK, 0.0));
    assert!((instance.get("damper.force") - soft).abs() > 0.1);
}

#[test]
fn bad_input_is_an_error_and_changes_nothing() {
    let arm = Unpacked::of(ARM);
    let instance = arm.instance(30);
    let component = instance.component;
    for (of, start, stop) in [
        ("the start time is 1 s", 1.0, 2.0),
        ("the stop time is -1 s", 0.0, -1.0),
        ("the stop time is NaN", 0.0, f64::NAN),
    ] {
        assert_eq!(fmi2SetupExperiment(component, 0, 0.0, start, 1, stop), ERROR);
        assert!(instance.last().starts_with(of), "{}", instance.last());
    }
    let out_of_order =
        |call: extern "C" fn(Component) -> c_int| assert_eq!(call(component), ERROR, "{}", instance.last());
    out_of_order(fmi2ExitInitializationMode);
    out_of_order(fmi2Terminate);
    assert_eq!(fmi2DoStep(component, 0.0, 0.1, 1), ERROR);
    let instance = instance.started();
    let wanted = simulated(ARM, &[], 4, 0.25);
    for (name, value) in [
        ("damper.u", f64::NAN),
        ("tau.q1", f64::INFINITY),
        ("damper.u", -1.0),
        ("q.q1", 1.0),
        ("time", 1.0),
        ("element.damper.alpha", 0.2),
    ] {
        assert_eq!(instance.set(name, value), ERROR, "{name} = {value}");
    }
    let (mut value, none) = (0.0, 100_000);
    // SAFETY: arrays as long as is said, or NULL.
    unsafe {
        assert_eq!(fmi2GetReal(component, &none, 1, &mut value), ERROR);
        assert_eq!(fmi2SetReal(component, &none, 1, &value), ERROR);
        assert_eq!(fmi2GetReal(component, null(), 1, &mut value), ERROR);
        assert_eq!(fmi2SetReal(component, &0, 1, null()), ERROR);
        assert_eq!(fmi2GetReal(component, null(), 0, null_mut()), OK);
        assert_eq!(fmi2GetFMUstate(component, null_mut()), ERROR);
        let categories = [c"logStatusError".as_ptr(), c"logNothing".as_ptr()];
        assert_eq!(fmi2SetDebugLogging(component, 1, 1, categories.as_ptr()), OK);
        assert_eq!(fmi2SetDebugLogging(component, 1, 2, categories.as_ptr()), ERROR);
    }
    for (point, size) in [(0.0, 0.0), (0.0, -0.1), (0.0, f64::NAN), (f64::NAN, 0.1), (0.5, 0.1), (0.0, f64::INFINITY)] {
        assert_eq!(fmi2DoStep(component, point, size, 1), ERROR, "{point} {size}");
    }
    assert_eq!(fmi2GetInteger(component, &none, 1, null_mut()), ERROR);
    assert_eq!(fmi2SetString(component, null(), 0, null()), OK);
    assert_eq!(fmi2GetDirectionalDerivative(component, null(), 0, null(), 0, null(), null_mut()), ERROR);
    assert_eq!(fmi2SetRealInputDerivatives(component, null(), 0, null(), null()), ERROR);
    assert_eq!(fmi2GetRealOutputDerivatives(component, null(), 0, null(), null_mut()), ERROR);
    assert_eq!(fmi2CancelStep(component), ERROR);
    assert_eq!(fmi2GetStatus(component, 0, null_mut()), DISCARD);
    assert_eq!(bits(&instance.steps(0, 4, 0.25)), bits(&wanted));
    assert_eq!(fmi2Terminate(component), OK);
    assert_eq!(instance.get("q.q1"), wanted[3][0]);
    assert_eq!((instance.set("damper.u", 1.0), fmi2DoStep(component, 1.0, 0.1, 1)), (ERROR, ERROR));
    // Freed ones, and what never was one, are found nowhere.
    drop(instance);
    for stale in [component, null_mut(), std::ptr::without_provenance_mut(7)] {
        assert_eq!(fmi2DoStep(stale, 0.0, 0.1, 1), ERROR);
        fmi2FreeInstance(stale);
    }
}

#[test]
fn only_the_right_fmu_is_instantiated() {
    let arm = Unpacked::of(ARM);
    let guid = arm.package.guid().to_owned();
    assert!(arm.instantiate(40, &guid.replace('{', "{0"), 1).is_null());
    assert!(told(40)[0].starts_with("the GUID is"));
    assert!(arm.instantiate(41, &guid, 0).is_null());
    std::fs::write(arm.folder.path().join("scenario.toml"), ARM.replace("1 V", "2 V")).unwrap();
    assert!(arm.instantiate(42, &guid, 1).is_null());
    assert!(told(42)[0].starts_with("the GUID is"));
    std::fs::remove_file(arm.folder.path().join("scenario.toml")).unwrap();
    assert!(arm.instantiate(43, &guid, 1).is_null());
    assert_eq!(told(43), ["scenario.toml is missing among the resources"]);
    // SAFETY: NULL in place of texts and callbacks.
    unsafe {
        assert!(fmi2Instantiate(null(), 1, null(), null(), null(), 0, 0).is_null());
        assert_eq!(CStr::from_ptr(fmi2GetVersion()), c"2.0");
        assert_eq!(CStr::from_ptr(fmi2GetTypesPlatform()), c"default");
    }
}

#[test]
fn a_stop_time_and_a_tolerance_are_taken() {
    let arm = Unpacked::of(ARM);
    let instance = arm.instance(50);
    assert_eq!(fmi2SetupExperiment(instance.component, 1, 1e-6, 0.0, 1, 2.0), OK);
    assert_eq!(fmi2EnterInitializationMode(instance.component), OK);
    assert_eq!(fmi2ExitInitializationMode(instance.component), OK);
    let wanted = simulated(ARM, &["time.end=2", "solver.rtol=1e-6"], 16, 0.125);
    assert_eq!(bits(&instance.steps(0, 16, 0.125)), bits(&wanted));
}

#[test]
fn events_stop_and_set() {
    let stop = "\n[[event]]\nname = \"half\"\nwhen = \"t - 0.55\"\naction = \"stop\"\n";
    let set = "\n[[event]]\nname = \"on\"\nwhen = \"t - 0.3\"\naction = { set = { \"damper.u\" = \"3 V\" } }\n";
    let arm = Unpacked::of(&format!("{ARM}{set}{stop}"));
    let instance = arm.instance(61).started();
    instance.steps(0, 2, 0.25);
    assert_eq!(instance.get("damper.u"), 3.0);
    assert_eq!(fmi2DoStep(instance.component, 0.5, 0.25, 1), DISCARD);
    let (mut is_over, mut t) = (0, 0.0);
    // SAFETY: can be written to.
    unsafe {
        assert_eq!(fmi2GetBooleanStatus(instance.component, 3, &mut is_over), OK);
        assert_eq!(fmi2GetRealStatus(instance.component, 2, &mut t), OK);
    }
    assert_eq!((is_over, t), (1, 0.55));
    assert_eq!(fmi2DoStep(instance.component, 0.55, 0.1, 1), DISCARD);
    assert_eq!(fmi2Terminate(instance.component), OK);
}

#[test]
fn what_is_no_fmu_is_refused() {
    let package = |text: &str| {
        let scenario = Scenario::parse(text, "arm.toml", "").unwrap();
        Package::new(&scenario, "arm", &Catalog::standard()).map(|_| ())
    };
    let swept = format!("{ARM}\n[[sweep]]\nparameter = \"element.damper.u\"\nvalues = [1, 2]\n");
    assert!(matches!(package(&swept), Err(PackageError::Cases { cases: 2 })));
    let prescribed = ARM.replace(
        "kind = \"forward\"\nstart = { q = { q1 = 0.1 } }",
        "kind = \"prescribed\"\njoints = { q1 = \"0.1*sin(t)\" }",
    );
    let scheme = prescribed.replace("inputs =", "scheme = \"l1\"\ninputs =");
    assert!(matches!(package(&scheme), Err(PackageError::Scheme { element }) if element == "damper"));
    assert!(matches!(package(&ARM.replace("alpha = 0.8", "alpha = 1.8")), Err(PackageError::Scenario(_))));
    // A motion that is given in advance has no torques, but all else.
    let given = Unpacked::of(&prescribed);
    let names: Vec<&str> = given.package.variables().iter().map(|variable| variable.name.as_str()).collect();
    assert!(names.contains(&"damper.u") && names.contains(&"tau.q1") && !names.contains(&"tau.q1.total"));
    let instance = given.instance(60).started();
    assert_eq!((instance.set("tau.q1", 1.0), instance.set("damper.u", 2.0)), (ERROR, OK));
    assert!(instance.steps(0, 10, 0.1).iter().all(|row| row.iter().all(|value| value.is_finite())));
}
