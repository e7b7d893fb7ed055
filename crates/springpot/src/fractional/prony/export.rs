//! Prony series as the tables that other programs read.

use super::{PronyError, PronySeries, Window};
use std::fmt::Write;

/// What the bulk modulus does where a series is taken for a shear modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bulk {
    /// It does not relax: nearly incompressible rubber.
    Elastic,
    /// It relaxes like the shear modulus: Poisson's ratio stays constant.
    Relaxes,
}

impl PronySeries {
    /// `term,modulus,relaxation_time,viscosity` with a row for each branch, fastest first.
    ///
    /// A branch is a spring of `modulus` in series with a damper of `viscosity` = modulus·relaxation_time: stiffness
    /// and damping of a spring–damper pair in series, as MuJoCo and other multibody codes build them from a massless
    /// body. The first row, term 0, is the equilibrium spring with empty time and viscosity.
    pub fn csv(&self) -> String {
        let mut text = format!("term,modulus,relaxation_time,viscosity\n0,{},,\n", number(self.equilibrium));
        for (k, term) in (1..).zip(&self.terms) {
            let [modulus, time, viscosity] = [term.modulus, term.relaxation_time, term.viscosity()].map(number);
            let _ = writeln!(text, "{k},{modulus},{time},{viscosity}");
        }
        text
    }

    /// Abaqus keywords: `*VISCOELASTIC, TIME=PRONY` with data lines g_i, k_i, τ_i, all moduli relative to the
    /// instantaneous one.
    ///
    /// # Errors
    /// [`PronyError::NoEquilibrium`] where Σg_i is not below 1; [`super::Slowest::Stays`] keeps it below.
    /// [`PronyError::Digits`] where the moduli of the window span so many decades that 1 − Σg_i has too few digits.
    pub fn abaqus(&self, bulk: Bulk) -> Result<String, PronyError> {
        let ratios = self.ratios()?;
        let mut text = String::new();
        for line in self.heading() {
            let _ = writeln!(text, "** {line}");
        }
        text.push_str("** Elastic constants of the material: *ELASTIC, MODULI=INSTANTANEOUS\n");
        text.push_str("** Data lines: g_i, k_i, tau_i in s\n*VISCOELASTIC, TIME=PRONY\n");
        for (ratio, term) in ratios.iter().zip(&self.terms) {
            let k = if bulk == Bulk::Relaxes { *ratio } else { 0.0 };
            let _ = writeln!(text, "{}, {}, {}", field(*ratio), field(k), field(term.relaxation_time));
        }
        Ok(text)
    }

    /// Ansys Mechanical APDL commands for material 1: `TB,PRONY` and `TBDATA` with pairs of relative modulus and
    /// relaxation time, three pairs to a line; moduli relative to the instantaneous one.
    ///
    /// # Errors
    /// Those of [`Self::abaqus`].
    pub fn ansys(&self, bulk: Bulk) -> Result<String, PronyError> {
        let ratios = self.ratios()?;
        let mut text = String::new();
        for line in self.heading() {
            let _ = writeln!(text, "! {line}");
        }
        text.push_str("! Elastic constants of the material (MP,EX and MP,NUXY) are the instantaneous ones.\n");
        let parts: &[&str] = if bulk == Bulk::Relaxes { &["SHEAR", "BULK"] } else { &["SHEAR"] };
        for part in parts {
            let _ = writeln!(text, "TB,PRONY,1,1,{},{part}", self.terms.len());
            let pairs: Vec<String> = ratios
                .iter()
                .zip(&self.terms)
                .map(|(ratio, term)| format!("{},{}", field(*ratio), field(term.relaxation_time)))
                .collect();
            for (line, pairs) in pairs.chunks(3).enumerate() {
                let _ = writeln!(text, "TBDATA,{},{}", 6 * line + 1, pairs.join(","));
            }
        }
        Ok(text)
    }

    /// g_i = modulus/instantaneous modulus, whose sum is below 1.
    fn ratios(&self) -> Result<Vec<f64>, PronyError> {
        let whole = self.instantaneous();
        let ratios: Vec<f64> = self.terms.iter().map(|term| term.modulus / whole).collect();
        if ratios.iter().sum::<f64>() >= 1.0 || self.equilibrium <= 0.0 {
            return Err(PronyError::NoEquilibrium);
        }
        let smallest = match self.window {
            Window::Times { to, .. } => self.relaxation(to),
            Window::Frequencies { from, .. } => self.complex_modulus(from).norm(),
        };
        // The reader takes the long-term modulus from 1 − Σg_i; a field may round a number to 15 digits.
        let rounding = 2.0 * f64::EPSILON * ratios.len() as f64 * whole / smallest;
        if self.error + rounding <= self.tolerance { Ok(ratios) } else { Err(PronyError::Digits(rounding)) }
    }

    /// What a reader of the table must know.
    fn heading(&self) -> Vec<String> {
        let (from, to) = self.window.ends();
        let (window, what) = match self.window {
            Window::Times { .. } => (format!("times from {} to {} s", number(from), number(to)), "G(t)"),
            Window::Frequencies { .. } => {
                (format!("angular frequencies from {} to {} rad/s", number(from), number(to)), "G*")
            }
        };
        let mut lines = vec![
            format!("Prony series of {} terms for {window}", self.terms.len()),
            format!("Verified relative error of {what} there: {:.2e} (bound {:e})", self.error, self.tolerance),
            format!("Instantaneous modulus: {}", number(self.instantaneous())),
            format!("Long-term modulus, 1 - sum of g_i of it: {}", number(self.equilibrium)),
        ];
        if self.residual > 0.0 {
            let own = self.equilibrium - self.residual;
            lines.push(format!(
                "It stands for what relaxes later; the equilibrium modulus of the material: {}",
                number(own)
            ));
        }
        lines
    }
}

/// The shortest text that reads back to the same bits, with an exponent where that is shorter.
fn number(value: f64) -> String {
    let (plain, scientific) = (format!("{value}"), format!("{value:e}"));
    if plain.len() <= scientific.len() { plain } else { scientific }
}

/// Longest number that Abaqus reads.
const WIDEST_FIELD: usize = 20;

/// As many digits as fit.
fn field(value: f64) -> String {
    let exact = number(value);
    let shorter = |digits: usize| format!("{value:.digits$e}");
    if exact.len() <= WIDEST_FIELD {
        return exact;
    }
    (8..17).rev().map(shorter).find(|text| text.len() <= WIDEST_FIELD).unwrap_or(exact)
}
