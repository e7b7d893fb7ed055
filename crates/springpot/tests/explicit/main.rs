//! Explicit steps: their orders, the balance of energies, agreement with implicit steps, and the change between both.

mod agree;
mod orders;
mod stiff;
#[path = "../support/mod.rs"]
mod support;
mod tangents;

use springpot::system::{Adaptive, RowTimes, Settings, System};
use support::{Run, cases, run_system};

/// A chain of links of one degree each, their axes in turn, with an element from the world to the last one and one between neighbours.
fn chain(links: usize, laws: [&str; 2]) -> String {
    let mut text = String::from("[robot]\n");
    for k in 0..links {
        let axis = [[0, 1, 0], [1, 0, 0], [0, 0, 1]][k % 3];
        let parent = if k == 0 { String::new() } else { format!("parent = \"b{}\"\n", k - 1) };
        let origin = if k == 0 { [0.0; 3] } else { [0.1, 0.02, -0.3] };
        text += &format!(
            "[[robot.body]]\nname = \"b{k}\"\n{parent}joint = {{ name = \"q{k}\", kind = \"revolute\", axis = {axis:?}, origin = {origin:?}, \
             damping = 0.02, armature = 0.01 }}\nmass = {}\ncom = [0.05, 0.01, -0.15]\n\
             inertia = {{ xx = 0.02, yy = 0.025, zz = 0.01, xy = 0.001 }}\n",
            1.0 + 0.3 * k as f64
        );
    }
    let [far, near] = laws;
    let last = links - 1;
    text += &format!(
        "[[element]]\nname = \"far\"\nfrom = {{ body = \"world\", point = [0.6, -0.3, 0.4] }}\n\
         to = {{ body = \"b{last}\", point = [0.1, 0.05, -0.25] }}\nrest_length = 0.9\n{far}\n\
         [[element]]\nname = \"near\"\njoint = \"q{last}\"\nrest = 0.1\n{near}\n"
    );
    text + "[motion]\nkind = \"forward\"\nstart = { q = { q0 = 0.7 }, v = { q0 = -0.4 } }\n"
}

const SPRING_DAMPER: &str = "law = \"kelvin-voigt\"\nparameters = { k = 40, c = 3 }";
const BENDING: &str =
    "network = \"parallel(polynomial(k1, k2, k3), dashpot(c))\"\nparameters = { k1 = 4, k2 = 1, k3 = 9, c = 0.3 }";

/// A body that floats, turning about all axes, held by two elements.
fn floating() -> String {
    format!(
        "[robot]\n[[robot.body]]\nname = \"top\"\njoint = {{ name = \"base\", kind = \"floating\" }}\nmass = 2\ncom = [0.02, -0.01, 0.05]\n\
         inertia = {{ xx = 0.05, yy = 0.08, zz = 0.1, xy = 0.004 }}\n\
         [[robot.body]]\nname = \"arm\"\nparent = \"top\"\njoint = {{ name = \"hinge\", kind = \"spherical\", origin = [0.2, 0, 0] }}\n\
         mass = 0.6\ncom = [0.1, 0.02, 0]\ninertia = {{ xx = 0.004, yy = 0.008, zz = 0.009 }}\n\
         [[element]]\nname = \"far\"\nfrom = {{ body = \"world\", point = [0.6, -0.3, 1.4] }}\n\
         to = {{ body = \"top\", point = [0.1, 0.05, 0.1] }}\nrest_length = 1.2\n{SPRING_DAMPER}\n\
         [motion]\nkind = \"forward\"\n\
         start = {{ v = {{ base = {{ wx = 2, wy = -3, wz = 4, vx = 0.2 }}, hinge = {{ wx = 1, wy = 2, wz = -2 }} }} }}\n"
    )
}

fn time(end: f64) -> String {
    format!("[time]\nend = {end}\noutput_step = {end}\n")
}

/// The system of a text without `[time]`.
fn system(text: &str, end: f64) -> System {
    support::system(&format!("{text}{}", time(end)))
}

/// Runs it to `end` with rows at these times.
fn run(system: &System, end: f64, times: &[f64], adaptive: Adaptive, rtol: f64) -> Run {
    let settings = Settings { rtol, adaptive, ..Settings::new(end, RowTimes::Times(times.into())) };
    let run = run_system(system, &settings);
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

/// The largest difference of q, v and a, each in units of the largest of its kind.
fn apart(reference: &Run, run: &Run) -> f64 {
    let mut worst = 0.0f64;
    for kind in ["q.", "v.", "a."] {
        let names: Vec<&String> = reference.names.iter().filter(|name| name.starts_with(kind)).collect();
        let columns = |of: &Run| names.iter().flat_map(|name| of.column(name)).collect::<Vec<f64>>();
        worst = worst.max(support::relative_difference(&columns(reference), &columns(run)));
    }
    worst
}
