//! Events of forward runs against closed forms: when they happen, what they stop and set, and that the memories go on.

mod support;

use springpot::Simulation;
use springpot::driver::{Checkpoint, Report, Rows, resume, run};
use springpot::system::{RunError, Stop};
use springpot_scenario::Plan;
use support::cases;
use support::forward::{every, slider, state};
use support::robots::{ARM, thermoviscoelastic};

/// Rows, rows of events with their numbers, and states.
#[derive(Debug, Default)]
struct Kept {
    rows: Vec<Vec<f64>>,
    events: Vec<(usize, Vec<f64>)>,
    states: Vec<(Checkpoint, usize)>,
    keeps_states: bool,
}

impl Rows for Kept {
    fn row(&mut self, values: &[f64]) -> std::io::Result<()> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn event(&mut self, event: usize, values: &[f64], _: &[f64]) -> std::io::Result<()> {
        self.events.push((event, values.to_vec()));
        Ok(())
    }

    fn wants_checkpoint(&mut self, _: f64, _: bool) -> bool {
        self.keeps_states
    }

    fn checkpoint(&mut self, state: Checkpoint) -> std::io::Result<()> {
        self.states.push((state, self.events.len()));
        Ok(())
    }
}

/// A run, its columns by name.
struct Run {
    names: Vec<String>,
    kept: Kept,
    report: Report,
    error: Option<RunError>,
}

impl Run {
    fn place(&self, column: &str) -> usize {
        self.names.iter().position(|name| name == column).unwrap_or_else(|| panic!("no column {column}"))
    }

    /// What a column is at each event of a number.
    fn at(&self, event: usize, column: &str) -> Vec<f64> {
        let k = self.place(column);
        self.kept.events.iter().filter(|(number, _)| *number == event).map(|(_, row)| row[k]).collect()
    }

    fn column(&self, column: &str) -> Vec<f64> {
        let k = self.place(column);
        self.kept.rows.iter().map(|row| row[k]).collect()
    }

    fn residual(&self) -> f64 {
        self.report.energy_residual.unwrap() / self.report.energy_turned_over.unwrap()
    }
}

fn plan(text: &str) -> Plan {
    cases(text).plan(0).unwrap_or_else(|refusals| panic!("{refusals}"))
}

fn try_run(text: &str, keeps_states: bool) -> Run {
    let plan = plan(text);
    let system = plan.system();
    let mut kept = Kept { keeps_states, ..Kept::default() };
    let (report, outcome) = run(&system, &plan.settings, &mut kept, &Stop::new(false));
    let names = system.columns().into_iter().map(|column| column.name).collect();
    Run { names, kept, report, error: outcome.err() }
}

fn done(text: &str) -> Run {
    let run = try_run(text, false);
    assert!(run.error.is_none(), "{:?}\n{text}", run.error);
    run
}

fn event(name: &str, rest: &str) -> String {
    format!("[[event]]\nname = \"{name}\"\n{rest}\n")
}

/// x'' = -x from x = 1.
fn oscillator(events: &str, end: f64, solver: &str) -> String {
    let law = "law = \"spring\"\nparameters = { k = 1 }";
    let times = format!("\n[time]\nend = {end}\noutput_step = 0.5\n[solver]\n{solver}\n");
    slider("1", 0.0, law, &state("1", "0")) + events + &times
}

fn near(found: &[f64], wanted: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), wanted.len(), "{what}");
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() <= tolerance, "{what}: {found} is not {wanted}: {:e}", found - wanted);
    }
}

const PI: f64 = std::f64::consts::PI;

#[test]
fn an_oscillator_passes_zero_on_time_a_thousand_times() {
    let rows = event("zero", "when = \"q.q\"");
    let end = 1001.0 * PI - 1.0;
    for rtol in [1e-7, 1e-9] {
        let run = done(&oscillator(&rows, end, &format!("rtol = {rtol:e}")));
        let wanted: Vec<f64> = (0..1001).map(|k| (f64::from(k) + 0.5) * PI).filter(|t| *t < end).collect();
        assert!(wanted.len() >= 1000);
        let (t, q) = (run.at(0, "t"), run.at(0, "q.q"));
        // The phase grows with every step.
        near(&t, &wanted, 300.0 * rtol * end, "zero");
        near(&q, &vec![0.0; q.len()], 1e-12, "q");
        let v: Vec<f64> = run.at(0, "v.q").iter().map(|v| v.abs()).collect();
        near(&v, &vec![1.0; v.len()], 300.0 * rtol * end, "v");
    }
}

/// No law is asked for what only the motion tells.
#[test]
fn strokes_and_rates_of_elements_alone() {
    let text = event("half", "when = \"e.stroke - 0.5\"") + &event("still", "when = \"e.rate\"");
    let run = done(&oscillator(&text, 6.0, "rtol = 1e-9"));
    near(&run.at(0, "t"), &[PI / 3.0, 5.0 * PI / 3.0], 1e-7, "half");
    near(&run.at(1, "t"), &[PI], 1e-7, "still");
}

#[test]
fn directions_and_the_start() {
    let text = [
        event("rises", "when = \"v.q\"\ndirection = \"rising\""),
        event("falls", "when = \"v.q\"\ndirection = \"falling\""),
        event("both", "when = \"v.q\""),
        event("height", "when = \"q.q-0.5\"\ndirection = \"falling\""),
        event("one", "when = \"q.q - 1\""),
    ]
    .concat();
    for solver in ["rtol = 1e-9", "method = \"midpoint\"\nstep = 1e-3"] {
        let run = done(&oscillator(&text, 10.0, solver));
        // v is 0 at the start, which is no event, and then negative.
        near(&run.at(0, "t"), &[PI, 3.0 * PI], 2e-6, "rises");
        near(&run.at(1, "t"), &[2.0 * PI], 2e-6, "falls");
        near(&run.at(2, "t"), &[PI, 2.0 * PI, 3.0 * PI], 2e-6, "both");
        near(&run.at(3, "t"), &[PI / 3.0, PI / 3.0 + 2.0 * PI], 2e-6, "height");
        // It comes back to where it started and does not pass it.
        assert!(run.at(4, "t").len().is_multiple_of(2), "{:?}", run.at(4, "t"));
        assert!(run.kept.events.windows(2).all(|pair| pair[0].1[0] <= pair[1].1[0]), "not in order");
    }
}

#[test]
fn events_that_are_recorded_change_no_bit() {
    let with = done(&oscillator(&event("zero", "when = \"sin(3*t)*q.q\""), 20.0, "rtol = 1e-8"));
    let without = done(&oscillator("", 20.0, "rtol = 1e-8"));
    assert!(!with.kept.events.is_empty());
    assert_eq!((with.kept.rows, with.report), (without.kept.rows, without.report));
}

#[test]
fn a_stop_ends_the_run_where_it_happens() {
    for (solver, tolerance) in [("rtol = 1e-10", 1e-9), ("method = \"midpoint\"\nstep = 1e-3", 1e-6)] {
        let text = event("low", "when = \"q.q + 0.5\"\naction = \"stop\"") + &event("zero", "when = \"q.q\"");
        let run = done(&oscillator(&text, 10.0, solver));
        let t = 2.0 * PI / 3.0;
        near(&run.at(0, "t"), &[t], tolerance, "low");
        near(&run.at(1, "t"), &[0.5 * PI], tolerance, "zero");
        let rows = run.column("t");
        assert_eq!(rows[..5], [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!((rows.len(), rows.last().copied()), (6, run.report.t_reached));
        near(&[run.report.t_reached.unwrap()], &[t], tolerance, "reached");
        assert_eq!(run.kept.rows.last(), run.kept.events.last().map(|(_, row)| row));
    }
}

/// A free mass of 2 kg.
fn mass(motion: &str, events: &str, end: f64, solver: &str) -> String {
    let body = "joint = { name = \"q\", kind = \"prismatic\", axis = [1, 0, 0] }, mass = 2";
    format!(
        "[robot]\ngravity = [0, 0, 0]\nbody = [{{ name = \"m\", {body} }}]\n[motion]\nkind = \"forward\"\n{motion}\n{events}\n\
         [time]\nend = {end}\noutput_step = 0.1\n[solver]\n{solver}\n"
    )
}

#[test]
fn a_force_that_is_switched_at_a_place() {
    // 4 N up to x = 1 at t = 1, then -4 N; back at x = 1 at t = 3.
    let events = event("brake", "when = \"q.q - 1\"\naction = { set = { \"tau.q\" = -4 } }")
        + &event("turn", "when = \"v.q\"\naction = \"record\"");
    for solver in ["rtol = 1e-10", "method = \"midpoint\"\nstep = 1e-2"] {
        let run = done(&mass("torque = { q = \"4\" }", &events, 4.0, solver));
        near(&run.at(0, "t"), &[1.0, 3.0], 1e-9, "brake");
        near(&run.at(0, "tau.q"), &[4.0, -4.0], 0.0, "force before");
        near(&run.at(1, "t"), &[2.0], 1e-9, "turn");
        near(&run.at(1, "q.q"), &[2.0], 1e-9, "turning point");
        for (t, q) in run.column("t").iter().zip(run.column("q.q")) {
            let wanted = if *t < 1.0 { t * t } else { 2.0 - (t - 2.0) * (t - 2.0) };
            assert!((q - wanted).abs() < 1e-9, "q({t}) = {q}, not {wanted}");
        }
        assert!(run.residual() < 1e-9, "{:e}", run.residual());
    }
}

#[test]
fn a_set_leaves_the_memory_alone() {
    // The same switch as a signal of time: its bits differ, since steps do.
    let strut = "law = \"magnetorheological\"\nparameters = { E_c = 20, mu_0 = 5, mu = 3, alpha = 0.6 }\ninputs = { u = INPUT }";
    let arm = |input: &str, events: &str| {
        slider("1", -2.0, &strut.replace("INPUT", input), &state("0.1", "0")) + events + &every(4.0, 0.05, 1e-9)
    };
    let events = event("on", "when = \"t - 1.31\"\naction = { set = { \"e.u\" = \"3 V\" } }")
        + &event("off", "when = \"t - 2.62\"\naction = { set = { \"e.u\" = 0.5 } }");
    let set = done(&arm("1", &events));
    let signal = done(&arm("\"1 + 2*step(t - 1.31) - 2.5*step(t - 2.62)\"", ""));
    near(&set.at(0, "t"), &[1.31], 1e-15, "on");
    near(&set.at(1, "t"), &[2.62], 1e-15, "off");
    assert_eq!((set.at(0, "e.u"), set.at(1, "e.u")), (vec![1.0], vec![3.0]));
    for column in ["q.q", "v.q", "e.derivative", "e.force", "e.stored", "e.dissipated", "e.input"] {
        let (a, b) = (set.column(column), signal.column(column));
        let size = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let off = a.iter().zip(&b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(off <= 3e-8 * size, "{column}: {off:e} of {size:e}");
    }
    assert!(set.residual() < 1e-8, "{:e}", set.residual());
}

#[test]
fn several_events_at_one_time_come_in_their_order() {
    let events = event("c", "when = \"q.q - 1\"\naction = { set = { \"tau.q\" = 0 } }")
        + &event("b", "when = \"2*q.q - 2\"")
        + &event("a", "when = \"1 - q.q\"\naction = { set = { \"tau.q\" = 6 } }")
        + &event("rising", "when = \"1 - q.q\"\ndirection = \"rising\"");
    let run = done(&mass("torque = { q = \"4\" }", &events, 1.5, "rtol = 1e-9"));
    let numbers: Vec<usize> = run.kept.events.iter().map(|(k, _)| *k).collect();
    assert_eq!(numbers, [0, 1, 2]);
    let times: Vec<f64> = run.kept.events.iter().map(|(_, row)| row[0]).collect();
    assert!(times.iter().all(|t| *t == times[0]));
    // The last one holds: 3 m/s² from v = 2 m/s.
    near(&[*run.column("v.q").last().unwrap()], &[2.0 + 3.0 * 0.5], 1e-9, "v");
}

#[test]
fn what_jumps_through_zero_happens_then() {
    let events = event("signal", "when = \"tau.q - 2\"\naction = \"record\"")
        + &event("first", "when = \"t - 2\"\naction = { set = { \"tau.q\" = -1 } }")
        + &event("second", "when = \"tau.q\"\ndirection = \"falling\"\naction = { set = { \"tau.q\" = 8 } }");
    let run = done(&mass("torque = { q = \"1 + 2*step(t - 1)\" }", &events, 3.0, "rtol = 1e-9"));
    // Up by the signal, down by the first event, up by the second.
    near(&run.at(0, "t"), &[1.0, 2.0, 2.0], 1e-12, "signal");
    near(&run.at(2, "t"), &[2.0], 1e-12, "second");
    near(&[*run.column("a.q").last().unwrap()], &[4.0], 1e-9, "a");
}

#[test]
fn events_without_end_are_told() {
    let events = event("up", "when = \"tau.q - 1\"\ndirection = \"rising\"\naction = { set = { \"tau.q\" = -3 } }")
        + &event("down", "when = \"tau.q + 1\"\ndirection = \"falling\"\naction = { set = { \"tau.q\" = 3 } }");
    let run = try_run(&mass("torque = { q = \"2*t\" }", &events, 3.0, "rtol = 1e-9"), false);
    let error = run.error.expect("no end").to_string();
    assert!(error.contains("event \"") && error.contains("again and again"), "{error}");
}

#[test]
fn going_on_keeps_every_bit() {
    let motion = "torque = { q1 = \"2*sign(sin(9*t))\", q2 = \"abs(sin(5*t))\" }";
    let text = format!("{ARM}{}\n[motion]\nkind = \"forward\"\n{motion}\n", thermoviscoelastic(0.5, 25.0, "caputo"))
        + &event("zero", "when = \"q.q1 - 0.002\"\naction = { set = { \"tau.q1\" = 3 } }")
        + &event("back", "when = \"v.q2\"\naction = { set = { \"strut.T\" = \"60 degC\", \"tau.q2\" = -1 } }")
        + &event("row", "when = \"sin(17*t) - 0.5 + q.q1\"");
    for solver in ["rtol = 1e-6", "method = \"midpoint\"\nstep = 0.002"] {
        let text = format!("{text}\n[time]\nend = 0.6\noutput_step = 0.017\n[solver]\n{solver}\n");
        let run = try_run(&text, true);
        assert!(run.error.is_none(), "{:?}", run.error);
        let numbers: Vec<usize> = run.kept.events.iter().map(|(k, _)| *k).collect();
        assert!((0..3).all(|k| numbers.contains(&k)), "{numbers:?}");
        let plan = plan(&text);
        for (state, seen) in run.kept.states.iter().step_by(7) {
            let (written, mut rest) = (state.rows(), Kept::default());
            let (report, outcome) = resume(&plan.system(), &plan.settings, state.clone(), &mut rest, &Stop::new(false));
            assert!(outcome.is_ok(), "{outcome:?}");
            assert_eq!(report, run.report);
            assert!(rest.rows == run.kept.rows[written..] && rest.events == run.kept.events[*seen..]);
        }
    }
}

/// When events happen in a simulation that is driven to its end, and what it says of a stop.
fn driven(robot: &mut Simulation) -> (Vec<(String, f64)>, Option<String>) {
    let mut passed = Vec::new();
    while robot.step().unwrap() {
        passed.extend(robot.passed().map(|(event, t)| (event.name.clone(), t)));
    }
    assert!(!robot.step().unwrap());
    (passed, robot.stopped_by().map(|event| event.name.clone()))
}

#[test]
fn simulations_have_the_events_of_runs() {
    let motion = "torque = { q1 = \"2*sign(sin(9*t))\", q2 = \"abs(sin(5*t))\" }";
    let text = format!("{ARM}{}\n[motion]\nkind = \"forward\"\n{motion}\n", thermoviscoelastic(0.5, 25.0, "caputo"))
        + &event("zero", "when = \"q.q1 - 0.002\"\naction = { set = { \"tau.q1\" = 3 } }")
        + &event("back", "when = \"v.q2\"\naction = { set = { \"strut.T\" = \"60 degC\", \"tau.q2\" = -1 } }")
        + &event("row", "when = \"sin(17*t) - 0.5 + q.q1\"")
        + &event("late", "when = \"t - 0.45 + 0.01*q.q1\"\naction = \"stop\"");
    for (solver, ends) in [("rtol = 1e-8", 0.6), ("method = \"midpoint\"\nstep = 0.002", 0.6), ("rtol = 1e-8", 0.2)] {
        // Rows so dense that no step ends on one.
        let text = format!("{text}\n[time]\nend = {ends}\noutput_step = 1e-4\n[solver]\n{solver}\n");
        let run = done(&text);
        let plan = plan(&text);
        let names: Vec<_> = plan.events.iter().map(|event| event.event.name.clone()).collect();
        let wanted: Vec<_> = run.kept.events.iter().map(|(k, row)| (names[*k].clone(), row[0])).collect();
        let mut robot = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
        robot.step_to(0.01).unwrap();
        let before = robot.state().unwrap();
        let mut robot = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
        let (passed, stopped) = driven(&mut robot);
        near(&[robot.t()], &[run.report.t_reached.unwrap()], 1e-12, "reached");
        assert_eq!(stopped.is_some(), ends > 0.5, "{stopped:?}");
        let of = |events: &[(String, f64)]| -> (Vec<_>, Vec<_>) { events.iter().cloned().unzip() };
        let ((names, times), (wanted_names, wanted_times)) = (of(&passed), of(&wanted));
        assert_eq!(names, wanted_names, "{solver}");
        near(&times, &wanted_times, 1e-12, solver);
        let t = robot.t();
        robot.set_state(&before).unwrap();
        assert_eq!(robot.stopped_by(), None);
        let (again, _) = driven(&mut robot);
        robot.set_state(&before).unwrap();
        assert_eq!((driven(&mut robot).0, robot.t()), (again, robot.t()));
        assert!((robot.t() - t).abs() < 1e-6);
    }
}

#[test]
fn what_an_event_sets_holds_until_somebody_else_does() {
    // 4 N until x = 1 at t = 1, then -4 N, and 1 N more from t = 1.5 on.
    let events = event("brake", "when = \"q.q - 1\"\ndirection = \"rising\"\naction = { set = { \"tau.q\" = -4 } }");
    let plan = plan(&mass("torque = { q = \"4\" }", &events, 4.0, "rtol = 1e-10"));
    let mut robot = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
    robot.step_to(1.5).unwrap();
    assert!((robot.v()[0] - 1.0).abs() < 1e-9, "{}", robot.v()[0]);
    robot.set_torque(0, 1.0).unwrap();
    robot.step_to(2.5).unwrap();
    assert!((robot.v()[0] + 0.5).abs() < 1e-9, "{}", robot.v()[0]);
    // A step that ends where an event acts can be looked into before it does.
    let mut robot = Simulation::new(plan.system(), plan.settings).unwrap();
    while robot.passed().next().is_none() {
        robot.step().unwrap();
    }
    assert!((robot.t() - 1.0).abs() < 1e-9 && robot.t_before() < robot.t());
    let middle = 0.5 * (robot.t() + robot.t_before());
    assert_eq!(robot.interpolate(middle).unwrap().t(), middle);
}

#[test]
fn what_somebody_sets_makes_events_happen() {
    let events = event("pushed", "when = \"tau.q - 1\"\ndirection = \"rising\"\naction = \"stop\"");
    let plan = plan(&mass("torque = { q = 0 }", &events, 4.0, "rtol = 1e-10"));
    for looks in [false, true] {
        let mut robot = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
        robot.step_to(1.5).unwrap();
        robot.set_torque(0, 2.0).unwrap();
        if looks {
            assert_eq!(robot.snapshot().unwrap().t(), 1.5);
        }
        assert!(!robot.step().unwrap(), "{looks}");
        assert_eq!(robot.stopped_by().map(|event| &*event.name), Some("pushed"));
        assert_eq!((robot.t(), robot.v()[0]), (1.5, 0.0));
    }
}

#[test]
fn a_switch_with_a_gap_acts_once_each_time() {
    // Steps far longer than the last bits of their times.
    let events = event("low", "when = \"q.q + 0.1\"\ndirection = \"falling\"\naction = { set = { \"tau.q\" = 3 } }")
        + &event("high", "when = \"q.q - 0.1\"\ndirection = \"rising\"\naction = { set = { \"tau.q\" = -3 } }");
    let run = done(&mass("torque = { q = 3 }", &events, 60.0, "rtol = 1e-6"));
    let numbers: Vec<usize> = run.kept.events.iter().map(|(k, _)| *k).collect();
    assert!(numbers.len() > 15, "{numbers:?}");
    assert!(numbers.iter().enumerate().all(|(k, number)| (k + 1) % 2 == *number), "{numbers:?}");
}

/// What hangs on t alone is known before the run: no pulse is too narrow, no wave too fast, moving or at rest.
#[test]
fn events_of_time_are_all_found() {
    let text = std::fs::read_to_string("../../testdata/silent/event_pulse_of_time.toml").unwrap();
    near(&done(&text).at(0, "t"), &[31.399_95, 31.400_05], 1e-12, "pulse");
    let rest = |when: &str, end: f64| {
        let law = "law = \"spring\"\nparameters = { k = 1 }";
        let times = format!("\n[time]\nend = {end}\noutput_step = {end}\n");
        slider("1", 0.0, law, &state("0", "0")) + &event("e", &format!("when = \"{when}\"")) + &times
    };
    let waves = done(&rest("sin(200*t)", 60.0)).at(0, "t");
    let wanted: Vec<f64> = (1..=3819).map(|k| f64::from(k) * PI / 200.0).collect();
    near(&waves, &wanted, 1e-13 * 60.0, "waves");
    for (when, count) in [
        ("sin(2000*t)", 1273),
        // Beside a state, which rests or moves.
        ("sin(200*t) + 0*q.q", 127),
        ("sin(200*t) + 0.1*q.q", 127),
        ("max(0, 1 - abs(t - 1.4)/1e-5) - 0.5 + q.q", 2),
        ("step(t - 1.4) - step(t - 1.4000001) - 0.5 + 0*v.q", 2),
        ("q.q + 2*step(t - 1) - 1", 1),
    ] {
        assert_eq!(done(&rest(when, 2.0)).at(0, "t").len(), count, "{when}");
    }
    let moving =
        |when: &str| done(&oscillator(&event("e", &format!("when = \"{when}\"")), 2.0, "rtol = 1e-9")).at(0, "t");
    // cos t against fast waves: each of these crosses it once in every half turn.
    assert_eq!(moving("2*sin(2000*t) - q.q").len(), 1274);
    near(&moving("step(t - 1.4) - 0.5 + 0*q.q"), &[1.4], 1e-15, "jump");
}

/// Functions of t that act end steps on time, also where a signal has its kink, and several at one time.
#[test]
fn events_of_time_act_on_time() {
    let text = [
        event("on", "when = \"max(0, 1 - abs(t - 1)/1e-4) - 0.5\"\ndirection = \"rising\"\naction = { set = { \"tau.q\" = 2 } }"),
        event("off", "when = \"step(t - 2) - 0.5\"\naction = { set = { \"tau.q\" = 0 } }"),
        event("too", "when = \"step(t - 2) - 0.25\""),
        event("end", "when = \"t - 3\"\naction = \"stop\""),
    ]
    .concat();
    for solver in ["rtol = 1e-10", "method = \"midpoint\"\nstep = 1e-2"] {
        let run = done(&mass("torque = { q = \"0.5*step(t - 2)\" }", &text, 4.0, solver));
        near(&run.at(0, "t"), &[0.999_95], 1e-12, "on");
        near(&run.at(1, "t"), &[2.0], 1e-12, "off");
        near(&run.at(2, "t"), &[2.0], 1e-12, "too");
        near(&[run.report.t_reached.unwrap()], &[3.0], 1e-12, "end");
        let speed = *run.column("v.q").last().unwrap();
        near(&[speed], &[2.0 - 0.999_95], 1e-9, "speed");
    }
    let states = try_run(&mass("torque = { q = \"1\" }", &text, 4.0, "rtol = 1e-9"), true).kept;
    for (state, told) in states.states.into_iter().step_by(7) {
        let plan = plan(&mass("torque = { q = \"1\" }", &text, 4.0, "rtol = 1e-9"));
        let mut rest = Kept::default();
        resume(&plan.system(), &plan.settings, state, &mut rest, &Stop::new(false)).1.unwrap();
        assert_eq!(rest.events, states.events[told..]);
    }
}

#[test]
fn a_function_of_time_that_passes_zero_too_often_is_refused() {
    let text = mass("torque = { q = \"1\" }", &event("e", "when = \"sin(1e9*t)\""), 4.0, "rtol = 1e-9");
    let error = try_run(&text, false).error;
    assert!(matches!(&error, Some(RunError::TooBusy { what, .. }) if what.contains("\"e\"")), "{error:?}");
    let error = try_run(&text.replace("sin(1e9*t)", "log(t - 1)"), false).error;
    assert!(matches!(error, Some(RunError::NotFinite { .. })), "{error:?}");
}

/// A mass bounces on a pad that does not stick to it: meeting it is an event each time, and so is letting go.
#[test]
fn a_force_that_rests_passes_zero_where_it_comes_and_goes() {
    let (k, g, height) = (1000.0f64, 9.81f64, 0.1f64);
    let law = "network = \"series(compression(k), spring(k))\"\nparameters = { k = 2000 }";
    let events = event("all", "when = \"e.force\"")
        + &event("meets", "when = \"e.force\"\ndirection = \"falling\"")
        + &event("leaves", "when = \"e.force\"\ndirection = \"rising\"");
    let text = slider("1", -g, law, &state("0.1", "0")) + &events + &every(1.5, 0.01, 1e-10);
    let run = done(&text);
    // tan(θ/2) = -v ω/g of the angle θ for which it stays on the pad, from the speed v at which it comes.
    let (speed, omega) = ((2.0 * g * height).sqrt(), k.sqrt());
    let [falls, stays] = [speed / g, 2.0 / omega * (PI - (speed * omega / g).atan())];
    let meets: Vec<f64> = (0..10).map(|n| falls + f64::from(n) * (2.0 * falls + stays)).filter(|t| *t < 1.5).collect();
    let leaves: Vec<f64> = meets.iter().map(|t| t + stays).filter(|t| *t < 1.5).collect();
    assert!(meets.len() > 3);
    near(&run.at(1, "t"), &meets, 1e-8, "meets");
    near(&run.at(2, "t"), &leaves, 1e-8, "leaves");
    assert_eq!(run.at(0, "t").len(), meets.len() + leaves.len());
    // In a Simulation that an event ends as well.
    let stops = text.replace("name = \"leaves\"", "name = \"leaves\"\naction = \"stop\"");
    near(&[*done(&stops).column("t").last().unwrap()], &leaves[..1], 1e-8, "stops");
}
