//! Laws of the caller's own in the bank, in C, and in FMUs. In a file of its own: the laws of C and FMUs are those of the process.
#![allow(unsafe_code)]

use springpot::collocation::Nodes;
use springpot::elements::MemoryRange;
use springpot::fractional::Form;
use springpot::law::{Catalog, Entry, Network, Param, Range};
use springpot_capi::Status;
use springpot_capi::bank::{Answers, Bank, Told};
use springpot_capi::c::*;
use springpot_capi::fmi::functions::*;
use springpot_capi::fmi::{Instance, Package, PackageError, Resources};
use springpot_scenario::Scenario;
use std::ffi::{CString, c_void};
use std::ptr::{null, null_mut};
use std::sync::Arc;

const ELEMENT: &str = r#"{ "law": "twin-dashpot", "parameters": { "c_left": "3 N*s/m", "c_right": 4 } }"#;

/// A mass that is pushed through the dashpots: v' = (1 - 7·v)/2.
const SCENARIO: &str = r#"
robot.body = [{ name = "slide", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 2 }]
motion = { kind = "forward", torque = { x = 1 } }
time = { end = 1, output_step = 0.5 }
element = [{ name = "e", joint = "x", law = "twin-dashpot", parameters = { c_left = "3 N*s/m", c_right = 4 } }]
"#;

fn laws() -> Catalog {
    let c = |name: &'static str| Param::new(name, "N*s/m", "viscosity", Range::NOT_NEGATIVE);
    Catalog::standard().with(Entry {
        name: "twin-dashpot".into(),
        equation: "F = (c_left + c_right)·x'".into(),
        params: vec![c("c_left"), c("c_right")],
        inputs: Vec::new(),
        source: "a test".into(),
        build: Arc::new(|values, _| Ok(Network::parallel(values.iter().map(|c| Network::dashpot(*c))))),
    })
}

fn force(bank: &mut Bank) -> f64 {
    bank.begin(&[0.0], &[], MemoryRange { tolerance: 1e-9, shortest: 1e-3, horizon: 1.0 }).unwrap();
    let mut forces = [0.0];
    let told = Told { strokes: &[0.0, 0.01], rates: &[10.0, 10.0], ..Told::default() };
    bank.evaluate(0.0, 1e-3, told, &mut Answers { forces: &mut forces, ..Answers::default() }).unwrap();
    forces[0]
}

/// The one test of this process, since the order counts.
#[test]
fn laws_of_the_caller_are_known_everywhere() {
    // In Rust they come with the call.
    assert_eq!(force(&mut Bank::new(ELEMENT, &laws(), Nodes::One, Form::Rates).unwrap()), 70.0);
    let unknown = Bank::new(ELEMENT, &Catalog::standard(), Nodes::One, Form::Rates).map(|_| ()).unwrap_err();
    assert!(unknown.status == Status::Text && unknown.message.contains("twin-dashpot"), "{unknown}");

    let scenario = Scenario::parse(SCENARIO, "slide.toml", "").unwrap();
    assert!(matches!(Package::new(&scenario, "slide", &Catalog::standard()), Err(PackageError::Scenario(_))));
    let package = Package::new(&scenario, "slide", &laws()).unwrap();
    assert_eq!(package.own_laws(), ["twin-dashpot"]);
    assert!(package.variables().iter().any(|variable| variable.name == "element.e.c_right"));
    let folder = tempfile::tempdir().unwrap();
    package.verify(folder.path()).unwrap();
    // A library that knows nothing of them says so.
    let resources = Resources::read(folder.path(), &Catalog::standard()).unwrap();
    let mut instance = Instance::new(resources.into());
    let fault = instance.enter_initialization().and_then(|()| instance.exit_initialization()).unwrap_err();
    assert!(fault.to_string().contains("twin-dashpot"), "{fault}");

    // In C and in FMUs they are those of the process, once and for all.
    springpot_capi::set_catalog(laws()).unwrap();
    let again = springpot_capi::set_catalog(Catalog::standard()).unwrap_err();
    assert!(again.get("twin-dashpot").is_none());
    let (text, mut bank) = (CString::new(ELEMENT).unwrap(), null_mut());
    // SAFETY: a text that ends, a pointer that can be written to; freed once.
    unsafe {
        assert_eq!(springpot_bank_new(text.as_ptr(), 1, 0, &mut bank), Status::Ok);
        springpot_bank_free(bank);
    }
    let uri = CString::new(format!("file://{}", folder.path().display())).unwrap();
    let guid = CString::new(package.guid()).unwrap();
    let callbacks: [*const c_void; 5] = [null(); 5];
    let at = |name: &str| package.variables().iter().position(|variable| variable.name == name).unwrap() as u32;
    // SAFETY: texts that end, callbacks as C lays them out, arrays as long as they say.
    unsafe {
        let callbacks = (&raw const callbacks).cast();
        let one = fmi2Instantiate(c"one".as_ptr(), 1, guid.as_ptr(), uri.as_ptr(), callbacks, 0, 0);
        assert!(!one.is_null());
        assert_eq!(fmi2SetupExperiment(one, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!((fmi2EnterInitializationMode(one), fmi2ExitInitializationMode(one)), (OK, OK));
        assert_eq!(fmi2DoStep(one, 0.0, 0.5, 1), OK);
        let mut v = f64::NAN;
        assert_eq!(fmi2GetReal(one, &at("v.x"), 1, &mut v), OK);
        assert!((v - (1.0 - (-1.75_f64).exp()) / 7.0).abs() < 1e-7, "{v}");
        fmi2FreeInstance(one);
    }
}
