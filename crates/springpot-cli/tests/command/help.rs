//! Help, version, and mistyped commands.

use crate::support::Place;

#[test]
fn help_is_where_it_is_looked_for() {
    let place = Place::new();
    let help = place.done(&["--help"]).stdout;
    assert_eq!(place.done(&["help"]).stdout, help);
    for line in [
        "Usage: springpot <COMMAND>",
        "  run          Run a scenario",
        "  check        Read and check",
        "  info         Describe a robot",
        "  dynamics     Compute the dynamics",
        "  derivative   Differentiate columns",
        "  prony        Turn a springpot",
        "  modes        Natural frequencies",
        "  laws         Show the laws",
        "  plot         Draw columns",
        "  fmu          Write a scenario as an FMU",
        "  init         Write a commented scenario",
        "  completions  Print a script",
        "  man          Print the manual page",
        "Exit codes: 0 done",
    ] {
        assert!(help.contains(line), "{help}");
    }
    let nothing = place.springpot(&[]);
    assert_eq!((nothing.code, nothing.stdout.as_str()), (Some(2), ""));
    assert!(nothing.stderr.contains("Usage: springpot <COMMAND>"));

    for (command, options) in [
        (
            "run",
            &[
                "--set <PATH=VALUE>",
                "--out <DIR>",
                "--checkpoint-every <TIME>",
                "--resume <DIR>",
                "--format <FORMAT>",
                "--jobs <N>",
                "--no-figures",
                "--quiet",
            ][..],
        ),
        ("check", &["--set <PATH=VALUE>", "--schema", "--quiet"]),
        ("view", &["--case <K,...>", "--out <FILE>", "--serve", "--port <N>"]),
        ("report", &["--out <FILE>"]),
        ("export", &["--case <K>", "<RESULTS> <FILE>"]),
        ("fmu", &["--set <PATH=VALUE>", "--out <FILE>", "--library <FILE>"]),
        ("info", &["--json", "--floating-base", "--ignore-mimic", "--package-path <DIR>"]),
        (
            "dynamics",
            &[
                "--states <FILE>",
                "--christoffel",
                "--frame <NAME>",
                "--at <TIME>",
                "--case <N>",
                "--json",
                "--set <PATH=VALUE>",
                "--floating-base",
                "--ignore-mimic",
                "--package-path <DIR>",
            ],
        ),
        (
            "derivative",
            &[
                "--column <NAME>",
                "--order <ORDER>",
                "--time <NAME>",
                "--kind <KIND>",
                "--scheme <SCHEME>",
                "--error",
                "--out <FILE>",
            ],
        ),
        (
            "prony",
            &[
                "--order <ALPHA>",
                "--coefficient <C>",
                "--from <TIME>",
                "--to <TIME>",
                "--band",
                "--rtol <ERROR>",
                "--equilibrium <MODULUS>",
                "--format <FORMAT>",
                "--bulk <BULK>",
                "--out <FILE>",
            ],
        ),
        ("laws", &["--from <DATA>", "--json"]),
        ("plot", &["--x <COLUMN>", "--where <PATH=VALUE>", "--unit <COLUMN=UNIT>", "--out <FILE>", "--title <TEXT>"]),
        ("init", &["--out <FILE>"]),
        ("completions", &["<SHELL>"]),
        ("man", &["--out <DIR>"]),
    ] {
        let help = place.done(&[command, "--help"]).stdout;
        assert_eq!(place.done(&["help", command]).stdout, help);
        assert!(options.iter().all(|option| help.contains(option)) && help.contains("Example"), "{help}");
    }
    let version = format!("springpot {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(place.done(&["--version"]).stdout, version);
    assert_eq!(place.done(&["-V"]).stdout, version);
}

#[test]
fn mistyped_commands_get_a_suggestion() {
    let place = Place::new();
    for (arguments, words) in [
        (&["rum", "arm.toml"][..], "no command \"rum\"\n  help: did you mean `run`?"),
        (&["rn", "arm.toml"], "did you mean `run`?"),
        (&["chek", "arm.toml"], "did you mean `check`?"),
        (&["control"], "help: there is run, sensitivity, design, merge,"),
        (
            &["arm.toml"],
            "no command, but a file\n  help: `springpot run arm.toml` runs it, `springpot check arm.toml` looks at it",
        ),
        (
            &["ur5.urdf"],
            "`springpot init ur5.urdf` writes a scenario with this robot, `springpot info ur5.urdf` describes it",
        ),
        (&["rows.csv"], "`springpot derivative rows.csv --column NAME --order 0.5` differentiates a column"),
        (&["run", "arm.toml", "--job", "2"], "`springpot run` has no option --job\n  help: did you mean --jobs?"),
        (&["run", "arm.toml", "-v"], "has no option -v\n  help: there is --set, --sweep,"),
        (&["check", "arm.toml", "--where", "x=1"], "it is one of `springpot derivative`, `springpot plot`"),
        (&["run"], "<SCENARIO>"),
        (
            &["run", "arm.toml", "--jobs", "0"],
            "--jobs 0: not a value that it takes\n  help: write how many cases run at a time",
        ),
        (&["run", "arm.toml", "--jobs", "many"], "--jobs many: not a value that it takes"),
        (&["run", "arm.toml", "--out", ""], "--out has no value\n  help: write --out <DIR>"),
        (&["run", "arm.toml", "other.toml"], "`springpot run` takes no \"other.toml\" after"),
        (&["dynamics", "arm.toml"], "<--states <FILE>|--at <TIME>>"),
        (&["dynamics", "arm.toml", "--at", "1", "--states", "s.json"], "cannot be used with"),
        (&["dynamics", "arm.toml", "--at", "1", "--christoffel"], "cannot be used with"),
        (&["dynamics", "arm.toml", "--at", "1", "--frame", "arm"], "cannot be used with"),
        (&["dynamics", "arm.toml", "--states", "s.json", "--case", "1"], "cannot be used with"),
        (&["dynamics", "arm.toml", "--at", "1", "--case", "-1"], "--case -1: not a value that it takes"),
    ] {
        let ended = place.springpot(arguments);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(ended.stderr.contains(words), "{arguments:?}: {}", ended.stderr);
    }
    assert!(!place.path("results").exists());
}
