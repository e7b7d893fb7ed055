//! Robots that move by themselves, from texts, in fixed steps and with error control.

use springpot::law::Catalog;
use springpot::scenario::Scenario;
use springpot::simulate::fixed::{Loop, MemorySettings, Method};
use springpot::simulate::{FixedStep, Report, RowTimes, RunError, Settings, Stop, System, run};

pub(crate) const METHODS: [Method; 2] = [Method::BackwardEuler, Method::Midpoint];

/// The three-body arm of the papers, falling under gravity; `more` holds elements and the rest.
pub(crate) fn arm(more: &str) -> String {
    format!(
        r#"
[[robot.body]]
name = "column"
joint = {{ name = "q1", kind = "revolute", axis = [0, 0, 1], origin = [0, 0, 0] }}
mass = 6.0
com = [0.02, 0.0, 0.3]
inertia = {{ xx = 0.20, yy = 0.20, zz = 0.06, xz = 0.01 }}
[[robot.body]]
name = "upper_arm"
joint = {{ name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.6] }}
mass = 3.0
com = [0.25, 0.01, 0.02]
inertia = {{ xx = 0.01, yy = 0.07, zz = 0.07, xy = 0.001, yz = 0.0005 }}
[[robot.body]]
name = "forearm"
joint = {{ name = "q3", kind = "revolute", axis = [0, 1, 0], origin = [0.5, 0, 0] }}
mass = 2.0
com = [0.18, -0.01, 0.01]
inertia = {{ xx = 0.006, yy = 0.03, zz = 0.03, xz = -0.001, yz = 0.0004 }}
{more}"#
    )
}

/// The arm's strut; `law` is the rest of its table.
pub(crate) fn strut(law: &str) -> String {
    format!(
        r#"
[[element]]
name = "strut"
from = {{ body = "column", point = [0.14, -0.1, 0.08] }}
to = {{ body = "forearm", point = [-0.06, 0.1, 0.08] }}
rest_length = "70 cm"
{law}
"#
    )
}

/// The thermoviscoelastic strut of the first paper.
pub(crate) fn thermoviscoelastic(alpha: f64, derivative: &str) -> String {
    strut(&format!(
        r#"law = "thermoviscoelastic"
parameters = {{ E_c = "30 N/m", E_kv = "20 N/m", E_d = "50 N*s^alpha/m", alpha = {alpha}, a_kv = "0.0007 m/K" }}
inputs = {{ T = "25 degC" }}
derivative = "{derivative}""#
    ))
}

/// A free motion of 1 s, which tests cut where they want.
pub(crate) fn free(start: &str) -> String {
    format!("[motion]\nkind = \"forward\"\n{start}\n[time]\nend = 1\noutput_step = 0.1\n")
}

/// The system of a scenario.
pub(crate) fn system(text: &str) -> System {
    let scenario = Scenario::parse(text, "test.toml", "").unwrap_or_else(|refusals| panic!("{refusals}\n{text}"));
    let cases = scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}\n{text}"));
    cases.plan(0).expect("a valid plan").system()
}

/// Loops of tests remember this well.
pub(crate) const MEMORY: MemorySettings = MemorySettings { tolerance: 1e-10, horizon: 100.0 };

/// A loop after `end` seconds without torque.
pub(crate) fn looped(system: &System, method: Method, step: f64, end: f64) -> Loop<'_> {
    let mut robot = Loop::new(system, method, step, MEMORY).expect("a loop");
    let still = vec![0.0; system.model.nv()];
    for _ in 0..(end / step).round() as u64 {
        robot.advance(&still).expect("a step");
    }
    robot
}

/// q and v of a loop.
pub(crate) fn state(robot: &Loop) -> Vec<f64> {
    [robot.q(), robot.v()].concat()
}

/// How runs of tests are carried out; `None`: with error control.
pub(crate) fn settings(end: f64, rows: &[f64], fixed_step: Option<FixedStep>) -> Settings {
    Settings {
        end,
        rows: RowTimes::Times(rows.into()),
        rtol: 1e-10,
        atol: None,
        memory_rtol: 1e-12,
        first_step: None,
        max_step: None,
        max_steps: None,
        fixed_step,
    }
}

/// The rows of a run, what it did and how it ended.
pub(crate) fn rows(system: &System, settings: &Settings) -> (Vec<Vec<f64>>, Report, Result<(), RunError>) {
    let mut rows = Vec::new();
    let mut keep = |row: &[f64]| -> std::io::Result<()> {
        rows.push(row.to_vec());
        Ok(())
    };
    let (report, outcome) = run(system, settings, &mut keep, &Stop::new(false));
    (rows, report, outcome)
}

/// q and v at `end` with error control, 1e-10.
pub(crate) fn truth(system: &System, end: f64) -> Vec<f64> {
    let (rows, _, outcome) = rows(system, &settings(end, &[end], None));
    outcome.expect("the adaptive run ends");
    rows[0][1..=system.model.nq() + system.model.nv()].to_vec()
}

/// Largest difference.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}
