//! Saved and loaded, of many parameters and few, and the limits.

use super::super::{EnergyTangent, MemoryTangent, Singular, TangentEnd, TangentPoint, TangentSeeds, TangentStep};
use super::Dice;
use crate::collocation::Nodes;
use crate::fractional::{Form, KernelError, Kind, Memory, RatePolynomial, StepStart};

/// Steps whose strokes and rates are random, with random derivatives, of P parameters: the first of so many that there are always.
struct Random {
    dice: Dice,
    parameters: usize,
    t: f64,
}

const MOST: usize = 64;

impl Random {
    fn numbers(&mut self, rows: usize) -> Vec<f64> {
        let whole: Vec<f64> = (0..rows * MOST).map(|_| self.dice.roll() - 0.5).collect();
        whole.chunks(MOST).flat_map(|row| row[..self.parameters].to_vec()).collect()
    }

    fn begin(&mut self) -> (Memory, MemoryTangent) {
        let memory = Memory::new(0.37, Kind::RiemannLiouville, 0.2, 0.2, 1e-10, 1e-3, 5.0).unwrap();
        let (alpha, origin) = (self.numbers(1), self.numbers(1));
        let tangent = MemoryTangent::new(&memory, &TangentSeeds { alpha: &alpha, origin: &origin, jump: &origin });
        (memory, tangent.unwrap())
    }

    /// Commits some steps, and gives all that was answered.
    fn go(&mut self, memory: &mut Memory, tangent: &mut MemoryTangent, count: usize) -> Vec<f64> {
        let mut answers = Vec::new();
        for k in 0..count {
            let h = if k % 5 == 4 { 1e-6 } else { 0.01 + 0.02 * self.dice.roll() };
            let rates: Vec<f64> = (0..4).map(|_| self.dice.roll()).collect();
            let polynomial = RatePolynomial::through_rates(h, Nodes::Radau, &rates);
            let start = StepStart { t: self.t, h, stroke: 0.2, rate: rates[0] };
            let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
            let (stroke, rate, delta_u) = (self.numbers(1), self.numbers(1), self.numbers(4));
            memory.prepare(&start, Nodes::Radau, Form::Rates);
            let point = TangentPoint { stroke: 0.2, rate: 0.4, delta_stroke: &stroke, delta_rate: &rate };
            let parameters = self.parameters;
            let mut out = vec![0.0; 6 * parameters];
            let (explicit, rest) = out.split_at_mut(3 * parameters);
            let (at, rest) = rest.split_at_mut(parameters);
            let (stored, dissipation) = rest.split_at_mut(parameters);
            tangent.explicit(memory, &step, Singular::Moments, &point, explicit);
            tangent.at(memory, &step, 0.4, &point, &delta_u, at);
            tangent.energy(memory, &step, 0.4, &point, &delta_u, &mut EnergyTangent { stored, dissipation });
            let end = TangentEnd { stroke: 0.3, delta_stroke: &stroke, resolution: 1e-9 };
            tangent.commit(memory, &step, &delta_u, Some(&end));
            memory.commit_rates(&polynomial, None, 0.3, 1e-9);
            self.t += h;
            let mut now = vec![0.0; parameters];
            tangent.now(memory, &stroke, &rate, &mut now);
            // By parameter.
            answers.extend(out.chunks(parameters.max(1)).chain([&now[..]]).map(<[f64]>::to_vec));
            if k == count / 2 {
                let size = self.numbers(1);
                tangent.jump(memory, self.t, &size);
            }
        }
        (0..self.parameters).flat_map(|j| answers.iter().map(move |row| row[j]).collect::<Vec<f64>>()).collect()
    }
}

fn random(parameters: usize) -> Random {
    Random { dice: Dice(9), parameters, t: 0.0 }
}

/// What parameter j has does not depend on how many there are, to the bit.
#[test]
fn parameters_do_not_see_each_other() {
    let run = |parameters: usize| {
        let mut random = random(parameters);
        let (mut memory, mut tangent) = random.begin();
        random.go(&mut memory, &mut tangent, 20)
    };
    let all = run(MOST);
    for parameters in [0, 1, 3, 8, 9, 17] {
        let few = run(parameters);
        assert_eq!(few.len(), parameters * all.len() / MOST);
        assert!(few.iter().zip(&all).all(|(few, all)| few.to_bits() == all.to_bits()), "{parameters} parameters");
    }
}

/// A memory has the same bits with a derivative beside it and without.
#[test]
fn memories_do_not_see_their_derivatives() {
    let run = |parameters: usize| {
        let mut random = random(parameters);
        let (mut memory, mut tangent) = random.begin();
        random.go(&mut memory, &mut tangent, 20);
        let mut numbers = Vec::new();
        memory.save(&mut numbers);
        numbers
    };
    assert_eq!(run(0), run(8));
}

#[test]
fn goes_on_from_numbers_and_from_bytes_to_the_bit() {
    for parameters in [1, 8, 13] {
        let mut random = random(parameters);
        let (mut memory, mut tangent) = random.begin();
        random.go(&mut memory, &mut tangent, 17);
        let (dice, t) = (random.dice.0, random.t);
        let mut numbers = Vec::new();
        tangent.save(&mut numbers);

        let bytes = postcard::to_stdvec(&(&memory, &tangent)).unwrap();
        let text = serde_json::to_string(&tangent).unwrap();
        let (mut copied, mut other): (Memory, MemoryTangent) = postcard::from_bytes(&bytes).unwrap();
        let mut third: MemoryTangent = serde_json::from_str(&text).unwrap();
        let (mut loaded, mut fresh) = (copied.clone(), Random { dice: Dice(9), parameters, t: 0.0 }.begin().1);
        let mut rest = &numbers[..];
        assert!(fresh.load(&mut rest).is_some() && rest.is_empty());
        let mut again = Vec::new();
        fresh.save(&mut again);
        assert_eq!(numbers, again);

        let expected = random.go(&mut memory, &mut tangent, 12);
        let mut go = |memory: &mut Memory, tangent: &mut MemoryTangent| {
            (random.dice.0, random.t) = (dice, t);
            random.go(memory, tangent, 12)
        };
        assert_eq!(expected, go(&mut copied.clone(), &mut third));
        assert_eq!(expected, go(&mut copied, &mut other));
        assert_eq!(expected, go(&mut loaded, &mut fresh));

        // Cut anywhere, it is refused.
        for length in 0..numbers.len() {
            assert!(fresh.load(&mut &numbers[..length]).is_none(), "{length} of {}", numbers.len());
        }
    }
}

#[test]
fn limits_are_those_of_springs_and_dashpots() {
    let polynomial = RatePolynomial::cubic(0.1, [0.3, 0.2, 0.0, 0.0]);
    let start = StepStart { t: 0.0, h: 0.1, stroke: 0.5, rate: 0.3 };
    let point = TangentPoint { stroke: 0.5, rate: 0.3, delta_stroke: &[2.0, 1.0], delta_rate: &[-1.0, 4.0] };
    let seeds = TangentSeeds { alpha: &[0.0; 2], origin: &[0.7, 0.0], jump: &[0.7, 0.0] };
    let (mut stored, mut dissipation, mut at, mut explicit) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 6]);
    let mut ask = |alpha: f64, kind: Kind, form: Form| {
        let memory = Memory::new(alpha, kind, 0.2, 0.2, 1e-8, 1e-3, 1.0).unwrap();
        let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
        let step = TangentStep { start, nodes: Nodes::Radau, places: None, form, polynomial };
        tangent.explicit(&memory, &step, Singular::Moments, &point, &mut explicit);
        tangent.at(&memory, &step, 0.5, &point, &[0.0; 8], &mut at);
        let mut out = EnergyTangent { stored: &mut stored, dissipation: &mut dissipation };
        tangent.energy(&memory, &step, 0.5, &point, &[0.0; 8], &mut out);
        tangent.commit(&memory, &step, &[0.0; 8], None);
        let mut now = [0.0; 2];
        tangent.now(&memory, point.delta_stroke, point.delta_rate, &mut now);
        assert_eq!(now, at);
        (explicit, at, stored, dissipation)
    };
    let (explicit, at, stored, dissipation) = ask(0.0, Kind::Caputo, Form::Rates);
    assert_eq!((explicit, at), ([-0.7, 0.0, -0.7, 0.0, -0.7, 0.0], [1.3, 1.0]));
    assert!((stored[0] - 0.3 * 1.3).abs() < 1e-15 && stored[1] == 0.3 && dissipation == [0.0; 2]);
    let (explicit, at, stored, _) = ask(0.0, Kind::RiemannLiouville, Form::Strokes);
    assert_eq!((explicit, at, stored), ([0.0; 6], [2.0, 1.0], [1.0, 0.5]));
    let (explicit, at, stored, dissipation) = ask(1.0, Kind::Caputo, Form::Rates);
    assert_eq!((explicit, at, stored, dissipation), ([0.0; 6], [-1.0, 4.0], [0.0; 2], [-0.6, 2.4]));
    // x'_i = Σ_j A⁻¹_ij (x_j − x_0)/h.
    let (explicit, ..) = ask(1.0, Kind::Caputo, Form::Strokes);
    let row: f64 = Nodes::Radau.inverse()[1].iter().sum();
    assert!((explicit[2] + row / 0.1 * 2.0).abs() < 1e-12 && (explicit[3] + row / 0.1).abs() < 1e-12);
}

#[test]
fn orders_at_the_limits_are_no_parameters() {
    for alpha in [0.0, 1.0] {
        let memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-8, 1e-3, 1.0).unwrap();
        let refused = MemoryTangent::new(&memory, &TangentSeeds { alpha: &[1.0], origin: &[0.0], jump: &[0.0] });
        assert_eq!(refused.err(), Some(KernelError::Order(alpha)));
    }
}

/// Between two steps energies are those at the end of the last one.
#[test]
fn energies_between_two_steps() {
    let mut random = random(3);
    let mut memory = Memory::new(0.37, Kind::Caputo, 0.2, 0.0, 1e-10, 1e-3, 5.0).unwrap();
    let zeros = [0.0; 3];
    let seeds = TangentSeeds { alpha: &[1.0, 0.0, 0.3], origin: &zeros, jump: &zeros };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    random.go(&mut memory, &mut tangent, 4);
    let rates = [0.3, 0.4, 0.6, 0.5];
    let polynomial = RatePolynomial::through_rates(0.02, Nodes::Radau, &rates);
    let start = StepStart { t: random.t, h: 0.02, stroke: 0.2, rate: rates[0] };
    let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
    let (delta_u, rate) = (random.numbers(4), random.numbers(1));
    let point = TangentPoint { stroke: 0.2, rate: 0.5, delta_stroke: &zeros, delta_rate: &rate };
    let [mut a, mut b, mut c, mut d] = [zeros; 4];
    tangent.energy(&memory, &step, 1.0, &point, &delta_u, &mut EnergyTangent { stored: &mut a, dissipation: &mut b });
    tangent.commit(&memory, &step, &delta_u, None);
    memory.commit(&polynomial);
    tangent.energy_now(&memory, start.t + start.h, &point, &mut EnergyTangent { stored: &mut c, dissipation: &mut d });
    for (end, now) in a.iter().zip(&c) {
        assert!((end - now).abs() < 1e-12 * a[0].abs(), "{a:?} {c:?}");
    }
}

/// What is told stands in the place of what is known, as with the memory.
#[test]
fn what_is_told_is_said() {
    for alpha in [0.0, 0.5] {
        let memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-8, 1e-3, 1.0).unwrap();
        let seeds = TangentSeeds { alpha: &[0.0], origin: &[0.0], jump: &[0.0] };
        let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
        tangent.tell(&[3.0]);
        let mut now = [0.0];
        tangent.now(&memory, &[1.0], &[2.0], &mut now);
        assert_eq!(now, [3.0]);
    }
}

/// A closed memory knows what holds at t = 0, and goes on as one that was open from the first.
#[test]
fn opens_with_its_memory() {
    let mut memory = Memory::closed(0.5, Kind::RiemannLiouville, 0.0, 0.0).unwrap();
    let seeds = TangentSeeds { alpha: &[1.0, 0.0], origin: &[0.0, 1.0], jump: &[0.0, 1.0] };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    let mut part = [0.0; 2];
    // From x(0) = 0 too, x(0) moves D^α x without bound.
    tangent.singular_part(&memory, 0.25, &mut part);
    assert!(part[0] == 0.0 && (part[1] - 2.0 / std::f64::consts::PI.sqrt()).abs() < 1e-15);
    memory.open(1e-8, 1e-3, 1.0).unwrap();
    tangent.open(&memory);
    let again = MemoryTangent::new(&memory, &seeds).unwrap();
    let [mut a, mut b] = [Vec::new(), Vec::new()];
    tangent.save(&mut a);
    again.save(&mut b);
    assert_eq!(a, b);
}
