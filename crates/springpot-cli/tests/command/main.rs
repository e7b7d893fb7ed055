//! The program as a user types it.

mod check;
mod derivative;
mod design;
mod doubts;
mod dynamics;
mod dynamics_refusals;
mod end_stops;
mod equation;
mod events;
mod export;
mod failures;
mod figures;
mod first_week;
mod fit;
mod fmu;
mod formats;
mod friction;
mod help;
mod inertias;
mod info;
mod init;
#[cfg(unix)]
mod interrupted;
mod joints;
mod latex;
mod laws;
mod linearise;
mod looks;
mod manual;
mod master;
mod measured;
mod messages;
mod metrics;
mod mjcf;
mod modes;
mod modulus;
mod names;
mod networks;
mod other_hands;
#[cfg(unix)]
mod pages;
mod pipes;
mod plot;
mod prony;
mod results;
#[cfg(unix)]
mod resume;
mod robots;
mod second_week;
mod sensitivity;
mod shapes;
mod shards;
mod staircases;
mod strangers;
mod studies;
mod support;
mod sweeps;
#[cfg(target_os = "linux")]
mod terminal;
mod third_week;
#[cfg(unix)]
mod written;
