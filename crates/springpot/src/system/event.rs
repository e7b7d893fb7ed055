//! Events of forward runs: what happens where a function of the columns passes zero.

use crate::observe::Quantity;
use crate::signal::ColumnExpression;
use crate::system::System;

/// What is watched, and what is done where it happens.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Its name.
    pub name: String,
    /// Passes zero where it happens.
    pub when: ColumnExpression,
    /// What the columns of `when` hold, in their order.
    pub columns: Vec<Quantity>,
    /// Which passages count.
    pub direction: Direction,
    /// What is done, besides telling the row ([`crate::driver::Rows::event`]).
    pub action: Action,
}

/// Which passages through zero count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Direction {
    /// From below.
    Rising,
    /// From above.
    Falling,
    /// Both.
    #[default]
    Both,
}

/// What an event does.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Action {
    /// Nothing more than its row.
    #[default]
    Record,
    /// The run ends there, as if that had been its end.
    Stop,
    /// These hold from there on, until another event sets them.
    Set(Vec<Setting>),
}

/// What an event sets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Setting {
    /// An input of an element, in place of its signal.
    Input {
        /// The element.
        element: usize,
        /// The input of its law.
        input: usize,
        /// SI.
        value: f64,
    },
    /// The actuator force on a velocity, in place of its signal.
    Torque {
        /// The velocity, which a force drives.
        velocity: usize,
        /// N·m or N.
        value: f64,
    },
}

impl Direction {
    /// All of them, with the words that scenarios have for them.
    pub const ALL: [(&'static str, Self); 3] =
        [("rising", Self::Rising), ("falling", Self::Falling), ("both", Self::Both)];

    pub(crate) fn counts(self, rises: bool) -> bool {
        match self {
            Self::Rising => rises,
            Self::Falling => !rises,
            Self::Both => true,
        }
    }
}

impl Event {
    /// Whether a run goes on differently behind it.
    pub(crate) fn acts(&self) -> bool {
        self.action != Action::Record
    }
}

impl System {
    /// Whether a setting of an event is an input of this element.
    pub(crate) fn sets_input_of(&self, event: usize, setting: usize, of: usize) -> bool {
        let Some(Action::Set(settings)) = self.events.get(event).map(|event| &event.action) else { return false };
        matches!(settings.get(setting), Some(Setting::Input { element, .. }) if *element == of)
    }
}
