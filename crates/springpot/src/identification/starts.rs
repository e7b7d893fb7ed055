//! Where fits begin: as the parameters say, and a Latin hypercube about that.

use super::parameter::{Parameter, Scale};
use crate::random::Random;

/// Share of a finite range that lies between its ends and the outermost start.
const MARGIN: f64 = 0.02;

/// The values of `count` starts. The first are the parameters' own; of the others each range is cut into as many equal parts as there
/// are starts, and each part is used once (M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239–245): the range between
/// the bounds, else a factor of ten to both sides of the own start.
pub(super) fn starts(parameters: &[Parameter], count: usize, seed: u64) -> Vec<Vec<f64>> {
    let given = parameters.iter().map(|parameter| parameter.start.len()).max().unwrap_or(1).max(1);
    let own = |k: usize| -> Vec<f64> {
        parameters.iter().map(|parameter| parameter.inside(parameter.start[k.min(parameter.start.len() - 1)])).collect()
    };
    let mut random = Random::new(seed, 0);
    let spread = count.saturating_sub(given);
    let columns: Vec<Vec<f64>> = parameters
        .iter()
        .map(|parameter| {
            let part = random.permutation(spread);
            part.into_iter().map(|k| place(parameter, (k as f64 + random.share()) / spread as f64)).collect()
        })
        .collect();
    let hypercube = (0..spread).map(|k| columns.iter().map(|column| column[k]).collect());
    (0..given.min(count.max(1))).map(own).chain(hypercube).collect()
}

/// The value at a share of the range.
fn place(parameter: &Parameter, share: f64) -> f64 {
    let [low, high] = parameter.bounds;
    let start = parameter.inside(parameter.start[0]);
    match parameter.scale {
        Scale::Log if low > 0.0 && high.is_finite() => low * (high / low).powf(share),
        Scale::Log => (start * 10.0_f64.powf(2.0 * share - 1.0)).clamp(low, high),
        _ if low.is_finite() && high.is_finite() => low + (high - low) * (MARGIN + (1.0 - 2.0 * MARGIN) * share),
        _ => (start + 10.0 * parameter.typical * (2.0 * share - 1.0)).clamp(low, high),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_range_once() {
        let mut parameters = [
            Parameter::new("k", 5.0, [0.0, f64::INFINITY]),
            Parameter::new("alpha", 0.3, [0.0, 1.0]),
            Parameter::free("x", -2.0),
        ];
        parameters[1].start = vec![0.3, 0.7];
        let all = starts(&parameters, 22, 7);
        assert_eq!((all.len(), &all[0][..], &all[1][..]), (22, &[5.0, 0.3, -2.0][..], &[5.0, 0.7, -2.0][..]));
        assert_eq!(all, starts(&parameters, 22, 7));
        assert_ne!(all, starts(&parameters, 22, 8));
        let share: [&dyn Fn(f64) -> f64; 3] =
            [&|k| 0.5 + 0.5 * (k / 5.0).log10(), &|a| (a - MARGIN) / (1.0 - 2.0 * MARGIN), &|x| 0.5 + (x + 2.0) / 40.0];
        for (j, share) in share.iter().enumerate() {
            let mut parts: Vec<usize> = all[2..].iter().map(|start| (share(start[j]) * 20.0) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..20).collect::<Vec<_>>(), "{j}");
        }
    }
}
