//! The tables, read back as the programs they are for would.

use springpot::fractional::prony::{Bulk, PronyError, PronySeries, Slowest, Springpot, Term, Window};

fn series(slowest: Slowest) -> PronySeries {
    let springpot = Springpot::new(50.0, 0.5, 0.0).unwrap();
    PronySeries::new(&springpot, Window::Times { from: 1e-3, to: 10.0 }, 1e-4, slowest).unwrap()
}

/// The number behind `label` in a comment.
fn commented(text: &str, label: &str) -> f64 {
    let line = text.lines().find(|line| line.contains(label)).unwrap();
    line.rsplit(": ").next().unwrap().parse().unwrap()
}

/// The series that a code makes of normalised moduli and times.
fn rebuilt(original: &PronySeries, instantaneous: f64, pairs: &[(f64, f64)]) -> PronySeries {
    let sum: f64 = pairs.iter().map(|(g, _)| g).sum();
    assert!(sum < 1.0);
    let term = |(g, tau): &(f64, f64)| Term { modulus: g * instantaneous, relaxation_time: *tau };
    let (equilibrium, terms) = (instantaneous * (1.0 - sum), pairs.iter().map(term).collect());
    PronySeries { equilibrium, terms, ..original.clone() }
}

fn same(a: &PronySeries, b: &PronySeries) {
    assert_eq!(a.terms.len(), b.terms.len());
    for k in 0..50 {
        let t = 1e-3 * 1.2f64.powi(k);
        assert!((a.relaxation(t) / b.relaxation(t) - 1.0).abs() < 1e-12, "t = {t}");
    }
}

#[test]
fn abaqus_reads_back_the_same_modulus() {
    let series = series(Slowest::Stays);
    for (bulk, relaxes) in [(Bulk::Elastic, false), (Bulk::Relaxes, true)] {
        let text = series.abaqus(bulk).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with("**"));
        assert_eq!(lines.next(), Some("*VISCOELASTIC, TIME=PRONY"));
        let rows: Vec<Vec<f64>> = lines.map(|line| line.split(", ").map(|n| n.parse().unwrap()).collect()).collect();
        assert!(
            text.lines().filter(|line| !line.starts_with('*')).flat_map(|line| line.split(", ")).all(|n| n.len() <= 20)
        );
        assert!(rows.iter().all(|row| row.len() == 3 && row[1] == if relaxes { row[0] } else { 0.0 }), "{text}");
        let pairs: Vec<(f64, f64)> = rows.iter().map(|row| (row[0], row[2])).collect();
        same(&series, &rebuilt(&series, commented(&text, "Instantaneous modulus"), &pairs));
        assert!(text.contains("Verified relative error of G(t) there: ") && text.contains("(bound 1e-4)"), "{text}");
    }
}

#[test]
fn ansys_reads_back_the_same_modulus() {
    let series = series(Slowest::Stays);
    let text = series.ansys(Bulk::Relaxes).unwrap();
    let mut parts: Vec<(String, Vec<f64>)> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('!')) {
        let fields: Vec<&str> = line.split(',').collect();
        match fields[0] {
            "TB" => {
                assert_eq!(fields[1..5], ["PRONY", "1", "1", &series.terms.len().to_string()]);
                parts.push((fields[5].to_owned(), Vec::new()));
            }
            "TBDATA" => {
                let constants = &mut parts.last_mut().unwrap().1;
                assert_eq!(fields[1].parse::<usize>().unwrap(), constants.len() + 1);
                assert!(fields.len() <= 8, "at most six constants in a line: {line}");
                constants.extend(fields[2..].iter().map(|n| n.parse::<f64>().unwrap()));
            }
            other => panic!("{other}"),
        }
    }
    assert_eq!(parts.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["SHEAR", "BULK"]);
    for (_, constants) in &parts {
        let pairs: Vec<(f64, f64)> = constants.chunks(2).map(|pair| (pair[0], pair[1])).collect();
        same(&series, &rebuilt(&series, commented(&text, "Instantaneous modulus"), &pairs));
    }
    assert_eq!(series.ansys(Bulk::Elastic).unwrap().matches("TB,PRONY").count(), 1);
}

#[test]
fn csv_and_serde_keep_every_bit() {
    let series = series(Slowest::Relaxes);
    let text = series.csv();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("term,modulus,relaxation_time,viscosity"));
    assert_eq!(lines.next(), Some("0,0,,"));
    for (term, line) in series.terms.iter().zip(lines) {
        let fields: Vec<f64> = line.split(',').skip(1).map(|n| n.parse().unwrap()).collect();
        assert_eq!(fields, [term.modulus, term.relaxation_time, term.viscosity()]);
    }
    assert_eq!(text.lines().count(), series.terms.len() + 2);
    let json = serde_json::to_string(&series).unwrap();
    assert_eq!(serde_json::from_str::<PronySeries>(&json).unwrap(), series);
}

#[test]
fn codes_that_need_a_long_term_modulus_get_none_without_one() {
    let series = series(Slowest::Relaxes);
    assert_eq!(series.abaqus(Bulk::Elastic), Err(PronyError::NoEquilibrium));
    assert_eq!(series.ansys(Bulk::Elastic), Err(PronyError::NoEquilibrium));
    // Nearly a dashpot over twelve decades: G falls by more than doubles can tell from 1.
    let springpot = Springpot::new(1.0, 0.99, 0.0).unwrap();
    let window = Window::Times { from: 1e-6, to: 1e6 };
    let series = PronySeries::new(&springpot, window, 1e-5, Slowest::Stays).unwrap();
    assert!(matches!(series.abaqus(Bulk::Elastic), Err(PronyError::Digits(lost)) if lost > 1e-5));
}
