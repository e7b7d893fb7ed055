//! Single pulses and jolts as narrow as 1e-6 of the run, against convolutions with the exact answer to an impulse.

use crate::random::{Random, slider};
use crate::support::forward::largest;
use crate::support::{Run, run};
use springpot::fractional::mittag_leffler::MittagLeffler;

/// When a pulse comes and half its width.
#[derive(Debug, Clone, Copy)]
struct Pulse {
    at: f64,
    half: f64,
}

impl Pulse {
    fn new(random: &mut Random, end: f64) -> Self {
        Self { at: random.within(0.05, 0.95) * end, half: 0.5 * end * random.log(1e-6, 1e-3) }
    }

    /// ∫ shape((s − at)/half) answer(t − s) ds; every shape has gone to 1e-17 at `reach` halves. The trapezoidal rule with `count` points on
    /// either side is exact to rounding for shapes that vanish smoothly.
    fn convolved(
        self,
        shape: &impl Fn(f64) -> f64,
        (reach, count): (f64, i32),
        t: f64,
        answer: impl Fn(f64) -> f64,
    ) -> f64 {
        let step = reach / f64::from(count);
        let points = (-count..=count).map(|k| f64::from(k) * step);
        points.map(|x| shape(x) * answer(t - self.at - self.half * x)).sum::<f64>() * step * self.half
    }

    /// The largest error of a column at rows outside the pulse, in units of the largest value there.
    fn error(self, run: &Run, column: &str, reach: f64, exact: impl Fn(f64) -> f64) -> f64 {
        let rows = run.column("t").into_iter().zip(run.column(column));
        let rows: Vec<_> = rows.filter(|(t, _)| (t - self.at).abs() > reach * self.half).collect();
        let wanted: Vec<f64> = rows.iter().map(|(t, _)| exact(*t)).collect();
        let errors = rows.iter().zip(&wanted).map(|((_, value), wanted)| (value - wanted).abs());
        largest(errors) / largest(wanted.iter().copied())
    }
}

/// m q'' + c D^alpha q = f(t) from rest: an impulse gives the speed E_{2−alpha,1}(−(c/m) t^{2−alpha}).
#[test]
fn narrow_torques_move_as_impulses_do() {
    torques(12);
}

#[test]
#[ignore = "half a minute"]
fn forty_narrow_torques_move_as_impulses_do() {
    torques(40);
}

fn torques(count: usize) {
    let mut random = Random(0x8CB9_2BA7_2F3D_8DD7);
    for k in 0..count {
        let (alpha, c) = (random.within(0.1, 0.9), random.log(0.1, 10.0));
        let end = random.log(1e-2, 1e3);
        let pulse = Pulse::new(&mut random, end);
        let Pulse { at, half } = pulse;
        let x = format!("((t-{at})/{half})");
        let compact = k % 2 == 0;
        let (text, reach) = if compact { (format!("max(0, 1-{x}^2)^3"), 1.0) } else { (format!("exp(-{x}^2)"), 6.5) };
        let shape = |x: f64| if compact { (1.0 - x * x).max(0.0).powi(3) } else { (-x * x).exp() };
        let law = format!("law = \"springpot\"\nparameters = {{ c = {c}, alpha = {alpha} }}");
        let motion = format!(
            "kind = \"forward\"\nstart = {{ q = {{ q = 1 }} }}\ntorque = {{ q = \"{}*{text}\" }}",
            end.recip() / half
        );
        let run = run(&slider(&law, &motion, end, 40));
        let speed = MittagLeffler::new(2.0 - alpha, 1.0).unwrap();
        let shift = MittagLeffler::new(2.0 - alpha, 2.0).unwrap();
        let z = |t: f64| -c * t.powf(2.0 - alpha);
        let answer = |t: f64| if t <= 0.0 { 0.0 } else { speed.real(z(t)) };
        let travel = |t: f64| if t <= 0.0 { 0.0 } else { t * shift.real(z(t)) };
        let force = |t: f64, answer: &dyn Fn(f64) -> f64| pulse.convolved(&shape, (reach, 30), t, answer) / half / end;
        for (column, error) in [
            ("v.q", pulse.error(&run, "v.q", reach, |t| force(t, &answer))),
            ("e.stroke", pulse.error(&run, "e.stroke", reach, |t| force(t, &travel))),
        ] {
            assert!(error < 1e-6, "{column}: {error:e}, width {:e} of the run", 2.0 * half / end);
        }
    }
}

/// x = tanh((t − at)/half): D^alpha x = ∫ (t − s)^(−alpha) x'(s) ds / Γ(1 − alpha).
#[test]
fn narrow_jolts_of_a_motion_are_remembered() {
    let mut random = Random(0xA24B_AED4_963E_E407);
    for _ in 0..40 {
        let alpha = random.within(0.1, 0.9);
        let end = random.log(1e-2, 1e3);
        let pulse = Pulse::new(&mut random, end);
        let law = format!("law = \"springpot\"\nparameters = {{ c = 1, alpha = {alpha} }}");
        let motion =
            format!("kind = \"prescribed\"\njoints = {{ q = \"1+0.1*tanh((t-{})/{})\" }}", pulse.at, pulse.half);
        let run = run(&slider(&law, &motion, end, 40));
        let shape = |x: f64| x.cosh().powi(-2);
        let scale = gamma(1.0 - alpha);
        let answer = |t: f64| if t <= 0.0 { 0.0 } else { 0.1 / pulse.half * t.powf(-alpha) / scale };
        let error = pulse.error(&run, "e.derivative", 20.0, |t| pulse.convolved(&shape, (20.0, 60), t, answer));
        assert!(error < 1e-6, "{error:e} at {alpha}, width {:e} of the run", 2.0 * pulse.half / end);
    }
}

/// Γ(x) = 1/E_{0+,x}(0): the first term of the Mittag-Leffler function.
fn gamma(x: f64) -> f64 {
    MittagLeffler::new(1.0, x).unwrap().real(0.0).recip()
}
