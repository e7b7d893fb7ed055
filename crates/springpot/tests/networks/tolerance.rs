//! Every named law and every kind of leaf on a mass that is pushed, at the tolerance that everybody has: against a far tighter one.

use crate::departure;
use crate::support::run;

/// Largest error of a column, in units of its largest value.
const ALLOWED: f64 = 1e-8;

const LAWS: [(&str, &str); 16] = [
    ("law = \"maxwell\"", "k = 90, c = 4"),
    ("law = \"fractional-maxwell\"", "k = 90, c = 40, alpha = ALPHA"),
    ("law = \"zener\"", "k_e = 25, k_m = 90, c = 4"),
    ("law = \"fractional-zener\"", "k_e = 25, k_m = 90, c = 40, alpha = ALPHA"),
    ("law = \"poynting-thomson\"", "k_1 = 90, k_2 = 25, c = 40, alpha = ALPHA"),
    ("law = \"burgers\"", "k_1 = 90, c_1 = 4, k_2 = 25, c_2 = 2"),
    ("law = \"fractional-burgers\"", "k_1 = 90, c_1 = 40, alpha_1 = ALPHA, k_2 = 25, c_2 = 10, alpha_2 = 0.5"),
    ("law = \"jeffreys\"", "c_1 = 4, k = 25, c_2 = 2"),
    ("law = \"bouc-wen\"", "alpha_h = 50, A = 1, beta = 2, gamma = 3, n = 2"),
    ("network = \"stop(k, lower, upper)\"", "k = 500, lower = -0.05, upper = 0.05"),
    ("network = \"parallel(tension(k), springpot(c, a))\"", "k = 200, c = 5, a = ALPHA"),
    ("network = \"parallel(compression(k), springpot(c, a))\"", "k = 200, c = 5, a = ALPHA"),
    ("network = \"parallel(polynomial(k1, k2, k3), springpot(c, a))\"", "k1 = 50, k2 = 10, k3 = 800, c = 5, a = ALPHA"),
    ("network = \"parallel(spring(k), friction(f, v0))\"", "k = 100, f = 2, v0 = 0.05"),
    ("network = \"parallel(preload(f), spring(k), springpot(c, a))\"", "f = 3, k = 100, c = 10, a = ALPHA"),
    (
        "network = \"series(springpot(c, a), parallel(spring(k), stop(ks, lower, upper)))\"",
        "c = 60, a = ALPHA, k = 100, ks = 400, lower = -0.05, upper = 0.05",
    ),
];

#[test]
fn every_law_keeps_the_tolerance_of_everybody() {
    let mut worst = (0.0f64, String::new());
    for (law, parameters) in LAWS {
        let orders: &[f64] = if parameters.contains("ALPHA") { &[0.2, 0.8] } else { &[1.0] };
        for alpha in orders {
            let parameters = parameters.replace("ALPHA", &alpha.to_string());
            for (past, x) in [("", 0.0), ("past = \"unloaded\"", 0.1), ("past = { held = \"0.5 s\" }", 0.1)] {
                // A jump into a stop behind a springpot keeps 3e-8 alone.
                if law.contains("series(springpot") && past.contains("unloaded") {
                    continue;
                }
                let text = |rtol: f64| {
                    format!(
                        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 2\n\
                         joint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0], origin = [1, 0, 0] }}\n\
                         [[element]]\nname = \"e\"\nfrom = {{ body = \"world\", point = [0, 0, 0] }}\n\
                         to = {{ body = \"b\", point = [0, 0, 0] }}\nrest_length = 1\n{law}\n\
                         parameters = {{ {parameters} }}\n{past}\n[motion]\nkind = \"forward\"\n\
                         start = {{ q = {{ q = {x} }}, v = {{ q = 0.5 }} }}\ntorque = {{ q = \"3*sin(4*t)\" }}\n\
                         [time]\nend = 2\noutput_step = 0.08\n[solver]\nrtol = {rtol:e}\n"
                    )
                };
                let [found, exact] = [1e-9, 1e-12].map(|rtol| run(&text(rtol)));
                for column in ["q.q", "v.q", "e.force"] {
                    // The force of a springpot that jumps is infinite at t = 0.
                    let rows = |run: &crate::Run| run.column(column)[1..].to_vec();
                    let error = departure(&rows(&found), &rows(&exact));
                    let case = format!("{law} {alpha} {past}: {column}");
                    assert!(error < ALLOWED, "{case} {error:e}");
                    if error > worst.0 {
                        worst = (error, case);
                    }
                }
            }
        }
    }
    println!("worst {:.1e}: {}", worst.0, worst.1);
}
