//! Master curves of materials whose shifts are known, and of measured ones.

use springpot::law::master::{Master, MasterError, Row, master};
use springpot::law::{Catalog, Derivative, InputValue, Point, Shift};

/// A fractional Zener solid, Pa, at ω/2π in Hz.
fn zener(hertz: f64) -> [f64; 2] {
    let catalog = Catalog::standard();
    let network = catalog.get("fractional-zener").unwrap().build(&[2e6, 1.5e9, 4e7, 0.5], Derivative::Caputo).unwrap();
    let inputs: [InputValue; 0] = [];
    network.complex_modulus(&Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs }, std::f64::consts::TAU * hertz)
}

/// Uniform numbers between −1 and 1 (splitmix64).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Rows of 16 frequencies over three decades at each temperature, moved by `shift`, with `noise` of each number.
fn record(shift: &Shift, temperatures: &[f64], noise: f64, vertical: impl Fn(f64) -> f64) -> Vec<Row> {
    let mut random = Noise(temperatures.len() as u64);
    let mut rows = Vec::new();
    for &temperature in temperatures {
        for k in 0..16 {
            let frequency = 10.0_f64.powf(-1.0 + 0.2 * f64::from(k));
            let [storage, loss] = zener(frequency * shift.factor(temperature)).map(|part| part / vertical(temperature));
            let mut scattered = |value: f64| value * (1.0 + 1.7 * noise * random.next());
            rows.push(Row { frequency, storage: scattered(storage), loss: scattered(loss), temperature });
        }
    }
    rows
}

const WLF: Shift = Shift::Wlf { c1: 12.0, c2: 80.0, reference: 293.15 };

fn ladder(count: usize, from: f64, step: f64) -> Vec<f64> {
    (0..count).map(|k| from + step * k as f64).collect()
}

/// Decades between a shift that was found and the one that made the record.
fn missed(found: &Master, shift: &Shift) -> f64 {
    let of = |t: f64| shift.ln_factor(t) / std::f64::consts::LN_10;
    found.shifts.iter().map(|one| (one.log_a - of(one.temperature)).abs()).fold(0.0, f64::max)
}

#[test]
fn exact_curves_give_their_shifts_back() {
    let temperatures = ladder(9, 273.15, 5.0);
    let found = master(&record(&WLF, &temperatures, 0.0, |_| 1.0), 293.15, false).unwrap();
    assert!(missed(&found, &WLF) < 1e-3, "{} {:?}", missed(&found, &WLF), found.shifts);
    let wlf = found.wlf.unwrap();
    let Shift::Wlf { c1, c2, reference } = wlf.shift else { panic!("{wlf:?}") };
    assert!((c1 / 12.0 - 1.0).abs() < 2e-3 && (c2 / 80.0 - 1.0).abs() < 2e-3 && reference == 293.15, "{wlf:?}");
    assert_eq!(found.chosen().shift, wlf.shift);
    assert_eq!((found.rows.len(), found.shifts.len(), found.shifts[4].log_a), (144, 9, 0.0));
    assert!(found.rows.windows(2).all(|pair| pair[0].frequency <= pair[1].frequency));
    for row in &found.rows {
        let [storage, loss] = zener(row.frequency);
        assert!((row.storage / storage - 1.0).abs() < 1e-3 && (row.loss / loss - 1.0).abs() < 1e-3, "{row:?}");
    }
}

#[test]
fn scattered_curves_give_them_within_their_spread() {
    let temperatures = ladder(9, 273.15, 5.0);
    let (mut within, mut all, mut parameters) = (0, 0, 0);
    let sets = 20;
    for set in 0..sets {
        let moved: Vec<f64> = temperatures.iter().map(|t| t + 0.001 * f64::from(set)).collect();
        let mut rows = record(&WLF, &moved, 0.0, |_| 1.0);
        let mut random = Noise(100 + set as u64);
        for row in &mut rows {
            row.storage *= 1.0 + 0.02 * 1.7 * random.next();
            row.loss *= 1.0 + 0.02 * 1.7 * random.next();
        }
        let found = master(&rows, 293.15, false).unwrap();
        for one in found.shifts.iter().filter(|one| one.sd > 0.0) {
            let exact = WLF.ln_factor(one.temperature) / std::f64::consts::LN_10;
            within += usize::from((one.log_a - exact).abs() < 2.0 * one.sd);
            all += 1;
        }
        let wlf = found.wlf.unwrap();
        let Shift::Wlf { c1, c2, .. } = wlf.shift else { panic!("{wlf:?}") };
        parameters +=
            usize::from((c1 - 12.0).abs() < 2.5 * wlf.sd[0]) + usize::from((c2 - 80.0).abs() < 2.5 * wlf.sd[1]);
        assert!(found.scatter.iter().all(|scatter| (0.012..0.03).contains(scatter)), "{:?}", found.scatter);
    }
    assert!(within as f64 >= 0.85 * all as f64, "{within} of {all}");
    assert!(parameters >= 34, "{parameters} of {}", 2 * sets);
}

#[test]
fn an_activated_material_is_one() {
    let shift = Shift::Arrhenius { energy: 1.5e5, reference: 313.15 };
    let found = master(&record(&shift, &ladder(7, 293.15, 6.0), 0.005, |_| 1.0), 313.15, false).unwrap();
    let Shift::Arrhenius { energy, reference } = found.chosen().shift else { panic!("{:?}", found.wlf) };
    assert!((energy - 1.5e5).abs() < 3.0 * found.arrhenius.sd[0] && reference == 313.15, "{:?}", found.arrhenius);
    // Between two curves a_T is 1 at the reference all the same.
    assert!(missed(&found, &shift) < 0.05 && found.shifts.iter().all(|one| one.log_a != 0.0 && one.sd > 0.0));
}

#[test]
fn vertical_shifts() {
    let rise = |temperature: f64| temperature / 293.15;
    let rows = record(&WLF, &ladder(7, 278.15, 5.0), 0.002, |t| 1.0 / rise(t));
    let found = master(&rows, 293.15, true).unwrap();
    assert!(missed(&found, &WLF) < 0.05, "{:?}", found.shifts);
    for one in &found.shifts {
        let exact = -rise(one.temperature).log10();
        assert!((one.log_b - exact).abs() < 4.0 * one.sd_b + 1e-4, "{one:?} {exact}");
    }
    let flat = master(&rows, 293.15, false).unwrap();
    assert!(flat.shifts.iter().all(|one| one.log_b == 0.0 && one.sd_b == 0.0));
}

#[test]
fn what_makes_no_master_curve_is_refused() {
    let rows = record(&WLF, &ladder(3, 283.15, 5.0), 0.0, |_| 1.0);
    let one = record(&WLF, &[293.15], 0.0, |_| 1.0);
    assert!(matches!(master(&one, 293.15, false), Err(MasterError::OneTemperature(_))));
    assert!(matches!(master(&[], 293.15, false), Err(MasterError::NoRows)));
    assert!(matches!(master(&rows, 313.15, false), Err(MasterError::Reference { .. })));
    assert!(matches!(master(&rows, f64::NAN, false), Err(MasterError::Reference { .. })));
    for (what, spoil) in [
        ("frequency", (|row: &mut Row| row.frequency = 0.0) as fn(&mut Row)),
        ("storage", |row| row.storage = f64::NAN),
        ("loss", |row| row.loss = -1.0),
        ("T", |row| row.temperature = 20.0),
    ] {
        let mut spoiled = rows.clone();
        spoil(&mut spoiled[7]);
        let Err(MasterError::Number { row: 7, what: found, .. }) = master(&spoiled, 293.15, false) else {
            panic!("{what}")
        };
        assert_eq!(found, what);
    }
    let apart = record(&WLF, &[278.15, 283.15, 323.15, 328.15], 0.001, |_| 1.0);
    let error = master(&apart, 283.15, false).unwrap_err();
    assert_eq!(error.to_string(), "the curves at 283.15 K and 323.15 K do not overlap");
    let few: Vec<Row> = rows.iter().enumerate().filter(|(k, _)| !(17..31).contains(k)).map(|(_, row)| *row).collect();
    assert!(matches!(master(&few, 288.15, false), Err(MasterError::TooFewRows { given: 2, .. })));
    // A spring alone says nothing.
    let spring: Vec<Row> = rows.iter().map(|row| Row { storage: 1e6, loss: 1e3, ..*row }).collect();
    let error = master(&spring, 288.15, false).unwrap_err();
    assert!(matches!(error, MasterError::Flat { .. }), "{error}");
    let two = master(&rows[..32], 288.15, false).unwrap();
    assert!(two.wlf.is_none() && two.arrhenius.sd[0] > 0.0 && two.shifts.len() == 2);
}

/// The records of pyvisco (BSD-3, testdata/dma/pyvisco) against the shift factors that it prints for them, which it finds from storage alone.
#[test]
fn shift_factors_that_pyvisco_prints() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/dma/pyvisco/");
    let table = |name: &str| -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(format!("{folder}{name}")).unwrap();
        text.lines().skip(2).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    let rows: Vec<Row> = table("freq_user_raw.csv")
        .iter()
        .map(|row| Row { frequency: row[0], storage: 1e6 * row[1], loss: 1e6 * row[2], temperature: row[3] + 273.15 })
        .collect();
    let found = master(&rows, 276.15, false).unwrap();
    let mut printed = table("time_user_raw__shift_factors.csv");
    printed.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert_eq!((rows.len(), found.shifts.len(), printed.len()), (210, 21, 21));
    // Above the glass transition, where rows say it: a quarter of a decade over eighteen.
    let mut compared = 0;
    for (own, printed) in found.shifts.iter().zip(&printed) {
        let celsius = own.temperature - 273.15;
        assert!((celsius - printed[0]).abs() < 0.6, "{celsius}");
        let limit = if celsius > -8.0 { 0.25 } else { 2.0 };
        assert!(
            (own.log_a - printed[1]).abs() < limit,
            "{celsius:.1}: {:.3} ± {:.3}, {:.3}",
            own.log_a,
            own.sd,
            printed[1]
        );
        compared += usize::from(celsius > -8.0);
    }
    assert_eq!(compared, 15);
    let total = |of: &dyn Fn(usize) -> f64| of(20) - of(0);
    let [own, theirs] = [total(&|k| found.shifts[k].log_a), total(&|k| printed[k][1])];
    assert!((own / theirs - 1.0).abs() < 0.08, "{own} {theirs}");
}
