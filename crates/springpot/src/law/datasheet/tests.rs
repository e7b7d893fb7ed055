use super::*;
use crate::dual::Dual;
use crate::law::catalog::Build;
use std::f64::consts::{FRAC_PI_2, PI};

const HZ: f64 = 2.0 * PI;

/// The parameters of the standard law of this form.
fn identify(model: Model, data: &[Datum]) -> Result<Identified, DatasheetError> {
    super::identify(model.law(&Catalog::standard()).unwrap(), data)
}

fn datum(quantity: Quantity, value: f64, omega: f64) -> Datum {
    Datum { quantity, value, omega }
}

/// What a law has in the place of these quantities.
fn told(law: &Identified, what: &[(Quantity, f64)]) -> Vec<Datum> {
    let of = |&(quantity, omega): &(Quantity, f64)| {
        let value = law.predict(&datum(quantity, 1.0, omega));
        datum(quantity, value, omega)
    };
    what.iter().map(of).collect()
}

fn close(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * b.abs()
}

#[test]
fn springpot_from_a_loss_factor_and_a_stiffness() {
    let omega = 10.0 * HZ;
    let data = [datum(Quantity::LossFactor, 0.3, omega), datum(Quantity::Stiffness, 5000.0, omega)];
    assert_eq!(Model::for_data(&data), Model::Springpot);
    let found = identify(Model::Springpot, &data).unwrap();
    let alpha = 0.3_f64.atan() / FRAC_PI_2;
    assert!(close(found.order, alpha, 1e-15) && close(found.coefficient, 5000.0 / omega.powf(alpha), 1e-14));
    assert_eq!((found.stiffness, found.parameter("k"), found.parameter("alpha")), (0.0, None, Some(found.order)));
}

#[test]
fn every_pair_at_one_frequency_gives_springpot_and_kelvin_voigt() {
    let omega = 25.0;
    let mut pairs = 0;
    for (model, order, stiffness) in [(Model::Springpot, 0.37, 0.0), (Model::KelvinVoigt, 1.0, 800.0)] {
        let law = Identified { model, stiffness, coefficient: 45.0, order };
        for first in Quantity::ALL {
            for second in Quantity::ALL {
                let same = |q: Quantity| if q == Quantity::Damping { Quantity::Loss } else { q };
                if same(first) == same(second) {
                    continue;
                }
                let data = told(&law, &[(first, omega), (second, omega)]);
                let found = identify(model, &data).unwrap();
                let near = close(found.coefficient, 45.0, 1e-12) && close(found.order, order, 1e-13);
                assert!(near && (found.stiffness - stiffness).abs() < 1e-10, "{first} {second}: {found:?}");
                pairs += 1;
            }
        }
    }
    assert_eq!(pairs, 2 * 18);
}

#[test]
fn as_many_data_as_parameters_are_met_exactly() {
    let law = Identified { model: Model::FractionalKelvinVoigt, stiffness: 1200.0, coefficient: 90.0, order: 0.42 };
    use Quantity::{Damping, Loss, LossFactor, Stiffness, Storage};
    for what in [
        // The first is in closed form.
        [(Storage, 0.0), (LossFactor, 60.0), (Stiffness, 60.0)],
        [(LossFactor, 6.0), (LossFactor, 600.0), (Stiffness, 60.0)],
        [(Stiffness, 1.0), (Stiffness, 30.0), (Stiffness, 900.0)],
        [(Storage, 2.0), (Loss, 20.0), (Storage, 200.0)],
        [(Damping, 2.0), (Loss, 40.0), (Stiffness, 200.0)],
        [(Stiffness, 0.0), (Loss, 20.0), (Loss, 200.0)],
    ] {
        let found = identify(law.model, &told(&law, &what)).unwrap();
        for (found, wanted) in [found.stiffness, found.coefficient, found.order].into_iter().zip([1200.0, 90.0, 0.42]) {
            assert!(close(found, wanted, 1e-8), "{what:?}: {found} for {wanted}");
        }
    }
    let springpot = Identified { model: Model::Springpot, stiffness: 0.0, coefficient: 500.0, order: 0.2 };
    let data = told(&springpot, &[(Stiffness, 1.0), (Stiffness, 1e4)]);
    assert_eq!(Model::for_data(&data), Model::Springpot);
    let found = identify(Model::Springpot, &data).unwrap();
    assert!(close(found.order, 0.2, 1e-10) && close(found.coefficient, 500.0, 1e-9), "{found:?}");
}

#[test]
fn more_data_are_met_as_well_as_can_be() {
    let law = Identified { model: Model::FractionalKelvinVoigt, stiffness: 900.0, coefficient: 300.0, order: 0.3 };
    use Quantity::{LossFactor, Stiffness};
    let what: Vec<_> =
        [1.0, 10.0, 100.0].into_iter().flat_map(|omega| [(LossFactor, omega), (Stiffness, omega)]).collect();
    let mut data = told(&law, &what);
    let exact = identify(law.model, &data).unwrap();
    assert!(exact.deviation(&data) < 1e-9 && close(exact.order, 0.3, 1e-7));
    // One percent of error in turn makes an error of that size, and no better fit is near.
    for (k, datum) in data.iter_mut().enumerate() {
        datum.value *= if k % 2 == 0 { 1.01 } else { 0.99 };
    }
    let squares = |law: &Identified| data.iter().map(|d| (law.predict(d) / d.value - 1.0).powi(2)).sum::<f64>();
    let found = identify(law.model, &data).unwrap();
    assert!((1e-3..2e-2).contains(&found.deviation(&data)), "{}", found.deviation(&data));
    for factor in [0.999, 1.001] {
        for other in [
            Identified { stiffness: found.stiffness * factor, ..found },
            Identified { coefficient: found.coefficient * factor, ..found },
            Identified { order: found.order * factor, ..found },
        ] {
            assert!(squares(&other) > squares(&found), "{other:?}");
        }
    }
}

#[test]
fn simple_laws() {
    let k = [datum(Quantity::Stiffness, 700.0, 0.0)];
    assert_eq!(Model::for_data(&k), Model::Spring);
    assert!(close(identify(Model::Spring, &k).unwrap().stiffness, 700.0, 1e-12));
    let c = [datum(Quantity::Damping, 30.0, 0.0)];
    assert_eq!(Model::for_data(&c), Model::Dashpot);
    assert!(close(identify(Model::Dashpot, &c).unwrap().coefficient, 30.0, 1e-12));
    let both = [k[0], c[0]];
    assert_eq!(Model::for_data(&both), Model::KelvinVoigt);
    let found = identify(Model::KelvinVoigt, &both).unwrap();
    assert!(close(found.stiffness, 700.0, 1e-10) && close(found.coefficient, 30.0, 1e-10), "{found:?}");
    assert_eq!(found.predict(&c[0]), found.coefficient);
}

#[test]
fn data_that_make_no_law_are_refused() {
    use Quantity::{Damping, LossFactor, Stiffness, Storage};
    let (tan, stiff) = (datum(LossFactor, 0.3, 60.0), datum(Stiffness, 5000.0, 60.0));
    let at_rest = datum(Storage, 6000.0, 0.0);
    let refused = |model, data: &[Datum]| identify(model, data).unwrap_err();
    let springpot = Model::Springpot;
    assert_eq!(refused(springpot, &[tan]), DatasheetError::TooFew { law: "springpot".into(), needed: 2, given: 1 });
    assert_eq!(refused(springpot, &[tan, datum(LossFactor, 0.4, 600.0)]), DatasheetError::NoStiffness);
    assert_eq!(refused(springpot, &[stiff, at_rest]), DatasheetError::NoStaticStiffness { law: "springpot".into() });
    assert_eq!(refused(springpot, &[tan, stiff, stiff]), DatasheetError::Twice { quantity: Stiffness, omega: 60.0 });
    assert_eq!(
        refused(springpot, &[stiff, datum(Damping, 3.0, 0.0)]),
        DatasheetError::NeedsFrequency { quantity: Damping }
    );
    for (value, omega) in [(0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (f64::INFINITY, 1.0), (1.0, -1.0), (1.0, f64::NAN)]
    {
        let error = refused(springpot, &[stiff, datum(LossFactor, value, omega)]);
        assert!(matches!(error, DatasheetError::NotPositive { .. }), "{error}");
    }
    // Softer in motion than at rest is no such element.
    let fractional = Model::FractionalKelvinVoigt;
    let error = refused(fractional, &[at_rest, tan, stiff]);
    assert!(matches!(error, DatasheetError::Unreachable { percent, .. } if percent > 1.0), "{error}");
    // A springpot does not become softer with the frequency either.
    let error = refused(springpot, &[stiff, datum(Stiffness, 4000.0, 600.0)]);
    assert!(matches!(error, DatasheetError::Unreachable { .. }), "{error}");
    // A loss factor above tan 90°, and a storage stiffness above the dynamic one.
    let error = refused(springpot, &[stiff, datum(Storage, 5001.0, 60.0)]);
    assert!(matches!(error, DatasheetError::Unreachable { .. } | DatasheetError::Undetermined { .. }), "{error}");
    // Three data that say two things.
    let law = Identified { model: springpot, stiffness: 0.0, coefficient: 80.0, order: 0.4 };
    let same = told(&law, &[(LossFactor, 60.0), (Stiffness, 60.0), (Storage, 60.0)]);
    assert_eq!(refused(fractional, &same), DatasheetError::Undetermined { law: "fractional-kelvin-voigt".into() });
    assert!(identify(springpot, &same).is_ok());
}

#[test]
fn the_catalog_says_which_laws_data_determine() {
    let catalog = Catalog::standard();
    let found: Vec<_> = catalog.entries().iter().filter_map(|law| Some((&*law.name, Model::of(law)?))).collect();
    let names = ["spring", "dashpot", "springpot", "kelvin-voigt", "fractional-kelvin-voigt"];
    assert_eq!(found, names.into_iter().zip(Model::ALL).collect::<Vec<_>>());
    for (name, model) in found {
        assert_eq!(catalog.get(name).unwrap().params.len(), model.parameter_count(), "{name}");
    }
    // Another law may have the same parameters, and is none of these; under another name the same law is.
    let kelvin_voigt = catalog.get("kelvin-voigt").unwrap();
    let with = |name: &'static str, build: Build| Entry { name: name.into(), build, ..Entry::clone(kelvin_voigt) };
    let (spring, dashpot) = (|k: &[Dual]| Network::spring(k[0]), |k: &[Dual]| Network::dashpot(k[1]));
    let maxwell = with("maxwell", Arc::new(move |k, _| Ok(Network::series([spring(k), dashpot(k)]))));
    let twice = with("twice", Arc::new(move |k, _| Ok(Network::parallel([spring(k), spring(k), dashpot(k)]))));
    let turned = with("turned", Arc::new(move |k, _| Ok(Network::parallel([dashpot(k), spring(k)]))));
    assert_eq!([&maxwell, &twice, &turned].map(Model::of), [None, None, Some(Model::KelvinVoigt)]);
    let data = [datum(Quantity::Stiffness, 700.0, 0.0), datum(Quantity::Damping, 30.0, 0.0)];
    assert_eq!(super::identify(&maxwell, &data), Err(DatasheetError::OtherLaw { law: "maxwell".into() }));
    assert_eq!(super::identify(&turned, &data), super::identify(kelvin_voigt, &data));
}
