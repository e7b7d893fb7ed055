//! The energy ledger of smooth motions.

use crate::slider;

#[test]
fn the_ledger_closes_on_smooth_motions() {
    // What is faster than the modes dissipates −d2·(x'²)' beside d1·x'²: without it 1e-7 to 4e-7 were missing at alpha = 0.9.
    for alpha in [0.1, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 0.999] {
        for motion in ["0.3*sin(3*t)", "0.3*(1 - cos(3*t))", "0.1*t^3 - 0.2*t", "0.3*exp(-2*t)"] {
            let run = slider::springpot(alpha, motion, 2.0, 0.1);
            let (residual, turned_over) = (run.report.energy_residual.unwrap(), run.report.energy_turned_over.unwrap());
            assert!(residual < 1e-8 * turned_over, "alpha {alpha}, {motion}: {residual:e} of {turned_over} J");
        }
    }
}

#[test]
fn a_uniform_motion_stores_and_dissipates_what_it_must() {
    // x = vt: ψ = ½v²(2^{2−alpha} − 2)·t^{2−alpha}/Γ(3−alpha), and the work is v²t^{2−alpha}/Γ(3−alpha).
    use springpot::fractional::gamma::reciprocal_gamma;
    for alpha in [0.1, 0.5, 0.9, 0.99] {
        let run = slider::springpot(alpha, "0.4*t", 2.0, 0.25);
        let (stored, dissipated) = (run.column("e.stored"), run.column("e.dissipated"));
        for (k, t) in run.column("t").into_iter().enumerate() {
            let work = 3.0 * 0.16 * t.powf(2.0 - alpha) * reciprocal_gamma(3.0 - alpha);
            let kept = 0.5 * (2f64.powf(2.0 - alpha) - 2.0) * work;
            assert!((stored[k] - kept).abs() < 2e-9, "alpha {alpha}, t = {t}: {} {kept}", stored[k]);
            assert!(
                (dissipated[k] - (work - kept)).abs() < 2e-8,
                "alpha {alpha}, t = {t}: {} {}",
                dissipated[k],
                work - kept
            );
        }
    }
}
