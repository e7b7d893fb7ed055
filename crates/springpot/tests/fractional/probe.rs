use springpot::fractional::scheme::Samples;
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
    let n = 40000;
    let h = 10.0 / n as f64;
    let t: Vec<f64> = (0..=n).map(|k| k as f64 * h).collect();
    for (name, f) in fs {
        let x: Vec<f64> = t.iter().map(|t| f(*t)).collect();
        let s = Samples { t: &t, x: &x, rate: None };
        for m in [Method::Spline, Method::Hermite, Method::Exponential] {
            for a in [0.1, 0.5, 0.9] {
                let y = derivative(&s, a, Definition::Caputo, m).unwrap();
                let big = y.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                let mut e = 0.0f64;
                let mut c = 0;
                for r in v["functions"][name].as_array().unwrap() {
                    let g = |k: &str| r[k].as_str().unwrap().parse::<f64>().unwrap();
                    let tt = g("t");
                    if tt > 10.0 || g("alpha") != a {
                        continue;
                    }
                    let k = (tt / h).round() as usize;
                    if (k as f64 * h - tt).abs() > 1e-9 {
                        continue;
                    }
                    c += 1;
                    e = e.max((y[k] - g("caputo")).abs() / big);
                }
                println!("{name} {m} {a}: {e:.1e} ({c})");
            }
        }
        // methods against each other at all orders
        for a in [-2.0, -1.9, -1.5, -1.0, -0.5, -0.01, 0.0, 0.01, 0.5, 0.99, 1.0, 1.01, 1.5, 1.9, 1.99, 2.0] {
            let y: Vec<Vec<f64>> = [Method::Spline, Method::Hermite, Method::Exponential]
                .iter()
                .map(|m| derivative(&s, a, Definition::Caputo, *m).unwrap())
                .collect();
            let big = y[0].iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let d = |i: usize, j: usize| y[i].iter().zip(&y[j]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / big;
            println!("{name} a={a}: spl-her {:.1e} spl-exp {:.1e}", d(0, 1), d(0, 2));
        }
    }
    for n in [100_000usize, 1_000_000] {
        let h = 10.0 / n as f64;
        let t: Vec<f64> = (0..n).map(|k| k as f64 * h).collect();
        let x: Vec<f64> = t.iter().map(|t| fs[0].1(*t)).collect();
        let s = Samples { t: &t, x: &x, rate: None };
        for m in [Method::Spline, Method::Hermite, Method::Exponential] {
            for a in [-0.5, 0.5, 1.5] {
                let i = std::time::Instant::now();
                let _ = derivative(&s, a, Definition::Caputo, m).unwrap();
                println!("{n} {m} {a}: {:?}", i.elapsed());
            }
        }
    }
}
