//! The ordinary: what everybody tries first, on every robot, law, scenario and command at hand. It must simply go, with default settings.
//!
//! A small part is among the tests of every day, the rest behind `--ignored`.

mod commands;
mod laws;
mod ran;
mod robots;
mod scenarios;
