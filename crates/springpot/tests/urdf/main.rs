//! URDF files: robots, refusals, warnings, packages, long chains, broken texts.
#![cfg(feature = "urdf")]

mod assumptions;
mod broken_joints;
mod broken_links;
mod broken_trees;
mod broken_xml;
mod fuzz;
mod long_chain;
mod packages;
mod robots;
mod support;
mod unused;
#[path = "../support/work.rs"]
mod work;
