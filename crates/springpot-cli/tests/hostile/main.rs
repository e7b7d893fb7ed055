//! Files and words of others, damaged at random: networks, expressions, robots, records of runs, as the command reads them. Each ends with
//! 0, 1 or 2, in five seconds of work and a gibibyte of memory, and never with a panic.
//!
//! A few hundred are tried by default; `cargo test -p springpot-cli --test hostile -- --ignored --nocapture` tries a hundred thousand of each.

mod expressions;
mod memory;
mod mutation;
mod networks;
mod records;
mod robots;
mod trial;
