//! What parts of a series have at t = 0, after each past.

use crate::one_sided::network;
use crate::{along, departure, force, slider};
use springpot::fractional::mittag_leffler::mittag_leffler;
use springpot::law::{Derivative, LeafState, Network, NetworkText, Past, Point, Start};

fn built(text: &str, values: &[f64], derivative: Derivative) -> Network {
    NetworkText::parse(text).unwrap().entry().build(values, derivative).unwrap()
}

/// Force and leaves at t = 0.
fn at_start(law: &Network, stroke: f64, jump: f64) -> (f64, Vec<LeafState>) {
    let state = law.begin(&Start { stroke, jump, inputs: &[] }).unwrap();
    let at = Point { t: 0.0, stroke, rate: 0.0, inputs: &[] };
    let mut leaves = Vec::new();
    law.leaves_now(&at, &state, &mut leaves);
    (law.now(&at, &state).force(), leaves)
}

fn strokes(leaves: &[LeafState]) -> Vec<f64> {
    leaves.iter().map(|leaf| leaf.stroke).collect()
}

fn assert_near(found: &[f64], wanted: &[f64], what: &str) {
    let is_near = found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-14);
    assert!(is_near, "{what}: {found:?}, not {wanted:?}");
}

/// Held since ever what flows carries nothing, so that what a preload stretches is at rest under no force; the past of a preload is that of all else.
#[test]
fn a_preload_has_relaxed() {
    let (k, l, c, a, f) = (1000.0, 300.0, 50.0, 0.5, 0.3);
    let flows = [("springpot(c, a)", vec![c, a]), ("dashpot(c)", vec![c]), ("friction(c, v0)", vec![c, 0.01])];
    for (flow, own) in &flows {
        let with = |values: &[f64]| [values, own].concat();
        let law =
            built(&format!("series(spring(k), parallel(spring(l), preload(f)), {flow})"), &with(&[k, l, f]), CAPUTO);
        let (pull, leaves) = at_start(&law, 0.002, 0.0);
        assert_eq!(pull, 0.0, "{flow}");
        assert_near(&strokes(&leaves), &[0.0, -f / l, -f / l, 0.002 + f / l], flow);
        let law = built(&format!("series(parallel(spring(l), preload(f)), {flow})"), &with(&[l, f]), CAPUTO);
        let (pull, leaves) = at_start(&law, 0.0, 0.0);
        assert_eq!(pull, 0.0, "{flow}");
        assert_near(&strokes(&leaves), &[-f / l, -f / l, f / l], flow);
    }
    let law = "series(parallel(spring(k), preload(g)), parallel(spring(l), preload(f)), springpot(c, a))";
    let (pull, leaves) = at_start(&built(law, &[k, -0.1, l, f, c, a], CAPUTO), 0.0, 0.0);
    assert!(pull.abs() < 1e-15);
    assert_near(&strokes(&leaves), &[1e-4, 1e-4, -1e-3, -1e-3, 9e-4], "two of them");
    // What flows beside a preload carries that, and all others have it.
    let law = "series(tension(k), spring(l), parallel(springpot(c, a), preload(f)))";
    let (pull, leaves) = at_start(&built(law, &[k, l, c, a, f], CAPUTO), 0.0, 0.0);
    assert_eq!(pull, f);
    assert_near(&strokes(&leaves)[..2], &[f / k, f / l], "beside what flows");
    // A rope takes what it can for free.
    for (f, wanted) in [(f, [0.0, -1e-3, -1e-3, 1e-3]), (-f, [-1e-3, 1e-3, 1e-3, 0.0])] {
        let law = "series(tension(k), parallel(spring(l), preload(f)), springpot(c, a))";
        let (pull, leaves) = at_start(&built(law, &[k, l, f, c, a], CAPUTO), 0.0, 0.0);
        assert_eq!(pull, 0.0);
        assert_near(&strokes(&leaves), &wanted, "behind a rope");
    }
    // Unloaded, it acts from t = 0 on.
    for (flow, own) in &flows {
        let law = format!("series(spring(k), parallel(spring(l), preload(f)), {flow})");
        let (pull, leaves) = at_start(&built(&law, &[&[k, l, f], &own[..]].concat(), JUMPED), 0.0, 0.0);
        assert!((pull - f * k / (k + l)).abs() < 1e-15, "{flow}: {pull}");
        assert_near(&strokes(&leaves), &[f / (k + l), -f / (k + l), -f / (k + l), 0.0], flow);
    }
}

const CAPUTO: Derivative = Derivative::Caputo;
const JUMPED: Derivative = Derivative::RiemannLiouville;

/// A spring that stiffens is where it has the force of its preload.
#[test]
fn a_stiffening_spring_has_relaxed() {
    let law = "series(parallel(polynomial(k1, k2, k3), preload(f)), spring(k), dashpot(c))";
    let (pull, leaves) = at_start(&built(law, &[1.0, 0.0, 5e4, -0.4, 900.0, 5.0], CAPUTO), 0.0, 0.0);
    assert!(pull.abs() < 1e-12, "{pull}");
    let x = leaves[0].stroke;
    assert!((x + 5e4 * x.powi(3) - 0.4).abs() < 1e-13, "{x}");
    assert!((x + leaves[3].stroke).abs() < 1e-14, "{leaves:?}");
}

/// A linear law with a preload, held since ever, gives the force of that without; prescribed and pushed, and it closes its balance.
#[test]
fn a_preload_in_series_moves_nothing() {
    let pushed = "kind = \"forward\"\nstart = { v = { q = 0.3 } }".to_owned();
    for motion in [along("0.01*sin(4*t)"), pushed] {
        for (bare, text, values) in [
            (
                "series(spring(k), spring(l), springpot(c, a))",
                "spring(k), parallel(spring(l), preload(f))",
                [50.0, 0.5],
            ),
            (
                "series(spring(k), spring(l), springpot(c, a))",
                "spring(k), parallel(spring(l), preload(f))",
                [50.0, 0.9],
            ),
        ] {
            let wanted =
                force(&slider(&[network(bare, &[1000.0, 300.0, values[0], values[1]])], &motion, 3.0, 60, 1e-9));
            for f in [-0.3, 0.03, 3.0] {
                let law =
                    network(&format!("series({text}, springpot(c, a))"), &[1000.0, 300.0, f, values[0], values[1]]);
                let run = slider(&[law], &motion, 3.0, 60, 1e-9);
                let off = departure(&force(&run), &wanted);
                assert!(off < 1e-8, "{f}: {off:e}");
                let left = run.column("energy.residual").iter().fold(0.0f64, |most, left| most.max(left.abs()));
                assert!(left < 1e-9, "{f}: {left:e} J");
            }
        }
    }
}

/// Stretched and held for a while a preload has relaxed for as long: by F = f·k/(k + l)·E_α(−(K/c)·t^α) with 1/K = 1/k + 1/l.
#[test]
fn a_preload_relaxes_while_it_is_held() {
    let (k, l, c, f, age) = (1000.0, 300.0, 50.0, 0.3, 0.02);
    for (flow, alpha) in [("springpot(c, a)", 0.5), ("dashpot(c)", 1.0)] {
        let own = if alpha == 1.0 { vec![c] } else { vec![c, alpha] };
        let law = format!("series(spring(k), parallel(spring(l), preload(f)), {flow})");
        let law = built(&law, &[&[k, l, f], &own[..]].concat(), JUMPED);
        let start = Start { stroke: 0.0, jump: 0.0, inputs: &[] };
        let state = Past::Held(age).state(&law, &start, 1e-11, 1.0).unwrap();
        let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
        let both = k * l / (k + l);
        let z = num_complex::Complex64::new(-both / c * f64::powf(age, alpha), 0.0);
        let left = mittag_leffler(alpha, 1.0, z).unwrap().re;
        let (found, wanted) = (law.now(&at, &state).force(), f * k / (k + l) * left);
        assert!((found - wanted).abs() < 1e-7 * f, "{flow}: {found}, not {wanted}");
    }
}

/// A stop without play is a spring, wherever its end is.
#[test]
fn a_stop_without_play_is_a_spring() {
    let pushed = "kind = \"forward\"\nstart = { v = { q = 0.3 } }".to_owned();
    for motion in [along("0.01*sin(4*t)"), pushed] {
        for (rest, values) in [
            ("dashpot(c)", &[100.0][..]),
            ("springpot(c, a)", &[50.0, 0.5]),
            ("parallel(spring(l), springpot(c, a))", &[200.0, 50.0, 0.5]),
        ] {
            let spring = network(&format!("series(spring(k), {rest})"), &[&[1000.0], values].concat());
            let wanted = force(&slider(&[spring], &motion, 2.0, 40, 1e-9));
            for end in [0.0, 0.002] {
                let stop = [&[1000.0, end, end], values].concat();
                let law = network(&format!("series(stop(k, lower, upper), {rest})"), &stop);
                let found = force(&slider(&[law], &motion, 2.0, 40, 1e-9));
                match end {
                    0.0 => assert_eq!(found, wanted, "{rest}"),
                    _ if rest.starts_with("parallel") => assert!(departure(&found, &wanted) > 1e-3, "{rest}"),
                    _ => assert!(departure(&found, &wanted) < 1e-8, "{rest}"),
                }
            }
        }
    }
}

/// Behind a jump at t = 0 all parts of a series have its force, springpots in what their derivatives are.
#[test]
fn a_jump_is_in_all_parts() {
    let cases: [(&str, &[f64], f64); 7] = [
        ("series(spring(k), springpot(c, a))", &[1000.0, 50.0, 0.5], 0.005),
        ("series(tension(k), springpot(c, a))", &[1000.0, 50.0, 0.5], 0.005),
        ("series(tension(k), springpot(c, a), springpot(d, b))", &[1000.0, 50.0, 0.5, 20.0, 0.2], 0.005),
        ("series(tension(k), dashpot(d), springpot(c, a))", &[1000.0, 20.0, 50.0, 0.5], 0.005),
        ("series(stop(k, lower, upper), springpot(c, a))", &[1000.0, 0.002, 0.004, 50.0, 0.5], -0.005),
        ("series(friction(f, v0), spring(k), springpot(c, a))", &[1.0, 0.01, 500.0, 50.0, 0.5], -0.005),
        ("series(friction(f, v0), spring(k), springpot(c, a))", &[1.0, 0.01, 500.0, 50.0, 0.5], 0.005),
    ];
    for (text, values, stroke) in cases {
        let (pull, leaves) = at_start(&built(text, values, JUMPED), stroke, stroke);
        assert!(pull.abs() > 0.9, "{text}: {pull}");
        for leaf in &leaves {
            assert!((leaf.force - pull).abs() < 1e-13 * pull.abs(), "{text}: {leaf:?} under {pull}");
        }
    }
    let law = "series(spring(k), springpot(c, a))";
    let law = built(law, &[1000.0, 50.0, 0.5], JUMPED);
    let state = law.begin(&Start { stroke: 0.005, jump: 0.005, inputs: &[] }).unwrap();
    assert_eq!(law.now(&Point { t: 0.0, stroke: 0.005, rate: 0.0, inputs: &[] }, &state).derivative, 0.1);
    // Side by side the springpot of the highest order has what is left.
    let law = "series(spring(k), parallel(spring(l), springpot(c, a), springpot(d, b)))";
    let (pull, leaves) = at_start(&built(law, &[1000.0, 300.0, 50.0, 0.5, 20.0, 0.8], JUMPED), 0.005, 0.005);
    let forces: Vec<f64> = leaves.iter().map(|leaf| leaf.force).collect();
    assert_eq!((pull, forces), (5.0, vec![5.0, 0.0, 0.0, 5.0]));
}
