//! What happened before t = 0: elements that were held, moved for ever, or were unloaded and jumped to where they are.

use crate::laws::slider;
use crate::{COLUMNS_OF_SLIDER, compare, compare_within, goes_on_to_the_bit};

const HELD: &str = "past = { held = \"0.3 s\" }\n";
const UNLOADED: &str = "past = \"unloaded\"\n";
const STEADY: &str = "past = \"steady\"\nperiod = \"0.2 s\"\n";

const KELVIN_VOIGT: &str = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 50, c = 40, alpha = 0.5 }\n";
const ZENER: &str = "law = \"fractional-zener\"\nparameters = { k_e = 20, k_m = 50, c = 30, alpha = 0.5 }\n";
const WLF: &str = "shift = { kind = \"wlf\", C1 = 8.86, C2 = \"101.6 K\", T_ref = \"293.15 K\" }\n\
                   expansion = { coefficient = \"2 mm/K\", T_ref = \"295.15 K\" }\ninputs = { T = \"T_m + 8*sin(9*t)\" }\n";

/// Two springpots one behind the other.
fn two(a_1: f64, a_2: f64) -> String {
    format!(
        "network = \"series(springpot(c_1, a_1), springpot(c_2, a_2))\"\n\
         parameters = {{ c_1 = 50, a_1 = {a_1}, c_2 = 30, a_2 = {a_2} }}\n"
    )
}

/// The mass, free, whose element happened to have this past.
fn after(law: &str, past: &str) -> String {
    slider(&format!("{law}{past}"))
}

/// The mass led by a motion that is periodic with 0.2 s.
fn led(law: &str, past: &str) -> String {
    after(law, past)
        .replace(
            "kind = \"forward\"\nstart = { q = { q1 = 0.1 }, v = { q1 = 1 } }",
            "kind = \"prescribed\"\njoints = { q1 = \"0.05*sin(10*pi*t) + 0.02*cos(20*pi*t)\" }",
        )
        .replace("rtol = 1e-10", "rtol = 1e-9")
}

const OF_LED: [&str; 3] = ["strut.force", "strut.stored", "strut.dissipated"];

#[test]
fn held() {
    let paths = [
        ("element.strut.c", 0.2),
        ("element.strut.alpha", 1e-3),
        ("element.strut.past.held", 1e-3),
        ("element.strut.rest", 1e-3),
        ("motion.start.q.q1", 1e-3),
    ];
    compare(&after(KELVIN_VOIGT, HELD), &COLUMNS_OF_SLIDER, &paths);
    compare(&after(ZENER, HELD), &COLUMNS_OF_SLIDER, &paths);
    // Along a given motion.
    compare(&led(ZENER, HELD), &OF_LED, &paths[1..4]);
}

#[test]
fn held_springpots_in_series() {
    for (a_1, a_2) in [(0.02, 0.98), (0.5, 0.5)] {
        let paths = [
            ("element.strut.c_1", 0.2),
            ("element.strut.a_1", 1e-3),
            ("element.strut.a_2", 1e-3),
            ("element.strut.past.held", 1e-3),
            ("motion.start.q.q1", 1e-3),
        ];
        compare(&after(&two(a_1, a_2), HELD), &COLUMNS_OF_SLIDER, &paths);
    }
}

/// What is not linear goes through the time until t = 0 in steps.
#[test]
fn held_where_it_is_not_linear() {
    let cubic = "network = \"series(polynomial(k, k_2, k_3), springpot(c, a))\"\n\
                 parameters = { k = 50, k_2 = 0, k_3 = 900, c = 30, a = 0.5 }\n";
    let paths = [("element.strut.k_3", 4.0), ("element.strut.a", 1e-3), ("element.strut.rest", 1e-3)];
    compare(&after(cubic, HELD), &COLUMNS_OF_SLIDER, &paths);
}

#[test]
fn held_under_heat() {
    let text = format!("[constants]\nT_m = 296\n{}", after(ZENER, &format!("{WLF}{HELD}")));
    let paths = [
        ("element.strut.alpha", 1e-3),
        ("element.strut.past.held", 2e-4),
        ("element.strut.shift.C1", 1e-2),
        ("element.strut.expansion.coefficient", 1e-5),
        ("constants.T_m", 2e-2),
    ];
    compare(&text, &COLUMNS_OF_SLIDER, &paths);
    let warms = after(
        KELVIN_VOIGT,
        "shift = { kind = \"arrhenius\", energy = 80000, T_ref = \"293.15 K\" }\n\
         thermal = { capacity = \"0.5 J/K\", conductance = \"0.2 W/K\", ambient = \"295.15 K\", start = \"297 K\" }\n\
         past = { held = \"0.3 s\" }",
    );
    let paths = [("element.strut.thermal.start", 1e-2), ("element.strut.c", 0.1), ("element.strut.past.held", 2e-4)];
    compare(&warms, &["q.q1", "strut.force", "strut.T", "strut.heat"], &paths);
}

#[test]
fn steady() {
    let paths = [("element.strut.alpha", 1e-3), ("element.strut.k", 0.2), ("element.strut.rest", 1e-3)];
    compare(&led(KELVIN_VOIGT, STEADY), &OF_LED, &paths);
    let paths = [("element.strut.a_1", 1e-3), ("element.strut.c_2", 0.2), ("element.strut.rest", 1e-3)];
    compare(&led(&two(0.3, 0.6), STEADY), &OF_LED, &paths);
    // What slips goes round a loop.
    let rubber = "network = \"parallel(jenkins(k_j, F_y), springpot(c, a))\"\n\
                  parameters = { k_j = 300, F_y = 5, c = 30, a = 0.5 }\n";
    let paths = [("element.strut.k_j", 1.0), ("element.strut.F_y", 1e-2), ("element.strut.a", 1e-3)];
    compare(&led(rubber, STEADY), &OF_LED, &paths);
}

/// The stroke of a line along a given motion bends with the places of its ends.
#[test]
fn steady_of_a_line() {
    let text = led(ZENER, STEADY).replace(
        "joint = \"q1\"\nrest = 0.03",
        "from = { body = \"world\", point = [0.3, 0.2, 0.1] }\nto = { body = \"cart\", point = [0, 0.02, 0] }\nrest_length = 0.3",
    );
    let paths = [("element.strut.from.point.1", 1e-3), ("element.strut.k_m", 0.2), ("element.strut.rest_length", 1e-3)];
    compare(&text, &OF_LED, &paths);
}

#[test]
fn steady_under_heat() {
    let heat = WLF.replace("8*sin(9*t)", "0*t");
    let text = format!("[constants]\nT_m = 296\n{}", led(&two(0.3, 0.6), &format!("{heat}{STEADY}")));
    let paths = [("element.strut.a_2", 1e-3), ("element.strut.shift.C2", 0.1), ("constants.T_m", 2e-2)];
    compare(&text, &OF_LED, &paths);
}

#[test]
fn unloaded_springs_behind_springpots() {
    let paths = [
        ("element.strut.k_m", 0.2),
        ("element.strut.alpha", 1e-3),
        ("element.strut.rest", 1e-3),
        ("motion.start.q.q1", 1e-3),
        ("robot.body.cart.mass", 1e-2),
    ];
    let columns = ["q.q1", "v.q1", "a.q1", "strut.force"];
    compare(&after(ZENER, UNLOADED), &columns, &paths);
    // From x(0) = 0 only changes of it jump.
    compare(&after(ZENER, UNLOADED).replace("q1 = 0.1", "q1 = 0.03"), &columns, &paths[1..4]);
    let heated = format!("[constants]\nT_m = 296\n{}", after(ZENER, &format!("{WLF}{UNLOADED}")));
    compare(&heated, &columns, &[("constants.T_m", 2e-2), ("element.strut.alpha", 1e-3)]);
}

/// All that flows at once has an impulse at t = 0.
#[test]
fn unloaded_springpots_in_series() {
    for ((a_1, a_2), start) in [((0.02, 0.05), 0.1), ((0.9, 0.98), 0.1), ((0.3, 0.6), 0.03)] {
        let text = after(&two(a_1, a_2), UNLOADED).replace("q1 = 0.1", &format!("q1 = {start}"));
        let paths = [
            ("element.strut.c_1", 0.2),
            ("element.strut.a_1", 1e-3),
            ("element.strut.a_2", 1e-3),
            ("element.strut.rest", 1e-3),
            ("robot.body.cart.mass", 1e-2),
        ];
        // Next to t = 0 their share of a jump is known to 1e-8, and of differences to less.
        compare_within(5e-7, &text, &["q.q1", "v.q1", "strut.force"], &paths);
    }
    let mixed = "network = \"parallel(series(parallel(springpot(c_1, a_1), spring(k)), springpot(c_2, a_2), dashpot(d)), spring(k_0))\"\n\
                 parameters = { c_1 = 50, a_1 = 0.2, k = 10, c_2 = 30, a_2 = 0.7, d = 3, k_0 = 5 }\n";
    let paths = [("element.strut.k", 0.1), ("element.strut.a_1", 1e-3), ("element.strut.d", 0.03)];
    compare(&after(mixed, UNLOADED), &["q.q1", "v.q1", "strut.force"], &paths);
    compare(
        &led(&two(0.3, 0.6), UNLOADED),
        &["strut.force"],
        &[("element.strut.a_1", 1e-3), ("element.strut.rest", 1e-3)],
    );
}

/// Of a line that turns the impulse turns with it.
#[test]
fn unloaded_springpots_of_a_line() {
    let text = after(&two(0.6, 0.9), UNLOADED).replace(
        "joint = \"q1\"\nrest = 0.03",
        "from = { body = \"world\", point = [0.3, 0.2, 0.1] }\nto = { body = \"cart\", point = [0, 0.02, 0] }\nrest_length = 0.2",
    );
    let paths = [("element.strut.from.point.1", 1e-3), ("motion.start.q.q1", 1e-3), ("element.strut.a_2", 1e-3)];
    compare_within(5e-7, &text, &["q.q1", "v.q1", "strut.force"], &paths);
}

#[test]
fn pasts_of_steps_of_one_size() {
    for past in [HELD, UNLOADED] {
        let text = after(ZENER, past)
            .replace("[solver]\nrtol = 1e-10", "[solver]\nmethod = \"backward-euler\"\nstep = \"2 ms\"");
        let paths = [("element.strut.k_m", 0.2), ("element.strut.alpha", 1e-3), ("motion.start.q.q1", 1e-3)];
        compare(&text, &["q.q1", "v.q1", "strut.force"], &paths);
    }
}

#[test]
fn runs_with_a_past_go_on() {
    let text = after(ZENER, HELD);
    goes_on_to_the_bit(&text, "element.strut.alpha,element.strut.past.held", 0.1, &[0.15, 0.35]);
    let text = after(&two(0.6, 0.9), UNLOADED);
    goes_on_to_the_bit(&text, "element.strut.a_1,motion.start.q.q1", 0.1, &[0.15, 0.35]);
}
