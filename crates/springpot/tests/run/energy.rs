//! The energy ledger: it closes in every run that knows it, and only because every mode of the memory is there.

use crate::steps::graded;
use crate::support::robots::{ARM, PATH, SWING, every, magnetorheological, prescribed, springpot, thermoviscoelastic};
use crate::support::truth::{Truth, gauss_jacobi};
use crate::support::{Run, cases, largest, run, run_case, scenarios, shipped};
use serde_json::Value;
use springpot::collocation::Nodes;
use springpot::collocation::RADAU_NODES;
use springpot::fractional::gamma::gamma;
use springpot::fractional::{Form, Kind};
use springpot::law::{Catalog, Point, Power, Start, State, Step};
use std::f64::consts::PI;

/// What a run may leave of the energy turned over.
const CLOSED: f64 = 1e-7;

/// The residual in units of the energy turned over, from the columns: the report must say the same.
pub(crate) fn residual(run: &Run, elements: &[&str]) -> f64 {
    let column = |name: &str| run.column(name);
    let mut total = vec![0.0; run.rows.len()];
    let mut add = |name: &str, sign: f64| {
        total.iter_mut().zip(column(name)).for_each(|(sum, x)| *sum += sign * x);
    };
    add("energy.kinetic", 1.0);
    add("energy.potential", 1.0);
    add("energy.actuators", -1.0);
    if run.names.iter().any(|name| name == "energy.joints") {
        add("energy.joints", 1.0);
    }
    for element in elements {
        add(&format!("{element}.stored"), 1.0);
        add(&format!("{element}.dissipated"), 1.0);
        add(&format!("{element}.input"), -1.0);
    }
    let turned_over = run.report.energy_turned_over.expect("a known ledger");
    let largest_of = largest(&total.iter().map(|x| x - total[0]).collect::<Vec<_>>());
    let shown = largest(&column("energy.residual"));
    // The sum cannot be known better than its largest part.
    let rounding = 4.0 * f64::EPSILON * largest(&column("energy.potential"));
    assert!(
        (largest_of - shown).abs() <= 1e-12 * turned_over + rounding,
        "{largest_of:e} by the columns, {shown:e} shown"
    );
    assert_eq!(run.report.energy_residual, Some(shown));
    shown / turned_over
}

/// Q·v = −F x' in every row in which the force is finite.
pub(crate) fn power_balance(run: &Run, element: &str) {
    let joints = run.joints();
    let (force, rate) = (run.column(&format!("{element}.force")), run.column(&format!("{element}.rate")));
    let q: Vec<Vec<f64>> = joints.iter().map(|j| run.column(&format!("{element}.Q.{j}"))).collect();
    let v: Vec<Vec<f64>> = joints.iter().map(|j| run.column(&format!("v.{j}"))).collect();
    let mut checked = 0;
    for k in (0..run.rows.len()).filter(|k| force[*k].is_finite()) {
        let powers: Vec<f64> = (0..joints.len()).map(|j| q[j][k] * v[j][k]).collect();
        let scale = powers.iter().map(|p| p.abs()).sum::<f64>() + (force[k] * rate[k]).abs();
        let gap = powers.iter().sum::<f64>() + force[k] * rate[k];
        assert!(gap.abs() <= 1e-12 * scale, "{element}, row {k}: {gap:e} of {scale:e}");
        checked += 1;
    }
    assert!(checked + 1 >= run.rows.len());
}

/// Stored energy is not negative, dissipated energy never falls, but by rounding of what the run turns over.
pub(crate) fn second_law(run: &Run, element: &str) {
    let stored = run.column(&format!("{element}.stored"));
    assert!(stored.iter().all(|x| *x >= 0.0), "{element} stores less than nothing");
    let dissipated = run.column(&format!("{element}.dissipated"));
    assert_eq!(dissipated[0], 0.0);
    let rounding = 1e-18 * run.report.energy_turned_over.unwrap_or(0.0);
    assert!(dissipated.windows(2).all(|x| x[1] >= x[0] - rounding), "{element} gives heat back");
}

#[test]
fn every_shipped_scenario() {
    let mut files: Vec<String> =
        std::fs::read_dir(scenarios()).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    let (mut known, mut unknown) = (0, 0);
    for file in files.iter().filter(|file| file.ends_with(".toml")) {
        let cases = shipped(file, &[]);
        let mut worst = 0.0f64;
        for index in 0..cases.len() {
            let run = run_case(&cases, index);
            assert!(run.error.is_none(), "{file}, case {index}: {:?}", run.error);
            let plan = cases.plan(index).unwrap();
            let names: Vec<&str> = plan.elements.iter().map(|plan| plan.element.name.as_str()).collect();
            names.iter().for_each(|name| power_balance(&run, name));
            let starts = plan.system().element_starts().unwrap();
            let mut is_known = true;
            for (element, start) in plan.elements.iter().map(|plan| &plan.element).zip(&starts) {
                if start.singular || element.scheme.is_some() {
                    // Infinite work, or a scheme that keeps no account: nothing is shown, in any row.
                    is_known = false;
                    for column in ["stored", "dissipated"].map(|key| format!("{}.{key}", element.name)) {
                        assert!(run.column(&column).iter().all(|x| x.is_nan()), "{file}, case {index}: {column}");
                    }
                } else {
                    second_law(&run, &element.name);
                }
            }
            if !is_known {
                assert_eq!(run.report.energy_residual, None);
                assert!(run.column("energy.residual").iter().all(|x| x.is_nan()));
                unknown += 1;
                continue;
            }
            worst = worst.max(residual(&run, &names));
            assert!(worst <= CLOSED, "{file}, case {index}: {worst:.1e}");
            known += 1;
        }
        println!("{file}: {} cases, worst residual {worst:.1e}", cases.len());
    }
    println!("{known} ledgers known, {unknown} not");
    assert!(known >= 25 && unknown >= 18, "{known} {unknown}");
}

#[test]
fn every_order_both_limits_included() {
    for alpha in [0.0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999, 1.0] {
        for derivative in ["caputo", "riemann-liouville"] {
            let text = format!("{ARM}{}{SWING}{}", thermoviscoelastic(alpha, 25.0, derivative), every(10.0, 0.05));
            let run = run(&text);
            second_law(&run, "strut");
            power_balance(&run, "strut");
            let residual = residual(&run, &["strut"]);
            println!("alpha = {alpha}, {derivative}: {residual:.1e}");
            assert!(residual <= CLOSED, "alpha = {alpha}, {derivative}: {residual:.1e}");
        }
    }
}

#[test]
fn tighter_tolerances_close_it_further() {
    let with = |rtol: f64| {
        let solver = format!("\n[solver]\nrtol = {rtol:e}\n");
        let text = format!("{ARM}{}{SWING}{}{solver}", thermoviscoelastic(0.5, 25.0, "caputo"), every(5.0, 0.05));
        residual(&run(&text), &["strut"])
    };
    let residuals = [1e-5, 1e-8, 1e-11].map(with);
    println!("rtol 1e-5, 1e-8, 1e-11: {residuals:?}");
    assert!(residuals[1] < 0.3 * residuals[0] && residuals[2] < 0.3 * residuals[1], "{residuals:?}");
}

#[test]
fn a_varying_coefficient_exchanges_energy_with_its_input() {
    for alpha in [0.0, 0.1, 0.5, 0.9, 1.0] {
        let with = |u: &str| {
            let element = magnetorheological(alpha, "caputo").replace("u = \"1 V\"", &format!("u = \"{u}\""));
            run(&format!("{ARM}{element}{}{}", prescribed("0.1*sin(8*t)", "0.1*t"), every(3.0, 0.02)))
        };
        let (varying, constant) = (with("1 + 0.9*sin(7*t)"), with("1 V"));
        let left = residual(&varying, &["strut"]);
        println!("u(t), alpha = {alpha}: {left:.1e}");
        assert!(left <= CLOSED, "alpha = {alpha}: {left:.1e}");
        second_law(&varying, "strut");
        // A constant voltage supplies nothing, a varying one supplies as long as anything is stored.
        assert!(constant.column("strut.input").iter().all(|x| *x == 0.0));
        let supplied = largest(&varying.column("strut.input"));
        if alpha < 1.0 {
            assert!(supplied > 1e-3 * largest(&varying.column("strut.stored")), "alpha = {alpha}: {supplied:e}");
        } else {
            assert_eq!(supplied, 0.0);
        }
    }
}

/// One mass on a rail, its element to the world along the rail: x = q.
const SLIDER: &str = r#"
[[robot.body]]
name = "slider"
joint = { name = "q", kind = "prismatic", axis = [1, 0, 0] }
mass = 2.0
[[element]]
name = "e"
from = { body = "world", point = [-1, 0, 0] }
to = { body = "slider", point = [0, 0, 0] }
rest_length = 1
"#;

fn slider(law: &str, q: &str, time: &str) -> Run {
    run(&format!("{SLIDER}{law}\n[motion]\nkind = \"prescribed\"\njoints = {{ q = \"{q}\" }}\n{time}"))
}

#[test]
fn harmonic_steady_state() {
    // x = X sin ωt: ⟨stored⟩ = E' X²/4, ⟨dissipation⟩ = ω E'' X²/2 with E* = c (iω)^alpha.
    let (omega, size, c): (f64, f64, f64) = (4.0, 0.05, 30.0);
    for alpha in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let periods = 40;
        let end = f64::from(periods) * 2.0 * PI / omega;
        let per_period = 50;
        let law = format!("law = \"springpot\"\nparameters = {{ c = {c}, alpha = {alpha} }}");
        let time = format!(
            "[time]\nend = {end:?}\noutput_step = {:?}\n[solver]\nrtol = 1e-7\n",
            2.0 * PI / omega / f64::from(per_period)
        );
        let run = slider(&law, &format!("{size}*sin({omega}*t)"), &time);
        let rows = (periods * per_period) as usize;
        assert_eq!(run.rows.len(), rows + 1);
        let last = rows - 10 * per_period as usize..rows;
        let stored = run.column("e.stored");
        let mean = stored[last.clone()].iter().sum::<f64>() / last.len() as f64;
        let dissipated = run.column("e.dissipated");
        let power = (dissipated[last.end] - dissipated[last.start]) / (20.0 * PI / omega);
        let modulus = c * omega.powf(alpha);
        let (storage, loss) = (modulus * (0.5 * PI * alpha).cos(), modulus * (0.5 * PI * alpha).sin());
        let (wanted, wanted_power) = (0.25 * storage * size * size, 0.5 * omega * loss * size * size);
        let errors = [(mean / wanted - 1.0).abs(), (power / wanted_power - 1.0).abs()];
        println!("alpha = {alpha}: stored {mean:.6e} ({:.1e}), power {power:.6e} ({:.1e})", errors[0], errors[1]);
        // What is left of the start fades like t^{−1−alpha}.
        assert!(errors.iter().all(|e| *e < 1e-3), "alpha = {alpha}: {errors:?}");
    }
}

#[test]
fn classical_limits() {
    // q = 0.2 + 0.1 sin 3t, so that x(0) = 0.2.
    let motion = "0.2 + 0.1*sin(3*t)";
    let time = every(2.0, 0.1);
    let law = |alpha: f64, derivative: &str| {
        format!("law = \"springpot\"\nparameters = {{ c = 7, alpha = {alpha} }}\nderivative = \"{derivative}\"")
    };
    for (derivative, held) in [("caputo", 0.2), ("riemann-liouville", 0.0)] {
        let spring = slider(&law(0.0, derivative), motion, &time);
        let dashpot = slider(&law(1.0, derivative), motion, &time);
        for (k, t) in spring.t().into_iter().enumerate() {
            let x = 0.2 + 0.1 * (3.0 * t).sin() - held;
            let stored = spring.column("e.stored")[k];
            assert!((stored - 3.5 * x * x).abs() < 1e-14, "{derivative}, t = {t}: {stored}");
            assert_eq!(spring.column("e.dissipated")[k], 0.0);
            assert_eq!(dashpot.column("e.stored")[k], 0.0);
            // ∫ c (0.3 cos 3s)² ds = c·0.09 (t/2 + sin(6t)/12)
            let wanted = 7.0 * 0.09 * (0.5 * t + (6.0 * t).sin() / 12.0);
            let dissipated = dashpot.column("e.dissipated")[k];
            assert!((dissipated - wanted).abs() < 1e-9, "t = {t}: {dissipated}, not {wanted}");
        }
        for run in [&spring, &dashpot] {
            assert!(residual(run, &["e"]) <= CLOSED);
        }
    }
}

#[test]
fn order_near_one_and_zero_tend_to_the_limits() {
    let law = |alpha: f64| format!("law = \"springpot\"\nparameters = {{ c = 7, alpha = {alpha} }}");
    let ends = |alpha: f64| {
        let run = slider(&law(alpha), "0.1*sin(3*t)", &every(2.0, 0.1));
        (*run.column("e.stored").last().unwrap(), *run.column("e.dissipated").last().unwrap())
    };
    for (limit, sign) in [(0.0, 1.0), (1.0, -1.0)] {
        let whole = ends(limit);
        let gap = |distance: f64| {
            let (stored, dissipated) = ends(limit + sign * distance);
            (stored - whole.0).abs() + (dissipated - whole.1).abs()
        };
        let (near, nearer) = (gap(1e-2), gap(1e-3));
        println!("alpha -> {limit}: {near:.2e} {nearer:.2e}");
        assert!((near / nearer - 10.0).abs() < 2.0, "alpha -> {limit}: {near:.2e} {nearer:.2e}");
    }
}

#[test]
fn joint_damping_and_friction() {
    let damped = ARM
        .replace("name = \"q2\",", "name = \"q2\", damping = \"0.1 N*m*s/rad\", friction = \"0.2 N*m\",")
        .replace("name = \"q3\",", "name = \"q3\", damping = 0.05,");
    for motion in [SWING.to_owned(), prescribed("0.3*sin(2*t)", "0.2*cos(3*t)")] {
        let with = |arm: &str| run(&format!("{arm}{}{motion}{}", springpot(0.5, "caputo"), every(3.0, 0.02)));
        let (run, frictionless) = (with(&damped), with(ARM));
        let left = residual(&run, &["strut"]);
        println!("joint losses: residual {left:.1e}");
        assert!(left <= CLOSED, "{left:.1e}");
        // ∫ d v² + f v tanh(v/1e-3) dt by Gauss–Legendre on short panels.
        let plan = cases(&format!("{damped}{}{motion}{}", springpot(0.5, "caputo"), every(3.0, 0.02))).plan(0).unwrap();
        let system = plan.system();
        let loss = |t: f64| {
            let v = system.state(t).unwrap().v;
            0.1 * v[1] * v[1] + 0.2 * v[1] * (v[1] / 1e-3).tanh() + 0.05 * v[2] * v[2]
        };
        let panels = 60_000;
        let rule = gauss_jacobi(4, 0.0);
        let width = 3.0 / f64::from(panels);
        let panel =
            |k: i32| rule.iter().map(|(x, w)| 0.5 * width * w * loss((f64::from(k) + 0.5 + 0.5 * x) * width)).sum();
        let wanted: f64 = (0..panels).map(panel).collect::<Vec<f64>>().iter().sum();
        let joints = run.column("energy.joints");
        assert!(joints.windows(2).all(|x| x[1] >= x[0]));
        let turned_over = run.report.energy_turned_over.unwrap();
        let error = (joints.last().unwrap() - wanted).abs();
        assert!(error < CLOSED * turned_over, "{} J lost, not {wanted} J: {error:e}", joints.last().unwrap());
        // The actuators pay for it, and nothing else changes.
        let extra =
            run.column("energy.actuators").last().unwrap() - frictionless.column("energy.actuators").last().unwrap();
        assert!((extra - wanted).abs() < CLOSED * turned_over, "{extra} J for {wanted} J");
        assert!(frictionless.names.iter().all(|name| name != "energy.joints"));
    }
}

#[test]
fn singular_starts_have_no_ledger() {
    let singular = run(&format!("{ARM}{}{PATH}{}", magnetorheological(0.5, "riemann-liouville"), every(2.0, 0.1)));
    for column in ["strut.stored", "strut.dissipated", "energy.residual"] {
        assert!(singular.column(column).iter().all(|x| x.is_nan()), "{column}");
    }
    assert_eq!((singular.report.energy_residual, singular.report.energy_turned_over), (None, None));
    for column in ["strut.derivative", "strut.force", "strut.Q.q2", "tau.q2"] {
        let values = singular.column(column);
        assert!(values[0].is_nan() && values[1..].iter().all(|x| x.is_finite()), "{column}");
    }
    // x(0) = 0 within rounding is no jump: the ledger is there.
    let quiet = run(&format!("{ARM}{}{SWING}{}", thermoviscoelastic(0.5, 25.0, "riemann-liouville"), every(2.0, 0.1)));
    assert!(residual(&quiet, &["strut"]) <= CLOSED);
}

/// Work done on a unit springpot by the forces it answers with, less what it stores and dissipates, in units of the work.
/// `edit` may change the state, written as JSON, before step `at`.
fn work_less_ledger(alpha: f64, at: usize, edit: &dyn Fn(&mut Value)) -> f64 {
    let entry = Catalog::standard();
    let law = entry.get("springpot").unwrap().build(&[1.0, alpha], Kind::Caputo).unwrap();
    let (x, v) = (|t: f64| 0.1 * (8.0 * t).sin() + 0.05 * t, |t: f64| 0.8 * (8.0 * t).cos() + 0.05);
    // Towards t = 0 the powers are of the kind t^{1−alpha}.
    let grid = graded(2.0, 4000);
    let mut state = law.begin(&Start { stroke: 0.0, jump: 0.0, inputs: &[] }).unwrap();
    state.open(1e-11, RADAU_NODES[0] * grid[1], 2.0).unwrap();
    let (mut work, mut dissipated, mut turned_over) = (0.0, 0.0, 0.0f64);
    let mut stored_at_edit = 0.0;
    for (k, w) in grid.windows(2).enumerate() {
        let here = Point { t: w[0], stroke: x(w[0]), rate: v(w[0]), inputs: &[] };
        if k == at {
            let mut json = serde_json::to_value(&state).unwrap();
            let before = law.now(&here, &state).stored.unwrap();
            edit(&mut json);
            state = serde_json::from_value::<State>(json).unwrap();
            // What the edit takes away at once is no loss of the motion that follows.
            stored_at_edit = law.now(&here, &state).stored.unwrap() - before;
        }
        let h = w[1] - w[0];
        let points: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| w[0] + c * h).collect();
        let (stroke, rate): (Vec<f64>, Vec<f64>) = points.iter().map(|t| (x(*t), v(*t))).unzip();
        let step = Step {
            t: w[0],
            h,
            nodes: Nodes::Radau,
            places: None,
            form: Form::Rates,
            stroke: &stroke,
            rate: &rate,
            inputs: &[],
            resolution: 1e-16,
            course: springpot::law::Course::Given,
        };
        let response = law.evaluate(&step, &state);
        let weights = springpot::collocation::RADAU_WEIGHTS;
        work += (0..3).map(|i| h * weights[i] * response.force[i] * rate[i + 1]).sum::<f64>();
        dissipated += Power::integrate(&law.powers(&step, &state), Nodes::Radau, h, 1.0).dissipation;
        law.commit(&step, &mut state);
        turned_over = turned_over.max(f64::abs(work)).max(dissipated);
    }
    let end = Point { t: 2.0, stroke: x(2.0), rate: v(2.0), inputs: &[] };
    let stored = law.now(&end, &state).stored.unwrap() - stored_at_edit;
    (work - stored - dissipated).abs() / turned_over
}

/// The modes in a state of the springpot law, as JSON.
fn modes(state: &mut Value) -> &mut Value {
    &mut state["memories"][0]["past"]
}

#[test]
fn dropping_one_mode_breaks_the_balance() {
    for alpha in [0.1, 0.5, 0.9] {
        let whole = work_less_ledger(alpha, 2500, &|_| ());
        assert!(whole < 1e-11, "alpha = {alpha}: {whole:.1e}");
        // The modes whose rates the motion knows: a tenth to ten times 8 rad/s.
        let dropped: Vec<f64> = [1.0, 8.0, 50.0]
            .into_iter()
            .map(|rate: f64| {
                work_less_ledger(alpha, 2500, &|state| {
                    let modes = modes(state);
                    let lambda: Vec<f64> = serde_json::from_value(modes["kernel"]["lambda"].clone()).unwrap();
                    let k = (0..lambda.len())
                        .min_by(|a, b| (lambda[*a] / rate).ln().abs().total_cmp(&(lambda[*b] / rate).ln().abs()))
                        .unwrap();
                    modes["z"].as_array_mut().unwrap().remove(k);
                    modes["kernel"]["lambda"].as_array_mut().unwrap().remove(k);
                    modes["kernel"]["weight"].as_array_mut().unwrap().remove(k);
                })
            })
            .collect();
        println!("alpha = {alpha}: whole {whole:.1e}, without one mode {dropped:?}");
        assert!(dropped.iter().all(|residual| *residual > 100.0 * CLOSED), "alpha = {alpha}: {dropped:?}");
    }
}

#[test]
fn the_power_of_the_memory_is_the_power_of_the_true_force() {
    // ∫ F x' dt with F from quadrature: no mode takes part in this side.
    for alpha in [0.1, 0.5, 0.9] {
        let law = format!("law = \"springpot\"\nparameters = {{ c = 7, alpha = {alpha} }}");
        let run = slider(&law, "0.1*sin(3*t)", &every(2.0, 0.5));
        let truth = Truth::new(alpha, 2.0, 0.1, &[]);
        let rate = |t: f64| 0.3 * (3.0 * t).cos();
        // F ~ t^{1−alpha} at the start: panels graded towards it.
        let rule = gauss_jacobi(10, 0.0);
        let edges: Vec<f64> = (0..=40).map(|k| 2.0 * (f64::from(k) / 40.0).powi(6)).collect();
        let mut work = 0.0;
        for w in edges.windows(2) {
            let half = 0.5 * (w[1] - w[0]);
            for (x, weight) in &rule {
                let t = w[0] + half * (1.0 + x);
                work += half * weight * 7.0 * truth.caputo(t, &rate) * rate(t);
            }
        }
        let ledger = run.column("e.stored").last().unwrap() + run.column("e.dissipated").last().unwrap();
        let error = (ledger - work).abs() / run.report.energy_turned_over.unwrap();
        println!("alpha = {alpha}: stored + dissipated {ledger:.9} J, work {work:.9} J, {error:.1e}");
        assert!(error < 1e-8, "alpha = {alpha}: {error:.1e}");
    }
}

/// Rows far below the default first step, of a power that rises like t^{1−alpha}: what is stored and dissipated is the work that is done.
#[test]
fn energies_of_the_very_first_rows() {
    let terms = [(1.0, -3.0), (2.0, 1.0), (3.0, 0.02)];
    for alpha in [0.1, 0.5, 0.9] {
        let run = run(&format!(
            "[[robot.body]]\nname = \"a\"\njoint = {{ name = \"x\", kind = \"prismatic\", axis = [1, 0, 0] }}\nmass = 1\n\
             [[element]]\nname = \"s\"\njoint = \"x\"\nlaw = \"springpot\"\nparameters = {{ c = 2, alpha = {alpha} }}\nderivative = \"caputo\"\n\
             [motion]\nkind = \"prescribed\"\njoints = {{ x = \"0.02*t^3 + t^2 - 3*t\" }}\n\
             [time]\nend = 100\noutput_times = {{ from = 1e-5, to = 100, count = 29, scale = \"log\" }}\n[solver]\nrtol = 1e-9\n"
        ));
        let (stored, dissipated) = (run.column("s.stored"), run.column("s.dissipated"));
        for (k, t) in run.t().into_iter().enumerate() {
            let work = |(n, by): (f64, f64)| {
                let force = 2.0 * by * gamma(n + 1.0) / gamma(n + 1.0 - alpha);
                let own = terms.map(|(m, rate)| m * rate * t.powf(n - alpha + m) / (n - alpha + m));
                force * own.iter().sum::<f64>()
            };
            let work: f64 = terms.map(work).iter().sum();
            let error = ((stored[k] + dissipated[k]) / work - 1.0).abs();
            assert!(error < 4e-3, "{alpha} {t:e}: {error:e}");
        }
    }
}
