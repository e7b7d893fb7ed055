//! The look of a figure from texts, as the command and Python give them.

use super::NotDrawn;
use crate::panels::{DrawnLook, FigureColumn, Misfit};
use springpot_scenario::{
    ColumnGlob, FIGURE_SIDES, FigureLabel, LOOK_OPTIONS, Look, LookOption, Place, RangeEnd, Said, Source, Takes,
    suggest, units,
};
use std::sync::Arc;

/// Reads options by name, each with its text, or without one where there shall be none of what it says.
pub(super) fn read(asked: &[(String, Option<String>)]) -> Result<Look, NotDrawn> {
    let mut look = Look::default();
    for (name, text) in asked {
        let known = LOOK_OPTIONS.iter().filter_map(|option| Some((option, option.spelt?)));
        let Some((option, spelt)) = known.clone().find(|(option, _)| option.name() == name) else {
            let help = suggest(name, known.map(|(option, _)| option.name()));
            return Err(NotDrawn::new(format!("figures have no option {name:?}"), help));
        };
        let asked = format!("--{}", spelt.option);
        put(&mut look, option, &asked, text.as_deref())?;
        let what = match option.takes {
            Takes::Flag { word, .. } => format!("{asked} {word}:"),
            _ => format!("{asked} {}", text.as_deref().unwrap_or_default()),
        };
        look.said.push(Said { option: option.name(), what, place: None });
    }
    if look.is_equal && (look.x.is_log || look.y.is_log) {
        let help = "leave --aspect out, or the scale".to_owned();
        return Err(NotDrawn::new("--aspect equal has no meaning on a logarithmic scale", help));
    }
    Ok(look)
}

/// The look of a figure with these columns.
pub(super) fn drawn(look: &Look, x: &FigureColumn, y: &[FigureColumn]) -> Result<DrawnLook, NotDrawn> {
    DrawnLook::new(look.clone(), x, y).map_err(|Misfit { option, message, help }| {
        let what = look.said(option).map_or("", |said| &said.what);
        NotDrawn::new(format!("{what} {message}"), help)
    })
}

/// Puts what is asked by `option`, which is called `asked` in messages, where it belongs.
fn put(look: &mut Look, option: &LookOption, asked: &str, text: Option<&str>) -> Result<(), NotDrawn> {
    let Some(text) = text else {
        let Takes::TextOrFalse { hides, .. } = option.takes else {
            return Err(NotDrawn::new(format!("{asked} is no switch"), "write what it is, or leave it out".to_owned()));
        };
        *hides(look) = true;
        return Ok(());
    };
    match option.takes {
        Takes::Range(at) => *at(look) = Some(ends(asked, text)?),
        Takes::Flag { word, at, .. } => {
            let choices = option.choices();
            if !choices.contains(&text) {
                let help = format!("write {}", choices.join(" or "));
                return Err(NotDrawn::new(format!("{asked} {text}: there is no such word"), help));
            }
            *at(look) = text == word;
        }
        Takes::Text(at) | Takes::TextOrFalse { text: at, .. } => *at(look) = Some(text.to_owned()),
        Takes::Size(at) => *at(look) = Some(size(asked, text)?),
        Takes::Times(at) => *at(look) = Some(window(asked, text)?),
        Takes::Labels => look.labels.push(label(asked, text)?),
        Takes::Direction(_) | Takes::Formats => {
            return Err(NotDrawn::new(format!("{asked} is of scenarios alone"), "leave it out".to_owned()));
        }
    }
    Ok(())
}

/// The two parts of a text with a comma.
fn pair<'t>(option: &str, text: &'t str) -> Result<[&'t str; 2], NotDrawn> {
    match text.split(',').map(str::trim).collect::<Vec<_>>()[..] {
        [first, second] => Ok([first, second]),
        _ => {
            let help = format!("write two values with a comma between them, as in {option} A,B");
            Err(NotDrawn::new(format!("{option} {text:?} is not two values"), help))
        }
    }
}

fn ends(option: &str, text: &str) -> Result<[RangeEnd; 2], NotDrawn> {
    let end = |text: &str| {
        RangeEnd::parse(text).map_err(|why| {
            let help = "write numbers in the unit that is drawn, or quantities such as 5N".to_owned();
            NotDrawn::new(format!("{option}: {text:?} is {why}"), help)
        })
    };
    let [from, to] = pair(option, text)?;
    Ok([end(from)?, end(to)?])
}

fn size(option: &str, text: &str) -> Result<[f64; 2], NotDrawn> {
    let [least, most] = FIGURE_SIDES;
    let help = || format!("write two lengths from {} to {} mm, as in 90mm,60mm", 1e3 * least, 1e3 * most);
    let side = |text: &str| match units::parse_quantity(text, "m", &|_| None) {
        Ok(side) if (least..=most).contains(&side) => Ok(side),
        Ok(_) => Err(NotDrawn::new(format!("{option}: {text} is no side of a figure"), help())),
        Err(error) => Err(NotDrawn::new(format!("{option}: {text}: {error}"), help())),
    };
    let [width, height] = pair(option, text)?;
    Ok([side(width)?, side(height)?])
}

/// A stretch of time, s.
fn window(option: &str, text: &str) -> Result<[f64; 2], NotDrawn> {
    let time = |text: &str| {
        units::parse_quantity(text, "s", &|_| None).map_err(|error| {
            let help = "write two times, such as 1,2 or 100ms,200ms".to_owned();
            NotDrawn::new(format!("{option} {text}: {error}"), help)
        })
    };
    let [from, to] = pair(option, text)?;
    let [from, to] = [time(from)?, time(to)?];
    if from < to {
        return Ok([from, to]);
    }
    let message = format!("{option} {text} runs from {from} s to {to} s, which is no stretch of time");
    Err(NotDrawn::new(message, "write the earlier time first".to_owned()))
}

/// Reads `COLUMN=TEXT`.
fn label(option: &str, assignment: &str) -> Result<FigureLabel, NotDrawn> {
    let Some((glob, text)) = assignment.split_once('=') else {
        return Err(NotDrawn::new(format!("{option} {assignment:?} has no `=`"), "write COLUMN=TEXT".to_owned()));
    };
    let source = Arc::new(Source { name: option.to_owned(), text: assignment.into() });
    let column = ColumnGlob { text: glob.to_owned(), place: Place { source, span: 0..glob.len() } };
    Ok(FigureLabel { column, text: text.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A text that an option takes.
    fn fitting(option: &LookOption) -> &'static str {
        match option.takes {
            Takes::Range(_) => "1,2 N",
            Takes::Flag { word, .. } => word,
            Takes::Text(_) | Takes::TextOrFalse { .. } => "words",
            Takes::Size(_) => "90mm,60mm",
            Takes::Times(_) => "1,2",
            Takes::Labels => "strut.*=pull",
            Takes::Direction(_) | Takes::Formats => panic!("{} is of scenarios alone", option.name()),
        }
    }

    #[test]
    fn every_option_of_the_command_is_read_and_remembered() {
        for option in LOOK_OPTIONS.iter().filter(|option| option.spelt.is_some()) {
            let look = read(&[(option.name().to_owned(), Some(fitting(option).to_owned()))]).unwrap();
            let said = look.said(option.name()).unwrap();
            assert!(said.what.starts_with(&format!("--{}", option.spelt.unwrap().option)), "{said:?}");
            assert_ne!(Look { said: Vec::new(), ..look }, Look::default(), "{}", option.name());
            let none = read(&[(option.name().to_owned(), None)]);
            assert_eq!(none.is_ok(), option.spelt.unwrap().without.is_some(), "{}", option.name());
        }
    }

    #[test]
    fn what_no_option_takes_is_refused() {
        for (name, text, wanted) in [
            ("xrange", "1,2", "figures have no option \"xrange\""),
            ("view", "1,2", "figures have no option"),
            ("x_range", "1", "--x-range \"1\" is not two values"),
            ("y_range", "1,b", "--y-range: \"b\" is"),
            ("x_scale", "cubic", "--x-scale cubic"),
            ("size", "1mm,2mm", "--size: 1mm is no side"),
            ("labels", "strut", "--label \"strut\" has no `=`"),
            ("window", "2,1", "--window 2,1 runs from 2 s to 1 s"),
        ] {
            let refused = read(&[(name.to_owned(), Some(text.to_owned()))]).unwrap_err();
            assert!(refused.message.starts_with(wanted) && refused.help.is_some(), "{refused:?}");
        }
    }
}
