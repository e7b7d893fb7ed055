//! What the system tells a run: to stop, or that a file is as large as it may be.

use springpot::system::Stop;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The flag that Ctrl-C, SIGTERM and SIGHUP set; a second one ends the process at once.
///
/// The first call installs the handlers. Where that fails the signals still end the process, only less tidily.
pub(crate) fn stop() -> &'static Stop {
    static STOP: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    STOP.get_or_init(|| {
        let flag = Arc::new(AtomicBool::new(false));
        let _ = install(&flag);
        flag
    })
}

#[cfg(unix)]
fn install(stop: &Arc<AtomicBool>) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag;
    // Writes beyond the largest size then fail, as they do on a full disk, and do not end the process without a word.
    flag::register(SIGXFSZ, Arc::default())?;
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        // Under nohup a run outlives its terminal.
        if signal == SIGHUP && is_ignored(SIGHUP) {
            continue;
        }
        flag::register_conditional_shutdown(signal, INTERRUPTED, stop.clone())?;
        flag::register(signal, stop.clone())?;
    }
    Ok(())
}

/// The exit code of what was interrupted.
const INTERRUPTED: i32 = 130;

/// What is called before a signal ends the process.
static CLEAN: Mutex<Vec<Box<dyn Fn() + Send>>> = Mutex::new(Vec::new());

/// Has `clean` called when Ctrl-C, SIGTERM or SIGHUP end the process. Where no handler can be installed they end it without.
pub(crate) fn before_the_end(clean: impl Fn() + Send + 'static) {
    let mut all = CLEAN.lock().unwrap_or_else(PoisonError::into_inner);
    all.push(Box::new(clean));
    // One handler hears for all that a process does.
    if all.len() > 1 {
        return;
    }
    drop(all);
    let clean = || CLEAN.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(|clean| clean());
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let ending = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|&signal| signal != SIGHUP || !is_ignored(SIGHUP));
        let Ok(mut signals) = signal_hook::iterator::Signals::new(ending) else { return };
        // Without a thread to wait for them, signals are heard by nobody; the command then goes on to its end.
        let _ = std::thread::Builder::new().spawn(move || {
            if signals.forever().next().is_some() {
                clean();
                std::process::exit(INTERRUPTED);
            }
        });
    }
    #[cfg(not(unix))]
    let _ = ctrlc::set_handler(move || {
        clean();
        std::process::exit(INTERRUPTED);
    });
}

/// Whether a signal is ignored, as far as the system tells: Linux does.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(not(unix))]
fn install(stop: &Arc<AtomicBool>) -> Result<(), ctrlc::Error> {
    let stop = stop.clone();
    ctrlc::set_handler(move || {
        if stop.swap(true, std::sync::atomic::Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
    })
}
