//! Runs that go on from what was kept of them: the same rows and the same report as without a break, bit by bit.

use crate::support::robots::{ARM, PATH, every, magnetorheological, prescribed, springpot, strut, thermoviscoelastic};
use crate::support::{cases, shipped};
use springpot::driver::{Checkpoint, Report, Rows, resume, run};
use springpot::system::{RunError, Settings, Stop, System};
use springpot_scenario::Cases;
use std::io;
use std::sync::atomic::Ordering;

/// Rows as bits, and every state between two steps, as bytes.
#[derive(Default)]
struct Keeper {
    rows: Vec<Vec<u64>>,
    states: Vec<Vec<u8>>,
    /// Whether states are wanted while the run goes on; the one where it stops is in any case.
    wants: bool,
}

impl Rows for Keeper {
    fn row(&mut self, values: &[f64]) -> io::Result<()> {
        self.rows.push(values.iter().map(|value| value.to_bits()).collect());
        Ok(())
    }

    fn wants_checkpoint(&mut self, _: f64, last: bool) -> bool {
        self.wants || last
    }

    fn checkpoint(&mut self, state: Checkpoint) -> io::Result<()> {
        self.states.push(postcard::to_stdvec(&state).unwrap());
        Ok(())
    }
}

fn plain(system: &System, settings: &Settings) -> (Vec<Vec<u64>>, Report) {
    let mut rows = Vec::new();
    let mut keep = |row: &[f64]| -> io::Result<()> {
        rows.push(row.iter().map(|value| value.to_bits()).collect());
        Ok(())
    };
    let (report, outcome) = run(system, settings, &mut keep, &Stop::new(false));
    assert!(outcome.is_ok(), "{outcome:?}");
    (rows, report)
}

/// Goes on from some states of a run, and compares rows and report with those of the run; returns how many states there were.
fn goes_on(cases: &Cases, tried: usize) -> usize {
    let plan = cases.plan(0).unwrap();
    let (system, settings) = (plan.system(), plan.settings.clone());
    let (rows, report) = plain(&system, &settings);
    let mut keeper = Keeper { wants: true, ..Keeper::default() };
    let (with, outcome) = run(&system, &settings, &mut keeper, &Stop::new(false));
    assert!(outcome.is_ok() && keeper.rows == rows && with == report, "keeping states changes the run");

    // Another process builds its system anew.
    let system = cases.plan(0).unwrap().system();
    let count = keeper.states.len();
    for bytes in keeper.states.iter().step_by((count / tried).max(1)).chain(keeper.states.last()) {
        let state: Checkpoint = postcard::from_bytes(bytes).unwrap();
        let (t, written) = (state.t(), state.rows());
        let mut rest = Keeper::default();
        let (resumed, outcome) = resume(&system, &settings, state, &mut rest, &Stop::new(false));
        assert!(outcome.is_ok(), "from t = {t}: {outcome:?}");
        assert_eq!(resumed, report, "from t = {t}");
        assert!(rest.rows == rows[written..], "rows differ from t = {t}");
    }
    count
}

fn forward(rest: &str) -> String {
    format!("\n[motion]\nkind = \"forward\"\n{rest}\n[solver]\nrtol = 1e-6\n")
}

/// Its springs slip after some millimetres.
fn filled_rubber() -> String {
    strut("law = \"filled-rubber\"\nparameters = { k = 20, c = 10, alpha = 0.3, k_f = [300, 100], F_f = [1, 1.5] }")
}

#[test]
fn robots_that_move_by_themselves() {
    let struts = [
        thermoviscoelastic(0.5, 25.0, "caputo"),
        thermoviscoelastic(0.3, 25.0, "riemann-liouville"),
        magnetorheological(0.8, "riemann-liouville"),
        springpot(1.0, "caputo"),
        springpot(0.1, "caputo"),
        filled_rubber(),
    ];
    let motions = [
        "torque = { q1 = \"2*sign(sin(9*t))\", q2 = \"abs(sin(5*t))\" }",
        "start = { q = { q2 = 0.1, q3 = 0.2 }, v = { q1 = 1 } }\nprescribed = { q3 = \"0.2 + 0.1*sin(3*t)\" }",
        "start = { q = { q2 = 0.1 } }\nlocked = [\"q1\"]",
    ];
    let mut states = 0;
    for (k, element) in struts.iter().enumerate() {
        let motion = motions[k % motions.len()];
        states += goes_on(&cases(&format!("{ARM}{element}{}{}", forward(motion), every(0.6, 0.017))), 5);
    }
    // Rows farther apart than steps, and a floating robot.
    states += goes_on(&cases(&format!("{ARM}{}{}{}", struts[0], forward(motions[0]), every(0.6, 0.3))), 5);
    let floating = ARM.replacen("kind = \"revolute\", axis = [0, 0, 1], origin = [0, 0, 0]", "kind = \"floating\"", 1);
    let start = "start = { v = { q1 = { vx = 0.5, wz = 1, wx = 0.3 } } }";
    states += goes_on(&cases(&format!("{floating}{}{}{}", struts[0], forward(start), every(0.4, 0.03))), 5);
    assert!(states > 300, "{states} states");
}

#[test]
fn materials_that_warm_themselves() {
    let law = "law = \"fractional-zener\"\nparameters = { k_e = 30, k_m = 200, c = 50, alpha = 0.5 }\n\
               shift = { kind = \"wlf\", C1 = 17.44, C2 = 51.6, T_ref = 290 }\nexpansion = { coefficient = 1e-4, T_ref = 290 }";
    let [own, told] =
        ["thermal = { capacity = 0.1, conductance = 0.02, ambient = 295 }", "inputs = { T = \"295 + 3*sin(4*t)\" }"]
            .map(|heat| strut(&format!("{law}\n{heat}")));
    let mut states = 0;
    for element in [&own, &told] {
        let falling = forward("start = { q = { q2 = 0.1 } }\nlocked = [\"q1\"]");
        states += goes_on(&cases(&format!("{ARM}{element}{falling}{}", every(0.4, 0.017))), 5);
        let swing = prescribed("0.1*abs(sin(8*t))", "0.1*t");
        states += goes_on(&cases(&format!("{ARM}{element}{swing}{}", every(0.4, 0.017))), 5);
        let solver = "[solver]\nmethod = \"midpoint\"\nstep = \"3 ms\"\n";
        let motion = "\n[motion]\nkind = \"forward\"\nstart = { q = { q2 = 0.1 } }\n";
        states += goes_on(&cases(&format!("{ARM}{element}{motion}{}{solver}", every(0.3, 0.017))), 7);
    }
    assert!(states > 300, "{states} states");
}

#[test]
fn joints_that_stick() {
    let arm = ARM
        .replacen("kind = \"revolute\"", "friction = { force = 3, stick = true }, kind = \"revolute\"", 1)
        .replace("name = \"q2\",", "name = \"q2\", friction = { force = 2, stick = true },")
        .replace("name = \"q3\",", "name = \"q3\", friction = { force = 9, stick = true },");
    let element = thermoviscoelastic(0.5, 25.0, "caputo");
    let free = "torque = { q1 = \"4*sign(sin(9*t))\", q2 = \"20*sin(5*t)\" }";
    let led = "start = { q = { q2 = 0.1 }, v = { q1 = 1 } }\nprescribed = { q3 = \"0.2 + 0.1*sin(3*t)\" }";
    let mut states = 0;
    for motion in [free, led] {
        states += goes_on(&cases(&format!("{arm}{element}{}{}", forward(motion), every(1.2, 0.017))), 9);
        let solver = "[solver]\nmethod = \"backward-euler\"\nstep = \"3 ms\"\n";
        let motion = format!("\n[motion]\nkind = \"forward\"\n{motion}\n");
        states += goes_on(&cases(&format!("{arm}{element}{motion}{}{solver}", every(0.3, 0.017))), 7);
    }
    assert!(states > 300, "{states} states");
}

#[test]
fn steps_of_one_size() {
    let element = thermoviscoelastic(0.5, 25.0, "caputo");
    let singular = thermoviscoelastic(0.3, 25.0, "riemann-liouville");
    let floating = ARM.replacen("kind = \"revolute\", axis = [0, 0, 1], origin = [0, 0, 0]", "kind = \"floating\"", 1);
    let mut states = 0;
    for (robot, element, motion) in [
        (ARM, &element, "torque = { q1 = \"2*sign(sin(9*t))\" }\nprescribed = { q3 = \"0.1*sin(3*t)\" }"),
        (ARM, &singular, "start = { q = { q2 = 0.1 } }\nlocked = [\"q1\"]"),
        (&floating, &element, "start = { v = { q1 = { vx = 0.5, wz = 1, wx = 0.3 } } }"),
    ] {
        for method in ["backward-euler", "midpoint"] {
            let solver = format!("[solver]\nmethod = \"{method}\"\nstep = \"3 ms\"\n");
            let motion = format!("\n[motion]\nkind = \"forward\"\n{motion}\n");
            states += goes_on(&cases(&format!("{robot}{element}{motion}{}{solver}", every(0.3, 0.017))), 7);
        }
    }
    assert_eq!(states, 600);
}

#[test]
fn motions_given_in_advance() {
    let kinked = prescribed("0.2*abs(sin(4*t))", "0.1*t + 0.2*max(0, t - 0.3)");
    let scheme = strut("law = \"springpot\"\nparameters = { c = 1, alpha = 0.4 }\nscheme = \"l1\"");
    let mut states = 0;
    for (element, motion) in [
        (thermoviscoelastic(0.5, 25.0, "caputo"), kinked.as_str()),
        (thermoviscoelastic(0.5, 25.0, "riemann-liouville"), &prescribed("0.2 + 0.1*sin(8*t)", "0.3")),
        (magnetorheological(0.2, "caputo"), PATH),
        (scheme, &kinked),
        (filled_rubber(), &kinked),
    ] {
        states += goes_on(&cases(&format!("{ARM}{element}{motion}{}", every(0.8, 0.017))), 5);
    }
    states += goes_on(&shipped("panda_gripper_path.toml", &["time.end=0.2"]), 3);
    assert!(states > 1_000, "{states} states");
}

#[test]
fn a_run_may_be_stopped_again_and_again() {
    let text = format!("{ARM}{}{}", thermoviscoelastic(0.5, 25.0, "caputo"), every(0.5, 0.011));
    let motion = forward("torque = { q2 = \"3*sign(sin(11*t))\" }");
    let plan = cases(&format!("{text}{motion}")).plan(0).unwrap();
    let (system, settings) = (plan.system(), plan.settings.clone());
    let (rows, report) = plain(&system, &settings);

    /// Stops at the first step after some rows.
    struct Stopping<'a>(Keeper, &'a Stop);
    impl Rows for Stopping<'_> {
        fn row(&mut self, values: &[f64]) -> io::Result<()> {
            self.0.row(values)?;
            self.1.store(self.0.rows.len() >= 4, Ordering::Relaxed);
            Ok(())
        }
        fn wants_checkpoint(&mut self, t: f64, last: bool) -> bool {
            self.0.wants_checkpoint(t, last)
        }
        fn checkpoint(&mut self, state: Checkpoint) -> io::Result<()> {
            self.0.checkpoint(state)
        }
    }
    let (mut all, mut state, mut parts) = (Vec::new(), None, 0);
    let last = loop {
        let stop = Stop::new(false);
        let mut part = Stopping(Keeper::default(), &stop);
        let (report, outcome) = match state.take() {
            None => run(&system, &settings, &mut part, &stop),
            Some(state) => resume(&system, &settings, state, &mut part, &stop),
        };
        parts += 1;
        all.append(&mut part.0.rows);
        match outcome {
            Ok(()) => break report,
            Err(RunError::Interrupted { .. }) => {
                assert_eq!(part.0.states.len(), 1);
                state = Some(postcard::from_bytes(&part.0.states[0]).unwrap());
            }
            Err(error) => panic!("{error}"),
        }
    };
    assert!(parts > 8, "{parts}");
    assert!(all == rows && last == report);
}

#[test]
fn another_robot_is_refused() {
    let element = thermoviscoelastic(0.5, 25.0, "caputo");
    let moving = forward("");
    let texts = [
        format!("{ARM}{element}{moving}{}", every(0.1, 0.05)),
        format!("{ARM}{moving}{}", every(0.1, 0.05)),
        format!("{ARM}{element}{}{}", prescribed("t", "0"), every(0.1, 0.05)),
    ];
    let systems = texts.each_ref().map(|text| {
        let plan = cases(text).plan(0).unwrap();
        (plan.system(), plan.settings.clone())
    });
    for (k, (system, settings)) in systems.iter().enumerate() {
        let mut keeper = Keeper { wants: true, ..Keeper::default() };
        let _ = run(system, settings, &mut keeper, &Stop::new(false));
        for (other, (system, settings)) in systems.iter().enumerate().filter(|(other, _)| *other != k) {
            let state = postcard::from_bytes(&keeper.states[1]).unwrap();
            let (_, outcome) = resume(system, settings, state, &mut Keeper::default(), &Stop::new(false));
            assert!(matches!(outcome, Err(RunError::OtherRun)), "{k} {other}: {outcome:?}");
        }
    }
}
