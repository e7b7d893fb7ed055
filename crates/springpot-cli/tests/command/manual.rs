//! `springpot completions` and `springpot man`.

use crate::support::Place;

const COMMANDS: [&str; 4] = ["run", "check", "dynamics", "laws"];

#[test]
fn every_shell_gets_a_script() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = place.done(&["completions", shell]).stdout;
        let known = |word: &str| script.contains(word);
        assert!(COMMANDS.iter().all(|command| known(command)) && known("checkpoint-every"), "{shell}: {script}");
    }
    let refused = place.springpot(&["completions", "tcsh"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("there is bash"), "{}", refused.stderr);
}

#[test]
fn pages_are_printed_or_written() {
    let place = Place::new();
    let page = place.done(&["man"]).stdout;
    assert!(page.contains(".TH springpot 1") && COMMANDS.iter().all(|command| page.contains(command)), "{page}");
    assert!(!page.contains("\\-help(1)"), "{page}");
    assert_eq!(place.done(&["man", "--out", "man"]).stdout, "");
    let files = place.files("man");
    assert!(COMMANDS.iter().all(|command| files.contains(&format!("springpot-{command}.1"))), "{files:?}");
    assert!(files.contains(&"springpot.1".to_owned()) && !files.iter().any(|file| file.contains("help")), "{files:?}");
    let run = place.read("man/springpot-run.1");
    assert!(run.contains("checkpoint\\-every") && run.contains(".SH EXAMPLES\n.nf\nspringpot run scenarios/"), "{run}");
    assert!(run.contains(".fi\n.SH NOTES\nWrites results.csv"), "{run}");
    // Every page has its examples as lines of their own.
    for file in files {
        let page = place.read(format!("man/{file}"));
        assert!(page.contains(".SH EXAMPLES\n.nf\nspringpot ") && !page.contains("EXTRA"), "{file}: {page}");
    }
    place.write("file", "");
    let failed = place.springpot(&["man", "--out", "file/man"]);
    assert!(failed.code == Some(1) && failed.stderr.contains("cannot be written"), "{}", failed.stderr);
}
