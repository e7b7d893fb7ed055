//! Options of the look of a figure, made of the rows that its keys in scenarios are made of.

use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use springpot_scenario::{LOOK_OPTIONS, LookOption, Spelt, Takes};

/// Options of the look of a figure by their names, each with its text, or without one where it was taken away.
#[derive(Debug, Clone)]
pub(crate) struct LookOptions(pub(crate) Vec<(String, Option<String>)>);

/// The options that the command has.
fn options() -> impl Iterator<Item = (&'static LookOption, Spelt)> {
    LOOK_OPTIONS.iter().filter_map(|option| Some((option, option.spelt?)))
}

impl Args for LookOptions {
    fn augment_args(mut command: Command) -> Command {
        const HEADING: &str = "Look of the figure";
        for (option, Spelt { option: long, value, help, without: none }) in options() {
            let action = if matches!(option.takes, Takes::Labels) { ArgAction::Append } else { ArgAction::Set };
            let mut arg = Arg::new(option.name()).long(long).value_name(value).help(help).action(action);
            // Numbers may be negative.
            arg = arg.allow_hyphen_values(matches!(option.takes, Takes::Range(_) | Takes::Times(_)));
            if let Takes::Flag { .. } = option.takes {
                arg = arg.value_parser(option.choices()).hide_possible_values(true);
            }
            if let Some((without, _)) = none {
                arg = arg.conflicts_with(without);
            }
            command = command.arg(arg.help_heading(HEADING));
            if let Some((long, help)) = none {
                let arg = Arg::new(long).long(long).help(help).action(ArgAction::SetTrue);
                command = command.arg(arg.help_heading(HEADING));
            }
        }
        command
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for LookOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut asked = Vec::new();
        for (option, spelt) in options() {
            let texts = matches.get_many::<String>(option.name()).into_iter().flatten();
            asked.extend(texts.map(|text| (option.name().to_owned(), Some(text.clone()))));
            if spelt.without.is_some_and(|(without, _)| matches.get_flag(without)) {
                asked.push((option.name().to_owned(), None));
            }
        }
        Ok(Self(asked))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
