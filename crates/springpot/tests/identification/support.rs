//! Problems of one series, y = f(x; p) with derivatives, and random numbers.

use springpot::identification::{Failed, Parameter, Problem, Rows, Series};

/// The value of a model and its derivatives by the parameters at x.
pub(crate) type Model = fn(f64, &[f64], &mut [f64]) -> f64;

/// (model − y)/sd at points.
pub(crate) struct Curve {
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) series: Vec<Series>,
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) model: Model,
    pub(crate) sd: f64,
}

impl Curve {
    pub(crate) fn new(parameters: Vec<Parameter>, points: Vec<[f64; 2]>, model: Model) -> Self {
        Self { parameters, series: vec![Series::new("y")], points, model, sd: 1.0 }
    }
}

impl Problem for Curve {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn rows(&self, values: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let mut by = vec![0.0; values.len()];
        for [x, y] in &self.points {
            let model = (self.model)(*x, values, &mut by);
            by.iter_mut().for_each(|by| *by /= self.sd);
            take(Rows { series: 0, residuals: &[(model - y) / self.sd], jacobian: &by });
        }
        Ok(())
    }
}

/// splitmix64 and normal deviates by Box and Muller.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn normal(&mut self) -> f64 {
        let (a, b) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}
