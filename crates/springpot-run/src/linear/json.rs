//! Small motions as data.

use super::about::{About, Stopped};
use super::channels::{column, input};
use serde_json::{Value, json};
use springpot::linear::{Mode, Modes};
use std::f64::consts::TAU;

/// What all files of data say first.
pub fn about_json(about: &About) -> Value {
    let names: Vec<String> = about.system.model.q_labels().into_iter().map(|label| label.name).collect();
    json!({
        "t": about.t, "equilibrium": about.equilibrium.is_some(), "q_names": names, "q": about.linear.q,
        "velocities": about.linear.velocity_names(), "left_over": about.linear.left_over,
    })
}

/// Eigenvalues.
pub fn modes_json(about: &About, modes: &Modes) -> Value {
    let mode = |mode: &Mode| {
        let shape = |part: &dyn Fn(usize) -> f64| (0..mode.shape.len()).map(part).collect::<Vec<_>>();
        json!({
            "re": mode.eigenvalue.re, "im": mode.eigenvalue.im, "frequency": mode.frequency(),
            "damped_frequency": mode.damped_frequency(), "damping_ratio": mode.damping_ratio(),
            "time_constant": (mode.eigenvalue.re != 0.0).then(|| mode.time_constant()), "unstable": mode.is_unstable(),
            "moves": mode.largest, "shape_re": shape(&|k| mode.shape[k].re), "shape_im": shape(&|k| mode.shape[k].im),
        })
    };
    let mut value = about_json(about);
    value["modes"] = modes.modes.iter().map(mode).collect();
    value["free_motions"] = modes.free_motions.into();
    value["fractional"] = modes.is_fractional.into();
    value["complete"] = modes.is_complete().into();
    value
}

/// The answers of a column to sines of an input at frequencies, Hz: `real` and `imaginary`, and the units of both.
///
/// # Errors
/// [`Stopped::Refused`] where one of them is not known.
pub fn response_json(about: &About, names: [&str; 2], frequencies: &[f64]) -> Result<Value, Stopped> {
    let refuse = |(message, help): (String, String)| Stopped::Refused(message, help);
    let input = input(about, "input", names[0]).map_err(refuse)?;
    let column = column(about, "column", names[1]).map_err(refuse)?;
    let one = |hertz: &f64| about.linear.frequency_response(input.what, column.what, TAU * hertz);
    let answers = frequencies.iter().map(one).collect::<Result<Vec<_>, _>>();
    let answers = answers.map_err(|why| refuse((why.to_string(), "take another column".to_owned())))?;
    let mut value = about_json(about);
    value["input"] = input.name.into();
    value["column"] = column.name.into();
    value["units"] = json!([input.unit, column.unit]);
    value["frequency"] = frequencies.into();
    value["real"] = answers.iter().map(|answer| answer.re).collect::<Vec<_>>().into();
    value["imaginary"] = answers.iter().map(|answer| answer.im).collect::<Vec<_>>().into();
    Ok(value)
}
