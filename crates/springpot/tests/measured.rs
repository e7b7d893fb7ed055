//! Laws fitted to measured storage and loss.

use springpot::law::Catalog;
use springpot::law::datasheet::{FitError, Fitted, Identified, Measured, Model, fit};
use std::f64::consts::TAU;

const MOUNT: Identified =
    Identified { model: Model::FractionalKelvinVoigt, stiffness: 2000.0, coefficient: 800.0, order: 0.35 };

fn fitted(model: Model, rows: &[Measured]) -> Result<Fitted, FitError> {
    fit(model.law(&Catalog::standard()).unwrap(), rows)
}

/// `count` frequencies, evenly on a logarithmic axis from 0.1 to 100 Hz.
fn rows(law: &Identified, count: usize) -> Vec<Measured> {
    let row = |k: usize| {
        let omega = TAU * 10.0_f64.powf(-1.0 + 3.0 * k as f64 / (count - 1) as f64);
        let [storage, loss] = law.complex_stiffness(omega);
        Measured { omega, storage, loss }
    };
    (0..count).map(row).collect()
}

/// Normal numbers: splitmix64, Box and Muller.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

/// Seeds of 200 for which each of k, c and alpha is recovered within twice its spread.
fn recovered(disturb: impl Fn(&mut Noise, Measured) -> Measured) -> [usize; 3] {
    let mut within = [0; 3];
    for seed in 0..200 {
        let mut noise = Noise(seed);
        let rows: Vec<Measured> = rows(&MOUNT, 50).into_iter().map(|row| disturb(&mut noise, row)).collect();
        let found = fitted(MOUNT.model, &rows).unwrap();
        for (count, name) in within.iter_mut().zip(["k", "c", "alpha"]) {
            let error = found.law.parameter(name).unwrap() - MOUNT.parameter(name).unwrap();
            *count += usize::from(error.abs() <= 2.0 * found.spread(name).unwrap());
        }
        assert!((0.003..0.03).contains(&found.rms) && found.largest < 0.06, "{found:?}");
    }
    within
}

#[test]
fn noisy_values_are_recovered_within_twice_the_spread() {
    let apart = recovered(|noise, row| Measured {
        storage: row.storage * (1.0 + 0.01 * noise.normal()),
        loss: row.loss * (1.0 + 0.01 * noise.normal()),
        ..row
    });
    let alike = recovered(|noise, row| {
        let size = 0.01 * row.storage.hypot(row.loss);
        Measured { storage: row.storage + size * noise.normal(), loss: row.loss + size * noise.normal(), ..row }
    });
    let together = recovered(|noise, row| {
        let factor = 1.0 + 0.01 * noise.normal();
        Measured { storage: row.storage * factor, loss: row.loss * factor, ..row }
    });
    for within in [apart, alike, together] {
        // Twice a standard deviation holds 95 % of normal errors; 90 % of 200 are 180, and all of them would be a spread told too large.
        assert!(within.iter().all(|count| (180..=199).contains(count)), "{apart:?} {alike:?} {together:?}");
    }
}

#[test]
fn exact_rows_give_their_law_back() {
    let of = |model, stiffness, coefficient, order| Identified { model, stiffness, coefficient, order };
    for law in [
        MOUNT,
        of(Model::FractionalKelvinVoigt, 3e7, 2e5, 0.9),
        of(Model::FractionalKelvinVoigt, 1e-4, 5e-4, 0.02),
        of(Model::Springpot, 0.0, 450.0, 0.6),
        of(Model::KelvinVoigt, 700.0, 30.0, 1.0),
    ] {
        let rows = rows(&law, 30);
        let found = fitted(law.model, &rows).unwrap();
        assert!(found.largest < 1e-10 && found.rms <= found.largest, "{law:?}: {found:?}");
        assert!((found.law.order - law.order).abs() < 1e-10, "{found:?}");
    }
    // The sum of squares is least: no neighbour is better.
    let mut noise = Noise(7);
    let disturbed: Vec<Measured> =
        rows(&MOUNT, 20).iter().map(|row| Measured { loss: row.loss * (1.0 + 0.1 * noise.normal()), ..*row }).collect();
    let found = fitted(MOUNT.model, &disturbed).unwrap().law;
    let squares = |law: Identified| -> f64 {
        let square = |row: &Measured| {
            let [re, im] = law.complex_stiffness(row.omega);
            ((re - row.storage).powi(2) + (im - row.loss).powi(2)) / (row.storage.powi(2) + row.loss.powi(2))
        };
        disturbed.iter().map(square).sum()
    };
    for factor in [0.9999, 1.0001] {
        assert!(squares(Identified { stiffness: found.stiffness * factor, ..found }) > squares(found));
        assert!(squares(Identified { coefficient: found.coefficient * factor, ..found }) > squares(found));
        assert!(squares(Identified { order: found.order * factor, ..found }) > squares(found));
    }
}

#[test]
fn parameters_at_an_end_of_their_range_have_no_spread() {
    // A springpot has no spring, and a storage that falls makes the order rise to 1.
    let springpot = Identified { model: Model::Springpot, stiffness: 0.0, coefficient: 450.0, order: 0.4 };
    let falling: Vec<Measured> =
        rows(&springpot, 10).iter().map(|row| Measured { storage: 3e4 / row.omega, ..*row }).collect();
    let found = fitted(Model::FractionalKelvinVoigt, &falling).unwrap();
    assert_eq!((found.law.order, found.spread("alpha")), (1.0, None), "{found:?}");
    assert!(found.spread("c").is_some() && found.covariance[2] == [0.0; 3], "{found:?}");
    let stiffer: Vec<Measured> = rows(&springpot, 10)
        .iter()
        .map(|row| Measured { storage: row.storage * row.omega.powf(0.1), ..*row })
        .collect();
    let found = fitted(Model::FractionalKelvinVoigt, &stiffer).unwrap();
    assert_eq!((found.law.stiffness, found.spread("k")), (0.0, None), "{found:?}");
    assert!(found.spread("c").is_some() && found.spread("alpha").is_some());
    assert_eq!(fitted(Model::Springpot, &stiffer).unwrap().spread("k"), None);
}

#[test]
fn rows_that_make_no_law_are_refused() {
    let good = rows(&MOUNT, 4);
    let whole = Model::FractionalKelvinVoigt;
    let named = "fractional-kelvin-voigt".to_owned();
    assert_eq!(fitted(whole, &good[..2]), Err(FitError::TooFew { law: named.clone(), needed: 3, given: 2 }));
    let twice = [good[0], good[1], good[0], good[1]];
    assert_eq!(fitted(whole, &twice), Err(FitError::SameFrequency { law: named, needed: 3, given: 2 }));
    assert!(fitted(Model::Springpot, &twice).is_ok());
    let same = [good[1]; 5];
    assert!(matches!(fitted(Model::KelvinVoigt, &same), Err(FitError::SameFrequency { needed: 2, given: 1, .. })));
    for (value, what) in [(0.0, "loss"), (-1.0, "frequency"), (f64::NAN, "storage"), (f64::INFINITY, "loss")] {
        let mut rows = good.clone();
        match what {
            "frequency" => rows[2].omega = value,
            "storage" => rows[2].storage = value,
            _ => rows[2].loss = value,
        }
        let error = fitted(whole, &rows).unwrap_err();
        assert!(matches!(error, FitError::NotPositive { row: 2, what: found, .. } if found == what), "{error}");
    }
    let catalog = Catalog::standard();
    let error = fit(catalog.get("magnetorheological").unwrap(), &good).unwrap_err();
    assert_eq!(error, FitError::OtherLaw { law: "magnetorheological".to_owned() });
}
