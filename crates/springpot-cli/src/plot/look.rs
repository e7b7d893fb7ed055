//! What the options say of the look of a figure.

use super::Refused;
use clap::Args;
use springpot_run::figures::{AskedAxis, AskedLook, FigureColumn, Look, Misfit, Part};
use springpot_scenario::RangeEnd;
use springpot_scenario::units;

/// Smallest and largest side of a figure, m.
const SIDES: [f64; 2] = [0.02, 2.0];

/// Options of the look of a figure.
#[derive(Debug, Args)]
#[command(next_help_heading = "Look of the figure")]
pub(crate) struct LookOptions {
    /// First and last value of x, in its unit or as quantities, such as 0,10 or 5ms,8ms
    #[arg(long, value_name = "A,B", allow_hyphen_values = true)]
    x_range: Option<String>,
    /// First and last value of y
    #[arg(long, value_name = "A,B", allow_hyphen_values = true)]
    y_range: Option<String>,
    /// Scale of x: linear or log
    #[arg(long, value_name = "SCALE", value_parser = ["linear", "log"], hide_possible_values = true)]
    x_scale: Option<String>,
    /// Scale of y: linear or log
    #[arg(long, value_name = "SCALE", value_parser = ["linear", "log"], hide_possible_values = true)]
    y_scale: Option<String>,
    /// equal: x and y have one scale, so that a circle is round
    #[arg(long, value_name = "ASPECT", value_parser = ["equal"], hide_possible_values = true)]
    aspect: Option<String>,
    /// Width and height of the page, such as 90mm,60mm [default: 150 mm wide]
    #[arg(long, value_name = "WIDTH,HEIGHT")]
    size: Option<String>,
    /// What stands at x, its unit included
    #[arg(long, value_name = "TEXT")]
    x_label: Option<String>,
    /// What stands at y, its unit included
    #[arg(long, value_name = "TEXT")]
    y_label: Option<String>,
    /// What a column is called; may be given several times
    #[arg(long = "label", value_name = "COLUMN=TEXT")]
    pub(super) labels: Vec<String>,
    /// What stands above the legend
    #[arg(long, value_name = "TEXT", conflicts_with = "no_legend")]
    legend: Option<String>,
    /// Draw no legend
    #[arg(long)]
    no_legend: bool,
    /// Draw only rows with t from A to B, in s or with a unit
    #[arg(long, value_name = "A,B", allow_hyphen_values = true)]
    window: Option<String>,
}

impl LookOptions {
    /// The look of a figure with these columns.
    pub(super) fn look(&self, x: &FigureColumn, y: &[FigureColumn]) -> Result<Look, Refused> {
        let axis = |option: &str, range: &Option<String>, scale: &Option<String>, label: &Option<String>| {
            let range = range.as_ref().map(|text| ends(option, text)).transpose()?;
            Ok(AskedAxis { range, is_log: scale.as_deref() == Some("log"), label: label.clone() })
        };
        let asked = AskedLook {
            x: axis("--x-range", &self.x_range, &self.x_scale, &self.x_label)?,
            y: axis("--y-range", &self.y_range, &self.y_scale, &self.y_label)?,
            is_equal: self.aspect.is_some(),
            size: self.size.as_ref().map(|text| size(text)).transpose()?,
            legend: self.legend.clone(),
            hides_legend: self.no_legend,
        };
        if asked.is_equal && (asked.x.is_log || asked.y.is_log) {
            let help = "leave --aspect out, or the scale".to_owned();
            return Err(Refused::new("--aspect equal has no meaning on a logarithmic scale", help));
        }
        Look::new(asked, x, y).map_err(|Misfit { part, message, help }| {
            let option = match part {
                Part::X => format!("--x-range {}", self.x_range.as_deref().unwrap_or_default()),
                Part::Y => format!("--y-range {}", self.y_range.as_deref().unwrap_or_default()),
                Part::Aspect => "--aspect equal:".to_owned(),
            };
            Refused::new(format!("{option} {message}"), help)
        })
    }

    /// The stretch of time that is drawn, s.
    pub(super) fn window(&self) -> Result<Option<[f64; 2]>, Refused> {
        let Some(text) = &self.window else { return Ok(None) };
        let time = |text: &str| {
            units::parse_quantity(text, "s", &|_| None).map_err(|error| {
                Refused::new(
                    format!("--window {text}: {error}"),
                    "write two times, such as 1,2 or 100ms,200ms".to_owned(),
                )
            })
        };
        let [from, to] = pair("--window", text)?;
        let [from, to] = [time(from)?, time(to)?];
        if from < to {
            return Ok(Some([from, to]));
        }
        let message = format!("--window {text} runs from {from} s to {to} s, which is no stretch of time");
        Err(Refused::new(message, "write the earlier time first".to_owned()))
    }
}

/// The two parts of a text with a comma.
fn pair<'t>(option: &str, text: &'t str) -> Result<[&'t str; 2], Refused> {
    match text.split(',').map(str::trim).collect::<Vec<_>>()[..] {
        [first, second] => Ok([first, second]),
        _ => {
            let help = format!("write two values with a comma between them, as in {option} A,B");
            Err(Refused::new(format!("{option} {text:?} is not two values"), help))
        }
    }
}

fn ends(option: &str, text: &str) -> Result<[RangeEnd; 2], Refused> {
    let end = |text: &str| {
        RangeEnd::parse(text).map_err(|why| {
            let help = "write numbers in the unit that is drawn, or quantities such as 5N".to_owned();
            Refused::new(format!("{option}: {text:?} is {why}"), help)
        })
    };
    let [from, to] = pair(option, text)?;
    Ok([end(from)?, end(to)?])
}

fn size(text: &str) -> Result<[f64; 2], Refused> {
    let help = || format!("write two lengths from {} to {} mm, as in 90mm,60mm", 1e3 * SIDES[0], 1e3 * SIDES[1]);
    let side = |text: &str| match units::parse_quantity(text, "m", &|_| None) {
        Ok(side) if (SIDES[0]..=SIDES[1]).contains(&side) => Ok(side),
        Ok(_) => Err(Refused::new(format!("--size: {text} is no side of a figure"), help())),
        Err(error) => Err(Refused::new(format!("--size: {text}: {error}"), help())),
    };
    let [width, height] = pair("--size", text)?;
    Ok([side(width)?, side(height)?])
}
