//! Dampers that a driver commands: Bingham, Bouc–Wen, Spencer, and the first two with a springpot in place of their dashpot.
//!
//! Coefficients are a + b·w. The driver follows the command u with a lag, w' = −eta·(w − u), w(0) = u(0).

use super::catalog::{Entry, Input, Param, Range, alpha, at_least_one_positive};
use super::leaf::{
    BoucWen, Coefficient, Friction, Hysteresis, Lagged, Preload, Spencer, Springpot, Viscous, hysteresis,
};
use super::network::Network;
use super::rule::RuleError;
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use std::borrow::Cow;
use std::sync::Arc;

const LAG: &str = "w' = −eta·(w − u)";

/// The equation of z.
const HYSTERESIS: &str = "z' = A·x' − gamma·|x'|·z·|z|^(n−1) − beta·x'·|z|^n";

/// F = c_1·y' + k_1·(x − x_0) and its inner equations ([`Spencer`]).
pub(super) fn spencer() -> Entry {
    let params = [
        pair("c_0", "N*s/m", "viscosity at large velocities"),
        pair("c_1", "N*s/m", "viscosity that rolls the force off at small velocities"),
        vec![
            stiffness("k_0", "stiffness at large velocities"),
            stiffness("k_1", "stiffness of the accumulator"),
            free_stroke(),
        ],
        hysteretic(),
        vec![eta()],
    ];
    Entry {
        name: "spencer".into(),
        equation: format!(
            "F = c_1·y' + k_1·(x − x_0), y' = (alpha·z + c_0·x' + k_0·(x − y))/(c_0 + c_1), z' = A·ν − gamma·|ν|·z·|z|^(n−1) − \
             beta·ν·|z|^n, ν = x' − y', c_0 = c_0a + c_0b·w, c_1 = c_1a + c_1b·w, alpha = alpha_a + alpha_b·w, {LAG}"
        )
        .into(),
        params: params.concat(),
        inputs: inputs(),
        source: "Spencer, Dyke, Sain & Carlson 1997".into(),
        build: Arc::new(|values, _| {
            let &[c_0a, c_0b, c_1a, c_1b, k_0, k_1, x_0, alpha_a, alpha_b, a, beta, gamma, n, eta] = values else {
                unreachable!("values follow params")
            };
            at_least_one_positive(&[("c_1a", c_1a), ("c_1b", c_1b), ("k_1", k_1)])?;
            let leaf = Spencer {
                fast: coefficient([c_0a, c_0b], "c_0a + u·c_0b ≥ 0", "c_0b")?,
                slow: coefficient([c_1a, c_1b], "c_1a + u·c_1b ≥ 0", "c_1b")?,
                inner_stiffness: k_0,
                stiffness: k_1,
                rest: x_0,
                alpha: coefficient([alpha_a, alpha_b], "alpha_a + u·alpha_b ≥ 0", "alpha_b")?,
                hysteresis: Hysteresis::new(a, beta, gamma, n)?,
            };
            Ok(Network::leaf(Lagged::new(leaf, eta)?))
        }),
    }
}

/// F = c_0·x' + k_0·(x − x_0) + alpha·z.
pub(super) fn bouc_wen_damper() -> Entry {
    let params = [pair("c_0", "N*s/m", "viscosity"), around_hysteresis()];
    Entry {
        name: "bouc-wen-damper".into(),
        equation: format!("F = (c_0a + c_0b·w)·x' + k_0·(x − x_0) + (alpha_a + alpha_b·w)·z, {HYSTERESIS}, {LAG}")
            .into(),
        params: params.concat(),
        inputs: inputs(),
        source: "Spencer, Dyke, Sain & Carlson 1997; Bouc 1967, Wen 1976".into(),
        build: Arc::new(|values, _| {
            let &[c_0a, c_0b, ref rest @ ..] = values else { unreachable!("values follow params") };
            some_of(c_0a, c_0b, rest)?;
            let viscosity = coefficient([c_0a, c_0b], "c_0a + u·c_0b ≥ 0", "c_0b")?;
            Ok(Network::parallel([Network::leaf(Lagged::new(Viscous { viscosity }, rest[8])?), beside_it(rest)?]))
        }),
    }
}

/// F = c_0·D^alpha x + k_0·(x − x_0) + alpha·z.
pub(super) fn fractional_bouc_wen_damper() -> Entry {
    let params = [springpot("c_0"), around_hysteresis()];
    Entry {
        name: "fractional-bouc-wen-damper".into(),
        equation: format!(
            "F = (c_0a + c_0b·w)·D^alpha x + k_0·(x − x_0) + (alpha_a + alpha_b·w)·z, {HYSTERESIS}, {LAG}"
        )
        .into(),
        params: params.concat(),
        inputs: inputs(),
        source: "that of `bouc-wen-damper` with a springpot in place of its dashpot".into(),
        build: Arc::new(|values, derivative| {
            let &[c_0a, c_0b, order, ref rest @ ..] = values else { unreachable!("values follow params") };
            some_of(c_0a, c_0b, rest)?;
            let coefficient = coefficient([c_0a, c_0b], "c_0a + u·c_0b ≥ 0", "c_0b")?;
            Ok(Network::parallel([lagged_springpot(coefficient, order, derivative, rest[8])?, beside_it(rest)?]))
        }),
    }
}

/// F = F_y·tanh(x'/v_0) + c·x' + F_0.
pub(super) fn bingham() -> Entry {
    let params = [yielding(), pair("c_", "N*s/m", "viscosity"), vec![offset(), eta()]];
    Entry {
        name: "bingham".into(),
        equation: format!("F = (F_ya + F_yb·w)·tanh(x'/v_0) + (c_a + c_b·w)·x' + F_0, {LAG}").into(),
        params: params.concat(),
        inputs: inputs(),
        source: "Bingham 1922; Stanway, Sproston & Stevens 1987, its sign smoothed".into(),
        build: Arc::new(|values, _| {
            let &[f_ya, f_yb, v_0, c_a, c_b, f_0, eta] = values else { unreachable!("values follow params") };
            at_least_one_positive(&[("F_ya", f_ya), ("F_yb", f_yb), ("c_a", c_a), ("c_b", c_b)])?;
            let viscosity = coefficient([c_a, c_b], "c_a + u·c_b ≥ 0", "c_b")?;
            let viscous = Network::leaf(Lagged::new(Viscous { viscosity }, eta)?);
            Ok(Network::parallel([yields([f_ya, f_yb, v_0], eta)?, viscous, Network::leaf(Preload { force: f_0 })]))
        }),
    }
}

/// F = F_y·tanh(x'/v_0) + c·D^alpha x + F_0.
pub(super) fn fractional_bingham() -> Entry {
    let params = [yielding(), springpot("c_"), vec![offset(), eta()]];
    Entry {
        name: "fractional-bingham".into(),
        equation: format!("F = (F_ya + F_yb·w)·tanh(x'/v_0) + (c_a + c_b·w)·D^alpha x + F_0, {LAG}").into(),
        params: params.concat(),
        inputs: inputs(),
        source: "that of `bingham` with a springpot in place of its dashpot".into(),
        build: Arc::new(|values, derivative| {
            let &[f_ya, f_yb, v_0, c_a, c_b, order, f_0, eta] = values else { unreachable!("values follow params") };
            at_least_one_positive(&[("F_ya", f_ya), ("F_yb", f_yb), ("c_a", c_a), ("c_b", c_b)])?;
            let coefficient = coefficient([c_a, c_b], "c_a + u·c_b ≥ 0", "c_b")?;
            let springpot = lagged_springpot(coefficient, order, derivative, eta)?;
            Ok(Network::parallel([yields([f_ya, f_yb, v_0], eta)?, springpot, Network::leaf(Preload { force: f_0 })]))
        }),
    }
}

fn inputs() -> Vec<Input> {
    vec![Input::new("u", "V", "command of the driver", Range::ANY)]
}

fn eta() -> Param {
    Param::new(
        "eta",
        "1/s",
        "rate at which the driver follows its command",
        Range { low: f64::MIN_POSITIVE, high: f64::MAX },
    )
}

fn stiffness(name: &'static str, meaning: &'static str) -> Param {
    Param::new(name, "N/m", meaning, Range::NOT_NEGATIVE)
}

fn free_stroke() -> Param {
    Param::new("x_0", "m", "stroke at which its spring gives no force", Range::ANY)
}

fn offset() -> Param {
    Param::new("F_0", "N", "force of the accumulator", Range::ANY)
}

/// a and b of a coefficient a + b·w.
fn pair(name: &'static str, unit: &'static str, meaning: &'static str) -> Vec<Param> {
    let per_volt = match unit.split_once('/') {
        Some((over, under)) => format!("{over}/({under}*V)"),
        None => format!("{unit}/V"),
    };
    vec![
        Param::new(format!("{name}a"), unit, format!("{meaning}, without command"), Range::NOT_NEGATIVE),
        Param::new(
            format!("{name}b"),
            per_volt,
            format!("change of {} per volt", name.trim_end_matches('_')),
            Range::ANY,
        ),
    ]
}

fn springpot(name: &'static str) -> Vec<Param> {
    [pair(name, "N*s^alpha/m", "coefficient of the fractional derivative"), vec![alpha()]].concat()
}

fn yielding() -> Vec<Param> {
    let positive = Range { low: f64::MIN_POSITIVE, high: f64::MAX };
    let v_0 = Param::new("v_0", "m/s", "rate about which the yield force turns over", positive);
    [pair("F_y", "N", "yield force"), vec![v_0]].concat()
}

fn hysteretic() -> Vec<Param> {
    let alpha = pair("alpha_", "N/m", "force per unit of the hysteretic variable z");
    alpha.into_iter().chain(hysteresis::params("1/m^n")).collect()
}

fn around_hysteresis() -> Vec<Param> {
    [vec![stiffness("k_0", "stiffness"), free_stroke()], hysteretic(), vec![eta()]].concat()
}

fn some_of(c_0a: Dual, c_0b: Dual, rest: &[Dual]) -> Result<(), RuleError> {
    let &[k_0, _, alpha_a, alpha_b, ..] = rest else { unreachable!("values follow params") };
    at_least_one_positive(&[("c_0a", c_0a), ("c_0b", c_0b), ("k_0", k_0), ("alpha_a", alpha_a), ("alpha_b", alpha_b)])
}

/// A coefficient a + b·w that is not negative whatever the command may be.
fn coefficient(pair: [Dual; 2], rule: &'static str, parameter: &'static str) -> Result<Coefficient, RuleError> {
    RuleError::unless(pair[0].value >= 0.0, rule, parameter)?;
    Ok(Coefficient::following(pair, rule, parameter))
}

fn yields([f_ya, f_yb, v_0]: [Dual; 3], eta: Dual) -> Result<Network, RuleError> {
    let force = coefficient([f_ya, f_yb], "F_ya + u·F_yb ≥ 0", "F_yb")?;
    RuleError::unless(v_0.value > 0.0, "v_0 > 0", "v_0")?;
    Ok(Network::leaf(Lagged::new(Friction { force, rate: v_0 }, eta)?))
}

/// k_0·(x − x_0) + alpha·z of k_0, x_0, alpha_a, alpha_b, A, beta, gamma, n and eta.
fn beside_it(values: &[Dual]) -> Result<Network, RuleError> {
    let &[k_0, x_0, alpha_a, alpha_b, a, beta, gamma, n, eta] = values else { unreachable!("values follow params") };
    let alpha = coefficient([alpha_a, alpha_b], "alpha_a + u·alpha_b ≥ 0", "alpha_b")?;
    let hysteresis = BoucWen::varying(alpha, Hysteresis::new(a, beta, gamma, n)?);
    Ok(Network::parallel([
        Network::spring(k_0),
        Network::leaf(Preload { force: -k_0 * x_0 }),
        Network::leaf(Lagged::new(hysteresis, eta)?),
    ]))
}

/// c·D^order x with a coefficient that lags: what it is from t = 0 on says nothing of a stroke that was stretched to x(0) at once.
fn lagged_springpot(
    coefficient: Coefficient,
    alpha: Dual,
    derivative: Derivative,
    eta: Dual,
) -> Result<Network, RuleError> {
    if derivative == Derivative::RiemannLiouville {
        let rule = "derivative = \"caputo\", past = \"held\": the coefficient of its springpot lags behind a command that is known from t = 0 on";
        return Err(RuleError { rule: rule.into(), parameter: Cow::Borrowed("alpha") });
    }
    Ok(Network::leaf(Lagged::new(Springpot { coefficient, alpha, derivative }, eta)?))
}
