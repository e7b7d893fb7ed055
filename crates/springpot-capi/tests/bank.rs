//! The bank as C sees it: the same bits as the bank of the engine, states, energies, and what is refused.
#![allow(unsafe_code)]

use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{Catalog, Derivative, InputValue, NetworkText, Start};
use springpot_capi::Status;
use springpot_capi::c::*;
use std::ffi::{CStr, CString};
use std::path::PathBuf;
use std::process::Command;
use std::ptr::{null, null_mut};

const H: f64 = 0.01;

/// The text of examples/bank.c.
const TEXT: &str = r#"
[[element]]
name = "pad"
law = "springpot"
parameters = { c = "50 N*s^alpha/m", alpha = 0.4 }
[[element]]
name = "mount"
network = "parallel(spring(k_e), series(spring(k_m), springpot(c, alpha)))"
parameters = { k_e = "2 N/mm", k_m = "5 N/mm", c = 300, alpha = 0.6 }
[[element]]
name = "damper"
law = "magnetorheological"
parameters = { E_c = 50, mu_0 = 50, mu = 200, alpha = 0.8 }
"#;

/// A bank that is freed.
struct Owned(*mut SpringpotBank);

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: of springpot_bank_new, freed once.
        unsafe { springpot_bank_free(self.0) };
    }
}

fn words() -> String {
    // SAFETY: ends with a NUL and is copied at once.
    unsafe { CStr::from_ptr(springpot_last_error()) }.to_str().unwrap().to_owned()
}

fn made(text: &str, nodes: u32, form: u32) -> Result<Owned, (Status, String)> {
    let (text, mut bank) = (CString::new(text).unwrap(), null_mut());
    // SAFETY: a text that ends, a pointer that can be written to.
    match unsafe { springpot_bank_new(text.as_ptr(), nodes, form, &mut bank) } {
        Status::Ok => Ok(Owned(bank)),
        status => {
            assert!(bank.is_null());
            Err((status, words()))
        }
    }
}

impl Owned {
    fn begin(&self, strokes: &[f64], inputs: &[f64]) -> Status {
        let (n, m) = (strokes.len(), inputs.len());
        // SAFETY: a bank, arrays as long as is said.
        unsafe { springpot_bank_begin(self.0, strokes.as_ptr(), n, inputs.as_ptr(), m, 1e-11, H, 2.0) }
    }

    /// Forces of a step, and the status.
    fn evaluate(&self, t: f64, strokes: &[f64], rates: &[f64], inputs: &[[f64; 4]; 2], forces: &mut [f64]) -> Status {
        let [values, slopes] = inputs;
        // SAFETY: a bank, arrays as long as is said, forces of their own.
        unsafe {
            springpot_bank_evaluate(
                self.0,
                t,
                H,
                strokes.as_ptr(),
                rates.as_ptr(),
                strokes.len(),
                values.as_ptr(),
                slopes.as_ptr(),
                4,
                forces.as_mut_ptr(),
                forces.len(),
                null_mut(),
                null_mut(),
                0,
            )
        }
    }

    fn commit(&self) -> Status {
        // SAFETY: a bank.
        unsafe { springpot_bank_commit(self.0) }
    }

    fn energies(&self, e: usize) -> [f64; 3] {
        let mut energies = [0.0; 3];
        // SAFETY: a bank, room for three numbers.
        assert_eq!(unsafe { springpot_bank_energies(self.0, e, energies.as_mut_ptr()) }, Status::Ok);
        energies
    }

    fn saved(&self) -> Vec<u8> {
        let mut needed = 0;
        // SAFETY: a bank; no bytes are written.
        assert_eq!(unsafe { springpot_bank_save(self.0, null_mut(), 0, &mut needed) }, Status::Ok);
        let mut bytes = vec![0; needed];
        // SAFETY: a bank, as much room as it says.
        assert_eq!(unsafe { springpot_bank_save(self.0, bytes.as_mut_ptr(), needed, &mut needed) }, Status::Ok);
        bytes
    }

    fn load(&self, bytes: &[u8]) -> Status {
        // SAFETY: a bank, as many bytes as is said.
        unsafe { springpot_bank_load(self.0, bytes.as_ptr(), bytes.len()) }
    }

    /// Step `n` of examples/bank.c.
    fn step(&self, n: u32) -> [f64; 9] {
        let (strokes, rates, inputs) = told(n);
        let mut forces = [0.0; 9];
        assert_eq!(self.evaluate(start(n), &strokes, &rates, &inputs, &mut forces), Status::Ok, "{}", words());
        assert_eq!(self.commit(), Status::Ok);
        forces
    }
}

fn start(n: u32) -> f64 {
    f64::from(n) / 100.0
}

/// Strokes, rates, and inputs with their rates at the points of step `n`.
fn told(n: u32) -> ([f64; 12], [f64; 12], [[f64; 4]; 2]) {
    let (mut strokes, mut rates, mut inputs) = ([0.0; 12], [0.0; 12], [[0.0; 4], [2.0; 4]]);
    for (k, c) in [0.0].iter().chain(Nodes::Radau.positions()).enumerate() {
        let at = start(n) + c * H;
        for e in 0..3 {
            strokes[4 * e + k] = 0.005 * (8.0 * at).sin();
            rates[4 * e + k] = 0.04 * (8.0 * at).cos();
        }
        inputs[0][k] = 2.0 * at;
    }
    (strokes, rates, inputs)
}

/// The same elements in a bank of the engine.
fn engine() -> ElementBank {
    let caputo = Derivative::Caputo;
    let by_name = |name: &str, values: &[f64]| Catalog::standard().get(name).unwrap().build(values, caputo).unwrap();
    let mount = NetworkText::parse("parallel(spring(k_e), series(spring(k_m), springpot(c, alpha)))").unwrap().entry();
    let laws = vec![
        by_name("springpot", &[50.0, 0.4]),
        mount.build(&[2000.0, 5000.0, 300.0, 0.6], caputo).unwrap(),
        by_name("magnetorheological", &[50.0, 50.0, 200.0, 0.8]),
    ];
    let mut bank = ElementBank::new(laws, Nodes::Radau, Form::Rates);
    let start = |inputs| Start { stroke: 0.0, jump: 0.0, inputs };
    let starts = [start(&[]), start(&[]), start(&[InputValue { value: 0.0, rate: 0.0 }])];
    bank.begin(&starts, MemoryRange { tolerance: 1e-11, shortest: H, horizon: 2.0 }).unwrap();
    bank
}

/// Forces at the ends of the steps of examples/bank.c.
fn forces_of_the_engine(steps: u32) -> Vec<[f64; 9]> {
    let mut bank = engine();
    let step = |n| {
        let (strokes, rates, inputs) = told(n);
        bank.start(start(n), H);
        for e in 0..3 {
            for k in 0..4 {
                let voltage = [InputValue { value: inputs[0][k], rate: inputs[1][k] }];
                bank.set(e, k, strokes[4 * e + k], rates[4 * e + k], if e == 2 { &voltage } else { &[] });
            }
        }
        bank.evaluate();
        bank.commit();
        std::array::from_fn(|i| bank.response(i / 3).force[i % 3])
    };
    (0..steps).map(step).collect()
}

fn begun() -> Owned {
    let bank = made(TEXT, 3, 0).unwrap_or_else(|(_, words)| panic!("{words}"));
    assert_eq!(bank.begin(&[0.0; 3], &[0.0]), Status::Ok, "{}", words());
    bank
}

#[test]
fn forces_are_those_of_the_engine_to_the_bit() {
    let bank = begun();
    for (n, wanted) in forces_of_the_engine(100).into_iter().enumerate() {
        let forces = bank.step(n as u32);
        assert_eq!(forces.map(f64::to_bits), wanted.map(f64::to_bits), "step {n}");
    }
}

#[test]
fn names_and_numbers_are_told() {
    let bank = begun();
    // SAFETY: a bank; names end with a NUL.
    unsafe {
        assert_eq!((springpot_bank_elements(bank.0), springpot_bank_inputs(bank.0)), (3, 1));
        assert_eq!(CStr::from_ptr(springpot_bank_name(bank.0, 1)), c"mount");
        assert_eq!(CStr::from_ptr(springpot_bank_input_name(bank.0, 0)), c"damper.u");
        assert!(springpot_bank_name(bank.0, 3).is_null() && springpot_bank_input_name(bank.0, 1).is_null());
        let mut nodes = [0.0; 3];
        assert_eq!(springpot_bank_positions(bank.0, nodes.as_mut_ptr(), 3), Status::Ok);
        assert_eq!(nodes, springpot::collocation::RADAU_NODES);
        assert_eq!(CStr::from_ptr(springpot_version()).to_str(), Ok(env!("CARGO_PKG_VERSION")));
    }
}

#[test]
fn tangents_are_those_of_the_forces() {
    let bank = begun();
    (0..5).for_each(|n| _ = bank.step(n));
    let (strokes, rates, inputs) = told(5);
    let (mut forces, mut by_stroke, mut by_rate) = ([0.0; 9], [0.0; 27], [0.0; 27]);
    // SAFETY: a bank, arrays as long as is said.
    let status = unsafe {
        let (x, v, [u, du]) = (strokes.as_ptr(), rates.as_ptr(), &inputs);
        let (f, fx, fv) = (forces.as_mut_ptr(), by_stroke.as_mut_ptr(), by_rate.as_mut_ptr());
        springpot_bank_evaluate(bank.0, start(5), H, x, v, 12, u.as_ptr(), du.as_ptr(), 4, f, 9, fx, fv, 27)
    };
    assert_eq!(status, Status::Ok, "{}", words());
    // The laws are linear: differences of any size give the tangents.
    for (e, j) in (0..3).flat_map(|e| (0..3).map(move |j| (e, j))) {
        for (tangent, size, of_rates) in [(&by_stroke, 1e-3, false), (&by_rate, 0.1, true)] {
            let (mut x, mut v, mut moved) = (strokes, rates, [0.0; 9]);
            if of_rates {
                v[4 * e + j + 1] += size
            } else {
                x[4 * e + j + 1] += size
            }
            assert_eq!(bank.evaluate(start(5), &x, &v, &inputs, &mut moved), Status::Ok);
            for i in 0..3 {
                let (slope, wanted) = ((moved[3 * e + i] - forces[3 * e + i]) / size, tangent[(3 * e + i) * 3 + j]);
                assert!((slope - wanted).abs() < 1e-8 * (1.0 + wanted.abs()), "{e} {i} {j}: {slope} {wanted}");
            }
        }
    }
}

#[test]
fn work_is_stored_dissipated_or_supplied() {
    let bank = begun();
    let mut work = [0.0; 3];
    let weights = springpot::collocation::RADAU_WEIGHTS;
    for n in 0..100 {
        let (_, rates, _) = told(n);
        let forces = bank.step(n);
        for e in 0..3 {
            work[e] += (0..3).map(|i| H * weights[i] * forces[3 * e + i] * rates[4 * e + i + 1]).sum::<f64>();
        }
    }
    for (e, work) in work.into_iter().enumerate() {
        let [stored, dissipated, supplied] = bank.energies(e);
        assert!(
            stored > 0.0 && dissipated > 0.0 && (supplied != 0.0) == (e == 2),
            "{e}: {stored} {dissipated} {supplied}"
        );
        let error = stored + dissipated - supplied - work;
        // Quadratures see the power of the first step, which begins as t^(1 - alpha), less well than all others.
        assert!(error.abs() < 1e-4 * dissipated, "{e}: {error} J of {dissipated} J");
    }
}

#[test]
fn what_was_saved_goes_on_to_the_bit() {
    let bank = begun();
    (0..40).for_each(|n| _ = bank.step(n));
    let bytes = bank.saved();
    let energies = [0, 1, 2].map(|e| bank.energies(e));
    let wanted: Vec<_> = (40..60).map(|n| bank.step(n)).collect();
    let after = [0, 1, 2].map(|e| bank.energies(e));
    // Back in the same bank, and on in another one.
    let other = begun();
    (0..3).for_each(|n| _ = other.step(n));
    for bank in [&bank, &other] {
        assert_eq!(bank.load(&bytes), Status::Ok, "{}", words());
        assert_eq!([0, 1, 2].map(|e| bank.energies(e)), energies);
        let again: Vec<_> = (40..60).map(|n| bank.step(n)).collect();
        assert_eq!(again, wanted);
        assert_eq!([0, 1, 2].map(|e| bank.energies(e)), after);
    }
    // Torn bytes, none, and those of another bank change nothing.
    let other = made("law = \"spring\"\nparameters = { k = 1 }", 3, 0).ok().unwrap();
    assert_eq!(other.load(&bytes), Status::Order);
    assert_eq!(other.begin(&[0.0], &[]), Status::Ok);
    assert_eq!(other.load(&bytes), Status::State);
    for k in (0..bytes.len()).step_by(97) {
        let mut torn = bytes.clone();
        torn[k] ^= 0x10;
        assert_eq!(bank.load(&torn), Status::State);
    }
    assert_eq!((bank.load(&[]), bank.load(&bytes[..bytes.len() - 1])), (Status::State, Status::State));
    assert_eq!(bank.energies(0), after[0]);
}

#[test]
fn misuse_is_an_error_in_words() {
    for (text, nodes, form, status, words) in [
        (TEXT, 2, 0, Status::Argument, "nodes = 2"),
        (TEXT, 3, 7, Status::Argument, "form = 7"),
        ("law = \"sprung\"\nparameters = {}", 3, 0, Status::Text, "elements:1:7: `law`"),
    ] {
        let (given, told) = made(text, nodes, form).err().unwrap();
        assert!(given == status && told.starts_with(words), "{given:?} {told}");
    }
    // SAFETY: NULL is what functions take in place of a bank, of texts and of arrays.
    unsafe {
        assert_eq!(springpot_bank_new(null(), 3, 0, null_mut()), Status::Argument);
        assert_eq!(springpot_bank_commit(null_mut()), Status::Argument);
        assert_eq!(springpot_bank_elements(null()), 0);
        springpot_bank_free(null_mut());
    }
    let bank = made(TEXT, 3, 0).ok().unwrap();
    let (strokes, rates, inputs) = told(0);
    let mut forces = [f64::NAN; 9];
    assert_eq!(bank.evaluate(0.0, &strokes, &rates, &inputs, &mut forces), Status::Order);
    assert_eq!(bank.begin(&[0.0; 2], &[0.0]), Status::Argument);
    assert_eq!(bank.begin(&[0.0, f64::NAN, 0.0], &[0.0]), Status::Number);
    assert_eq!(bank.begin(&[0.0; 3], &[]), Status::Input);
    assert_eq!(bank.begin(&[0.0; 3], &[f64::INFINITY]), Status::Input);
    assert_eq!(bank.commit(), Status::Order);
    assert_eq!(bank.begin(&[0.0; 3], &[0.0]), Status::Ok);
    assert_eq!(bank.commit(), Status::Order);
    assert_eq!(bank.evaluate(0.0, &strokes[..11], &rates[..11], &inputs, &mut forces), Status::Argument);
    assert_eq!(bank.evaluate(0.0, &strokes, &rates, &inputs, &mut forces[..8]), Status::Argument);
    assert_eq!(bank.evaluate(0.5, &strokes, &rates, &inputs, &mut forces), Status::Order);
    assert_eq!(bank.evaluate(f64::NAN, &strokes, &rates, &inputs, &mut forces), Status::Number);
    let mut wrong = strokes;
    wrong[5] = f64::NAN;
    assert_eq!(bank.evaluate(0.0, &wrong, &rates, &inputs, &mut forces), Status::Number);
    assert_eq!(words(), "number 5 of strokes is NaN");
    // Below -mu_0/mu the damper would feed the motion.
    assert_eq!(bank.evaluate(0.0, &strokes, &rates, &[[-1.0; 4], [0.0; 4]], &mut forces), Status::Input);
    assert!(words().starts_with("element damper at t = 0 s"), "{}", words());
    assert_eq!(bank.commit(), Status::Order);
    // After all of that it is what it was.
    assert_eq!(bank.step(0).map(f64::to_bits), forces_of_the_engine(1)[0].map(f64::to_bits));
}

/// Where cargo puts the shared library: beside the folder of the tests.
fn library() -> PathBuf {
    let deps = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let name = springpot_capi::fmi::LIBRARY;
    let found = [deps.parent().unwrap().join(name), deps.join(name)].into_iter().filter(|file| file.is_file());
    let latest = found.max_by_key(|file| file.metadata().and_then(|data| data.modified()).ok());
    latest.expect("cargo builds the library with its tests")
}

#[test]
fn the_example_in_c_prints_the_forces_of_the_engine() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    if Command::new(&compiler).arg("--version").output().is_err() {
        println!("no C compiler ({compiler}): examples/bank.c is not compiled");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("bank");
    let library = library();
    let home = library.parent().unwrap();
    let compiled = Command::new(&compiler)
        .args(["-std=c99", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I"])
        .arg(root.join("include"))
        .arg(root.join("examples/bank.c"))
        .arg(&library)
        .arg(format!("-Wl,-rpath,{}", home.display()))
        .args(["-lm", "-o"])
        .arg(&program)
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new(&program).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = String::from_utf8(run.stdout).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 100);
    for (row, wanted) in rows.iter().zip(forces_of_the_engine(100)) {
        let ends = [wanted[2], wanted[5], wanted[8]];
        assert_eq!(row[1..].iter().map(|force| force.to_bits()).collect::<Vec<_>>(), ends.map(f64::to_bits));
    }
    assert!(String::from_utf8_lossy(&run.stderr).contains("damper: "));
}

#[test]
fn the_header_declares_every_function() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let header = std::fs::read_to_string(root.join("include/springpot.h")).unwrap();
    let source = std::fs::read_to_string(root.join("src/c.rs")).unwrap();
    let functions: Vec<&str> = source
        .split("extern \"C\" fn ")
        .skip(1)
        .map(|rest| &rest[..rest.find('(').unwrap()])
        .filter(|name| name.starts_with("springpot_"))
        .collect();
    assert!(functions.len() > 12, "{functions:?}");
    for name in functions {
        assert!(header.contains(&format!(" {name}(")) || header.contains(&format!("*{name}(")), "{name}");
    }
    for value in ["SPRINGPOT_STATUS_DEFECT = 8", "SPRINGPOT_NODES_RADAU = 3", "SPRINGPOT_COURSE_SOUGHT = 1"] {
        assert!(header.contains(value), "{value}");
    }
}
