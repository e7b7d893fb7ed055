//! What happened before t = 0, against closed forms.

use crate::departure;
use crate::support::{Run, cases, run_system};
use springpot::elements::Element;
use springpot::fractional::mittag_leffler::{Complex64, MittagLeffler};
use springpot_scenario::Plan;

/// A slider along x whose one element has this law, and a stroke of q(t).
pub(crate) fn slider(element: &str, q: &str, end: f64) -> Run {
    let plan = plan(element, q, end);
    let run = run_system(&plan.system(), &plan.settings);
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

/// The element of such a slider.
pub(crate) fn element(element: &str) -> Element {
    plan(element, "t", 1.0).system().elements[0].clone()
}

fn plan(element: &str, q: &str, end: f64) -> Plan {
    let text = format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 1\n\
         joint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0], origin = [1, 0, 0] }}\n\
         [[element]]\nname = \"e\"\nfrom = {{ body = \"world\", point = [0, 0, 0] }}\n\
         to = {{ body = \"b\", point = [0, 0, 0] }}\nrest_length = 1\n{element}\n\
         [motion]\nkind = \"prescribed\"\njoints = {{ q = \"{q}\" }}\n[time]\nend = {end}\noutput_step = {step}\n",
        step = end / 25.0
    );
    cases(&text).plan(0).expect("a valid plan")
}

/// 1/Γ(1 − a) by E_{1,1−a}(0).
fn reciprocal_gamma(a: f64) -> f64 {
    MittagLeffler::new(1.0, a).unwrap().real(0.0)
}

#[test]
fn held_for_a_while_a_springpot_still_relaxes() {
    for alpha in [0.2, 0.5, 0.95] {
        for age in [0.01, 3.0, 1e4] {
            let law =
                format!("law = \"springpot\"\nparameters = {{ c = 40, alpha = {alpha} }}\npast = {{ held = {age} }}");
            let run = slider(&law, "0.1 + 0.2*t", 2.0);
            let exact = |t: &f64| {
                let held = 0.1 * (t + age).powf(-alpha) * reciprocal_gamma(1.0 - alpha);
                40.0 * (held + 0.2 * t.powf(1.0 - alpha) * reciprocal_gamma(2.0 - alpha))
            };
            let exact: Vec<f64> = run.t().iter().map(exact).collect();
            let error = departure(&run.column("e.force"), &exact);
            assert!(error < 1e-9, "{alpha} {age}: {error:e}");
            // What is stored then is known; the balance closes.
            assert!(run.column("e.stored")[0] > 0.0 && run.column("e.dissipated")[0] == 0.0);
            assert!(run.residual() < 1e-8, "{alpha} {age}: {:e}", run.residual());
        }
    }
}

#[test]
fn held_for_a_while_a_series_still_relaxes() {
    for alpha in [0.2, 0.5, 0.9] {
        for age in [0.1, 30.0] {
            let law = format!(
                "law = \"fractional-maxwell\"\nparameters = {{ k = 90, c = 40, alpha = {alpha} }}\npast = {{ held = {age} }}"
            );
            let run = slider(&law, "0.1", 2.0);
            let relaxed = MittagLeffler::new(alpha, 1.0).unwrap();
            let exact: Vec<f64> =
                run.t().iter().map(|t| 9.0 * relaxed.real(-90.0 / 40.0 * (t + age).powf(alpha))).collect();
            let error = departure(&run.column("e.force"), &exact);
            assert!(error < 1e-8, "{alpha} {age}: {error:e}");
        }
    }
}

/// F = Re(K*(iω) X e^{iωt}) from the first row on, where a run from rest needs many periods.
#[test]
fn a_steady_past_is_the_complex_modulus() {
    let omega = std::f64::consts::TAU * 2.0;
    let s = Complex64::new(0.0, omega);
    for alpha in [0.2, 0.5, 0.9] {
        let springpot = 40.0 * s.powf(alpha);
        let series = Complex64::from(90.0) * springpot / (90.0 + springpot);
        for (law, parameters, modulus) in [
            ("springpot", "c = 40", springpot),
            ("fractional-kelvin-voigt", "k = 25, c = 40", springpot + 25.0),
            ("fractional-zener", "k_e = 25, k_m = 90, c = 40", series + 25.0),
            ("fractional-maxwell", "k = 90, c = 40", series),
        ] {
            let law = format!(
                "law = \"{law}\"\nparameters = {{ {parameters}, alpha = {alpha} }}\npast = \"steady\"\nperiod = 0.5"
            );
            // The mean has no share in what flows, and all in what does not.
            let run = slider(&law, "0.02 + 0.1*sin(4*pi*t + 0.3)", 1.0);
            let rest = if law.contains("zener") || law.contains("kelvin") { 0.02 * 25.0 } else { 0.0 };
            let force = |t: &f64| rest + (modulus * 0.1 * (s * t + Complex64::new(0.0, 0.3)).exp()).im;
            let exact: Vec<f64> = run.t().iter().map(force).collect();
            let error = departure(&run.column("e.force"), &exact);
            assert!(error < 1e-9, "{law}: {error:e}");
            assert!(run.residual() < 1e-8, "{law}: {:e}", run.residual());
            // Each period loses π·K″·X².
            let lost = run.column("e.dissipated").last().unwrap() / 2.0;
            let loop_area = std::f64::consts::PI * modulus.im * 0.01;
            assert!((lost / loop_area - 1.0).abs() < 1e-8, "{law}: {lost} {loop_area}");
        }
    }
}
