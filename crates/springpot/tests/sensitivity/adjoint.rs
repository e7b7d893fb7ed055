//! Gradients by going back through a run, against derivatives of every row beside it on the same steps.

use crate::support::cases;
use springpot::driver;
use springpot::observe::Quantity;
use springpot::sensitivity::{Sensitivity, Share};
use springpot::system::{RunError, Settings, Stop, System};
use std::sync::Arc;

/// How far both may be apart, in units of the sum of the sizes of what they are made of.
const KNOWN: f64 = 1e-10;

/// Rounding of changes that cancel, in units of the largest change by a typical value of any parameter.
const ROUNDING: f64 = 1e-13;

/// Quantities whose rows have derivatives, and by parameter and quantity Σ w_r ∂y_r and Σ |w_r ∂y_r|.
struct Forward {
    quantities: Vec<Quantity>,
    rows: Vec<Vec<f64>>,
    sums: Vec<Vec<[f64; 2]>>,
}

/// A weight for a row and a quantity, of either sign.
fn weight(row: usize, quantity: usize) -> f64 {
    (1.7 * row as f64 + 0.9 * quantity as f64 * quantity as f64 + 0.3).sin()
}

fn forward(system: &System, settings: &Settings, by: &Sensitivity) -> Forward {
    let mut quantities: Vec<Quantity> = by.columns.iter().map(|column| column.of).collect();
    quantities.dedup();
    let (count, mut rows) = (by.parameters.len(), Vec::new());
    let mut keep = |row: &[f64]| {
        rows.push(row.to_vec());
        Ok(())
    };
    let (_, outcome) = driver::run(system, settings, &mut keep, &Stop::new(false));
    outcome.unwrap();
    let mut sums = vec![vec![[0.0; 2]; quantities.len()]; count];
    for (r, row) in rows.iter().enumerate() {
        let changes = &row[row.len() - by.columns.len()..];
        for (column, change) in by.columns.iter().zip(changes) {
            let k = quantities.iter().position(|of| *of == column.of).unwrap();
            if change.is_finite() {
                let [sum, size] = &mut sums[column.by][k];
                *sum += weight(r, k) * change;
                *size += (weight(r, k) * change).abs();
            }
        }
    }
    let plain = rows.iter().map(|row| row[..row.len() - by.columns.len()].to_vec()).collect();
    Forward { quantities, rows: plain, sums }
}

/// The scenario's own derivatives, forwards and backwards; how much is kept to go back, bytes.
fn compare(what: &str, text: &str) -> Result<usize, RunError> {
    let plan = cases(text).plan(0).unwrap();
    let mut system = plan.system();
    let by = Sensitivity { control: false, ..Sensitivity::clone(system.sensitivity.as_ref().expect("some asked for")) };
    system.sensitivity = Some(Arc::new(by.clone()));
    let mut back = system.clone();
    let forward = forward(&system, &plan.settings, &by);
    let adjoint = Some(forward.quantities.clone());
    back.sensitivity = Some(Arc::new(Sensitivity { columns: Vec::new(), adjoint, ..by.clone() }));
    let mut rows = Vec::new();
    let mut keep = |row: &[f64]| {
        rows.push(row.to_vec());
        Ok(())
    };
    let (_, tape) = driver::record(&back, &plan.settings, &mut keep, &Stop::new(false));
    let tape = tape?.expect("a recording");
    assert_eq!(rows.len(), forward.rows.len());
    for (own, other) in rows.iter().zip(&forward.rows) {
        let bits = |row: &[f64]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(own), bits(other), "{what}: rows are those of the plain run");
    }
    let share = |k: usize| (0..rows.len()).map(|row| Share { row, quantity: k, slope: weight(row, k) }).collect();
    let shares: Vec<Vec<Share>> = (0..forward.quantities.len()).map(share).collect();
    let found = tape.gradients(&shares, &Stop::new(false))?;
    for (k, (quantity, found)) in forward.quantities.iter().zip(&found).enumerate() {
        for (p, (parameter, found)) in by.parameters.iter().zip(found).enumerate() {
            let [sum, size] = forward.sums[p][k];
            let typical = |p: usize| by.parameters[p].typical.abs();
            let largest = (0..by.parameters.len()).map(|p| forward.sums[p][k][1] * typical(p)).fold(0.0, f64::max);
            let miss = (found - sum).abs();
            // What is 0 but for rounding is so beside what else changes the quantity.
            assert!(
                miss <= (KNOWN * size).max(ROUNDING * largest / typical(p)),
                "{what}: {quantity:?} by {}: {found:e} for {sum:e} of {size:e}",
                parameter.name
            );
        }
    }
    assert!(tape.bytes() > 0);
    Ok(tape.bytes())
}

const ARM: &str = r#"
[robot]
gravity = [0, 0, -9.81]
[[robot.body]]
name = "one"
joint = { name = "q1", kind = "revolute", axis = [0, 0, 1], origin = [0, 0, 0.3] }
mass = 3
com = [0.02, 0.1, 0.05]
inertia = { xx = 0.03, yy = 0.02, zz = 0.04 }
[[robot.body]]
name = "two"
parent = "one"
joint = { name = "q2", kind = "revolute", axis = [1, 0, 0], origin = [0, 0.1, 0.2], damping = 0.2 }
mass = 2
com = [0, 0.2, 0.03]
inertia = { xx = 0.02, yy = 0.01, zz = 0.02 }
[[robot.body]]
name = "three"
parent = "two"
joint = { name = "q3", kind = "revolute", axis = [1, 0, 0], origin = [0, 0.4, 0], friction = { force = 0.4, speed = 0.2 } }
mass = 1
com = [0.01, 0.15, 0]
inertia = { xx = 0.01, yy = 0.004, zz = 0.01 }
[[element]]
name = "strut"
from = { body = "one", point = [0.05, 0, 0] }
to = { body = "three", point = [0, 0.1, 0.05] }
rest_length = 0.35
"#;

const MOTION: &str = r#"
[motion]
kind = "forward"
start = { q = { q1 = 0.3, q2 = 0.4, q3 = -0.5 }, v = { q2 = -0.3, q1 = 0.7 } }
torque = { q3 = "0.5*cos(4*t)" }
[time]
end = 0.6
output_step = 0.0173
[solver]
rtol = 1e-7
memory_rtol = 1e-9
"#;

/// Parameters of the robot and its motion.
const OF_ROBOT: [&str; 11] = [
    "element.strut.rest_length",
    "element.strut.to.point.2",
    "element.strut.from.point.0",
    "motion.start.q.q2",
    "motion.start.v.q1",
    "robot.body.two.joint.damping",
    "robot.body.three.joint.friction.force",
    "robot.body.two.mass",
    "robot.body.three.com.1",
    "robot.body.two.joint.origin.1",
    "robot.gravity.2",
];

fn arm(law: &str, by: &[&str], motion: &str) -> String {
    let by: Vec<String> = OF_ROBOT.iter().chain(by).map(|path| format!("{path:?}")).collect();
    let of = r#"["q.*", "v.*", "a.*", "tau.*", "strut.length", "strut.stroke", "strut.rate", "strut.force", "energy.kinetic", "energy.potential"]"#;
    format!("{ARM}{law}\n{motion}\n[sensitivity]\nby = [{}]\nof = {of}\n", by.join(", "))
}

#[test]
fn an_arm_with_each_kind_of_law() {
    let k = "element.strut.k";
    let laws: [(&str, &str, &[&str]); 7] = [
        ("spring and dashpot", "law = \"kelvin-voigt\"\nparameters = { k = 120, c = 15 }", &[k, "element.strut.c"]),
        (
            "springpot",
            "law = \"springpot\"\nparameters = { c = 60, alpha = 0.4 }",
            &["element.strut.c", "element.strut.alpha"],
        ),
        (
            "fractional Kelvin-Voigt",
            "law = \"fractional-kelvin-voigt\"\nparameters = { k = 100, c = 60, alpha = 0.7 }",
            &[k, "element.strut.alpha"],
        ),
        (
            "bingham",
            "law = \"bingham\"\nparameters = { F_0 = 0.1, F_ya = 0.7, F_yb = 4, v_0 = 0.05, c_a = 1, c_b = 10, eta = 190 }\ninputs = { u = \"0.2*t\" }",
            &["element.strut.F_ya", "element.strut.v_0", "element.strut.eta"],
        ),
        (
            "bouc-wen",
            "law = \"bouc-wen\"\nparameters = { alpha_h = 30, A = 1, beta = 20, gamma = 30, n = 1.5 }",
            &["element.strut.alpha_h", "element.strut.beta", "element.strut.n"],
        ),
        ("maxwell", "law = \"maxwell\"\nparameters = { k = 300, c = 15 }", &[k, "element.strut.c"]),
        (
            "fractional zener",
            "law = \"fractional-zener\"\nparameters = { k_e = 80, k_m = 200, c = 60, alpha = 0.5 }",
            &["element.strut.k_e", "element.strut.k_m", "element.strut.c", "element.strut.alpha"],
        ),
    ];
    for (what, law, by) in laws {
        compare(what, &arm(law, by, MOTION)).unwrap();
    }
}

/// Steps of motion and memories alone keep their equations, whichever memories they are and whatever kinks are between them; with an event to be watched
/// for they keep maps of columns.
#[test]
fn through_the_equations_of_steps() {
    let torque = MOTION.replace("0.5*cos(4*t)", "0.5*cos(4*t) + f*step(t - 0.21)");
    let law = "network = \"parallel(spring(k), springpot(c, alpha), springpot(d, beta))\"\nparameters = { k = 100, c = 60, alpha = 0.7, d = 20, beta = 0.3 }";
    let by = ["k", "c", "alpha", "d", "beta"].map(|name| format!("element.strut.{name}"));
    let by: Vec<&str> = by.iter().map(String::as_str).chain(["constants.f"]).collect();
    let text = format!("[constants]\nf = 0.7\n{}", arm(law, &by, &torque));
    let (from, to) = (text.find("of = [").unwrap(), text.rfind(']').unwrap());
    let text = format!("{}of = [\"q.*\", \"v.*\", \"a.*\"{}\n", &text[..from], &text[to..]);
    let never = "\n[[event]]\nname = \"never\"\nwhen = \"q.q1 - 50\"\n";
    let [own, columns] = ["", never].map(|event| compare("rows of motion", &format!("{text}{event}")).unwrap());
    assert!(own != columns, "{own} bytes either way");
}

/// A torque that switches at a given time, a spring from a table, a springpot whose coefficient follows an input: steps end on changes that no parameter moves.
#[test]
fn across_what_changes_at_given_times() {
    let motion = MOTION.replace("0.5*cos(4*t)", "0.5*cos(4*t) + f*step(t - 0.21) + 0.3*abs(t - 0.4)");
    let constants = "\n[constants]\nf = 0.7\nV = 1.5\n";
    let law = "law = \"magnetorheological\"\nparameters = { E_c = 50, mu_0 = 60, mu = 10, alpha = 0.5 }\ninputs = { u = \"V*step(t - 0.3) + 0.2*t\" }";
    let by = ["constants.f", "constants.V", "element.strut.mu", "element.strut.alpha"];
    compare("a voltage that jumps", &format!("{constants}{}", arm(law, &by, &motion))).unwrap();
}

/// Numbers without pattern.
struct Draw(u64);

impl Draw {
    fn number(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn vector(&mut self, size: f64) -> String {
        let [x, y, z] = [(); 3].map(|()| self.number(-size, size));
        format!("[{x:?}, {y:?}, {z:?}]")
    }
}

/// A chain of joints, with two elements from the world to two of its bodies.
fn chain(draw: &mut Draw, joints: usize) -> String {
    let mut text = "[robot]\n".to_owned();
    for k in 0..joints {
        let kind = if k % 3 == 2 { "prismatic" } else { "revolute" };
        let parent = if k == 0 { String::new() } else { format!("parent = \"b{}\"\n", k - 1) };
        let (axis, origin, com) = (draw.vector(1.0), draw.vector(0.4), draw.vector(0.1));
        let (mass, damping) = (draw.number(0.5, 3.0), draw.number(0.1, 0.6));
        text += &format!(
            "[[robot.body]]\nname = \"b{k}\"\n{parent}mass = {mass:?}\ncom = {com}\ninertia = {{ xx = 0.03, yy = 0.04, zz = 0.05 }}\n\
             joint = {{ name = \"j{k}\", kind = \"{kind}\", axis = {axis}, origin = {origin}, damping = {damping:?} }}\n"
        );
    }
    let (alpha, alpha_m) = (draw.number(0.15, 0.85), draw.number(0.3, 0.9));
    let laws = [
        format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 90, c = 40, alpha = {alpha:?} }}"),
        format!("law = \"fractional-zener\"\nparameters = {{ k_e = 60, k_m = 150, c = 40, alpha = {alpha_m:?} }}"),
    ];
    for (e, law) in laws.iter().enumerate() {
        let body = if e == 0 { joints - 1 } else { joints / 2 };
        let (from, to) = (draw.vector(0.6), draw.vector(0.3));
        text += &format!(
            "[[element]]\nname = \"e{e}\"\nfrom = {{ body = \"world\", point = {from} }}\nto = {{ body = \"b{body}\", point = {to} }}\n\
             rest_length = 0.4\n{law}\n"
        );
    }
    let last = joints - 1;
    text + &format!(
        "[motion]\nkind = \"forward\"\nstart = {{ q = {{ j0 = 0.3 }}, v = {{ j1 = -0.4 }} }}\n[time]\nend = 0.5\noutput_step = 0.031\n\
         [solver]\nrtol = 1e-6\nmemory_rtol = 1e-8\n[sensitivity]\nof = [\"q.*\", \"v.*\", \"e0.force\", \"e1.force\", \"e1.length\", \"energy.kinetic\"]\n\
         by = [\"element.e0.alpha\", \"element.e0.k\", \"element.e1.k_m\", \"element.e1.alpha\", \"element.e1.to.point.1\", \"motion.start.q.j0\",\n\
         \"motion.start.v.j1\", \"robot.body.b{last}.mass\", \"robot.body.b1.com.2\", \"robot.body.b0.inertia.xx\", \"robot.body.b1.joint.damping\",\n\
         \"robot.body.b{last}.joint.axis.0\", \"robot.gravity.0\", \"element.e0.rest_length\"]\n"
    )
}

#[test]
fn random_chains_with_two_elements() {
    let mut draw = Draw(7);
    for joints in [2, 3, 4, 5] {
        compare(&format!("{joints} joints"), &chain(&mut draw, joints)).unwrap();
    }
}

#[test]
fn a_run_that_is_driven_step_by_step_is_refused() {
    let law = "law = \"kelvin-voigt\"\nparameters = { k = 120, c = 15 }";
    let plan = cases(&arm(law, &[], MOTION)).plan(0).unwrap();
    let mut system = plan.system();
    let by = Sensitivity::clone(system.sensitivity.as_ref().unwrap());
    let adjoint = Some(vec![Quantity::Coordinate(0)]);
    system.sensitivity = Some(Arc::new(Sensitivity { columns: Vec::new(), adjoint, ..by }));
    let error = springpot::Simulation::new(system, plan.settings.clone()).unwrap().step().unwrap_err().to_string();
    assert!(error.contains("driven step by step") && error.ends_with("method = \"forward\" does"), "{error}");
}
