//! Many cycles: what the slowest modes hold must not drift from the stroke.

use crate::slider;

#[test]
fn an_hour_of_cycles_leaves_no_drift() {
    // At alpha = 1e-12 the derivative is x − x(0) to 4e-11. Integrals of the rates alone are off by 2e-8 in these rows and by
    // 1e-7 between them, and by as much at alpha = 0.01.
    let run = slider::springpot(1e-12, "0.1*exp(sin(t))", 3600.0, 60.0);
    let (stroke, derivative) = (run.column("e.stroke"), run.column("e.derivative"));
    let largest = derivative.iter().fold(0.0f64, |m, d| m.max(d.abs()));
    assert_eq!(stroke.len(), 61);
    for (k, (x, d)) in stroke.iter().zip(&derivative).enumerate() {
        assert!((d - (x - stroke[0])).abs() < 1e-10 * largest, "row {k}: {d} {}", x - stroke[0]);
    }
}
