//! Laws at rest, and how they answer to small motions about it.

use super::network::Network;
use super::step::{Point, Term};
use crate::fractional::prony::{Relaxation, Spectrum};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Rounds in which parts in series come to one force.
const MOST_ROUNDS: usize = 200;

/// A law, or a leaf, that has been at rest since ever ([`Network::at_rest`]).
#[derive(Debug, Clone, PartialEq)]
pub struct AtRest {
    /// F that remains, N.
    pub force: f64,
    /// Its slope dF/dx, N/m; `None` where it flows: what remains of F does not depend on the stroke.
    pub stiffness: Option<f64>,
    /// How it answers to small motions.
    pub tangent: Tangent,
}

/// A law under small motions e^{st} about rest: δF = K(s) δx + Σ ∂F/∂u δu, with the parts of its [`Network`].
///
/// A nonlinear elastic leaf has its slope at the stroke that it has at rest, friction f/v0·s, Bouc–Wen the spring alpha_h·A (z = 0).
#[derive(Debug, Clone, PartialEq)]
pub enum Tangent {
    /// c·s^order, and an input with ∂F of it.
    Leaf(Term, Option<(usize, f64)>),
    /// A leaf that answers as these parts do.
    Whole(Box<Tangent>),
    /// One stroke, forces add.
    Parallel(Vec<Tangent>),
    /// One force, strokes add.
    Series(Vec<Tangent>),
}

/// A leaf under small motions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafAnswer {
    /// Its own stroke.
    pub stroke: Complex64,
    /// Its force.
    pub force: Complex64,
    /// D^order of its stroke: the stroke itself where it is no springpot and no dashpot.
    pub derivative: Complex64,
    /// The order.
    pub order: f64,
}

/// Strokes at which all parts have one force: each follows its tangent to the force at which the tangents together have the whole stroke.
pub(super) fn series(parts: &[Network], at: &Point) -> Option<AtRest> {
    let mut strokes = vec![at.stroke / parts.len() as f64; parts.len()];
    for _ in 0..MOST_ROUNDS {
        let own = |(part, stroke): (&Network, &f64)| part.at_rest(&Point { stroke: *stroke, ..*at }, 0.0);
        let rest: Vec<AtRest> = parts.iter().zip(&strokes).map(own).collect::<Option<_>>()?;
        let stiffest = rest.iter().filter_map(|part| part.stiffness).fold(0.0f64, |most, k| most.max(k.abs()));
        // What is slack yields, though not without end.
        let yielding = |part: &AtRest| {
            part.stiffness.map(|k| if k.abs() > 1e-6 * stiffest { k } else { 1e-6 * stiffest.max(f64::MIN_POSITIVE) })
        };
        let flowing = rest.iter().position(|part| part.stiffness.is_none());
        let force = match flowing {
            Some(part) => rest[part].force,
            None => {
                let free: f64 = rest.iter().zip(&strokes).map(|(r, x)| x - r.force / yielding(r).unwrap_or(1.0)).sum();
                (at.stroke - free) / rest.iter().filter_map(yielding).map(f64::recip).sum::<f64>()
            }
        };
        if flowing.is_some_and(|one| rest.iter().any(|part| part.stiffness.is_none() && part.force != rest[one].force))
        {
            return None;
        }
        let mut moved = 0.0f64;
        for (part, stroke) in rest.iter().zip(&mut strokes) {
            if let Some(k) = yielding(part) {
                let step = (force - part.force) / k;
                *stroke += step;
                moved = moved.max(step.abs());
            }
        }
        if let Some(flowing) = flowing {
            strokes[flowing] += at.stroke - strokes.iter().sum::<f64>();
        }
        let size = strokes.iter().fold(at.stroke.abs(), |size, x| size.max(x.abs()));
        if !moved.is_finite() {
            return None;
        }
        if moved <= 4.0 * f64::EPSILON * size {
            let stiffness = flowing.is_none().then(|| {
                let stiffnesses = || rest.iter().filter_map(|part| part.stiffness);
                if stiffnesses().any(|k| k == 0.0) { 0.0 } else { stiffnesses().map(f64::recip).sum::<f64>().recip() }
            });
            let tangent = Tangent::Series(rest.into_iter().map(|part| part.tangent).collect());
            return Some(AtRest { force, stiffness, tangent });
        }
    }
    None
}

impl Tangent {
    /// A leaf that is a spring of the stiffness k, N/m.
    pub(super) fn spring(k: f64) -> Self {
        Self::Leaf(Term { coefficient: k, order: 0.0 }, None)
    }

    /// A leaf that is a dashpot of the coefficient c, N·s/m.
    pub(super) fn dashpot(c: f64) -> Self {
        Self::Leaf(Term { coefficient: c, order: 1.0 }, None)
    }

    /// A leaf that is a spring beside a dashpot, told as one; without a dashpot the spring alone.
    pub(super) fn damped(k: f64, c: f64) -> Self {
        match c {
            0.0 => Self::spring(k),
            _ => Self::Whole(Box::new(Self::Parallel(vec![Self::spring(k), Self::dashpot(c)]))),
        }
    }

    /// The same with times longer by a_T = `factor`, its inputs under the numbers that `outside` gives them.
    pub(super) fn shifted(self, factor: f64, outside: &dyn Fn(usize) -> Option<usize>) -> Self {
        let all = |parts: Vec<Self>| parts.into_iter().map(|part| part.shifted(factor, outside)).collect();
        match self {
            Self::Leaf(term, input) => {
                let input = input.and_then(|(input, gain)| Some((outside(input)?, gain)));
                Self::Leaf(term.shifted(factor), input)
            }
            Self::Whole(tangent) => Self::Whole(Box::new(tangent.shifted(factor, outside))),
            Self::Parallel(parts) => Self::Parallel(all(parts)),
            Self::Series(parts) => Self::Series(all(parts)),
        }
    }

    /// K(s), N/m; of s^order the principal branch.
    pub fn modulus(&self, s: Complex64) -> Complex64 {
        match self {
            Self::Leaf(term, _) => term.coefficient * power(s, term.order),
            Self::Whole(parts) => parts.modulus(s),
            Self::Parallel(parts) => parts.iter().map(|part| part.modulus(s)).sum(),
            Self::Series(parts) => {
                let moduli: Vec<Complex64> = parts.iter().map(|part| part.modulus(s)).collect();
                match moduli.contains(&Complex64::ZERO) {
                    true => Complex64::ZERO,
                    false => moduli.iter().map(|k| k.inv()).sum::<Complex64>().inv(),
                }
            }
        }
    }

    /// What remains of K(s) at s = 0, N/m.
    pub fn relaxed(&self) -> f64 {
        match self {
            Self::Leaf(term, _) => {
                if term.order == 0.0 {
                    term.coefficient
                } else {
                    0.0
                }
            }
            Self::Whole(parts) => parts.relaxed(),
            Self::Parallel(parts) => parts.iter().map(Self::relaxed).sum(),
            Self::Series(parts) => {
                let each = || parts.iter().map(Self::relaxed);
                if each().any(|k| k == 0.0) { 0.0 } else { each().map(f64::recip).sum::<f64>().recip() }
            }
        }
    }

    /// ∂F/∂u of an input at the same stroke.
    pub fn gain(&self, s: Complex64, input: usize) -> Complex64 {
        self.answer(s, Complex64::ZERO, Some(input), &mut |_| ())
    }

    /// δF under δx = `stroke` and, of an `input`, δu = 1; hands over every leaf, in their order.
    pub fn answer(
        &self,
        s: Complex64,
        stroke: Complex64,
        input: Option<usize>,
        take: &mut dyn FnMut(LeafAnswer),
    ) -> Complex64 {
        match self {
            Self::Leaf(term, source) => {
                let derivative = power(s, term.order) * stroke;
                let commanded = source.filter(|(i, _)| Some(*i) == input).map_or(0.0, |(_, gain)| gain);
                let force = term.coefficient * derivative + commanded;
                take(LeafAnswer { stroke, force, derivative, order: term.order });
                force
            }
            Self::Whole(parts) => {
                let force = parts.answer(s, stroke, input, &mut |_| ());
                take(LeafAnswer { stroke, force, derivative: stroke, order: 0.0 });
                force
            }
            Self::Parallel(parts) => parts.iter().map(|part| part.answer(s, stroke, input, take)).sum(),
            Self::Series(parts) => {
                let each: Vec<(Complex64, Complex64)> = parts
                    .iter()
                    .map(|part| (part.modulus(s), part.answer(s, Complex64::ZERO, input, &mut |_| ())))
                    .collect();
                let slack = each.iter().position(|(k, _)| *k == Complex64::ZERO);
                let force = match slack {
                    Some(part) => each[part].1,
                    None => {
                        let free: Complex64 = each.iter().map(|(k, source)| source / k).sum();
                        (stroke + free) / each.iter().map(|(k, _)| k.inv()).sum::<Complex64>()
                    }
                };
                let own = |(k, source): &(Complex64, Complex64)| (force - source) / k;
                let others: Complex64 =
                    each.iter().enumerate().filter(|(i, _)| Some(*i) != slack).map(|(_, part)| own(part)).sum();
                for (i, (part, values)) in parts.iter().zip(&each).enumerate() {
                    let stroke = if Some(i) == slack { stroke - others } else { own(values) };
                    part.answer(s, stroke, input, take);
                }
                force
            }
        }
    }

    /// Whether all that relaxes does so by springpots: dashpots relax by single exponentials and answer a step by an impulse.
    pub fn is_smooth(&self) -> bool {
        match self {
            Self::Leaf(term, _) => term.order < 1.0 || term.coefficient == 0.0,
            Self::Whole(parts) => parts.is_smooth(),
            Self::Parallel(parts) | Self::Series(parts) => parts.iter().all(Self::is_smooth),
        }
    }

    /// The same without inputs and with as few parts as it takes: those of one order are one.
    pub fn reduced(&self) -> Self {
        let (parts, is_series) = match self {
            Self::Leaf(term, _) => return Self::Leaf(*term, None),
            Self::Whole(parts) => return parts.reduced(),
            Self::Parallel(parts) => (parts, false),
            Self::Series(parts) => (parts, true),
        };
        let mut terms: Vec<Term> = Vec::new();
        let mut others = Vec::new();
        let mut pending: Vec<Self> = parts.iter().rev().map(Self::reduced).collect();
        while let Some(part) = pending.pop() {
            match part {
                Self::Leaf(term, _) => match terms.iter_mut().find(|own| own.order == term.order) {
                    Some(own) if is_series => {
                        let sum = own.coefficient + term.coefficient;
                        own.coefficient *= if sum == 0.0 { 0.0 } else { term.coefficient / sum };
                    }
                    Some(own) => own.coefficient += term.coefficient,
                    None => terms.push(term),
                },
                Self::Parallel(parts) if !is_series => pending.extend(parts.into_iter().rev()),
                Self::Series(parts) if is_series => pending.extend(parts.into_iter().rev()),
                other => others.push(other),
            }
        }
        if is_series && terms.iter().any(|term| term.coefficient == 0.0) {
            return Self::Leaf(Term { coefficient: 0.0, order: 0.0 }, None);
        }
        let terms = terms.into_iter().filter(|term| term.coefficient != 0.0).map(|term| Self::Leaf(term, None));
        let mut all: Vec<Self> = terms.chain(others).collect();
        match all.len() {
            0 => Self::Leaf(Term { coefficient: 0.0, order: 0.0 }, None),
            1 => all.remove(0),
            _ if is_series => Self::Series(all),
            _ => Self::Parallel(all),
        }
    }
}

/// The relaxation of a law that is smooth ([`Tangent::is_smooth`]): H(τ) = Im K(−1/τ + i0)/π.
impl Relaxation for Tangent {
    fn equilibrium(&self) -> f64 {
        self.relaxed()
    }

    fn spectrum(&self, tau: f64) -> f64 {
        self.modulus(Complex64::new(-tau.recip(), 0.0)).im / PI
    }

    fn relaxation(&self, t: f64) -> f64 {
        Spectrum::new(self.relaxed(), |tau| self.spectrum(tau)).map_or(f64::NAN, |spectrum| spectrum.relaxation(t))
    }

    fn complex_modulus(&self, omega: f64) -> Complex64 {
        self.modulus(Complex64::new(0.0, omega))
    }
}

/// s^order; 1 at order 0, whatever s.
fn power(s: Complex64, order: f64) -> Complex64 {
    if order == 0.0 {
        Complex64::ONE
    } else if order == 1.0 {
        s
    } else {
        s.powf(order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Derivative;
    use crate::law::leaf::{Friction, Polynomial, Stop};

    fn at(stroke: f64) -> Point<'static> {
        Point { t: 0.0, stroke, rate: 0.0, inputs: &[] }
    }

    #[test]
    fn linear_laws_have_their_modulus() {
        let springpot = |c: f64, alpha: f64| Network::springpot(c, alpha, Derivative::Caputo);
        let law = Network::parallel([
            Network::spring(3.0),
            Network::series([Network::spring(20.0), Network::parallel([springpot(4.0, 0.3), Network::dashpot(0.2)])]),
            Network::series([Network::dashpot(1.5), Network::series([Network::spring(7.0), Network::spring(9.0)])]),
        ]);
        let rest = law.at_rest(&at(0.1), 0.0).unwrap();
        assert!((rest.force - 0.3).abs() < 1e-15 && rest.stiffness == Some(3.0), "{rest:?}");
        for s in [Complex64::new(0.0, 2.0), Complex64::new(-1.0, 3.0), Complex64::new(0.4, 0.0)] {
            let expected = law.modulus(&at(0.0), s);
            assert!((rest.tangent.modulus(s) - expected).norm() < 1e-14 * expected.norm());
            assert!((rest.tangent.reduced().modulus(s) - expected).norm() < 1e-14 * expected.norm());
            let mut leaves = Vec::new();
            let force = rest.tangent.answer(s, Complex64::ONE, None, &mut |leaf| leaves.push(leaf));
            assert!((force - expected).norm() < 1e-14 * expected.norm());
            // The strokes in series, 20 N/m behind the springpot and its dashpot, add to the whole.
            assert!((leaves[1].stroke + leaves[2].stroke - 1.0).norm() < 1e-14 && leaves.len() == 7, "{leaves:?}");
        }
    }

    #[test]
    fn what_is_not_linear_answers_where_it_rests() {
        let cubic = || Network::leaf(Polynomial::new([10.0, 0.0, 500.0]));
        // In series with a spring of 40 N/m both have one force; behind a dashpot nothing remains.
        let rest = Network::series([cubic(), Network::spring(40.0)]).at_rest(&at(0.5), 0.0).unwrap();
        let x = 0.5 - rest.force / 40.0;
        assert!((10.0 * x + 500.0 * x.powi(3) - rest.force).abs() < 1e-12 * rest.force, "{rest:?}");
        let slope = 10.0 + 1500.0 * x * x;
        let expected = 40.0 * slope / (40.0 + slope);
        assert!((rest.stiffness.unwrap() - expected).abs() < 1e-10 * expected);
        let relaxed = Network::series([cubic(), Network::dashpot(2.0)]).at_rest(&at(0.5), 0.0).unwrap();
        assert_eq!((relaxed.force, relaxed.stiffness), (0.0, None));
        let s = Complex64::new(0.0, 3.0);
        let maxwell = (1.0 / 10.0 + (2.0 * s).inv()).inv();
        assert!((relaxed.tangent.modulus(s) - maxwell).norm() < 1e-12, "{relaxed:?}");
        let rubbing = Network::leaf(Friction::new(3.0, 0.1).unwrap()).at_rest(&at(0.2), 0.0).unwrap();
        assert_eq!(rubbing.tangent.modulus(s), Complex64::new(0.0, 90.0));
        // A rope that is slack carries nothing, and what is behind it neither.
        let rope = Network::leaf(Stop::tension(50.0));
        let slack = Network::series([rope.clone(), Network::spring(10.0)]).at_rest(&at(-0.1), 0.0).unwrap();
        assert!(slack.force.abs() < 1e-12 && slack.tangent.modulus(s) == Complex64::ZERO, "{slack:?}");
        let taut = Network::series([rope, Network::spring(10.0)]).at_rest(&at(0.6), 0.0).unwrap();
        assert!((taut.force - 5.0).abs() < 1e-12, "{taut:?}");
    }

    #[test]
    fn it_relaxes_as_the_closed_form_does() {
        use crate::fractional::prony::FractionalZener;
        let springpot = Network::springpot(4.0, 0.4, Derivative::Caputo);
        let law = Network::parallel([Network::spring(3.0), Network::series([Network::spring(20.0), springpot])]);
        let own = law.at_rest(&at(0.0), 0.0).unwrap().tangent;
        let zener = FractionalZener::new(3.0, 20.0, 0.4, (4.0f64 / 20.0).powf(2.5)).unwrap();
        assert!(own.is_smooth() && !Tangent::Leaf(Term { coefficient: 1.0, order: 1.0 }, None).is_smooth());
        assert_eq!(own.equilibrium(), 3.0);
        for t in [1e-4, 1e-2, 0.3, 5.0, 1e3] {
            assert!((own.spectrum(t) / zener.spectrum(t) - 1.0).abs() < 1e-11, "{t}");
            assert!((own.relaxation(t) / zener.relaxation(t) - 1.0).abs() < 1e-10, "{t}");
            assert!((own.complex_modulus(t) / zener.complex_modulus(t) - 1.0).norm() < 1e-12, "{t}");
        }
    }

    #[test]
    fn inputs_reach_the_force_through_what_is_behind_them() {
        let inputs = [crate::law::InputValue { value: 2.0, rate: 0.0 }];
        let pushed = Network::parallel([Network::spring(30.0), Network::source(5.0, 0.0, 0)]);
        let law = Network::series([pushed, Network::spring(10.0)]);
        let rest = law.at_rest(&Point { inputs: &inputs, ..at(0.4) }, 0.0).unwrap();
        // 30 x − 10 = 10 (0.4 − x).
        assert!((rest.force - 10.0 * (0.4 - 14.0 / 40.0)).abs() < 1e-12, "{rest:?}");
        let gain = rest.tangent.gain(Complex64::new(0.0, 1.0), 0);
        assert!((gain - Complex64::from(-5.0 * 10.0 / 40.0)).norm() < 1e-14, "{gain}");
    }
}
