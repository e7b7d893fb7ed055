//! Floating joints along prescribed poses: closed forms of the rigid body, and the energy ledger with elements.

use crate::support::robots::every;
use crate::support::{Run, largest, run};

const MASS: f64 = 3.0;
const COM: [f64; 3] = [0.05, -0.02, 0.1];
const INERTIA: [[f64; 3]; 3] = [[0.3, 0.02, -0.01], [0.02, 0.4, 0.03], [-0.01, 0.03, 0.5]];

/// A single body that floats; `pose` is the rest of its table in the motion.
fn body(com: [f64; 3], inertia: [[f64; 3]; 3], gravity: &str, pose: &str) -> String {
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = inertia;
    format!(
        "[robot]\ngravity = {gravity}\n[[robot.body]]\nname = \"rock\"\njoint = {{ name = \"free\", kind = \"floating\" }}\n\
         mass = {MASS}\ncom = {com:?}\n\
         inertia = {{ xx = {xx}, yy = {yy}, zz = {zz}, xy = {xy}, xz = {xz}, yz = {yz} }}\n\
         [motion]\nkind = \"prescribed\"\njoints = {{ free = {{ {pose} }} }}\n"
    )
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn times(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + b[k])
}

fn scaled(s: f64, a: [f64; 3]) -> [f64; 3] {
    a.map(|x| s * x)
}

/// Asserts that a column is the same number in all rows.
fn assert_constant(run: &Run, column: &str, value: f64) {
    for (t, found) in run.t().into_iter().zip(run.column(column)) {
        assert!((found - value).abs() < 1e-12 * (1.0 + value.abs()), "{column} at {t}: {found}, not {value}");
    }
}

#[test]
fn a_body_on_a_turntable_needs_constant_forces_in_its_own_axes() {
    // Turned by phi about x, then carried round the z axis at omega on a circle of radius r.
    let (omega, phi, r, g) = (2.5f64, 0.4f64, 0.7, 9.81);
    let pose =
        format!("x = \"{r}*cos({omega}*t)\", y = \"{r}*sin({omega}*t)\", z = 0.5, rpy = [{phi}, 0, \"{omega}*t\"]");
    let run = run(&format!("{}{}", body(COM, INERTIA, "[0, 0, -9.81]", &pose), every(4.0, 0.05)));
    let (s, c) = phi.sin_cos();
    let spin = [0.0, omega * s, omega * c];
    let linear = [0.0, omega * r * c, -omega * r * s];
    // Newton at the centre of mass and Euler about it, seen from the body's axes, where everything stands still.
    let centre = sum([-omega * omega * r, 0.0, 0.0], cross(spin, cross(spin, COM)));
    let force = scaled(MASS, sum(centre, [0.0, g * s, g * c]));
    let torque = sum(cross(spin, times(INERTIA, spin)), cross(COM, force));
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        assert_constant(&run, &format!("v.free.v{axis}"), linear[k]);
        assert_constant(&run, &format!("v.free.w{axis}"), spin[k]);
        assert_constant(&run, &format!("a.free.w{axis}"), 0.0);
        assert_constant(&run, &format!("tau.free.v{axis}"), force[k]);
        assert_constant(&run, &format!("tau.free.w{axis}"), torque[k]);
    }
    assert_constant(&run, "q.free.z", 0.5);
    // The attitude as a quaternion: half of the turn about z after half of phi about x, through many turns.
    let attitude: Vec<Vec<f64>> = ["qx", "qy", "qz", "qw"].map(|part| run.column(&format!("q.free.{part}"))).into();
    for (k, t) in run.t().into_iter().enumerate() {
        let ((sp, cp), (sz, cz)) = ((0.5 * phi).sin_cos(), (0.5 * omega * t).sin_cos());
        let expected = [sp * cz, sp * sz, cp * sz, cp * cz];
        assert!((0..4).all(|i| (attitude[i][k] - expected[i]).abs() < 1e-14), "t = {t}");
    }
}

#[test]
fn a_top_left_alone_precesses_without_any_force() {
    // Symmetric about x, tilted by theta, precessing at omega: C·spin = (C − A)·omega·sin theta, and the angular momentum stays.
    let (a, c, omega, theta) = (0.5f64, 0.2, 3.0, 0.6f64);
    let spin = (c - a) / c * omega * theta.sin();
    let pose = format!("x = \"0.3*t\", y = 1, z = \"-2*t\", rpy = [\"{spin}*t\", {theta}, \"{omega}*t\"]");
    let inertia = [[c, 0.0, 0.0], [0.0, a, 0.0], [0.0, 0.0, a]];
    let run = run(&format!("{}{}", body([0.0; 3], inertia, "[0, 0, 0]", &pose), every(5.0, 0.01)));
    for part in ["vx", "vy", "vz", "wx", "wy", "wz"] {
        let worst = largest(&run.column(&format!("tau.free.{part}")));
        assert!(worst < 1e-13, "{part}: {worst:e}");
    }
    // It does turn, and its energy stays.
    assert!(largest(&run.column("a.free.wy")) > 1.0);
    assert!(largest(&run.column("energy.actuators")) < 1e-12);
    let kinetic = run.column("energy.kinetic");
    assert!(kinetic.iter().all(|x| (x / kinetic[0] - 1.0).abs() < 1e-13));
    assert_eq!(run.report.rows, 501);
}

/// A boat on moorings, a mast hinged on it, a block that slides: two elements to the world, one inside.
const MOORED: &str = r#"
[[robot.body]]
name = "hull"
joint = { name = "sea", kind = "floating", origin = [0.1, 0, 0.2], rpy = [0, 0, 0.3] }
mass = 40
com = [0.05, 0, -0.1]
inertia = { xx = 2, yy = 6, zz = 7, xz = 0.2 }
[[robot.body]]
name = "boom"
joint = { name = "gooseneck", kind = "continuous", axis = [0, 0, 1], origin = [0.2, 0, 0.5], damping = 0.4 }
mass = 3
com = [-0.5, 0, 0]
inertia = { xx = 0.01, yy = 0.3, zz = 0.3 }
[[element]]
name = "bow_line"
from = { body = "world", point = [3, 0.5, 1] }
to = { body = "hull", point = [1, 0, 0.2] }
rest_length = 2
law = "fractional-kelvin-voigt"
parameters = { k = 300, c = 200, alpha = 0.4 }
[[element]]
name = "stern_line"
from = { body = "hull", point = [-1, 0.1, 0.2] }
to = { body = "world", point = [-3, -1, 0.5] }
rest_length = 2.1
law = "thermoviscoelastic"
parameters = { E_c = 100, E_kv = 150, E_d = 80, alpha = 0.6, a_kv = 0.001 }
inputs = { T = "290 + 5*sin(3*t)" }
[[element]]
name = "sheet"
from = { body = "hull", point = [-0.6, 0, 0.1] }
to = { body = "boom", point = [-0.8, 0, 0] }
rest_length = 0.5
law = "springpot"
parameters = { c = 60, alpha = 0.5 }
[motion]
kind = "prescribed"
[motion.joints]
sea = { x = "0.2*sin(t)", y = "0.1*sin(2*t)", z = "0.15*sin(1.5*t)", rpy = ["0.2*sin(2*t)", "0.1*cos(1.5*t)", "0.3*sin(t)"] }
gooseneck = "0.6*sin(2*t)"
"#;

const LINES: [&str; 3] = ["bow_line", "stern_line", "sheet"];

#[test]
fn the_balance_closes_with_moorings() {
    let run = run(&format!("{MOORED}{}", every(4.0, 0.02)));
    for line in LINES {
        crate::energy::power_balance(&run, line);
        crate::energy::second_law(&run, line);
    }
    let residual = crate::energy::residual(&run, &LINES);
    println!("{residual:.1e} of {:.1} J", run.report.energy_turned_over.unwrap());
    assert!(residual < 1e-8, "{residual:e}");
    // The sheet is inside the boat: as a whole it pushes the hull nowhere, but the boom against it.
    let inside = ["vx", "vy", "vz", "wx", "wy", "wz"].map(|part| largest(&run.column(&format!("sheet.Q.sea.{part}"))));
    assert!(inside.iter().all(|q| *q < 1e-12), "{inside:?}");
    assert!(largest(&run.column("sheet.Q.gooseneck")) > 1.0);
}

#[test]
fn attitudes_that_pass_through_every_turn_close_it_too() {
    // Pitch goes through 90 degrees, where roll and yaw are about one axis, and yaw through many turns.
    let text = MOORED
        .replace("rpy = [\"0.2*sin(2*t)\", \"0.1*cos(1.5*t)\", \"0.3*sin(t)\"]", "rpy = [\"0.4*t\", \"2*t\", \"3*t\"]");
    assert_ne!(text, MOORED);
    let text = text
        .replace("point = [3, 0.5, 1]", "point = [6, 0.5, 1]")
        .replace("point = [-3, -1, 0.5]", "point = [-6, -1, 0.5]");
    let run = run(&format!("{text}{}", every(4.0, 0.02)));
    let residual = crate::energy::residual(&run, &LINES);
    assert!(residual < 1e-8, "{residual:e}");
    let attitude: Vec<Vec<f64>> = ["qx", "qy", "qz", "qw"].map(|part| run.column(&format!("q.sea.{part}"))).into();
    for k in 0..run.rows.len() {
        let norm: f64 = (0..4).map(|i| attitude[i][k].powi(2)).sum();
        assert!((norm - 1.0).abs() < 1e-14);
        if k > 0 {
            // No jump of sign from row to row.
            let product: f64 = (0..4).map(|i| attitude[i][k] * attitude[i][k - 1]).sum();
            assert!(product > 0.9, "row {k}");
        }
    }
}

#[test]
fn a_pose_that_jumps_is_an_error_and_one_with_a_kink_is_none() {
    let pose = |y: &str, yaw: &str| {
        let text = body(COM, INERTIA, "[0, 0, -9.81]", &format!("y = \"{y}\", rpy = [0, 0, \"{yaw}\"]"));
        crate::support::run_case(&crate::support::cases(&format!("{text}{}", every(1.0, 0.1))), 0)
    };
    for (y, yaw) in [("0.1*step(t - 0.35)", "0"), ("0", "0.1*step(t - 0.35)")] {
        let error = pose(y, yaw).error.expect("a jump").to_string();
        assert!(error.contains("joint \"free\" jumps by"), "{error}");
        assert!(error.starts_with("t = 0.35"), "{error}");
    }
    let kinked = pose("abs(t - 0.35)", "0.5*abs(t - 0.6)");
    assert!(kinked.error.is_none(), "{:?}", kinked.error);
    let turned_over = kinked.report.energy_turned_over.unwrap();
    assert!(kinked.report.energy_residual.unwrap() < 1e-9 * turned_over);
}
