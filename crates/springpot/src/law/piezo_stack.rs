//! Piezo stacks with the circuit that drives them, their hysteresis and their creep.

use super::catalog::{Entry, Input, Param, Range, alpha};
use super::leaf::{Hysteresis, Stack, VoltageDrop, hysteresis};
use super::network::Network;
use super::prandtl_ishlinskii::PrandtlIshlinskii;
use super::rule::RuleError;
use crate::dual::{Dual, Real};
use crate::fractional::Kind as Derivative;
use crate::fractional::gamma::{digamma, gamma};
use std::sync::Arc;

const POSITIVE: Range = Range { low: f64::MIN_POSITIVE, high: f64::MAX };

/// Number of parameters that all of them have.
const COMMON: usize = 10;

/// F = k·(x − x_c) + c·D^alpha x − T·V with k = F_block/x_0, T = F_block/V_max: blocked it pushes with F_block at V_max, free it is longer by x_0 ([`Stack`]).
///
/// x_c is 0 but with `creep` g: then the spring is in series with a springpot, so that x = x_0·(1 + g·t^a/(10^a − 1)) under a constant voltage: g between 1 s and 10 s.
pub(super) fn piezo_stack() -> Entry {
    Entry {
        name: "piezo-stack".into(),
        equation: equation("R·q' + V = U").into(),
        params: common(),
        inputs: vec![voltage()],
        source: "IEEE Std 176-1987; Goldfarb & Celanovic 1997".into(),
        build: Arc::new(|values, derivative| stack(values, VoltageDrop::None, derivative)),
    }
}

/// With the hysteresis of Bouc and Wen between charge and voltage.
pub(super) fn piezo_stack_bouc_wen() -> Entry {
    let alpha_h = Param::new("alpha_h", "", "voltage per unit of the hysteretic variable z", Range::NOT_NEGATIVE);
    let more = [alpha_h].into_iter().chain(hysteresis::params("1/V^n"));
    Entry {
        name: "piezo-stack-bouc-wen".into(),
        equation: equation("R·q' + V + alpha_h·z(A, beta, gamma, n) = U, z of e = q/(C + T²/k)").into(),
        params: common().into_iter().chain(more).collect(),
        inputs: vec![voltage()],
        source: "Goldfarb & Celanovic 1997; Bouc 1967, Wen 1976".into(),
        build: Arc::new(|values, derivative| {
            let (common, &[alpha_h, a, beta, gamma, n]) = values.split_at(COMMON) else {
                unreachable!("values follow params")
            };
            let hysteresis = Hysteresis::new(a, beta, gamma, n)?;
            stack(common, VoltageDrop::BoucWen { alpha_h, hysteresis }, derivative)
        }),
    }
}

/// With the hysteresis of Prandtl and Ishlinskii: free and at rest V = (1 − Σ a_i)·U + Σ a_i·(play of U).
pub(super) fn piezo_stack_prandtl_ishlinskii() -> Entry {
    Entry {
        name: "piezo-stack-prandtl-ishlinskii".into(),
        equation: equation("R·q' + V + Σ b_i·stop_i(e) = U, e = q/(C + T²/k), the inverse of plays a_i, r_i").into(),
        params: with_plays(),
        inputs: vec![voltage()],
        source: "Goldfarb & Celanovic 1997; Kuhnen 2003".into(),
        build: Arc::new(|values, derivative| of_plays(values, false, derivative)),
    }
}

/// The same behind its exact inverse: the input is the voltage that the stack is to work with.
pub(super) fn piezo_stack_feed_forward() -> Entry {
    let input = Input::new("U", "V", "voltage that the stack is to work with", Range::ANY);
    Entry {
        name: "piezo-stack-feed-forward".into(),
        equation: equation(
            "R·q' + V + Σ b_i·stop_i(e) = U + Σ b_i·stop_i(U), e = q/(C + T²/k), the inverse of plays a_i, r_i",
        )
        .into(),
        params: with_plays(),
        inputs: vec![input],
        source: "Kuhnen 2003; Goldfarb & Celanovic 1997".into(),
        build: Arc::new(|values, derivative| of_plays(values, true, derivative)),
    }
}

fn equation(circuit: &str) -> String {
    format!(
        "F = k·(x − x_c) + c·D^alpha x − T·V, k = F_block/x_0, T = F_block/V_max, q = C·V + T·x, {circuit}, V_min ≤ U ≤ V_max; creep x_c of the \
         order alpha_creep"
    )
}

fn voltage() -> Input {
    Input::new("U", "V", "voltage of the drive", Range::ANY)
}

fn common() -> Vec<Param> {
    let not_positive = Range { low: f64::MIN, high: 0.0 };
    vec![
        Param::new("F_block", "N", "force at V_max where it cannot move", POSITIVE),
        Param::new("x_0", "m", "stroke at V_max where nothing holds it", POSITIVE),
        Param::new("V_max", "V", "highest voltage, at which the two hold", POSITIVE),
        Param::new("V_min", "V", "lowest voltage", not_positive).or(0.0),
        Param::new("c", "N*s^alpha/m", "coefficient of the fractional derivative", Range::NOT_NEGATIVE),
        alpha(),
        Param::new("C", "F", "capacitance at a fixed stroke", POSITIVE),
        Param::new("R", "ohm", "resistance of the drive", POSITIVE),
        Param::new("creep", "", "share of x_0 that it creeps by between 1 s and 10 s", Range::NOT_NEGATIVE).or(0.0),
        Param::new("alpha_creep", "", "order of the springpot that creeps", Range { low: 1e-3, high: 1.0 }).or(0.1),
    ]
}

fn with_plays() -> Vec<Param> {
    let more = [
        Param::new("a", "", "weights of the plays", Range::NOT_NEGATIVE).list(),
        Param::new("r", "V", "half widths of the plays", POSITIVE).list(),
    ];
    common().into_iter().chain(more).collect()
}

fn of_plays(values: &[Dual], feed_forward: bool, derivative: Derivative) -> Result<Network, RuleError> {
    let (common, plays) = values.split_at(COMMON);
    let (weights, widths) = plays.split_at(plays.len() / 2);
    let stops = PrandtlIshlinskii::new(weights, widths)?.stops().to_vec();
    stack(common, VoltageDrop::Stops { stops, feed_forward }, derivative)
}

fn stack(values: &[Dual], drop: VoltageDrop, derivative: Derivative) -> Result<Network, RuleError> {
    let &[f_block, x_0, v_max, v_min, c, alpha, capacitance, resistance, creep, alpha_creep] = values else {
        unreachable!("values follow params")
    };
    RuleError::unless(v_min.value <= 0.0, "V_min ≤ 0", "V_min")?;
    let stiffness = f_block / x_0;
    let spring = Network::spring(stiffness);
    let elastic = if creep.value == 0.0 {
        spring
    } else {
        let grown = Dual::from(10.0).powf(alpha_creep) - 1.0.into();
        let coefficient = stiffness * grown / (creep * factorial(alpha_creep));
        Network::series([spring, Network::springpot(coefficient, alpha_creep, derivative)])
    };
    let coupling = f_block / v_max;
    let electric = Stack { coupling, capacitance, resistance, stiffness, drop, range: [v_min.value, v_max.value] };
    Ok(Network::parallel([elastic, Network::springpot(c, alpha, derivative), Network::leaf(electric)]))
}

/// Γ(1 + x).
fn factorial(x: Dual) -> Dual {
    let value = gamma(1.0 + x.value);
    x.through(value, value * digamma(1.0 + x.value))
}
