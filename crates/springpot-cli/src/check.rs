//! `springpot check`.

use crate::arguments::CheckOptions;
use crate::{Ending, refusals};
use springpot::scenario::{Cases, Plan, Refusals};
use springpot::simulate::{ElementStart, RunError};
use springpot::sweep::Layout;

/// A stroke at t = 0 beyond this share of the rest length is worth a warning.
const LARGE_STROKE: f64 = 0.2;

pub(crate) fn check(options: &CheckOptions) -> Ending {
    let opened = refusals::open(&options.scenario).and_then(|cases| {
        let plan = cases.plan(0)?;
        Ok((cases, plan))
    });
    let (cases, plan) = match opened {
        Ok(opened) => opened,
        Err(refused) => {
            refusals::print(&refused);
            return Ending::Refused;
        }
    };
    match describe(&cases, &plan, options.quiet) {
        Ok(Ok(())) => Ending::Done,
        Ok(Err(error)) => {
            eprintln!("error: {error}");
            Ending::Failed
        }
        Err(refused) => {
            refusals::print(&refused);
            Ending::Refused
        }
    }
}

/// Prints the plan of the first case and what deserves a warning in it.
fn describe(cases: &Cases, plan: &Plan, quiet: bool) -> Result<Result<(), RunError>, Refusals> {
    let system = plan.system();
    Layout::new(cases, &system)?;
    let starts = match system.element_starts() {
        Ok(starts) => starts,
        Err(error) => return Ok(Err(error)),
    };
    if !quiet {
        if let Some(title) = &plan.title {
            println!("{title}");
        }
        let joints: Vec<&str> = plan.joint_names().collect();
        println!("robot     {} bodies, joints {}", plan.bodies.len(), joints.join(", "));
        println!("motion    {} to {} s, {} rows", plan.motion.kind(), plan.time.end, plan.time.rows.count());
        let solver = &plan.solver;
        println!("solver    rtol {:e}, memory_rtol {:e}", solver.rtol, solver.memory_rtol);
        if cases.parameters().is_empty() {
            println!("cases     1");
        } else {
            println!("cases     {} over {}", cases.len(), cases.parameters().join(", "));
        }
    }
    for (element, start) in plan.elements.iter().zip(&starts) {
        if !quiet {
            println!("element   {}: {}", element.name, element.law.name);
            println!("          {}", element.law.equation);
            println!("          l(0) = {} m, x(0) = {} m", short(start.length), short(start.stroke));
            let gradient = plan.joint_names().zip(&start.gradient);
            let gradient: Vec<String> = gradient.map(|(joint, g)| format!("{joint}: {}", short(*g))).collect();
            println!("          dl/dq  {}", gradient.join(", "));
        }
        for warning in warnings(&element.name, element.rest_length, start) {
            eprintln!("warning: {warning}");
        }
    }
    Ok(Ok(()))
}

fn warnings(name: &str, rest_length: f64, start: &ElementStart) -> Vec<String> {
    let mut warnings = Vec::new();
    let ElementStart { length, stroke, .. } = start;
    if stroke.abs() > LARGE_STROKE * rest_length {
        warnings.push(format!(
            "element \"{name}\" starts with a stroke of {} m, more than 20 % of its rest length {} m: l(0) = {} m",
            short(*stroke),
            short(rest_length),
            short(*length)
        ));
    }
    if start.singular {
        warnings.push(format!(
            "element \"{name}\" starts with x(0) = {} m and the Riemann-Liouville derivative: its force is infinite at \
             t = 0 and its energy unknown; derivative = \"caputo\" means that it was held at x(0) before",
            short(*stroke)
        ));
    }
    warnings
}

/// Six significant digits, without trailing zeros.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}
