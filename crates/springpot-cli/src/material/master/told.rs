//! A master curve as tables, as JSON and as a page.

use super::Told;
use crate::grid::{Grid, Set};
use crate::terminal;
use serde_json::{Map, Value, json};
use springpot::law::Shift;
use springpot::law::master::ShiftFit;
use springpot_run::numbers::{count, rough, short};

/// 0 degC, K.
const ZERO: f64 = 273.15;

impl Told<'_> {
    fn unit(&self) -> &'static str {
        if self.table.is_modulus { "Pa" } else { "N/m" }
    }

    /// shifts.csv.
    pub(super) fn shifts(&self) -> String {
        let more = if self.options.vertical { ",sd_b" } else { "" };
        let mut text = format!("T,log10_a_T,sd,log10_b_T{more}\n");
        for one in &self.found.shifts {
            text.push_str(&format!("{},{},{},{}", one.temperature, one.log_a, one.sd, one.log_b));
            text.push_str(&if self.options.vertical { format!(",{}\n", one.sd_b) } else { "\n".to_owned() });
        }
        text
    }

    /// master.csv.
    pub(super) fn curve(&self) -> String {
        let unit = self.unit();
        let mut text = format!("frequency [Hz],storage [{unit}],loss [{unit}],T [K]\n");
        for row in &self.found.rows {
            text.push_str(&format!("{},{},{},{}\n", row.frequency, row.storage, row.loss, row.temperature));
        }
        text
    }

    /// The line of an element.
    fn line(&self) -> String {
        let reference = short(self.found.reference);
        match self.found.chosen().shift {
            Shift::Wlf { c1, c2, .. } => {
                format!(
                    "shift = {{ kind = \"wlf\", C1 = {}, C2 = \"{} K\", T_ref = \"{reference} K\" }}",
                    short(c1),
                    short(c2)
                )
            }
            Shift::Arrhenius { energy, .. } => {
                format!(
                    "shift = {{ kind = \"arrhenius\", energy = \"{} J/mol\", T_ref = \"{reference} K\" }}",
                    short(energy)
                )
            }
        }
    }

    fn kind(&self) -> &'static str {
        match self.found.chosen().shift {
            Shift::Wlf { .. } => "wlf",
            Shift::Arrhenius { .. } => "arrhenius",
        }
    }

    /// master.json.
    pub(super) fn json(&self) -> String {
        let found = self.found;
        let fit = |fit: &ShiftFit| match fit.shift {
            Shift::Wlf { c1, c2, reference } => json!({
                "C1": c1, "C2": c2, "T_ref": reference, "sd": { "C1": fit.sd[0], "C2": fit.sd[1] },
                "correlation": fit.correlation, "rms": fit.rms, "bic": fit.bic,
            }),
            Shift::Arrhenius { energy, reference } => {
                json!({ "energy": energy, "T_ref": reference, "sd": fit.sd[0], "rms": fit.rms, "bic": fit.bic })
            }
        };
        let shifts = found.shifts.iter().map(|one| {
            json!({
                "T": one.temperature, "log10_a_T": one.log_a, "sd": one.sd, "log10_b_T": one.log_b, "sd_b": one.sd_b, "rows": one.rows,
            })
        });
        let law = self.law.as_ref().map(|(law, fitted)| {
            let each = |of: &dyn Fn(usize) -> Option<f64>| -> Map<String, Value> {
                law.params.iter().enumerate().map(|(k, param)| (param.name.to_string(), of(k).into())).collect()
            };
            json!({
                "law": law.name, "parameters": each(&|k| Some(fitted.values[k])), "sd": each(&|k| fitted.spreads[k]),
                "rms": fitted.rms, "deviation": fitted.largest, "area_over_length": self.sample,
            })
        });
        let value = json!({
            "file": self.options.file.display().to_string(), "rows": found.rows.len(), "skipped": self.table.skipped,
            "T_ref": found.reference, "unit": self.unit(), "vertical": self.options.vertical, "shifts": shifts.collect::<Vec<_>>(),
            "scatter": { "storage": found.scatter[0], "loss": found.scatter[1] }, "wlf": found.wlf.as_ref().map(fit),
            "arrhenius": fit(&found.arrhenius), "chosen": self.kind(), "shift": self.line(), "law": law,
        });
        format!("{value:#}\n")
    }

    /// What is printed.
    pub(super) fn page(&self) -> String {
        let (found, width) = (self.found, terminal::stdout_width().or(Some(80)));
        let mut titles = vec![
            ("T, degC".to_owned(), Set::Number),
            ("log10 a_T".to_owned(), Set::Number),
            ("±".to_owned(), Set::Number),
        ];
        if self.options.vertical {
            titles.extend([("log10 b_T".to_owned(), Set::Number), ("±".to_owned(), Set::Number)]);
        }
        titles.push(("rows".to_owned(), Set::Number));
        let mut grid = Grid::new(titles);
        for one in &found.shifts {
            let spread = |sd: f64| if sd == 0.0 { "0".to_owned() } else { rough(sd) };
            let mut cells = vec![format!("{:.2}", one.temperature - ZERO), format!("{:.4}", one.log_a), spread(one.sd)];
            if self.options.vertical {
                cells.extend([format!("{:.5}", one.log_b), spread(one.sd_b)]);
            }
            cells.push(one.rows.to_string());
            grid.row(cells);
        }
        let mut text = format!(
            "master curve at {} K, {} degC: E*(f a_T) = b_T E*(f, T)\n\n",
            short(found.reference),
            short(found.reference - ZERO)
        );
        text.push_str(&grid.text(terminal::stdout_width()));
        text.push('\n');
        let mut line =
            |lead: &str, words: &str| text.push_str(&terminal::hanging(&format!("  {lead:<11}"), words, width));
        let rows = count(found.rows.len(), "row", "rows");
        line("from", &format!("{}, {rows} at {} temperatures", self.options.file.display(), found.shifts.len()));
        let [storage, loss] = found.scatter.map(|scatter| rough(100.0 * scatter));
        line(
            "scatter",
            &format!("{storage} % in storage, {loss} % in loss, relative to |E*|, where neighbours overlap"),
        );
        for fit in found.wlf.iter().chain([&found.arrhenius]) {
            let spread = |sd: f64| if sd.is_finite() { format!(" ± {}", rough(sd)) } else { String::new() };
            let missed = format!(
                "misses a step by {} decades rms, BIC {}",
                rough(fit.rms),
                short((10.0 * fit.bic).round() / 10.0)
            );
            match fit.shift {
                Shift::Wlf { c1, c2, .. } => line(
                    "wlf",
                    &format!(
                        "C1 = {}{}, C2 = {}{} K; {missed}",
                        short(c1),
                        spread(fit.sd[0]),
                        short(c2),
                        spread(fit.sd[1])
                    ),
                ),
                Shift::Arrhenius { energy, .. } => line(
                    "arrhenius",
                    &format!("energy = {}{} kJ/mol; {missed}", short(energy / 1e3), spread(fit.sd[0] / 1e3)),
                ),
            }
        }
        line("±", "one standard deviation; shifts from T_ref on");
        line(
            "files",
            &format!("shifts.csv, master.csv, master.json, master.svg, shifts.svg in {}", self.folder.display()),
        );
        if let Some((law, fitted)) = &self.law {
            text.push_str(&format!("\n{}   {}\n\n", law.name, law.equation));
            for ((param, value), spread) in law.params.iter().zip(&fitted.values).zip(&fitted.spreads) {
                let unit = &param.unit;
                let spread = match spread {
                    Some(spread) => format!("± {} {unit}", rough(*spread)),
                    None => format!("{unit}, an end of its range"),
                };
                text.push_str(format!("  {:<5} = {} {spread}", param.name, short(*value)).trim_end());
                text.push('\n');
            }
            let [rms, largest] = [fitted.rms, fitted.largest].map(|share| rough(100.0 * share));
            text.push_str(&format!("  deviation {rms} % rms, {largest} % at most, relative to |K|\n"));
            if self.table.is_modulus && self.options.area.is_none() {
                text.push_str("  of a part of 1 m^2 and 1 m: give --area and --length for another\n");
            }
        }
        text.push_str(&format!("\nBIC prefers {}. In an element:\n\n{}\n", self.kind(), self.line()));
        text
    }
}
