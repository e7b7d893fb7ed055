use springpot::fractional::*;
#[test]
fn probe() {
    let v: serde_json::Value = serde_json::from_str(
        &std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/fractional/derivatives.json"))
            .unwrap(),
    )
    .unwrap();
    let fs: [(&str, fn(f64) -> f64); 4] = [
        ("0.7*sin(8t)+0.1*t", |t| 0.7 * (8.0 * t).sin() + 0.1 * t),
        ("1+sin(3t)", |t| 1.0 + (3.0 * t).sin()),
        ("cos(3t)", |t| (3.0 * t).cos()),
        ("exp(-t)", |t| (-t).exp()),
    ];
    for (name, f) in fs {
        let i = std::time::Instant::now();
        let p = Piecewise::of(f, 0.0..=50.0, 1e-15).unwrap();
        println!("{name}: {} pieces {:?}", p.pieces(), i.elapsed());
        for a in [0.1, 0.5, 0.9] {
            let i = std::time::Instant::now();
            let d = p.derivative(a, Definition::Caputo).unwrap();
            let el = i.elapsed();
            let rows: Vec<(f64, f64, f64)> = v["functions"][name]
                .as_array()
                .unwrap()
                .iter()
                .map(|r| {
                    let g = |k: &str| r[k].as_str().unwrap().parse::<f64>().unwrap();
                    (g("t"), g("alpha"), g("caputo"))
                })
                .filter(|r| r.1 == a)
                .collect();
            let big = rows.iter().fold(0.0f64, |m, v| m.max(v.2.abs()));
            let i = std::time::Instant::now();
            let e = rows
                .iter()
                .map(|r| {
                    let y = d.at(r.0);
                    ((y.value - r.2).abs() / big, y.error / big)
                })
                .fold((0.0f64, 0.0f64), |m, e| (m.0.max(e.0), m.1.max(e.1)));
            println!("  {a}: err {:.1e} est {:.1e} build {:?} at {:?}", e.0, e.1, el, i.elapsed() / 20);
        }
    }
    for p in [0.5, 1.5, 2.5, 0.1, 0.0] {
        let i = std::time::Instant::now();
        let f = Piecewise::of(|t| t.powf(p), 0.0..=10.0, 1e-15).unwrap();
        println!("t^{p}: {} pieces {:?}", f.pieces(), i.elapsed());
        for a in [-1.5, -0.5, 0.1, 0.5, 0.99, 1.0, 1.5, 1.99] {
            let d = f.derivative(a, Definition::RiemannLiouville).unwrap();
            let e: Vec<(f64, f64)> = [1e-6, 1e-3, 0.01, 0.3, 1.0, 3.0, 10.0]
                .iter()
                .map(|&t| {
                    let y = d.at(t);
                    let ex = gamma::gamma(p + 1.0) * gamma::reciprocal_gamma(p + 1.0 - a) * f64::powf(t, p - a);
                    ((y.value - ex).abs() / ex.abs().max(1.0), y.error / ex.abs().max(1.0))
                })
                .collect();
            println!(
                "   a={a}: err {:?} est {:?}",
                e.iter().map(|e| format!("{:.0e}", e.0)).collect::<Vec<_>>().join(" "),
                e.iter().map(|e| format!("{:.0e}", e.1)).collect::<Vec<_>>().join(" ")
            );
        }
    }
    // kink & step in closures
    for (n, f) in [
        ("kink", (|t: f64| (t - 1.0).abs()) as fn(f64) -> f64),
        ("step", |t| if t > 1.0 { 1.0 } else { 0.0 }),
        ("kink.3", |t| (t - 1.3).abs()),
    ] {
        let i = std::time::Instant::now();
        let p = Piecewise::of(f, 0.0..=10.0, 1e-15).unwrap();
        println!("{n}: {} pieces {:?}", p.pieces(), i.elapsed());
        for a in [-0.5, 0.5, 0.99, 1.5] {
            let d = p.derivative(a, Definition::Caputo).unwrap();
            let s = if n == "kink.3" { 1.3 } else { 1.0 };
            for t in [0.5, 1.31, 2.0, 9.0] {
                let pw = |q: f64| if t > s { f64::powf(t - s, q) } else { 0.0 };
                let r = gamma::reciprocal_gamma;
                let ex = if n == "step" {
                    pw(-a) * r(1.0 - a)
                } else {
                    let base = if a > 1.0 {
                        0.0
                    } else if a > 0.0 {
                        -f64::powf(t, 1.0 - a) * r(2.0 - a)
                    } else {
                        s * f64::powf(t, -a) * r(1.0 - a) - f64::powf(t, 1.0 - a) * r(2.0 - a)
                    };
                    base + 2.0 * pw(1.0 - a) * r(2.0 - a)
                };
                let y = d.at(t);
                println!("   a={a} t={t} err {:.1e} est {:.1e}", (y.value - ex).abs(), y.error);
            }
        }
    }
}
