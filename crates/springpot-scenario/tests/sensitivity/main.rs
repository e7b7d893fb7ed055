//! Derivatives by the numbers of a file: from paths to columns, against differences of whole runs, and what is refused.

mod back;
mod changes;
mod control;
mod every;
mod free;
mod kinks;
mod laws;
mod pasts;
mod steps;

use springpot::Simulation;
use springpot::law::Catalog;
use springpot::observe::Quantity;
use springpot_scenario::{Plan, Refusals, Scenario};

/// A robot of three bodies with a line, a cable, a bushing and a law on a joint, numbers of all kinds in its file.
const ARM: &str = r#"
[constants]
f = "0.4 Hz"
k_0 = 80
k_1 = { expression = "k_0 + 50*f" }
[robot]
gravity = [0.3, 0, -9.81]
gripper = { body = "three", point = [0.1, 0.2, 0.05] }
[[robot.body]]
name = "one"
joint = { name = "q1", kind = "revolute", axis = [0.1, 0.2, 1], origin = [0, 0, 0.3], rpy = [0.1, 0.2, 0.3], damping = 0.3 }
mass = 3
com = [0.02, 0.1, 0.05]
inertia = { xx = 0.03, yy = 0.02, zz = 0.04, xy = 0.002 }
[[robot.body]]
name = "link"
joint = { name = "fixed", kind = "fixed", origin = [0, 0.05, 0.1], rpy = [0, 0.1, 0] }
mass = 0.4
com = [0, 0.02, 0]
[[robot.body]]
name = "two"
joint = { name = "q2", kind = "revolute", axis = [1, 0, 0.1], origin = [0, 0.1, 0.1], friction = { force = 0.1, speed = 0.5 } }
mass = 2
com = [0, 0.2, 0.03]
inertia = { xx = 0.02, yy = 0.01, zz = 0.02 }
[[robot.body]]
name = "three"
joint = { name = "q3", kind = "prismatic", axis = [0.2, 1, 0], origin = [0, 0.3, 0], armature = 0.2 }
mass = 1
com = [0.01, 0.15, 0]
inertia = { xx = 0.01, yy = 0.004, zz = 0.01 }
[[element]]
name = "strut"
from = { body = "world", point = [0.05, 0.5, 0] }
to = { body = "two", point = [0, 0.1, 0.05] }
rest_length = "start"
law = "kelvin-voigt"
parameters = { k = { expression = "k_1" }, c = 15 }
[[element]]
name = "tendon"
from = { body = "one", point = [0.1, 0, 0] }
via = [{ body = "two", point = [0.1, 0.05, 0.1] }]
to = { body = "three", point = [0.1, 0.1, 0.05] }
rest_length = 0.2
law = "kelvin-voigt"
parameters = { k = 40, c = 5 }
[[element]]
name = "mount"
from = { body = "one", point = [0, 0.1, 0.2], rpy = [0.1, 0, 0.2] }
to = { body = "two", point = [0, 0.05, 0.02], rpy = [0, 0.1, 0] }
[element.bushing]
x = { law = "kelvin-voigt", parameters = { k = 30, c = 2 }, rest = 0.01 }
rx = { law = "kelvin-voigt", parameters = { k = 4, c = 0.3 } }
[[element]]
name = "slide"
joint = "q3"
rest = 0.05
law = "kelvin-voigt"
parameters = { k = 90, c = 3 }
[motion]
kind = "forward"
start = { q = { q1 = 0.3, q2 = 0.4, q3 = 0.05 }, v = { q2 = -0.3 } }
torque = { q1 = 0.4, q2 = "0.5*cos(2*pi*f*t)" }
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
memory_rtol = 1e-12
"#;

const COLUMNS: [&str; 12] = [
    "q.q1",
    "q.q2",
    "q.q3",
    "v.q2",
    "strut.force",
    "tendon.length",
    "mount.rx.force",
    "slide.force",
    "gripper.y",
    "strut.dissipated",
    "energy.joints",
    "energy.actuators",
];

const COLUMNS_OF_SLIDER: [&str; 4] = ["q.q1", "v.q1", "strut.force", "strut.stored"];

/// Times that are compared, none of which a step ends on.
const ROWS: [f64; 2] = [0.1734, 0.3821];

fn scenario(text: &str) -> Scenario {
    Scenario::parse(text, "arm.toml", concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios")).unwrap()
}

fn plan(scenario: &Scenario) -> Result<Plan, Refusals> {
    scenario.cases(&Catalog::standard())?.plan(0)
}

fn said(scenario: &Scenario) -> String {
    plan(scenario).map(|_| ()).unwrap_err().to_string()
}

/// The columns called `names` at [`ROWS`].
fn rows(plan: &Plan, names: &[String]) -> Vec<Vec<f64>> {
    let system = plan.system();
    let observables = system.observables();
    let find = |name: &String| {
        let found = observables.quantities().into_iter().find(|of| observables.named(*of).to_string() == *name);
        found.unwrap_or_else(|| panic!("no column {name}"))
    };
    let quantities: Vec<Quantity> = names.iter().map(find).collect();
    let mut simulation = Simulation::new(system, plan.settings.clone()).unwrap();
    let row = |t: f64| {
        while simulation.t() < t {
            simulation.step().unwrap();
        }
        let snapshot = simulation.interpolate(t).unwrap();
        quantities.iter().map(|quantity| snapshot.value(*quantity)).collect()
    };
    ROWS.map(row).to_vec()
}

/// A run that goes on from the state that another one of the same has at `from` has all numbers of rows at these times to the bit.
fn goes_on_to_the_bit(text: &str, by: &str, from: f64, times: &[f64]) {
    let mut asked = scenario(text);
    asked.differentiate(by).unwrap();
    let plan = plan(&asked).unwrap();
    let quantities = plan.system().observables().quantities();
    let begin = || Simulation::new(plan.system(), plan.settings.clone()).unwrap();
    let (mut first, mut second) = (begin(), begin());
    let pass = |simulation: &mut Simulation, t: f64| {
        while simulation.t() < t {
            simulation.step().unwrap();
        }
        let snapshot = simulation.interpolate(t).unwrap();
        quantities.iter().map(|of| snapshot.value(*of).to_bits()).collect::<Vec<_>>()
    };
    pass(&mut first, from);
    second.set_state(&first.state().unwrap()).unwrap();
    for &t in times {
        assert_eq!(pass(&mut first, t), pass(&mut second, t));
    }
}

/// Compares derivatives of all columns by the numbers at these paths with differences of whole runs.
fn compare(text: &str, columns: &[&str], paths: &[(&str, f64)]) {
    compare_within(1e-7, text, columns, paths);
}

/// The same, to so much of the largest value.
fn compare_within(share: f64, text: &str, columns: &[&str], paths: &[(&str, f64)]) {
    let mut asked = scenario(text);
    let all: Vec<&str> = paths.iter().map(|(path, _)| *path).collect();
    back::goes_back(text, columns, &all);
    asked.differentiate(&all.join(",")).unwrap();
    let asked = plan(&asked).unwrap_or_else(|refusals| panic!("{refusals}"));
    let told: Vec<String> =
        columns.iter().flat_map(|column| all.iter().map(move |path| format!("d({column})/d({path})"))).collect();
    let found = rows(&asked, &told);
    let names: Vec<String> = columns.iter().map(|name| (*name).to_owned()).collect();
    for (p, (path, step)) in paths.iter().enumerate() {
        let mut parameters = asked.sensitivity.as_ref().unwrap().parameters.iter();
        let value = parameters.find(|parameter| parameter.name == *path).unwrap().value;
        let at = |steps: f64| {
            let mut moved = scenario(text);
            if text.contains("[sensitivity]") {
                moved.set("sensitivity=").unwrap();
            }
            moved.set(&format!("{path}={:?}", value + steps * step)).unwrap();
            moved.set("solver.rtol=1e-13").unwrap();
            rows(&plan(&moved).unwrap_or_else(|refusals| panic!("{refusals}")), &names)
        };
        let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
        for (k, column) in columns.iter().enumerate() {
            let truth = |r: usize| (8.0 * (a[r][k] - b[r][k]) - (c[r][k] - d[r][k])) / (12.0 * step);
            let size = (0..ROWS.len()).map(|r| truth(r).abs()).fold(0.0, f64::max);
            for r in 0..ROWS.len() {
                let of = found[r][k * paths.len() + p];
                let miss = (of - truth(r)).abs();
                // What the runs that are compared may be off.
                let known = share * size + 2e-12 * (1.0 + a[r][k].abs()) / step;
                assert!(
                    miss < known,
                    "d({column})/d({path}) at {}: {of} for {}, {miss:e} > {known:e}",
                    ROWS[r],
                    truth(r)
                );
            }
        }
    }
}

#[test]
fn laws_starts_and_forces() {
    compare(
        ARM,
        &COLUMNS,
        &[
            ("element.strut.c", 0.05),
            ("element.mount.rx.k", 0.02),
            ("element.slide.rest", 1e-3),
            ("element.mount.x.rest", 1e-3),
            ("motion.start.q.q1", 2e-3),
            ("motion.start.v.q3", 5e-3),
            ("motion.torque.q1", 5e-3),
            ("robot.body.one.joint.damping", 5e-3),
            ("robot.body.two.joint.friction.force", 5e-3),
            ("robot.gravity.0", 1e-2),
        ],
    );
}

#[test]
fn constants_through_expressions_and_signals() {
    compare(ARM, &COLUMNS, &[("constants.f", 2e-3), ("constants.k_0", 0.2)]);
}

#[test]
fn masses_and_inertias() {
    compare(
        ARM,
        &COLUMNS,
        &[
            ("robot.body.two.mass", 5e-3),
            ("robot.body.link.mass", 5e-3),
            ("robot.body.two.com.1", 1e-3),
            ("robot.body.link.com.2", 1e-3),
            ("robot.body.one.inertia.xy", 5e-5),
            ("robot.body.three.joint.armature", 2e-3),
        ],
    );
}

#[test]
fn geometry() {
    compare(
        ARM,
        &COLUMNS,
        &[
            ("robot.body.two.joint.origin.1", 1e-3),
            ("robot.body.link.joint.rpy.1", 2e-3),
            ("robot.body.one.joint.rpy.0", 2e-3),
            ("robot.body.one.joint.axis.1", 2e-3),
            ("robot.body.three.joint.axis.0", 2e-3),
            ("element.strut.from.point.1", 1e-3),
            ("element.tendon.via.0.point.2", 5e-4),
            ("element.mount.to.rpy.1", 2e-3),
            ("element.mount.from.point.0", 1e-3),
            ("robot.gripper.point.0", 1e-3),
        ],
    );
}

#[test]
fn parameters_have_names_units_and_add_up() {
    let arm = ARM.replace("parameters = { k = 90, c = 3 }", "parameters = { k = 40, c = 3 }");
    let text = format!(
        "{arm}\n[[parameter]]\nname = \"stiffness\"\npath = [\"element.tendon.k\", \"element.slide.k\"]\ntypical = \"1 kN/m\"\n\
         [[parameter]]\npath = \"motion.start.q.q1\"\nbounds = [\"0 deg\", \"90 deg\"]\n\
         [sensitivity]\nof = [\"q.*\", \"tendon.force\"]\ncontrol = false\n"
    );
    let plan = plan(&scenario(&text)).unwrap_or_else(|refusals| panic!("{refusals}"));
    let sensitivity = plan.sensitivity.as_ref().unwrap();
    let parameters: Vec<_> =
        sensitivity.parameters.iter().map(|one| (&*one.name, one.value, &*one.unit, one.typical)).collect();
    assert_eq!(parameters, [("stiffness", 40.0, "N/m", 1000.0), ("motion.start.q.q1", 0.3, "rad", 0.3)]);
    let names: Vec<(&str, &str)> = sensitivity.columns.iter().map(|column| (&*column.name, &*column.unit)).collect();
    assert_eq!(names[0], ("d(q.q1)/d(stiffness)", "rad/(N/m)"));
    assert_eq!(names[1], ("d(q.q1)/d(motion.start.q.q1)", "rad/rad"));
    assert_eq!(names.last(), Some(&("d(tendon.force)/d(motion.start.q.q1)", "N/rad")));
    assert_eq!(names.len(), 8);
    let columns = plan.columns();
    assert!(columns[columns.len() - 8..].iter().zip(&names).all(|(column, (name, _))| column.name == *name));
    // Both move by one number.
    let found = rows(&plan, &[names[0].0.to_owned()]);
    let mut each = scenario(&arm);
    each.differentiate("element.tendon.k,element.slide.k").unwrap();
    let each = self::plan(&each).unwrap();
    let parts = rows(&each, &["d(q.q1)/d(element.tendon.k)".to_owned(), "d(q.q1)/d(element.slide.k)".to_owned()]);
    for (sum, parts) in found.iter().zip(parts) {
        assert!((sum[0] - parts[0] - parts[1]).abs() < 1e-12 * (1.0 + sum[0].abs()));
    }
}

#[test]
fn derivatives_without_control_change_nothing_else() {
    let names: Vec<String> = COLUMNS.map(str::to_owned).to_vec();
    let text = format!("{ARM}\n[sensitivity]\nby = [\"element.strut.c\"]\ncontrol = false\n");
    assert_eq!(rows(&plan(&scenario(&text)).unwrap(), &names), rows(&plan(&scenario(ARM)).unwrap(), &names));
}

#[test]
fn what_cannot_be_a_parameter_is_refused_by_its_path() {
    for (path, words) in [
        ("time.end", "time.end cannot be a parameter: rows say when the run is looked at"),
        ("solver.rtol", "solver.rtol cannot be a parameter: it says how exactly is computed"),
        ("element.strut.k", "it is an expression"),
        ("element.strut.k", "it follows from constants.k_1"),
        ("motion.torque.q2", "it follows from constants.f"),
        ("element.strut.rest_length", "element.strut.rest_length cannot be a parameter: it is the text \"start\""),
        ("element.strut.law", "it is the text \"kelvin-voigt\""),
        ("element.strut.enabled", "element.strut.enabled cannot be a parameter"),
        ("robot.body.two.com", "as in robot.body.two.com.0"),
        ("robot.body.two.joint.friction", "as in robot.body.two.joint.friction.force"),
        ("robot.body.two.joint.friction.speed", "robot.body.two.joint.friction.speed cannot be a parameter"),
        ("robot.body.four.mass", "no robot.body is named \"four\""),
        ("element.strut.cc", "did you mean"),
        ("constants.g", "there is no such constant"),
        ("element.tendon.k,element.tendon.k", "element.tendon.k is a parameter twice"),
    ] {
        let mut asked = scenario(ARM);
        asked.differentiate(path).unwrap();
        let said = said(&asked);
        assert!(said.contains(words) && said.starts_with("--sensitivity:1:"), "{path}: {said}");
    }
    let with = |tables: &str| said(&scenario(&format!("{ARM}\n{tables}")));
    for (tables, words) in [
        ("[sensitivity]", "[sensitivity] has no parameter"),
        ("[sensitivity]\nby = []", "[sensitivity] has no parameter"),
        ("[sensitivity]\nby = \"element.tendon.k\"\nof = \"q.q9\"", "\"q.q9\" matches no column"),
        ("[sensitivity]\nby = \"element.tendon.k\"\nmethod = \"adjoint\"", "there is no [[metric]]"),
        ("[sensitivity]\nby = \"element.tendon.k\"\nhow = 1", "unknown key `how`"),
        ("[[parameter]]\nname = \"k\"", "has no `path`"),
        (
            "[[parameter]]\npath = [\"element.tendon.k\", \"element.slide.k\"]",
            "\"element.tendon.k\" moves numbers together that differ: element.tendon.k is 40 N/m, element.slide.k is 90 N/m",
        ),
        ("[[parameter]]\npath = \"element.tendon.k\"\nbounds = [60, 50]", "goes from 60 to 50"),
        (
            "[[parameter]]\npath = \"element.tendon.k\"\nbounds = [50, 60]",
            "is 50 … 60, and the file begins outside, at 40",
        ),
        ("[[parameter]]\npath = \"element.tendon.k\"\nbounds = [\"1 N\", \"2 N\"]", "this place takes `N/m`"),
        ("[[parameter]]\npath = \"element.tendon.k\"\nscale = \"square\"", "no scale"),
        ("[[parameter]]\npath = \"element.tendon.k\"\nprior = { mean = 40, sd = 0 }", "must be positive"),
        (
            "[sensitivity]\nby = \"element.tendon.k\"\n[[sweep]]\nparameter = \"element.tendon.k\"\nvalues = [1, 2]",
            "element.tendon.k cannot be a parameter: it is swept",
        ),
    ] {
        let said = with(tables);
        assert!(said.contains(words), "{tables}: {said}");
    }
}

#[test]
fn what_the_engine_does_not_know_is_refused_by_name() {
    let text = ARM.replace(
        "torque = { q1 = 0.4,",
        "torque = { q1 = { expression = \"-strut.derivative\", unit = \"N*m\", sample = \"10 ms\" },",
    );
    let mut asked = scenario(&text);
    asked.differentiate("element.tendon.k").unwrap();
    let said = said(&asked);
    assert!(said.contains("the run cannot be differentiated: no derivative by a parameter is known of"), "{said}");
}

#[test]
fn an_order_at_its_end_needs_another_memory() {
    for alpha in ["0", "1", "0.5"] {
        let text = ARM.replace(
            "law = \"kelvin-voigt\"\nparameters = { k = 40, c = 5 }",
            &format!("law = \"springpot\"\nparameters = {{ c = 5, alpha = {alpha} }}"),
        );
        let mut asked = scenario(&text);
        asked.differentiate("element.tendon.alpha").unwrap();
        match plan(&asked) {
            Err(refusals) if alpha != "0.5" => {
                assert!(refusals.to_string().contains("start at 0.01 or 0.99"), "{refusals}")
            }
            // Whatever else the leaf lacks.
            Err(refusals) => assert!(!refusals.to_string().contains("start at"), "{refusals}"),
            Ok(_) => assert_eq!(alpha, "0.5"),
        }
    }
}

#[test]
fn a_robot_from_a_file_with_locked_joints_and_a_follower() {
    let text = r#"
[robot]
urdf = "robots/panda.urdf"
gravity = [0, 0, -9.81]
[robot.gripper]
body = "panda_hand_tcp"
point = [0, 0, 0]
[[element]]
name = "strut"
from = { body = "world", point = [0.35, 0.1, 0] }
to = { body = "panda_link4", point = [0, 0, 0.1] }
rest_length = "start"
law = "kelvin-voigt"
parameters = { k = "40 N/cm", c = "70 N*s/m" }
[[element]]
name = "pad"
from = { body = "panda_rightfinger", point = [0, 0, 0.04] }
to = { body = "panda_leftfinger", point = [0, 0, 0.04] }
rest_length = "4 cm"
law = "kelvin-voigt"
parameters = { k = "2 N/cm", c = "6 N*s/m" }
[motion]
kind = "forward"
locked = ["panda_joint1", "panda_joint3", "panda_joint5", "panda_joint6", "panda_joint7"]
start = { q = { panda_joint2 = 0.3, panda_joint4 = -1.8, panda_joint6 = 2, panda_finger_joint1 = 0.03 } }
[time]
end = 0.4
output_step = 0.1
[solver]
rtol = 1e-10
"#;
    compare(
        text,
        &["q.panda_joint2", "q.panda_joint4", "q.panda_finger_joint1", "strut.force", "pad.force", "gripper.z"],
        &[
            ("element.strut.to.point.2", 1e-3),
            ("element.pad.from.point.1", 1e-3),
            ("element.pad.c", 0.02),
            ("motion.start.q.panda_joint2", 1e-3),
            ("motion.start.q.panda_joint1", 1e-3),
            ("motion.start.v.panda_joint3", 1e-3),
            ("robot.gravity.1", 1e-2),
        ],
    );
    let mut asked = scenario(text);
    asked.differentiate("robot.body.panda_link4.mass").unwrap();
    assert!(said(&asked).contains("numbers in a robot's file have no path"), "{}", said(&asked));
}

/// Cases of elements that are not enabled have the columns of those that are.
#[test]
fn cases_have_the_same_columns() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/point_to_point.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let mut swept = scenario(&text);
    swept.differentiate("motion.controller.kp.q1,robot.body.forearm.mass").unwrap();
    let cases = swept.cases(&Catalog::standard()).unwrap();
    let columns = |case: usize| {
        let plan = cases.plan(case).unwrap_or_else(|refusals| panic!("{refusals}"));
        let names: Vec<String> = plan.row_columns().iter().map(|column| column.name.to_string()).collect();
        names
    };
    let first = columns(0);
    assert!(first.iter().any(|name| name == "d(thermo.force)/d(motion.controller.kp.q1)"));
    assert!((1..4).all(|case| columns(case) == first));
}

/// What nobody knows a derivative of is refused, with what it is, and is never 0.
#[test]
fn what_is_not_known_is_refused() {
    let refused = |text: &str, path: &str, column: Option<&str>| {
        let mut asked = scenario(text);
        if text.contains("[[sweep]]") {
            asked.set("sweep=").unwrap();
            asked.set("figure=").unwrap();
        }
        asked.differentiate(path).unwrap();
        if let Some(column) = column {
            asked.set(&format!("sensitivity.of={column:?}")).unwrap();
        }
        said(&asked)
    };
    let torque = "torque = { q1 = 0.4, q2 = \"0.5*cos(2*pi*f*t)\" }";
    let moved = ARM.replace(torque, "prescribed = { q1 = \"0.3 + 0.2*sin(f*t)\" }").replace("q1 = 0.3, q2", "q2");
    let sampled = "torque = { q1 = { expression = \"-0.1*tendon.derivative\", unit = \"N*m\", sample = \"10 ms\" } }";
    let slow = "controller = { kind = \"computed-torque\", kp = 60, kd = 9, compensate_elements = true, rate_limits = { q1 = 60 }, reference = { kind = \"move\", to = { q1 = 0.6, q2 = 0.1, q3 = 0.1 }, duration = 0.3 } }";
    for (text, path, column, words) in [
        (ARM, "element.tendon.k", Some("energy.residual"), "\"energy.residual\" cannot be differentiated"),
        (&*moved, "constants.f", None, "motion.prescribed.q1 follows from it, and no derivative by that is known"),
        (&ARM.replace(torque, sampled), "element.tendon.k", None, "D^alpha x that feedback samples"),
        (
            &ARM.replace(torque, slow),
            "motion.controller.kp",
            None,
            "limits of rates of forces that take the elements off",
        ),
    ] {
        let said = refused(text, path, column);
        assert!(said.contains(words), "{path}: {said}");
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/magnetorheological_voltage.toml");
    let along_a_path = std::fs::read_to_string(folder).unwrap();
    for (path, words) in [
        ("motion.x", "motion.x cannot be a parameter: no derivative by it is known"),
        ("motion.guess.q3", "motion.guess.q3 cannot be a parameter: no derivative by it is known"),
        ("robot.gripper.point.0", "no derivative by geometry is known of joints that follow a path of the gripper"),
        ("element.damper.to.point.1", "no derivative by geometry is known of joints that follow a path of the gripper"),
        ("robot.body.forearm.joint.origin.0", "no derivative by geometry is known"),
    ] {
        let said = refused(&along_a_path, path, None);
        assert!(said.contains(words), "{path}: {said}");
    }
}
