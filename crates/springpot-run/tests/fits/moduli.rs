//! Moduli: intervals that hold the truth, the law that there is, and a sweep over amplitudes.

use crate::support::{Noise, Place, found, pad};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::fmt::Write as _;

const DMA: &str = "[[data]]\nkind = \"dma\"\nelement = \"pad\"\ncsv = \"dma.csv\"\n\
                   columns = { frequency = \"f\", storage = \"E1\", loss = \"E2\" }\n";

/// Rows of a modulus over `decades` about 1 Hz with noise.
fn table(modulus: impl Fn(Complex64) -> Complex64, (rows, decades): (usize, f64), noise: f64, seed: u64) -> String {
    let mut random = Noise(seed);
    let mut text = "f [Hz],E1 [N/m],E2 [N/m]\n".to_owned();
    for row in 0..rows {
        let f = 10f64.powf(decades * (row as f64 / (rows - 1) as f64 - 0.5));
        let own = modulus(Complex64::new(0.0, TAU * f));
        let mut with = |x: f64| x * (noise * random.normal()).exp();
        let (storage, loss) = (with(own.re), with(own.im));
        _ = writeln!(text, "{f},{storage},{loss}");
    }
    text
}

/// Of so many sets of a fractional Kelvin–Voigt element, 30 frequencies, 2 %, how many intervals of 95 % hold alpha.
fn held(sets: u64, decades: f64, alpha: f64, k: f64) -> usize {
    let place = Place::new();
    let law = pad("law = \"fractional-kelvin-voigt\"", &[("k", 0.8), ("c", 1.2), ("alpha", 0.4)]);
    let text = format!("{law}{DMA}[fit]\nstarts = 2\n");
    let holds = |seed: &u64| {
        place.write("dma.csv", &table(|s| k + s.powf(alpha), (30, decades), 0.02, 1000 + seed));
        let [low, high] = found(&place.fit(&text), "alpha").interval;
        (low..=high).contains(&alpha)
    };
    (0..sets).filter(holds).count()
}

/// 92 to 97 % of 300 sets, as 95 % are; the others are a matter of seconds.
#[test]
fn intervals_of_alpha_hold_it() {
    let held = held(300, 2.0, 0.3, 0.5);
    assert!((276..=291).contains(&held), "{held} of 300");
}

#[test]
#[ignore = "some seconds"]
fn intervals_of_alpha_hold_it_over_one_decade_and_four() {
    for (decades, alpha) in [(1.0, 0.3), (2.0, 0.05), (4.0, 0.7)] {
        let held = held(300, decades, alpha, 1.0);
        eprintln!("{decades} decades, alpha {alpha}: {held} of 300");
        assert!((276..=291).contains(&held), "{decades} decades, alpha {alpha}: {held} of 300");
    }
}

/// How often BIC takes what made the rows, 40 frequencies over three decades, 3 %, of one springpot, of one beside a spring, of two.
fn chosen(sets: u64) -> [u64; 3] {
    let place = Place::new();
    let two = "parallel(springpot(c_a, a), springpot(c_b, b))";
    let laws = ["springpot", "fractional-kelvin-voigt", two];
    let truths: [fn(Complex64) -> Complex64; 3] =
        [|s| 2.0 * s.powf(0.3), |s| 1.0 + 1.0 * s.powf(0.5), |s| 2.0 * s.powf(0.15) + 0.3 * s.powf(0.7)];
    let text = format!(
        "{}{DMA}[fit]\nelement = \"pad\"\nstarts = 6\nlaws = {laws:?}\n",
        pad("law = \"springpot\"", &[("c", 1.5), ("alpha", 0.4)])
    );
    [0, 1, 2].map(|k: usize| {
        let is_right = |seed: &u64| {
            place.write("dma.csv", &table(truths[k], (40, 3.0), 0.03, 5000 + seed));
            let outcome = place.fit(&text);
            outcome.chosen.as_deref() == Some(laws[k])
        };
        (0..sets).filter(is_right).count() as u64
    })
}

#[test]
fn the_law_that_made_the_rows_is_chosen() {
    let chosen = chosen(10);
    // Fewer than 8 of 10 come once in 80 of what is right in 95 %.
    assert!(chosen.iter().all(|right| *right >= 8), "{chosen:?} of 10");
}

#[test]
#[ignore = "a minute"]
fn the_law_that_made_the_rows_is_chosen_in_95_per_cent() {
    let chosen = chosen(300);
    eprintln!("{chosen:?} of 300");
    assert!(chosen.iter().all(|right| *right >= 285), "{chosen:?} of 300");
}

/// K* of a spring that slips at F_y, over a stroke of this amplitude: k up to there, then the harmonic of its loop.
fn slipping(k: f64, yields: f64, amplitude: f64) -> Complex64 {
    let share = yields / (k * amplitude);
    if share >= 1.0 {
        return k.into();
    }
    let turn = (1.0 - 2.0 * share).acos();
    let area = 4.0 * yields * (amplitude - yields / k);
    let pi = std::f64::consts::PI;
    Complex64::new(k / pi * (turn - turn.sin() * turn.cos()), area / (pi * amplitude * amplitude))
}

/// Of so many sweeps over five amplitudes at five frequencies with 2 % of noise, in how many all seven numbers of filled rubber are within two
/// standard deviations, and in how many of them each.
fn rubber(sets: u64) -> (usize, [usize; 7]) {
    let place = Place::new();
    let names = ["k", "c", "alpha", "k_f.0", "k_f.1", "F_f.0", "F_f.1"];
    let truth = [80e3, 20e3, 0.25, 60e3, 40e3, 6.0, 40.0];
    let mut text = "[[element]]\nname = \"pad\"\nlaw = \"filled-rubber\"\n\
                    parameters = { k = 5e4, c = 5e4, alpha = 0.4, k_f = [3e4, 3e4], F_f = [3, 60] }\n"
        .to_owned();
    for name in names {
        _ = write!(text, "[[parameter]]\nname = \"{name}\"\npath = \"element.pad.{name}\"\n");
    }
    text = text.replace("name = \"k_f.", "name = \"k_f").replace("name = \"F_f.", "name = \"F_f");
    let columns = DMA.replace("loss = \"E2\"", "loss = \"E2\", amplitude = \"A\"");
    let text = format!("{text}{columns}relative_sd = 0.02\n[fit]\nstarts = 4\n");
    let (mut all, mut each) = (0, [0; 7]);
    for seed in 0..sets {
        let mut random = Noise(9000 + seed);
        let mut rows = "f [Hz],A [mm],E1 [N/m],E2 [N/m]\n".to_owned();
        for amplitude in [0.05, 0.2, 0.6, 2.0, 5.0] {
            for f in [0.5, 1.5, 5.0, 15.0, 50.0] {
                let linear = truth[0] + truth[1] * Complex64::new(0.0, TAU * f).powf(truth[2]);
                let filler = (0..2).map(|i| slipping(truth[3 + i], truth[5 + i], 1e-3 * amplitude));
                let own = linear + filler.sum::<Complex64>();
                let mut with = |x: f64| x * (0.02 * random.normal()).exp();
                let (storage, loss) = (with(own.re), with(own.im));
                _ = writeln!(rows, "{f},{amplitude},{storage},{loss}");
            }
        }
        place.write("dma.csv", &rows);
        let outcome = place.fit(&text);
        let off = |(name, exact): (&&str, &f64)| {
            let own = found(&outcome, &name.replace('.', ""));
            (own.value - exact).abs() / own.sd
        };
        let off: Vec<f64> = names.iter().zip(&truth).map(off).collect();
        all += usize::from(off.iter().all(|z| *z <= 2.0));
        off.iter().zip(&mut each).for_each(|(z, count)| *count += usize::from(*z <= 2.0));
    }
    (all, each)
}

#[test]
fn a_sweep_over_amplitudes_finds_all_of_filled_rubber() {
    let (_, each) = rubber(4);
    // Two of 4 beyond two standard deviations come once in 70, of one number.
    assert!(each.iter().all(|held| *held >= 2), "{each:?} of 4");
}

/// Each number in 90 of 100 at least; all seven at once, as seven independent ones of 95 %, in 70 or more.
#[test]
#[ignore = "a minute"]
fn sweeps_over_amplitudes_find_all_of_filled_rubber() {
    let (all, each) = rubber(100);
    eprintln!("all seven in {all} of 100, each in {each:?}");
    assert!(all >= 70 && each.iter().all(|held| *held >= 90), "{all} and {each:?} of 100");
}

/// Springs side by side, as leaves and inside a law, are told only by their sum.
#[test]
fn springs_side_by_side_are_known_by_their_sum() {
    let place = Place::new();
    place.write("dma.csv", &table(|s| 50.0 + 60.0 * s.powf(0.3), (40, 3.0), 0.01, 77));
    let network = "network = \"parallel(spring(k_a), spring(k_b), springpot(c, alpha))\"";
    let law = "law = \"thermoviscoelastic\"\ninputs = { T = \"25 degC\" }";
    let cases = [
        (pad(network, &[("k_a", 10.0), ("k_b", 30.0), ("c", 40.0), ("alpha", 0.4)]), ["k_a", "k_b"]),
        (
            pad(law, &[("E_c", 10.0), ("E_kv", 30.0), ("E_d", 40.0), ("alpha", 0.4)])
                .replace("alpha = 0.4 }", "alpha = 0.4, a_kv = 1e-3 }"),
            ["E_c", "E_kv"],
        ),
    ];
    for (text, [first, second]) in cases {
        let outcome = place.fit(&format!("{text}{DMA}"));
        let [open] = &outcome.fit.undetermined[..] else { panic!("{:?}", outcome.fit.undetermined) };
        let determined = open.determined.unwrap();
        let names = determined.sum.map(|(at, _)| outcome.fitting.plan().parameters[at].sought.name.clone());
        assert_eq!(names, [first, second]);
        assert!((determined.sum[1].1 - 1.0).abs() < 1e-6, "{determined:?}");
        assert!((determined.value - 50.0).abs() < 3.0 * determined.sd && determined.sd < 2.0, "{determined:?}");
        let said = open.text(|at| outcome.fitting.plan().parameters[at].sought.name.clone());
        assert!(said.starts_with(&format!("only {first} + {second} = ")) && said.ends_with("is determined"), "{said}");
        // What they stand beside is known all the same.
        let alpha = found(&outcome, "alpha");
        assert!((alpha.value - 0.3).abs() < 3.0 * alpha.sd, "{alpha:?}");
    }
}

/// A stiffness that is not there: 0 to the bit with a limit above it wherever the rows have it below 0, which they do in every second set.
#[test]
fn a_stiffness_that_belongs_at_0_is_0() {
    let place = Place::new();
    let law = pad("law = \"fractional-kelvin-voigt\"", &[("k", 10.0), ("c", 40.0), ("alpha", 0.4)]);
    let text = format!("{law}{DMA}[fit]\nstarts = 3\n");
    let (mut at_zero, sets) = (0, 12);
    for seed in 0..sets {
        place.write("dma.csv", &table(|s| 60.0 * s.powf(0.3), (40, 3.0), 0.02, 300 + seed));
        let outcome = place.fit(&text);
        let k = found(&outcome, "k");
        if outcome.fit.at_bound[0].is_none() {
            assert!(k.value < 3.5 * k.sd, "{k:?}");
            continue;
        }
        at_zero += 1;
        let [low, high] = k.interval;
        assert_eq!((k.value, k.sd, low, outcome.fit.parameters), (0.0, 0.0, 0.0, 2));
        println!("0, at most {high:.2}");
        assert!(high > 0.1 && high < 5.0, "{k:?}");
    }
    assert!((3..=9).contains(&at_zero), "{at_zero} of {sets}");
}
