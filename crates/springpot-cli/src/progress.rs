//! The progress bar on stderr, when it is a terminal.

use crate::signals;
use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use springpot_run::numbers::brief;
use springpot_run::sweep::Progress;
use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Runs shorter than this show no bar.
const PATIENCE: Duration = Duration::from_millis(300);
const REFRESH: Duration = Duration::from_millis(100);

/// Switches of the signals from which on they are told: each ends a step.
const MANY_SWITCHES: u64 = 10_000;

/// Shows rows written of rows wanted while `work` runs, and how far it has come on the way to `end`, s, where signals switch often.
pub(crate) fn show_while<T>(wanted: u64, end: f64, progress: &Progress, quiet: bool, work: impl FnOnce() -> T) -> T {
    if quiet || !std::io::stderr().is_terminal() {
        return work();
    }
    let finished = AtomicBool::new(false);
    std::thread::scope(|scope| {
        // Without a thread to show it, the work still goes on.
        let watcher = std::thread::Builder::new().spawn_scoped(scope, || watch(wanted, end, progress, &finished)).ok();
        let result = work();
        finished.store(true, Ordering::Relaxed);
        if let Some(watcher) = watcher {
            watcher.thread().unpark();
        }
        result
    })
}

fn watch(wanted: u64, end: f64, progress: &Progress, finished: &AtomicBool) {
    std::thread::park_timeout(PATIENCE);
    if finished.load(Ordering::Relaxed) {
        return;
    }
    let bar = ProgressBar::with_draw_target(Some(wanted), ProgressDrawTarget::stderr_with_hz(10));
    bar.set_style(style());
    while !finished.load(Ordering::Relaxed) {
        // Cases of a sweep over the end or the output step have other numbers of rows than the first.
        bar.set_position(progress.rows.load(Ordering::Relaxed).min(wanted));
        let switches = progress.switches.load(Ordering::Relaxed);
        if signals::stop().load(Ordering::Relaxed) {
            bar.set_message(", stopping");
        } else if switches >= MANY_SWITCHES {
            let (t, switches) = (brief(progress.t()), HumanCount(switches));
            bar.set_message(format!(", t = {t} of {} s, {switches} switches to follow", brief(end)));
        }
        std::thread::park_timeout(REFRESH);
    }
    bar.finish_and_clear();
}

fn style() -> ProgressStyle {
    let left = |state: &ProgressState, text: &mut dyn Write| {
        // An estimate from nothing would say 0 s.
        if state.pos() > 0 && state.pos() < state.len().unwrap_or(0) {
            let _ = write!(text, ", {} left", indicatif::HumanDuration(state.eta()));
        }
    };
    let template = "{wide_bar} {percent:>3} %, row {human_pos} of {human_len}{left}{msg}";
    ProgressStyle::with_template(template).unwrap_or(ProgressStyle::default_bar()).with_key("left", left)
}
