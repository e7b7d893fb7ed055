//! `springpot linearise`: x' = A x + B u, y = C x + D u about rest.

use super::modes::Stopped;
use super::modes::asked::Asked;
use crate::arguments::LineariseOptions;
use crate::{Ending, diagnostic, drawing, frequency, output, printed, terminal};
use springpot::law::Catalog;
use springpot::linear::StateKind;
use springpot_run::linear::{self, Modelled};
use springpot_run::numbers::{brief, count, rough};
use std::f64::consts::TAU;
use std::io::Cursor;

pub(crate) fn linearise(options: &LineariseOptions, catalog: &Catalog) -> Ending {
    model(options, catalog).map_or_else(Stopped::end, |modelled| tell(options, &modelled))
}

fn model(options: &LineariseOptions, catalog: &Catalog) -> Result<Modelled, Stopped> {
    let ending = drawing::ending(&options.out);
    if !matches!(&*ending, "json" | "npz") {
        let message = format!("--out {}: no kind of file", options.out.display());
        return Err((message, "write a name that ends in .json or .npz".to_owned()).into());
    }
    let band = band(&options.band)?;
    let cases = Asked::cases((&options.file, &options.overrides, &[]), catalog)?;
    diagnostic::robot_warnings(&cases);
    let asked = Asked::about(&cases.plan(0).map_err(Stopped::told)?, options.about.place())?;
    let names = [&options.inputs[..], &options.outputs[..]];
    let modelled = linear::linearise(&asked.about, names, band, options.tolerance).map_err(Stopped::from)?;
    asked.warn();
    Ok(modelled)
}

/// Two frequencies, Hz.
fn band(text: &str) -> Result<[f64; 2], Stopped> {
    let help = || "write two frequencies, the lower one first: --band '0.1 Hz,100 Hz'".to_owned();
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [low, high] = parts[..] else {
        return Err((format!("--band {text}: not two frequencies"), help()).into());
    };
    let read = |part: &str| match frequency::angular(part) {
        Ok(omega) if omega > 0.0 && omega.is_finite() => Ok(omega / TAU),
        Ok(_) => Err(Stopped::from((format!("--band {text}: {part:?} is not a frequency above 0"), help()))),
        Err(error) => Err(Stopped::from((format!("--band {text}: {error}"), help()))),
    };
    let [from, to] = [read(low)?, read(high)?];
    if from >= to {
        return Err((format!("--band {text}: {low} is not below {high}"), "swap them".to_owned()).into());
    }
    Ok([from, to])
}

fn tell(options: &LineariseOptions, modelled: &Modelled) -> Ending {
    let bytes = if drawing::ending(&options.out) == "json" {
        format!("{:#}\n", modelled.json()).into_bytes()
    } else {
        let mut archive = Cursor::new(Vec::new());
        if let Err(error) = modelled.npz(&mut archive) {
            diagnostic::error(error.to_string());
            return Ending::Failed;
        }
        archive.into_inner()
    };
    match output::written(&options.out, output::write(&options.out, &bytes)) {
        Ending::Done => printed(terminal::try_print(&page(modelled))),
        ending => ending,
    }
}

fn page(modelled: &Modelled) -> String {
    let states = &modelled.model.states;
    let of = |kinds: &[StateKind]| states.iter().filter(|state| kinds.contains(&state.kind)).count();
    let memories = of(&[StateKind::Memory, StateKind::MemoryOfIntegral]);
    let inner = of(&[StateKind::Inner]);
    let words = format!(
        "{}: {} of the robot, {inner} inside laws and controllers, {} of memories",
        count(states.len(), "state", "states"),
        states.len() - memories - inner,
        memories
    );
    let [from, to] = modelled.band.map(brief);
    let error =
        format!("every channel within {} of the exact answer from {from} Hz to {to} Hz", rough(modelled.model.error));
    let width = terminal::stdout_width().or(Some(80));
    terminal::hanging("", &words, width) + &terminal::hanging("", &error, width)
}
