//! What is seen of signals before a run.

#[path = "support/work.rs"]
mod work;

use springpot::signal::{Agenda, AgendaError, Expression, Signal, Stop, Watched};
use work::Work;

fn watch(text: &str) -> Signal {
    Signal::expression(Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}")))
}

fn look(text: &str, end: f64, is_position: bool) -> Agenda {
    let signal = watch(text);
    Agenda::new(&[Watched { signal: &signal, is_position, slack: 1.0 }], end, 1e-6, 10_000_000, None).unwrap()
}

/// All stops up to `end`, as the first time after each.
fn kinks(agenda: &Agenda, end: f64) -> Vec<f64> {
    let (mut found, mut t) = (Vec::new(), 0.0);
    while let Some(Stop { before, after: Some(after) }) = agenda.next_stop(t) {
        assert!(t <= before && before < after && after <= end, "{t}: {before} {after}");
        found.extend((after < end).then_some(after));
        t = after;
    }
    found
}

/// The kinks of `text` are `expected`, each to 1e-12 of the end.
fn has_kinks(text: &str, end: f64, expected: &[f64]) {
    let found = kinks(&look(text, end, false), end);
    assert_eq!(
        found.len(),
        expected.len(),
        "{text}: {:?} {:?}",
        &found[..found.len().min(9)],
        &expected[..expected.len().min(9)]
    );
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-12 * end, "{text}: {found} {expected}");
    }
}

#[test]
fn every_switch_of_a_square_wave_is_found() {
    for (rate, end) in [(100.0, 10.0), (300.0, 10.0), (1000.0, 3.0), (1.0 / 7.0, 60.0)] {
        let half: Vec<f64> = (1..).map(|k| 0.5 * f64::from(k) / rate).take_while(|t| *t < end - 1e-9).collect();
        has_kinks(&format!("1+sign(sin(2*pi*{rate}*t))"), end, &half);
    }
}

#[test]
fn kinks_of_every_function_are_found() {
    let tenths =
        |from: f64, step: f64, count: i32| -> Vec<f64> { (0..count).map(|k| from + step * f64::from(k)).collect() };
    has_kinks("abs(t-0.3)", 1.0, &[0.3]);
    has_kinks("step(t^2-0.25)+sign(t-0.7)", 1.0, &[0.5, 0.7]);
    has_kinks("min(t, 1-t, 0.4)", 1.0, &[0.4, 0.5, 0.6]);
    has_kinks("max(0, 1-((t-3)/0.001)^2)^3", 60.0, &[2.999, 3.001]);
    has_kinks("atan2(sin(pi*t), cos(pi*t))", 4.0, &[1.0, 3.0]);
    // The usual triangle and rectified waves.
    has_kinks("asin(sin(pi*t))", 4.0, &tenths(0.5, 1.0, 4));
    has_kinks("acos(cos(pi*t))", 4.5, &tenths(1.0, 1.0, 4));
    has_kinks("sqrt(sin(pi*t)^2)", 4.5, &tenths(1.0, 1.0, 4));
    has_kinks("(sin(pi*t)*sin(pi*t))^0.5", 4.5, &tenths(1.0, 1.0, 4));
    has_kinks("sqrt(1-cos(2*pi*t))", 3.5, &tenths(1.0, 1.0, 3));
    // A kink inside a kink, two at one time, one that only touches, and none.
    has_kinks(
        "step(asin(sin(pi*t))-0.5)",
        2.0,
        &[0.5 / std::f64::consts::PI, 0.5, 1.0 - 0.5 / std::f64::consts::PI, 1.5],
    );
    has_kinks("abs(t-0.5)+step(t-0.5)", 1.0, &[0.5]);
    has_kinks("abs(2+sin(9*t))+sqrt(2+cos(9*t))+max(3, sin(t))", 50.0, &[]);
    has_kinks("step(t-t)+abs(0*t)+max(t, t)", 50.0, &[]);
}

#[test]
fn square_waves_of_any_duty_and_rate() {
    for k in 1..60 {
        let (rate, level) = (17.3 * f64::from(k), -0.99 + 0.033 * f64::from(k));
        let (end, omega) = (2.0, std::f64::consts::TAU * rate);
        let up = level.asin();
        let mut expected: Vec<f64> = (0..)
            .flat_map(|n| [up, std::f64::consts::PI - up].map(|x| (x + std::f64::consts::TAU * f64::from(n)) / omega))
            .take_while(|t| *t < end + 1.0 / rate)
            .filter(|t| 0.0 < *t && *t < end)
            .collect();
        expected.sort_by(f64::total_cmp);
        has_kinks(&format!("step(sin(2*pi*{rate}*t)-{level})"), end, &expected);
    }
}

#[test]
fn steps_are_short_where_a_pulse_is_and_nowhere_else() {
    for (text, at, width) in [
        ("1+0.01*exp(-((t-18.0048724)/0.01)^2)", 18.0048724, 0.01),
        ("sin(t)+1e-3*exp(-((t-41.2345678)/0.00003)^2)", 41.2345678, 3e-5),
        ("1e-8/(1+((t-33.333333)/1e-6)^2)", 33.333333, 1e-6),
    ] {
        let agenda = look(text, 60.0, true);
        let inside = agenda.reach(at, 1.0);
        assert!(inside < 0.5 * width && inside > 1e-3 * width, "{text}: {inside}");
        assert_eq!(agenda.reach(at - 5.0, 0.1), 0.1, "{text}");
        // No step may start before the pulse and end behind it.
        for k in 0..200 {
            let t = at - 0.5 * f64::from(k) * width;
            let reach = agenda.reach(t, 0.12);
            assert!(t + reach < at || reach < 0.5 * width, "{text}: {t} {reach}");
        }
    }
}

#[test]
fn smooth_motions_ask_for_no_shorter_steps() {
    for text in ["0.1*sin(8*t)", "0.1*t", "0.8+0.1*sin(0.4*pi*t)", "0.3*t^2-sqrt(1+t)", "tanh(t-5)+1/(1+t^2)", "7"] {
        for is_position in [true, false] {
            let agenda = look(text, 10.0, is_position);
            assert_eq!(agenda.finest(), None, "{text}");
            assert_eq!(agenda.reach(3.0, 0.02), 0.02);
        }
    }
}

#[test]
fn what_no_run_can_follow_is_refused_and_an_interrupt_is_heard() {
    let busy = watch("sign(sin(1e9*t))");
    let watched = [Watched { signal: &busy, is_position: false, slack: 1.0 }];
    let stop = std::sync::atomic::AtomicBool::new(true);
    assert_eq!(Agenda::new(&watched, 100.0, 1e-6, 10_000_000, Some(&stop)).unwrap_err(), AgendaError::Interrupted);
    for text in ["sign(sin(1e9*t))", "min(t, max(0.1, cos(31e9*t)))", "abs(sin(1e17*t))", "max(0.1, cos(1e25*t))*t"] {
        let busy = watch(text);
        let watched = [Watched { signal: &busy, is_position: false, slack: 1.0 }];
        let error = Agenda::new(&watched, 0.5, 1e-6, 10_000_000, None).unwrap_err();
        assert!(matches!(error, AgendaError::TooBusy { signal: 0, times } if times > 1e7), "{text}: {error}");
    }
    // Few kinks are many where few are allowed.
    let busy = watch("abs(sin(100*t))");
    let watched = [Watched { signal: &busy, is_position: false, slack: 1.0 }];
    assert!(matches!(Agenda::new(&watched, 10.0, 1e-6, 100, None), Err(AgendaError::TooBusy { .. })));
    assert_eq!(Agenda::new(&watched, 10.0, 1e-6, 1000, None).unwrap().switches(), 318);
}

/// Beyond 2^53 turns times cannot be told apart any more.
#[test]
fn swings_without_kinks_count_their_steps() {
    for rate in ["1e9", "1e12", "1e15", "1e17", "1e18", "1e19", "1e21", "1e25"] {
        for is_position in [true, false] {
            let agenda = look(&format!("sin({rate}*t)"), 0.5, is_position);
            let least = agenda.least_steps(0.5, 0.1);
            assert!(least > 0.05 * rate.parse::<f64>().unwrap(), "{rate}: {least}");
        }
    }
}

/// Kinks of a sum are those of its terms, however many.
#[test]
fn sums_of_many_kinks_are_looked_at_term_by_term() {
    let texts: Vec<String> =
        (1..=300).map(|k| format!("max(0, sin({}*t))", 0.5 + 0.012_345_678_9 * f64::from(k))).collect();
    let sum = format!("2*(0.1*t^2 - ({}))/3", texts.join(" + "));
    let mut expected: Vec<f64> = (1..=300)
        .flat_map(|k| {
            let omega = 0.5 + 0.012_345_678_9 * f64::from(k);
            (1..).map(move |n| f64::from(n) * std::f64::consts::PI / omega).take_while(|t| *t < 20.0)
        })
        .collect();
    expected.sort_by(f64::total_cmp);
    has_kinks(&sum, 20.0, &expected);
    // Smooth swings among them are seen as they are alone.
    let (alone, among) =
        (look("sin(2000*t)", 2.0, true), look(&format!("sin(2000*t) + {}", texts[..70].join(" + ")), 2.0, true));
    let [a, b] = [alone, among].map(|agenda| agenda.finest().unwrap());
    assert!(b <= 2.0 * a && b > 0.01 * a, "{a} {b}");
}

#[test]
fn short_runs_are_looked_through_as_quickly_as_long_ones() {
    for (text, is_position) in [("0.3*sin(4*t)", true), ("2*cos(3*t)", false), ("1e-9*exp(t)", true)] {
        for end in [1e-6, 0.01, 0.5] {
            assert_eq!(look(text, end, is_position).finest(), None, "{text} {end}");
        }
    }
}

#[test]
fn steady_swings_are_seen_at_a_glance() {
    let work = Work::begin();
    for (text, is_position) in
        [("0.1*sin(5e5*t)", true), ("cos(3e6*t)*sin(t)", false), ("1e-6*sin(3e5*t)+sin(t)", true)]
    {
        let agenda = look(text, 100.0, is_position);
        let step = agenda.finest().unwrap();
        assert!(step > 1e-8 && step < 3e-6, "{text}: {step}");
        assert!((0..50).all(|k| agenda.reach(2.0 * f64::from(k), 0.2) <= 4.0 * step), "{text}");
    }
    assert!(work.done().as_secs_f64() < 5.0);
}

#[test]
fn every_step_of_a_long_staircase_is_found() {
    // Uneven, and written in no order.
    let times: Vec<f64> = (0..1000).map(|k| 0.001 + 0.01 * f64::from(k) + 0.003 * f64::from(k).sin()).collect();
    let mixed = (0..1000).map(|k| times[(k * 617) % 1000]);
    let stairs: String =
        mixed.enumerate().map(|(k, t)| format!(" + {}*step(t - {t:?})", 0.1 + 0.01 * (k % 7) as f64)).collect();
    has_kinks(&format!("sin(3*t){stairs}"), 10.0, &times);
    // Ramps of two kinks each, and pulses as products.
    let ramps: String = (0..200).map(|k| format!(" + max(0, min(1, 100*(t - {})))", f64::from(k) * 0.02)).collect();
    let even =
        |count: i32, step: f64, from: f64| -> Vec<f64> { (0..count).map(|k| from + step * f64::from(k)).collect() };
    let ends: Vec<f64> = (1..400).map(|k| f64::from(k) * 0.01).collect();
    has_kinks(&format!("0{ramps}"), 4.5, &ends);
    let pulses: String =
        (0..150).map(|k| format!(" - step(t - {0})*step({0} + 0.01 - t)", f64::from(k) * 0.02 + 0.005)).collect();
    has_kinks(&format!("2{pulses}"), 3.5, &even(300, 0.01, 0.005));
    // Kinks that stay where they are cost nothing, however many.
    let still: String = (0..300).map(|k| format!(" + sqrt({k} + 1 + t^2) + abs(t + 1 + {k})")).collect();
    has_kinks(&format!("t{still}"), 10.0, &[]);
    // Of waves all kinks are left.
    let waves: String = (0..70).map(|k| format!(" + abs(sin(pi*(t + {})))", f64::from(k) / 70.0)).collect();
    has_kinks(&format!("0{waves}"), 1.005, &even(70, 1.0 / 70.0, 1.0 / 70.0));
}
