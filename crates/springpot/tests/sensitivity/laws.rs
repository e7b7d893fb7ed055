//! Every leaf and network alone.

use crate::replay::Replay;
use springpot::collocation::Nodes;
use springpot::dual::Dual;
use springpot::fractional::Form;
use springpot::law::leaf::{
    BoucWen, Coefficient, EndStop, ExpressionLeaf, Friction, Hysteresis, Jenkins, Polynomial, Preload, Source, Spencer,
    Stack, Stop, Viscous, VoltageDrop,
};
use springpot::law::{Catalog, Course, Derivative, Entry, Expansion, Heat, Network, PrandtlIshlinskii, Shift, Thermal};
use springpot::signal::StrokeExpression;
use std::sync::Arc;

const KNOWN: f64 = 1e-9;

/// a + b·u of the first input.
fn following(constant: Dual, slope: Dual) -> Coefficient {
    Coefficient { slope, input: Some(0), ..Coefficient::constant(constant) }
}

/// A law of a text.
fn said(text: &str, n: &[Dual]) -> Network {
    let expression = Arc::new(StrokeExpression::parse(text).unwrap());
    Network::leaf(ExpressionLeaf::new(expression, n.to_vec()))
}

/// Leaves that keep nothing.
fn simple() -> Vec<(&'static str, Replay)> {
    vec![
        (
            "spring and dashpot",
            Replay::new(|n| Network::parallel([Network::spring(n[0]), Network::dashpot(n[1])]), &[20.0, 3.0]),
        ),
        ("expression", Replay::new(|n| said("a*sinh(x/b) + max(x - d, 0)*a", n), &[2.0, 0.03, 0.01])),
        (
            "expression of rates",
            Replay::new(|n| said("k*x + c*v*abs(v)^p + f*tanh(v/s)", n), &[20.0, 3.0, 0.7, 1.5, 0.3]),
        ),
        ("preload", Replay::new(|n| Network::leaf(Preload { force: n[0] }), &[2.0])),
        ("polynomial", Replay::new(|n| Network::leaf(Polynomial::new([n[0], n[1], n[2]])), &[20.0, -30.0, 900.0])),
        ("tension", Replay::new(|n| Network::leaf(Stop::tension(n[0])), &[60.0])),
        ("stop", Replay::new(|n| Network::leaf(Stop::new(n[0], n[1], n[2]).unwrap()), &[80.0, -0.02, 0.013])),
        ("friction", Replay::new(|n| Network::leaf(Friction::new(n[0], n[1]).unwrap()), &[1.5, 0.3])),
        (
            "end stop",
            Replay::new(|n| Network::leaf(EndStop::new(n[0], n[1], n[2], n[3]).unwrap()), &[90.0, 1.3, -0.021, 0.017]),
        ),
        (
            "viscous",
            Replay::new(|n| Network::leaf(Viscous { viscosity: following(n[0], n[1]) }), &[3.0, 0.7])
                .with_inputs(&[[2.0, 1.0, 5.0]]),
        ),
        (
            "varying friction",
            Replay::new(|n| Network::leaf(Friction { force: following(n[0], n[1]), rate: n[2] }), &[3.0, 0.7, 0.2])
                .with_inputs(&[[2.0, 1.0, 5.0]]),
        ),
        (
            "source",
            Replay::new(|n| Network::leaf(Source { gain: n[0], reference: n[1], input: 1 }), &[3.0, 0.7])
                .with_inputs(&[[2.0, 1.0, 5.0], [1.0, 0.4, 11.0]]),
        ),
    ]
}

/// Leaves with inner variables.
fn inner() -> Vec<(&'static str, Replay)> {
    let bouc_wen = |n: &[Dual]| Network::leaf(BoucWen::new(n[0], n[1], n[2], n[3], n[4]).unwrap());
    let varying = |n: &[Dual]| {
        let hysteresis = Hysteresis::new(n[2], n[3], n[4], n[5]).unwrap();
        Network::leaf(BoucWen::varying(following(n[0], n[1]), hysteresis))
    };
    let spencer = |n: &[Dual]| {
        Network::leaf(Spencer {
            fast: following(n[0], n[1]),
            slow: following(n[2], n[3]),
            inner_stiffness: n[4],
            stiffness: n[5],
            rest: n[6],
            alpha: following(n[7], n[8]),
            hysteresis: Hysteresis::new(n[9], n[10], n[11], n[12]).unwrap(),
        })
    };
    let input = [[2.0, 1.0, 5.0]];
    vec![
        ("bouc-wen", Replay::new(bouc_wen, &[50.0, 1.0, 300.0, 400.0, 2.0])),
        ("bouc-wen of n = 1", Replay::new(bouc_wen, &[50.0, 0.8, -5.0, 15.0, 1.2])),
        ("varying bouc-wen", Replay::new(varying, &[50.0, 4.0, 1.0, 100.0, 250.0, 1.5]).with_inputs(&input)),
        (
            "spencer",
            Replay::new(spencer, &[7.0, 1.0, 30.0, 3.0, 40.0, 9.0, 0.01, 60.0, 8.0, 1.1, 200.0, 500.0, 2.0])
                .with_inputs(&input),
        ),
    ]
}

/// Laws of the catalog whose driver lags.
fn lagged() -> Vec<(&'static str, Replay)> {
    fn of(name: &str, n: &[Dual]) -> Network {
        (Catalog::standard().get(name).unwrap().build)(n, Derivative::Caputo).unwrap()
    }
    let input = [[2.0, 1.0, 5.0]];
    vec![
        (
            "lagging spencer",
            Replay::new(
                |n| of("spencer", n),
                &[7.0, 1.0, 30.0, 3.0, 40.0, 9.0, 0.01, 60.0, 8.0, 1.1, 200.0, 500.0, 2.0, 30.0],
            )
            .with_inputs(&input),
        ),
        (
            "lagging bouc-wen",
            Replay::new(|n| of("bouc-wen-damper", n), &[7.0, 1.0, 40.0, 0.01, 60.0, 8.0, 1.1, 200.0, 500.0, 2.0, 30.0])
                .with_inputs(&input),
        ),
        ("bingham", Replay::new(|n| of("bingham", n), &[4.0, 1.0, 0.2, 3.0, 0.5, 1.0, 25.0]).with_inputs(&input)),
    ]
}

fn stacks() -> Vec<(&'static str, Replay)> {
    fn stack(n: &[Dual], drop: VoltageDrop) -> Network {
        let [coupling, capacitance, resistance, stiffness] = [n[0], n[1], n[2], n[3]];
        Network::leaf(Stack { coupling, capacitance, resistance, stiffness, drop, range: [-1e3, 1e3] })
    }
    fn of_plays(n: &[Dual], feed_forward: bool) -> Network {
        let stops = PrandtlIshlinskii::new(&n[4..6], &n[6..8]).unwrap().stops().to_vec();
        stack(n, VoltageDrop::Stops { stops, feed_forward })
    }
    let own = [2.0, 0.02, 1.5, 500.0];
    let with = |more: &[f64]| [&own, more].concat();
    let input = [[10.0, 12.0, 7.0]];
    vec![
        ("stack", Replay::new(|n| stack(n, VoltageDrop::None), &own).with_inputs(&input)),
        (
            "stack with bouc-wen",
            Replay::new(
                |n| {
                    let hysteresis = Hysteresis::new(n[5], n[6], n[7], n[8]).unwrap();
                    stack(n, VoltageDrop::BoucWen { alpha_h: n[4], hysteresis })
                },
                &with(&[0.4, 1.1, 0.02, 0.1, 1.4]),
            )
            .with_inputs(&input),
        ),
        ("stack with stops", Replay::new(|n| of_plays(n, false), &with(&[0.1, 0.08, 1.1, 6.3])).with_inputs(&input)),
        (
            "stack with feed-forward",
            Replay::new(|n| of_plays(n, true), &with(&[0.1, 0.08, 1.1, 6.3])).with_inputs(&input),
        ),
    ]
}

#[test]
fn leaves_that_keep_nothing() {
    for (name, replay) in simple() {
        replay.check(name, KNOWN);
    }
}

#[test]
fn leaves_with_inner_variables() {
    for (name, replay) in inner() {
        replay.check(name, KNOWN);
    }
    for nodes in [Nodes::One, Nodes::Midpoint] {
        for (name, replay) in inner() {
            replay.told(nodes, Form::Strokes).check(name, KNOWN);
        }
    }
}

#[test]
fn leaves_behind_a_driver() {
    for (name, replay) in lagged() {
        replay.check(name, KNOWN);
    }
    for (name, replay) in lagged() {
        replay.told(Nodes::Midpoint, Form::Rates).check(name, KNOWN);
    }
}

#[test]
fn stacks_and_their_circuits() {
    for (name, replay) in stacks() {
        replay.check(name, KNOWN);
    }
}

fn series() -> Vec<(&'static str, Replay)> {
    fn beside(parts: [Network; 2]) -> Network {
        Network::parallel(parts)
    }
    let input = [[2.0, 1.0, 5.0]];
    // Rates of parts are differences of their strokes.
    let all = vec![
        ("maxwell", Replay::new(|n| Network::series([Network::spring(n[0]), Network::dashpot(n[1])]), &[40.0, 1.5])),
        (
            "zener",
            Replay::new(
                |n| {
                    let maxwell = Network::series([Network::spring(n[1]), Network::dashpot(n[2])]);
                    beside([Network::spring(n[0]), maxwell])
                },
                &[10.0, 40.0, 1.5],
            ),
        ),
        (
            "yielding",
            Replay::new(
                |n| {
                    let voigt = |k, c| beside([Network::spring(k), Network::dashpot(c)]);
                    Network::series([voigt(n[0], n[1]), voigt(n[2], n[3])])
                },
                &[10.0, 0.8, 40.0, 1.5],
            ),
        ),
        (
            "springs of which one is bent",
            Replay::new(
                |n| {
                    let bent = Network::leaf(Polynomial::new([n[1], 0.0.into(), n[2]]));
                    Network::series([Network::spring(n[0]), beside([bent, Network::leaf(Preload { force: n[3] })])])
                },
                &[30.0, 20.0, 60000.0, 0.4],
            ),
        ),
        (
            "bent spring and dashpot",
            Replay::new(
                |n| Network::series([Network::leaf(Polynomial::new([n[0], 0.0.into(), n[1]])), Network::dashpot(n[2])]),
                &[30.0, 60000.0, 1.5],
            ),
        ),
        (
            "bouc-wen and dashpot",
            Replay::new(
                |n| {
                    let hysteresis = Network::leaf(BoucWen::new(n[0], n[1], n[2], n[3], 2.0).unwrap());
                    Network::series([beside([hysteresis, Network::spring(n[4])]), Network::dashpot(n[5])])
                },
                &[50.0, 1.0, 100.0, 250.0, 20.0, 6.0],
            ),
        ),
        (
            "viscous and spring",
            Replay::new(
                |n| {
                    let viscous = Network::leaf(Viscous { viscosity: following(n[0], n[1]) });
                    Network::series([viscous, Network::spring(n[2])])
                },
                &[1.0, 0.3, 40.0],
            )
            .with_inputs(&input),
        ),
        (
            "series within series",
            Replay::new(
                |n| {
                    let maxwell = Network::series([Network::spring(n[1]), Network::dashpot(n[2])]);
                    Network::series([Network::spring(n[0]), beside([Network::dashpot(n[3]), maxwell])])
                },
                &[30.0, 40.0, 1.5, 0.6],
            ),
        ),
        (
            "rope and damper",
            Replay::new(
                |n| {
                    let voigt = beside([Network::spring(n[1]), Network::dashpot(n[2])]);
                    Network::series([Network::leaf(Stop::tension(n[0])), voigt])
                },
                &[60.0, 30.0, 1.5],
            ),
        ),
        (
            "stop and zener",
            Replay::new(
                |n| {
                    let maxwell = Network::series([Network::spring(n[4]), Network::dashpot(n[5])]);
                    let stop = Network::leaf(Stop::new(n[0], n[1], n[2]).unwrap());
                    Network::series([stop, beside([Network::spring(n[3]), maxwell])])
                },
                &[60.0, -0.01, 0.012, 30.0, 40.0, 1.5],
            ),
        ),
        (
            "friction and spring",
            Replay::new(
                |n| Network::series([Network::spring(n[0]), Network::leaf(Friction::new(n[1], n[2]).unwrap())]),
                &[60.0, 1.0, 0.1],
            ),
        ),
        (
            "rope, damper and friction",
            Replay::new(
                |n| {
                    let voigt = beside([Network::spring(n[1]), Network::dashpot(n[2])]);
                    let friction = Network::leaf(Friction::new(n[3], n[4]).unwrap());
                    Network::series([Network::leaf(Stop::tension(n[0])), voigt, friction])
                },
                &[60.0, 30.0, 1.5, 1.0, 0.2],
            ),
        ),
    ];
    // Hysteresis bends more sharply, and its shape matters less; what lets go must not do so within a difference.
    let known = |name: &str| match name {
        "bouc-wen and dashpot" => [6e-4, 5e-4],
        "rope, damper and friction" => [3e-4, 1e-4],
        _ => [2e-3, 1e-4],
    };
    all.into_iter()
        .map(|(name, replay)| {
            let [difference, rounding] = known(name);
            (name, Replay { difference, rounding, ..replay })
        })
        .collect()
}

#[test]
fn parts_in_series() {
    for (name, replay) in series() {
        replay.check(name, KNOWN);
    }
    for (name, replay) in series() {
        Replay { course: Course::Given, ..replay }.check(name, KNOWN);
    }
}

#[test]
fn parts_in_series_at_one_node() {
    for nodes in [Nodes::One, Nodes::Midpoint] {
        for (name, replay) in series() {
            replay.told(nodes, Form::Strokes).check(name, KNOWN);
        }
    }
}

/// Springpots behind others, held since ever.
fn springpots_in_series() -> Vec<(&'static str, Replay)> {
    fn springpot(c: Dual, alpha: Dual) -> Network {
        Network::springpot(c, alpha, Derivative::Caputo)
    }
    let all = vec![
        (
            "fractional maxwell",
            Replay::new(|n| Network::series([Network::spring(n[0]), springpot(n[1], n[2])]), &[40.0, 6.0, 0.4])
                .by_orders(&[2]),
        ),
        (
            "fractional zener",
            Replay::new(
                |n| {
                    let maxwell = Network::series([Network::spring(n[1]), springpot(n[2], n[3])]);
                    Network::parallel([Network::spring(n[0]), maxwell])
                },
                &[10.0, 40.0, 6.0, 0.7],
            )
            .by_orders(&[3]),
        ),
        (
            "two springpots",
            Replay::new(|n| Network::series([springpot(n[0], n[1]), springpot(n[2], n[3])]), &[20.0, 0.3, 6.0, 0.8])
                .by_orders(&[1, 3]),
        ),
        (
            "springpot beside a spring behind both",
            Replay::new(
                |n| {
                    let voigt = |k, c, alpha| Network::parallel([Network::spring(k), springpot(c, alpha)]);
                    Network::series([voigt(n[0], n[1], n[2]), voigt(n[3], n[4], n[5])])
                },
                &[30.0, 6.0, 0.4, 20.0, 3.0, 0.6],
            )
            .by_orders(&[2, 5]),
        ),
        (
            "bent spring and springpot",
            Replay::new(
                |n| {
                    let bent = Network::leaf(Polynomial::new([n[0], 0.0.into(), n[1]]));
                    Network::series([bent, springpot(n[2], n[3])])
                },
                &[30.0, 60000.0, 6.0, 0.5],
            )
            .by_orders(&[3]),
        ),
        (
            "rope and springpot",
            Replay::new(
                |n| {
                    let voigt = Network::parallel([Network::spring(n[1]), springpot(n[2], n[3])]);
                    Network::series([Network::leaf(Stop::tension(n[0])), voigt])
                },
                &[60.0, 30.0, 1.5, 0.6],
            )
            .by_orders(&[3]),
        ),
    ];
    all.into_iter().map(|(name, replay)| (name, Replay { difference: 2e-3, rounding: 1e-4, ..replay })).collect()
}

#[test]
fn springpots_behind_others() {
    for course in [Course::Sought, Course::Given] {
        for (name, replay) in springpots_in_series() {
            Replay { course, ..replay }.check(name, KNOWN);
        }
    }
}

/// A law under a temperature that is told.
fn heated(numbers: &[Dual], heat: Heat, law: fn(&[Dual]) -> Network) -> Network {
    let entry = Entry {
        name: "own".into(),
        equation: "".into(),
        params: Vec::new(),
        inputs: Vec::new(),
        source: "".into(),
        build: Arc::new(move |numbers, _| Ok(law(numbers))),
    };
    (entry.with_heat(heat).unwrap().build)(numbers, Derivative::Caputo).unwrap()
}

const SHIFT: Shift = Shift::Wlf { c1: 8.86, c2: 101.6, reference: 293.15 };

fn shifted(numbers: &[Dual]) -> Network {
    let heat = Heat { shift: Some(SHIFT), ..Heat::default() };
    heated(numbers, heat, |n| {
        let maxwell = Network::series([Network::spring(n[0]), Network::dashpot(n[1])]);
        let friction = Network::leaf(Friction::new(n[4], n[5]).unwrap());
        let hysteresis = Network::leaf(BoucWen::new(n[6], 1.0, n[7], 250.0, 2.0).unwrap());
        Network::parallel([maxwell, Network::spring(n[2]), Network::dashpot(n[3]), friction, hysteresis])
    })
}

fn stretched(numbers: &[Dual]) -> Network {
    let expansion = Some(Expansion { coefficient: 1e-4, reference: 290.0 });
    heated(numbers, Heat { shift: Some(SHIFT), expansion, ..Heat::default() }, |n| {
        Network::parallel([Network::spring(n[0]), Network::dashpot(n[1])])
    })
}

#[test]
fn laws_under_a_temperature_that_is_told() {
    for temperature in [[299.0, 0.0, 1.0], [299.0, 6.0, 7.0]] {
        let told = |build: fn(&[Dual]) -> Network, values: &[f64]| {
            let replay = Replay::new(build, values).with_inputs(&[temperature]);
            Replay { still: 1, rounding: 1e-4, ..replay }
        };
        told(shifted, &[40.0, 1.5, 20.0, 0.8, 1.0, 0.2, 30.0, 100.0]).check("shifted", KNOWN);
        told(stretched, &[40.0, 1.5]).check("stretched", KNOWN);
        Replay { still: 0, ..told(stretched, &[40.0, 1.5]) }.check("stretched by a temperature that moves", KNOWN);
    }
}

/// A law under heat, all numbers of which move: those of the heat are the first.
fn warmed(n: &[Dual], heat: fn(&[f64]) -> Heat, count: usize, law: fn(&[Dual]) -> Network) -> Network {
    let of = |take: fn(&Dual) -> f64| n[..count].iter().map(take).collect::<Vec<f64>>();
    let [values, moved] = [of(|number| number.value), of(|number| number.slope)];
    heated(&n[count..], heat(&values), law).with_moving_heat(heat(&moved))
}

fn wlf(n: &[f64]) -> Heat {
    Heat { shift: Some(Shift::Wlf { c1: n[0], c2: n[1], reference: n[2] }), ..Heat::default() }
}

fn warming(n: &[f64]) -> Heat {
    let shift = Some(Shift::Arrhenius { energy: n[0], reference: n[1] });
    let thermal = Some(Thermal { capacity: n[2], conductance: n[3], ambient: n[4], start: n[5] });
    Heat { shift, thermal, expansion: None }
}

fn stretching(n: &[f64]) -> Heat {
    let thermal = Some(Thermal { capacity: n[0], conductance: n[1], ambient: n[2], start: n[3] });
    Heat { thermal, expansion: Some(Expansion { coefficient: n[4], reference: n[5] }), ..wlf(&n[6..]) }
}

fn voigt(n: &[Dual]) -> Network {
    Network::parallel([Network::spring(n[0]), Network::springpot(n[1], n[2], Derivative::Caputo)])
}

fn zener(n: &[Dual]) -> Network {
    let maxwell = Network::series([Network::spring(n[1]), Network::springpot(n[2], n[3], Derivative::Caputo)]);
    Network::parallel([Network::spring(n[0]), maxwell])
}

/// The clock and its nodes move with what temperature does, and with the temperature, which is told or follows from losses.
#[test]
fn clocks_that_parameters_move() {
    const WARM: [f64; 4] = [300.0, 0.4, 0.2, 290.0];
    let all = [
        (
            "voigt by wlf",
            Replay::new(|n| warmed(n, wlf, 3, voigt), &[8.86, 101.6, 293.15, 20.0, 6.0, 0.5])
                .by_orders(&[5])
                .with_inputs(&[[299.0, 6.0, 7.0]]),
        ),
        (
            "zener by wlf",
            Replay::new(|n| warmed(n, wlf, 3, zener), &[8.86, 101.6, 293.15, 20.0, 30.0, 6.0, 0.4])
                .by_orders(&[6])
                .with_inputs(&[[299.0, 6.0, 7.0]]),
        ),
        (
            "voigt that warms",
            Replay::new(
                |n| warmed(n, warming, 6, voigt),
                &[80000.0, 293.0, 0.01, WARM[2], WARM[3], WARM[0], 20.0, 6.0, 0.5],
            )
            .by_orders(&[8]),
        ),
        (
            "zener that warms",
            Replay::new(
                |n| warmed(n, warming, 6, zener),
                &[80000.0, 293.0, 0.01, WARM[2], WARM[3], WARM[0], 20.0, 30.0, 6.0, 0.5],
            )
            .by_orders(&[9]),
        ),
        (
            "voigt that warms and stretches",
            Replay::new(
                |n| warmed(n, stretching, 9, voigt),
                &[0.02, WARM[2], WARM[3], WARM[0], 1e-3, 295.0, 8.86, 101.6, 293.15, 20.0, 6.0, 0.5],
            )
            .by_orders(&[11]),
        ),
    ];
    for (name, replay) in all {
        Replay { difference: 2e-6, rounding: 1e-6, moves_clock: true, ..replay }.check(name, 1e-7);
    }
}

#[test]
fn springs_that_slip() {
    let alone = |n: &[Dual]| Network::leaf(Jenkins::new(n[0], n[1]).unwrap());
    let all = [
        ("jenkins", Replay::new(alone, &[60.0, 1.1])),
        (
            "jenkins behind springs",
            Replay::new(
                |n| {
                    let slips = |k, limit| Network::leaf(Jenkins::new(k, limit).unwrap());
                    Network::series([slips(n[0], n[1]), Network::spring(n[2]), slips(n[3], n[4])])
                },
                &[90.0, 2.0, 200.0, 150.0, 1.1],
            ),
        ),
        (
            "filled rubber",
            Replay::new(
                |n| (Catalog::standard().get("filled-rubber").unwrap().build)(n, Derivative::Caputo).unwrap(),
                &[20.0, 6.0, 0.4, 40.0, 60.0, 0.7, 1.9],
            )
            .by_orders(&[2]),
        ),
    ];
    for (name, replay) in all {
        // Not so far that it begins to slip within a difference.
        Replay { difference: 1e-4, rounding: 1e-4, ..replay }.check(name, KNOWN);
    }
    let law = Network::series([alone(&[60.0.into(), 1.1.into()]), Network::dashpot(2.0)]);
    assert_eq!(law.without_derivatives(), None);
}

#[test]
fn friction_behind_friction_has_no_derivatives() {
    let friction = || Network::leaf(Friction::new(1.0, 0.1).unwrap());
    let law = Network::series([friction(), Network::spring(2.0), friction()]);
    assert_eq!(law.without_derivatives().unwrap(), "friction in series with friction");
}
