//! NIST's Statistical Reference Datasets for nonlinear regression, which are in the public domain: both starts of each come to the
//! certified values, standard deviations and sums of squares.
//!
//! <https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml>

use crate::support::{Curve, Model};
use springpot::identification::{Parameter, Settings, Status, fit};
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

struct Set {
    name: &'static str,
    model: Model,
    starts: [&'static [f64]; 2],
    certified: &'static [f64],
    sd: &'static [f64],
    squares: f64,
    x: &'static [f64],
    y: &'static [f64],
}

fn thurber(x: f64, b: &[f64], by: &mut [f64]) -> f64 {
    let (above, below) = (b[0] + x * (b[1] + x * (b[2] + x * b[3])), 1.0 + x * (b[4] + x * (b[5] + x * b[6])));
    for k in 0..4 {
        by[k] = x.powi(k as i32) / below;
    }
    for k in 1..4 {
        by[3 + k] = -above * x.powi(k as i32) / (below * below);
    }
    above / below
}

fn roszman(x: f64, b: &[f64], by: &mut [f64]) -> f64 {
    let ratio = b[2] / (x - b[3]);
    let slope = -1.0 / (PI * (1.0 + ratio * ratio));
    by.copy_from_slice(&[1.0, -x, slope / (x - b[3]), slope * ratio / (x - b[3])]);
    b[0] - b[1] * x - ratio.atan() / PI
}

fn mgh09(x: f64, b: &[f64], by: &mut [f64]) -> f64 {
    let (above, below) = (x * (x + b[1]), x * (x + b[2]) + b[3]);
    let value = b[0] * above / below;
    by.copy_from_slice(&[above / below, b[0] * x / below, -value * x / below, -value / below]);
    value
}

fn mgh17(x: f64, b: &[f64], by: &mut [f64]) -> f64 {
    let (first, second) = ((-x * b[3]).exp(), (-x * b[4]).exp());
    by.copy_from_slice(&[1.0, first, second, -x * b[1] * first, -x * b[2] * second]);
    b[0] + b[1] * first + b[2] * second
}

fn eckerle(x: f64, b: &[f64], by: &mut [f64]) -> f64 {
    let z = (x - b[2]) / b[1];
    let bell = (-0.5 * z * z).exp() / b[1];
    by.copy_from_slice(&[bell, b[0] * bell * (z * z - 1.0) / b[1], b[0] * bell * z / b[1]]);
    b[0] * bell
}

const SETS: [Set; 10] = [
    Set {
        name: "Misra1a",
        model: |x, b, by| {
            let rest = (-b[1] * x).exp();
            by.copy_from_slice(&[1.0 - rest, b[0] * x * rest]);
            b[0] * (1.0 - rest)
        },
        starts: [&[500.0, 0.0001], &[250.0, 0.0005]],
        certified: &[2.3894212918E+02, 5.5015643181E-04],
        sd: &[2.7070075241E+00, 7.2668688436E-06],
        squares: 1.2455138894E-01,
        x: &[77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0],
        y: &[10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78],
    },
    Set {
        name: "DanWood",
        model: |x, b, by| {
            let power = x.powf(b[1]);
            by.copy_from_slice(&[power, b[0] * power * x.ln()]);
            b[0] * power
        },
        starts: [&[1.0, 5.0], &[0.7, 4.0]],
        certified: &[7.6886226176E-01, 3.8604055871E+00],
        sd: &[1.8281973860E-02, 5.1726610913E-02],
        squares: 4.3173084083E-03,
        x: &[1.309, 1.471, 1.490, 1.565, 1.611, 1.680],
        y: &[2.138, 3.421, 3.597, 4.340, 4.882, 5.660],
    },
    Set {
        name: "BoxBOD",
        model: |x, b, by| {
            let rest = (-b[1] * x).exp();
            by.copy_from_slice(&[1.0 - rest, b[0] * x * rest]);
            b[0] * (1.0 - rest)
        },
        starts: [&[1.0, 1.0], &[100.0, 0.75]],
        certified: &[2.1380940889E+02, 5.4723748542E-01],
        sd: &[1.2354515176E+01, 1.0455993237E-01],
        squares: 1.1680088766E+03,
        x: &[1.0, 2.0, 3.0, 5.0, 7.0, 10.0],
        y: &[109.0, 149.0, 149.0, 191.0, 213.0, 224.0],
    },
    Set {
        name: "Rat42",
        model: |x, b, by| {
            let rest = (b[1] - b[2] * x).exp();
            let value = b[0] / (1.0 + rest);
            let slope = -value * rest / (1.0 + rest);
            by.copy_from_slice(&[1.0 / (1.0 + rest), slope, -x * slope]);
            value
        },
        starts: [&[100.0, 1.0, 0.1], &[75.0, 2.5, 0.07]],
        certified: &[7.2462237576E+01, 2.6180768402E+00, 6.7359200066E-02],
        sd: &[1.7340283401E+00, 8.8295217536E-02, 3.4465663377E-03],
        squares: 8.0565229338E+00,
        x: &[9.0, 14.0, 21.0, 28.0, 42.0, 57.0, 63.0, 70.0, 79.0],
        y: &[8.930, 10.800, 18.590, 22.330, 39.350, 56.110, 61.730, 64.620, 67.080],
    },
    Set {
        name: "Roszman1",
        model: roszman,
        starts: [&[0.1, -0.00001, 1000.0, -100.0], &[0.2, -0.000005, 1200.0, -150.0]],
        certified: &[2.0196866396E-01, -6.1953516256E-06, 1.2044556708E+03, -1.8134269537E+02],
        sd: &[1.9172666023E-02, 3.2058931691E-06, 7.4050983057E+01, 4.9573513849E+01],
        squares: 4.9484847331E-04,
        x: &[
            -4868.68, -4868.09, -4867.41, -3375.19, -3373.14, -3372.03, -2473.74, -2472.35, -2469.45, -1894.65,
            -1893.40, -1497.24, -1495.85, -1493.41, -1208.68, -1206.18, -1206.04, -997.92, -996.61, -996.31, -834.94,
            -834.66, -710.03, -530.16, -464.17,
        ],
        y: &[
            0.252429, 0.252141, 0.251809, 0.297989, 0.296257, 0.295319, 0.339603, 0.337731, 0.333820, 0.389510,
            0.386998, 0.438864, 0.434887, 0.427893, 0.471568, 0.461699, 0.461144, 0.513532, 0.506641, 0.505062,
            0.535648, 0.533726, 0.568064, 0.612886, 0.624169,
        ],
    },
    Set {
        name: "MGH09",
        model: mgh09,
        starts: [&[25.0, 39.0, 41.5, 39.0], &[0.25, 0.39, 0.415, 0.39]],
        certified: &[1.9280693458E-01, 1.9128232873E-01, 1.2305650693E-01, 1.3606233068E-01],
        sd: &[1.1435312227E-02, 1.9633220911E-01, 8.0842031232E-02, 9.0025542308E-02],
        squares: 3.0750560385E-04,
        x: &[4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625],
        y: &[0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246],
    },
    Set {
        name: "MGH10",
        model: |x, b, by| {
            let part = (b[1] / (x + b[2])).exp();
            by.copy_from_slice(&[part, b[0] * part / (x + b[2]), -b[0] * part * b[1] / (x + b[2]).powi(2)]);
            b[0] * part
        },
        starts: [&[2.0, 400000.0, 25000.0], &[0.02, 4000.0, 250.0]],
        certified: &[5.6096364710E-03, 6.1813463463E+03, 3.4522363462E+02],
        sd: &[1.5687892471E-04, 2.3309021107E+01, 7.8486103508E-01],
        squares: 8.7945855171E+01,
        x: &[50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0, 95.0, 100.0, 105.0, 110.0, 115.0, 120.0, 125.0],
        y: &[
            34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0, 5147.0,
            4427.0, 3820.0, 3307.0, 2872.0,
        ],
    },
    Set {
        name: "Thurber",
        model: thurber,
        starts: [&[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03], &[1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05]],
        certified: &[
            1.2881396800E+03,
            1.4910792535E+03,
            5.8323836877E+02,
            7.5416644291E+01,
            9.6629502864E-01,
            3.9797285797E-01,
            4.9727297349E-02,
        ],
        sd: &[
            4.6647963344E+00,
            3.9571156086E+01,
            2.8698696102E+01,
            5.5675370270E+00,
            3.1333340687E-02,
            1.4984928198E-02,
            6.5842344623E-03,
        ],
        squares: 5.6427082397E+03,
        x: &[
            -3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481, -2.363, -2.322, -1.501,
            -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714, -0.566, -0.545, -0.400, -0.309, -0.109, -0.103,
            0.010, 0.119, 0.377, 0.790, 0.963, 1.006, 1.115, 1.572, 1.841, 2.047, 2.200,
        ],
        y: &[
            80.574, 84.248, 87.264, 87.195, 89.076, 89.608, 89.868, 90.101, 92.405, 95.854, 100.696, 101.060, 401.672,
            390.724, 567.534, 635.316, 733.054, 759.087, 894.206, 990.785, 1090.109, 1080.914, 1122.643, 1178.351,
            1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384, 1442.962, 1464.350,
            1468.705, 1447.894, 1457.628,
        ],
    },
    Set {
        name: "MGH17",
        model: mgh17,
        starts: [&[50.0, 150.0, -100.0, 1.0, 2.0], &[0.5, 1.5, -1.0, 0.01, 0.02]],
        certified: &[3.7541005211E-01, 1.9358469127E+00, -1.4646871366E+00, 1.2867534640E-02, 2.2122699662E-02],
        sd: &[2.0723153551E-03, 2.2031669222E-01, 2.2175707739E-01, 4.4861358114E-04, 8.9471996575E-04],
        squares: 5.4648946975E-05,
        x: &[
            0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 110.0, 120.0, 130.0, 140.0, 150.0, 160.0,
            170.0, 180.0, 190.0, 200.0, 210.0, 220.0, 230.0, 240.0, 250.0, 260.0, 270.0, 280.0, 290.0, 300.0, 310.0,
            320.0,
        ],
        y: &[
            0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658, 0.628,
            0.603, 0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420,
            0.414, 0.411, 0.406,
        ],
    },
    Set {
        name: "Eckerle4",
        model: eckerle,
        starts: [&[1.0, 10.0, 500.0], &[1.5, 5.0, 450.0]],
        certified: &[1.5543827178E+00, 4.0888321754E+00, 4.5154121844E+02],
        sd: &[1.5408051163E-02, 4.6803020753E-02, 4.6800518816E-02],
        squares: 1.4635887487E-03,
        x: &[
            400.0, 405.0, 410.0, 415.0, 420.0, 425.0, 430.0, 435.0, 436.5, 438.0, 439.5, 441.0, 442.5, 444.0, 445.5,
            447.0, 448.5, 450.0, 451.5, 453.0, 454.5, 456.0, 457.5, 459.0, 460.5, 462.0, 463.5, 465.0, 470.0, 475.0,
            480.0, 485.0, 490.0, 495.0, 500.0,
        ],
        y: &[
            0.0001575, 0.0001699, 0.0002350, 0.0003102, 0.0004917, 0.0008710, 0.0017418, 0.0046400, 0.0065895,
            0.0097302, 0.0149002, 0.0237310, 0.0401683, 0.0712559, 0.1264458, 0.2073413, 0.2902366, 0.3445623,
            0.3698049, 0.3668534, 0.3106727, 0.2078154, 0.1164354, 0.0616764, 0.0337200, 0.0194023, 0.0117831,
            0.0074357, 0.0022732, 0.0008800, 0.0004579, 0.0002345, 0.0001586, 0.0001143, 0.0000710,
        ],
    },
];

/// From one start without bounds. Three first starts lie far off: MGH17 is a long way in a narrow valley, b2 of BoxBOD runs away to where
/// the curve is a step, b1 of MGH10 to 0.
#[test]
fn certified_values() {
    let (mut numbers, mut far) = (0, Vec::new());
    for set in &SETS {
        assert_eq!(set.x.len(), set.y.len(), "{}", set.name);
        let points: Vec<[f64; 2]> = set.x.iter().zip(set.y).map(|(x, y)| [*x, *y]).collect();
        for (k, start) in set.starts.iter().enumerate() {
            let parameters = start.iter().map(|value| Parameter::free("b", *value)).collect();
            let curve = Curve::new(parameters, points.clone(), set.model);
            let settings = Settings { starts: 1, steps: 3000, ..Settings::default() };
            let found = fit(&curve, &settings, &AtomicBool::new(false)).unwrap();
            if found.cost > 1.001 * set.squares {
                far.push((set.name, k));
                continue;
            }
            assert_eq!(found.status, Status::Converged, "{} {k}", set.name);
            assert!((found.cost / set.squares - 1.0).abs() < 1e-9, "{} {k}: {:e}", set.name, found.cost);
            for (j, (certified, sd)) in set.certified.iter().zip(set.sd).enumerate() {
                let [value, spread] =
                    [found.values[j] / certified - 1.0, found.sd(j) / found.widening / sd - 1.0].map(f64::abs);
                assert!(value < 1e-8, "{} {k}: b{} = {:e}, {value:.1e}", set.name, j + 1, found.values[j]);
                assert!(spread < 1e-6, "{} {k}: sd of b{} = {:e}, {spread:.1e}", set.name, j + 1, found.sd(j));
                numbers += 2;
            }
        }
    }
    assert_eq!(far, [("BoxBOD", 0), ("MGH10", 0)]);
    assert_eq!(numbers, 4 * (2 + 2 + 2 + 3 + 4 + 4 + 3 + 7 + 5 + 3) - 2 * (2 + 3));
}
